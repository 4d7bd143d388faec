#!/bin/sh
# Accelerations under constraints, and multipliers:
#   1. the solver of lag_kkt.h against GSL's singular value decomposition, redundant constraints and all; large systems, within a band or not, against elimination;
#   2. systems with a closed form, one for each kind of constraint (models/constrained.lag).
. tests/tap.sh
model=tests/exec/models/constrained.lag

# ---- 1. the solver ----
if [ -n "$GSL" ]; then
  kkt() { $CC -std=c11 -O1 -Wall -Wextra -Werror -Wno-misleading-indentation -Iruntime/include -o "$TMP/kkt" tests/exec/constraints/kkt.c -lgsl -lgslcblas -lm && "$TMP/kkt"; }
  check "lag_kkt: solution and least multipliers to 1e-10 of an SVD" kkt
fi

band() { $CC -std=c11 -O1 -Wall -Wextra -Werror -Wno-misleading-indentation -Iruntime/include -o "$TMP/band" tests/exec/constraints/band.c -lm && "$TMP/band"; }
check "lag_kkt within a band: chains, rings, without inertia here and there, and what is left to the other solvers" band

# ---- 2. closed forms ----
# At the start of the scene, in the order of its outputs, by the theory of each small system:
#   rod     lambda = m (g y - v^2)/(2 l^2), x'' = 2 x lambda/m
#   table   lambda = m g
#   grows   r'' = 0, so lambda = -m r th'^2 with th' = (X Y' - Y X')/r^2, X'' = lambda X/(r m)
#   blade   along the blade at speed 1, turning at 2: (s'', k'') = 2 (-sin a, cos a), lambda = -2 m
#   roll    r'' = 2/7 W e_z x r' (any textbook: the ball on a turntable), lambda = m bx''
#   curve   u'' = -2 u, and the force that holds the coordinate without inertia, m
#   tied    m + 3 m falls by the weight of m: n.y'' = -g/4, lambda = (0, 3 m g/4)
#   apart   the weight m g on m + 2 m + 3 m; of l1 + 2 l3 = -5 m g/6, l2 + 2 l3 = -m g/2 the least: 18 l3 = 8 (-4/3 m g/2)
expected() {
  awk 'BEGIN { OFMT = "%.17g"; m = 2; g = 9.81; l = 3; W = 3; a = 0.7
    lr = m*(g*(-2.4) - 0.25)/(2*l*l); print 2*1.8*lr/m; print lr; print 0; print m*g
    th = (2.4*(-0.5) - 1.8*1)/9; lg = -m*l*th*th; print lg*2.4/(l*m); print lg
    print -2*sin(a); print 2*cos(a); print -2*m
    print -2/7*W*0.1; print 2/7*W*0.2; print -m*2/7*W*0.1
    print -0.6; print m; print 0; print -g/4; print 0; print 3*m*g/4
    z = -(8/18)*(4/3)*m*g/2; print -g/12*2*m/m/1; print -5*m*g/6 - 2*z; print -m*g/2 - 2*z; print z }'
}
row() { sed -n 2p "$1" | tr ',' '\n' | sed 1d; }
near() { # FILE TOLERANCE: two columns, got and expected
  awk -v tol="$2" '{ d = $1 - $2; size = $2 < 0 ? -$2 : $2; if (size < 1) size = 1
    if (!(d <= tol*size && -d <= tol*size)) { print NR ": " $0; bad = 1 } } END { exit bad || NR != 22 }' "$1"
}
agrees() { # TOLERANCE OPTIONS...
  tol=$1
  shift
  "$LAGC" run $model --method rk45 -o "$TMP/out.csv" "$@" >"$TMP/log" 2>&1 || { cat "$TMP/log"; return 1; }
  row "$TMP/out.csv" >"$TMP/got"
  expected >"$TMP/expected"
  paste "$TMP/got" "$TMP/expected" >"$TMP/both"
  near "$TMP/both" "$tol"
}
# Rounding: 21 coordinates, 12 constraints, numbers of the order of 10.
check "accelerations and multipliers of closed forms" agrees 1e-13
# awk has doubles, and so has the start's text
slow check "the same with 34 digits" agrees 1e-15 --precision quad
check "lagc check counts freedoms and names what is redundant" sh -c '"$1" check "$2" | grep -q "10 degrees of freedom; 12 constraints, of rank 11"' sh "$LAGC" $model
redundant() { "$LAGC" check $model | grep 'follows from' | sed 's/^ *constraint \([^ ]*\).*/\1/'; }
is "what follows from others" again "$(redundant)"
loose() { "$LAGC" check $model | grep -c 'not unique'; }
is "multipliers that are not unique" 3 "$(loose)"

# ---- constraints that become dependent on the way: four bars come to lie in a line at t = 1 and 1 + pi, ...; a multiplier has its limit there, and no
# value within a thousandth of it. b = 0, a = c = 1 - t: mass 2 goes round with a' = -1, so lambda(cy) = m y2'' = -m l sin a, and without inertia c has lambda(cx) sin c = lambda(cy) cos c
tends() { # EVERY ARGS...
  every=$1
  shift
  "$LAGC" run tests/exec/models/rhomb.lag s --every "$every" -o "$TMP/out.csv" --quiet "$@" || return 1
  awk -F, '$5 == "nan" && $6 == "nan" { none++; next } NR > 1 { d = $5 + cos($2); d = d < 0 ? -d : d; if (!(d <= 1e-3)) { print; bad = 1 } if (!($6*$6 <= 1e-6)) { print; bad = 1 } } END { exit bad || none < 1 || none > 2 || NR < 5 }' "$TMP/out.csv"
}
for every in 1 0.01; do # 1e-3: effect of 1e-8 between the ends of a step near the line; on it, 2e21
  check "through a line: dop853, rows every $every" tends $every --until 5 --tol 1e-12
  check "rk45" tends $every --until 5 --method rk45 --tol 1e-12
done
shown() { "$LAGC" run tests/exec/models/rhomb.lag "$@" -o "$TMP/out.csv" --quiet; sed -n "${row}p" "$TMP/out.csv" | cut -d, -f "$column"; }
row=2 column=2
is "at a start in the line the least multiplier is 0" 0 "$(shown folded)"
row=2 column=5
is "a start that is nearly there has none" nan "$(shown s a=1e-9 c=1e-9)"

# ---- lengths as far from angles as l from 1: a rack of mass m between two gears of radius l and inertia m l^2, turned by m l g ----
# One degree of freedom, of 3 m l^2: a'' = -g/(3 l), and on the rack lambda(back) = m g/3, so lambda(rack) = m x'' - m g/3 = -2 m g/3
cat >"$TMP/gears.lag" <<'EOF'
model gears "A rack between two gears"
coord x [m], a [rad], b [rad]
param m = 1 [kg] > 0, g = 3 [m/s^2], l = 1 [m] > 0
lagrangian = m/2*x'^2 + m*l^2/2*(a'^2 + b'^2) - m*l*g*a
constraint rack: x = l*a
constraint back: x = -l*b
scene go {
  start a = 0.5 [rad]
  span 1 [s]
  output x, a, b, lambda(rack), lambda(back)
}
EOF
for l in ${SLOW:+1 1e9} 1e-9; do
  sed "s/l = 1 /l = $l /; s/g = 3 /g = 3*$l /" "$TMP/gears.lag" >"$TMP/gears_l.lag"
  check "l = $l: both constraints count" sh -c '"$1" check "$2" | grep -q "1 degree of freedom; 2 constraints, of rank 2 at the start"' sh "$LAGC" "$TMP/gears_l.lag"
  check "and in a run" sh -c '"$1" run "$2" -o "$3" | grep -q "2 independent at the start"' sh "$LAGC" "$TMP/gears_l.lag" "$TMP/out.csv"
  # at t = 1: a = 0.5 - 1/2; rounding of sums of a half
  check "its motion and multipliers" awk -F, -v l="$l" 'END { n = split("0 0 0 " (-2*l) " " l, want, " ")
    for (i = 1; i <= n; i++) { d = $(i + 1) - want[i]; size = i == 1 || i > 3 ? l : 1; if (!(d*d <= 1e-28*size*size)) { print i, $(i + 1), want[i]; bad = 1 } } exit bad }' "$TMP/out.csv"
done

# The rack with one constraint given twice, solved by the null space method with the units from the compiler. x'' = F/(3 m), th = x/l
cat >"$TMP/twice.lag" <<'EOF'
model twice "Two gears on a rack, and one of the constraints twice"
coord x [m], th [rad], ph [rad]
param m = 1 [kg] > 0, l = 1e-9 [m] > 0, F = 3 [N]
lagrangian = m/2*x'^2 + m*l^2/2*(th'^2 + ph'^2) + F*x
constraint rack: x = l*th
constraint mesh: th = ph
constraint again: x = l*ph
scene s { span 2; output x, l*th, l*ph }
EOF
twice() { "$LAGC" run "$TMP/twice.lag" -o "$TMP/out.csv" && awk -F, 'END { for (i = 2; i <= 4; i++) if (!(($i - 2)^2 < 1e-28)) { print; exit 1 } }' "$TMP/out.csv"; }
check "l = 1e-9: one of three follows from the others, and the motion is that of a closed form" twice

# ---- 3. embedded headers ----
# A million steps of RK4: without NAME_hold the circle is left by 7e-5; with it by rounding, and the energy's error is that of the method.
cat >"$TMP/circle.lag" <<'EOF'
model circle "A pendulum in Cartesian coordinates"
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2], l = 1 [m] > 0
lagrangian = m/2*(x'^2 + y'^2) - m*g*y
constraint rod: x^2 + y^2 = l^2
scene swing { start x = 1 [m] }
EOF
cat >"$TMP/circle.c" <<'EOF'
#include <stdio.h>
#define CIRCLE_IMPLEMENTATION
#include "circle.h"
int main(void) {
  circle_params p;
  circle_state s;
  double worst = 0, e[2];
  circle_defaults(&p);
  circle_start(&p, &s);
  s.q[0] = 3, s.q[1] = 4, s.v[0] = 1;
  if (circle_hold(&p, &s) || fabs(s.q[0] - 0.6) > 1e-15 || fabs(s.q[1] - 0.8) > 1e-15 || fabs(s.v[0] - 0.64) > 1e-15) return printf("hold\n"), 1;
  circle_start(&p, &s);
  for (int i = 0; i < STEPS; i++) {
    if (circle_rk4_step(&p, &s, 1e-3) != CIRCLE_OK) return printf("step %d\n", i), 1;
    worst = fmax(worst, fabs(s.q[0]*s.q[0] + s.q[1]*s.q[1] - 1));
  }
  circle_energy(s.t, s.q, s.v, &p, e);
  printf("%g %g\n", worst, e[0]);
  return !(worst <= 1e-15 && fabs(e[0]) < 1e-8);
}
EOF
embedded() { # a million steps, in `make test` a tenth, of a method of order 4 and size 1e-3 change the energy by some 1e-9
  "$LAGC" header "$TMP/circle.lag" -o "$TMP/circle.h" &&
    $CC -std=c11 -O2 -Wall -Wextra -Wconversion -Werror "-DSTEPS=${SLOW:+10}00000" -I"$TMP" -o "$TMP/circle" "$TMP/circle.c" -lm && "$TMP/circle"
}
check "an embedded header holds its constraints over many steps" embedded
tap_end
