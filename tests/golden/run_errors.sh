#!/bin/sh
# Golden tests of the messages of `lagc check`:
#   tests/golden/err/sem_NAME.lag + .expected    a bad model: exit status 1, the messages exactly, nothing on stdout
#   tests/golden/err/warn_NAME.lag + .expected   a good one that draws warnings: exit status 0, the messages exactly
#   tests/golden/ok/NAME.lag                     a good one, the near miss of an error: exit status 0, no messages
# rows.txt lists refused constructs, each with its file and its near miss.
# Bad models are also given to the commands that write files, in `make test` a quarter of them: none may be left, whole or in part.
# LAGC names the compiler; PART=K: one model in K, others each day, where a process takes long to start; BLESS=1 rewrites the expectations, on purpose.
. tests/tap.sh
tmp=$TMP
mkdir -p "$tmp/out"

for lag in tests/golden/err/sem_*.lag tests/golden/err/warn_*.lag tests/golden/ok/*.lag; do
  one_of "${PART:-1}" || continue
  want=${lag%.lag}.expected
  status=1
  command=check
  case $lag in
    */warn_*) status=0 ;;
    */ok/method.lag) status=0 want=/dev/null command='run --quiet' ;;
    */ok/*) status=0 want=/dev/null ;;
  esac
  # shellcheck disable=SC2086 # a command and its option
  set -- $command
  "$LAGC" "$1" "$lag" ${2:+"$2"} >"$tmp/stdout" 2>"$tmp/stderr"
  code=$?
  problem=
  if [ -n "${BLESS:-}" ] && [ "$code" = "$status" ] && [ "$want" != /dev/null ]; then cp "$tmp/stderr" "$want"; fi
  [ "$code" = "$status" ] || problem="exit status $code, expected $status
"
  if [ "$status" != 0 ] && [ -s "$tmp/stdout" ]; then problem="${problem}something on stdout
"; fi
  cmp -s "$want" "$tmp/stderr" || problem=$problem$(diff -u "$want" "$tmp/stderr")
  empty "$lag" "$problem"
done

# ---- each row has its message, and a near miss ----
grep -v '^#' tests/golden/rows.txt | sed 's/ *| */|/g' >"$tmp/rows"
while IFS='|' read -r row err words ok; do
  problem=
  grep -qF -e "$words" "tests/golden/err/$err.expected" || problem="no \`$words\` in err/$err.expected
"
  [ -f "tests/golden/ok/$ok.lag" ] || problem="${problem}there is no ok/$ok.lag"
  empty "row: $row" "$problem"
done <"$tmp/rows"
for lag in tests/golden/ok/*.lag; do
  name=${lag##*/}
  grep -q "|${name%.lag}\$" "$tmp/rows" || empty "$lag is the near miss of a row" "rows.txt does not name it"
done

# ---- nothing is written ----
mkdir "$tmp/cache"
for lag in tests/golden/err/sem_*.lag; do
  one_of 4 || continue
  problem=
  for command in emit build derive header; do
    XDG_CACHE_HOME=$tmp/cache "$LAGC" $command "$lag" -o "$tmp/out/file" >"$tmp/stdout" 2>"$tmp/stderr"
    code=$?
    # `derive` and `emit` read one scene, and do not report mistakes in others
    if [ "$code" = 0 ] && [ "$command" != build ]; then
      rm -f "$tmp/out/file"
      continue
    fi
    [ "$code" = 1 ] || problem="$problem$command: exit status $code
"
    [ -z "$(ls -A "$tmp/out")" ] || problem="$problem$command left $(ls -A "$tmp/out")
"
    rm -rf "$tmp/out"
    mkdir "$tmp/out"
  done
  empty "$lag leaves no file" "$problem"
done
tap_end
