#!/bin/sh
# Laws of contacts: Newton's, Poisson's and Stronge's coefficient of restitution, static friction, rolling to rest, and the size of a program with many contacts.
# The numbers of impacts are from an integration of Routh's equations over the impulse in all coordinates, with 40 digits, by a script of its own
# (tests/exec/contacts/impact.py).
. tests/exec/lib_motion.sh

refuses() { # refuses STATUS WORDS MODEL ARGS...
  status=$1 words=$2 name=$3
  shift 3
  "$LAGC" run "$TMP/$name.lag" "$@" >"$TMP/log" 2>&1
  [ $? = "$status" ] && grep -q -e "$words" "$TMP/log" || { cat "$TMP/log"; return 1; }
}
rejects() { # rejects WORDS OPTIONS: a model with a contact of these options
  printf 'model m\ncoord x [m], y [m]\nparam mu = 0.3\nlagrangian = 1 [kg]/2*(x%s^2 + y%s^2)\ncontact c: y >= 0, restitution = 0, %s\nscene s { span 1 }\n' "'" "'" "$2" >"$TMP/bad.lag"
  ! "$LAGC" check "$TMP/bad.lag" s >"$TMP/log" 2>&1 && grep -q -e "$1" "$TMP/log" || { cat "$TMP/log"; return 1; }
}

# ---- a double pendulum strikes the floor with its tip (after T.R. Kane, D.A. Levinson, Dynamics (1985), 5.8): the slip turns, and Newton's law adds energy
pendulum() { # LAW: a model of that law
  model "pendulum_$1" <<END_OF
model pendulum_$1
coord a [rad], b [rad]
param mu = 0.5 >= 0, e = 0.5, A = 20 [deg], B = 30 [deg]
let y = -cos(a) - cos(b)
let x = sin(a) + sin(b)
kinetic = 1 [kg*m^2]*(2/3*a'^2 + 1/2*cos(a - b)*a'*b' + 1/6*b'^2)
contact floor: 1 [m]*(y + cos(A) + cos(B)) >= 0, restitution = e, friction = mu, slip = 1 [m]*x'$2
scene s { start a = A, b = B, a' = -0.1 [rad/s], b' = -0.2 [rad/s]; span 1e-9 [s]; output a', b', energy every 1e-9 [s] }
END_OF
}
pendulum default ""
pendulum stronge ", law = stronge"
pendulum poisson ", law = poisson"
pendulum newton ", law = newton"
for law in default stronge; do
  check "a double pendulum strikes, $law" run pendulum_$law s
  check "a' by Stronge's law" close_to "$(cell 0 2)" -0.19893233597135099687 1e-14
  check "b' by Stronge's law" close_to "$(cell 0 3)" 0.22313678537660737902 1e-14
done
check "the same, by Poisson's law" run pendulum_poisson s
check "a' by Poisson's law" close_to "$(cell 0 2)" -0.19717970613818508518 1e-14
check "b' by Poisson's law" close_to "$(cell 0 3)" 0.21960668440432969306 1e-14
check "the same, by Newton's law" run pendulum_newton s
check "a' by Newton's law" close_to "$(cell 0 2)" -0.23437461526662126662 1e-14
check "b' by Newton's law" close_to "$(cell 0 3)" 0.2945236933433434188 1e-14
check "friction 0.7: Stronge's law loses energy" run pendulum_stronge s mu=0.7
check "a'" close_to "$(cell 0 2)" -0.19260193051367542869 1e-14
check "friction 0.7: Poisson's law loses energy" run pendulum_poisson s mu=0.7
check "a'" close_to "$(cell 0 2)" -0.19096650159695448637 1e-14
check "friction 0.7: Newton's law would add energy" refuses 3 "at t = 0 s the impact of the contact floor would add 0.013619 J of kinetic energy by Newton's law, as friction turns the slip in it" pendulum_newton s mu=0.7

# ---- a ball: normal and tangential velocity are not coupled, and the three laws are one
for law in stronge poisson newton; do
  model ball <<END_OF
model ball
coord x [m], y [m], th [rad]
param m = 1 [kg] > 0, r = 0.1 [m] > 0
kinetic = m/2*(x'^2 + y'^2) + m*r^2/5*th'^2
contact floor: y >= r, restitution = 0.6, friction = 0.1, slip = x' + r*th', law = $law
scene s { start y = r, x' = 2 [m/s], y' = -3 [m/s]; span 1 [s] }
END_OF
  check "a ball by $law" run ball s
  check "-e v" close_to "$(final "y'")" 1.8 1e-14
  check "v - mu (1 + e) v_n" close_to "$(final "x'")" "$(calc '2 - 0.1*1.6*3')" 1e-14
  check "5 mu (1 + e) v_n/(2 r)" close_to "$(final "th'")" "$(calc '-2.5*0.1*1.6*3/0.1')" 1e-12
done

# ---- an eccentric rod strikes with its end, without slip before: with friction 0.3 it slips throughout, and the laws agree; with 0.6 the slip stops
for law in stronge poisson newton; do
  model rod <<END_OF
model rod
coord x [m], y [m], th [rad]
param mu = 0.3 >= 0
let fx = x - 0.5 [m]*cos(th)
let fy = y - 0.5 [m]*sin(th)
kinetic = 1 [kg]/2*(x'^2 + y'^2) + 1/24 [kg*m^2]*th'^2
contact floor: fy >= 0, restitution = 0.6, friction = mu, law = $law, slip = fx'
scene s { start th = 1 [rad], y = 0.5*sin(1), x' = -0.3 [m/s], y' = -1 [m/s]; span 1e-9 [s]; output x', y', th' every 1e-9 [s] }
END_OF
  check "a rod slips through its impact, $law" run rod s
  check "x'" close_to "$(cell 0 2)" 0.027288518250239050564 1e-14
  check "y'" close_to "$(cell 0 3)" 0.090961727500796835213 1e-14
  case $law in
  stronge) want="0.4039675231831138796 0.39254002678764313331 -0.96014605488824450728" ;;
  poisson) want="0.41305764966673881883 0.41336163875690813737 -0.98175137853633242872" ;;
  newton) want="0.3862619369838554987 0.35198406244617462293 -0.91806359091998189377" ;;
  esac
  set -- $want
  check "it sticks in its impact, $law" run rod s mu=0.6
  check "x'" close_to "$(cell 0 2)" "$1" 1e-14
  check "y'" close_to "$(cell 0 3)" "$2" 1e-14
  check "th'" close_to "$(cell 0 4)" "$3" 1e-13
done

# ---- static friction
model pull <<'END_OF'
model pull
coord x [m], y [m]
param m = 2 [kg] > 0, g = 9.81 [m/s^2] > 0, mu = 0.3 >= 0, hold = 0.5, k = 3 [N/s], a = 0 [deg]
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*(x*sin(a) + y*cos(a))
force x = k*t
contact plane: y >= 0, restitution = 0, friction = mu, static = hold, slip = x'
scene s { span 4 [s]; output x, x', lambda(plane.slip) every 0.5 [s] }
scene slope { like s; k = 0; a = 20 [deg] }
END_OF
for method in rk45 dop853 radau rk4; do
  check "a growing pull, static = 0.5, by $method" run pull s --method "$method" --measure 'slips=hit(plane slips)'
  t=$(calc '0.5*2*9.81/3')
  check "breaks the block loose at mu_s m g/k" close_to "$(number slips)" "$t" 1e-9
  # m x'' = k t - mu m g from then on
  check "it slides under mu m g" close_to "$(final x)" "$(calc "3/4*((64 - $t^3)/3 - $t^2*(4 - $t)) - 0.3*9.81*(4 - $t)^2/2")" 1e-8
done
check "held by more than mu m g" close_to "$(cell 3 4)" -9 1e-12
check "tan 20 deg is between mu and mu_s: it rests" run pull slope
check "where it is" close_to "$(final x)" 0 0
check "pushed down it does not stop" run pull slope "x'=-0.001"
check "(sin a - mu cos a) g" close_to "$(final x)" "$(calc '-0.004 - 8*9.81*(sin(atan2(0,-1)/9) - 0.3*cos(atan2(0,-1)/9))')" 1e-11
check "pushed up it comes to rest" run pull slope "x'=1"
check "at v^2/(2 g (sin a + mu cos a))" close_to "$(final x)" "$(calc '1/(2*9.81*(sin(atan2(0,-1)/9) + 0.3*cos(atan2(0,-1)/9)))')" 1e-12
check "without static the same model slides back" run pull slope "x'=1" hold=0.3
check "it moves" test "$(final "x'")" != 0
model crates <<'END_OF'
model crates
coord x [m], y [m], th [rad], u [m], v [m]
param w = 0.5 [m] > 0, mu = 0.3 >= 0, mu_s = 0.6 >= 0, F = 2 [N/s], G = 5 [N]
kinetic = 1 [kg]/2*(x'^2 + y'^2 + u'^2 + v'^2) + 0.1 [kg*m^2]/2*th'^2
potential = 10 [N]*(y + v)
force x = F*t
force u = G
contact a: y - w*th >= 0, restitution = 0, friction = mu, static = mu_s, slip = x'
contact b: y + w*th >= 0, restitution = 0, friction = mu, static = mu_s, slip = x'
contact c: v >= 0, restitution = 0, static = mu_s, friction = mu, slip = u'
scene s { span 6 [s]; output u', lambda(c.slip) every 2 [s] }
END_OF
check "a crate on two feet, and a block that needs its static friction" run crates s --measure 'one=hit(a slips)' --measure 'other=hit(b slips)'
check "the crate breaks loose at mu_s m g/F" close_to "$(number one)" 3 1e-10
check "on both feet" close_to "$(number other)" 3 1e-10
check "with m x'' = F t - mu m g" close_to "$(final x)" "$(calc '((216 - 27)/3 - 9*3) - 3*9/2')" 1e-9
check "the block stays" close_to "$(cell 6 2)" 0 0
check "held by 5 N, more than 3 N" close_to "$(cell 6 3)" -5 1e-9

# by moreau: it breaks loose a step late, at a pull of k h more; a step in which the slip turns is off by h^2 g/8 and less
moreau='moreau(step=0.001)'
check "a growing pull by moreau" run pull s --method "$moreau"
t=$(calc '0.5*2*9.81/3')
check "slides from mu_s m g on" close_to "$(final x)" "$(calc "3/4*((64 - $t^3)/3 - $t^2*(4 - $t)) - 0.3*9.81*(4 - $t)^2/2")" 1e-6
check "held by more than mu m g" close_to "$(cell 3 4)" -9 2e-3 # the mean of a step
check "on a slope" run pull slope --method "$moreau"
check "it rests" close_to "$(final x)" 0 0
check "pushed down" run pull slope "x'=-0.001" --method "$moreau"
check "it does not stop" close_to "$(final x)" "$(calc '-0.004 - 8*9.81*(sin(atan2(0,-1)/9) - 0.3*cos(atan2(0,-1)/9))')" 1e-11
check "pushed up" run pull slope "x'=1" --method "$moreau"
check "it stops where it would turn" close_to "$(final x)" "$(calc '1/(2*9.81*(sin(atan2(0,-1)/9) + 0.3*cos(atan2(0,-1)/9)))')" 2e-6
check "no energy comes in" close_to "$(number drift)" 0 1e-12
check "two feet and a block by moreau" run crates s --method "$moreau"
check "m x'' = F t - mu m g" close_to "$(final x)" "$(calc '((216 - 27)/3 - 9*3) - 3*9/2')" 1e-2 # a step late, at 3 m/s^2 for 3 s
check "the block stays" close_to "$(cell 6 2)" 0 0
sed 's/^contact .*//; s/^force x.*/&\nfriction plane on x: mu*m*g*cos(a), static = hold*m*g*cos(a)/; s/lambda(plane.slip)/plane/' "$TMP/pull.lag" >"$TMP/joint.lag"
check "dry friction of a joint, too" run joint slope "x'=1" --method "$moreau"
check "stops there" close_to "$(final x)" "$(calc '1/(2*9.81*(sin(atan2(0,-1)/9) + 0.3*cos(atan2(0,-1)/9)))')" 2e-6

# ---- rolling resistance is dry friction on the angle, of an arm c times the force that presses: x' falls by c g/(r (1 + 2/5)) a second
model rolls <<'END_OF'
model rolls
coord x [m], y [m], th [rad]
param m = 1 [kg] > 0, r = 0.1 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.3 >= 0, c = 0.002 [m] >= 0, a = 0 [rad]
kinetic = m/2*(x'^2 + y'^2) + m*r^2/5*th'^2
potential = m*g*(y*cos(a) + x*sin(a))
contact floor: y >= r, restitution = 0, friction = mu, slip = x' + r*th'
friction rolling on th: c*m*g*cos(a)
scene s { start y = r, x' = 1 [m/s], th' = -10 [rad/s]; span 10 [s]; output x, rolling, lambda(floor.slip) every 1 [s] }
END_OF
for method in rk45 dop853 radau rk4; do
  check "a ball rolls to rest, by $method" run rolls s --method "$method"
  check "after 7 v^2 r/(10 c g)" close_to "$(final x)" "$(calc '0.7*0.1/(0.002*9.81)')" 1e-12
  check "and stays" close_to "$(final "x'")" 0 1e-14
done
# pushed without spin it slips for v/(g (mu + 5 (mu - c/r)/2)) = 1/9.81 s first, at the speed 0.7 m/s then; with c > mu r it never turns
check "a ball that is pushed" run rolls s "th'=0"
check "slides, and rolls to rest" close_to "$(final x)" "$(calc '1/9.81 - 0.3/(2*9.81) + 0.7*0.49*0.1/(0.002*9.81)')" 1e-12
check "on a floor that holds its turning" run rolls s "th'=0" c=0.05
check "it slides as a block" close_to "$(final x)" "$(calc '1/(2*0.3*9.81)')" 1e-12
# a ball on a slope rests up to tan a = c/r
check "on a slope of tan a = 0.0199 < c/r" run rolls s "x'=0" "th'=0" a=0.0199
check "it rests" close_to "$(final x)" 0 1e-14
check "on a slope of tan a = 0.0201" run rolls s "x'=0" "th'=0" a=0.0201
check "it rolls" close_to "$(final x)" "$(calc '-50*9.81*(sin(0.0201) - 0.02*cos(0.0201))/1.4')" 1e-9

# ---- a slider with play in its guide, of P. Flores, R. Leine, C. Glocker, Multibody Syst. Dyn. 23 (2010) 165, DOI 10.1007/s11044-009-9178-y: it strikes with two
# corners at once, and moreau lets both come back by Newton's law, as the one equation of their common impulse does (steps of Runge and Kutta on both sides of it)
model clearance <<'END_OF'
model clearance
coord a [rad], b [rad], c [rad]
param l = 153 [mm] > 0, L = 306 [mm] > 0, w = 50 [mm] > 0, h = 25 [mm] > 0, play = 1 [mm] > 0, g = 9.81 [m/s^2], e = 0.4, mu = 0.01 >= 0
param m = 38 [g] > 0, J1 = 7.4e-5 [kg*m^2] > 0, J2 = 5.9e-4 [kg*m^2] > 0, J3 = 2.7e-6 [kg*m^2] > 0
let A = l/2*(cos(a), sin(a)), B = l*(cos(a), sin(a)) + L/2*(cos(b), sin(b)), S = l*(cos(a), sin(a)) + L*(cos(b), sin(b))
kinetic = m/2*dot(A', A') + m/2*dot(B', B') + m*dot(S', S') + J1/2*a'^2 + J2/2*b'^2 + J3/2*c'^2
potential = m*g*(A.y + B.y + 2*S.y)
let x1 = S.x - w*cos(c) - h*sin(c), x2 = S.x + w*cos(c) - h*sin(c), x3 = S.x - w*cos(c) + h*sin(c), x4 = S.x + w*cos(c) + h*sin(c)
contact p1: play - S.y + w*sin(c) + h*(1 - cos(c)) >= 0, restitution = e, friction = mu, slip = x1'
contact p2: play - S.y - w*sin(c) + h*(1 - cos(c)) >= 0, restitution = e, friction = mu, slip = x2'
contact p3: play + S.y - w*sin(c) + h*(1 - cos(c)) >= 0, restitution = e, friction = mu, slip = x3'
contact p4: play + S.y + w*sin(c) + h*(1 - cos(c)) >= 0, restitution = e, friction = mu, slip = x4'
scene s { start a' = 150 [rad/s], b' = -75 [rad/s]; span 4 [ms]; output a', c every 2.5 [ms] }
END_OF
check "a slider with play" run clearance s --method 'moreau(step=1e-5)'
check "the crank on its way to the impact" close_to "$(cell 0.0025 2)" 112.35358569905735 1e-2 # h^2 at 150 rad/s
check "and behind it" close_to "$(final "a'")" 93.45792790799663 8e-3 # the impact is off by half a step
check "as published, by steps of 1e-4 with the mass matrix at their begin" close_to "$(final "a'")" 93.96242554169565 0.6 # siconos-tutorials, SliderCrankMoreauJeanDirectProjectionOSI.ref
check "the slider does not turn" close_to "$(final c)" 0 1e-12

# ---- refusals
check "static below sliding friction" refuses 2 'the static limit minus the friction of a sliding body has a value of -0.1, which must be at least 0: it is hold - mu' pull s hold=0.2
check "moreau has a law of its own" refuses 2 'moreau.* has a law of impact of its own' pendulum_newton s --method 'moreau(step=0.01)'
check "another law" rejects 'a law of impact is .stronge., .poisson. or .newton.' "friction = mu, slip = x', law = moreau"
check "a law and a tangential restitution" rejects '.tangential. is a law of its own' "friction = mu, slip = x', tangential = 1, law = newton"
check "an option twice" rejects 'the contact .c. has .friction. twice' "friction = mu, slip = x', friction = 1"
check "static without friction" rejects 'the contact .c. has a slip and no friction' "static = mu, slip = x'"
check "a law alone" rejects 'the contact .c. has neither friction nor slip' "law = newton"
check "static below 0" rejects 'a coefficient of static friction is at least 0' "friction = mu, static = -1, slip = x'"

# ---- the laws of contacts are emitted once: the C of a stack of blocks grows as its number, not as its square
cat >"$TMP/stack.lag" <<'END_OF'
model stack
const N = 5
coord x[N] [m], y[N] [m]
let X[0] = 0 [m]
let X[i in 1..N] = x[i]
let Y[0] = 0 [m]
let Y[i in 1..N] = y[i]
kinetic = sum(i in 1..N, 1 [kg]/2*(x[i]'^2 + y[i]'^2))
potential = sum(i in 1..N, 9.81 [N]*y[i])
for i in 1..N {
  contact c[i]: Y[i] - Y[i-1] >= 0.1 [m], restitution = 0.2, friction = 0.5, slip = X[i]' - X[i-1]'
}
scene s { start y[i in 1..N] = 0.1*i; span 1 [s] }
END_OF
grows() { # 60 blocks against 30: at most 2.2 times the text
  a=$("$LAGC" emit "$TMP/stack.lag" -D N=30 | wc -c) b=$("$LAGC" emit "$TMP/stack.lag" -D N=60 | wc -c)
  echo "$a $b"
  [ "$b" -lt $((a * 22 / 10)) ]
}
check "60 blocks take twice the C of 30" grows
tap_end
