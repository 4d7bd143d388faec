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
check "functions of a sum by a tree" functions tests/golden/ok/far.lag -D N=60
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
# Compilers fold calls on constants, and round cbrt(7) and sinh(2) correctly, the C library in the last digit not.
cat >"$TMP/constants.lag" <<'END'
model constants
coord x
param P = 2*sinh(2)
lagrangian = x'^2/2 - (cbrt(7) + 10^(1/3) + cosh(3))*x^2/2 + P*x
event at: x - 2^(1/3) falling { x' = tan(2)*x' }
scene s { start x = 0.3; span 1; output x, sinh(1)*x, hypot(2, 3)*x, atan2(1, 3)*x, tanh(0.3)*exp(x) }
END
check "functions of constants" functions "$TMP/constants.lag"
for model in models/*.lag; do
  case $model in
    */double_pendulum.lag) one_of 2 && check "functions of $model" functions "$model" --method taylor --with derivatives ;;
    *) one_of 40 && light "$model" && check "functions of $model" functions "$model" --method taylor --with derivatives ;;
  esac
  [ -z "${SLOW:-}" ] || { one_of 4 && light "$model" && check "functions of $model, with derivatives of L" functions "$model" --method variational; }
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
# 2 x'^2 of the condition on accelerations stands in the force, too, and is read again by the solver after other values.
echo "model parabola; coord x, z; lagrangian = (x'^2 + z'^2)/2; constraint on: z = x^2; force x = exp(-2*x'^2)*sqrt(1 + x^2)
scene s { start x = 0.3, x' = 1.5; span 1; method rk4; output x, z }" >"$TMP/parabola.lag"
for how in never always; do "$LAGC" run "$TMP/parabola.lag" --compile $how --quiet -o "$TMP/parabola_$how.csv"; done
check "a value that a force and the solver share" cmp "$TMP/parabola_never.csv" "$TMP/parabola_always.csv"

# The cache's entry and its bytes, when only one of them was written; and another lagc of the same name, size and time.
halves() {
  printf 'model halves\ninclude "k.lag"\ncoord x\nlagrangian = x%s^2/2 - k*x^2/2\nscene s { start x = 1; span 1; output x }\n' "'" >"$TMP/halves.lag"
  export XDG_CACHE_HOME="$TMP/halves" && mkdir -m 700 "$XDG_CACHE_HOME" || return 1
  for k in 1 2 1; do
    echo "let k = $k" >"$TMP/k.lag"
    [ ! -e "$TMP/entry.run" ] || [ $k = 2 ] || cp "$TMP/entry.run" "$XDG_CACHE_HOME"/lagc/*.run
    "$LAGC" run "$TMP/halves.lag" --compile never --quiet -o "$TMP/halves.csv" || return 1
    [ $k = 2 ] || [ -e "$TMP/first.csv" ] || { cp "$TMP/halves.csv" "$TMP/first.csv" && cp "$XDG_CACHE_HOME"/lagc/*.run "$TMP/entry.run"; }
  done
  cmp "$TMP/first.csv" "$TMP/halves.csv"
}
check "bytes of another entry are not evaluated" eval '(halves)'
another() {
  export XDG_CACHE_HOME="$TMP/another" LAG_HOME="$TMP/home" && mkdir -m 700 "$XDG_CACHE_HOME" "$LAG_HOME" || return 1
  ln -s "$(cd "$BUILD" && pwd)" "$LAG_HOME/lib" && ln -s "$(pwd)/runtime/include" "$LAG_HOME/include" || return 1
  for _ in 1 2; do
    cp "$LAGC" "$TMP/lagc_new" && touch -r "$LAGC" "$TMP/lagc_new" && mv "$TMP/lagc_new" "$TMP/lagc" || return 1
    "$TMP/lagc" run models/pendulum.lag --compile never --quiet -o "$TMP/another.csv" || return 1
  done
  [ "$(find "$XDG_CACHE_HOME" -name '*.run' | wc -l)" = 2 ]
}
check "another lagc of the same size and time" eval '(another)'
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
  echo modes models/guiding_centre.lag
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
near_rows() { paste -d , "$1" "$2" | awk -F , 'NR > 1 { for (i = 1; i < 4; i++) if (($i - $(i + 4))^2 > 1e-18) exit 1; n++ } END { exit n != 5 }'; }
check "and a sweep, whose rows are those of runs in lanes up to roundings" near_rows "$TMP/with/sweep.csv" "$TMP/without/sweep.csv"

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

# Runs whose reader waits after a row until a compiler has ended beside them, and so change over near that row: nobody can see where. A pipe holds
# 64 kB; the library is looked for once in 256 steps.
slow_run() { # CC ROW MODEL SCENE DONE: the rows in $TMP/slow.csv; DONE: a command that succeeds once the wait is over, 20 s at most
  { # files of 32 kB at most, where the disk is full: less than a library
    case $1 in *full) trap '' XFSZ && ulimit -f 64 ;; esac
    CC=$1 exec "$LAGC" run "$3" "$4" --method rk4 --step 1e-3 --every 1e-3 --until 6 --quiet -o - 2>"$TMP/slow.err"
  } | awk -v row="$2" -v wait="i=0; until $5 || [ \$i = 100 ]; do sleep 0.2; i=\$((i + 1)); done" '{ print } NR == row { system(wait) }' >"$TMP/slow.csv"
}
has_library="find '$XDG_CACHE_HOME' -type f -size +8k ! -name '*.bytes' ! -path '*lagc-build*' | grep -q ."
same_rows() { "$LAGC" run "$1" "$2" --method rk4 --step 1e-3 --every 1e-3 --until 6 --quiet --compile never -o "$TMP/never.csv" && cmp "$TMP/slow.csv" "$TMP/never.csv"; }
changes_over() { # MODEL SCENE ROW
  rm -rf "$XDG_CACHE_HOME"
  mkdir -m 700 "$XDG_CACHE_HOME"
  slow_run "$CC" "$3" "$1" "$2" "$has_library" && sh -c "$has_library" && same_rows "$1" "$2"
}
day=${DAY:-0}
for model in double_pendulum lorenz slider_crank kepler stick_slip magnetic_pendulum; do
  scene=$(sed -n 's/^scene \([a-zA-Z0-9_]*\).*/\1/p' models/$model.lag | head -n 1)
  row=$(((day * 977 + ${#model} * 131) % 1500 + 1))
  one_of 6 && check "models/$model.lag changes over after row $row" changes_over "models/$model.lag" "$scene" "$row"
done

# A run of a few steps that take long looks for the library, too, not once in 256 steps; a wrong path shows it.
looks_early() {
  "$LAGC" build tests/bench/models/bodies.lag -D N=400 --bytes -o "$TMP/early.bytes" && echo /no/library >"$TMP/early" || return 1
  LAG_PROGRAM="$TMP/early.bytes" LAG_COMPILED=5 "$BUILD/lag-run" --until 0.01 --every 0.01 --quiet -o "$TMP/early.csv" 5<"$TMP/early" 2>"$TMP/err"
  grep 'the C compiler failed' "$TMP/err"
}
check "a few long steps change over" looks_early
# Steps that take longer than the compiler are compiled before they begin.
compiles_first() {
  rm -rf "$XDG_CACHE_HOME"
  mkdir -m 700 "$XDG_CACHE_HOME"
  for how in never auto; do
    "$LAGC" run tests/bench/models/bodies.lag -D N=700 --until 0.001 --every 0.001 --compile $how --quiet -o "$TMP/$how.csv" || return 1
    [ $how = auto ] || find "$XDG_CACHE_HOME" -type f -delete
  done
  cmp "$TMP/never.csv" "$TMP/auto.csv" && sh -c "$has_library" && ! find "$XDG_CACHE_HOME" -name '*.bytes' | grep .
}
check "a run of long steps is compiled first, with the same bits" compiles_first

# Options of CC that let sines use fused multiply-adds change nothing, either.
if "$CC" -march=native -dM -E -x c /dev/null 2>/dev/null | grep -q __FMA__; then
  fused() { (CC="$CC -march=native" && changes_over models/double_pendulum.lag swing 50); }
  one_of 3 && check "a change-over to C with fused multiply-adds" fused
fi

# Compilers that fail, hang, write rubbish, or have no room: the run goes on, and the next one begins.
fake() { # NAME COMMANDS
  printf '#!/bin/sh\nstarted="%s/started"\n%s\n' "$TMP" "$2" >"$TMP/$1" && chmod +x "$TMP/$1"
}
fake fails 'echo $$ >>"$started"; exit 1'
fake hangs '[ ! -e "$started.over" ] || exit 1; echo $$ >>"$started"; exec sleep 30'
fake full 'echo $$ >>"$started"; exec '"$CC"' "$@"'
fake rubbish 'while [ $# -gt 0 ]; do [ "$1" != -o ] || echo rubbish >"$2"; case $2 in *library.so) echo $$ >"$started" ;; esac; shift; done'
has_started="[ -s '$TMP/started' ]"
goes_on() {
  rm -f "$TMP/started" "$TMP/started.over"
  for again in 1 2; do
    slow_run "$TMP/$1" 300 models/double_pendulum.lag swing "$has_started"
    [ -s "$TMP/started" ] && same_rows models/double_pendulum.lag swing || return 1
    sleep 0.5 # what was written goes to the cache
  done
  : >"$TMP/started.over" # those that still hang end, and no others begin
  [ "$1" != hangs ] || while read -r pid; do kill "$pid"; done <"$TMP/started"
}
for cc in fails hangs rubbish full; do
  one_of 4 && check "the compiler beside the run: $cc" goes_on "$cc"
done

# No room to compile: the message has a way out.
mkdir -m 700 "$TMP/no_room"
way_out() {
  (trap '' XFSZ && ulimit -f 0 && XDG_CACHE_HOME=$TMP/no_room "$LAGC" run models/pendulum.lag th=0.4321 --compile always 2>&1 | cat) |
    grep -q '^lagc: cannot write in .*; make room, or set XDG_CACHE_HOME to another folder$'
}
check "a full disk: where else to compile" way_out

# Bytes cut short, or with changed bits, bytes and words.
"$LAGC" build models/bouncing_ball.lag --bytes -o "$TMP/ball"
"$LAGC" build models/lennard_jones.lag -D N=14 --method taylor --bytes -o "$TMP/nests"
if [ -n "$san" ]; then
  # shellcheck disable=SC2086 # flags
  "$CC" -std=c11 $SAN_FLAGS -D_GNU_SOURCE -Iruntime/include -Iruntime -o "$TMP/sanitized" tests/exec/evaluator.c "$san/liblag.a" -ldl -lm || exit 1
else
  cp "$TMP/evaluator" "$TMP/sanitized"
fi
LAG_COMPILED=9 LAG_PROGRAM=$TMP/ball "$BUILD/lag-run" --method rk4 --step 1e-3 --quiet 9</dev/null 2>"$TMP/err"
is "a compiler that ends without a library" "lag-run: the C compiler failed, so the run was evaluated; \`lagc build\` prints its messages" "$(cat "$TMP/err")"
check "damaged bytes of a model with events" "$TMP/sanitized" "$TMP/ball" - "$(depth 200 2000 20000)"
"$LAGC" build tests/golden/ok/far.lag -D N=60 --bytes -o "$TMP/tree"
check "damaged bytes of a model with a sum by a tree" "$TMP/sanitized" "$TMP/tree" - "$(depth 50 500 2000)"
cat >"$TMP/pile.lag" <<'END'
model pile
const N = 6
coord r[N]: vec2
param R[N] = {0.05, 0.06, 0.07, 0.05, 0.06, 0.07} > 0
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2 - 9.81*r[i].y)
contact hit[i in 1..N, j in near(i, 0.14)]: norm(r[i] - r[j]) >= R[i] + R[j], restitution = 0.3
contact floor[i in 1..N]: r[i].y >= R[i], restitution = 0.3, friction = 0.2, slip = r[i].x'
scene s { start r[i in 1..N] = (0.2*i, 0.2*i); span 0.5; method moreau(step = 0.002); output r }
END
check "functions of families of contacts" functions "$TMP/pile.lag"
"$LAGC" build "$TMP/pile.lag" --bytes -o "$TMP/pile"
check "damaged bytes of a model with families of contacts" "$TMP/sanitized" "$TMP/pile" - "$(depth 50 500 2000)"
check "damaged bytes of a model with nests and series" "$TMP/sanitized" "$TMP/nests" - "$(depth 100 1000 20000)"
# Operations of a dense mass matrix of 2000 coordinates, 2^31 and more: the counter is full.
cat >"$TMP/dense.lag" <<'END'
model dense
const N = 2000
coord x[N]
param m = 1 > 0
kinetic = sum(i in 1..N, m*x[i]'^2) + sum(i in 1..N-1, m/4*x[i]'*x[i+1]')
END
"$LAGC" build "$TMP/dense.lag" --bytes -o "$TMP/dense"
LAG_PROGRAM=$TMP/dense "$BUILD/lag-run" m=-1 >/dev/null 2>"$TMP/err"
is "more operations than are counted are no damage" "lag-run: m = -1: the model declares m > 0" "$(cat "$TMP/err")"
printf 'no program' >"$TMP/text"
LAG_PROGRAM=$TMP/text "$BUILD/lag-run" >/dev/null 2>"$TMP/err"
is "a text is no program" "lag-run: $TMP/text: these bytes are no program" "$(cat "$TMP/err")"
tap_end
