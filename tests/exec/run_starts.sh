#!/bin/sh
# Starts of models with constraints: `lagc check` and `lagc run`, which find the start by one search with separate equations, agree. Impossible starts
# are refused by both with the name of the constraint at fault; accepted ones have the same rank.
. tests/tap.sh

model() { cat >"$TMP/$1.lag"; }
# one LINE...: a particle in the plane with a turning body, and the statements LINE
one() {
  {
    echo 'model one "A particle that something holds"'
    echo 'coord x [m], y [m], th [rad] periodic'
    echo 'param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, l = 1 [m] > 0, J = 1 [kg*m^2] > 0, v = 1 [m/s]'
    echo "lagrangian = m/2*(x'^2 + y'^2) + J/2*th'^2 - m*g*y"
    printf '%s\n' "$@"
  } >"$TMP/one.lag"
}
checks() { "$LAGC" check "$@" >"$TMP/check" 2>&1; }
runs() { "$LAGC" run "$@" -o "$TMP/rows.csv" >"$TMP/run" 2>&1; }
says() { grep -qF -e "$1" "$2" || { cat "$2"; return 1; }; }
# refused CONSTRAINT WORDS [MODEL [SCENE]]: by both, with no rows; in `make test` every third by a run, too
refused() {
  rm -f "$TMP/rows.csv"
  checks "$TMP/${3:-one}.lag" && { cat "$TMP/check"; return 1; }
  says "\`$1\`" "$TMP/check" && says "$2" "$TMP/check" || return 1
  one_of ${one_in:-3} || return 0
  runs "$TMP/${3:-one}.lag" ${4:+"$4"} && { cat "$TMP/run"; return 1; }
  says " $1 (line" "$TMP/run" && says "$2" "$TMP/run" && [ ! -e "$TMP/rows.csv" ]
}
# always_refused ...: by a run each day
always_refused() { one_in=1; refused "$@"; got=$?; one_in=; return $got; }
# taken RANK COUNT MODEL [SCENE]: by both, with RANK of COUNT constraints independent
taken() {
  checks "$TMP/$3.lag" || { cat "$TMP/check"; return 1; }
  runs "$TMP/$3.lag" ${4:+"$4"} || { cat "$TMP/run"; return 1; }
  says "${4:+scene $4: }" "$TMP/check" && says "$2 constraint$([ "$2" = 1 ] || echo s), of rank $1 at the start" "$TMP/check" && says "constraints: $2, $1 independent" "$TMP/run"
}
value() { sed -n "s/^  $1  *\\([-+0-9.e]*\\) .*/\\1/p" "$TMP/run"; }
near() { close_to "$@"; }

# ---- constraints that cannot be held
one 'constraint c: x^2 = 0 [m^2]' 'scene s { start x = 1 [m]; span 2 [s] }'
check "a square, from afar" refused c 'derivatives of the constraint'
one 'constraint c: (x^2 + y^2 - l^2)^2 = 0 [m^4]' "scene s { start x = 1 [m], x' = 1 [m/s]; span 2 [s] }"
check "a square, where it holds" refused c 'vanish where it holds'
one 'constraint c: (x^2 + y^2 - l^2)^2 = 0 [m^4]' 'contact floor: y >= -2*l, restitution = 0.5' 'scene s { start x = 1 [m]; span 2 [s] }'
check "a square beside a contact" always_refused c 'vanish where it holds'
one 'constraint c: exp(-x^2/l^2) = 0' 'scene s { start x = 1 [m]; span 2 [s] }'
check "where the derivatives vanish beside it" refused c 'vanish where it holds'
one 'constraint c: x^2 + y^2 = -l^2' 'scene s { start x = 1 [m]; span 2 [s] }'
check "what no place obeys" refused c 'off by 1 '
silent() { "$LAGC" run "$TMP/one.lag" -o - >"$TMP/rows" 2>"$TMP/run"; [ $? = 2 ] && [ ! -s "$TMP/rows" ]; }
check "nothing is written, not even a header" silent
one 'param k = 0 [1]' 'constraint c: k*x = l' 'scene s { start x = 1 [m]; span 2 [s] }'
check "a factor that is 0" refused c 'off by 1 '
one 'constraint c: exp(th) = 0' 'scene s { start x = 1 [m]; span 2 [s] }'
check "what holds at no place" refused c 'vanish where it holds'
one 'constraint c: sqrt(x - l) = 0' 'scene s { start x = 2 [m]; span 2 [s] }'
check "a root" refused c 'have no value where it holds'
one 'constraint c: log(x/l) = 0' 'scene s { start x = -2 [m]; span 2 [s] }'
check "where there is no value" always_refused c 'has no value at the start'
one 'constraint c: x^2 + y^2 = l^2' 'contact wall: x >= -2*l, restitution = 0.5' 'scene s { start x = 1e200 [m]; span 2 [s] }'
check "where it is too large" refused c 'has no value at the start'
one 'constraint c: x^2 + y^2 = l^2' 'constraint d: x = 2*l' 'scene s { start x = 1 [m]; span 2 [s] }'
check "two that exclude each other" refused d 'off by 1 '
one 'constraint c: x + y = 6 [m]' 'scene s { start exactly x = 1 [m]; span 1 [s] }'
check "exactly" refused c 'without `exactly` the nearest start is taken'
one 'constraint c: x = l' "scene s { start exactly x = 1 [m], x' = 1 [m/s]; span 1 [s] }"
check "exactly, velocities" refused c 'without `exactly` the nearest start is taken'

# ---- constraints that agree at the start only
contradicts() { # WORDS: check says so, and a run, naming the same constraint, with no rows
  rm -f "$TMP/rows.csv"
  checks "$TMP/one.lag" && return 1
  says '`b` contradicts the constraints before it: ' "$TMP/check" && says "$1" "$TMP/check" || return 1
  runs "$TMP/one.lag" && return 1
  says 'b (line 6) is off by' "$TMP/run" && says 'contradict each other soon after the start' "$TMP/run" && [ ! -e "$TMP/rows.csv" ]
}
one 'constraint a: x = 0 [m]' "constraint b: x' = v*(t/1 [s])" 'scene s { span 1 [s] }'
check "another acceleration" contradicts 'demands another acceleration'
one 'constraint a: x = 0 [m]' "constraint b: x' = v*(t/1 [s])^2" 'scene s { span 1 [s] }'
check "the same acceleration, and another speed" contradicts 'no state obeys them all; it is off by 9.54e-07 [m/s]' # v (1/1024)^2
one 'constraint a: x = 0 [m]' 'constraint b: 2*x = 0 [m]' "constraint c: x' + th'*0 [m] = 0 [m/s]" "scene s { start y = 1 [m], y' = 1 [m/s]; span 1 [s] }"
check "those that say the same do not contradict" taken 1 3 one

# ---- directions without inertia
model ker <<'END'
model ker "A coordinate that a factor of 0 leaves alone"
coord x [m], z [m]
param m = 1 [kg] > 0, k = 0 [kg], c = 0 [1]
lagrangian = m/2*x'^2 + k/2*z'^2
constraint b: z*c = x*c
scene s { start x = 1 [m], x' = 1 [m/s]; span 1 [s] }
END
lacks() { rm -f "$TMP/rows.csv"; ! checks "$TMP/ker.lag" && says 'the motion of `z` is undetermined' "$TMP/check" && ! runs "$TMP/ker.lag" && says 'the mass matrix is singular: z has no inertia' "$TMP/run" && [ ! -e "$TMP/rows.csv" ]; }
check "a coordinate without inertia that nothing moves" lacks
# At one place only: at z = 0 the parabola lets z move without x.
sed "s/lagrangian = .*/lagrangian = m\/2*x'^2/; s/constraint b: .*/constraint b: x = z^2\/1 [m]/; s/start .*;/start z = 0 [m];/" "$TMP/ker.lag" >"$TMP/apex.lag"
mv "$TMP/ker.lag" "$TMP/kept.lag" && cp "$TMP/apex.lag" "$TMP/ker.lag"
check "a coordinate without inertia that nothing moves at the start" lacks
mv "$TMP/kept.lag" "$TMP/ker.lag"
sed -i 's/k = 0 /k = 1 /' "$TMP/ker.lag"
free() { taken 0 1 ker && near "$(value x)" 2 1e-9 && near "$(value z)" 0 1e-12; }
check "with inertia, a constraint that says nothing is none" free

model rail <<'END'
model rail "A bead on a parabola: its parameter has no inertia"
coord x [m], y [m], s [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0
lagrangian = m/2*(x'^2 + y'^2) - m*g*y
constraint a: x = 2*s
constraint b: y = s^2/1 [m]
scene one { start s = 1 [m]; span 1 [s]; output lambda(b) every 0.5 [s] }
scene kept { like one; method variational(step = 1e-3) }
END
check "by dop853 it moves" runs "$TMP/rail.lag" one
# Methods that find velocities from momenta: constraints add inertia to their directions. Against dop853, whose M is as written, of order 2 and 4;
# the factor by which half the step shrinks the error
x_of() { runs "$TMP/rail.lag" one "$@" >/dev/null && value x; }
exact=$(x_of --method dop853 --tol 1e-14)
order() { # METHOD STEP FACTOR LEAST MOST
  one=$(x_of --method "$1" --step "$2")
  half=$(x_of --method "$1" --step "$(awk -v h="$2" 'BEGIN { print h/2 }')")
  awk -v a="$one" -v b="$half" -v x="$exact" -v least="$3" -v most="$4" 'BEGIN { r = (a - x)/(b - x); print a - x, b - x, r; exit !(a != "" && r >= least && r <= most) }'
}
check "variational has order 2 there" order variational 4e-3 3.8 4.2
check "verlet" order verlet 4e-3 3.8 4.2
check "symplectic_euler 1" order symplectic_euler 4e-3 1.8 2.2
check "verlet4 4" order verlet4 2e-2 14 18
trend() { runs "$TMP/rail.lag" one --method variational --step 1e-2 --until 200 && says 'oscillates' "$TMP/run" && says 'constraint residual: ' "$TMP/run" && grep -q 'residual: [0-9.]*e-1[56], of rates [0-9.]*e-1[56]' "$TMP/run"; }
check "its energy has no trend" trend
forces() { # at rest at s = 1, y = x^2/4 has slope s: lambda(b) = m (g + y'') = m g (1 - s^2/(1 + s^2))
  "$LAGC" run "$TMP/rail.lag" kept -o "$TMP/rows.csv" --quiet && near "$(sed -n 2p "$TMP/rows.csv" | cut -d, -f2)" 4.905 1e-12
}
check "multipliers stay" forces
kept() { checks "$TMP/rail.lag" kept && says 'scene kept: ok' "$TMP/check"; }
check "lagc check takes such a scene" kept

# ---- the nearest of several states
# Two rods and a slider. Nearest by SLSQP (SciPy) from 60 places each: at 2.257, 0.2216 and 1.8148 from the request; other assemblies are 2.4 to 28.7 away.
model loop <<'END'
model loop "A loop of three rods"
coord a [rad], b [rad], c [rad]
let P = 1 [m]*(0.8*(cos(a), sin(a)) + 2*(cos(a - b), sin(a - b)) + (cos(a - b - c), sin(a - b - c)))
kinetic = 1 [kg*m^2]*(a'^2 + b'^2 + c'^2)/2
constraint cx: P.x = 2 [m]
constraint cy: P.y = 0 [m]
scene s { span 1e-9 [s] }
END
moved() { # DISTANCE A B C
  want=$1
  runs "$TMP/loop.lag" "a=$2" "b=$3" "c=$4" && echo "$2 $3 $4 $(value a) $(value b) $(value c)" | awk -v d="$want" '{ far = sqrt(($1-$4)^2 + ($2-$5)^2 + ($3-$6)^2) - d; print far; exit !(far < 1e-3 && -far < 1e-3) }'
}
check "the nearest assembly" moved 2.257 0.97 -0.6 0.41
check "another" moved 1.8148 -0.57425656 2.47622532 0.92788569
# Open angles stay near, by less than a turn: with a at 10 degrees the rods are d apart at angle f, and have two places (cosine rule), of which the other one is told.
nearest_turn() {
  sed 's/span 1e-9/start a = 10*pi\/180; span 1e-9/' "$TMP/loop.lag" >"$TMP/open.lag"
  runs "$TMP/open.lag" && near "$(value c)" 2.6421428398768 1e-9 && near "$(value b)" -0.1147600367903 1e-9
}
check "open angles stay near" nearest_turn
tells_other() { "$LAGC" run "$TMP/open.lag" | grep -q 'other places obey them, too: b = 0.69204 rad, c = -2.64214 rad; `start guess b = 0.692` takes that one'; }
check "and the other assembly is told" tells_other
takes_other() { sed 's/start a/start guess b = 0.692; start a/' "$TMP/open.lag" >"$TMP/other.lag" && runs "$TMP/other.lag" && near "$(value c)" -2.6421428398768 1e-9; }
check "and taken" takes_other
# Two rails without play: of velocities that are left open none drives the slider into a rail, so that a' stays: b' = r cos(a) a'/(l cos(b)).
cat >"$TMP/rails.lag" <<'END'
model rails
coord a [rad], b [rad], x [m], y [m]
param r = 0.1 [m], l = 0.25 [m]
kinetic = 0.005 [kg*m^2]*(a'^2 + b'^2) + 1 [kg]*(x'^2 + y'^2)
constraint px: x = r*cos(a) + l*cos(b)
constraint py: y = r*sin(a) - l*sin(b)
contact low: y >= 0, restitution = 0
contact high: -y >= 0 [m], restitution = 0
let bent = asin(r*sin(1)/l)
scene run { start a = 1, b = bent, x = r*cos(1) + l*cos(bent), a' = 5 [rad/s]; span 1e-9 [s]; output y every 1 }
END
for by in dop853 'moreau(step=1e-10)'; do
  between() { runs "$TMP/rails.lag" --method "$by" && near "$(value "a'")" 5 1e-6 && near "$(value "b'")" 1.14756274670073 1e-6; }
  check "open velocities, by $by" between
done
header_start() { "$LAGC" header "$TMP/rails.lag" --with moreau --prefix rails -o - | grep -q '1\.147562746700'; }
check "and in headers" header_start
# What the scene sets moves least: sin(b) = r/l sin(a) holds near a = 1 at b = 0.34325.
model crank <<'END'
model crank "A slider-crank whose slider is left open"
coord a [rad], b [rad], x [m]
param r = 0.1 [m] > 0, l = 0.25 [m] > 0
kinetic = 1 [kg*m^2]*(a'^2 + b'^2)/2 + 1 [kg]*x'^2/2
constraint px: x = r*cos(a) + l*cos(b)
constraint py: r*sin(a) = l*sin(b)
scene s { start a = 1, b = 0.34; span 1e-9 [s] }
END
open_first() { runs "$TMP/crank.lag" && near "$(value a)" 1 1e-3 && near "$(value b)" 0.34325 1e-3; }
check "what the scene leaves open moves first" open_first
# On a parabola: steps along it are damped, as it bends more than the request is far; a state of size 0 is one. Nearest: x - 1/2 + 2 x (x^2 + 1) = 0, by bisection; steps end within 1e-7 of it.
model parabola <<'END'
model parabola "A bead on a parabola"
coord x [m], y [m]
lagrangian = 1 [kg]*(x'^2 + y'^2)/2
constraint c: y = x^2/(1 [m])
scene both { start x = 0.5, y = -1; span 1e-9 [s] }
scene below { start y = -1; span 1e-9 [s] }
END
bent() { runs "$TMP/parabola.lag" both && near "$(value x)" 0.1637400010366631 1e-6; }
check "the nearest place of a parabola" bent
vertex() { runs "$TMP/parabola.lag" below && near "$(value y)" 0 1e-12; }
check "its vertex, from below" vertex
# A coordinate that no constraint contains stays, whatever inertia couples it to those that move.
model cart <<'END'
model cart "A pendulum on a cart that a drive sets in motion"
coord x [m], th [rad]
lagrangian = 1 [kg]*(x'^2 + (x' + 1 [m]*cos(th)*th')^2 + (1 [m]*sin(th)*th')^2)/2
constraint drive: x = 0.2 [m/s]*t
scene s { start th = 0.2; span 1e-9 [s] }
END
stays() { runs "$TMP/cart.lag" && near "$(value "x'")" 0.2 1e-12 && near "$(value "th'")" 0 1e-8; }
check "what no constraint contains stays" stays

# ---- singular places
model chain <<'END'
model chain "A chain that lies folded on a line"
const N = 5
coord r[N]: vec2 [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, l = 0.2 [m] > 0
kinetic = sum(i in 1..N, m/2*dot(r[i]', r[i]'))
potential = sum(i in 1..N, m*g*r[i].y)
constraint first: norm(r[1]) = l
for i in 2..N { constraint rod[i]: norm(r[i] - r[i-1]) = l }
constraint last: r[N] = (0.6 [m], 0 [m])
scene s { start r[1].x = 0.2 [m], r[2].x = 0.4 [m], r[3].x = 0.6 [m], r[4].x = 0.8 [m], r[5].x = 0.6 [m]; span 0.1 [s] }
END
check "a folded chain" taken 6 7 chain
model dead <<'END'
model dead "Four bars at their dead centre: one of the equations has no derivative there"
coord a [rad], b [rad], c [rad]
param m = 1 [kg] > 0, l = 1 [m] > 0
kinetic = m*l^2/2*(a'^2 + b'^2 + c'^2)
constraint cx: l*cos(a) + l*cos(b) = l + l*cos(c)
constraint cy: l*sin(a) + l*sin(b) = l*sin(c)
scene s { start a = 0 [rad]; span 0.1 [s] }
END
check "a linkage at its dead centre" taken 1 2 dead
# a' + b' = c' of any ratio there; beside it b' = 0, or a' = 0
singular() { says "singular start: the rank is 2 near it; the constraints do not determine a', b', c' here" "$TMP/check" && says "1 independent at the start; singular: 2 nearby, and the starting value of a', b', c' decides the branch" "$TMP/run"; }
check "and that its velocities are not determined" singular
checks "$TMP/dead.lag"
check "is said to be there" says 'constraint cx (line 5): holonomic; its derivatives vanish at the start' "$TMP/check"
one 'constraint c: x^2 + y^2 = l^2' 'scene s { start x = 0 [m], y = 0 [m]; span 0.1 [s] }'
check "in the middle of a circle" taken 1 1 one
one 'constraint a: x = 0 [m]' 'constraint b: 2*x = 0 [m]' 'scene s { start y = 1 [m]; span 1 [s] }'
regular() { taken 1 2 one && ! grep singular "$TMP/check" "$TMP/run"; }
check "what follows from others everywhere is not singular" regular
one "constraint a: x*x' + y*y' = l*x*th'" "scene s { start th' = 1 [rad/s]; span 1 [s] }"
velocities() { taken 0 1 one && says "singular start: the rank is 1 near it; the constraints do not determine x', y'" "$TMP/check" && says "singular: 1 nearby, and the starting value of x', y'" "$TMP/run"; }
check "a constraint on velocities that is none at the start" velocities

# ---- contacts
model floor <<'END'
model floor "A ball on a floor"
coord y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, e = 0.5
lagrangian = m/2*y'^2 - m*g*y
contact ground: y >= 1 [m], restitution = e
scene inside { start y = 0.9 [m]; span 1 [s] }
END
inside() { ! checks "$TMP/floor.lag" && says 'inside the contact `ground`: its gap is -0.1' "$TMP/check" && ! runs "$TMP/floor.lag" && says 'inside the contact ground: its gap is -0.1 m' "$TMP/run"; }
check "inside a contact" inside
sed -i 's/y = 0.9 .*; span/y = 2 [m]; e = 1.5; span/' "$TMP/floor.lag"
more() { ! checks "$TMP/floor.lag" && says '`ground` has a restitution of 1.5' "$TMP/check" && ! runs "$TMP/floor.lag" && says '`ground` has a restitution of 1.5' "$TMP/run"; }
check "a restitution of more than 1" more

# ---- headers start where runs do
# same TOLERANCE TIME MODEL [SCENE]: the header's start, and its state after steps of 1e-3, are those of the run; MAIN: further code of its main program
same() {
  tolerance=$1
  until=$2
  shift 2
  "$LAGC" header "$@" -o "$TMP/h.h" || return 1
  cat >"$TMP/h.c" <<'END'
#include <stdio.h>
#define H_IMPLEMENTATION
#include "h.h"
int main(void) {
  h_params p;
  h_state s;
  h_defaults(&p);
  int status = h_start(&p, &s);
  for (long i = 0; i < STEPS && status == H_OK; i++) status = h_rk4_step(&p, &s, 1e-3 HELD);
  for (int i = 0; i < H_NQ; i++) printf("%s%.17g", i ? "," : "", s.q[i]);
  for (int i = 0; i < H_NQ; i++) printf(",%.17g", s.v[i]);
  printf("\n");
  return status;
}
END
  "$CC" -std=c99 -O1 "-DSTEPS=${until}000" "-DHELD=$held" -o "$TMP/h" "$TMP/h.c" -lm && "$TMP/h" >"$TMP/h.csv" || return 1
  "$LAGC" run "$@" --until "$until" --tol 1e-13 --save-state "$TMP/state" --json >"$TMP/run" 2>&1 || return 1
  sed 's/.*"final"//' "$TMP/run" | grep -o '": [-+0-9.e]*' | sed 's/": //' | head -"$(($(tr ',' '\n' <"$TMP/h.csv" | wc -l)))" | tr '\n' ',' >"$TMP/run.csv"
  awk -F, -v tol="$tolerance" 'NR == FNR { for (i = 1; i <= NF; i++) want[i] = $i; next }
    { for (i = 1; i <= NF; i++) { d = $i - want[i]; print $i, want[i]; if (!(want[i] != "" && d <= tol && -d <= tol)) bad = 1 } } END { exit bad || FNR != 1 }' "$TMP/run.csv" "$TMP/h.csv"
}
held=
slow check "a ball on a turntable, 20 s" same 1e-9 20 models/turntable.lag
model which <<'END'
model which "What is moved: y and z, which the scene does not give, by their masses"
coord x [m], y [m], z [m]
param m = 1 [kg] > 0, M = 4 [kg] > 0
lagrangian = m/2*x'^2 + M/2*(y'^2 + 3*z'^2)
constraint a: x + y + z = 6 [m]
constraint b: x^2 + z^2 = 2 [m^2]
scene one { start x = 1 [m], y' = -1 [m/s]; span 1 [s] }
scene square { start x = 1 [m], z = -3 [m], x' = 3 [m/s]; span 1 [s] }
END
check "what is not given moves" same 1e-9 1 "$TMP/which.lag" one
check "by hand: 1, 4, 1" sh -c '"$0" run "$1" one | grep -q "z from 0 to 1 m"' "$LAGC" "$TMP/which.lag"
# a distance is flat where it is least: the place has half of its digits
slow check "and what is given where that does not suffice" same 1e-6 1 "$TMP/which.lag" square
held=', 0'
sed '/^constraint b/a contact floor: y + 100 [m] >= 0, restitution = 1' "$TMP/which.lag" >"$TMP/over.lag"
check "with a contact" same 1e-9 1 "$TMP/over.lag" one

# ---- a constraint that jumps
one 'constraint c: if(t > 1 [s], x, y) = 0 [m]' 'scene s { start x = 1 [m]; span 2 [s] }'
jumps() { # ARGS...: the run ends where it does, and x has not moved
  ! runs "$TMP/one.lag" "$@" && says 'constraint c (line 5) is not met' "$TMP/run" && near "$(value x)" 1 1e-9
}
jump_nowhere() { # WORDS: no method jumps
  check "dop853 does not jump with it$1" jumps
  check "nor does rk45$1" jumps --method rk45 --tol 1e-6
  check "nor rk4$1" jumps --method rk4 --step 0.01
  check "nor verlet$1" jumps --method verlet --step 0.01
  check "nor verlet4$1" jumps --method verlet4 --step 0.01
  check "nor variational$1" jumps --method variational --step 0.01
}
jump_nowhere ''
# y, of the same unit, falls by more than that: no constraint ties it to x
one 'constraint c: x = l*if(t > 1 [s], 2, 1)' "scene s { start x = 1 [m], y = 1 [m], y' = -100 [m/s]; span 2 [s] }"
slow jump_nowhere ' where another coordinate moves fast'
# from rest by t^3, and on a table that turns back: no jumps, however long the steps are
one 'constraint c: x = l*(t/1 [s])^3' 'constraint d: y = l*sin(3*t/1 [s])' 'scene s { span 2 [s] }'
smooth() { runs "$TMP/one.lag" "$@" && near "$(value x)" 8 1e-9 && near "$(value y)" -0.27941549819892587 1e-9; }
for m in 'dop853' 'rk4 --step 0.2' 'verlet --step 0.2' 'variational --step 0.2' 'verlet8 --step 0.2'; do
  check "what moves fast does not jump: $m" smooth --method $m
done

printf 'model heap\ncoord x [m]\nparam rho = 0.5 [kg/m] > 0, g = 9.81 [m/s^2]\nlagrangian = rho*x*x'"'"'^2/2 + rho*g*x^2/2\nscene zero { span 1 [s] }\nscene some { start x = 0.1; span 1 [s] }\n' >"$TMP/heap.lag"
heap() { ! checks "$TMP/heap.lag" && says 'heap.lag:5:7: error: the mass matrix is singular at the start of the scene `zero`, where `x` has no inertia' "$TMP/check"; }
check "a start without inertia is an error of check" heap
check "a start with inertia beside it" "$LAGC" check "$TMP/heap.lag" some
# Starts by functions and lets of parameters are the numbers of the same formula by hand: h of 1/4, A*sqrt(k)
cat >"$TMP/given.lag" <<'EOF2'
model given
coord q[3] [m], th [deg]
param A = 2 [m], k = 9 [1/s^2], a = 60 [deg]
function h(x) = if(x <= 1, 1 - 3*x^2/2 + 3*x^3/4, 0)
let rate = A*sqrt(k)
kinetic = sum(i in 1..3, q[i]'^2/2) + th'^2/2*(1 [m^2])
potential = sum(i in 1..3, k*q[i]^2/2)
scene s { start q[i in 1..3] = h(i/4)*A, q[1]' = rate, th = 60; A = h(1/2)*8/3 [m]; output q, q[1]', th every 1 }
EOF2
given() { "$LAGC" run "$TMP/given.lag" "$@" -o - --until 1 --quiet | sed -n 2p; }
# h(1/4) = 1 - 3/32 + 3/256 = 0.91796875, h(1/2) = 0.71875, h(3/4) = 0.47265625; A = 1.91666...: products of these, to a rounding
near_given() { given "$@" | awk -F, -v A="$A" '{ split("0.91796875 0.71875 0.47265625", h, " "); for (i = 1; i <= 3; i++) bad += ($(i + 1) - h[i]*A)^2 > 1e-30; exit bad || ($5 - 3*A)^2 > 1e-29 || $6 != "60" }'; }
A=1.9166666666666667 check "starts by functions and lets" near_given
A=5 check "starts by functions and lets, with another parameter" near_given A=5
# ---- guesses: of a four-bar linkage with its crank at 1 the rod has two places, b = 0.3576 and -0.8348 (cosine rule: the ends are d apart, at angle f)
cat >"$TMP/guess.lag" <<'END_OF'
model four
coord a [rad], b [rad], c [rad]
kinetic = 0.1 [kg*m^2]/2*(a'^2 + b'^2 + c'^2)
constraint px: 1 [m]*cos(a) + 3 [m]*cos(b) = 4 [m] + 2 [m]*cos(c)
constraint py: 1 [m]*sin(a) + 3 [m]*sin(b) = 2 [m]*sin(c)
scene up { start a = 1; start guess b = 0.6; span 1 [s]; output a }
scene down { start a = 1; start guess b = -1.2; span 1 [s]; output a }
END_OF
for side in up down; do
  check "a guess chooses the assembly, $side" sh -c '"$1" run "$2" "$3" --until 1e-9 --json >"$4" 2>/dev/null' sh "$LAGC" "$TMP/guess.lag" $side "$TMP/guess"
  sign=$([ $side = up ] && echo 1 || echo -1)
  right=$(awk -v s="$sign" 'BEGIN { x = 4 - cos(1); y = -sin(1); d = x*x + y*y; z = (9 + d - 4)/(6*sqrt(d)); printf "%.15g", atan2(y, x) + s*atan2(sqrt(1 - z*z), z) }')
  check "the nearest to it" close_to "$(sed -n 's/.*"final": {.*"b": \([-0-9.e]*\).*/\1/p' "$TMP/guess")" "$right" 1e-9
  check "and what is given stays" close_to "$(sed -n 's/.*"final": {"a": \([-0-9.e]*\).*/\1/p' "$TMP/guess")" 1 1e-12
done
# ---- families: one loop for a formula, whatever their size; later starts of members go before, as do families after them
cat >"$TMP/family.lag" <<'END_OF'
model family
const N = 100
coord x[N], r[N, 3]: vec2
param m = 2 > 0, k[N] = 1, w[N] = 1
kinetic = sum(i in 1..N, m/2*x[i]'^2 + sum(j in 1..3, m/2*dot(r[i,j]', r[i,j]')))
potential = sum(i in 1..N, k[i]*w[i]/2*x[i]^2)
scene s {
  k[i in 1..N] = 1 + i/10
  w[i in 1..N] = m*k[i]
  start x[3] = 99
  start x[i in 1..N] = sin(1.7*i) + m*pi
  start x[5] = -1, x' = 0.25
  start r[i in 1..N, j in 1..3] = (i + 0.1*j, cos(i*j)/m)
  start r[i in 11..N, 2].x' = sqrt(i)
  start r[N, 3] = (7, 8)
  span 1
  output x[3], x[99], x[5], x[7]', r[2,3].x, r[2,3].y, r[100,3].y, r[10,2].x', r[12,2].x', w[40], w[41]
}
END_OF
starts_of_family() {
  "$LAGC" run "$TMP/family.lag" m=3 'k[40]=9' --compile $1 --until 1e-9 --quiet -o - | sed -n 2p | awk -F, 'BEGIN { pi = atan2(0, -1) }
    function apart(x, y) { return (x - y)^2 > 1e-30*(1 + y*y) }  # some roundings of numbers up to 12
    { exit apart($2, sin(5.1) + 3*pi) || apart($3, sin(168.3) + 3*pi) || $4 != -1 || $5 != 0.25 || apart($6, 2.3) || apart($7, cos(6)/3) || $8 != 8 ||
        $9 != 0 || apart($10, sqrt(12)) || $11 != 27 || apart($12, 15.3) }'
}
for how in never always; do check "starts and parameters of families, compiled: $how" starts_of_family $how; done
lines() { "$LAGC" emit "$TMP/family.lag" -DN="$1" -o - | sed -n '/^static void params_s/,/^}/p; /^static void start_s/,/^}/p' | wc -l; }
is "as many lines for 2000 members as for 1000" "$(lines 1000)" "$(lines 2000)"
sed 's|sin(1.7\*i) + m\*pi|1/(i - 70)|' "$TMP/family.lag" >"$TMP/family0.lag"
says_zero() { "$LAGC" check "$TMP/family0.lag" 2>&1 | grep -q '11:27: error: division by zero'; }
check "a member without a value has a message" says_zero
sed 's|sin(1.7\*i) + m\*pi|sqrt(i - m)|; /start x.3./d' "$TMP/family.lag" >"$TMP/family1.lag"
says_member() { "$LAGC" run "$TMP/family1.lag" --quiet >/dev/null 2>"$TMP/said" || grep -q 'the start of `x\[1\]` is not finite' "$TMP/said"; }
check "and so has one whose parameters have none" says_member

# ---- rows of ten by one formula: member 41 is the first of the fifth, though 4.1 - 0.1 is below 4 in doubles
cat >"$TMP/rows.lag" <<'END'
model rows
const N = 400, K = 10
coord r[N]: vec2
param s = 1
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2)
scene s { start r[i in 1..N] = (s*(i - 1 - K*floor((i - 1)/K)), s*floor((i - 1)/K)); span 1; method rk4(step = 1); output r }
END
rows() {
  "$LAGC" run "$TMP/rows.lag" --compile "$1" --quiet -o "$TMP/rows.csv" || return 1
  awk -F, 'NR == 2 { for (i = 1; i <= 400; i++) if ($(2*i) != (i - 1) % 10 || $(2*i + 1) != int((i - 1)/10)) { print "member " i; exit 1 } }' "$TMP/rows.csv"
}
loops() { "$LAGC" emit "$TMP/rows.lag" -o "$TMP/rows.c" && grep -q "floor)" "$TMP/rows.c"; }
check "a formula of indices is a loop" loops
for how in never always; do check "rows of ten, compiled: $how" rows "$how"; done
tap_end
