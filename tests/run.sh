#!/bin/sh
# Runs suites of tests; `make test` calls it with what it built (RUN_TESTS in tests/tests.mk).
#   sh tests/run.sh [--today | --long | --all | --bless | --bench] [PREFIX...]     only suites whose names, with or without their folder, begin with a PREFIX
# JOBS: suites at a time (a job a processor); TIMES=1: each suite's processor time beside its wall time, the second of the run in which it ended,
# and the sum of processor times.
#
# A suite is a file, found by its name; there is no list.
#   tests/unit/test_NAME.c         built into $BIN/test_NAME (cmocka)            suite unit/test_NAME
#   tests/fuzz/fuzz_NAME.c         replays tests/fuzz/corpus/NAME                suite fuzz/fuzz_NAME
#   tests/FOLDER/NAME.sh           run from the top of the source tree by sh     suite FOLDER/NAME
#   tests/FOLDER/long_NAME.sh      the same, in `make test-long` and `make test-all` only
#   tests/bench/NAME.sh            run by `make bench`; its output is shown, and written to tests/bench/RESULTS.md
#   tests/FOLDER/lib_NAME.sh       no suite: functions that scripts share
# How deep: `make test` takes some rows of long tables (`one_of` of tests/tap.sh, slow() of tests/unit/slow.h); `make test-long` has SLOW=1, twice
# as many rows and all `slow` checks; `make test-all` has all rows. DAY, the number of today, chooses the rows; the first line of a run names it.
# --today, which `make test` gives, leaves out seven of eight suites of exec/, others each DAY, unless a PREFIX names them.
# --bless runs the scripts that know BLESS with BLESS=1: they rewrite their expectations.
#
# Suites speak TAP: a plan `1..N`; `ok 1 - name`, `not ok 2 - name`, `ok 3 - name # SKIP why`; `# details`.
# `1..0 # SKIP why` skips a whole suite. A suite that crashes, exits with a status other than 0 and has no `not ok`,
# runs into the time limit, or has fewer or more results than its plan says, counts one failure more.
#
# Environment of scripts (paths relative to the top; empty: not available):
#   LAGC, LAGC_SAN, LAGC_CLANG     the compiler; built under the sanitizers of SAN_FLAGS, in `make test-long` all, with -O0; built by clang, in `make test-long`
#   PRECISIONS                     libraries of other precisions: none in `make test`
#   LIBLAG, INC, LIBS              the runtime's libraries, its headers, libraries to link after them
#   BIN, BUILD, TMP                built test programs; the build folder; a folder of the suite's own, empty
#   CC, CLANG, CXX, GSL, MAKE      GSL is `yes` or empty
#   LINKER                         a faster linker than CC's own: COMPILER_PATH where LAGC_OPTIMISE is set
#   LAG_TREE                       value of LAG_HOME with which LAGC_SAN and LAGC_CLANG find the runtime and the gallery
#   LAGC_OPTIMISE                  -O0 where simulators run for less time than they compile for: suites without `slow` checks and `one_of`; unset, so -O2, elsewhere
# Every suite leaves its output in $BUILD/test/log, those of `make test-long` in $BUILD/test/long, which reports in the order in which suites begin.
# The last line is `N passed, N failed`.
cd "$(dirname "$0")/.." || exit 2
unset MAKEFLAGS MFLAGS MAKELEVEL
export LAGC LAGC_SAN SAN_FLAGS LAGC_CLANG PRECISIONS LIBLAG LIBS INC BIN BUILD CC CLANG CXX GSL MAKE
export CMOCKA_MESSAGE_OUTPUT=TAP
export UBSAN_OPTIONS="print_stacktrace=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}"
: "${BUILD:=build}" "${BIN:=$BUILD/test/bin}" "${JOBS:=$(nproc 2>/dev/null || echo 2)}"
logs=$BUILD/test/log
# Simulators that tests make are kept apart from the user's own.
export CCACHE_DIR="${CCACHE_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/ccache}"
XDG_CACHE_HOME=$(pwd)/$BUILD/test/cache
LAG_TREE=$(pwd)/$BUILD/test/home
export XDG_CACHE_HOME LAG_TREE

kind='test'
limit=600
of_exec=1
case ${1:-} in
  --today) of_exec=8 ;;
  --long) kind=long limit=2400 logs=$BUILD/test/long ;;
  --all) kind=long limit=7200 logs=$BUILD/test/all ;;
  --bless) kind=bless JOBS=1 ;;
  --bench) kind=bench limit=3600 JOBS=1 ;;
  --run-one) kind=one ;;
esac
rows=some
[ "${1:-}" != --all ] || rows=all
case ${1:-} in --*) shift ;; esac
case $kind in
  test | bless) # `make coverage ROWS=all`: each check of these suites
    if [ "${COVERAGE:+${ROWS:-}}" = all ]; then export SLOW=1 ROWS && limit=7200; else unset SLOW; fi
    ;;
  long) unset LAGC_OPTIMISE && export SLOW=1 ROWS=$rows ;;
  bench) unset LAGC_OPTIMISE SLOW ;;
esac
[ "$kind" = one ] || export DAY="${DAY:-$(($(date +%s) / 86400))}"
[ -z "${LINKER:-}" ] || { mkdir -p "$BUILD/test/linker" && ln -sfn "$LINKER" "$BUILD/test/linker/ld"; }
# python3 may be a script that looks for a Python, at forty times the processor time of lagc: suites call what it finds.
python=$(command -v python3)
case $kind$python in one* | */test/python/python3) python= ;; esac
if [ -n "$python" ] && [ "$(head -c 2 "$python")" = '#!' ] && python=$(python3 -c 'import sys; print(sys.executable)' 2>/dev/null); then
  mkdir -p "$BUILD/test/python"
  printf '#!/bin/sh\nexec "%s" "$@"\n' "$python" >"$BUILD/test/python/python3" && chmod +x "$BUILD/test/python/python3"
  PATH=$(pwd)/$BUILD/test/python:$PATH
fi
# deep FILE: a suite with rows or checks that `make test` leaves out
deep() { grep -q 'SLOW\|^ *slow \|\<one_of ' "$1"; }

seconds() { date +%s.%N 2>/dev/null; }

# ---- one suite: its output to NAME.log, `status begin end processor_seconds` to NAME.done ----
if [ "$kind" = one ]; then
  suite=$1
  limit=$2
  logs=$3
  log=$logs/$suite.log
  TMP=$(pwd)/$BUILD/test/tmp/$suite
  export TMP
  rm -rf "$TMP"
  mkdir -p "$TMP" "$(dirname "$log")"
  case $suite in
    unit/test_*) set -- "$BIN/${suite#unit/}" ;;
    fuzz/fuzz_*) set -- "$BIN/${suite#fuzz/}" "tests/fuzz/corpus/${suite#fuzz/fuzz_}" ;;
    *)
      set -- sh "tests/$suite.sh"
      case $suite in
        */long_* | bench/*) ;; # cross compilers, users' flags
        *)
          if [ -z "${SLOW:-}" ] || ! deep "tests/$suite.sh"; then
            export LAGC_OPTIMISE="${LAGC_OPTIMISE:--O0}"
            # Compilers look for `ld` there first: gold links a simulator in half the time.
            [ -z "${LINKER:-}" ] || export COMPILER_PATH="$(pwd)/$BUILD/test/linker${COMPILER_PATH:+:$COMPILER_PATH}"
          fi
          ;;
      esac
      ;;
  esac
  begin=$(seconds)
  timeout -k 5 "$limit" "$@" >"$log" 2>&1 </dev/null
  status=$?
  end=$(seconds)
  times >"$logs/$suite.part" # a line of the shell itself, a line of its children: `0m0.10s 0m0.02s`, user and system
  used=$(awk 'NR == 2 { for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); sum += 60*t[1] + t[2] } printf "%.1f", sum }' "$logs/$suite.part")
  echo "$status $begin $end $used" >"$logs/$suite.part"
  mv "$logs/$suite.part" "$logs/$suite.done"
  exit 0
fi

# ---- selection of suites ----
found() {
  for f in tests/unit/test_*.c tests/fuzz/fuzz_*.c tests/*/*.sh; do
    [ -f "$f" ] || continue
    name=${f#tests/}
    name=${name%.*}
    case $name in
      */lib_*) continue ;;
      bench/*) is=bench ;;
      */long_*) is=long ;;
      *) is='test' ;;
    esac
    if [ "$kind" = bless ]; then
      case $f in *.sh) ;; *) continue ;; esac
      grep -q BLESS "$f" || continue
    elif [ "$is" != "$kind" ]; then
      [ "$kind $is" = 'long test' ] || continue
    fi
    [ $# = 0 ] && echo "$name"
    for prefix; do
      case $name in "$prefix"* | */"$prefix"*)
        echo "$name"
        break
        ;;
      esac
    done
  done
}

# Suites known to take long: they begin first where there is no record of a run.
slow="unit/test_nest unit/test_rt_cost unit/test_lift unit/test_found unit/test_syntax unit/test_rt_energy unit/test_sym exec/random_models \
exec/run_contradictions exec/includes exec/run_scenes exec/run_facts exec/run_modes exec/run_pictures"
[ "$kind" != long ] || slow="$slow exec/run_compilers exec/long_sanitized exec/long_agree exec/long_random exec/long_windows exec/long_lanes exec/run_callbacks \
exec/run_digits exec/long_energy exec/long_ports math/run_math hard/long_hard golden/gallery exec/verify exec/run_lanes exec/long_million hard/long_quad"
[ $# = 0 ] || of_exec=1
suites=$(found "$@" | awk -v k="$of_exec" -v day="${DAY:-0}" '!/^exec\// || (n++ + day) % k == 0')
unknown=
for prefix; do [ -n "$(found "$prefix")" ] || unknown="$unknown $prefix"; done
if [ -n "$unknown" ]; then
  case $kind$unknown in test*long_*) unknown="$unknown (\`make test-long\` has those of long_)" ;; esac
  echo "no suite's name begins with:$unknown"
  exit 1
fi
if [ -z "$suites" ]; then
  echo "0 passed, 0 failed"
  exit 0
fi
if [ "$kind" = bless ]; then
  if [ -n "${CI:-}" ]; then
    echo "bless: not in CI"
    exit 1
  fi
  export BLESS=1
else
  unset BLESS
fi

mkdir -p "$LAG_TREE/share/lagc"
ln -sfn "$(pwd)/models" "$LAG_TREE/share/lagc/models"
ln -sfn "$(pwd)/$BUILD" "$LAG_TREE/lib"
ln -sfn "$(pwd)/runtime/include" "$LAG_TREE/include"

# ---- run them, $JOBS at a time, the slowest first; report in order ----
# The slowest first, as the last run found them, so that none of them is left to run alone; a suite without a record counts as 5 s.
slowest_first() {
  for s in $suites; do
    used=
    [ -f "$logs/$s.done" ] && read -r _ _ _ used <"$logs/$s.done"
    echo "${used:-$(case " $slow " in *" $s "*) echo 30 ;; *) echo 5 ;; esac)} $s"
  done | sort -s -k1,1nr | cut -d ' ' -f 2
}
order=$(slowest_first)
[ "$kind" != long ] || suites=$order
case $kind in 'test' | long) echo "rows of DAY=$DAY" ;; esac
for s in $suites; do rm -f "$logs/$s.done"; done
# shellcheck disable=SC2086 # a list of words
printf '%s\n' $order | xargs -P "$JOBS" -I SUITE sh tests/run.sh --run-one SUITE "$limit" "$logs" &
runner=$!
start=$(date +%s)
trap 'kill "$runner" 2>/dev/null; exit 130' INT TERM

# A suite's log and exit status -> one line `passed failed skipped`, then the lines to show.
# shellcheck disable=SC2016 # awk's own $
judge='
  BEGIN { planned = -1 }
  /^1\.\.[0-9]+/ {
    n = $1; sub(/^1\.\./, "", n)
    planned = (planned < 0 ? 0 : planned) + n
    if (n == 0 && toupper($0) ~ /# *SKIP/) { skipped++; why = $0; sub(/.*# *[Ss][Kk][Ii][Pp] */, "", why); show("skipped: " why); planned++ }
    next
  }
  /^(not )?ok / && toupper($0) ~ /# *SKIP/ {
    skipped++
    why = $0; sub(/^(not )?ok [0-9]* *-? */, "", why)
    name = why; sub(/ *# *[Ss][Kk][Ii][Pp].*/, "", name); sub(/.*# *[Ss][Kk][Ii][Pp] */, "", why)
    reason = (why == "" || why == name) ? name : (name == "" ? why : why " (" name ")")
    if (!(why in told)) show("skipped: " reason)
    told[why] = 1
    failing = 0; next
  }
  /^ok /     { passed++; failing = 0; next }
  /^not ok / { failed++; failing = 1; show($0); next }
  failing    { if (failing++ <= 12) show($0); else if (failing == 14) show("..."); next }
             { other[++nother] = $0 }
  function show(line) { if (nshown < 60) shown[++nshown] = line; else cut = 1 }
  END {
    bad = ""
    results = passed + failed + skipped
    if (status == 124 || status == 137) bad = "stopped: longer than " limit " s"
    else if (status != 0 && !failed) bad = "exit status " status
    else if (planned < 0) bad = results ? "no plan 1..N: it may have stopped early" : "no results"
    else if (planned != results) bad = "the plan says " planned " tests, " results " ran"
    if (bad != "") {
      failed++
      show("not ok - " bad)
      for (i = nother > 40 ? nother - 39 : 1; i <= nother; i++) shown[++nshown] = other[i]
    }
    print passed + 0, failed + 0, skipped + 0
    for (i = 1; i <= nshown; i++) print "    " shown[i]
    if (cut) print "    ..."
    if (failed) print "    (all of it: " log_file ")"
  }'

passed=0
failed=0
skipped=0
for s in $suites; do
  while [ ! -f "$logs/$s.done" ]; do
    if ! kill -0 "$runner" 2>/dev/null && [ ! -f "$logs/$s.done" ]; then
      echo "run.sh: the runner of suites died before $s"
      echo "126 0 0 0" >"$logs/$s.done"
    fi
    sleep 0.05
  done
  read -r status begin end used <"$logs/$s.done"
  took=$(awk -v a="$begin" -v b="$end" 'BEGIN { printf "%.1f", b - a }')
  if [ "$kind" = bench ]; then
    echo "$s ($took s)"
    sed 's/^/    /' "$logs/$s.log"
    [ "$status" = 0 ] && passed=$((passed + 1)) || failed=$((failed + 1))
    continue
  fi
  verdict=$(awk -v status="$status" -v limit="$limit" -v log_file="$logs/$s.log" "$judge" "$logs/$s.log")
  # shellcheck disable=SC2046 # three numbers
  set -- $(printf '%s\n' "$verdict" | head -n 1)
  passed=$((passed + $1))
  failed=$((failed + $2))
  skipped=$((skipped + $3))
  dots=$(printf '%s ........................................' "$s" | cut -c 1-36)
  line="$dots $1 passed"
  [ "$2" = 0 ] || line="$line, $2 FAILED"
  [ "$3" = 0 ] || line="$line, $3 skipped"
  printf '%s  %s s%s\n' "$line" "$took" "${TIMES:+, processor $used s, at $((${end%.*} - start)) s}"
  printf '%s\n' "$verdict" | tail -n +2
done
wait "$runner" 2>/dev/null
# shellcheck disable=SC2086 # a list of words
if [ "$kind" = bench ] && [ "$failed" = 0 ]; then sh tests/bench/lib_results.sh "$logs" $suites && echo 'see tests/bench/RESULTS.md'; fi

[ -z "${TIMES:-}" ] || (cd "$logs" && for s in $suites; do cat "$s.done"; done) | awk '{ sum += $4 } END { printf "processor time of all suites: %.0f s\n", sum }'
line="$passed passed, $failed failed"
[ "$skipped" = 0 ] || line="$line, $skipped skipped"
[ "$of_exec" = 1 ] || echo "of the suites of exec/ one in $of_exec, others each day: \`make test T=exec\` and \`make test-long\` run them all"
echo "$line"
[ "$failed" = 0 ]
