#!/bin/sh
# lagc run --gradient: derivatives of measures by all parameters and starts, against closed forms; refusals. Python's are in python/check_lagc.py.
. tests/tap.sh
cat >"$TMP/spring.lag" <<'M'
model spring
coord x [m]
param m = 2 [kg] > 0, k = 8 [N/m] > 0, v0 = 0.6 [m/s], F = 0 [N], unused = 1
input u [N] = F*t/1 [s]
lagrangian = m/2*x'^2 - k/2*x^2
force x = u
event kick: x - 5 [m] rising { x' = -x' }
scene go { start x = 0.5, x' = v0; span 3 [s]; output x }
scene slow { like go; start x = 0.1 }
M
run() { "$LAGC" run "$TMP/spring.lag" go --method dop853 --tol 1e-12 --until 1.3 "$@" --json >"$TMP/out.json" 2>"$TMP/err"; }
# d MEASURE NAME: that derivative.
d() { python3 -c 'import json, sys; print(repr(json.load(open(sys.argv[1]))["gradient"][sys.argv[2]][sys.argv[3]]))' "$TMP/out.json" "$1" "$2"; }
# x = 0.5 cos wt + v0/w sin wt, w = sqrt(k/m) = 2. within: the tolerance of the run, times some ten; at a maximum its place is known to 1e-8 of a step
check "a value at the end" run --gradient x --gradient 'late = x(1)' --gradient 'most = max(x)' --gradient 'p = 3*x(1)*max(x)'
near "by a start" 1e-10 -0.8568887533689472 "$(d x 'x(0)')"
near "... and by its velocity" 1e-10 0.2577506859107323 "$(d x "x'(0)")"
near "by the stiffness: w t/(2 k) (-0.5 sin wt + v0/w cos wt) - v0/(2 w k) sin wt" 1e-10 "$(awk 'BEGIN { w = 2; k = 8; t = 1.3; v = 0.6; printf "%.15g", w*t/(2*k)*(-0.5*sin(w*t) + v/w*cos(w*t)) - v/(2*w*k)*sin(w*t) }')" "$(d x k)"
near "by a parameter of the start, v0" 1e-10 0.2577506859107323 "$(d x v0)"
near "by that of an input's formula: (t - sin(wt)/w)/k" 1e-10 "$(awk 'BEGIN { printf "%.15g", (1.3 - sin(2.6)/2)/8 }')" "$(d x F)"
is "what it does not feel" 0 "$(d x unused | sed 's/\.0$//')"
near "at a time" 1e-10 "$(awk 'BEGIN { printf "%.15g", sin(2)/2 }')" "$(d late v0)"
near "of a maximum, sqrt(x0^2 + v0^2/w^2)" 1e-11 "$(awk 'BEGIN { printf "%.15g", 0.6/4/sqrt(0.25 + 0.09) }')" "$(d most v0)"
near "of a product" 1e-10 "$(awk 'BEGIN { a = sqrt(0.34); x = 0.5*cos(2) + 0.3*sin(2); printf "%.15g", 3*(sin(2)/2*a + x*0.15/a) }')" "$(d p v0)"
check "of the energy, m v0^2/2 + k x0^2/2, which contains parameters itself" run --gradient 'energy(1)'
near "... by the first of them, v0^2/2" 1e-10 0.18 "$(d 'energy(1)' m)"
near "... by the second, x0^2/2" 1e-10 0.125 "$(d 'energy(1)' k)"
check "by the Verlet family" run --method verlet8 --step 0.01 --gradient x
near "... of order 8" 1e-10 -0.8568887533689472 "$(d x 'x(0)')"
check "after a method without reverse mode, by dop853" run --method taylor --gradient x
near "... as well" 1e-8 -0.8568887533689472 "$(d x 'x(0)')"
automatic() { "$LAGC" run "$TMP/spring.lag" go --tol 1e-12 --until 1.3 --gradient x --json >"$TMP/out.json" 2>"$TMP/err" && grep -q '"method": "taylor"' "$TMP/out.json"; }
check "after Taylor series that were chosen automatically, by dop853, too" automatic
near "... as well" 1e-10 -0.8568887533689472 "$(d x 'x(0)')"
# Steps of a header in reverse: 130 of rk4 with h = 0.01, whose error is some 1e-9.
cat >"$TMP/header.c" <<'C'
#define SPRING_IMPLEMENTATION
#include "spring.h"
#include <stdio.h>
int main(void) {
  enum { STEPS = 130 };
  static spring_state s[STEPS + 1];
  spring_params p;
  double x[SPRING_NY] = {1, 0}, g[SPRING_NP] = {0};
  spring_defaults(&p);
  if (spring_start(&p, &s[0])) return 1;
  for (int i = 0; i < STEPS; i++) {
    s[i + 1] = s[i];
    if (spring_rk4_step(&p, &s[i + 1], 0.01, 0)) return 1;
  }
  for (int i = STEPS - 1; i >= 0; i--)
    if (spring_adjoint_step(&p, &s[i], 0.01, 0, x, g)) return 1;
  printf("{\"gradient\": {\"x\": {\"x(0)\": %.17g, \"v(0)\": %.17g, \"k\": %.17g, \"F\": %.17g}}}\n", x[0], x[1], g[SPRING_P_K], g[SPRING_P_F]);
  return 0;
}
C
header() { "$LAGC" header "$TMP/spring.lag" go --with adjoint -o "$TMP/spring.h" 2>/dev/null && "$CC" -O0 -Wall -Werror "$TMP/header.c" -o "$TMP/header" -lm && "$TMP/header" >"$TMP/out.json"; }
check "a header with steps in reverse" header
near "its gradient by a start" 1e-8 -0.8568887533689472 "$(d x 'x(0)')"
near "by a velocity" 1e-8 0.2577506859107323 "$(d x 'v(0)')"
near "by a parameter" 1e-8 "$(awk 'BEGIN { w = 2; k = 8; t = 1.3; v = 0.6; printf "%.15g", w*t/(2*k)*(-0.5*sin(w*t) + v/w*cos(w*t)) - v/(2*w*k)*sin(w*t) }')" "$(d x k)"
near "by one of an input's formula" 1e-8 "$(awk 'BEGIN { printf "%.15g", (1.3 - sin(2.6)/2)/8 }')" "$(d x F)"
text() { "$LAGC" run "$TMP/spring.lag" go --method dop853 --tol 1e-12 --until 1.3 --gradient x >"$TMP/text" && grep -q "^  d/dk  *-0.0[0-9]* m/(N/m)$" "$TMP/text"; }
check "as text, with units" text
told() { "$LAGC" run "$TMP/spring.lag" go --until 1 "$@" >"$TMP/text" 2>"$TMP/err"; }
none() { told --gradient "$1" && grep -qF "no gradient of $1: $2" "$TMP/text"; }
check "what has none says why" none megno "exponents have no gradient"
check "... as a measure without a value" none 'period(x)' "no period: it passes 0 upwards never"
check "means" run --gradient 'mean(x)' --gradient 'rms(x)'
near "... by a start: sin(wt)/(wt)" 1e-10 "$(awk 'BEGIN { printf "%.15g", sin(2.6)/2.6 }')" "$(d 'mean(x)' 'x(0)')"
near "... by a parameter of the start, (1 - cos(wt))/(w^2 t)" 1e-10 "$(awk 'BEGIN { printf "%.15g", (1 - cos(2.6))/4/1.3 }')" "$(d 'mean(x)' v0)"
# With C, S the integrals of cos^2 wt, cos wt sin wt: rms^2 t = x0^2 C + 2 x0 v0/w S + ..., whose half derivative is x0 C + v0/w S.
near "of a root of a mean square by a start" 1e-10 "$(awk 'BEGIN { t = 1.3; w = 2; C = t/2 + sin(2*w*t)/4/w; S = sin(w*t)^2/2/w; Q = t/2 - sin(2*w*t)/4/w; a = 0.5; b = 0.3
  printf "%.15g", (a*C + b*S)/t/sqrt((a*a*C + 2*a*b*S + b*b*Q)/t) }')" "$(d 'rms(x)' 'x(0)')"
# |cos wt| has a corner where wt = pi/2, within a step: its mean is (2 - sin wT)/(w T), and dw/dk = w/(2 k). A corner is cut off up to 1e-8 of a part.
corner() { "$LAGC" run "$TMP/spring.lag" go --method $1 --tol 1e-12 --until 1.3 x=1 v0=0 --gradient 'mean(abs(x))' --json >"$TMP/out.json" 2>"$TMP/err"; }
for method in dop853 taylor; do
  check "a mean over a corner by $method" corner $method
  near "... its value" 1e-11 0.5709610108378983 "$(sed 's/.*"mean(abs(x))": \([0-9.]*\).*gradient.*/\1/' "$TMP/out.json")"
  near "... by the stiffness" 1e-8 "$(awk 'BEGIN { a = 2.6; printf "%.15g", (-cos(a)/a - (2 - sin(a))/a/a)*1.3/8 }')" "$(d 'mean(abs(x))' k)"
done
# A ball that bounces: the first time T = sqrt(2 h/g), the second (1 + 2 e) T; an oscillator's period 2 pi sqrt(m/k). By Taylor series the gradient is
# that of dop853, whose event is beside that of the run by rounding. The mean by the way out of its message: of x = cos wt over 1.3 s, sin wt/(w t).
cat >"$TMP/drop.lag" <<'M'
model drop
coord y [m], x [m]
param g = 9.81 [m/s^2] > 0, h = 1.3 [m], e = 0.8, k = 4 [N/m] > 0, m = 1 [kg] > 0
state S [m*s]
flow S' = x
lagrangian = m*y'^2/2 - m*g*y + m*x'^2/2 - k*x^2/2
event floor: y falling { y' = -e*y' }
scene go { start y = h, x = 1; span 2 [s]; output y, x, S }
scene swing { like go; h = 1e6; span 7 [s] }
M
drop() { "$LAGC" run "$TMP/drop.lag" "$@" --tol 1e-12 --json >"$TMP/out.json" 2>"$TMP/err"; }
hits() { drop go "$@" --gradient 'hit(floor)' --gradient 'hit(floor, 2)'; }
for method in dop853 taylor radau; do
  check "times of an event by $method" hits --method $method
  near "... by the height, T/(2 h)" 1e-11 0.19800621511662161 "$(d 'hit(floor)' h)"
  near "... and of the next, (1 + 2 e) T/(2 h)" 1e-11 0.5148161593032162 "$(d 'hit(floor, 2)' h)"
  near "... by the restitution, 2 T" 1e-11 1.0296323186064325 "$(d 'hit(floor, 2)' e)"
done
check "the period, then the mean at the end, as a state" drop swing --gradient 'period(x)' --gradient 'average = S/(7 [s])'
near "... by the mass, P/(2 m)" 1e-11 1.5707963267948966 "$(d 'period(x)' m)"
near "... of the mean, by w/(2 k): (w t cos(w t) - sin(w t))/(w^2 t)/(2 k/w)" 1e-11 "$(awk 'BEGIN { w = 2; t = 7; printf "%.15g", (w*t*cos(w*t) - sin(w*t))/(w*w*t)*w/8 }')" "$(d average k)"
sed 's/^event floor.*/kick beat every h\/1 [m\/s] { x'"'"' = -x'"'"' }/' "$TMP/drop.lag" >"$TMP/beat.lag"
beats() { "$LAGC" run "$TMP/beat.lag" go --gradient 'hit(beat)' --json >"$TMP/out.json" 2>"$TMP/err"; }
check "the time of a kick, h" beats
near "... by its period" 1e-11 1 "$(d 'hit(beat)' h)"
# What an event moves: with V = sqrt(2 g h) the largest speed before the first bounce is V, behind it e V; the mean over [0, T] of the fall that the
# event ends is 2/3 h, that of the velocity -h/T, and the last velocity -V. A mean over bounces: the velocity's is (y(2) - h)/2, y(2) by its own gradient.
check "values at a bounce" drop go --method dop853 --gradient "max(-y')" --gradient "max(y')" --gradient "mean(y')" --gradient y
near "... before it, sqrt(g/(2 h))" 1e-11 1.942440970294058 "$(d "max(-y')" h)"
near "... behind it, e times that" 1e-11 1.553952776235247 "$(d "max(y')" h)"
near "... by the restitution, V" 1e-10 5.050346522764552 "$(d "max(y')" e)"
near "a mean over jumps" 1e-9 "$(awk -v y="$(d y e)" 'BEGIN { printf "%.15g", y/2 }')" "$(d "mean(y')" e)"
sed 's/{ y. = .*/{ stop }/' "$TMP/drop.lag" >"$TMP/stop.lag"
stops() { "$LAGC" run "$TMP/stop.lag" go --tol 1e-12 --method dop853 --json "$@" >"$TMP/out.json" 2>"$TMP/err"; }
check "a run that an event ends" stops --gradient end --gradient "y'" --gradient 'mean(y)' --gradient "rms(y')" --gradient 'min(y)'
near "... its end, 1/sqrt(2 g h)" 1e-11 0.19800621511662161 "$(d end h)"
near "... the velocity there" 1e-11 -1.942440970294058 "$(d "y'" h)"
near "... a mean" 1e-11 0.6666666666666667 "$(d 'mean(y)' h)"
near "... a root of a mean square, V/sqrt(3)" 1e-11 1.121468817084233 "$(d "rms(y')" h)"
near "... a smallest value, 0" 1e-11 0 "$(d 'min(y)' h)"
# Without programs in reverse each step is a matrix. Velocity at the floor: -sqrt(2 g h).
for method in dop853 radau; do
  among() { "$LAGC" run "$TMP/stop.lag" go --tol 1e-12 --method $method --measure "end_speed = -y'" --sensitivity h,g --json 2>"$TMP/err" | sed 's/"sensitivity"/"gradient"/' >"$TMP/out.json"; }
  check "a value at the end, among sensitivities, by $method" among
  near "... by the height" 1e-11 1.942440970294058 "$(d end_speed h)"
  near "... by g" 1e-11 0.2574080796516081 "$(d end_speed g)"
done
# Part of the time on the far side of 0, in a step: (t + x0/v)/t with x0 = -1, v = 1, t = 3, by differences of order 4: wrong by 1.5e-8 of it.
echo "model half; coord x; lagrangian = x'^2/2; scene s { start x = -1, x' = 1; span 3 }" >"$TMP/half.lag"
far='mean(if(x > 0, 1, 0))'
check "a mean of a value that jumps has no gradient" says 0 'a value jumps at a switch within the mean' "$LAGC" run "$TMP/half.lag" --gradient "$far"
among() { "$LAGC" run "$TMP/half.lag" --measure "far = $far" --sensitivity "x,x'" --json | sed 's/"sensitivity"/"gradient"/' >"$TMP/out.json"; }
check "... among sensitivities" among
near "... by the start" 1e-8 0.33333333333333333 "$(d far x)"
near "... by the velocity" 1e-8 0.33333333333333333 "$(d far "x'")"
check "... and as text" says 0 "derivatives of measures, by differences of runs" "$LAGC" run "$TMP/half.lag" --measure "far = $far" --sensitivity x
key() { "$LAGC" run "$TMP/stop.lag" go --measure y --sensitivity h --json 2>"$TMP/err" | grep -q '"y": {"h": [^}]*}.*"measure y": {"h": '; }
check "a measure that is called as an output has a key of its own" key
# The mean current until a motor has turned by 2 rad. Taylor series were chosen, and dop853, which differentiates, finds the end some numbers before that of
# the run. Digits: mpmath, 22 of them, differences of order 4.
cat >"$TMP/motor.lag" <<'M'
model motor
coord th [rad]
state i [A]
param J = 0.01 [kg*m^2] > 0, K = 0.1 [N*m/A], mgl = 0.2 [N*m], R = 1 [ohm], L = 0.5 [H] > 0, U = 6 [V]
lagrangian = J/2*th'^2 + mgl*cos(th)
force th = K*i
flow i' = (U - R*i - K*th')/L
event turned: th - 2 [rad] rising { stop }
scene go { span 5 [s]; output th }
M
motor() { "$LAGC" run "$TMP/motor.lag" --tol 1e-12 --gradient 'mean(i)' --json >"$TMP/out.json" 2>"$TMP/err"; }
check "a mean up to an event, by a method that was chosen" motor
near "... by the inertia" 1e-9 54.2846889160231239 "$(d 'mean(i)' J)"
# Contacts that close, without restitution, and open. Down a slope y = -b x: T = (b v + sqrt(b^2 v^2 + 2 g h))/g, then x' = (v + b g T)/(1 + b^2), x'' =
# g b/(1 + b^2); by b from differences of that form, of order 4. Off a cylinder: beside differences of runs, by sensitivities, which gradients equal below.
cat >"$TMP/slope.lag" <<'M'
model slope
coord x [m], y [m]
param g = 9.81 [m/s^2] > 0, h = 1 [m], v = 1.2 [m/s], b = 0.3
lagrangian = (x'^2 + y'^2)/2 - g*y
contact floor: y + b*x >= 0, restitution = 0
scene go { start x = 0, y = h, x' = v; span 1.2 [s]; tolerance 1e-12; output x }
M
cat >"$TMP/cylinder.lag" <<'M'
model cylinder
coord x [m], y [m]
param g = 9.81 [m/s^2] > 0, R = 1 [m] > 0, v = 0.6 [m/s], c = 0.05 [1/s]
lagrangian = (x'^2 + y'^2)/2 - g*y
dissipation = c/2*(x'^2 + y'^2)
contact floor: sqrt(x^2 + y^2) - R >= 0, restitution = 0
scene go { start x = 0.02, y = 1.05, x' = v; span 1 [s]; tolerance 1e-13; output x }
M
slides() { "$LAGC" run "$TMP/$1.lag" --method dop853 --gradient x --json >"$TMP/out.json" 2>"$TMP/err"; }
check "a contact that closes" slides slope
near "... by the slope" 1e-9 "$(awk 'function x(b) { T = (b*v + sqrt(b^2*v^2 + 2*g))/g; s = 1.2 - T; return v*T + (v + b*g*T)/(1 + b^2)*s + g*b/(1 + b^2)*s^2/2 }
  BEGIN { g = 9.81; v = 1.2; e = 1e-3; printf "%.12g", (8*(x(0.3 + e) - x(0.3 - e)) - x(0.3 + 2*e) + x(0.3 - 2*e))/12/e }')" "$(d x b)"
check "one that closes and opens, against differences" python3 tests/exec/sensitivity/differences.py "$LAGC" "$TMP/cylinder.lag" go 1e-8 g=9.81 R=1 v=0.6 c=0.05 --method dop853
rubs() { "$LAGC" run "$TMP/rub.lag" --method dop853 --gradient "$1" 2>"$TMP/err" | grep -qF "no gradient of $1: $2"; }
sed "s/^scene/observe F = sign(x')\nscene/; s/output x,x'/output x, F/" tests/exec/sensitivity/rub.lag >"$TMP/rub.lag"
check "a mean over a switch, where its value jumps, says so" rubs 'mean(F)' "a value jumps at a switch within the mean"
check "... and a largest value there" rubs 'max(F)' "its largest or smallest value is at a switch"
# Forward against adjoint: the same derivatives by --sensitivity, to 1e-12 of the largest: both round alike, but in another order. Of constraints, slides,
# implicit methods, series; at an event whose restitution follows from a parameter; at a time within a step.
dot() { # MODEL SCENE VALUE NAMES ARGS...
  model=$1 scene=$2 value=$3 names=$4
  shift 4
  "$LAGC" run "$model" $scene --gradient "$value" "$@" --json >"$TMP/gradient" 2>"$TMP/err" && "$LAGC" run "$model" $scene --sensitivity "$names" "$@" --json >"$TMP/forward" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }
  python3 - "$TMP/gradient" "$TMP/forward" "$value" <<'X'
import json, sys
adjoint, forward = (json.loads(open(f).read()) for f in sys.argv[1:3])
adjoint, forward = adjoint["gradient"][sys.argv[3]], forward["sensitivity"][sys.argv[3]]
size = max(abs(x) for x in forward.values())
bad = [(k, adjoint.get(k, adjoint.get(k + "(0)")), x) for k, x in forward.items() if abs(adjoint.get(k, adjoint.get(k + "(0)")) - x) > 1e-12*size]
sys.exit(str(bad) if bad or not size else 0)
X
}
S=tests/exec/sensitivity
cat >"$TMP/four_bar.lag" <<'M'
model four_bar
coord a [rad], b [rad], c [rad]
param r1 = 0.5 [m] > 0, r2 = 1.2 [m] > 0, r3 = 1 [m] > 0, d = 1.3 [m] > 0, M = 2 [kg] > 0, J = 0.2 [kg*m^2] > 0, g = 9.81 [m/s^2]
let x = r1*cos(a) + r2/2*cos(b), y = r1*sin(a) + r2/2*sin(b)
lagrangian = M/2*(x'^2 + y'^2) + J/2*(a'^2 + b'^2 + c'^2) - M*g*y
constraint across: r1*cos(a) + r2*cos(b) - r3*cos(c) = d
constraint up: r1*sin(a) + r2*sin(b) - r3*sin(c) = 0 [m]
scene turn {
  start a = 0.8, a' = 8 [rad/s]
  start guess b = 0.6, c = 1.5
  span 1 [s]
  output a
}
M
check "contacts that close and open" dot "$TMP/cylinder.lag" "" x "g,R,c,x,y,x'" --method dop853
check "a constraint" dot models/cartesian_pendulum.lag "" x "g,l,y,x'" --until 2 --method dop853
check "a rod whose length is a parameter" dot $S/rod.lag "" x l,g,a,w
check "a four-bar, whose start the constraints give" dot "$TMP/four_bar.lag" "" a "r1,r2,r3,d,M,a,a'" --method dop853
check "... by an implicit method" dot $S/rod.lag "" x l,g,a,w --method radau --tol 1e-8
check "dry friction that sticks and slips" dot $S/rub.lag "" x w,R,x0,v0
check "weights of a network" dot models/learned_spring.lag record x "V_w1[3,1],V_b1[5],V_w2[8],V_b2,x,m" --until 5 --method dop853
check "an implicit method" dot models/pendulum.lag wide th "g,l,th,th'" --until 2 --method radau
check "Taylor series" dot models/pendulum.lag wide th "g,l,th,th'" --until 2 --method taylor
check "... of a motion in which small changes grow" dot models/double_pendulum.lag swing th2 "l2,th1,th1'" --method taylor
cat >"$TMP/bounce.lag" <<'M'
model bounce
coord y [m]
param g = 9.81 [m/s^2] > 0, a = 0.9, e = a^2
lagrangian = y'^2/2 - g*y
event floor: y falling { y' = -e*y' }
scene go { start y = 1; span 1.3 [s]; output y }
M
check "a restitution that follows from a parameter" dot "$TMP/bounce.lag" "" y "g,a,e,y" --method dop853
sed 's/^event floor:.*/contact floor: y >= 0, restitution = e/' "$TMP/bounce.lag" >"$TMP/contact.lag"
check "... of a contact" dot "$TMP/contact.lag" "" y "g,a,e,y" --method dop853
# carts that meet at 2/3 s: v1 = -2 e then, so that the mean of x1 over 2 s changes by -(4/3)^2/2
elastic() { "$LAGC" run models/collisions.lag --until 2 --method dop853 --gradient 'mean(x1)' --json >"$TMP/out.json" 2>"$TMP/err"; }
check "a restitution of 1, about which differences go" elastic
near "... a mean" 1e-9 -0.888888888888889 "$(d 'mean(x1)' e)"
within() { # the rod's x at 1.9, within a step
  "$LAGC" run $S/rod.lag --gradient 'late = x(1.9)' --json >"$TMP/out.json" && late=$(d late w) && "$LAGC" run $S/rod.lag --gradient x --until 1.9 --json >"$TMP/out.json" && close_to "$(d x w)" "$late" 1e-12
}
check "a time within a step" within
# Units of steps that are recorded again: gradient_units.c.
units() { # MODEL SCENE METHOD
  "$LAGC" emit "$1" --with derivatives -o "$TMP/units.c" 2>"$TMP/err" && "$CC" -O1 -Iruntime/include -DSCENE="$2" "-DMETHOD=\"$3\"" tests/exec/gradient_units.c "$TMP/units.c" "$BUILD/liblag.a" -lm -o "$TMP/units" && "$TMP/units" >"$TMP/out" && ! grep '^not' "$TMP/out" || { cat "$TMP/err" "$TMP/out"; return 1; }
}
check "units of steps" units models/double_pendulum.lag double_pendulum_swing dop853
slow check "... of slides" units "$S/rub.lag" rub_s dop853
slow check "... with a constraint, implicit" units "$S/rod.lag" rod_s radau
# 2000 components by 2001 starts and parameters: 31 MB a matrix, 12 for the stages of dop853, 4 for the Jacobian, the columns,
# and those of a stage and of the result.
printf '%s\n' 'model family' 'const N = 1000' 'param k = 1' 'coord w[N]' \
  "lagrangian = sum(i in 1..N, (w[i]'^2 - k*w[i]^2)/2)" 'scene s { start w[i in 1..N] = i/N; span 1 }' >"$TMP/family.lag"
too_large() { (ulimit -v 400000 && "$LAGC" run "$TMP/family.lag" --method dop853 --gradient 'w[1]'); }
check "a gradient too large for memory says so" says 0 "no gradient of w[1]: out of memory: derivatives of 2000 components" too_large
check "how large, and what to do" grep -q 'take 5[0-3][0-9] MB; ask for fewer columns, as by .--sensitivity NAME' "$TMP/out"
tap_end
