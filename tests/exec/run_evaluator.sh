#!/bin/sh
# Models that are evaluated, not compiled: functions and rows have the bits of compiled ones; no compiler is called; damaged bytes are refused or run,
# under sanitizers.
. tests/tap.sh
LAGC_OPTIMISE=-O0 # the same bits as at -O2: exec/run_probe
export LAGC_OPTIMISE
san=${LAGC_SAN:+$(dirname "$LAGC_SAN")}
"$CC" -std=c11 -O1 -D_GNU_SOURCE -Iruntime/include -Iruntime -o "$TMP/evaluator" tests/exec/evaluator.c "$BUILD/liblag.a" -ldl -lm || exit 1

# functions MODEL WORD...: every function of every scene at random states
functions() {
  model=$1
  shift
  "$LAGC" build "$model" "$@" --bytes -o "$TMP/bytes" && "$LAGC" build "$model" "$@" --shared -o "$TMP/model.so" && "$TMP/evaluator" "$TMP/bytes" "$TMP/model.so" 12
}
check "functions of models/lennard_jones.lag with nests of loops" functions models/lennard_jones.lag -D N=14 --method taylor
for model in models/*.lag; do
  case $model in
    */double_pendulum.lag) one_of 2 && check "functions of $model" functions "$model" --method taylor --with derivatives ;;
    *) one_of 40 && light "$model" && check "functions of $model" functions "$model" --method taylor --with derivatives ;;
  esac
  [ -z "${SLOW:-}" ] || { one_of 4 && check "functions of $model, with derivatives of L" functions "$model" --method variational; }
done

# rows MODEL SCENE: the same rows, compiled and evaluated
rows() {
  for how in always never; do "$LAGC" run "$1" "$2" --compile $how --quiet -o "$TMP/$how.csv" >"$TMP/$how.out" 2>&1; echo $? >>"$TMP/$how.out"; done
  cmp "$TMP/always.csv" "$TMP/never.csv" && cmp "$TMP/always.out" "$TMP/never.out"
}
for model in models/*.lag; do
  for scene in $(sed -n 's/^scene \([a-zA-Z0-9_]*\).*/\1/p' "$model"); do
    one_of 120 && light "$model" && check "rows of $model, scene $scene" rows "$model" "$scene"
  done
done

# Without a compiler, and without one in the cache: the report but for its time, and one line that says so.
report() { sed 's/, [0-9.e-]* s$//'; }
export XDG_CACHE_HOME="$TMP/cache" && mkdir -p -m 700 "$XDG_CACHE_HOME"
"$LAGC" run models/pendulum.lag th=0.5 --compile never 2>"$TMP/err" | report >"$TMP/never"
is "--compile never: nothing is said beside the report" "" "$(cat "$TMP/err")"
is "and nothing compiled" "" "$(find "$XDG_CACHE_HOME" -type f ! -name "*.run" ! -name "*.bytes")"
CC=/no/compiler "$LAGC" run models/pendulum.lag th=0.5 2>"$TMP/err" | report >"$TMP/auto"
check "without a compiler the report is the same" cmp "$TMP/never" "$TMP/auto"
is "one line says that there is none" 1 "$(grep -c 'there is no C compiler `/no/compiler`' "$TMP/err")"
"$LAGC" run models/pendulum.lag th=0.5 --compile always | report >"$TMP/always"
check "compiled, too" cmp "$TMP/never" "$TMP/always"
"$LAGC" run models/pendulum.lag --compile never --precision long >/dev/null 2>"$TMP/err"
is "other numbers than doubles need the compiler" "lagc: --compile never evaluates doubles only: leave --precision out" "$(cat "$TMP/err")"

# A run of some seconds changes over to what was compiled beside it; nobody can see where.
changes_over() {
  "$LAGC" run models/double_pendulum.lag --until 20000 --every 1 --quiet -o "$TMP/auto.csv" && "$LAGC" run models/double_pendulum.lag --until 20000 --every 1 --compile never --quiet -o "$TMP/never.csv" &&
    cmp "$TMP/auto.csv" "$TMP/never.csv" && [ -n "$(find "$XDG_CACHE_HOME" -type f)" ]
}
slow check "rows of a run that changes over" changes_over

# Bytes cut short, or with changed bits, bytes and words.
"$LAGC" build models/bouncing_ball.lag --bytes -o "$TMP/ball"
"$LAGC" build models/lennard_jones.lag -D N=14 --method taylor --bytes -o "$TMP/nests"
if [ -n "$san" ]; then
  # shellcheck disable=SC2086 # flags
  "$CC" -std=c11 $SAN_FLAGS -D_GNU_SOURCE -Iruntime/include -Iruntime -o "$TMP/sanitized" tests/exec/evaluator.c "$san/liblag.a" -ldl -lm || exit 1
else
  cp "$TMP/evaluator" "$TMP/sanitized"
fi
check "damaged bytes of a model with events" "$TMP/sanitized" "$TMP/ball" - "${SLOW:+20}200"
check "damaged bytes of a model with nests and series" "$TMP/sanitized" "$TMP/nests" - "${SLOW:+20}100"
printf 'no program' >"$TMP/text"
LAG_PROGRAM=$TMP/text "$BUILD/lag-run" >/dev/null 2>"$TMP/err"
is "a text is no program" "lag-run: $TMP/text: these bytes are no program" "$(cat "$TMP/err")"
tap_end
