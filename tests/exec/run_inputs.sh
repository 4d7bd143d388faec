#!/bin/sh
# Inputs: tables, formulas and constants, in scenes and on the command line; functions of the program around a model.
# Expected values are closed forms.
cd "$(dirname "$0")/../.." || exit 2
: "${LAGC:=build/lagc}" "${INC:=runtime/include}" "${LIBLAG:=build/liblag.a}" "${LIBS:=-lm}" "${CC:=cc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
dir=$TMP/inputs
mkdir -p "$dir/data"

# last MODEL ARGUMENTS...: the final value of x
last() { "$LAGC" run "$@" --json 2>"$dir/err" | sed -n 's/.*"final": {"x": \([-0-9.e+]*\).*/\1/p'; }
# near_rates MODEL: the output `rate` is 0.2 cos t at each row
near_rates() { "$LAGC" run "$1" --observe rate --every 0.37 -o - --quiet | awk -F, 'NR > 1 { d = $NF - 0.2*cos($1); n++; if (d > 1e-10 || -d > 1e-10) bad = 1 } END { exit bad || n < 8 }'; }
# near NAME TOLERANCE EXPECTED GOT

# u = 1 + t - 2t^2 + t^3/2 at uneven times from 0 to 3: the spline is this cubic. m x'' = u, from rest:
# x = (t^2/2 + t^3/6 - t^4/6 + t^5/40)/m, and after 3 s u stays -1/2.
awk 'BEGIN { print "t [s],other,u [N],gust"; n = split("0 0.3 0.5 0.9 1.4 2 2.2 3", t, " ")
  for (i = 1; i <= n; i++) {
    u = 1 + t[i] - 2*t[i]^2 + t[i]^3/2
    printf "%s,0,%.17g,%.17g\n", t[i], u, u }
  }' >"$dir/data/cubic.csv"
awk 'BEGIN { for (i = 0; i <= 200; i++) print i/2, i == 100 }' >"$dir/data/pulse.dat"
sed 's/u \[N\]/a/' "$dir/data/cubic.csv" >"$dir/data/ground.csv"
cat >"$dir/cart.lag" <<'END'
model cart "A mass that is pushed"
coord x [m]
param m = 2 [kg] > 0, F0 = 3 [N]
input u [N] = 1
lagrangian = m/2*x'^2
force x = u
effect wind {
  input gust [N] = "data/cubic.csv"
  force x = gust
}
scene push { span 2 [s] }
scene table { like push; u = "data/cubic.csv"; span 5 [s] }
scene still { like table; u = 0 }
scene formula { like push; u = F0*cos(3 [rad/s]*t) }
scene pulse { like push; u = "data/pulse.dat"; span 100 [s] }
scene windy { like push; u = 0; use wind }
scene calm { like windy; use wind(gust = 2) }
END
m=$dir/cart.lag

near "a constant" 1e-12 1 "$(last "$m")"
near "a table, inside" 1e-9 "$(awk 'BEGIN { t = 2; printf "%.17g", (t^2/2 + t^3/6 - t^4/6 + t^5/40)/2 }')" "$(last "$m" table --until 2)"
# x(3) = 0.7875, x'(3) = (3 + 9/2 - 18 + 81/8)/2 = -0.1875; then x = 0.7875 - 0.1875*2 - 0.5*2^2/4
near "a table, past its end" 1e-9 -0.0875 "$(last "$m" table)"
check "that is said" grep -q "note: the table of u reaches from 0 to 3 s" "$dir/err"
last "$m" table --until 3 >/dev/null
empty "not where the table covers the run" "$(cat "$dir/err")"
last "$m" table u=1 >/dev/null
empty "nor where a constant replaces it" "$(cat "$dir/err")"
# Backwards from 0 s: u = 1 before the table.
near "before a table" 1e-9 1 "$(last "$m" table --until -2)"
for method in dop853 'rk4(step=0.01)' 'verlet4(step=0.01)' ${GSL:+gsl-rk8pd gsl-bsimp}; do
  near "a table with $method" 2e-8 -0.0875 "$(last "$m" table --method "$method")"
done
# The jump of slope at 3 s and those of the third derivative are at ends of steps: an adaptive method makes no
# error there. (Without that, rk45 is 2e-7 off at this tolerance.)
near "steps end at rows" 1e-11 -0.0875 "$(last "$m" table --tol 1e-9)"

near "a scene's constant" 0 0 "$(last "$m" still)"
near "a scene's formula of parameters and t" 1e-9 "$(awk 'BEGIN { printf "%.17g", 5*(1 - cos(6))/9/2 }')" "$(last "$m" formula F0=5)"
near "an effect's table" 1e-9 "$(awk 'BEGIN { t = 2; printf "%.17g", (t^2/2 + t^3/6 - t^4/6 + t^5/40)/2 }')" "$(last "$m" windy)"
near "use wind(gust = 2)" 1e-12 2 "$(last "$m" calm)"
near "u=5 on the command line" 1e-12 5 "$(last "$m" u=5)"
near "over a table" 1e-11 31.25 "$(last "$m" table u=5)"
near "wind.gust=4" 1e-12 4 "$(last "$m" windy wind.gust=4)"
near "gust=4, where that is unique" 1e-12 4 "$(last "$m" windy gust=4)"

near "u=formula" 1e-9 "$(awk 'BEGIN { printf "%.17g", 5*(1 - cos(6))/9/2 }')" "$(last "$m" 'u=5*F0/3*cos(3 [rad/s]*t)')"
near "over a scene's table" 1e-9 "$(awk 'BEGIN { printf "%.17g", (5 - sin(5))/2 }')" "$(last "$m" table 'u=sin(t/(1 [s]))*1 [N]')"
near "u=table, relative to this folder" 1e-11 -0.0875 "$(cd "$dir" && last cart.lag push --until 5 u=data/cubic.csv)"
near "in quotes" 1e-11 -0.0875 "$(last "$m" push --until 5 "u=\"$dir/data/cubic.csv\"")"
near "of an effect" 1e-12 4 "$(last "$m" windy 'wind.gust=2*2 [N]')"
check "a formula that is wrong" says 1 'u=:1:1: error: this value is in [m]' "$LAGC" run "$m" 'u=2 [m]'
check "a table that is not there" says 1 'nothing.csv' "$LAGC" run "$m" u=nothing.csv
check "a parameter takes numbers" says 2 '"2*x" is not a number' "$LAGC" run "$m" 'm=2*x'

# A pulse in one row of 201 in 100 s of rest. The spline of 1 in one row and 0 in all others has the area of one gap:
# m x' = 0.5.
for method in rk45 dop853; do
  got=$("$LAGC" run "$m" pulse --method $method --json | sed -n "s/.*\"x'\": \([-0-9.e+]*\).*/\1/p")
  near "$method does not step over a pulse" 1e-10 0.25 "$got"
done

# RK4 keeps its order across rows: steps of 0.1 and 0.05, whose grids do not hit the rows at 0.33.., 0.66...
awk 'BEGIN { for (i = 0; i <= 9; i++) printf "%.17g,%.17g\n", i/3, sin(2*i/3) }' >"$dir/data/wave.csv"
sed "s|data/cubic.csv|data/wave.csv|; s|lagrangian = .*|lagrangian = m/2*x'^2 - 2 [N/m]*x^2|" "$m" >"$dir/wave.lag"
for h in 0.1 0.05 0.001; do last "$dir/wave.lag" table --until 3 --method "rk4(step=$h)"; done | tr '\n' ' ' >"$dir/orders"
order() { awk '{ p = log(($1 - $3)/($2 - $3))/log(2); print p; exit !(p > 3.7 && p < 4.4) }' "$dir/orders"; }
check "RK4 is of order 4 across rows" order

# ---- files: relative to the model, read when it is compiled
near "from another folder" 1e-9 -0.0875 "$(cd / && last "$m" table)"
mkdir -p "$dir/parts/data"
sed -n '/^model/,/^lagrangian/!d; /^input/d; p' "$m" >"$dir/whole.lag"
printf 'include "parts/wind.lag"\nforce x = u\n' >>"$dir/whole.lag"
echo 'input u [N] = "data/two.csv"' >"$dir/parts/wind.lag"
printf '0,2\n9,2\n' >"$dir/parts/data/two.csv"
near "relative to the file that is included" 1e-12 2 "$(last "$dir/whole.lag" --until 2)"
"$LAGC" build "$dir/whole.lag" -o "$dir/sim" && printf '0,4\n9,4\n' >"$dir/parts/data/two.csv"
near "a simulator keeps the table it was built with" 1e-12 2 \
  "$("$dir/sim" --until 2 --json | sed -n 's/.*"final": {"x": \([-0-9.e+]*\).*/\1/p')"
near "lagc run reads it again" 1e-12 4 "$(last "$dir/whole.lag" --until 2)"
cp "$dir/parts/data/two.csv" "$dir/two.before"
for command in emit header build; do
  check "$command: a table is not overwritten" says 2 "two.csv: $command writes" \
    "$LAGC" $command "$dir/whole.lag" -o "$dir/parts/data/two.csv"
done
check "run: a table is not overwritten" says 2 "would be overwritten" "$LAGC" run "$dir/whole.lag" -o "$dir/parts/data/two.csv"
check "nor by --svg=" says 2 "--svg writes SVG" "$LAGC" run "$dir/whole.lag" "--svg=$dir/parts/data/two.csv"
check "it is as it was" cmp "$dir/two.before" "$dir/parts/data/two.csv"
# lagc reads its own output: the column of the input's name, in its unit.
"$LAGC" run "$m" formula -o "$dir/data/back.csv" --every 0.01 --observe u --quiet
sed '/^scene/s|data/cubic.csv|data/back.csv|' "$m" >"$dir/back.lag"
near "a table that lagc wrote" 1e-8 "$(last "$m" formula)" "$(last "$dir/back.lag" table --until 2)"

# ---- a run in two parts is the whole run
"$LAGC" run "$m" table -o "$dir/whole.csv" --every 0.25 --quiet
"$LAGC" run "$m" table -o "$dir/one.csv" --every 0.25 --until 1.5 --save-state "$dir/state" --quiet
"$LAGC" run "$m" table -o "$dir/two.csv" --resume "$dir/state" --quiet
sed 1d "$dir/two.csv" | cat "$dir/one.csv" - >"$dir/both.csv"
check "saved and resumed, with a table: the same bytes" cmp "$dir/whole.csv" "$dir/both.csv"
sed -i 's/^3,.*/3,0,9,9/' "$dir/data/cubic.csv"
check "resume: another table is another model" says 2 "saved by another model" "$LAGC" run "$m" table --resume "$dir/state"

# ---- facts
flags() { "$LAGC" emit "$m" "$1" | sed -n 's/.*\.flags = //p'; }
is "a table is neither smooth nor autonomous" "LAG_CONSTANT_MASS | LAG_SEPARABLE | LAG_TIMELESS | LAG_LOSES_ENERGY," "$(flags table)"
is "a constant is" "LAG_CONSTANT_MASS | LAG_AUTONOMOUS | LAG_SMOOTH | LAG_SEPARABLE | LAG_TIMELESS | LAG_LOSES_ENERGY," "$(flags push)"
is "a formula of t is smooth" "LAG_CONSTANT_MASS | LAG_SMOOTH | LAG_SEPARABLE | LAG_TIMELESS | LAG_LOSES_ENERGY," "$(flags formula)"
is "a choice is not" "LAG_CONSTANT_MASS | LAG_SEPARABLE | LAG_TIMELESS | LAG_LOSES_ENERGY," "$("$LAGC" emit tests/exec/models/tables.lag still | sed -n 's/.*\.flags = //p')"

# ---- functions of the program around the model
strict='-std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -O1'
embedded() { # HEADER|LIBLAG
  "$LAGC" header "$m" --with verlet4,variational,dop853 -o "$dir/cart.h" && "$LAGC" emit "$m" -o "$dir/cart.c" || return 1
  case $1 in
    # shellcheck disable=SC2086 # lists of words
    HEADER) $CC $strict -DHEADER -I"$dir" tests/exec/embed_inputs.c -lm -o "$dir/embedded" ;;
    # shellcheck disable=SC2086
    LIBLAG) $CC $strict -DLIBLAG -I"$INC" tests/exec/embed_inputs.c "$dir/cart.c" $LIBLAG $LIBS -o "$dir/embedded" ;;
  esac && "$dir/embedded"
}
check "inputs of an embedded header" embedded HEADER
check "inputs by a function, with liblag" embedded LIBLAG
# A jump is two rows of one time. m x'' = u, u = 0 before 1 s and 4 after it: x(3) = 4/m*2^2/2 = 4, x(1.5) = 4/m*0.5^2/2. The same
# backwards, where u = 4 is before: x(-3) from rest. Values before a jump at the first row, and behind one at the last.
printf '0,0\n0.5,0\n1,0\n1,4\n3,4\n' >"$dir/data/jump.csv"
printf '0,0\n1,0\n1,4\n' >"$dir/data/last.csv"
printf '0,0\n0,4\n1,4\n' >"$dir/data/first.csv"
printf -- '-3,4\n-1,4\n-1,0\n0,0\n' >"$dir/data/back.csv"
for method in rk45 dop853 'gauss --step 0.01' 'verlet4 --step 0.01'; do
  # shellcheck disable=SC2086
  near "$method: a jump" 1e-9 4 "$(last "$m" push u="$dir/data/jump.csv" --until 3 --method $method)"
done
near "soon after a jump" 1e-12 0.25 "$(last "$m" push u="$dir/data/jump.csv" --until 1.5)"
near "a jump at the last row" 1e-12 4 "$(last "$m" push u="$dir/data/last.csv" --until 3)"
near "a jump at the first row" 1e-12 9 "$(last "$m" push u="$dir/data/first.csv" --until 3)"
near "a jump, backwards" 1e-12 4 "$(last "$m" push u="$dir/data/back.csv" --until=-3)"
rejected() { "$LAGC" run "$m" push u="$dir/data/jump.csv" --until 3 --json 2>"$dir/err" | sed 's/.*"rejected": \([0-9]*\).*/\1/'; }
is "no step is tried across a jump" 0 "$(rejected)"
# Measures go over the jump: x = (t - 1)^2 from there on, so that max(x) = 4 at 3, and the mean of u is 4*2/3.
measured() { "$LAGC" run "$m" push u="$dir/data/jump.csv" --until 3 "$@" --measure 'max(x)' --measure 'mean(u)' | awk '$1 == "max(x)" { a = $2 - 4 } $1 == "mean(u)" { b = $2 - 8/3 } END { print a, b; exit !(NR && a*a + b*b < 1e-18 && b != "") }'; }
check "measures over a jump" measured --method rk45
check "by another method" measured --method dop853
# Prescribed motion: the support of a pendulum by a formula of t in L, which needs no input; by an input, its table and its formula, in L and as a constraint.
# Rows 0.01 s apart: u'' of the quintic is off by 1e-9, th by less.
cat >"$dir/shaken.lag" <<'END'
model shaken
coord th
input u = DRIVE
let x = u + 0.4*sin(th)
let y = -0.4*cos(th)
lagrangian = (x'^2 + y'^2)/2 - 9.81*y
expect 0.16*th'' = -3.924*sin(th) - 0.4*u''*cos(th)
observe rate = u'
scene s { start th = 0.2; span 3 }
END
awk 'BEGIN { for (i = 0; i <= 300; i++) printf "%.17g,%.17g\n", i/100, 0.2*sin(i/100) }' >"$dir/data/record.csv"
sed 's/u = DRIVE/u = "data\/record.csv"/' "$dir/shaken.lag" >"$dir/table.lag"
sed 's/u = DRIVE/u = 0.2*sin(t)/' "$dir/shaken.lag" >"$dir/formula.lag"
sed -e '/^input/d; /^expect/d; /^observe/d' -e 's/x = u +/x = 0.2*sin(t) +/' "$dir/shaken.lag" >"$dir/by_hand.lag"
sed -e 's/^coord th/coord th, r/; s/u = DRIVE/u = "data\/record.csv"/; s/x = u +/x = r +/; /^expect/d' -e '/^observe/a constraint drive: r = u' "$dir/shaken.lag" >"$dir/driven.lag"
th() { "$LAGC" run "$@" --tol 1e-11 --quiet --until 3 --json 2>"$dir/err" | sed -n 's/.*"th": \([-0-9.e+]*\).*/\1/p'; }
hand=$(th "$dir/by_hand.lag")
near "a support that a table moves" 3e-9 "$hand" "$(th "$dir/table.lag")"
near "a formula" 1e-10 "$hand" "$(th "$dir/formula.lag")"
near "a formula by taylor" 1e-10 "$hand" "$(th "$dir/formula.lag" --method taylor)"
near "a constraint" 3e-9 "$hand" "$(th "$dir/driven.lag")"
near "rk4 keeps its order" 1e-8 "$hand" "$(th "$dir/table.lag" --method rk4 --step 0.001)"
sed 's/x = 0.2\*sin(t) +/x =/' "$dir/by_hand.lag" >"$dir/plain.lag"
near "a support at rest" 1e-10 "$(th "$dir/plain.lag")" "$(th "$dir/table.lag" u=5)"
check "the rate of a table" near_rates "$dir/table.lag"
check "the power of the drive" says 0 "dE/dt = u'*lambda(drive)" "$LAGC" derive "$dir/driven.lag"
check "a rate is not held by itself" says 2 "u' is the rate of an input, and follows from it" "$LAGC" run "$dir/table.lag" "u'=1"
head -n 5 "$dir/data/record.csv" >"$dir/data/few.csv"
check "a record too short" says 1 "has 5 rows: a smooth curve needs 6" "$LAGC" run "$dir/table.lag" u="$dir/data/few.csv"
awk 'BEGIN { print "t,u"; for (i = 0; i < 31; i++) print i/10 "," (i < 15 ? 0.001*i : 0.1) }' >"$dir/data/steps.csv"
check "a record with a step between its rows" says 0 'steps from 0.014 to 0.1 between t = 1.4 and 1.5' "$LAGC" run "$dir/table.lag" u="$dir/data/steps.csv" --until 1
check "a record that jumps" says 1 "its table \`$dir/data/jump.csv\` jumps at t = 1" "$LAGC" run "$dir/table.lag" u="$dir/data/jump.csv"
# A function of the program for u asks for one of u', u''. In a header they are inputs of a step.
cat >"$dir/rates.c" <<'END'
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "lag.h"
extern const lag_scene shaken_s;
static double value(void *c, double t) { (void)c; return 0.2*sin(t); }
static double rate(void *c, double t) { (void)c; return 0.2*cos(t); }
static double second(void *c, double t) { (void)c; return -0.2*sin(t); }
int main(void) {
  lag_sim *s = lag_sim_new(&shaken_s);
  if (lag_sim_set_input(s, "u'", rate, NULL)) return 1;
  if (lag_sim_advance(s, 3) != LAG_EINVAL || !strstr(lag_sim_message(s), "give it a function as")) return 2;
  if (lag_sim_set_input(s, "u", value, NULL) || lag_sim_set_input(s, "u''", second, NULL) || lag_sim_set_tolerance(s, 1e-11)) return 3;
  if (lag_sim_advance(s, 3) < 0) return 4;
  printf("%.17g\n", lag_sim_state_value(s, 0));
  lag_sim_free(s);
  return 0;
}
END
"$LAGC" emit "$dir/formula.lag" -o "$dir/formula.c"
# shellcheck disable=SC2086 # lists of words
check "functions of the program" $CC $strict -I"$INC" "$dir/rates.c" "$dir/formula.c" $LIBLAG $LIBS -o "$dir/rates"
near "its support" 1e-9 "$hand" "$("$dir/rates")"
# A floor that moves, by an input and by its formula: the same bounces.
cat >"$dir/floor.lag" <<'END'
model floor
coord x
input u = 0.02*sin(30*t)
lagrangian = x'^2/2 - 9.81*x
contact table: x >= u, restitution = 0.5
scene s { start x = 0.1; span 2 }
END
sed -e '/^input/d' -e 's/x >= u/x >= 0.02*sin(30*t)/' "$dir/floor.lag" >"$dir/floor_by_hand.lag"
near "a floor that shakes" 1e-9 "$(last "$dir/floor_by_hand.lag")" "$(last "$dir/floor.lag")"
# A floor that accelerates: a body rides on it, in time steps of order 2 to rounding.
cat >"$dir/lift.lag" <<'END'
model lift
coord x
input u = t^2/2
lagrangian = x'^2/2 - 9.81*x
contact table: x >= u, restitution = 0
scene s { span 1; method moreau(step = 0.1) }
END
near "a floor that lifts, in time steps" 1e-12 0.5 "$(last "$dir/lift.lag")"
printf '0,0\n1,0\n1.000001,1\n2,1\n' >"$dir/data/steep.csv"
check "lagc run shows the model's warnings" says 0 "warning: between its rows the curve goes from" "$LAGC" run "$m" push u="$dir/data/steep.csv" --quiet

# ---- integrals of a record: a = 1 + t - 2t^2 + t^3/2 up to 3 s, so that u = t^2/2 + t^3/6 - t^4/6 + t^5/40; a sled above it keeps x + u
cat >"$dir/sled.lag" <<'END'
model sled "A sled on ice, and the ground as it was measured"
coord x [m]
param m = 2 [kg] > 0
input a [m/s^2] = "data/ground.csv", v [m/s] = integral(a), u [m] = integral(v)
lagrangian = m/2*(x' + u')^2
scene s { span 2 [s]; output x, u'' every 1 [s] }
scene still { like s; a = 0 }
END
near "the double integral of a record" 1e-13 "$(awk 'BEGIN { t = 2; printf "%.17g", -(t^2/2 + t^3/6 - t^4/6 + t^5/40) }')" "$(last "$dir/sled.lag")"
near "its second rate is the record" 1e-12 -1 "$("$LAGC" run "$dir/sled.lag" -o - --quiet | awk -F, 'END { print $3 }')"
near "a scene without it" 1e-15 0 "$(last "$dir/sled.lag" still)"
# Behind the record u rests, and v(3) = -3/8 stops at once; levelled, v ends at 0.
check "a support that stops at once is said" says 0 "u stops at once, from u' = -0.375 in SI" "$LAGC" run "$dir/sled.lag" --until 4
sed 's/integral(a)/integral(a, level)/' "$dir/sled.lag" >"$dir/rests.lag"
check "one that rests is not" sh -c '! "$0" run "$1" --until 4 2>&1 | grep "at once"' "$LAGC" "$dir/rests.lag"
# levelled: v(3) = 3 + 9/2 - 18 + 81/8 = -3/8 over 3 s; then u(3) = 63/40 + 9/16, over 3 s again
sed -i 's/integral(\([av]\))/integral(\1, level)/g' "$dir/sled.lag"
level() { "$LAGC" run "$dir/sled.lag" --until "$1" -o - --observe u --quiet | awk -F, 'END { print $NF }'; }
near "without its drift it ends where it begins" 1e-13 0 "$(level 3)"
near "beside the mean of its velocity" 1e-13 "$(awk 'BEGIN { t = 2; printf "%.17g", t^2/2 + t^3/6 - t^4/6 + t^5/40 + t^2/16 - (63/40 + 9/16)*t/3 }')" "$(level 2)"
# ---- values that hold: 1, -2, 3 N for a second each move 1 kg by 1/2, 0 and 1/2 m
printf 't,F\n0,1\n1,-2\n2,3\n' >"$dir/data/held.csv"
printf 'model held\ncoord x [m]\ninput F [N] = hold("data/held.csv")\nlagrangian = 1 [kg]/2*x%s^2\nforce x = F\nscene s { span 3 [s] }\n' "'" >"$dir/held.lag"
near "values that hold until the next row" 1e-12 1 "$(last "$dir/held.lag")"
near "by steps that end there" 1e-12 1 "$(last "$dir/held.lag" --method 'rk4(step=0.125)')"
printf 't,F\n0,1\n1,9\n1,-2\n2,3\n' >"$dir/data/held.csv"
near "of two rows at 1 s the second holds" 1e-12 1 "$(last "$dir/held.lag")"
printf 't,F\n1,1\n1,-2\n' >"$dir/data/held.csv"
check "a table of one time is a jump" says 0 "the table of F is a jump at 1 s" "$LAGC" run "$dir/held.lag"
near "1/2 + 1 2 - 2 2^2/2" 1e-12 -1.5 "$(last "$dir/held.lag")"
tap_end
