#!/bin/sh
# Sizes that rounding cannot undercut, and errors that two runs alike do not show: what rests, what cancels, kicks where a floor is touched, laws of growth that a run does not show.
# Expected: closed forms; horizons by runs at other tolerances, which part there.
. tests/tap.sh

# value KEY: a number or word of the JSON in $TMP/json
value() { sed -n "s/.*\"$1\": *\"\{0,1\}\([^,}\"]*\).*/\1/p" "$TMP/json" | head -n 1; }
run() { "$LAGC" run "$@" -o /dev/null --json >"$TMP/json" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }; }
# below NAME MOST GOT: a number, and at most MOST
below() { check "$1" awk -v m="$2" -v g="$3" 'BEGIN { print g; exit !(g ~ /^[0-9]/ && g + 0 <= m) }'; }

# A pendulum that hangs at an angle of 180 degrees: sin(pi) is 1.2e-16 in doubles, and so is its motion.
cat >"$TMP/rest.lag" <<'EOF2'
model rest
coord x [m], th [rad]
param m = 1 [kg] > 0, k = 4 [N/m] > 0, l = 0.5 [m] > 0, g = 9.81 [m/s^2] > 0
kinetic = m/2*x'^2 + m*l^2/2*th'^2
potential = k/2*x^2 + m*g*l*cos(th)
effect soft { param e = 10 [N/m^2]; potential = e*x^3/3 }
scene s { start x = 0.1, th = 180 [deg]; span 20 [s]; exact x = 0.1 [m]*cos(2 [1/s]*t); output x every 1 }
scene bent { start x = 0.1, th = 180 [deg]; span 20 [s]; use soft; output x every 1 }
EOF2
check "a pendulum that hangs at rest beside a spring" run "$TMP/rest.lag" s
# the closed form's largest deviation, over the size of x, 0.1: it is of the same order as that of x'
below "its error is the spring's" 3e-8 "$(value error)"
check "--accuracy is not refused" run "$TMP/rest.lag" s --accuracy 1e-6
check "an effect beside it is needed: without it the spring moves as cos(2t)" sh -c '"$0" effects "$1" bent | grep "^ *soft .*needed"' "$LAGC" "$TMP/rest.lag"

# A square crate slides flat: x = v t - mu g t^2/2 up to v/(mu g) = 1.2232 s, then v^2/(2 mu g) = 3.6697247706422. It neither lifts nor turns.
cat >"$TMP/crate.lag" <<'EOF2'
model crate
coord x [m], y [m], q [rad]
param m = 3 [kg] > 0, s = 0.06 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.5 >= 0
let cx[1] = x + cos(q)*(-s) + sin(q)*s
let cy[1] = y + sin(q)*(-s) - cos(q)*s
let cx[2] = x + cos(q)*s + sin(q)*s
let cy[2] = y + sin(q)*s - cos(q)*s
kinetic = m/2*(x'^2 + y'^2) + m*(2*s)^2/12*q'^2
potential = m*g*y
for i in 1..2 { contact foot[i]: cy[i] >= 0, restitution = 0, friction = mu, slip = cx[i]' }
scene slide { start y = 0.06, x' = 6 [m/s]; span 2 [s]; output x every 0.5 }
EOF2
check "a crate that slides flat" run "$TMP/crate.lag"
near "comes to rest where it must" 1e-12 3.6697247706422 "$(value x)"
below "with an error at rounding" 1e-13 "$(value error)"

# A kick while the ball lies on the floor: y = v t - g t^2/2 from then on, exact for each method.
cat >"$TMP/kick.lag" <<'EOF2'
model late
coord y
param g = 9.81, e = 0.9, v = 1, T = 10
lagrangian = y'^2/2 - g*y
contact floor: y >= 0, restitution = e
kick k every T { y' = v }
scene s { start y = 0; span 10.05; output y every 1 }
EOF2
for how in "" "--method rk4"; do
  # shellcheck disable=SC2086 # a list of words
  check "a kick on a floor that is touched${how:+, $how}" run "$TMP/kick.lag" $how
  below "is no error${how:+, $how}" 1e-13 "$(value error)"
done

# L = -a (1 - cos x)/x^2 = -a (1/2 - x^2/24 + ..): x'' = x/12 near 0, x(2) = x0 cosh(2/sqrt(12)), but for x0^2.
cat >"$TMP/remov.lag" <<'EOF2'
model remov
coord x
param a = 1
lagrangian = x'^2/2 - a*(1 - cos(x))/x^2
scene tiny { start x = 1e-5; span 2; tolerance 1e-12; output x every 1 }
EOF2
check "a removable singularity" run "$TMP/remov.lag"
near "its half-angle form has six digits left at 1e-5" 2e-11 1.17134797e-05 "$(value x)"
is "and says that the error is not known" null "$(value error)"
check "naming the formula" says 0 "the formula of x'' cancels along this motion" "$LAGC" run "$TMP/remov.lag" x=1e-8
# At 1e-12 the logarithm has lost five of 19 digits in the self-check, too.
printf '%s\n' "model log" "coord x" "state z" "kinetic = x'^2/2" "force x = -log(1 + 1e-12*x)*1e12" "flow z' = -log(1 + 1e-12*z)*1e12" \
  "scene s { start x = 1, z = 1; span 1 }" >"$TMP/log.lag"
check "digits that a series lost, too" says 0 "cancels along this motion" "$LAGC" run "$TMP/log.lag" --method taylor
check "away from it all is known" run "$TMP/remov.lag" x=1
below "to rounding" 1e-10 "$(value error)"

# A rewrite keeps the digits of products beside their zeros: at u = x - y = 2^-23 the sums sin(1 + u) - sin(1), cos(1) - cos(1 + u), sinh(1 + u) - sinh(1)
# have nine. Values in 40 digits by mpmath.
printf '%s\n' "model zeros" "coord x, y, z, u" "lagrangian = (x'^2 + y'^2 + z'^2 + u'^2)/2" "force x = 2*cos(1 + (x - u)/2)*sin((x - u)/2)" \
  "force y = 2*sin(1 + (y - u)/2)*sin((y - u)/2)" "force z = 2*cosh(1 + (z - u)/2)*sinh((z - u)/2)" "observe a = x'', b = y'', c = z''" \
  "scene s { start x = 0.5 + 2^(-23), y = 0.5 + 2^(-23), z = 0.5 + 2^(-23), u = 0.5; span 1e-12; output a, b, c }" >"$TMP/zeros.lag"
"$LAGC" run "$TMP/zeros.lag" --quiet -o "$TMP/zeros.csv"
sed -n 2p "$TMP/zeros.csv" | tr ',' ' ' >"$TMP/first"
read -r _ a b c <"$TMP/first"
near "2 cos(1 + u/2) sin(u/2)" 1e-21 6.4409048046178734e-8 "$a"
near "2 sin(1 + u/2) sin(u/2)" 1e-21 1.0031116211562413e-7 "$b"
near "2 cosh(1 + u/2) sinh(u/2)" 1e-21 1.8394955454620089e-7 "$c"

# Laws that a run does not show. A pendulum by rk4 loses energy, and its phase grows as t^2 in the end: 3e-7 at 30 s, 2.5e-5 at 160 s. A double pendulum in chaos: its error multiplies
# by 118 from 4 to 8 s, as no power does.
printf 'model p\ncoord th\nlagrangian = th%s^2/2 + 1.3*cos(th)\nscene s { start th = 2; span 30; output th every 1 }\n' "'" >"$TMP/p.lag"
check "a pendulum by rk4" run "$TMP/p.lag" --method rk4 --step 0.05
is "does not claim that its error is bounded" null "$(value error_growth)"
cat >"$TMP/d.lag" <<'EOF2'
model d
coord a, b
let x1 = sin(a)
let y1 = -cos(a)
let x2 = x1 + sin(b)
let y2 = y1 - cos(b)
kinetic = (x1'^2 + y1'^2)/2 + (x2'^2 + y2'^2)/2
potential = 9.81*(y1 + y2)
scene s { start a = 2, b = 2.5; span 8; tolerance 1e-10; output a every 1 }
EOF2
check "a double pendulum" run "$TMP/d.lag"
check "claims no power of t" sh -c 'case $1 in null | exponential) ;; *) echo "$1"; exit 1 ;; esac' sh "$(value error_growth)"

# Chaos that shows late, between two light planets (a start of REBOUND's tests): runs at tolerances 1e-11 to 1e-13 part by 0.3 between 290 and 370 s.
late() {
  cat >"$TMP/late.lag" <<'EOF2'
model late_chaos
const N = 3
coord r[N]: vec3
param m[N] = {1.0, 0.0001, 0.0001} > 0, G = 1.0
lagrangian = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]') + sum(j in 1..i-1, G*m[i]*m[j]/norm(r[i] - r[j])))
scene s { start r = {(-6.197107027845805e-05, 0.0, 0.0), (0.29363168356222114, 0.0, 0.0), (0.32607901922235927, 0.0, 0.0)}, r' = {(0.0, -0.00035960958943490696, 0.0), (0.0, 1.844972046009362, 0.0), (0.0, 1.7511238483397074, 0.0)}
  span 1000; tolerance 1e-12; output r every 100 }
EOF2
  check "two planets" run "$TMP/late.lag"
  near "know their horizon" 70 330 "$(value horizon)"
}
slow late

# At rest with forces in balance, in coordinates that are all 0: what moves is rounding, and no energy is lost.
cat >"$TMP/balance.lag" <<'EOF2'
model balance
coord x [m], y [m]
param m = 0.3 [kg] > 0, k = 0.7 [N/m], d = 0.1 [m], F = 0.07 [N]
kinetic = m/2*(x'^2 + y'^2)
potential = k/2*(x - d)^2 - k/2*d^2 + F*x + k/2*(y + d)^2 - k/2*d^2 - F*y
scene s { span 10 [s]; output x every 1 [s] }
EOF2
cat >"$TMP/truss.lag" <<'EOF2'
model truss
coord x [m], y [m], u [m], w [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2], l = 0.37 [m]
kinetic = m/2*(x'^2 + y'^2 + u'^2 + w'^2)
potential = m*g*(y + w)
constraint a: (x + l)^2 + y^2 = l^2
constraint b: x^2 + (y + 2*l)^2 = 4*l^2
constraint c: (u - x + l)^2 + (w - y + l)^2 = 2*l^2
constraint d: u = 0.2*w
scene s { span 2 [s]; output x every 1 [s] }
EOF2
rests() { # WORDS...: for each method
  for m in rk4 variational symplectic_euler; do "$LAGC" run "$@" --method $m --step 1e-3 >"$TMP/out" 2>&1 || { echo "$m"; cat "$TMP/out"; return 1; }; done
}
check "forces in balance" rests "$TMP/balance.lag"
check "in milligrams" rests "$TMP/balance.lag" m=3e-4 k=7e-4 F=7e-5
check "held by constraints" rests "$TMP/truss.lag"
check "of a nanogram" rests "$TMP/truss.lag" m=1e-12

# Long steps of taylor let a part at rest grow from rounding to its tolerance; the spring beside it has nine digits: x = 0.875 cos(w t) - 0.1875/w sin(w t), w^2 = 15/7.
cat >"$TMP/long_steps.lag" <<'END'
model long_steps
coord x [m], ph
param m = 0.875 [kg] > 0, k = 1.875 [N/m] > 0, I = 0.25 [kg*m^2] > 0, tq = 4.9 [N*m] > 0
lagrangian = m/2*x'^2 - k/2*x^2 + I/2*ph'^2 - tq*cos(ph)
scene s { start x = 0.875, x' = -0.1875, ph = 3.141592653589793; span 60; method taylor }
END
"$LAGC" run "$TMP/long_steps.lag" --json >"$TMP/out"
check "what grows from rounding is no lost digit" awk -F'[:,}]' '{ for (i = 1; i < NF; i++) if ($i ~ /"error"$/ || $i ~ /"x"$/) v[$i ~ /error/ ? "e" : "x"] = $(i + 1)
  w = sqrt(15/7); d = v["x"] - 0.875*cos(60*w) + 0.1875/w*sin(60*w); if (d < 0) d = -d; print v["e"], d; exit !(v["e"] > d/3 && v["e"] < 1e-7 && d < 1e-8) }' "$TMP/out"

# Other units, 1e-9 to 1e9 times, and parts at rest beside: no verdict changes.
[ -n "${SLOW:-}" ] && few= || few=--few
if command -v python3 >/dev/null; then
  check "no verdict changes with units or with what rests" python3 tests/accuracy/units.py ${few} --of "$(depth 1 3 1)"
  . tests/exec/lib_precision.sh
  if has_precision long; then slow check "estimates of 60 random runs" python3 tests/accuracy/estimates.py --n 60 --seed 5; fi
fi
# A door that friction holds: the telescope has no mass, and its velocity is rounding, 2e-17 m/s.
run models/door_closer.lag stays
below "a door at rest has an error" 1e-13 "$(value error)"
# A drum that its shoe holds: 1e4 N*m in balance leave 2e-27 rad; the second run has made no step when sizes are taken.
run models/drum_brake.lag locks
below "a drum at rest has an error" 1e-13 "$(value error)"
# Shut, the seal has what an impact at 5 rad/s leaves of its velocity, 1e-16 m/s, whose sign is no event.
check "a door slams shut" run models/door_closer.lag slam k=2987
# Released at 90 degrees the rod pulls at the cart by g cos(90 deg) = 6e-16 m/s^2: its reach is not that acceleration's, and steps are those of 89 degrees.
run models/cart_pendulum.lag swing --method dop853 --tol 1e-9 --until 0.5 th='89[deg]'
steps=$(value steps)
run models/cart_pendulum.lag swing --method dop853 --tol 1e-9 --until 0.5
below "a force that is rounding at the start makes no steps" $((2 * steps)) "$(value steps)"
below "and the energy's drift is one of joules" 1e-9 "$(value energy_drift)"
check "a stronger spring" run models/door_closer.lag slam k=1678.6666666666667
tap_end
