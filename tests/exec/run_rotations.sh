#!/bin/sh
# Rotations: meaning of R*v, products, omega, torques, starts and events, by systems with closed forms (models/turns.lag, models/spun.lag); the
# command line gives the same result as a scene; embedded headers, C and C++; 10^5 steps; `lagc check`.
. tests/tap.sh
turns=tests/exec/models/turns.lag spun=tests/exec/models/spun.lag

value() { # FILE COLUMN TIME
  awk -F, -v name="$2" -v t="$3" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name || index($i, name " [") == 1) c = i }
    NR > 1 && c && $1 == t { print $c; exit }' "$1"
}
near() { # FILE COLUMN TIME EXPECTED TOLERANCE; EXPECTED is a formula of awk
  got=$(value "$1" "$2" "$3")
  awk -v got="$got" -v tol="$5" 'BEGIN { pi = atan2(0, -1); x = '"$4"'; print "got", got, "expected", x
    exit !(got != "" && got - x <= tol && x - got <= tol) }' </dev/null
}
out=$TMP/turns.csv
check "turns run" sh -c '"$1" run "$2" -o "$3" >"$3.txt"' sh "$LAGC" $turns "$out"

# ---- vectors ----
# Rodrigues: v cos a + n x v sin a + n (n.v)(1 - cos a), n = (1, 2, 3)/sqrt(14), v = (4, 5, 6): n x v = (-3, 6, -3)/sqrt(14), n.v = 32/sqrt(14)
k=0
for c in x y z; do
  k=$((k + 1))
  v=$((k + 3)) x=$([ $k = 2 ] && echo 6 || echo -3)
  check "R*v: $c" near "$out" r1.$c 0 "$v*cos(0.7) + $x/sqrt(14)*sin(0.7) + $k*32/14*(1 - cos(0.7))" 1e-14
  check "transpose(R)*v: $c" near "$out" r2.$c 0 "$v*cos(0.7) - $x/sqrt(14)*sin(0.7) + $k*32/14*(1 - cos(0.7))" 1e-14
done
# y by 90 degrees about x is z, which stays z about z; the other way round it would be -x.
check "R*S turns by S first" near "$out" r3.z 0 1 1e-15
# omega is in the body's frame: (1, 2, 3) about axes that are turned by 90 degrees about z
check "R*omega(R) is the angular velocity in space, x" near "$out" r4.x 0 -2 1e-14
check "the same, y" near "$out" r4.y 0 1 1e-14
closed_form() { sed -n 's/^exact N.*largest deviation \([^,]*\),.*/\1/p' "$out.txt" | awk '$1 > 1e-11 { bad = 1 } END { exit NR != 4 || bad }'; }
check "turning about one axis is turn(n, w t)" closed_form

# ---- torques and forces ----
# 170 steps, each with an error of up to 1e-13 in a rate, which acts for 10 s
check "a torque about an axis of the body: w = w0 + tau t/C" near "$out" w.z 10 "pi + 0.6*10/3" 5e-11
check "a torque in space: L = tau t" near "$out" '(T*omega(T)).x' 10 "0.6*10/2" 5e-11
check "and none about y" near "$out" '(T*omega(T)).y' 10 0 5e-11
check "dissipation c/2 omega^2 brakes: exp(-c t/I)" near "$out" 'omega(B).y' 10 "-0.2*exp(-0.5*10/2)" 5e-11
check "a force at a point is that of its potential" near "$out" unlike 10 0 1e-12
# A compound pendulum on a ball joint with m g l = I + m l^2: th'' = -sin th; digits of tests/hard/cases.json, pendulum-th0-2.5
check "a pendulum on a ball joint, 1 s" near "$out" swing 1 2.18128590790872297093178299662 5e-11
check "a pendulum on a ball joint, 10 s" near "$out" swing 10 2.46853204863864863459435656744 1e-10
check "quaternions have length 1" near "$out" off 10 0 1e-15
# A rod falls at 1 m/s from 2 m, tilted by 0.5, on its lower end; m = 1, g = 2, inertia 2/3, half its length 1/2, no loss: it meets the ground at
# u = sqrt(1 + 2 g h), and gets the impulse p = 2 u/(1/m + (cos 0.5/2)^2/I).
u='sqrt(1 + 4*(2 - sin(0.5)/2))'
p="(2*$u/(1 + (cos(0.5)/2)^2*1.5))"
check "a rod falls on its end: it turns" near "$out" e.y 1 "-1.5*cos(0.5)/2*$p" 5e-11
check "and flies on" near "$out" "y'.z" 1 "-$u + $p - 2*(1 - ($u - 1)/2)" 5e-11

# ---- starts and events ----
out=$TMP/spun.csv
check "events run" sh -c '"$1" run "$2" -o "$3" >"$3.txt"' sh "$LAGC" $spun "$out"
# Equations symmetric in time: a turn of 2 s is undone in 2 s.
for c in w x y z; do check "omega = -omega: back at the start, $c" near "$out" "R[1].$c" 4 "$(value "$out" "R[1].$c" 0)" 1e-11; done
check "a start of each member" near "$out" 'w[2].z' 0 0.4 1e-15
# (1, 2, 2)/3 by 0.3; a product of turns, by Hamilton's rule
check "start: turn(axis, angle)" near "$out" 'R[2].y' 0 "2/3*sin(0.15)" 1e-15
check "start: a product of turns" near "$out" S.y 0 "sin(0.25)*sin(0.125)" 1e-15
# Turned by 90 degrees in space: Sz = cos z' + sin w' of the unturned body; the angular velocity in its own frame is unchanged.
sed '/^event turned/d' $spun >"$TMP/free.lag"
check "the same without the event" sh -c '"$1" run "$2" -o "$3" >"$3.txt"' sh "$LAGC" "$TMP/free.lag" "$TMP/free.csv"
check "R = turn*R in an event turns it in space" near "$out" S.z 4 "sqrt(0.5)*($(value "$TMP/free.csv" S.z 4) + $(value "$TMP/free.csv" S.w 4))" 1e-11
for c in x y z; do check "and keeps omega, $c" near "$out" v.$c 4 "$(value "$TMP/free.csv" v.$c 4)" 1e-11; done
# The command line gives the same result.
sed '/^  start/d' $spun >"$TMP/bare.lag"
bare() {
  "$LAGC" run "$TMP/bare.lag" 'R=turn((1, 2, 2), 0.3)' 'omega(R[1])=(0.1, 1, 0.2)' 'omega(R[2])=(0.1, 1, 0.4)' \
    'S=turn((0, 0, 1), 0.5)*turn((1, 0, 0), 0.25)' 'omega(S)=(0.3, 0.4, 0.5)' -o "$TMP/bare.csv" --quiet && cmp "$out" "$TMP/bare.csv"
}
check "the command line says the same as a scene" bare
"$LAGC" check $spun --allow-numeric >"$TMP/check.txt" 2>&1
check "three degrees of freedom a body" grep -q '^scene s: 9 degrees of freedom; 3 constraints, of rank 3 at the start$' "$TMP/check.txt"
check "the constraint of each is told" grep -q 'constraint R\[2\] (line 3): holonomic, the unit length of a rotation' "$TMP/check.txt"
check "Euler's equation agrees in numbers" grep -q "expect A\*omega(S)'.x: not proved, agrees to 1[4-7] digits" "$TMP/check.txt"
sed 's/(B - C)/(C - B)/' $spun >"$TMP/false.lag"
check "a false one is refuted" sh -c '"$1" check "$2" --allow-numeric 2>&1 | grep -q "is false"' sh "$LAGC" "$TMP/false.lag"

# ---- contacts ----
# A box falls on its four corners and comes to rest: three equations for four forces; the least ones are a quarter of the weight each.
for scene in flat tilted; do
  out=$TMP/$scene.csv
  check "a box falls, $scene" "$LAGC" run tests/exec/models/box.lag $scene -o "$out"
  for k in a b c d; do check "$scene: corner $k carries a quarter" near "$out" "lambda($k)" 5 "9.81/4" 1e-12; done
  check "$scene: it lies" near "$out" r.z 5 0.2 1e-14
done
# No friction: the box goes on sliding and turning; 30 steps at 1e-9.
check "it slides on" near "$TMP/flat.csv" r.x 5 5 1e-12
check "and turns on" near "$TMP/flat.csv" R.z 5 "sin(2.5)" 1e-8

# ---- derivations ----
energy_of() { "$LAGC" derive "models/$1.lag" | sed -n '/^energy/{n;s/^ *E = //p;}'; }
is "the energy is told by omega" 'A*w.x^2/2 + B*w.y^2/2 + C*w.z^2/2' "$(energy_of free_body)"
is "and by what else L is written with" "A*(w.x^2 + w.y^2)/2 + C*w.z^2/2 + m*g*h*axis.z" "$(energy_of lagrange_top)"
# A term of first degree, of a gyroscope in a turning frame, is not part of the energy: E = T2 - T0 + V.
cat >"$TMP/turning.lag" <<'E2'
model turning "A dumb-bell on a table that turns: terms of degree 2, 1 and 0 in L"
coord R: rotation, x [m]
param A = 2 [kg*m^2] > 0, m = 1 [kg] > 0, W = 3 [rad/s]
kinetic = A/2*dot(omega(R), omega(R)) + A*dot(omega(R), transpose(R)*(0, 0, W)) + A/2*W^2 + m/2*(x'^2 + (W*x)^2)
potential = 0 [J]
scene s { start omega(R) = (0, 0, 1), x = 2 [m], x' = 5 [m/s]; span 1 [s]; output energy every 1 [s] }
E2
"$LAGC" run "$TMP/turning.lag" -o "$TMP/turning.csv" --quiet
# 2/2 1^2 - 2/2 3^2 + 5^2/2 - (3 2)^2/2
check "terms of degree 1 are no energy" near "$TMP/turning.csv" energy 0 "1 - 9 + 12.5 - 18" 1e-14
check "and it is conserved" near "$TMP/turning.csv" energy 1 "-13.5" 1e-7

# ---- long runs ----
# A body about its middle axis, 10^5 steps of order 2: the energy returns to its digits, and so does the length.
long() {
  "$LAGC" run models/free_body.lag longer --step 0.01 --observe 'R.w^2 + R.x^2 + R.y^2 + R.z^2 - 1' --every 10 --json -o "$TMP/long.csv" >"$TMP/long.json" || return 1
  awk -F, 'NR > 1 && ($NF > 1e-14 || $NF < -1e-14) { print; bad = 1 } END { exit bad || NR < 100 }' "$TMP/long.csv" || return 1
  sed -n 's/.*"energy_drift": \([^,]*\),.*/\1/p' "$TMP/long.json" | awk '{ print; exit !($1 < 1e-13) }'
}
slow check "10^5 steps by variational: energy and length" long

# ---- embedded headers ----
cat >"$TMP/free_body.c" <<'E2'
#include <stdio.h>
#define FREE_BODY_IMPLEMENTATION
#include "free_body.h"
int main() {
  free_body_params p;
  free_body_state s;
  double worst = 0, length;
  free_body_defaults(&p);
  free_body_start(&p, &s);
  for (int i = 0; i < 10000; i++) {
    if (free_body_rk4_step(&p, &s, 1e-3) != FREE_BODY_OK) return printf("step %d\n", i), 1;
    length = s.q[0]*s.q[0] + s.q[1]*s.q[1] + s.q[2]*s.q[2] + s.q[3]*s.q[3];
    worst = fmax(worst, fabs(length - 1));
  }
  const double *q = s.q, *v = s.v, wx = 2*(q[0]*v[1] - q[1]*v[0] - q[2]*v[3] + q[3]*v[2]), z = 1 - 2*(q[1]*q[1] + q[2]*q[2]);
  printf("%g %.15g %.15g\n", worst, wx, z);
  /* digits of tests/hard/cases.json, hlw-free-rigid-body at t = 10: w1 and R33. 10^4 steps of order 4 and size 1e-3 */
  return !(worst < 1e-15 && fabs(wx - 0.203533068294020405) < 1e-11 && fabs(z - 0.233404013307185243) < 1e-11);
}
E2
"$LAGC" header models/free_body.lag -o "$TMP/free_body.h"
embedded() { "$@" -O2 -Wall -Wextra -Werror -I"$TMP" -o "$TMP/embedded" "$TMP/free_body.c" -lm && "$TMP/embedded"; }
check "an embedded header turns a body, in C" embedded "$CC" -std=c11
cp "$TMP/free_body.c" "$TMP/free_body.cc"
if command -v "${CXX:-c++}" >/dev/null; then
  embedded_cc() { "${CXX:-c++}" -std=c++17 -O2 -Wall -Wextra -Werror -I"$TMP" -o "$TMP/embedded_cc" "$TMP/free_body.cc" -lm && "$TMP/embedded_cc"; }
  slow check "and in C++" embedded_cc
fi
tap_end
