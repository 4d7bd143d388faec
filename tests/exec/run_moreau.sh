#!/bin/sh
# Method moreau: contacts by impulses at each step, against closed forms: rest, friction, rolling, rows of balls, towers, constraints, balances, and refusals.
. tests/exec/lib_motion.sh

refuses() { # refuses STATUS WORDS COMMAND MODEL ARGS...
  status=$1 words=$2 command=$3 name=$4
  shift 4
  "$LAGC" "$command" "$TMP/$name.lag" "$@" >"$TMP/log" 2>&1
  [ $? = "$status" ] && grep -q -e "$words" "$TMP/log" || { cat "$TMP/log"; return 1; }
}
m3='moreau(step=0.001)'

# ---- a ball that bounces ever faster: infinitely many impacts until t = 4.06 s, and rest after that
model ball <<'END_OF'
model ball
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, e = 0.8, r = 0.1 [m], c = 0 [N*s/m]
lagrangian = m/2*(x'^2 + y'^2) - m*g*y
force x = -c*x'
contact floor: y >= r, restitution = e
contact wall: 3 [m] - x >= r, restitution = 1
event marks: x - 1 [m] rising { }
scene drop { start y = 1.1 [m], x' = 1 [m/s]; span 6 [s]; measure marked = hit(marks); output x, y, y', lambda(floor) every 0.5 [s] }
scene swing { start y = 10 [m], x = -5 [m], x' = 4 [m/s]; c = 2 [N*s/m]; span 1 [s] }
END_OF
for h in 0.01 0.001; do
  check "a ball, h = $h" run ball drop --method "moreau(step=$h)"
  check "comes to rest" close_to "$(final "y'")" 0 0
  check "from t = 4.1 s on" close_to "$(cell 4.5 4)" 0 0
  check "on the floor, within half a step of the fall" close_to "$(final y)" 0.1 "$(calc "$h*4.5/2")"
  check "where the floor carries it" close_to "$(cell 5 5)" 9.81 1e-12
  check "its energy is lost in impacts" close_to "$(number at_events)" -9.81 "$(calc "$h*4.5/2*9.81")"
  check "and nowhere else" close_to "$(number drift)" 0 1e-12
  check "no contact brings energy in" close_to "$(number energy_gained)" 0 0
done
check "an event of the model is located as ever" close_to "$(number marked)" 1 1e-12
check "e = 1" run ball drop e=1 --method $m3
check "it bounces on" close_to "$(number drift)" 0 1e-12
check "without loss" close_to "$(number at_events)" 0 1e-12
step_error() { run ball swing --method "moreau(step=$1)" && calc "$(final "x'") - 4*exp(-2)"; } # x'' = -2 x', until the wall is near
check "drag" run ball swing --method 'moreau(step=0.01)'
check "order 2: a half of the step makes a quarter of the error" close_to "$(calc "$(step_error 0.02)/($(step_error 0.01))")" 4 0.02

# ---- a block on an incline
model slope <<'END_OF'
model slope
coord x [m], y [m]
param m = 2 [kg] > 0, g = 9.81 [m/s^2] > 0, mu = 0.3, a = 0 [deg], e = 0, k = 0 [N/s], et = 0, c = 0 [N*s/m]
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*(x*sin(a) + y*cos(a))
force x = k*t - c*x'
contact plane: y >= 0, restitution = e, friction = mu, slip = x', tangential = et
scene s { start x' = 3 [m/s]; span 4 [s]; output x, x', lambda(plane), lambda(plane.slip) every 0.5 [s] }
scene rests { like s; start x' = 0; a = 16 [deg] }
scene pulled { like rests; a = 0; k = 3 [N/s] }
scene thrown { like s; start y = 1 [m]; span 0.5 [s] }
scene drag { like s; c = 4 [N*s/m]; span 0.2 [s] }
END_OF
check "a block stops" run slope s --method $m3
check "at v0^2/(2 mu g), to h^2 mu g/8" close_to "$(final x)" "$(calc '9/(2*0.3*9.81)')" 4e-7
check "and stays" close_to "$(final "x'")" 0 0
check "its energy is heat, m v0^2/2" close_to "$(number dry_friction)" -9 1e-11
check "which the balance contains" close_to "$(number drift)" 0 1e-12
check "friction is mu m g while it slides" close_to "$(cell 0.5 5)" "$(calc '-0.3*2*9.81')" 1e-10
check "and 0 at rest" close_to "$(cell 4 5)" 0 1e-10
check "tan 16 deg < mu: it sticks" run slope rests --method $m3
check "where it is" close_to "$(final x)" 0 0
check "held by the weight along the plane" close_to "$(cell 4 5)" "$(calc '2*9.81*sin(16*atan2(0,-1)/180)')" 1e-10
check "a growing pull" run slope pulled --method $m3
t=$(calc '4 - 0.3*2*9.81/3')
check "breaks it loose: k t^3/(6 m), h v/2 for the step in which it does" close_to "$(final x)" "$(calc "3*$t^3/12")" 1e-4
v=$(calc 'sqrt(2*9.81)')
check "a throw, e = 0.5" run slope thrown e=0.5 --method $m3
check "mu (1 + e) v is lost along the plane; v is known to h g, and friction acts in one step more" close_to "$(final "x'")" "$(calc "3 - 0.3*1.5*$v")" "$(calc '0.3*2.5*9.81*0.001')"
check "elastic along the plane" run slope thrown e=0.5 mu=2 et=0.8 --method $m3
check "it comes back" close_to "$(final "x'")" "$(calc '-0.8*3')" 1e-12
slip_error() { run slope drag --method "moreau(step=$1)" && calc "$(final "x'") - ((3 + 0.3*9.81/2)*exp(-0.4) - 0.3*9.81/2)"; } # v' = -mu g - 2 v
check "order 2 also while it slides" close_to "$(calc "$(slip_error 0.02)/($(slip_error 0.01))")" 4 0.05

# ---- a ball that slides, and rolls: its angular momentum about the lane leaves it 5/7 of its speed
model bowling <<'END_OF'
model bowling
coord x [m], y [m], th [rad]
param m = 6 [kg] > 0, r = 0.108 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.1 >= 0, e = 0.3
kinetic = m/2*(x'^2 + y'^2) + m*r^2/5*th'^2
potential = m*g*y
contact lane: y >= r, restitution = e, friction = mu, slip = x' + r*th'
scene throw { start x' = 8 [m/s], y = 0.2 [m]; span 5 [s]; output x, x', lambda(lane.slip) every 0.1 [s] }
END_OF
check "a ball on a lane" run bowling throw --method $m3
check "rolls with 5/7 of its speed" close_to "$(final "x'")" "$(calc '40/7')" 1e-10
check "without friction then" close_to "$(cell 5 4)" 0 1e-9

# ---- a rod that strikes the floor with its end, slipping: friction may turn the slip round; energy is never gained, and Newton's law with the slip at the end alone would gain here
model rod <<'END_OF'
model rod
coord x [m], y [m], th [rad]
param m = 1 [kg] > 0, l = 1 [m] > 0, mu = 0.8 >= 0, e = 0.9
kinetic = m/2*(x'^2 + y'^2) + m*l^2/24*th'^2
let fx = x + l/2*cos(th)
let fy = y - l/2*sin(th)
contact floor: fy >= 0, restitution = e, friction = mu, slip = fx'
scene s { start th = 1 [rad], y = 0.43 [m], y' = -1 [m/s]; span 0.05 [s] }
END_OF
loses() { awk -v a="$(number at_events)" -v b="$(number dry_friction)" -v gained="$(number energy_gained)" -v drift="$(number drift_absolute)" 'BEGIN { print a, b, gained, drift; exit !(a + b < 0 && gained == 0 && drift < 1e-4) }'; }
for v in -2 -0.5 0 0.2 0.5 1 2; do
  check "a rod strikes, slipping at $v m/s" run rod s "x'=$v" --method 'moreau(step=1e-4)'
  check "and loses energy" loses
done

# ---- a bead inside a hoop: along a curve the gap closes at a rate of v^2/R a second, which is no impact. Closed forms: v = v0 without friction, v = v0/(1 + mu v0 t/R) with it
model hoop <<'END_OF'
model hoop
coord x [m], y [m]
param m = 1 [kg] > 0, R = 1 [m] > 0, mu = 0 >= 0, e = 0.5, g = 0 [m/s^2], v = 3 [m/s]
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*y
contact wall: R - hypot(x, y) >= 0, restitution = e, friction = mu, slip = (x*y' - y*x')/hypot(x, y)
observe speed [m/s] = hypot(x', y')
scene s { start x = R, y' = v; span 5 [s]; output speed, lambda(wall) every 2.5 [s] }
scene swings { start x = 0.8 [m], y = -0.6 [m]; g = 9.81 [m/s^2]; span 100 [s] }
scene lands { like s; start x = 0.9 [m]; e = 0; span 2 [s]; output lambda(wall) every 0.001 [s] }
END_OF
check "a bead inside a hoop" run hoop s --method $m3
check "no impact" close_to "$(number impacts)" 0 0
check "its angle is v t/R, to t R (v h/R)^2 v/(24 R)" close_to "$(final x)" "$(calc 'cos(15)')" 1.2e-5
check "it keeps its speed" close_to "$(cell 5 2)" 3 1e-12
check "the hoop presses with m v^2/R" close_to "$(cell 5 3)" 9 1e-11
check "it is inside by (v h)^2/(8 R), as a chord is" close_to "$(number deepest)" "$(calc '9e-6/8')" 1e-10
hoop_error() { run hoop s mu=0.2 --method "moreau(step=$1)" && calc "$(final x) - cos(5*log(4))"; }
check "with friction: order 2" close_to "$(calc "$(hoop_error 0.01)/($(hoop_error 0.005))")" 4 0.1
check "the speed is v0/(1 + mu v0 t/R)" close_to "$(cell 5 2)" 0.75 2e-6
check "it swings, 100 s" run hoop swings --method 'moreau(step=0.01)'
check "inside by no more than (v h)^2/(8 R), v^2 = 2 g 0.4 m, and as much again while it becomes faster: it is led out no faster than it sinks" close_to "$(number deepest)" "$(calc '1.5*2*9.81*0.4*1e-4/8')" "$(calc '0.51*2*9.81*0.4*1e-4/8')"
check "with its energy, to order 4" close_to "$(number at_events)" 0 1e-6
check "it lands" run hoop lands --method $m3
check "once" close_to "$(number impacts)" 1 0
check "with x v/R of its speed, m (x v)^2/R^3 presses, to the step's path" close_to "$(cell 2 2)" 7.29 0.01
check "evenly, from step to step" close_to "$(cell 1.999 2)" "$(cell 2 2)" 1e-11

# ---- a row of balls: struck at the same time, or one after the other
model cradle <<'END_OF'
model cradle
coord x[4] [m]
param e = 1, d = 0 [m] >= 0, r = 0.1 [m] > 0
kinetic = sum(i in 1..4, 1 [kg]/2*x[i]'^2)
for i in 1..3 { contact c[i]: x[i+1] - x[i] >= 2*r, restitution = e }
scene hit { start x[i in 1..4] = i*(2*r + d), x[1] = 0, x[1]' = 1 [m/s]; span 0.5 [s] }
END_OF
check "a row that touches" run cradle hit --method $m3
check "throws the ball back with half its speed" close_to "$(final "x\[1\]'")" -0.5 1e-12
check "and leaves as one" close_to "$(final "x\[4\]'")" 0.5 1e-12
check "with gaps of 1 cm" run cradle hit d=0.01 --method $m3
check "the ball stops" close_to "$(final "x\[1\]'")" 0 1e-12
check "and the last one goes" close_to "$(final "x\[4\]'")" 1 1e-12

# ---- a pendulum on a rod, against a wall 0.2 m from the line below its pivot
model pendulum <<'END_OF'
model pendulum
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2], l = 1 [m] > 0, e = 1
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*y
constraint rod: x^2 + y^2 = l^2
contact wall: x >= 0.2 [m], restitution = e
scene swing { start x = 1 [m]; span 10 [s]; output x, lambda(rod) every 1 [s] }
END_OF
check "a pendulum against a wall, e = 1" run pendulum swing --method $m3
check "keeps its energy, to h^2" close_to "$(number drift)" 0 1e-4
check "and its rod" close_to "$(number constraint_residual)" 0 1e-14
check "e = 0.3" run pendulum swing e=0.3 --method $m3
check "it hangs at the wall" close_to "$(final x)" 0.2 5e-3
check "at rest" close_to "$(final "x'")" 0 1e-14
check "with a pull of m g/cos(a) at the rod, -2 lambda l; x is known to 2 mm" close_to "$(cell 10 3)" "$(calc '-9.81/2/sqrt(1 - 0.2^2)')" 3e-3

# ---- a tower of blocks
model tower <<'END_OF'
model tower
const N = 12
coord x[N] [m], y[N] [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, h = 0.1 [m] > 0, mu = 0.5 >= 0, e = 0.2, a = 0
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2))
potential = sum(i in 1..N, m*g*(y[i] - a*x[i]))
let X[0] = 0 [m]
let X[i in 1..N] = x[i]
let Y[0] = 0 [m]
let Y[i in 1..N] = y[i]
for i in 1..N { contact c[i]: Y[i] - Y[i-1] >= h, restitution = e, friction = mu, slip = X[i]' - X[i-1]' }
scene rest { start y[i in 1..N] = i*h; span 0.5 [s]; output lambda(c[1]) every 0.5 [s] }
scene drop { like rest; start y[i in 1..N] = i*h + i*0.01 [m]; span 2 [s] }
END_OF
N=12
if [ -n "${SLOW:-}" ]; then N=50; fi
check "a tower of $N blocks" run tower rest -D N=$N --method $m3
check "stays as high" close_to "$(final "y\[$N\]")" "$(calc "$N*0.1")" 1e-12
check "at rest" close_to "$(final "y\[$N\]'")" 0 1e-12
check "its weight is on the floor" close_to "$(cell 0.5 2)" "$(calc "$N*9.81")" 1e-9
check "a slope of 0.4 < mu" run tower rest -D N=$N a=0.4 --method $m3
check "does not move it" close_to "$(final "x\[$N\]")" 0 1e-12
check "a slope of 0.6" run tower rest -D N=$N a=0.6 --method $m3
check "lets it slide as one body" close_to "$(final "x\[1\]'")" "$(calc '(0.6 - 0.5)*9.81*0.5')" 1e-9
check "with its top" close_to "$(final "x\[$N\]'")" "$(calc '(0.6 - 0.5)*9.81*0.5')" 1e-9
check "dropped with gaps between" run tower drop -D N=$N --method $m3
check "it comes to rest" close_to "$(final "y\[$N\]'")" 0 1e-12
check "no energy comes in" close_to "$(number energy_gained)" 0 0
check "and the balance holds" close_to "$(number drift)" 0 1e-11

# ---- in space: a puck, and a ball with spin; the start is turned by 0, 30, 90 and 200 degrees, and the motion with it
model puck <<'END_OF'
model puck
coord x [m], y [m], z [m], a [rad], b [rad]
param m = 2 [kg] > 0, r = 0.1 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.2 >= 0, k = 0, turn = 0 [deg], e = 0.3
kinetic = m/2*(x'^2 + y'^2 + z'^2) + m*r^2/5*(a'^2 + b'^2)
potential = m*g*z
contact floor: z >= 0, restitution = e, friction = mu, slip = (x' - k*r*b', y' + k*r*a')
observe along [m] = x*cos(turn) + y*sin(turn)
observe across [m] = -x*sin(turn) + y*cos(turn)
observe v_along [m/s] = x'*cos(turn) + y'*sin(turn)
observe v_across [m/s] = -x'*sin(turn) + y'*cos(turn)
scene slides { start x' = 5 [m/s]*cos(turn), y' = 5 [m/s]*sin(turn); span 3 [s]; method moreau(step = 0.001); output along, across, v_along, v_across, lambda(floor.slip) every 1 [s] }
scene rolls { like slides; k = 1; start a' = 20 [rad/s]*cos(turn), b' = 20 [rad/s]*sin(turn) }
scene falls { like rolls; start z = 0.3 [m] }
END_OF
for turn in 0 30 90 200; do
  check "a puck, turned by $turn degrees" run puck slides turn=$turn
  check "stops at v0^2/(2 mu g), to h^2 mu g/8" close_to "$(final along)" "$(calc '25/(2*0.2*9.81)')" 3e-7
  check "on a straight line" close_to "$(final across)" 0 1e-12
  check "friction is mu m g" close_to "$(awk -F, '$1 == 1 { print sqrt($6^2 + $7^2) }' "$TMP/csv")" "$(calc '0.2*2*9.81')" 1e-10
  check "a ball with side spin" run puck rolls turn=$turn
  check "rolls on with 5/7 of its speed" close_to "$(final v_along)" "$(calc '25/7')" 1e-10
  check "and 2/7 of that of its spin across" close_to "$(final v_across)" "$(calc '-2*0.1*20/7')" 1e-10
done
check "thrown on the floor" run puck falls turn=30
check "the same 5/7" close_to "$(final v_along)" "$(calc '25/7')" 1e-10
check "and 2/7" close_to "$(final v_across)" "$(calc '-4/7')" 1e-10
check "no energy comes in" close_to "$(number energy_gained)" 0 0
check "by events, too" run puck slides --method dop853
check "it stops there" close_to "$(final along)" "$(calc '25/(2*0.2*9.81)')" 1e-8
three() { sed "s/slip = (x' - k\*r\*b', y' + k\*r\*a')/slip = (x', y', z')/" "$TMP/puck.lag" >"$TMP/three.lag" && refuses 1 'a number or two are needed here' check three; }
check "three components" three

# ---- a long row of dominoes. Times by quadrature of the motion in which each leans on the next (models/dominoes.facts), 60 points of Gauss an interval
dominoes() {
  "$LAGC" run models/dominoes.lag "$1" -D N=50 --quiet -o "$TMP/csv" --json $2 >"$TMP/json" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }
}
all_fall() { # from th > asin(s/h) on each lies on the next, which never lets it rise
  awk -F, 'NR == 1 { next } { for (i = 2; i <= 51; i++) { bad += $i < was[i] - 1e-4; was[i] = $i } } END { for (i = 2; i <= 51; i++) bad += !(was[i] > 0.4297); exit bad > 0 }' "$TMP/csv"
}
no_growth() { awk -F, 'NR > 2 && $52 > was*(1 + 1e-6) { bad = 1 } { was = $52 } END { exit bad || was == "" }' "$TMP/csv"; } # drift of a smooth part
passes() { awk -F, -v c="$1" 'NR > 1 { if (was < 0.42977 && $c >= 0.42977) { print t + ($1 - t)*(0.42977 - was)/($c - was); exit } was = $c; t = $1 }' "$TMP/csv"; } # asin(s/h), where the next is struck
slow check "50 dominoes, by events" dominoes fall "--measure a=hit(hit[40]) --measure b=hit(hit[48]) --measure c=hit(hit[49])"
[ -z "${SLOW:-}" ] || check "the 40th strikes the 41st" close_to "$(number a)" 1.136827509425722 1e-8
[ -z "${SLOW:-}" ] || check "the wave has its last speed" close_to "$(calc "0.0275/($(number c) - $(number b))")" 1.1977567843 1e-6
slow check "all fall" all_fall
slow check "their energy never grows" no_growth
slow check "50 dominoes, by time steps" dominoes row
[ -z "${SLOW:-}" ] || check "the 40th strikes the 41st: impacts come late by a step at most, each" close_to "$(passes 41)" 1.1368275 "$(calc '40*2e-4')"
[ -z "${SLOW:-}" ] || check "the wave is as fast, to these steps" close_to "$(calc "10*0.0275/($(passes 49) - $(passes 39))")" 1.1977568 "$(calc '1.2*2e-4*1.2/0.0275')"
slow check "all fall" all_fall
slow check "their energy never grows" no_growth

# ---- dry friction of joints and sliders, beside contacts
# A telescope without inertia slams a door: k/2 ((s0 - rest)^2 - (s1 - rest)^2) - F (s0 - s1) is left at the frame, from s0 at 80 degrees to s1.
telescope() { "$LAGC" run models/door_closer.lag slam --method 'moreau(step=1e-4)' --quiet -o "$TMP/csv" --json >"$TMP/json" 2>"$TMP/err"; }
check "coordinates without inertia that constraints determine" telescope
check "the frame takes all energy that friction leaves" close_to "$(number at_events)" -2.980088305083 3e-4 # F and the spring over a step of the door's edge
model slider <<'END_OF'
model slider
coord x [m], y [m]
param m = 2 [kg] > 0, g = 9.81 [m/s^2], mu = 0.3 >= 0, mu_s = 0.3 >= 0, k = 0 [N/m], v = 0 [m/s], F = 0 [N], wall = 10 [m], e = 0
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*y + k/2*(x - v*t)^2
force x = F
friction rub on x: mu*m*g, static = mu_s*m*g
contact floor: y >= 0, restitution = 0
contact stop: wall - x >= 0, restitution = e
scene stops { start x' = 3 [m/s]; span 2 [s]; output x, x', rub, lambda(stop), energy every 0.25 [s] }
scene pulled { like stops; start x' = 0; k = 10 [N/m]; v = 1 [m/s]; mu_s = 0.5; span 1.5 [s] }
scene pressed { like stops; start x' = 0; F = 20 [N]; wall = 0.5 [m]; e = 0.5; span 6 [s] }
END_OF
check "a slider stops" run slider stops --method $m3
check "at v0^2/(2 mu g), to h^2 mu g/8" close_to "$(final x)" "$(calc '9/(2*0.3*9.81)')" 4e-7
check "and stays" close_to "$(final "x'")" 0 0
check "its energy is the heat of friction, m v0^2/2" close_to "$(number dry_friction)" -9 1e-11
check "which the balance contains" close_to "$(number drift)" 0 1e-12
check "friction is mu m g while it slides" close_to "$(cell 0.5 4)" "$(calc '-0.3*2*9.81')" 1e-12
check "and 0 at rest" close_to "$(cell 2 4)" 0 1e-12
check "the report counts its rest, to a step" close_to "$(number sliding_s)" "$(calc '2 - 3/(0.3*9.81)')" 1e-3
check "pulled by a spring" run slider pulled --method $m3
check "static friction holds it: at k v t < 0.5 m g" close_to "$(cell 0.75 2)" 0 1e-15
check "by the force of the spring, in the middle of a step" close_to "$(cell 0.75 4)" "$(calc '-10*0.7495')" 1e-12
w=2.2360679774997896 t=$(calc '1.5 - 0.5*2*9.81/10') f=$(calc '0.2*2*9.81/10') # sqrt(k/m); time since it broke loose; way from where friction and spring balance, m x'' = -k (x - v t - ...)
check "it breaks loose at 0.5 m g/k: v (t - sin(w t)/w) + f (1 - cos(w t)); friction falls within a step" close_to "$(final x)" "$(calc "$t - sin($w*$t)/$w + $f*(1 - cos($w*$t))")" "$(calc "0.001*$t*0.2*9.81 + 1e-6")"
check "pressed against a wall" run slider pressed --method $m3
check "it comes to rest there" close_to "$(final "x'")" 0 1e-15
check "friction and wall hold it together" close_to "$(calc "20 + $(cell 6 4) - $(cell 6 5)")" 0 1e-12
check "friction by no more than its size" sh -c "awk 'BEGIN { exit !($(cell 6 4) <= 0 && $(cell 6 4) >= -0.3*2*9.81*(1 + 1e-12)) }'"
check "impacts and friction take what the force brings" close_to "$(number drift)" 0 1e-12
check "no contact brings energy in" close_to "$(number energy_gained)" 0 0
model leg <<'END_OF'
model leg
coord a [rad], b [rad]
param m = 1 [kg] > 0, l = 0.5 [m] > 0, g = 9.81 [m/s^2], R = 0.6 [N*m] >= 0
let x1 = l*cos(a)
let y1 = l*sin(a)
let x2 = x1 + l*cos(b)
let y2 = y1 + l*sin(b)
let knee = b - a
kinetic = m/2*(x1'^2 + y1'^2 + x2'^2 + y2'^2)
potential = m*g*(y1 + y2)
friction hip on a: R, static = 1.3*R
friction rub on knee: R/2
contact foot: y2 + 0.3 [m] >= 0, restitution = 0.6
contact shin: y1 + 0.3 [m] >= 0, restitution = 0.6
scene s { start a = 1.2 [rad], b = 0.3 [rad]; span 4 [s]; tolerance 1e-10; output a, b, energy every 0.01 [s] }
END_OF
leg_at() { run leg s --method "$1" --until 1.2 && final a; } # after 6 impacts of the foot
exact=$(leg_at dop853)
for h in 0.005 0.001 0.0001; do check "a leg with friction in hip and knee, which bounces: the event-driven run, to the path of a step, h = $h" close_to "$(leg_at "moreau(step=$h)")" "$exact" "$(calc "$h*4")"; done
check "at rest, where events follow each other without end" run leg s --method $m3
check "at rest" close_to "$(final "b'")" 0 1e-12
check "its energy never grows" awk -F, 'NR > 2 && $4 > was + 1e-12 { bad = 1 } { was = $4 } END { exit bad }' "$TMP/csv"
leg_drift() { run leg s --method "moreau(step=$1)" --until 0.4 && number drift; }
check "before the first impact the balance is of order 2" close_to "$(calc "$(leg_drift 0.01)/($(leg_drift 0.005))")" 4 0.3
model bump <<'END_OF'
model bump "A block that rubs strikes a heavier one, and comes back with half its speed"
coord x [m], y [m]
kinetic = 1 [kg]/2*x'^2 + 3 [kg]/2*y'^2
friction rub on x: 1 [N]
contact hit: y - x >= 0, restitution = 1
scene s { start x' = 2 [m/s], y = 0.125 [m]; span 0.5 [s]; output x', y', energy every 0.01 [s] }
END_OF
check "an impact turns the slip round" run bump s --method 'moreau(step=0.01)'
check "once" close_to "$(number impacts)" 1 0
check "nor then does friction bring energy in" awk -F, 'NR > 2 && $4 > was + 1e-12 { print; bad = 1 } { was = $4 } END { exit bad }' "$TMP/csv"
check "momentum is what friction leaves, 1 N before and -1 N behind, to the step" close_to "$(calc "$(final "x'") + 3*($(final "y'"))")" "$(calc '2 - 0.0635 + (0.5 - 0.0635)')" 0.02
model held <<'END_OF'
model held
coord a [m]
kinetic = 1 [kg]/2*a'^2
force a = 0.9 [N] + 0.5 [N/s]*t
friction rub on a: 0.8 [N], static = 1.2 [N]
scene s { span 1 [s]; output a }
END_OF
check "energy that is rounding of what friction holds is none to lose" run held s --method $m3
check "it breaks loose at 0.6 s" close_to "$(final "a'")" 0.2 1e-3
model rubs <<'END_OF'
model rubs
coord x [m], y [m]
kinetic = 1 [kg]/2*(x'^2 + y'^2)
potential = 1 [kg]*9.81 [m/s^2]*y
friction rub on x: 0.5*lambda(floor)
contact floor: y >= 0, restitution = 0
scene s { span 2 [s] }
END_OF
check "a size that follows the force of a contact" refuses 1 'a coefficient times the size of that force' run rubs s --method $m3

# ---- reports, sweeps, saved runs
check "the report counts" sh -c "$LAGC run $TMP/ball.lag drop --method '$m3' >$TMP/log && grep -q 'contacts: at most [12] acts\{0,1\} at once, [0-9]* impacts, 1[.0-9]* iterations a step with contacts; the deepest is 0.004[0-9]* inside (in SI)' $TMP/log"
check "events of contacts are left out" sh -c "! grep -q 'event floor' $TMP/log"
run ball drop --method $m3
x=$(final y)
check "a sweep has the same end" sh -c "$LAGC sweep $TMP/ball.lag drop e=0.7..0.8:2 --method '$m3' -o $TMP/sweep.csv --measure y >/dev/null && tail -n 1 $TMP/sweep.csv | grep -q ',$x,ok'"
split() { # MODEL SCENE
  "$LAGC" run "$TMP/$1.lag" "$2" --method $m3 --until 1.0005 --save-state "$TMP/s.state" --quiet &&
    "$LAGC" run "$TMP/$1.lag" "$2" --method $m3 --resume "$TMP/s.state" --until 6 --json >"$TMP/b.json" && "$LAGC" run "$TMP/$1.lag" "$2" --method $m3 --json >"$TMP/a.json" &&
    [ "$(sed 's/.*"contacts"//' "$TMP/a.json")" = "$(sed 's/.*"contacts"//' "$TMP/b.json")" ]
}
check "a run in two parts is the same run" split ball drop
check "with dry friction, too" split slider pressed
check "a picture" sh -c "$LAGC plot $TMP/ball.lag drop --method '$m3' -o $TMP/ball.svg >/dev/null && grep -q '<svg' $TMP/ball.svg"

# ---- without a step it follows the tolerance: a ball in space slides with side spin and rolls from t = 0.243 s on, at v0 - 2/7 of its slip at the start
model bowl <<'END_OF'
model bowl
coord r: vec3 [m], R: rotation
param m = 0.17 [kg] > 0, b = 0.028 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.2 >= 0
let w = omega(R)
let W = R*w
kinetic = m/2*dot(r', r') + m*b^2/5*dot(w, w)
potential = m*g*r.z
contact table: r.z >= b, restitution = 0.5, friction = mu, slip = (r.x' - b*W.y, r.y' + b*W.x)
scene s { start r.z = b, r.x' = 2 [m/s], omega(R) = (30, 20, 5) [rad/s]; span 200; output r.x', r.y' }
END_OF
check "by the tolerance" run bowl s --until 0.3 --method moreau --tol 1e-6
check "vx" close_to "$(final "r.x'")" 1.588571428571429 1e-5 # errors of 1e-6 a step, with both signs
check "vy" close_to "$(final "r.y'")" -0.24 1e-5

# ---- refusals, and the way out of other methods
check "backwards" refuses 2 'moreau does not follow contacts backwards in time' run ball drop --method $m3 --until -1
check "a start inside" refuses 2 'the start is inside the contact floor: its gap is -0.1 m' run ball drop --method $m3 y=0
check "a restitution above 1" refuses 2 'the contact floor has a restitution of 1.5' run ball drop --method $m3 e=1.5
check "hit(floor)" refuses 3 'moreau does not locate events of contacts, as floor is one' run ball drop --method $m3 --measure 'hit(floor)'
check "--accuracy" refuses 2 'moreau meets impacts at its steps' run ball drop --method $m3 --accuracy 1e-6
check "lagc cost" refuses 2 'lagc cost leaves it out' cost ball drop --methods moreau
check "drag that is too strong for the step" refuses 3 'change too much within a step: take smaller steps, or radau' run ball swing c=5000 --method $m3
check "more contacts at once than others follow" refuses 3 'more than 6 contacts touch at once, some of them with friction, which only moreau follows' run tower rest -D N=$N --method dop853
check "verlet names it" refuses 2 'rk45, dop853, radau, rk4 and moreau can' run slope s --method verlet

# ---- friction that falls with speed: a e^(c v) + b = (a e^(c v0) + b) e^(-a c t/m) for F = a + b e^(-c |v|); a fast body is not stopped at once
model stribeck <<'END_OF'
model stribeck
coord x [m]
kinetic = 0.5 [kg]*x'^2
friction rub on x: 3 [N] + 5 [N]*exp(-2 [s/m]*abs(x'))
scene s { start x' = -5 [m/s]; span 0.5 [s]; output x }
END_OF
check "Stribeck's friction" run stribeck s --method $m3
check "brakes" close_to "$(final "x'")" "$(calc '-log(((3*exp(10) + 5)*exp(-3) - 5)/3)/2')" 1e-7 # h^2 F'/m

# ---- a block that rocks until it lies: slips of both edges are almost one, and friction locks them
rocks() { "$LAGC" run models/rocking_block.lag "h=$1" --method 'moreau(step=5e-4)' --json --quiet >"$TMP/json" 2>"$TMP/log" || { cat "$TMP/log"; return 1; }; }
for h in 0.4 0.46 0.4657 0.47 0.5; do
  one_of 2 || continue
  check "a rocking block, h = $h, comes to its end" rocks $h
  check "it lies" close_to "$(final y)" $h 1e-5 # half a step of the last fall
  al=$(calc "atan2(0.2, $h)") start=$(calc '6*atan2(0,-1)/180')
  check "its energy is lost in strokes" close_to "$(number at_events)" "$(calc "-100*9.81*(sqrt(0.04 + $h^2)*cos($al - $start) - $h)")" 5e-3 # the fall of a step, m g h v
done
# ---- a wheel is turned between a floor and a wall: it holds up to mu m g r (1 + mu)/(1 + mu^2) = 8.829 N m; the rows of both contacts depend on each other
model corner <<'END_OF'
model corner
coord x [m], y [m], th [rad]
param m = 5 [kg] > 0, r = 0.3 [m] > 0, mu = 0.5, g = 9.81 [m/s^2] > 0
kinetic = m/2*(x'^2 + y'^2) + m*r^2/4*th'^2
potential = m*g*y
force th = -4 [N*m/s]*t
contact floor: y >= r, restitution = 0, friction = mu, slip = x' + r*th'
contact wall: 1 [m] - x >= r, restitution = 0.2, friction = mu, slip = y' + r*th'
scene drive { start x = 0.5, y = r; span 4 [s] }
END_OF
for by in dop853 $m3; do
  check "a wheel in a corner, $by" run corner drive --method "$by"
  check "turns where friction gives way" close_to "$(final "th'")" "$(calc '-(2*(16 - 2.20725^2) - 8.829*(4 - 2.20725))/0.225')" 1e-5 # the step in which it breaks loose: h^2/2*4/I
done

# ---- a toggle is thrown over its dead centre against a stop: within a step of 0.03 rad the slider moves by the square of that alone
model toggle <<'END_OF'
model toggle
coord a [rad], b [rad], x [m], y [m]
param l = 0.2 [m] > 0
kinetic = 0.004 [kg*m^2]/2*(a'^2 + b'^2) + 0.5 [kg]/2*(x'^2 + y'^2)
potential = 2e4 [N/m]/2*max(x - 0.395 [m], 0)^2
force a = -8 [N*m]
guide pin: (x, y) = l*(cos(a) + cos(b), sin(a) - sin(b)), friction = 0.25, slip = 6 [mm]*(a' + b')
guide rail: y = 0, friction = 0.25, slip = x'
contact stop: a >= -0.06, restitution = 0.1
scene clamp { start a = 0.6; start guess b = 0.6, x = 0.33; span 1 [s] }
END_OF
check "a toggle passes its dead centre" run toggle clamp --method $m3
check "and clamps" close_to "$(final x)" "$(calc '0.4*cos(0.06)')" 1e-5 # of the order of the step in which it strikes: h l sin(0.06)

# ---- forces at the start, before a step: a block that lies, one that slides, one that flies; m g = 10, mu m g = 3
model start <<'END_OF'
model start
coord x[3] [m], y[3] [m]
param m = 1 [kg] > 0, g = 10 [m/s^2], mu = 0.3 >= 0
kinetic = sum(i in 1..3, m/2*(x[i]'^2 + y[i]'^2))
potential = sum(i in 1..3, m*g*y[i])
for i in 1..3 {
  force x[i] = -2 [N]
  contact floor[i]: y[i] >= 0, restitution = 0, friction = mu, slip = x[i]'
}
scene s {
  start x[2]' = 1 [m/s], y[3] = 1 [m]; span 0.1 [s]; method moreau(step = 0.01)
  output lambda(floor[1]), lambda(floor[1].slip), lambda(floor[2]), lambda(floor[2].slip), lambda(floor[3]), x[2]' every 0.1 [s]
}
END_OF
check "forces at the start" run start s
is "at rest, sliding, in flight" "0,10,2,10,-3,0,1" "$(sed -n 2p "$TMP/csv")"
check "the steps are as without them: 1 - 0.5" close_to "$(final "x\[2\]'")" 0.5 1e-14
tap_end
