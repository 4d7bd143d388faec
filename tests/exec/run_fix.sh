#!/bin/sh
# --fix turns parameters into numbers, and unrequested functions are not in emitted C. Operations are counted by the compiler and, for a few
# small models, by hand; trajectories are compared with those of programs without --fix.
cd "$(dirname "$0")/../.." || exit 2
. tests/tap.sh
dir=$TMP/fix
mkdir -p "$dir"
ops() { "$LAGC" derive "$1" --ops --fix "$2" | awk 'NR == 1 { a = $1 } NR == 2 { b = $3 } END { print a, b }'; } # with and without

# ---- operations
cat >"$dir/two.lag" <<'END'
model two "Springs in a row"
const n = 2
coord x[n] [m]
param m = 2 [kg] > 0, k[n] = {3, 5} [N/m], c = 0.25 [N*s/m], w [rad/s] = 2*pi, still [m] = 0, d [N*s/m] = 2*c
lagrangian = m/2*sum(i in 1..n, x[i]'^2) - sum(i in 1..n, k[i]/2*x[i]^2)
for i in 1..n { force x[i] = -c*x[i]' + still*1 [N/m]*sin(w*t) }
effect drive { param F = 3 [N], a: vec2 = (1, 2) [N]; force x[1] = (F - 1 [N])*cos(w*t)/(m + 1 [kg])*1 [kg] + a.y }
scene rest { start x[1] = 1, x[2] = 1; span 5; tolerance 1e-10 }
scene heavy { like rest; m = 8; k[2] = 7 }
scene driven { like rest; use drive(F = 4) }
END
two=$dir/two.lag
# a[i] = -(k[i]*x[i] + c*v[i])*(1/m): three products, a sum, and a sign, which costs nothing
is "as many operations as by hand: 3 products and a sum for each of 2 coordinates" 8 "$(ops "$two" all | cut -d' ' -f1)"
for m in double_pendulum cart_pendulum foucault chain outer_planets spherical_pendulum charged_particle; do
  check "$m: fewer operations, never more" sh -c 'echo "$*"; [ "$1" -lt "$2" ]' - $(ops models/$m.lag all)
done
for m in models/*.lag; do
  one_of 4 || continue
  # shellcheck disable=SC2046
  set -- $(ops "$m" all)
  [ "$1" -le "$2" ] || echo "$m: $1 with, $2 without"
done >"$dir/more"
empty "no model of the gallery has more" "$(cat "$dir/more")"

# ---- the same motion
final() { "$LAGC" run "$@" --json 2>"$dir/err" | sed -n 's/.*"final": {\(.*\)}}.*/\1/p' | tr ',' '\n' | sed 's/.*: //'; }
agree() { # TOLERANCE MODEL SCENE...: two runs with and without
  tol=$1
  shift
  final "$@" >"$dir/a"
  final "$@" --fix all >"$dir/b"
  [ -s "$dir/a" ] || { cat "$dir/err"; return 1; }
  paste "$dir/a" "$dir/b" | awk -v tol="$tol" '{ print; d = $1 - $2; s = $1 < 0 ? -$1 : $1; if (s < 1) s = 1; if (NF != 2 || d > tol*s || -d > tol*s) bad = 1 } END { exit bad }'
}
# A difference of rounding in each of some hundred steps, of motions that are not chaotic: a thousand times 2e-16 is generous.
for s in ${SLOW:+rest heavy} driven; do check "two, $s" agree 1e-12 "$two" $s; done
check "by Taylor series" agree 1e-12 "$two" driven --method taylor
# Newton's iteration stops below a part of the tolerance, 1e-10; rounding may end it one correction sooner, and in a hundred steps.
check "by an implicit method, with its Jacobian" agree 1e-8 "$two" driven --method radau
slow check "by a variational method, with second derivatives" agree 1e-11 "$two" rest --method 'variational(step = 0.01)'
slow check "with constraints" agree 1e-10 models/slider_crank.lag --until 1
check "of first order" agree 1e-10 models/vortices.lag --until 1
slow check "events and closed forms" agree 1e-10 models/bouncing_ball.lag
slow check "functions of parameters" agree 1e-9 models/foucault.lag fast

# ---- emitted C and headers
emitted() { "$LAGC" emit "$two" "$@" >"$dir/e.c" && ${CC:-cc} -std=c11 -Wall -Werror -Iruntime/include -c "$dir/e.c" -o "$dir/e.o"; }
check "emit: compiles" emitted driven --fix m,drive.F,k
check "emit: says the numbers" grep -qF 'Parameters that are numbers here: m = 2, k[1] = 3, k[2] = 5, drive.F = 4.' "$dir/e.c"
check "emit: others are left" grep -qF 'p_table[]' "$dir/e.c"
check "emit: all" emitted driven --fix all
check "emit: no parameter is left" sh -c '! grep -qF "p_table[]" "$1" && ! grep -q "[^a-z_]p\[" "$1"' - "$dir/e.c"
header() { "$LAGC" header "$two" driven --fix all -o "$dir/two.h" && printf '#define TWO_IMPLEMENTATION\n#include "two.h"\nint main(void) { return 0; }\n' >"$dir/h.c" && ${CC:-cc} -std=c99 -Wall -Werror -I"$dir" "$dir/h.c" -o "$dir/h" -lm; }
check "header: all" header

# ---- fixed parameters cannot be set
"$LAGC" build "$two" --fix m,k,drive.a -o "$dir/sim" || echo "no simulator"
check "a fixed parameter" says 2 "m is a number in this program (--fix); this builds one that takes all values: lagc build $two -o SIMULATOR" "$dir/sim" driven m=3
check "a member" says 2 'k[2] is a number' "$dir/sim" driven 'k[2]=3'
check "a family" says 2 'k is a number' "$dir/sim" driven k=3
check "of an effect" says 2 'drive.a.x is a number' "$dir/sim" driven drive.a.x=3
check "where the effect is off it is that" says 2 'effect drive is not in scene' "$dir/sim" rest drive.a.x=3
check "others can be set" "$dir/sim" driven c=0.5 F=2 --quiet
check "scenes keep their own numbers" sh -c '[ "$("$0" heavy --json | sed "s/.*final//")" != "$("$0" rest --json | sed "s/.*final//")" ]' "$dir/sim"
check "run --fix" says 2 'm is a number' "$LAGC" run "$two" --fix m m=3
check "of an effect that is off, it is said" says 0 'note: --fix drive.F: the effect `drive` is off in the scene `rest`, and has nothing to fix there' "$LAGC" derive "$two" rest --fix drive.F
check "no such parameter" says 1 'did you mean `m`?' "$LAGC" emit "$two" --fix mm
check "no parameter" says 1 '--fix x: this is a coordinate' "$LAGC" emit "$two" --fix x
check "a constant" says 1 'constants are set when compiling: -D n=' "$LAGC" emit "$two" --fix n
check "made of others" says 1 '`d` depends on other parameters' "$LAGC" emit "$two" --fix d
cat "$two" - >"$dir/both.lag" <<'END'
effect wind { param F = 1 [N]; force x[2] = F }
scene both { like driven; use wind }
END
check "declared twice" says 1 'say which: --fix wind.F' "$LAGC" derive "$dir/both.lag" both --fix F
check "and once where the other effect is off" "$LAGC" derive "$dir/both.lag" driven --fix F
check "together with them" "$LAGC" emit "$two" --fix c,d
check "more digits" says 2 'leave it out where --precision has more digits' "$LAGC" run "$two" --fix m --precision quad
check "completion" sh -c '"$0" complete emit "$1" --fix c,dr | grep -q "^c,drive.F"' "$LAGC" "$two"

# ---- unrequested functions are not emitted
cat >"$dir/asks.lag" <<'END'
model asks "Observables, multipliers, a closed form"
coord x [m], y [m]
param m = 1 [kg] > 0, l = 1 [m] > 0, g = 9.81 [m/s^2]
lagrangian = m/2*(x'^2 + y'^2) - m*g*y
constraint rod: x^2 + y^2 = l^2
observe odd [m^7] = exp(x/l)*y^7
observe pull [N] = lambda(rod)*l
scene plain { start x = 1 [m]; output x every 0.1 [s] }
scene both { like plain; output x, odd, pull every 0.1 [s] }
END
sed '/^observe/d; /^scene both/d' "$dir/asks.lag" >"$dir/none.lag"
check "observables that no output asks for leave no trace" sh -c '"$0" emit "$1/asks.lag" plain >"$1/a.c" && "$0" emit "$1/none.lag" plain >"$1/b.c" && cmp "$1/a.c" "$1/b.c"' "$LAGC" "$dir"
check "where one asks, it is there" sh -c '"$0" emit "$1/asks.lag" both | grep -q "LAG_FN(exp)"' "$LAGC" "$dir"
has() { "$LAGC" emit "$@" >"$dir/a.c" && grep -oE '\.(linear|taylor|variation|second) = ' "$dir/a.c" | tr -d '.= \n'; }
is "no method: no Jacobian, series or second derivatives" '' "$(has models/double_pendulum.lag)"
is "rk45, dop853, verlet ask for none" '' "$(has models/pendulum.lag --method rk45; has models/pendulum.lag --method dop853; has models/henon_heiles.lag --method verlet)"
is "radau: the Jacobian" linear "$(has models/double_pendulum.lag --method radau)"
is "taylor: the series" taylor "$(has models/double_pendulum.lag --method taylor)"
is "variational: second derivatives" variationsecond "$(has models/double_pendulum.lag --method variational)"
is "accelerations do not pay for them" "$("$LAGC" emit models/double_pendulum.lag | grep -c 'Accelerations: 38 operations')" \
  "$("$LAGC" emit models/double_pendulum.lag --method radau | grep -c 'Accelerations: 38 operations')"
# Functions whose values are not fractions stay calls: the compiled program computes them, and the text agrees (every compilation compares).
cat >"$dir/numbers.lag" <<'END'
model numbers
coord x
param k = 2 > 0
lagrangian = x'^2/2 - (atan2(1, 2) + 2*hypot(1, 2) + 3*min(pi, 3) + 4*max(pi, 3) + 5*2^pi + atan2(k, 2) + hypot(k, 3) + max(k, 3) + if(k > 2, 1, 3))*x^2
END
check "functions of two numbers" "$LAGC" emit "$dir/numbers.lag" --fix all -o "$dir/numbers.c"
tap_end
