#!/bin/sh
# Symmetries from the .lag file to the report: charges are conserved, or balance the forces that break them, to the accuracy of the method; monitors
# watch them; false claims are refused. Expected values: orders of methods, rounding, and no other error.
. tests/tap.sh
. tests/exec/lib_charges.sh
planets=tests/exec/models/planets.lag

run() { "$LAGC" run "$@" >"$TMP/out" 2>"$TMP/err"; }
says() { # says WORDS ARGS...
  words=$1
  shift
  run "$@" && grep -qE -e "$words" "$TMP/out"
}
# kept WITHIN ARGS...: every charge of a symmetry stays within that
kept() {
  within=$1
  shift
  run "$@" --json || return 1
  for name in spin momentum boost; do
    below "$(of $name drift)" "$within" || { echo "$name: $(of $name drift), $(of $name trend)"; return 1; }
  done
}

# ---- nothing disturbs: momenta of discrete Lagrangians are those of L. Rounding walks as the root of 5000 steps, with some 20 terms
for m in verlet verlet4 variational; do
  check "$m keeps them to rounding" kept 1e-13 $planets quiet --method $m --step 0.01
  is "of the spin, the report says so" rounding "$(of spin trend)"
done
# Gauss's methods conserve quadratic invariants, to the last bit of Newton's method
check "gauss keeps them" kept 1e-13 $planets quiet --method 'gauss(stages=2)' --step 0.01
check "dop853 keeps them to what its steps lose" kept 2e-10 $planets quiet --tol 1e-11 --method dop853
check "a conserved charge has no work" sh -c "grep -q '\"spin\": {\"is\": \"conserved\", \"initial\": 0.375.*\"work\": 0,' '$TMP/out'"
check "the report has a line for each" says '^boost drift: [0-9.e-]* \(from 0.1 kg\*m\), rounding$' $planets quiet --method verlet --step 0.01
check "and the energy's" says '^energy drift: [0-9.e-]* \(.*relative to .*\), oscillates \(as step\^2\)$' $planets quiet --method verlet --step 0.01

# ---- the energy of symplectic methods: bounded, of the size h^p
bounded() { # bounded METHOD ORDER STEP: the energy oscillates; half the step, 2^ORDER times less
  run $planets quiet --method "$1" --step "$3" --json && coarse=$(of energy drift)
  is "$1: the energy oscillates" oscillates "$(of energy trend)"
  run $planets quiet --method "$1" --step "$(awk -v h="$3" 'BEGIN { print h/2 }')" --json && fine=$(of energy drift)
  check "half the step, 2^$2 times less" order "$2"
}
order() { between "$(awk -v a="$coarse" -v b="$fine" 'BEGIN { print log(a/b)/log(2) }')" "$(($1 - 1)).6" "$1.6"; }
bounded verlet 2 0.02
bounded verlet4 4 0.08
bounded variational 2 0.02
bounded 'variational(order=4)' 4 0.08
bounded 'gauss(stages=2)' 4 0.08
check "the report says so of orders that options choose" says '^energy drift: .* oscillates \(as step\^4\)$' $planets quiet --method 'gauss(stages=2)' --step 0.08
check "and of their defaults" says '^energy drift: .* oscillates \(as step\^2\)$' $planets quiet --method variational --step 0.02
run $planets quiet --method rk4 --step 0.01 --json
is "of rk4 it grows" grows "$(of energy trend)"

# ---- friction, a field that grows with time, a wall: balances close as well as the charges did
for setting in "dop853 --tol 1e-11" "rk45 --tol 1e-11" "taylor --tol 1e-11" "rk4 --step 1e-3"; do
  # shellcheck disable=SC2086 # method and setting
  check "$setting: balances close" kept 1e-9 $planets disturbed --method $setting
  check "of the energy, too" below "$(of energy drift)" 1e-9
  is "they are called that" "balanced balanced" "$(of energy is) $(of momentum is)"
done
# the loss is by far larger than the part that is not accounted for
check "there is work to account for" between "$(of spin work)" -20 -1
check "the report says what forces did" says '^spin balance: [0-9.e-]* \(from 0.375 kg\*m\^2/s; change by forces: -[0-9.]*\)' $planets disturbed
run $planets disturbed --method rk4 --step 0.01 --json && coarse=$(of spin drift)
run $planets disturbed --method rk4 --step 0.005 --json && fine=$(of spin drift)
check "rk4: half the step, 2^4 times less" order 4
check "a driven, damped pendulum" run models/driven_damped_pendulum.lag chaos --tol 1e-11 --json
check "closes to a hundred tolerances in its 200 s" below "$(of energy drift)" 1e-9
check "by radau, too" run models/driven_damped_pendulum.lag chaos --tol 1e-8 --until 100 --method radau --json
check "to fifteen tolerances of the median size, which is a third of the largest: at the nodes of its stages, which are better than what lies between them" below "$(of energy drift)" 1.5e-7
check "without words nothing is integrated, but monitors see it" run $planets disturbed --quiet

# ---- an input in L: its power is known while it follows its formula. Held, the spring has a fixed end: the energy stays
spring=tests/exec/models/pulled_spring.lag
check "the formula's rate has a part in the balance" run $spring --json
is "which is known" balanced "$(of energy is)"
check "and closes" below "$(of energy drift)" 1e-9
check "with another value" run $spring a=0.2 --json
is "it is not" "not known" "$(of energy is)"
check "so nothing is taken off the energy" below "$(of energy drift)" 1e-9
cat >"$TMP/pull.csv" <<'END'
t [s],a [m]
0,0
10,0.1
20,0.3
END
sed 's|= 0.1 \[m\]\*sin(w\*t)|= "pull.csv"|' $spring >"$TMP/table.lag"
check "of a table the rate is not known, and the report says so" says '^energy change: [0-9.e-]* \(not decided: its rate is not known\)' "$TMP/table.lag"

# ---- the input of a scene: check reports its power. With u = 1 + t/5 in L = ... - u (x^2 + y^2)/2: u' (x^2 + y^2)/2
cat >"$TMP/stiffer.lag" <<'END'
model stiffer
coord x, y
input u = 0
kinetic = (x'^2 + y'^2)/2
potential = u*(x^2 + y^2)/2
symmetry later(s): t -> t - s
scene formula { start x = 1, y' = 0.3; span 5; u = 1 + t/5 }
scene table { like formula; u = "pull.csv" }
END
printf 't,u\n0,1\n5,2\n9,4\n' >"$TMP/pull.csv"
check "check knows the scenes' inputs" sh -c "'$LAGC' check '$TMP/stiffer.lag' >'$TMP/out' 2>&1"
is "a formula's rate, and that a table's is not known" "d(later)/dt = x^2/10 + y^2/10|d(later)/dt: L depends on an input whose rate of change is not known|" \
  "$(sed -n 's/^  \(d(later)\)/\1/p' "$TMP/out" | tr '\n' '|')"

# ---- L linear in velocities: forces and dissipation work there, too
for drag in "force x = -a*x'" "force x = -a*x" "dissipation = a*x'^2/2"; do
  printf '%s\n' "model eddy" "coord x, y" "param a = 1" "lagrangian = (x*y' - y*x')/2 - (x^2 + y^2)^2/4" \
    "symmetry spin(s): x -> x*cos(s) - y*sin(s), y -> x*sin(s) + y*cos(s)" "effect drag { $drag }" "scene s { start x = 1; span 10; use drag; monitor spin 1e-8, energy 1e-8 }" >"$TMP/eddy.lag"
  check "$drag: monitors are content" run "$TMP/eddy.lag" --tol 1e-11 --json
  wanted=balanced
  case $drag in *a\*x) wanted=conserved ;; esac # with the potential a x^2/2
  is "these are balances" "$wanted balanced" "$(of energy is) $(of spin is)"
  # half the square of the distance at the end, by the state, less that at the start, 1/2
  check "the work is what the motion shows" run "$TMP/eddy.lag" --tol 1e-11
  moved=$(awk '$1 == "x" { x = $2 } $1 == "y" { y = $2 } END { print (x*x + y*y - 1)/2 }' "$TMP/out")
  run "$TMP/eddy.lag" --tol 1e-11 --json
  check "to a hundred tolerances" between "$(awk -v a="$(of spin work)" -v b="$moved" 'BEGIN { print a - b }')" -1e-6 1e-6
done
check "check shows them" sh -c "'$LAGC' check '$TMP/eddy.lag' | grep -q 'd(energy)/dt = '"

# ---- contacts: a resting body is pushed, m g = 19.62 N for 5 s; a body that strikes jumps
cat >"$TMP/ball.lag" <<'END'
model ball
coord x [m], y [m]
param m = 2 [kg] > 0, g = 9.81 [m/s^2] > 0
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*y
symmetry lift(s): y -> y + s
symmetry level(s): x -> x + s
symmetry along(s): x -> x + s, y -> y - s
effect ground { contact floor: y >= 0, restitution = 0.5 }
effect ramp { contact slope: x + y >= 0, restitution = 0 }
scene rests { start y = 0, x' = 0.3; span 5; use ground; monitor lift 1e-12, level 1e-12 }
scene drops { like rests; start y = 1; span 3; monitor lift 1e-7 }
scene slides { start y = 0; span 2; use ramp; monitor along 1e-9, lift 1e-9, level 1e-9 }
END
check "a ball at rest on a floor" run "$TMP/ball.lag" rests --json
check "the floor has brought 98.1 N*s" between "$(of lift work)" 98.09999999 98.10000001
is "along the floor nothing does" conserved "$(of level is)"
check "one that bounces, and comes to rest" run "$TMP/ball.lag" drops
check "one that slides down a slope" run "$TMP/ball.lag" slides --json
is "along which its momentum is a charge" conserved "$(of along is)"
is "while neither component is" "balanced balanced" "$(of lift is) $(of level is)"

# ---- the scale of a charge is the size of its terms: rounding of terms that cancel is not drift
cat >"$TMP/pair.lag" <<'END'
model pair
coord a, b
param m1 = 1 > 0, m2 = 3 > 0
kinetic = m1/2*a'^2 + m2/2*b'^2
potential = (a - b)^2/2
symmetry boost(s): a -> a + s*t, b -> b + s*t
scene s { start a = 0.3, b = -0.1; span 1e-3; method rk4(step=1e-5); monitor boost 1e-14 }
END
check "two bodies about their centre of mass" run "$TMP/pair.lag" --json
is "what changes is rounding" rounding "$(of boost trend)"

# ---- the state at the end, within a step, is a part of the run
cat >"$TMP/end.lag" <<'END'
model end
coord x, y
kinetic = (x'^2 + y'^2)/2
potential = x^2 + y^2
symmetry spin(s): x -> x*cos(s) - y*sin(s), y -> x*sin(s) + y*cos(s)
scene s { start x = 1, y' = 1; span 4; method dop853; tolerance 1e-9; monitor spin 2e-10 }
END
run "$TMP/end.lag"
is "monitors see it" 3 $?
drift=$(sed -n 's/^spin drift: \([^ ]*\) .*/\1/p' "$TMP/out")
check "with the drift that the report has" grep -q "^monitor spin: drift $drift, limit 2e-10" "$TMP/out"

# ---- monitors: of charges as of the energy
run $planets quiet --method rk4 --step 0.1
is "what drifts past its limit ends the run" 3 $?
check "and is named" grep -q "monitor spin: drift .* is past its limit 1e-06" "$TMP/out"
sed 's/monitor spin 1e-6, /monitor energy 1e-9, spin 1e-9, /' $planets >"$TMP/planets.lag"
check "balances are watched, not charges" run "$TMP/planets.lag" disturbed --tol 1e-11

# ---- headers: charges and their rates at the start, worked out by hand
"$LAGC" header $planets disturbed -o "$TMP/p.h" >/dev/null
cat >"$TMP/h.c" <<'END'
#define P_IMPLEMENTATION
#include "p.h"
#include <stdio.h>
int main(void)
{
  p_params p;
  p_state s;
  double c[6], w[4];
  p_defaults(&p);
  p_start(&p, &s);
  if (p_charges(s.t, s.q, s.v, &p, c) || p_powers(s.t, s.q, s.v, &p, w)) return 1;
  printf("%g %g %g, %g %g %g %g\n", c[0], c[2], c[4], w[0], w[1], w[2], w[3] + 0.0);
  return 0;
}
END
check "a header has them" "$CC" -std=c99 -Wall -Wextra -Wno-unused-function "$TMP/h.c" -o "$TMP/h" -lm
is "with their values and rates" "0.375 0.1 0.1, -0.00066 -0.0108 -0.0004 0" "$("$TMP/h")"
"$LAGC" header models/pendulum.lag -o "$TMP/none.h" >/dev/null
check "a model without symmetries has none" sh -c "! grep -q charges '$TMP/none.h'"

# ---- constraints that are products hold where one factor is 0; a symmetry that is not proved for all states may fail on one of these parts
parts() { # parts FACTOR: a circle, or where the factor is 0
  printf 'model parts\ncoord x, y\nlagrangian = (x%s^2 + y%s^2)/2\nconstraint c: (x^2 + y^2 - 1)*(%s) = 0\nsymmetry turn(s): x -> x*cos(s) - y*sin(s), y -> x*sin(s) + y*cos(s)\nscene s { start x = 1 }\n' \
    "'" "'" "$1" >"$TMP/parts.lag"
  "$LAGC" check "$TMP/parts.lag" >"$TMP/out" 2>&1
}
says_of() { parts "$1" && false; grep -q "$2" "$TMP/out" || { cat "$TMP/out"; return 1; }; }
check "a line near by" says_of 'x - 3' 'the symmetry .turn. does not keep to the constraint .c.'
check "a line that no start goes to" says_of 'x - 500' 'which may leave out one factor of this constraint'
check "another circle" parts '(x - y)^2 + 2*x*y - 4'
check "is turned into itself" grep -q 'symmetry turn: proved' "$TMP/out"
check "a factor that is positive by its signs is no part" parts 'x^2 + 1'
check "and asks for nothing" grep -q 'symmetry turn: ' "$TMP/out"

# ---- every sign of a rotation counts
rotated() { # rotated XX XY YX YY: signs of the four terms
  printf 'model turn\ncoord x, y\nlagrangian = (x%s^2 + y%s^2)/2 + 1/hypot(x, y)\nsymmetry turn(s): x -> %sx*cos(s) %s y*sin(s), y -> %sx*sin(s) %s y*cos(s)\n' \
    "'" "'" "$1" "$2" "$3" "$4" >"$TMP/turn.lag"
  "$LAGC" check "$TMP/turn.lag" >"$TMP/out" 2>&1
}
check "as in the book it is proved" rotated '' - '' +
check "and its inverse" rotated '' + - +
# signs XX,XY,YX,YY, and the verdict on them
refused() {
  old=$IFS IFS=,
  # shellcheck disable=SC2086 # a list
  set -- $1 "$2"
  IFS=$old
  rotated "$1" "$2" "$3" "$4"
  is "signs $1,$2,$3,$4: refused" 1 $?
  check "with the reason" grep -q "$5" "$TMP/out"
}
for signs in "+,+,,+" ",-,-,+"; do
  refused "$signs" 'the remainder of delta L is .*x.*; it would be 0 if the change of `x` or `y` had the opposite sign'
done
for signs in "-,-,,+" ",-,,-"; do
  refused "$signs" 'at s = 0 the symmetry `turn` maps `[xy]` to `-[xy]`'
done

# A header names the numbers in its array of charges.
names() { "$LAGC" header models/kepler.lag | grep -q '^ \* Symmetries: 0 spin\.'; }
check "a header numbers the charges from 0" names

# Symmetries that move all of 600 members: 95 MB, where every term had arrays of all symbols 2 GB.
cat >"$TMP/ring.lag" <<'END'
model ring
const N = 600
coord u[N], v[N]
lagrangian = sum(i in 1..N, (u[i]'^2 + v[i]'^2)/2) - sum(i in 1..N-1, ((u[i+1] - u[i])^2 + (v[i+1] - v[i])^2)/2)
symmetry later(s): t -> t + s
symmetry boost(s): for i in 1..N: u[i] -> u[i] + s*t
symmetry turn(s): for i in 1..N: u[i] -> u[i]*cos(s) - v[i]*sin(s), v[i] -> u[i]*sin(s) + v[i]*cos(s)
END
large() { (ulimit -v 200000 && [ "$("$LAGC" check "$TMP/ring.lag" | grep -c ': proved')" = 3 ]); }
check "memory grows with the text" large
cat >"$TMP/springs.lag" <<'END'
model springs
const N = 2000
coord x[N]
param m = 1 > 0, k = 1 > 0
kinetic = sum(i in 1..N, m/2*x[i]'^2)
potential = sum(i in 1..N-1, k/2*(x[i+1] - x[i])^2) + k/2*(x[1] - x[N])^2
symmetry shift(s): for i in 1..N: x[i] -> x[i] + s
END
few() { (ulimit -v "$4" && [ "$("$LAGC" check "$TMP/$1.lag" | grep -c "$2")" = "$3" ]); }
check "a ring of 2000: 40 MB, and 480 MB where each row kept values of all symbols" few springs ': proved' 1 120000
{ sed '/^symmetry/d; s/^const N = .*/const N = 1/' "$TMP/ring.lag"; awk 'BEGIN { for (i = 1; i <= 1000; i++) printf "scene s%d { start u = %d }\n", i, i }'; } >"$TMP/scenes.lag"
check "1000 scenes take the memory of one: 120 MB where each was kept" few scenes '^scene .*: ok' 1000 60000
tap_end
