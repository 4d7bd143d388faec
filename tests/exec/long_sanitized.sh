#!/bin/sh
# Gallery models (`make test-all`: each), with a compiler and a runtime under sanitizers: by check, derive, noether, header, emit and run, and by a third of all else, in turns; then
# the golden suites, as deep as in `make test` (half of the refused models), with this compiler.
. tests/exec/lib_sanitized.sh
# Two at a time.
if [ -n "${1:-}" ]; then
  turn=$2
  every_command "$1" >"$TMP/$(basename "$1").wrong"
  exit
fi
models=
for m in models/*.lag; do one_of 32 && models="$models $m"; done
n=${DAY:-0}
for m in $models; do echo "$m $((n += 1))"; done | xargs -P 2 -n 2 sh tests/exec/long_sanitized.sh
for m in $models; do empty "$(basename "$m" .lag)" "$(cat "$TMP/$(basename "$m").wrong" 2>&1)"; done
for suite in golden/run_eqns golden/run_errors golden/run_expect golden/run_syntax golden/run_language golden/run_messages; do
  # shellcheck disable=SC2016,SC2046 # no word, or three
  check "$suite, by this compiler" env $(depth "" "-u SLOW PART=2" "") LAGC="$LAGC_SAN" LAG_HOME="$LAG_TREE" TMP="$TMP/$suite" sh -c 'mkdir -p "$TMP"; out=$(sh "tests/$0.sh"); code=$?; printf "%s\n" "$out" | grep -A 20 "^not ok"; exit $code' "$suite"
done
tap_end
