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
check "nests whose rows are longer than a block" functions models/lennard_jones.lag -D N=80
# A coefficient 4 i of a loop over i is no power of two, though that of its first turn, 8, is one.
cat >"$TMP/index.lag" <<'END'
model index
const N = 200
coord x[N]
kinetic = sum(i in 1..N, x[i]'^2/2)
potential = sum(i in 1..N, sum(j in 1..i-1, i*(x[i] - x[j])^2/(j + 1))) + sum(i in 1..N, i*x[i]^4)
scene s { start x[i in 1..N] = 0.001*i; span 0.1 }
END
check "numbers that turns of a loop multiply" functions "$TMP/index.lag"
for model in models/*.lag; do
  case $model in
    */double_pendulum.lag) one_of 2 && check "functions of $model" functions "$model" --method taylor --with linear ;;
    *) one_of 40 && light "$model" && check "functions of $model" functions "$model" --method taylor --with linear ;;
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

# Without any compiler in PATH: README's commands and others print the same, but for times.
mkdir "$TMP/tools"
for tool in sh grep sed; do ln -s "$(command -v $tool)" "$TMP/tools/$tool"; done
case $LAGC in /*) there=$LAGC ;; *) there=$(pwd)/$LAGC ;; esac
commands() {
  sed -n 's/^\$ build\/lagc \(header\|build\) .*//; s/^\$ build\/lagc //p' README.md
  echo plot models/pendulum.lag -o plot.svg
  echo modes models/double_pendulum.lag
  echo lyapunov models/double_pendulum.lag --until 5
  echo orbit models/pendulum.lag
  echo effects models/projectile_world.lag gusty --json
  echo "sweep models/pendulum.lag th=0.1..1:5 --quiet -o sweep.csv"
}
commands >"$TMP/commands"
by() { # by FOLDER PATH CC: what the commands print and write
  mkdir "$TMP/$1" && ln -s "$(pwd)/models" "$TMP/$1/models"
  while read -r command; do
    (cd "$TMP/$1" && PATH=$2 CC=$3 sh -c "$there $command" 2>>errors) || echo "failed: $command"
  done <"$TMP/commands" | sed 's/, [0-9.e-]* s$//; s/time_s": [0-9.e-]*//g' >"$TMP/$1/printed"
}
by with "$PATH" "$CC"
by without "$TMP/tools" no-compiler
is "no command fails" "" "$(grep failed "$TMP/without/printed")"
check "the same is printed without a compiler" diff "$TMP/with/printed" "$TMP/without/printed"
for file in motion.csv plot.svg chaos.html motion.svg; do check "and written: $file" cmp "$TMP/with/$file" "$TMP/without/$file"; done
# Lanes have sines of their own, which the motion of a libration over 10 periods makes no more than the tolerance, 1e-11, times a hundred.
near() { paste -d , "$1" "$2" | awk -F , 'NR > 1 { for (i = 1; i < 4; i++) if (($i - $(i + 4))^2 > 1e-18) exit 1; n++ } END { exit n != 5 }'; }
check "and a sweep, whose rows are those of runs in lanes up to roundings" near "$TMP/with/sweep.csv" "$TMP/without/sweep.csv"

# Compilers that link no libgcc: tcc.
empty "liblag asks for no symbols of gcc's own library" "$(nm -u "$BUILD/liblag.a" 2>/dev/null | grep __cpu_)"
if command -v tcc >/dev/null; then
  by_tcc() {
    CC=tcc "$LAGC" run models/bouncing_ball.lag --compile always --quiet -o "$TMP/tcc.csv" && "$LAGC" run models/bouncing_ball.lag --compile never --quiet -o "$TMP/never.csv" &&
      cmp "$TMP/tcc.csv" "$TMP/never.csv" && CC=tcc "$LAGC" build models/pendulum.lag --shared -o "$TMP/libtcc.so"
  }
  check "tcc compiles simulators and libraries" by_tcc
else
  skip "tcc compiles simulators and libraries" "tcc is not installed"
fi

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
