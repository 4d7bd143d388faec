#!/bin/sh
# Guides: joints and sliders with Coulomb's friction by their own force. Held against closed forms, and against integrations of the same motions in one
# coordinate, where the force of the guide is solved for at each state (SciPy's DOP853, tolerance 1e-12), whose numbers stand here.
. tests/exec/lib_motion.sh

refuses() { # refuses STATUS WORDS MODEL ARGS...
  status=$1 words=$2 name=$3
  shift 3
  "$LAGC" run "$TMP/$name.lag" "$@" >"$TMP/log" 2>&1
  [ $? = "$status" ] && grep -q -e "$words" "$TMP/log" || { cat "$TMP/log"; return 1; }
}

# ---- a block on a rail: N = F - m g, of either sign
model rail <<'END_OF'
model rail
coord x [m], y [m]
param m = 2 [kg] > 0, g = 9.81 [m/s^2], mu = 0.2 >= 0, F = 30 [N], pull = 0 [N]
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*y
force (x, y) = (pull, F)
guide rail: y = 0, friction = mu, static = 1.5*mu
scene go { start x' = 1 [m/s]; span 2 [s]; output x, lambda(rail), lambda(rail.slip) every 1 [s] }
END_OF
check "it slides to rest" run rail go
check "after v^2/(2 mu N/m)" close_to "$(final x)" "$(calc '1/(2*0.2*(30 - 19.62)/2)')" 1e-12
check "its friction then is 0" close_to "$(cell 2 4)" 0 1e-15
check "static friction holds up to 3.114 N" run rail go pull=3.11 "x'=0"
check "by itself" close_to "$(final x)" 0 0
check "and reports the part that it needs" close_to "$(number rail.slip)" "$(calc '3.11/3.114')" 1e-12
check "more moves it" run rail go pull=3.12 "x'=0"
check "against friction" close_to "$(final x)" "$(calc '(3.12 - 0.2*10.38)/2*2')" 1e-12

# ---- a drawer pulled beside its middle: forces F b/(2 a) and two frictions; it jams from mu = a/b on, whatever F
if one_of 3; then
model drawer <<'END_OF'
model drawer
coord x [m], y [m], th [rad]
param m = 2 [kg] > 0, I = 0.1 [kg*m^2] > 0, a = 0.2 [m] > 0, b = 0.3 [m], F = 10 [N], mu = 0.3 >= 0
kinetic = m/2*(x'^2 + y'^2) + I/2*th'^2
force (x - b*sin(th), y + b*cos(th)) = (F, 0)
guide back: y - a*sin(th) = 0, friction = mu, slip = x'
guide front: y + a*sin(th) = 0, friction = mu, slip = x'
scene go { span 2 [s]; output x, lambda(back), lambda(front.slip) every 1 [s] }
END_OF
check "a drawer slides" run drawer go
check "by F - mu F b/a" close_to "$(final x)" "$(calc '(10 - 0.3*10*1.5)/2*2')" 1e-12
check "its friction jams it" run drawer go mu=0.7 F=1000
check "at any force" close_to "$(final x)" 0 0
check "which the report says" close_to "$(number back.slip)" "$(calc '1/(0.7*1.5)')" 1e-9
says_jammed() { "$LAGC" run "$TMP/drawer.lag" mu=0.7 | grep -q 'guide back.slip sticks, self-locking: it needs 95.2 %'; }
check "and its words" says_jammed
fi

# ---- a bead on a hoop: by a guide, by the multiplier; the force of the hoop changes its side twice
if one_of 3; then
hoop() { # NAME FRICTION: a model
  printf 'model %s\ncoord x [m], y [m]\nparam m = 0.1 [kg] > 0, R = 0.5 [m] > 0, g = 9.81 [m/s^2], mu = 0.2 >= 0\nkinetic = m/2*(x%s^2 + y%s^2)\npotential = m*g*y\n%s\nscene go { start y = -0.5, x%s = 6 [m/s]; span 2 [s]; output x every 1 [s] }\n' \
    "$1" "'" "'" "$2" "'" >"$TMP/$1.lag"
}
hoop squared 'guide hoop: x^2 + y^2 = R^2, friction = mu'
hoop named "constraint hoop: hypot(x, y) = R
let s = R*atan2(x, -y)
friction rub on s: mu*abs(lambda(hoop))"
for name in squared named; do
  check "a bead on a hoop, $name" run $name go --tol 1e-12
  check "x" close_to "$(final x)" -0.0846718237081 1e-10 # the reference starts anew beside two turning points: 1e-11
  check "the balance of the energy closes" close_to "$(number drift)" 0 1e-11
done
sed '/^friction/s/$/, static = 3*mu*abs(lambda(hoop))/' "$TMP/named.lag" >"$TMP/held.lag"
check "where tan is 1/2" run held go x=0.22360679774997896 y=-0.44721359549995793 "x'=0"
check "static friction holds it" close_to "$(final x)" 0.22360679774997896 1e-15
fi

# ---- a journal: the friction torque is mu r hypot(lx, ly)
if one_of 3; then
model journal <<'END_OF'
model journal
coord x [m], y [m], th [rad]
param m = 2 [kg] > 0, I = 0.05 [kg*m^2] > 0, l = 0.4 [m] > 0, r = 0.03 [m] > 0, g = 9.81 [m/s^2], mu = 0.3 >= 0
kinetic = m/2*(x'^2 + y'^2) + I/2*th'^2
potential = m*g*y
guide pin: (x, y) = l*(sin(th), -cos(th)), friction = mu, slip = r*th'
scene go { start th = 2, th' = 0; span 6 [s]; output th every 1 [s] }
END_OF
check "a pendulum on a rough journal" run journal go --tol 1e-12
check "its angle" close_to "$(final th)" 0.06505133 1e-8 # the digits of the reference behind six turning points
fi

# ---- eight bars on rough pins, let go: the first pin slips back, two others on, five stick (the one of 3^8 choices that obeys the law: SciPy)
if one_of 3; then
model chain <<'END_OF'
model chain
const N = 8
coord x[N] [m], y[N] [m], th[N] [rad]
param m = 0.2 [kg] > 0, l = 0.3 [m] > 0, d = 10 [mm] > 0, g = 9.81 [m/s^2] > 0, mu = 0.2 >= 0
let X[0] = 0 [m]
let X[i in 1..N] = x[i] + l/2*sin(th[i])
let Y[0] = 0 [m]
let Y[i in 1..N] = y[i] - l/2*cos(th[i])
let w[0] = 0 [rad/s]
let w[i in 1..N] = th[i]'
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2) + m*l^2/24*th[i]'^2)
potential = sum(i in 1..N, m*g*y[i])
for i in 1..N {
  guide pin[i]: (x[i] - l/2*sin(th[i]), y[i] + l/2*cos(th[i])) = (X[i-1], Y[i-1]), friction = mu, slip = d*(w[i] - w[i-1])
}
scene go { start th[i in 1..N] = 0.4; span 0.05 [s]; output th[1] every 1 [s] }
END_OF
check "eight rough pins" run chain go --tol 1e-12
check "the first bar" close_to "$(final 'th\[1\]')" 0.3869785172168667 1e-12
check "the last" close_to "$(final 'th\[8\]')" 0.40001342550883445 1e-12
fi

# ---- a wire in space: of a helix, N = m hypot(v^2/rho, g cos(alpha))
if one_of 3; then
model helix <<'END_OF'
model helix
coord r: vec3 [m]
param m = 0.1 [kg] > 0, R = 0.5 [m] > 0, h = 0.3 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.2 >= 0
kinetic = m/2*dot(r', r')
potential = m*g*r.z
guide wire: (r.x, r.y) = R*(cos(r.z/h), sin(r.z/h)), friction = mu
scene go { start r = (R, 0, 0); span 3 [s]; output r.z every 1 [s] }
END_OF
check "a bead on a helix" run helix go --tol 1e-12
check "its depth" close_to "$(final r.z)" -4.704727772553328 1e-11
fi

# ---- on a surface in space friction has two components, and is followed by moreau: a puck between plates, N = 12 - m g; a bead in a sphere, in the plane of the hoop
if one_of 3; then
model plates <<'END_OF'
model plates
coord x [m], y [m], z [m]
param m = 0.5 [kg] > 0, g = 9.81 [m/s^2], mu = 0.3 >= 0
kinetic = m/2*(x'^2 + y'^2 + z'^2)
potential = m*g*z
force z = 12 [N]
for i in 1..1 { guide plates[i]: z = 0, friction = mu, slip = (x', y') }
scene go { start x' = 0.6 [m/s], y' = 0.8 [m/s]; span 0.1 [s]; output x, lambda(plates[1]), lambda(plates[1].slip) every 0.1 [s] }
END_OF
check "a puck between plates takes moreau" run plates go
check "its friction" close_to "$(cell 0.1 4)" "$(calc '-0.6*0.3*(12 - 0.5*9.81)')" 1e-9
check "by the force of the plates" close_to "$(cell 0.1 3)" "$(calc '0.5*9.81 - 12')" 1e-9
check "its path" close_to "$(final x)" "$(calc '0.6*(0.1 - 0.3*(12 - 0.5*9.81)/0.5*0.1^2/2)')" 1e-9
check "to rest" run plates go --until 1
check "after v^2/(2 a)" close_to "$(final x)" "$(calc '0.6*0.5^2/(0.3*(12 - 0.5*9.81))')" 1e-7
check "where it has no speed at all" close_to "$(final "x'")" 0 0
model sphere <<'END_OF'
model sphere
coord r: vec3 [m]
param m = 0.1 [kg] > 0, R = 0.5 [m] > 0, g = 9.81 [m/s^2], mu = 0.2 >= 0
kinetic = m/2*dot(r', r')
potential = m*g*r.y
guide ball: norm(r) = R, friction = mu, slip = ((r.x*r.y' - r.y*r.x')/R, r.z')
scene go { start r = (0, -0.5, 0), r.x' = 6 [m/s]; span 2 [s]; output r.x every 2 [s] }
END_OF
check "a bead in a sphere" run sphere go --method 'moreau(step=1e-3)'
check "as on the hoop" close_to "$(final r.x)" -0.0846718237081 5e-4 # half a step at two turns of 1 m/s
check "no energy comes in" close_to "$(number drift)" 0 1e-11
fi

# ---- a crank with friction at pin and rail, over the turning points of both slips
if one_of 3; then
model press <<'END_OF'
model press
coord a [rad], b [rad], x [m], y [m]
param r = 0.1 [m] > 0, l = 0.3 [m] > 0, d = 15 [mm] > 0, mu = 0.1 >= 0
param I = 0.05 [kg*m^2] > 0, J = 0.01 [kg*m^2] > 0, m = 1.5 [kg] > 0, g = 9.81 [m/s^2]
kinetic = I/2*a'^2 + J/2*b'^2 + m/2*(x'^2 + y'^2)
potential = m*g*y
guide pin: (x, y) = (r*cos(a) + l*cos(b), r*sin(a) - l*sin(b)), friction = mu, slip = d*b'
guide rail: y = 0, friction = mu, static = 1.5*mu
scene coast { start a = 1, a' = 5 [rad/s], b = asin(r*sin(1)/l), x = r*cos(1) + l*cos(asin(r*sin(1)/l)); span 0.5 [s]; output a every 0.5 [s] }
END_OF
check "a crank passes the turning points of its slips" run press coast --tol 1e-11
check "its angle" close_to "$(final a)" 3.4085322936455413 1e-10
check "and comes to rest" run press coast --until 10
check "without a step more" close_to "$(final "a'")" 0 1e-15
run press coast mu=0.4 --until 2 && rests=$(final a)
check "by moreau two frictions hold its one motion" run press coast mu=0.4 --until 2 --method 'moreau(step=2e-3)'
check "where events end it" close_to "$(final a)" "$rests" 1e-3 # half a step at 1 rad/s
fi

# ---- Painleve: a rod whose tip is guided, friction W_nn/|W_nt| = (1 + 3 sin^2)/(3 sin cos)
if one_of 3; then
model rod <<'END_OF'
model rod
coord x [m], y [m], th [rad]
param m = 1 [kg] > 0, l = 1 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.5 >= 0
let px = x - l*sin(th), py = y - l*cos(th)
kinetic = m/2*(x'^2 + y'^2) + m*l^2/6*th'^2
potential = m*g*y
guide tip: py = 0, friction = mu, slip = px'
scene go { start th = 0.6, y = l*cos(0.6), x' = 3 [m/s]; span 0.01 [s] }
END_OF
limit=$(calc '(1 + 3*sin(0.6)^2)/(3*sin(0.6)*cos(0.6))' | cut -c1-6)
check "below the limit one motion follows" run rod go mu=1.39
check "above it several" refuses 3 "several motions follow at the guide tip.slip, of friction 1.41: .*from a friction of $limit" rod go mu=1.41
check "or none" refuses 3 "no motion follows at the guide tip.slip, of friction 1.41: .*from a friction of $limit" rod go mu=1.41 "x'=-3"
fi

# ---- a start at rest that static friction holds, by a contact and by a guide, under a force that grows
for kind in 'contact floor: y >= 0, restitution = 0,' 'guide floor: y = 0,'; do
  printf "model held\ncoord a [rad], x [m], y [m]\nparam m = 1 [kg] > 0\nkinetic = m/2*(x'^2 + y'^2) + 0.01 [kg*m^2]/2*a'^2\npotential = m*9.81 [m/s^2]*y\nconstraint c: x = 1 [m]*cos(a)\n%s friction = 0.2, static = 0.4, slip = x'\nforce x = 2 [N] + 2.5 [N/s]*t\nscene go { start a = 1, x = cos(1); span 2 [s]; output x every 1 [s] }\n" "$kind" | model held
  check "${kind%%:*} holds a body, then not" run held go
  check "from 0.4 m g on" close_to "$(sed -n 's/.*"floor slips": {"count": 1, "first": \([-0-9.e]*\).*/\1/p' "$TMP/json")" 0.7696 1e-12
done

# ---- rough jaws on rough rails: nothing determines the prestress of a block at rest between them, so it holds as long as some holds it, by 2 mu F/(1 - mu mu_r); from then on the
# least, where rails relieve it: N = F/(1 + mu mu_r)
model jaws <<'END_OF'
model jaws
coord x[2] [m], y[2] [m], bx [m], by [m]
param F = 20 [N], mu = 0.4, mu_r = 0.1, g = 9.81 [m/s^2], pull = 0 [N/s]
kinetic = 0.2 [kg]/2*(x[1]'^2 + y[1]'^2 + x[2]'^2 + y[2]'^2) + 0.5 [kg]/2*(bx'^2 + by'^2)
potential = 0.5 [kg]*g*by
force (x[1], x[2]) = (F, -F)
force by = pull*t
for i in 1..2 { guide rail[i]: y[i] = 0, friction = mu_r, slip = x[i]' }
contact left: bx - 0.02 [m] - x[1] >= 0, restitution = 0, friction = mu, slip = by' - y[1]'
contact right: x[2] - bx - 0.02 [m] >= 0, restitution = 0, friction = mu, slip = by' - y[2]'
scene close { start x = {-0.05, 0.06}; span 2 [s] }
scene pull { start x = {-0.02, 0.02}; pull = 10 [N/s]; span 3 [s] }
END_OF
check "jaws close on a block" run jaws close
check "which they hold" close_to "$(final "by'")" 0 0
check "a block is pulled out of jaws" run jaws pull
loose=$(calc '(0.5*9.81 + 2*0.4*20/(1 - 0.04))/10')
check "against the least friction" close_to "$(final "by'")" "$(calc "(5*(9 - $loose^2) - (0.5*9.81 + 2*0.4*20/(1 + 0.04))*(3 - $loose))/0.5")" 1e-8

# ---- by moreau: the same laws, where it stops to the order of a step
check "a block by moreau" run rail go --method 'moreau(step=1e-3)'
check "slides to rest" close_to "$(final x)" "$(calc '1/(2*0.2*(30 - 19.62)/2)')" 1e-6
check "and stays" close_to "$(final "x'")" 0 1e-15
model many <<'END_OF'
model many
const N = 9
coord x[N] [m], y[N] [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, mu = 0.3 >= 0
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2))
potential = sum(i in 1..N, m*g*y[i])
for i in 1..N { guide rail[i]: y[i] = 0, friction = mu, slip = x[i]' }
scene go { start x[i in 1..N]' = 1.1 [m/s]; span 1 [s]; output x[1], x[9] }
END_OF
check "nine guides by moreau" run many go --method 'moreau(step=1e-2)'
check "of which the last stops, too" close_to "$(final 'x.9.')" "$(calc '1.21/(2*0.3*9.81)')" 1e-4 # h^2 mu g/8 and more in the step where it stops
sed 's/N = 9/N = 17/; s/x\[9\]/x[17]/; s/span 1/span 0.4/' "$TMP/many.lag" | model crowd
check "seventeen, more than events decide, take moreau" run crowd go
check "to the same rest" close_to "$(final 'x.17.')" "$(calc '1.21/(2*0.3*9.81)')" 1e-6 # h^2 mu g/8, 1000 steps a second
# slopes of forces once a step, and each mode tried twice: about 8 rates a guide and step
rates() { "$LAGC" run "$TMP/crowd.lag" --until 1 --method 'moreau(step=1e-2)' --json --quiet >"$TMP/json"; }
check "by 100 steps without rows" rates
check "of 8 rates a guide and step" close_to "$(calc "$(number rhs_calls)/1700")" 8 1
check "dop853 refuses them by number" refuses 2 'at most 16 guides with friction, and the model has 17' crowd go --method dop853
model beside <<'END_OF'
model beside
coord x [m], y [m], u [m], w [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0
kinetic = m/2*(x'^2 + y'^2 + u'^2 + w'^2)
potential = m*g*(y + w)
guide rail: y = 0, friction = 0.1, slip = x'
contact wall: 1 [m] - x >= 0, restitution = 0.5
contact floor: w >= 0, restitution = 0, friction = 0.2, slip = u'
scene go { start x' = 3 [m/s], u' = 1 [m/s]; span 3 [s]; output x, u }
END_OF
turned=$(calc '1 - (9 - 2*0.981)/4/(2*0.981)')
check "beside contacts, one of which it strikes" run beside go
check "with half its speed left" close_to "$(final x)" "$turned" 1e-12
check "by moreau" run beside go --method 'moreau(step=1e-3)'
check "to the path of a step" close_to "$(final x)" "$turned" 2e-3
check "beside a contact with friction" close_to "$(final u)" "$(calc '1/(2*0.2*9.81)')" 1e-6

# ---- a crank jams in its pin and rail beside its dead centre: both methods find where. The friction of either guide depends on that of the other, and with the pin held
# more of the rail's own would push the slider on.
model jams <<'END_OF'
model jams
coord a [rad], b [rad], x [m], y [m]
const r = 0.123 [m], l = 0.372 [m], low = -4 [mm]
kinetic = 0.02 [kg*m^2]/2*a'^2 + 0.004 [kg*m^2]/2*b'^2 + 1.56 [kg]/2*(x'^2 + y'^2)
potential = 1.56 [kg]*9.81 [m/s^2]*(x + y)
guide pin: (x, y) = (r*cos(a) + l*cos(b), r*sin(a) - l*sin(b)), friction = 0.367, slip = 21.5 [mm]*(a' + b')
guide rail: y = low, friction = 0.367, static = 0.482, slip = x'
scene go { start a = 2.125, a' = 13.3 [rad/s]; start guess b = 0, x = l, y = low; span 3 [s]; output a, x }
END_OF
check "a crank jams beside its dead centre" run jams go
at=$(final a) slider=$(final x)
check "by moreau" run jams go --method 'moreau(step=4e-4)'
check "at the same place" close_to "$(final a)" "$at" 5e-4 # of the order of the step
check "the slider, too" close_to "$(final x)" "$slider" 5e-6

# ---- a yoke that turns round and rests by the friction of slot and rail, of which each presses the other: moreau found no forces that agree. SciPy, dop853 to 1e-12: 2.99347498171667
model yoke <<'END_OF'
model yoke
coord a [rad], x [m], y [m]
const r = 0.05 [m], m = 1.5 [kg], g = 9.81 [m/s^2]
kinetic = 0.0075 [kg*m^2]/2*a'^2 + m/2*(x'^2 + y'^2)
potential = m*g*(x + y)
guide slot: x = r*cos(a), friction = 0.2, static = 0.23, slip = r*cos(a)*a' - y'
guide rail: y = 0, friction = 0.2, slip = x'
scene go { start a = 1.7, a' = -2.5 [rad/s]; start guess x = 0; span 3 [s]; output a }
END_OF
check "a yoke comes to rest" run yoke go --tol 1e-10
check "where SciPy finds it" close_to "$(final a)" 2.99347498171667 1e-9
check "by moreau" run yoke go --method 'moreau(step=4e-4)'
check "to the order of a step" close_to "$(final a)" 2.99347498171667 1e-3

# a crank whose rail has broken loose in a step, where friction of the pin that follows the load would let it hold in the next turn, and not in the one after
model loose <<'END_OF'
model loose
coord a [rad], b [rad], x [m], y [m]
kinetic = 0.024 [kg*m^2]/2*a'^2 + 0.0032 [kg*m^2]/2*b'^2 + 1.775 [kg]/2*(x'^2 + y'^2)
potential = 1.775 [kg]*9.81 [m/s^2]*x
guide pin: (x, y) = (0.1377 [m]*cos(a) + 0.3 [m]*cos(b), 0.1377 [m]*sin(a) - 0.3 [m]*sin(b)), friction = 0.241, slip = 17 [mm]*(a' + b')
guide rail: y = 6 [mm], friction = 0.241, static = 0.35, slip = x'
scene go { start a = -2.189, a' = 4.6 [rad/s]; start guess b = 0, x = 0.3 [m], y = 0.006 [m]; span 3 [s]; output a }
END_OF
check "a crank turns round" run loose go
at=$(final a)
check "by moreau" run loose go --method 'moreau(step=4e-4)'
check "at the same place" close_to "$(final a)" "$at" 2e-3 # of the order of the step

# ---- refusals
check "a negative friction" refuses 2 'the model declares mu >= 0' rail go mu=-0.1

# ---- the same on a curve: held from t = 0 on, it slips at 2 mu g/F, and sticks again (SciPy: 0.4119069855300544); moreau meets the friction of slipping exactly while it holds
for kind in 'guide path: x^2 + y^2 = R^2, friction = mu, static = 2*mu' 'constraint path: hypot(x, y) = R
let s = R*atan2(x, -y)
friction path on s: mu*abs(lambda(path)), static = 2*mu*abs(lambda(path))'; do
  printf "model curve\ncoord x [m], y [m]\nparam m = 1 [kg] > 0, R = 1 [m] > 0, g = 9.81 [m/s^2], mu = 0.2 >= 0\nkinetic = m/2*(x'^2 + y'^2)\npotential = m*g*y\nforce x = 0.8 [N/s]*t\n%s\nscene go { start y = -R; span 8 [s]; output x every 8 [s] }\n" "$kind" | sed 's/friction path on/friction rub on/' >"$TMP/curve.lag"
  one_of 2 || continue
  check "${kind%% *} holds a body on a curve, then not" run curve go
  check "and again" close_to "$(final x)" 0.4119069855300544 1e-9
  check "by moreau" run curve go --method 'moreau(step=1e-3)'
  check "to half a step" close_to "$(final x)" 0.4119069855300544 1e-5
done

# ---- a guide or a contact that sticks holds the slip of a joint with friction of its own: both carry the pull, until k t = F + mu m g
held() { # held NAME, on stdin: what presses the body, and its share of the inertia
  { printf "model %s\ncoord x [m], y [m], th [rad]\nparam m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, F = 2 [N] >= 0, mu = 0.3, k = 1 [N/s], r = 0.2 [m] > 0\n" "$1"
    printf "kinetic = m/2*(x'^2 + y'^2) + m*r^2/4*th'^2\npotential = m*g*y\nforce x = k*t\nconstraint gear: x = r*th\n"
    cat
    printf "scene pull { span 8 [s]; output x }\nscene go { like pull; start x' = 3 [m/s], th' = 15 [rad/s] }\n"
  } >"$TMP/$1.lag"
}
held on_guide <<'END_OF'
guide rail: y = 0, friction = mu, slip = x'
friction rub on x: F
END_OF
held on_contact <<'END_OF'
contact rail: y >= 0, restitution = 0, friction = mu, slip = x'
friction rub on x: F
END_OF
held geared <<'END_OF'
guide rail: y = 0, friction = mu, slip = x'
friction rub on th: F*r
END_OF
# 3/2 m x'' = k t - F - mu m g from t1 = (F + mu m g)/k on; before that v0 t - (F + mu m g) t^2/3 + k t^3/9 to its first stop, at v = 0
t1=$(calc '2 + 0.3*9.81')
for name in on_guide on_contact geared; do
  check "friction of a joint beside one that sticks, $name" run $name pull
  check "it breaks loose where both are at their limits" close_to "$(final x)" "$(calc "(8 - $t1)^3/9")" 1e-8
  check "after a stop" run $name go
  stop=$(calc "$t1 - sqrt($t1^2 - 9)") # 3 = ((F + mu m g) t - k t^2/2)/1.5
  check "the same" close_to "$(final x)" "$(calc "3*$stop - $t1*$stop^2/3 + $stop^3/9 + (8 - $t1)^3/9")" 1e-8
  one_of 3 || continue
  check "by moreau" run $name pull --method 'moreau(step=1e-3)'
  check "to h v/2 of the step in which it breaks loose" close_to "$(final x)" "$(calc "(8 - $t1)^3/9")" 1e-5
done

# ---- a cam whose friction presses its follower against the guide: N of the contact enters both. Its turn is Runge and Kutta's of a'^2 by a, from dead
# centre to dead centre, 4000 steps each
if one_of 3; then
model cam <<'END_OF'
model cam
coord a [rad], x [m], y [m], th [rad]
param m = 0.5 [kg] > 0, I = 0.002 [kg*m^2] > 0, mu = 0.1 >= 0, e = 0.02 [m], k = 300 [N/m]
kinetic = 0.05 [kg*m^2]/2*a'^2 + m/2*(x'^2 + y'^2) + I/2*th'^2
potential = m*9.81 [m/s^2]*y + k/2*(y + 0.05 [m])^2
guide low: x - 0.04 [m]*sin(th) = 0, friction = mu, slip = y'
guide high: x + 0.04 [m]*sin(th) = 0, friction = mu, slip = y'
contact lift: y - e*cos(a) >= 0, restitution = 0.1, friction = mu, slip = x' + 0.05 [m]*a'
scene go { start a' = 20 [rad/s], y = e; span 3 [s]; output a every 3 [s] }
END_OF
check "a cam that loads its follower's guide" run cam go --tol 1e-11
check "its angle" close_to "$(final a)" 51.96494584110964 1e-8
check "by moreau" run cam go --method 'moreau(step=1e-3)'
check "its angle, whose error falls as h^1.6 from 8e-3 at 1e-2" close_to "$(final a)" 51.96494584110964 2e-4
fi

# ---- a wedge lifts a rod in its guide: P = (m k F/M + m g)/(1 - mu k + m k^2/M) presses the guide with k P, of which friction lets 4 % pass with mu k = 0.96;
# with mu k = 1.08 it jams
model wedge <<'END_OF'
model wedge
coord s [m], x [m], y [m]
param m = 1 [kg] > 0, M = 20 [kg] > 0, mu = 0.6 >= 0, k = 1.2, F = 90 [N], g = 9.81 [m/s^2]
kinetic = M/2*s'^2 + m/2*(x'^2 + y'^2)
potential = m*g*y - F*s
guide rail: x = 0, friction = mu, slip = y'
contact lift: y - k*(s - x) >= 0, restitution = 0
scene go { span 1 [s]; output s every 1 [s] }
END_OF
for method in dop853 'moreau(step=1e-2)'; do
  check "a wedge lifts a rod in its guide, $method" run wedge go --method "$method"
  check "by a t^2/2" close_to "$(final s)" "$(calc '(90 - 1.2*(1.2*90/20 + 9.81)/(1 - 0.72 + 1.44/20))/40')" 1e-13
  check "close to where it jams" run wedge go mu=0.8 M=2000 F=300 --method "$method"
  check "the same" close_to "$(final s)" "$(calc '(300 - 1.2*(1.2*300/2000 + 9.81)/(0.04 + 1.44/2000))/4000')" 1e-13
  check "where it jams" run wedge go mu=0.9 M=10 --method "$method"
  check "it stays" close_to "$(final s)" 0 1e-12
done

# ---- telescopes of four slides on two guides each. Thrown together on a level all are slowed by mu g, so that no friction between them has more to
# hold than it can; let down a slope they come to rest on their stops, where each guide and stop could hold alone
if one_of 3; then
telescope() { # NAME MU SLOPE RESTITUTION START
  cat >"$TMP/$1.lag" <<END_OF
model $1
const N = 4
coord x[N] [m], y[N] [m], th[N] [rad]
param m = 0.5 [kg] > 0, I = 4e-3 [kg*m^2] > 0, g = 9.81 [m/s^2], mu = $2 >= 0, L = 0.3 [m] > 0, a = 0.05 [m] > 0, slope = $3
let X[0] = 0 [m]
let Y[0] = 0 [m]
let A[0] = 0 [rad]
let X[i in 1..N] = x[i]
let Y[i in 1..N] = y[i]
let A[i in 1..N] = th[i]
let s[i in 1..N] = (X[i] - X[i-1])*cos(A[i-1]) + (Y[i] - Y[i-1])*sin(A[i-1])
let n[i in 1..N] = -(X[i] - X[i-1])*sin(A[i-1]) + (Y[i] - Y[i-1])*cos(A[i-1])
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2) + I/2*th[i]'^2)
potential = sum(i in 1..N, m*g*(cos(slope)*y[i] + sin(slope)*x[i]))
for i in 1..N {
  guide back[i]: n[i] - a*sin(A[i] - A[i-1]) = 0, friction = mu, slip = s[i]'
  guide front[i]: n[i] + a*sin(A[i] - A[i-1]) = 0, friction = mu, slip = s[i]'
  contact inner[i]: s[i] >= 0, restitution = $4
  contact outer[i]: L - s[i] >= 0, restitution = $4
}
scene go { start $5; span 1 [s]; output x[4] every 1 [s] }
END_OF
}
in_time() (ulimit -t 60; run "$@") # it hung
telescope thrown 0.2 0 0.5 "x[i in 1..N] = 0.01*i, x[i in 1..N]' = 1 [m/s]"
check "four slides that move as one" in_time thrown go
check "come to rest after v^2/(2 mu g)" close_to "$(final 'x\[4\]')" "$(calc '0.04 + 1/(2*0.2*9.81)')" 1e-12
check "none has slipped on another" close_to "$(final 'x\[1\]')" "$(calc '0.01 + 1/(2*0.2*9.81)')" 1e-12
telescope let_down 0.2 0.8 0 "x[i in 1..N] = 0.05*i, x[4]' = 5 [m/s]"
check "a telescope down a slope" in_time let_down go
check "rests on its stops" close_to "$(final 'x\[4\]')" 0 1e-12
check "its balance closes" close_to "$(number drift)" 0 1e-8 # the tolerance, ten times
fi
# ---- a disc in a journal of radius 0.1 that carries (3, -4): it turns by w^2/(2 mu r 5) until t = w/(mu r 5) = 5
for size in 'hypot(lambda(px), lambda(py))' 'sqrt(lambda(px)^2 + lambda(py)^2)' 'sqrt(4*lambda(px)^2 + (2*lambda(py))^2)/2'; do
  printf '%s\n' 'model pin; coord x, y, th' "lagrangian = (x'^2 + y'^2 + th'^2)/2 - 4*y" 'force x = 3' 'param mu = 0.2 >= 0, r = 0.1 > 0' 'constraint px: x = 0; constraint py: y = 0' "friction rub on th: mu*r*$size" "scene go { start th' = 0.5; span 6 }" >"$TMP/pin.lag"
  check "a journal, by $size" run pin go
  check "... stops after 1.25 rad" close_to "$(final th)" 1.25 1e-12
done

# ---- coefficients that depend on the place, outside of their range at the start
begins() { # FRICTION: a bead on a rail at x = 2
  printf '%s\n' 'model bead; coord x, y' "lagrangian = (x'^2 + y'^2)/2 - 9.81*y" 'constraint rail: y = 0' "friction rub on x: $1" "scene s { start x = 2, x' = 6; span 1 }" >"$TMP/bead.lag"
  "$LAGC" run "$TMP/bead.lag"
}
check "a negative coefficient" says 2 'this friction has a coefficient of -1, which must be at least 0: it is 1 - x' begins '(1 - x)*abs(lambda(rail))'
check "a static one below that while it slips" says 2 'the friction rub.slip has a static friction of 0.1, which must be at least its friction while it slips, 0.3' begins '0.3*abs(lambda(rail)), static = (x - 1.9)*abs(lambda(rail))'

# ---- and on the way: x = 1 - cosh(k t) + 6 sinh(k t)/k, k^2 = 9.81, passes 1 at t = atanh(k/6)/k = 0.18489, where x' = sqrt(36 - k^2)
printf '%s\n' 'model worn; coord x, y' "lagrangian = (x'^2 + y'^2)/2 - 9.81*y" 'constraint rail: y = 0' 'friction rub on x: (1 - x)*abs(lambda(rail))' "scene s { start x' = 6; span 1 }" >"$TMP/worn.lag"
for method in rk4 moreau; do
  check "a coefficient that becomes negative, $method" says 3 'at t = 0.185 s this friction has a coefficient of -0.0005' "$LAGC" run "$TMP/worn.lag" --quiet --method "$method(step = 1e-3)"
done
for method in dop853 radau; do
  check "the same, $method" says 3 'which must be at least 0: it is 1 - x' "$LAGC" run "$TMP/worn.lag" --quiet --method $method
done

tap_end
