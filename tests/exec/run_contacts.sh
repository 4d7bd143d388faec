#!/bin/sh
# Contacts against closed forms: impacts and the time at which they end, forces on resting bodies, the moment at which they leave, impulses
# that agree with constraints.
. tests/tap.sh

model() { cat >"$TMP/$1.lag"; }
run() { "$LAGC" run "$TMP/$1.lag" "$2" --quiet -o "$TMP/out.csv" --json >"$TMP/out.json" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }; }
near() { close_to "$@"; }
cell() { awk -F, -v t="$1" -v c="$2" '$1 == t { print $c }' "$TMP/out.csv"; } # TIME COLUMN

# A ball of restitution 0.8 from 1 m, and one that is pulled up by 15 N sin t after it has come to rest.
model ball <<'EOF'
model ball "A ball that comes to rest, and leaves when it is lifted"
coord y [m], x [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2], e = 0.8, F = 0 [N]
lagrangian = m/2*(y'^2 + x'^2) - m*g*y
force y = F*sin(1 [1/s]*t)
contact floor: y >= 0, restitution = e
scene drop { start y = 1 [m], x' = 1 [m/s]; span 5 [s]; method dop853; tolerance 1e-12; output y, x, y', lambda(floor) every 0.5 [s] }
scene plastic { like drop; e = 0; F = 15 [N]; span 1 [s]; start y = 0.01 [m], x' = 0 [m/s]; output y, y', lambda(floor) every 0.1 [s] }
scene rest { like drop; start y = 0 [m]; span 1 [s] }
scene inside { like drop; start y = -0.1 [m] }
EOF
check "a ball comes to rest" run ball drop
# t_1 = sqrt(2/g), then flights of 2 e^k t_1; after k impacts t_k = t_1 (1 + 2 e (1 - e^(k-1))/(1 - e)); the end is at 9 t_1.
impacts() { "$LAGC" run "$TMP/ball.lag" drop | sed -n 's/^event floor: .*first at t = \([^ ]*\) s, last at \([^ ]*\) s/\1 \2/p'; }
set -- $(impacts)
# the event's time is read off the method's path, whose error is the tolerance
check "the first impact, sqrt(2/g)" near "$1" 0.451523640985730904450811124338 1e-11
# flights shorter than 1e-7 of the time so far are not flown: 4 of those are left
check "the end of impacts, 9 sqrt(2/g)" near "$2" 4.06371276887157814005730011904 2e-6
check "it lies on the floor" near "$(cell 4.5 2)" 0 1e-12
check "its weight presses" near "$(cell 4.5 5)" 9.81 1e-12
check "and it slides on" near "$(cell 5 3)" 5 1e-12
# With e = 0 the first impact is the last: the ball lies until 15 sin t = 9.81 lifts it, at 0.71286.
check "e = 0 and a pull" run ball plastic
lifted() { "$LAGC" run "$TMP/ball.lag" plastic | sed -n 's/^event floor opens: 1 time, t = \([^ ]*\) s/\1/p'; }
check "it leaves when nothing presses, asin(g m/F)" near "$(lifted)" 0.712859977313621 1e-10
check "pressed by m g - F sin t" near "$(cell 0.5 4)" "$(awk 'BEGIN { printf "%.17g", 9.81 - 15*sin(0.5) }')" 1e-12
check "what lies at the start stays" run ball rest
check "at rest" near "$(cell 1 2)" 0 0
check "and presses" near "$(cell 1 5)" 9.81 1e-12
inside() { ! "$LAGC" run "$TMP/ball.lag" inside >"$TMP/log" 2>&1 && grep -q 'the start is inside the contact floor: its gap is -0.1 m' "$TMP/log"; }
check "a start inside is refused" inside

# ---- states that no motion has led to
model kicked <<'EOF'
model kicked "A ball that begins with an impact, and one that events put where it touches"
coord y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2], e = 0.5
lagrangian = m/2*y'^2 - m*g*y
contact floor: y >= 0, restitution = e
event clock: t - 0.05 [s] rising { y = 0 [m]; y' = -2 [m/s] }
event wrong: t - 0.9 [s] rising { y = -1 [m] }
scene begin { start y' = -1 [m/s]; span 0.04 [s]; method dop853; tolerance 1e-12; output y, y' every 0.01 [s] }
scene moved { like begin; start y = 1 [m]; span 0.1 [s] }
scene inside { like begin; span 1 [s] }
EOF
check "a start with a closing gap is an impact" run kicked begin
check "it leaves at e times its speed" near "$(cell 0 3)" 0.5 1e-12
check "and rises" near "$(cell 0.04 2)" "$(awk 'BEGIN { printf "%.17g", 0.5*0.04 - 9.81*0.04^2/2 }')" 1e-12
check "an event that puts the ball on the floor, moving down" run kicked moved
check "is an impact, too" near "$(cell 0.06 3)" "$(awk 'BEGIN { printf "%.17g", 1 - 9.81*0.01 }')" 1e-12
into() { ! "$LAGC" run "$TMP/kicked.lag" inside >"$TMP/log" 2>&1 && grep -q 'event wrong sets a state that is inside the contact floor: its gap is -1 m' "$TMP/log"; }
check "one that puts it inside ends the run" into
lively() { ! "$LAGC" run "$TMP/kicked.lag" begin e=2 >"$TMP/log" 2>&1 && grep -q 'the contact floor has a restitution of 2' "$TMP/log"; }
check "a restitution of 2 is refused" lively
# Three balls come to rest on each other, by methods of both kinds.
model stack <<'EOF'
model stack "Three balls fall onto each other"
coord y[3] [m]
param m[3] = {1, 3, 1} [kg] > 0, g = 9.81 [m/s^2], e = 0.5, d = 0.2 [m]
kinetic = sum(i in 1..3, m[i]/2*y[i]'^2)
potential = sum(i in 1..3, m[i]*g*y[i])
contact floor: y[1] >= d/2, restitution = e
for i in 1..2 { contact pair[i]: y[i+1] - y[i] >= d, restitution = e }
scene fall { start y = {0.5, 1, 1.5}; span 3 [s]; output y[3], lambda(floor), lambda(pair[1]), lambda(pair[2]) every 1 [s] }
EOF
for method in dop853 'variational(step=1e-3)' 'verlet(step=1e-3)'; do
  stack() { "$LAGC" run "$TMP/stack.lag" --method "$method" --quiet -o "$TMP/out.csv" >"$TMP/log" 2>&1 || { cat "$TMP/log"; return 1; }; }
  check "a stack comes to rest: $method" stack
  check "each carries what is above it" near "$(cell 3 3)" "$(awk 'BEGIN { printf "%.17g", 5*9.81 }')" 1e-9
  check "and the uppermost its own weight" near "$(cell 3 5)" 9.81 1e-9
done

# A pendulum in Cartesian coordinates strikes a wall: the rod takes part in the impulse, so that the speed along the circle turns round.
model rod <<'EOF'
model rod "A pendulum that strikes a wall"
coord x [m], y [m], far [m]
param m = 2 [kg] > 0, g = 9.81 [m/s^2], l = 1 [m] > 0, e = 0.5
lagrangian = m/2*(x'^2 + y'^2 + far'^2) - m*g*y
constraint rod: x^2 + y^2 = l^2
contact wall: x >= -0.6 [m], restitution = e
scene swing { start x = 0.8 [m], y = -0.6 [m], far' = 1 [m/s]; span 5 [s]; method dop853; tolerance 1e-12
 output x, y, x', y', far', energy every 0.01 [s] }
EOF
check "a pendulum against a wall" run rod swing
# The energy that n impacts leave: each takes all but e^2 of m v^2/2 = 0.2 m g, and the first costs the fall from -0.6 to -0.8.
check "what is left of its energy" near "$(awk -F, 'END { printf "%.17g", $7 }' "$TMP/out.csv")" "$("$LAGC" run "$TMP/rod.lag" swing | awk '/^event wall:/ { n = $3 } END { v2 = 0.4*9.81*0.25^n; printf "%.17g", 2*(v2/2 - 9.81*0.8) + 1 }')" 1e-9
check "what is far away is not touched" near "$(awk -F, 'END { print $6 }' "$TMP/out.csv")" 1 1e-12
on_circle() { awk -F, 'NR > 1 { d = $2^2 + $3^2 - 1; if (d > 1e-14 || -d > 1e-14) exit 1 }' "$TMP/out.csv"; }
check "on the circle throughout" on_circle
# A floor that shakes: once it falls faster than the ball, the path of a method of order 1 is below it at once, in each step. Once it went on for
# minutes by microseconds; now it ends with the reason. Others leave the floor, at which sin(w t) = g/(A w^2).
model shaker <<'EOF'
model shaker "A ball on a floor that oscillates"
coord y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, A = 0.2 [m], w = 8 [rad/s]
lagrangian = m/2*y'^2 - m*g*y
contact floor: y - A*sin(w*t) >= 0 [m], restitution = 0.5
scene s { start y = 1; span 2 }
EOF
shaken() { timeout 60 "$LAGC" run "$TMP/shaker.lag" --method "$@" >"$TMP/out" 2>&1; }
without_end() { shaken symplectic_euler --step 2e-3; [ $? = 3 ] && grep -q 'FAILED: contact floor strikes at t = 0.89[0-9]* s again and again.*take verlet or dop853' "$TMP/out"; }
check "a contact that strikes without end ends the run" without_end
left() { sed -n 's/^event floor opens:.*t = \([^ ]*\) s.*/\1/p' "$TMP/out"; }
for method in dop853 verlet; do
  check "a floor that shakes: $method" shaken $method
  check "left where it falls faster" near "$(left)" "$(awk 'BEGIN { x = 9.81/12.8; pi = atan2(0, -1); printf "%.17g", (4*pi + atan2(x, sqrt(1 - x*x)))/8 }')" 1e-9
done

# Without loss, for 5000 s: it falls for sqrt(2 h/g) = 0.45152 s and strikes every 0.90305 s from then on, 5537 times. Late, the last bit of time is
# a path as long as the gap is rounded.
model long <<'EOF'
model long "A ball that bounces for long"
coord y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2]
lagrangian = m/2*y'^2 - m*g*y
contact floor: y >= 0, restitution = 1
scene s { start y = 1 [m]; span 5000 [s]; output y every 100 [s] }
EOF
often() { "$LAGC" run "$TMP/long.lag" s >"$TMP/out" 2>&1 && grep -q '^event floor: 5537 times' "$TMP/out"; }
check "a ball that bounces for long strikes once each time" often

"$LAGC" run "$TMP/long.lag" s --until 2 >"$TMP/out"
is "the report has no empty line where contacts are the only constraints" "1 0" "$(grep -c '^constraint residual' "$TMP/out") $(grep -c '^$' "$TMP/out")"

# ---- the loop at the top of a header, compiled as it stands
model corner <<'EOF'
model corner "Pressed into a corner"
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2]
lagrangian = m/2*(x'^2 + y'^2) - m*g*(x + y)
contact left: x >= 0, restitution = 0.5
contact floor: y >= 0, restitution = 0.5
scene s { start x = 0.3 [m], y = 0.5 [m]; span 3 [s] }
EOF
example() { # MODEL SCENE: coordinates and velocities at the end, in $TMP/state
  "$LAGC" header "$TMP/$1.lag" "$2" -o "$TMP/eg.h" || return 1
  { printf '#include <stdio.h>\n#define EG_IMPLEMENTATION\n#include "eg.h"\nint main(void) {\n'
    sed -n '/^ \*   eg_params p;/,/^ \*   printf/s/^ \* //p' "$TMP/eg.h"
    echo 'for (int i = 0; i < EG_NQ; i++) printf("%.9f %.9f ", s.q[i], s.v[i]);'; echo 'return 0; }'; } >"$TMP/eg.c"
  "$CC" -std=c99 -Wall -Wextra -Werror -O1 "$TMP/eg.c" -o "$TMP/eg" -lm || return 1
  timeout 20 "$TMP/eg" | tail -n 1 >"$TMP/state"
}
state() { cut -d ' ' -f "$1" "$TMP/state"; }
# A restitution of the speed, k v^(-1/4), at most 1: 37 bounces one by one. Tolerance: 1e-11 a step, and v^(3/4) makes errors smaller.
model speed <<'END'
model speed "A ball that is the more elastic the slower it falls"
coord y
param k = 0.8, g = 9.81
lagrangian = y'^2/2 - g*y
contact floor: y >= 0, restitution = min(1, k*abs(y')^(-0.25))
scene s { start y = 5; span 6; tolerance 1e-11; output y, y' every 6 }
END
bounces() { awk 'BEGIN { g = 9.81; v = sqrt(2*g*5); t = v/g; for (;;) { e = 0.8*v^(-0.25); if (e > 1) e = 1; v *= e; if (t + 2*v/g > 6) break; t += 2*v/g } s = 6 - t; printf "%.17g %.17g\n", v*s - g*s*s/2, v - g*s }'; }
check "a restitution that depends on the speed" run speed s
set -- $(bounces)
check "where it is after 37 bounces" near "$(cell 6 2)" "$1" 1e-8
check "and its velocity" near "$(cell 6 3)" "$2" 1e-8
check "by time steps, too" "$LAGC" run "$TMP/speed.lag" --method moreau --step 1e-3 --quiet
sed -i 's/min(1, k\*abs(y.)^(-0.25))/1.1*k*abs(y'"'"')^0.25/' "$TMP/speed.lag"
check "one above 1 ends the run" says 2 "which must be between 0 and 1" "$LAGC" run "$TMP/speed.lag" --quiet
check "a header says that contacts are the loop's" sh -c "'$LAGC' header '$TMP/ball.lag' | grep -q 'Contacts: a step ignores them. The loop below calls ball_events, ball_act and ball_hold'"
check "its loop compiles and runs" example ball drop
check "the ball bounces to rest" near "$(state 1)" 0 1e-8
check "at rest" near "$(state 2)" 0 0
check "while it slides on" near "$(state 3)" 5 1e-2
check "a ball that is lifted" run ball plastic
check "in the loop" example ball plastic
check "leaves as in a run" near "$(state 1)" "$(cell 1 2)" 1e-3
check "with its speed" near "$(state 2)" "$(cell 1 3)" 1e-2
check "in a corner" example corner s
check "it comes to rest, and time goes on" grep -q '^-*0.0000000.. -*0.000000000 -*0.0000000.. -*0.000000000 $' "$TMP/state"

# A block that rests on one beside it, which a constraint holds: their accelerations are differences of forces, which are no size of the motion.
model held <<'EOF'
model held
coord x [m], n [m]
param m = 1 [kg] > 0
kinetic = m/2*(x'^2 + n'^2)
force x = if(t > 1 [s], 15 [N], 0) - 10 [N]
constraint frame: n' = 0
contact tooth: x >= n, restitution = 0
scene lifted { start x = 4.2 [m], n = 4.2 [m]; span 4 [s]; output x every 1 [s] }
EOF
check "a block is lifted off one that a constraint holds" run held lifted
check "it rises by 5 (t - 1)^2/2" near "$(cell 4 2)" 26.7 1e-8 # ten times the tolerance
# The same, as its slip turns: the force is one of a surface where a motion may slide.
model turns <<'EOF'
model turns
coord x [m], y [m]
param m = 1 [kg] > 0
kinetic = m/2*(x'^2 + y'^2)
force x = -1 [N]
force y = if(x' < 0, 15 [N], 0) - 10 [N]
contact floor: y >= 0, restitution = 0
scene s { start x' = 1; span 4 [s]; output y every 1 [s] }
EOF
check "a block is lifted off as it turns" run turns s
check "and rises by 5 (t - 1)^2/2" near "$(cell 4 2)" 22.5 1e-8
# A hammer of no restitution, lifted each second: its blows come at equal times, which is no series that ends.
model hammer <<'EOF'
model hammer
coord y [m]
param m = 1 [kg] > 0
kinetic = m/2*y'^2
force y = if(sin(2*pi*t/1 [s]) > 0, 12 [N], 0) - 10 [N]
contact anvil: y >= 0, restitution = 0
scene blows { span 8.4 [s]; output y every 1 [s] }
EOF
# up by 2 for half a second, which is 0.25 m and 0.05 m more, and down by 10 from 0.6 s on: 0.6 + sqrt(0.06)
blows() { "$LAGC" run "$TMP/hammer.lag" >"$TMP/blows" && grep -q '^event anvil: 8 times, first at t = 0.8449' "$TMP/blows" && ! grep 'left out' "$TMP/blows"; }
check "blows at equal times are told as they are" blows
# Loops with contacts. MuJoCo's test engine_core_smooth_test, rne_post/connect/multiple_constraints.xml: cubes of 1 kg in the field (1, 2, 3), one hung from another beside a slider of
# frictionloss 9 N; its sensor, which bears two of them, has (-2, -4, -6).
model connect <<'EOF'
model connect
coord r: vec3 [m], s [m]
param m = 1 [kg] > 0
let G = (1 [m/s^2], 2 [m/s^2], 3 [m/s^2])
kinetic = m/2*(dot(r', r') + s'^2)
potential = -m*dot(G, r) - m*G.z*s
constraint link: r = (0 [m], 0 [m], 0 [m])
friction slide on s: 9 [N]
observe X [N] = lambda(link).x - m*G.x
observe Y [N] = lambda(link).y - m*G.y
observe Z [N] = lambda(link).z - m*G.z
scene hangs { span 1 [s]; output X, Y, Z, s every 1 [s] }
scene steps { like hangs; method moreau(step = 1e-2) }
EOF
for s in hangs steps; do
  check "cubes on a connect, $s" run connect $s
  is "and its sensor" "1,-2,-4,-6,0" "$(tail -1 "$TMP/out.csv")"
done
# Two legs of length L hinged at the top, which bears P, feet on the floor, tied by a rope: moments about the hinge give the rope's force (P + m g) tan(a)/2, each foot m g + P/2.
model frame <<'EOF'
model frame
coord x[2] [m], y[2] [m], a[2] [rad], h [m]
param m = 3 [kg] > 0, L = 2 [m] > 0, P = 40 [N], g = 9.81 [m/s^2], mu = 0 >= 0
let px = x[1] + L/2*sin(a[1]), py = y[1] + L/2*cos(a[1])
let side[1] = 1
let side[2] = -1
kinetic = sum(i in 1..2, m/2*(x[i]'^2 + y[i]'^2) + m*L^2/24*a[i]'^2) + m/2*h'^2
potential = sum(i in 1..2, m*g*y[i]) + P*h
constraint pin: (x[2] - L/2*sin(a[2]), y[2] + L/2*cos(a[2])) = (px, py)
constraint load: h = py
constraint rope: 0.8*L = x[2] + L/2*sin(a[2]) - x[1] + L/2*sin(a[1]) while lambda(rope) > 0
for i in 1..2 {
  contact foot[i]: y[i] >= L/2*cos(a[i]), restitution = 0, friction = mu, slip = x[i]' - side[i]*L/2*cos(a[i])*a[i]'
}
scene stands {
  start x[1] = -0.4, x[2] = 0.4, a[i in 1..2] = asin(0.4), y[i in 1..2] = sqrt(0.84), h = 2*sqrt(0.84)
  span 1 [s]; output lambda(rope), lambda(foot[1]), h every 1 [s]
}
scene steps { like stands; method moreau(step = 1e-2) }
EOF
for s in stands steps; do
  check "a frame on two feet, $s" run frame $s
  check "the rope bears (P + m g) tan(a)/2" near "$(cell 1 2)" 15.150868119084954 1e-12
  check "and each foot m g + P/2" near "$(cell 1 3)" 49.43 1e-12
  check "it stands" near "$(cell 1 4)" 1.833030277982336 1e-14
done
tap_end
