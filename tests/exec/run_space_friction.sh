#!/bin/sh
# Contacts in space, whose slip has two components, by events: against closed forms and SciPy.
. tests/exec/lib_motion.sh

event() { sed -n "s/.*\"$1\": {\"count\": 1, \"first\": \([-0-9.e+]*\).*/\1/p" "$TMP/json"; } # NAME: time, once

# ---- a billiard ball slides with side spin, its path is a parabola, and rolls on. |slip| falls by 7/2 mu g; velocities end at v0 - 2/7 slip
model bowl <<'END_OF'
model bowl
coord r: vec3 [m], R: rotation
param m = 0.17 [kg] > 0, b = 0.028 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.2 >= 0, e = 0.5
let w = omega(R)
let W = R*w
kinetic = m/2*dot(r', r') + m*b^2/5*dot(w, w)
potential = m*g*r.z
contact table: r.z >= b, restitution = e, friction = mu, slip = (r.x' - b*W.y, r.y' + b*W.x)
scene s { start r.z = b, r.x' = 2 [m/s], omega(R) = (30, 20, 5) [rad/s]; span 2; output r.x, r.y, r.x', r.y' }
scene drop { start r.z = b + 0.2 [m], r.x' = 2 [m/s], r.y' = 1 [m/s], omega(R) = (30, 20, 5) [rad/s]; span 2; output r.x', r.y' }
END_OF
# (sx, sy) = (2 - 20 b, 30 b), T = |s|/(7/2 mu g): the mean velocity until T, then the last
sx=1.44 sy=0.84
T=$(calc "sqrt($sx^2 + $sy^2)/(3.5*0.2*9.81)")
for tol in 1e-6 1e-9 1e-12; do
  allowed=$(calc "300*$tol + 1e-12")
  check "a billiard ball, $tol" run bowl s --tol $tol
  check "rolls along x" close_to "$(final "r.x'")" "$(calc "2 - 2/7*$sx")" "$allowed"
  check "and y" close_to "$(final "r.y'")" "$(calc "-2/7*$sy")" "$allowed"
  check "after a parabola: x" close_to "$(final r.x)" "$(calc "2*2 - 2/7*$sx*(2 - $T/2)")" "$allowed"
  check "y" close_to "$(final r.y)" "$(calc "-2/7*$sy*(2 - $T/2)")" "$allowed"
done
check "dropped, it ends alike" run bowl drop --tol 1e-11
check "x" close_to "$(final "r.x'")" "$(calc "2 - 2/7*$sx")" 1e-9 # what the last bounces leave out
check "y" close_to "$(final "r.y'")" "$(calc "1 - 2/7*(1 + $sy)")" 1e-9

# ---- a puck across a slope of angle al: its path curves until it stops at T = v0 (k + cos f0)/(g sin al (k^2 - 1)), k = mu/tan al; the slip comes in along the slope as a power 1/(k - 1)
model slope <<'END_OF'
model slope
coord x [m], y [m], z [m]
param m = 0.7 [kg] > 0, g = 10 [m/s^2] > 0, al = 0.5, k = 1.5, v0 = 2 [m/s], f0 = 2
kinetic = m/2*(x'^2 + y'^2 + z'^2)
potential = m*g*(z*cos(al) - x*sin(al))
contact plane: z >= 0, restitution = 0, friction = k*tan(al), slip = (x', y')
scene s { start x' = v0*cos(f0), y' = v0*sin(f0); span 5 }
END_OF
for k in 1.5 2 6; do
  check "a puck on a slope, k = $k" run slope s k=$k --tol 1e-11
  check "stops" close_to "$(event "plane sticks.x")" "$(calc "2*($k + cos(2))/(10*sin(0.5)*($k^2 - 1))")" 2e-10
  check "with its energy balanced" close_to "$(number drift)" 0 1e-10
done
check "thrown up the slope, it turns round" run slope s f0=3.1 --tol 1e-9
check "and stops" close_to "$(event "plane sticks.x")" "$(calc "2*(1.5 + cos(3.1))/(10*sin(0.5)*1.25)")" 1e-9

# ---- a puck under a force that turns and grows slips off; SciPy's DOP853 (rtol 1e-12) from the first slip on
model pulled <<'END_OF'
model pulled
coord x [m], y [m], z [m]
param m = 1 [kg] > 0, g = 10 [m/s^2] > 0, mu = 0.3, hold = 0.3, a = 2 [N/s], w = 1 [rad/s]
kinetic = m/2*(x'^2 + y'^2 + z'^2)
potential = m*g*z
force x = a*t*cos(w*t)
force y = a*t*sin(w*t)
contact plane: z >= 0, restitution = 0, friction = mu, static = hold, slip = (x', y')
scene s { span 4 [s]; output x, y }
END_OF
check "pulled off" run pulled s --tol 1e-9
check "as it begins to slip" close_to "$(event "plane slips.x")" 1.5 1e-9
check "x" close_to "$(final x)" -4.52122999 1e-6 # it begins by forces that have just grown enough, and turns fast at first
check "y" close_to "$(final y)" 0.65636967 1e-6
check "static friction above" run pulled s hold=0.4 --tol 1e-10
check "x, then" close_to "$(final x)" -4.18050592 1e-8
check "y, then" close_to "$(final y)" 0.3173173 1e-8
check "by moreau" run pulled s hold=0.4 --method 'moreau(step=1e-3)'
check "x by moreau" close_to "$(final x)" -4.18050592 5e-3 # a step late, at up to 5 m/s
check "y by moreau" close_to "$(final y)" 0.3173173 5e-3

# ---- static friction of a guide in space whose force changes its side: N = 10 |sin 9 t| along both faces, pulled by 4 t. It breaks loose where 4 t = 0.45 N, and slides by 4 t - 0.3 N
# until that has taken its speed; places by SciPy's quad and brentq over these intervals
model plates <<'EOF'
model plates
coord x [m], y [m], z [m]
param m = 1 [kg] > 0, g = 10 [m/s^2], mu = 0.3 >= 0
kinetic = m/2*(x'^2 + y'^2 + z'^2)
potential = m*g*z*sin(9*t/(1 [s]))
force x = 2.4 [N/s]*t
force y = 3.2 [N/s]*t
guide plates: z = 0, friction = mu, static = 1.5*mu, slip = (x', y')
scene s { span 2 [s]; tolerance 1e-11; output x, y every 2 [s] }
EOF
check "a block between plates" run plates s
check "slips, stops, slips: x" close_to "$(cell 2 2)" 1.434419182063738 1e-9
check "and y" close_to "$(cell 2 3)" 1.9125589094183173 1e-9
for h in 1e-3 1e-4 1e-5; do # a break-away is off by a step: 1.2 m/s of it
  check "by moreau, h = $h" run plates s --method "moreau(step=$h)"
  check "to the step" close_to "$(cell 2 2)" 1.434419182063738 "$(awk "BEGIN { print 1.2*$h }")"
done
tap_end
