#!/bin/sh
# Taylor coefficients in emitted code: every function against digits of mpmath, every model against its own accelerations, in
# several precisions; and the method `taylor`, which uses them.
. tests/tap.sh

here=tests/exec/taylor
models=
for m in models/*.lag tests/exec/models/*.lag; do
  case $m in *mutants*) continue ;; esac # they share names with other models
  self_contained "$m" && models="$models $m"
done
[ -n "${SLOW:-}" ] || models=$(printf "%s\n" $models | grep '/double_pendulum.lag\|/kepler\|kapitza\|slider_crank\|motor\|room\|tables\|rolling_ball\|functions\|powers')
longer() { # MODEL N: a long family, whose recurrences are loops
  sed "s/^const N = .*/const N = $2/; s/^model $1/model $1_$2/; s/ b = 0 / b = 0.3 /" "models/$1.lag" >"$TMP/$1_$2.lag"
  models="$models $TMP/$1_$2.lag"
}
longer chain 120
longer string 400
name_of() { sed -n 's/^model \([^ ]*\).*/\1/p' "$1"; }
gcc=
for c in "$CC" gcc; do "$c" --version 2>/dev/null | grep -q 'Free Software' && gcc=$c && break; done
echo '#include <quadmath.h>' >"$TMP/quad.h"
quad=
[ -n "$gcc" ] && echo 'int main(void) { return 0; }' | "$gcc" -include "$TMP/quad.h" -x c - -lquadmath -o "$TMP/quad" 2>/dev/null && quad=yes

# build PRECISION FILES... -o PROGRAM
build() {
  precision=$1
  shift
  case $precision in
    double) "$CC" -std=c11 "${optimise:--O1}" -ffp-contract=off -I"$INC" "$@" -lm ;;
    long) "$CC" -std=c11 "${optimise:--O1}" -ffp-contract=off -I"$INC" -DREAL_LONG '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L' "$@" -lm ;;
    quad) "$gcc" -std=gnu11 "${optimise:--O1}" -ffp-contract=off -I"$INC" -include "$TMP/quad.h" -DREAL_QUAD -DLAG_REAL=__float128 '-DLAG_FN(x)=x##q' \
      '-DLAG_C(x)=x##Q' "$@" -lquadmath -lm ;;
  esac
}

# ---- every function
digits() { # PRECISION FILE.c
  build "$1" "$2" $here/coefficients.c -o "$TMP/digits" && "$TMP/digits" $here/functions.expected
}
"$LAGC" emit $here/functions.lag --method taylor -o "$TMP/functions.c"
for p in double ${SLOW:+long} ${quad:+quad}; do check "every function, its coefficients: $p" digits "$p" "$TMP/functions.c"; done
[ -n "$quad" ] || skip "every function, its coefficients: quad" "there is no libquadmath"
sed 's/\*per_order//' "$TMP/functions.c" >"$TMP/wrong.c"
wrong_digits() { ! cmp "$TMP/functions.c" "$TMP/wrong.c" && build double "$TMP/wrong.c" $here/coefficients.c -o "$TMP/digits" && ! "$TMP/digits" $here/functions.expected; }
check "this test sees a recurrence that lacks a factor" wrong_digits

# ---- every model
mkdir -p "$TMP/c"
{
  echo '#include "lag_model.h"'
  for m in $models; do
    n=$(name_of "$m")
    "$LAGC" emit "$m" --method taylor -o "$TMP/c/$n.c"
    sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP/c/$n.c"
  done
  echo 'extern const lag_scene *const all_scenes[];'
  echo 'const lag_scene *const all_scenes[] = {'
  for m in $models; do sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP/c/$(name_of "$m").c"; done
  echo '  0};'
} >"$TMP/c/scenes.c"
defects() { # PRECISION; compiling takes longer than running
  optimise=${LAGC_OPTIMISE:-}
  build "$1" "$TMP"/c/*.c $here/defect.c -o "$TMP/defect" && "$TMP/defect" >"$TMP/defect.txt" || { cat "$TMP/defect.txt"; return 1; }
}
p=${SLOW:+${quad:+quad}} # in `make test`, in long doubles
check "models: their polynomials solve the equations, to their order" defects "${p:-long}"
mkdir -p "$TMP/wrong"
wrong_defect() { # a wrong sign in one recurrence of the double pendulum must show
  sed '/^static .*taylor_next(/,/^}/s/ - c\[/ + c[/' "$TMP/c/double_pendulum.c" >"$TMP/wrong/model.c" && ! cmp "$TMP/c/double_pendulum.c" "$TMP/wrong/model.c" &&
    echo '#include "lag_model.h"
      extern const lag_scene double_pendulum_swing, *const all_scenes[];
      const lag_scene *const all_scenes[] = {&double_pendulum_swing, 0};' >"$TMP/wrong/scenes.c" &&
    build "${p:-long}" "$TMP/wrong/model.c" "$TMP/wrong/scenes.c" $here/defect.c -o "$TMP/defect_wrong" && ! "$TMP/defect_wrong"
}
check "this test sees a wrong sign" wrong_defect
wrong_place() { # a loop that reads its neighbours' constants must show
  sed '/^static .*taylor_next(/,/^}/s/ = c\[3\*k + 5\];/ = c[3*k + 8];/' "$TMP/c/string_400.c" >"$TMP/wrong/model.c" && ! cmp "$TMP/c/string_400.c" "$TMP/wrong/model.c" &&
    echo '#include "lag_model.h"
      extern const lag_scene string_400_mode, *const all_scenes[];
      const lag_scene *const all_scenes[] = {&string_400_mode, 0};' >"$TMP/wrong/scenes.c" &&
    build "${p:-long}" "$TMP/wrong/model.c" "$TMP/wrong/scenes.c" $here/defect.c -o "$TMP/defect_wrong" && ! "$TMP/defect_wrong"
}
check "this test sees a loop that reads what stands one further" wrong_place
short() { # MODEL N: four times the length gives the same amount of C, apart from digits of numbers
  for n in "$2" $((4 * $2)); do "$LAGC" emit "models/$1.lag" -D N="$n" --method taylor -o "$TMP/size$n.c" || return 1; done
  [ "$(wc -c <"$TMP/size$((4 * $2)).c")" -lt $(($(wc -c <"$TMP/size$2.c") * 11 / 10)) ] || { wc -c "$TMP/size$2.c" "$TMP/size$((4 * $2)).c"; return 1; }
}
check "a string of any length has recurrences of the same length" short string 400
constrained=$(grep -l '^  .constraints = &' "$TMP"/c/*.c | sed 's/.*\///; s/\.c$//')
check "some of these models have constraints" [ "$(echo "$constrained" | wc -l)" -gt 1 ]
# `if`, friction, min; the brachistochrone's sqrt(1/y) derived is 1/abs(y)
not_analytic="motor room tables ${SLOW:+block brachistochrone coulomb_oscillator coupled_clutches falling_cat quarter_car rocket shaken_frame stick_slip}"
# shellcheck disable=SC2086 # lists
is "models with constraints have none, nor those that are not analytic: if, and a table" "$(printf 'without: %s\n' $constrained $not_analytic | sort -u)" \
  "$(grep without "$TMP/defect.txt" | sort -u)"

# ---- pairs and fours
mkdir -p "$TMP/narrow"
for n in double_pendulum ${SLOW:+chain_120 kepler outer_planets swinging_atwood}; do # products, squares, and loops
  sed 's/defined(__x86_64__)/0/' "$TMP/c/$n.c" >"$TMP/narrow/$n.c"
  sed -n 's/^const lag_scene \(.*\) = {/\1/p' "$TMP/narrow/$n.c" | head -n 1
done >"$TMP/narrow/names"
{
  echo '#include "lag_model.h"'
  sed 's/.*/extern const lag_scene &;/' "$TMP/narrow/names"
  echo 'extern const lag_scene *const all_scenes[]; const lag_scene *const all_scenes[] = {'
  sed 's/.*/  \&&,/' "$TMP/narrow/names"
  echo '0};'
} >"$TMP/narrow/scenes.c"
bits() { # OUT FILES... with the scenes
  out=$1
  shift
  "$CC" -std=c11 -O2 -ffp-contract=off -I"$INC" "$@" "$TMP/narrow/scenes.c" $here/bits.c -lm -o "$TMP/bits" && "$TMP/bits" >"$out"
}
narrow_files() { for f in "$TMP"/narrow/*.c; do [ "$f" = "$TMP/narrow/scenes.c" ] || echo "$f"; done; }
wide_files() { for f in $(narrow_files); do echo "$TMP/c/${f##*/}"; done; }
same_bits() {
  # shellcheck disable=SC2046 # a list of files
  bits "$TMP/narrow.txt" $(narrow_files) && bits "$TMP/wide.txt" $(wide_files) && [ "$(wc -l <"$TMP/wide.txt")" -gt 40 ] &&
    cmp "$TMP/narrow.txt" "$TMP/wide.txt"
}
if grep -qs '^flags.* avx2' /proc/cpuinfo; then check "two or four numbers side by side: the same bits" same_bits
else skip "two or four numbers side by side: the same bits" "not on this processor"; fi

# ---- the method
mkdir -p "$TMP/r"
for m in "models/pendulum.lag wide" "models/double_pendulum.lag swing" "models/kepler.lag orbit" "models/bouncing_ball.lag drop" \
  "tests/hard/cases/kepler_e0_6.lag go" "$here/gap.lag go"; do
  # shellcheck disable=SC2086 # two words
  set -- $m
  "$LAGC" emit "$1" "$2" --method taylor -o "$TMP/r/$(basename "$1" .lag).c"
done
check "runs.c compiles" "$CC" -std=c11 -O1 -ffp-contract=off -I"$INC" "$TMP"/r/*.c $here/runs.c "$BUILD/liblag.a" -lm -o "$TMP/runs"
relay "$TMP/runs"

run() { "$LAGC" run "$@" >"$TMP/out" 2>"$TMP/err"; }
refused() { # WORDS ARGS...
  words=$1
  shift
  run "$@"
  [ $? = 2 ] && grep -qF -e "$words" "$TMP/err" || { cat "$TMP/out" "$TMP/err"; return 1; }
}
failed() { # WORDS ARGS...
  words=$1
  shift
  run "$@"
  [ $? = 3 ] && grep -q -e "$words" "$TMP/out" "$TMP/err" || { cat "$TMP/out" "$TMP/err"; return 1; }
}
printf '0,0\n1,1\n2,0\n' >"$TMP/gust.csv"
cat >"$TMP/table.lag" <<'EOF'
model table
coord x
input u = "gust.csv"
lagrangian = x'^2/2
force x = u
scene run { span 2 [s] }
EOF
printf '%s\n' 'model cut' 'coord x, y' "lagrangian = (x'^2 + y'^2)/2 - x^2/2 - y^2" 'force x = 0.3*atan2(y, x)' 'scene s { start x = 1; span 1 }' >"$TMP/cut.lag"
check "so is an angle that may pass its cut" refused "atan2 and tables; dop853" "$TMP/cut.lag" --method taylor
check "if, abs, sign, min, max are refused, and dop853 is named" refused "without if, abs, sign, min, max, atan2 and tables; dop853" tests/exec/models/motor.lag --method taylor
without() {
  "$LAGC" build models/pendulum.lag --method dop853 -o "$TMP/sim" && ! "$TMP/sim" --method taylor 2>"$TMP/err" && grep -q 'lagc run MODEL --method taylor' "$TMP/err" &&
    "$LAGC" build models/pendulum.lag --method taylor -o "$TMP/sim" && "$TMP/sim" --method taylor --quiet --until 1
}
check "a simulator that was built without series says how to build it" without
check "a collision ends the run: when, and why" failed 't = 1.1107.*step became too small' $here/fall.lag --method taylor
check "an order that is too high" refused "order = 99: it is a whole number from 0 to" models/pendulum.lag --method "taylor(order=99)"
check "an order that is no whole number" refused "order = 2.5: it is a whole number" models/pendulum.lag --method "taylor(order=2.5)"
check "a table: the message says that tables are the reason" refused "and tables" "$TMP/table.lag" --method taylor
final() { sed -n "s/^  $1  *\([^ ]*\).*/\1/p" "$TMP/out"; }
near() { awk -v x="$1" -v y="$2" 'BEGIN { d = x - y; exit !(d < 1e-14 && d > -1e-14) }'; }
inputs() { # x' = 3 sin(2 t), and x' = 2 where a constant replaces the formula
  run $here/driven.lag --method taylor --tol 1e-15 --until 1 && near "$(final x)" 2.1242202548207136 &&
    run $here/driven.lag F=2 --method taylor --tol 1e-15 --until 1 && near "$(final x)" 2
}
check "an input: along its formula, and held" inputs
# Tolerances are relative for a state above 1: an amplitude of a million acts like an amplitude of 1 in other units, up to the floor of 1.
calls() { run "$TMP/oscillator.lag" "x=$1" --method taylor && sed -n 's/.*right-hand sides \([0-9]*\).*/\1/p' "$TMP/out"; }
other_unit() {
  printf 'model oscillator\ncoord x\nlagrangian = (x%s^2 - x^2)/2\nscene s { start x = 1; span 20; tolerance 1e-8 }\n' "'" >"$TMP/oscillator.lag"
  one=$(calls 1) million=$(calls 1e6)
  [ "$million" -gt 0 ] && [ "$((2 * million))" -le "$((3 * one))" ] || { echo "$one $million"; return 1; }
}
check "a state of a million takes as many steps as one of 1" other_unit
tap_end
