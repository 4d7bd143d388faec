#!/bin/sh
# Dry friction and other switches of the equations: stops, sticking, sliding modes, crossings, and refusals, against closed forms. The models of the gallery
# have facts of their own (models/block, coulomb_oscillator, stick_slip).
. tests/tap.sh

model() { cat >"$TMP/$1.lag"; }
# run MODEL ARGS...: JSON in $TMP/json
run() {
  name=$1
  shift
  "$LAGC" run "$TMP/$name.lag" "$@" --json >"$TMP/json" 2>"$TMP/err" || { cat "$TMP/json" "$TMP/err"; return 1; }
}
number() { sed -n "s/.*\"$1\": \\([-0-9.e+]*\\).*/\\1/p" "$TMP/json"; } # of the last member of this name
final() { sed 's/.*"final": {//' "$TMP/json" | sed -n "s/.*\"$1\": \\([-0-9.e+]*\\).*/\\1/p"; }
near() { close_to "$@"; }
calc() { awk "BEGIN { printf \"%.17g\", $1 }"; }
most() { awk -v got="$1" -v most="$2" 'BEGIN { print got, most; exit !(got != "" && got <= most) }'; }
refuses() { # refuses STATUS WORDS MODEL ARGS...
  status=$1 words=$2 name=$3
  shift 3
  "$LAGC" run "$TMP/$name.lag" "$@" >"$TMP/log" 2>&1
  [ $? = "$status" ] && grep -q -e "$words" "$TMP/log" || { cat "$TMP/log"; return 1; }
}

# ---- a block: it stops at v0^2/(2 mu g), by every method that can follow it; 2/(2*0.3*9.81)*2 = 0.67957866123003737
model slide <<'END_OF'
model slide
coord x [m]
param m = 1 [kg] > 0, mu = 0.3 [1], g = 9.81 [m/s^2] > 0
lagrangian = m/2*x'^2
force x = -mu*m*g*sign(x')
observe hold [N] = -mu*m*g*sign(x')
scene s { start x' = 2 [m/s]; span 10 [s] }
scene compared { like s; exact x = if(t < 2 [m/s]/(mu*g), x'(0)*t - mu*g*t^2/2, x'(0)^2/(2*mu*g)); output x, exact(x), error(x) every 1 [s] }
END_OF
for method in rk45 dop853 radau rk4 'rk4(step=0.1)' 'rk45(adapt=off,step=0.01)'; do
  check "a block stops, by $method" run slide --method "$method"
  check "at v0^2/(2 mu g)" near "$(final x)" "$(calc '4/(2*0.3*9.81)')" 1e-13
  check "and stays" near "$(final "x'")" 0 1e-14
  check "it sticks once" near "$(number slides)" 1 0
  check "for the rest of the time" near "$(number sliding_s)" "$(calc '10 - 2/(0.3*9.81)')" 1e-12
done
check "beside a closed form" run slide compared
check "which outputs show" near "$(final 'exact(x)')" "$(calc '4/(2*0.3*9.81)')" 1e-13
check "with the error" near "$(final 'error(x)')" 0 1e-13
run slide --method rk45
check "few steps" most "$(number steps)" 50
for method in verlet variational symplectic_euler ${GSL:+gsl-rk8pd gsl-bsimp}; do
  check "refused: $method" refuses 2 "method $method cannot follow a motion that sticks or slides where .sign(x'). jumps; rk45, dop853, radau and rk4 can" slide --method $method
done
check "check names the surface" sh -c "$LAGC check $TMP/slide.lag | grep -qx \"switching surface: .x'. = 0 (line 5), where a motion may stick\""

# ---- a saw crosses its surface where x/L is a whole number, and not 0: x = 1 + t passes 2, 4, ..., 10 within 10 s
printf '%s\n' 'model saw' 'coord x' 'state z' 'param L = 2 > 0' "lagrangian = x'^2/2" "flow z' = mod(x, L)" \
  "scene s { start x = 1, x' = 1; span 10 }" > "$TMP/saw.lag"
check "check names whole numbers" sh -c "$LAGC check $TMP/saw.lag | grep -qx 'switching surface: .x/L. = a whole number (line 6)'"
check "and so does a run" sh -c "$LAGC run $TMP/saw.lag | grep -qx 'surface x/L = a whole number: crossed 5 times'"

# ---- its work is a line of its own: -m v^2/2 here; -4 R x0 a period of Den Hartog's oscillator, x0 = 0.48483893978808 (models/coulomb_oscillator.facts)
run slide --method dop853
check "friction does the work" near "$(number dry_friction)" -2 1e-13
check "and the balance closes" near "$(number drift)" 0 1e-13
cp models/coulomb_oscillator.lag "$TMP/driven.lag"
run driven driven --until "$(calc '10*3.14159265358979324')" --tol 1e-12
check "ten driven swings" near "$(number dry_friction)" "$(calc '-10*4*0.48483893978808')" 1e-9
check "cost what the shaker gives" near "$(number work)" 0 1e-9

# ---- at rest on an edge: where the force on both sides leads away, several motions follow
model away <<'END_OF'
model away
coord x [m]
lagrangian = 1 [kg]/2*x'^2 - k/2*x^2
param k = 0 [N/m], F = 1 [N]
force x = F*sign(x')
scene s { span 2 [s] }
END_OF
check "two motions from one start: the run says so" refuses 3 "FAILED: at t = 0 s the motion meets x' = 0, where .sign(x'). in line 5 switches: it can leave the surface to either side" away
check "and goes on from beside it" run away "x'=0.5"
check "along the one" near "$(final x)" 3 1e-12
model valley <<'END_OF'
model valley
coord x [m]
param F = 1 [N], c = 0 [N*s/m]
lagrangian = 1 [kg]/2*x'^2 - F*abs(x)
force x = -c*x'
scene s { start x = 1 [m]; span 2 [s] }
END_OF
# a quarter period sqrt(2 m x/F)
check "a valley with an edge: crossed" run valley --until "$(calc '4*sqrt(2)')" --tol 1e-12
check "every half period" near "$(number crossings)" 2 0
check "and back after a whole one" near "$(final x)" 1 1e-10
check "with the energy kept" near "$(number drift)" 0 1e-12
check "by verlet, whose steps end at the edge" run valley --until "$(calc '4*sqrt(2)')" --method verlet --step 0.01
check "exactly, as the pieces are parabolas" near "$(final x)" 1 1e-10
check "at rest on the edge" refuses 3 "it rests on the surface, or leaves it to either side" valley x=0

# ---- two surfaces at once: blocks joined by a spring, both at rest. A force F on x moves none while F < 1, x alone while k x + 1 < F and k x < 0.7
model pair <<'END_OF'
model pair
coord x [m], y [m]
param F = 0.9 [N], k = 3 [N/m]
lagrangian = 1 [kg]/2*(x'^2 + y'^2) - k/2*(y - x)^2
force x = F - 1 [N]*sign(x')
force y = -0.7 [N]*sign(y')
observe hx [N] = -1 [N]*sign(x')
observe hy [N] = -0.7 [N]*sign(y')
scene s { span 5 [s]; output x, y, hx, hy every 1 [s] }
END_OF
for method in rk45 dop853 radau rk4; do
  [ $method = radau ] && tol=1e-6 || tol=1e-8 # errors of a tolerance of 1e-9
  check "both stick, by $method" run pair --method $method
  check "x" near "$(final x)" 0 1e-13
  check "held by what is needed" near "$(final hx)" -0.9 1e-12
  check "as nothing pulls at y" near "$(final hy)" 0 1e-12
  # x swings from 0 to 2 (F - 1)/k and stays there, as k x - F = -0.8 is less than 1; y is pulled by k x = 0.4
  check "x moves alone by $method" run pair --method $method F=1.2
  check "half a swing" near "$(final x)" "$(calc '2*0.2/3')" $tol
  check "and is held" near "$(final hx)" "$(calc '0.4 - 1.2')" $tol
  check "y is held, too" near "$(final hy)" -0.4 $tol
done

run pair F=0 k=0 "x'=2" "y'=1"
check "the work of both frictions is counted" near "$(number dry_friction)" -2.5 1e-12

# ---- a relay: x'' = -sign(x + x'), a slide along x + x' = 0 as exp(-t), from the point where the parabola meets the line
model relay <<'END_OF'
model relay
state x, y
flow x' = y
flow y' = -sign(x + y)
scene s { start x = 0.5, y = -0.5; span 3 }
END_OF
for method in rk45 dop853 radau rk4; do
  check "a relay by $method" run relay --method $method
  check "slides home as exp(-t)" near "$(final x)" "$(calc '0.5*exp(-3)')" 1e-8
  check "on the line" near "$(calc "$(final x) + $(final y)")" 0 1e-8
done

# ---- functions of time: a square wave and a sawtooth. x'' = sign(sin(pi t)): after n periods of 2 s at rest, 1 m a period on
model wave <<'END_OF'
model wave
coord x [m], y [m]
lagrangian = 1 [kg]/2*(x'^2 + y'^2)
force x = 1 [N]*sign(sin(pi*t/1 [s]))
force y = 1 [N]*(t/1 [s] - floor(t/1 [s]) - 1/2)
scene s { span 10 [s] }
END_OF
for method in rk45 dop853 radau 'rk4(step=0.3)' 'verlet(step=0.3)'; do
  check "a square wave by $method" run wave --method "$method" --tol 1e-10
  check "is integrated piece by piece" near "$(final x)" 5 1e-9
  check "and ends at rest" near "$(final "x'")" 0 1e-9
  # a saw tooth of mean 0: each second adds -1/12 m, from a velocity that is 0 at whole seconds
  case $method in verlet*) ;; *) check "a sawtooth, too" near "$(final y)" "$(calc '-10/12')" 1e-9 ;; esac
done

# a wave of 2/3 up and 1/3 down, by steps of whole periods, which see the same value at each end and in the middle
model uneven <<'END_OF'
model uneven
coord x [m]
lagrangian = 1 [kg]/2*x'^2
force x = 1 [N]*sign(1/2 + sin(2*pi*t/1 [s]))
scene s { span 4 [s] }
END_OF
for method in 'rk4(step=1)' rk45; do
  check "steps of whole periods by $method" run uneven --method "$method"
  check "miss no crossing" near "$(final "x'")" "$(calc 4/3)" 1e-9
done

# ---- bilinear springs: half periods pi/w1 and pi/w2
model bilinear <<'END_OF'
model bilinear
coord x [m]
lagrangian = 1 [kg]/2*x'^2 - if(x > 0, 1 [N/m], 9 [N/m])/2*x^2
scene s { start x = 1 [m]; span 20 [s] }
END_OF
for method in rk45 dop853 radau rk4; do
  check "a spring of two stiffnesses by $method" run bilinear --until "$(calc '3*(3.14159265358979324 + 3.14159265358979324/3)')" --tol 1e-11 --method $method
  check "comes back" near "$(final x)" 1 1e-8
done
check "with its corner crossed" near "$(number crossings)" 6 0
# the period is the same for all amplitudes and phases, so that after one period each neighbouring motion is where it was
tangent() { sed -n 's/.*"tangent": {\([^}]*}[^}]*\)}.*/\1/p' "$TMP/json" | grep -o ': -\{0,1\}[0-9][-0-9.e+]*' | awk '{ d = $2 - (NR == 1 || NR == 4); print $2; bad = bad || d > 1e-8 || d < -1e-8 } END { exit bad || NR != 4 }'; }
check "its tangent goes over the corners" run bilinear --until "$(calc '3.14159265358979324 + 3.14159265358979324/3')" --tol 1e-11 --tangent
check "to the identity after a period" tangent
model large <<'END_OF'
model large
const n = 70
coord x[n] [m]
lagrangian = sum(i in 1..n, 1 [kg]/2*x[i]'^2) - sum(i in 1..n-1, 1 [N/m]/2*(x[i+1] - x[i])^2)
for i in 1..n { friction rub[i] on x[i]: 1 [N] }
scene s { start x[1]' = 2 [m/s]; span 0.5 [s]; output rub[70] every 0.1 [s] }
END_OF
check "a model of 70 bodies that stick" run large

# ---- stiff but smooth: tanh(v/vs). While |v| >> vs it is Coulomb's friction; on a slope the block then creeps at vs*atanh(tan a/mu)
model smooth <<'END_OF'
model smooth
coord s [m]
param m = 1 [kg] > 0, g = 10 [m/s^2] > 0, mu = 0.5, a = 0.2 [rad], vs = 1e-3 [m/s]
lagrangian = m/2*s'^2 - m*g*s*sin(a)
force s = -mu*m*g*cos(a)*tanh(s'/vs)
scene x { start s' = 1 [m/s]; span 10 [s] }
END_OF
for vs in 1e-3 1e-6 1e-9; do
  check "tanh(v/$vs) by radau" run smooth vs=$vs --method radau
  check "creeps at the speed of its balance, r = tan a/mu" near "$(final "s'")" "$(awk "BEGIN { r = sin(0.2)/cos(0.2)/0.5; printf \"%.12g\", -$vs*log((1 + r)/(1 - r))/2 }")" 1e-10
  check "in few steps" most "$(number steps)" 400
done

# ---- a start at rest, held on a curved path under a load that grows: velocities have the size of what friction holds, and no step is as short as rounding
model curve <<'END_OF'
model curve
coord a [rad]
param I = 1 [kg*m^2] > 0
let x = 1 [m]*a^2
kinetic = I/2*a'^2
force a = 1.8 [N*m] + 1 [N*m/s]*t
friction rub on x: 0.8 [N], static = 1.2 [N]
scene s { start a = 0.9; span 1 [s]; output a every 0.5 [s] }
END_OF
check "a body held on a curve" run curve s
check "in a few steps" most "$(number steps)" 100
check "breaks loose where 1.8 + t = 1.2 dx/da" near "$(number sliding_s)" 0.36 1e-12

# ---- an output is the held force, also where its text has a short form of its own, as that of acos'
model acos <<'END_OF'
model acos
coord a [rad]
param I = 1 [kg*m^2] > 0
let x = 1 [m]*acos(a/2)
kinetic = I/2*a'^2
force a = 0.3 [N*m]
friction rub on x: 2 [N]
scene s { start a = 0.9, a' = 1 [rad/s]; span 2 [s]; output a, rub every 1 [s] }
END_OF
check "a body held on x = acos(a/2)" run acos s
check "by the force that balances 0.3 = rub/sqrt(4 - a^2)" near "$(final rub)" "$(awk -v a="$(final a)" "BEGIN { printf \"%.17g\", 0.3*sqrt(4 - a*a) }")" 1e-14

# ---- on a support that an input moves: as on the same formula
for u in 'input u [m] = 0.1 [m]*sin(3 [1/s]*t)' 'let u = 0.1 [m]*sin(3 [1/s]*t)'; do
  printf "model shaken\ncoord x [m]\n%s\nlet s = x - u\nkinetic = 1 [kg]/2*x'^2\nfriction rub on s: 0.5 [N]\nscene go { span 4 [s]; output x }\n" "$u" >"$TMP/shaken.lag"
  check "a block on ${u%% *} u" run shaken go
  [ "${u%% *}" = input ] && by_input=$(final x)
done
check "moves alike" near "$by_input" "$(final x)" 1e-15
check "and sticks" most 1 "$(number slides)"

# ---- sticking that ends by itself: the shaken oscillator at rest 19 times, and the belt's period (digits: the facts of these models), by every method
cp models/stick_slip.lag models/coulomb_oscillator.lag "$TMP"
for method in rk45 dop853 radau rk4; do
  case $method in rk45) tol=1e-7 ;; radau) tol=1e-6 ;; rk4) tol=1e-5 ;; *) tol=1e-8 ;; esac # of radau its error at 1e-9; of rk4 that of Hermite's path beside a tangent surface
  check "a shaken mass by $method" run coulomb_oscillator stick_slip --method $method
  check "is where it should be" near "$(final x)" -0.1474563757205878 $tol
  check "after 19 rests" near "$(number slides)" 19 0
  check "of together 4.518 s" near "$(number sliding_s)" 4.518110764755514 $tol
  check "a belt by $method" run stick_slip --method $method --measure 'T=hit(lets_go, 5) - hit(lets_go)'
  check "has its period" near "$(number T)" "$(calc '4*8.42029357870480441')" $tol
done
run stick_slip --method radau
check "radau has the Jacobian of the slide" most "$(number rhs_calls)" 3400

# ---- a friction that differs by direction, as an if: held by any force between -2 and 1
model ratchet <<'END_OF'
model ratchet
coord x [m]
param F = 0.5 [N]
lagrangian = 1 [kg]/2*x'^2
force x = -F + if(x' > 0, -2 [N], 1 [N])
observe hold [N] = if(x' > 0, -2 [N], 1 [N])
scene s { start x' = 1 [m/s]; span 4 [s]; output x, hold every 1 [s] }
END_OF
for method in rk45 radau; do
  check "a ratchet by $method" run ratchet --method $method
  check "stops at v^2/(2 (2 + F))" near "$(final x)" 0.2 1e-12
  check "and is held by F" near "$(final hold)" 0.5 1e-12
  check "it slips back where F is more than 1 N" run ratchet --method $method F=1.5
  check "from its far end, at 0.5 m/s^2" near "$(final x)" "$(calc '1/7 - 0.25*(4 - 1/3.5)^2')" 1e-9
  check "and never where F is 1 N less a little" run ratchet --method $method F=0.999999
  check "at rest" near "$(final "x'")" 0 1e-14
done
model condition <<'END_OF'
model condition
coord x [m]
lagrangian = 1 [kg]/2*x'^2
force x = if(x' > 0 and x < 10 [m], -2 [N], 1 [N])
scene s { start x' = 1 [m/s]; span 4 [s] }
END_OF
check "of two conditions at once no mean is taken" refuses 3 "at t = 0.5[0-9]* s the motion meets x' = 0, .* the force is no sum of the switch and a rest" condition

# ---- static friction above that of motion. On the belt: carried to k x = mu_s N; then with A = (mu_s - mu) N/k, B = v/w an oscillation about mu N/k, until x' is v
# again, 2 (pi - atan(A/B)) later and 2 A back: here A = 0.15, B = 0.1
model static <<'END_OF'
model static
const n = 1
coord x[n] [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0, N = 1 [N] > 0, v = 0.1 [m/s], mu_s = 0.4, mu = 0.25
kinetic = sum(i in 1..n, m/2*x[i]'^2)
potential = sum(i in 1..n, k/2*x[i]^2)
let slip[i in 1..n] = x[i] - v*t
for i in 1..n { friction rub[i] on slip[i]: mu*N, static = mu_s*N }
expect m*x[1]'' = rub[1] - k*x[1]
scene s { start x' = 0.1 [m/s]; span 60 [s]; output x, rub[1] every 0.1 [s] }
END_OF
check "its expectation is proved" "$LAGC" check "$TMP/static.lag"
slip=$(awk 'BEGIN { printf "%.17g", 2*(3.14159265358979324 - atan2(0.15, 0.1)) }')
for method in rk45 dop853 radau rk4; do
  case $method in radau | rk4) tol=1e-6 ;; *) tol=1e-7 ;; esac
  check "a belt with static friction by $method" run static --method $method
  check "is where it should be" near "$(final 'x\[1\]')" "$(calc "0.1 + 0.1*(60 - 4 - 7*($slip + 3) - $slip)")" $tol
  check "and sticks as long" near "$(number sliding_s)" "$(calc "60 - 8*$slip")" $tol
done
run static --until 3.9
check "held by more than mu N" near "$(final 'rub\[1\]')" 0.39 1e-12
check "a static limit below mu N" refuses 2 "the static limit minus the friction of a sliding body has a value of -0.15" static mu_s=0.1
sed 's/rub\[i\] on slip\[i\]: mu\*N/rub[i] on slip[i]: mu*N*(1 + exp(-x[i]^2*1 [1\/m^2]))/' "$TMP/static.lag" >"$TMP/place.lag" # 0.5 N where x = 0
check "one that is below it at a place, by events" refuses 3 "its static limit is smaller than the friction of a sliding body" place
check "and by steps" refuses 3 "a static limit smaller than the friction of a sliding body" place --method 'moreau(step=0.01)'
check "one that is mu N" run static mu_s=0.25

# ---- saved in the middle of a slide, and resumed: the same bits
split() {
  "$LAGC" run "$TMP/coulomb_oscillator.lag" stick_slip --until 3.6262 --save-state "$TMP/s.state" --quiet &&
    "$LAGC" run "$TMP/coulomb_oscillator.lag" stick_slip --resume "$TMP/s.state" --until 20 --json >"$TMP/b.json" &&
    "$LAGC" run "$TMP/coulomb_oscillator.lag" stick_slip --until 20 --json >"$TMP/a.json"
}
check "a run that is split while it sticks" split

same() { [ "$(sed 's/.*"final"//' "$TMP/a.json")" = "$(sed 's/.*"final"//' "$TMP/b.json")" ] || { cat "$TMP/a.json" "$TMP/b.json"; return 1; }; }
check "is the same run" same

# ---- events act on switches: a block that is struck while it sticks, and one that bounces
model struck <<'END_OF'
model struck
coord x [m]
param R = 1 [N]
lagrangian = 1 [kg]/2*x'^2
force x = -R*sign(x')
event blow: t - 3 [s] rising { x' = 2 [m/s] }
scene s { span 10 [s] }
END_OF
check "a blow sets it free" run struck
check "and it stops again after v^2/(2 R)" near "$(final x)" 2 1e-12
check "having stuck twice" near "$(number slides)" 2 0
blown() { "$LAGC" run "$TMP/struck.lag" --tangent --json | grep -q "\"tangent\": {\"x\": {\"x\": 1, \"x'\": 0}, \"x'\": {\"x\": 0, \"x'\": 0}}"; }
check "its place follows from the start, its velocities do not" blown
sed "s/x' = 2 .m.s./x = x + 1 [m]/" "$TMP/struck.lag" >"$TMP/shifted.lag"
check "no tangent over an event under which it goes on sticking" refuses 3 "an event changes the state where the motion meets a surface or slides" shifted --tangent
stops() { "$LAGC" run "$TMP/slide.lag" --tangent --json | grep -q "\"tangent\": {\"x\": {\"x\": 1, \"x'\": 0.6795786[0-9]*}, \"x'\": {\"x\": 0, \"x'\": 0}}"; }
check "where it stops, v^2/(2 mu g), has one: v/(mu g), with x = v^2/(2 mu g) = x/(v/2)" stops

# Sizes that parameters determine, from the command line, in sweeps, in headers: a negative friction would drive the motion, v = 3 + 0.1 g t.
cat >"$TMP/sizes.lag" <<'END'
model sizes
coord x [m], th [rad]
param m = 2 [kg] > 0, g = 9.81 [m/s^2] > 0, mu = 0.3, mu_s = 0.4, J = 1 [kg*m^2]
kinetic = m*x'^2/2 + J*th'^2/2
friction f on x: mu*m*g, static = mu_s*m*g
scene s { start x' = 3 [m/s]; span 3; output x, x' every 0.5 }
END
check "a negative friction" says 2 "this friction has a size of -1.962, which must be at least 0: it is m*g*mu" "$LAGC" run "$TMP/sizes.lag" mu=-0.1
check "no inertia" says 2 'the coordinate th has an inertia of 0, which must be more than 0: it is J' "$LAGC" run "$TMP/sizes.lag" J=0
# Sizes that change along a run: mu N with N = 20 - 15 t, negative from 4/3 s on; a curve that is positive up to x' = 1/sqrt(2).
printf '%s\n' 'model push' 'coord x' 'param mu = 0.3 >= 0, b = 2' 'input N = 20' "kinetic = x'^2" 'friction f on x: mu*N' 'scene s { start x'"'"' = 9; N = 20 - 15*t; span 3 }' 'scene still { start x'"'"' = 9; N = 20; span 1 }' >"$TMP/push.lag"
check "a normal force that becomes negative" says 3 "this friction has a size of -" "$LAGC" run "$TMP/push.lag" s --json
is "when: up to a step" 1 "$("$LAGC" run "$TMP/push.lag" s --json 2>/dev/null | sed -n 's/.*"t_end": \([0-9.]*\),.*/\1/p' | awk '{ print ($1 > 1 && $1 <= 4/3) }')"
check "one that does not" "$LAGC" run "$TMP/push.lag" still --quiet
sed 's/mu\*N$/mu*(1 - b*x'"'"'^2)/; /^input/d; s/ N = [^;]*;//; s/= 9/= 0.5/; s/, b = 2/, b = 2, F = 3/' "$TMP/push.lag" >"$TMP/curve.lag"
echo 'force x = F' >>"$TMP/curve.lag"
check "a curve that becomes negative" says 3 "which must be at least 0: it is mu" "$LAGC" run "$TMP/curve.lag" s --json
check "or begins so" says 2 "this friction has a size of -" "$LAGC" run "$TMP/curve.lag" s "x'=2"
printf '%s\n' 'model rest' 'coord x' "kinetic = x'^2" 'friction f on x: x, static = 2' 'scene s { start x = -1; span 1 }' >"$TMP/rest.lag"
check "or at rest, where its own static size holds" says 2 "this friction has a size of -1, which" "$LAGC" run "$TMP/rest.lag"
# A step's trial end beyond a corner of the size, or beyond an event that raises it, is no state of the run.
printf '%s\n' 'model corner' 'coord x' "lagrangian = x'^2/2 - x^2/2" 'friction rub on x: max(0, cos(t)/10)' 'scene s { start x = 2; span 10 }' >"$TMP/corner.lag"
printf '%s\n' 'model refill' 'coord x' 'state z' "lagrangian = x'^2/2 - x^2/2" "flow z' = -1" 'event refill: z - 0.1 falling { z = 3 }' 'friction rub on x: z/10' 'scene s { start x = 2, z = 3; span 10 }' >"$TMP/refill.lag"
check "a size with a corner at 0" "$LAGC" run "$TMP/corner.lag" --quiet
check "a size that an event raises in time" "$LAGC" run "$TMP/refill.lag" --quiet
check "a friction of 0" "$LAGC" run "$TMP/sizes.lag" mu=0 --quiet
"$LAGC" sweep "$TMP/sizes.lag" mu=-0.1..0.3:3 -o "$TMP/sizes.csv" --quiet
is "rows of a sweep" "value ok ok" "$(awk -F , 'NR > 1 { printf "%s%s", s, $NF; s = " " }' "$TMP/sizes.csv")"
start() {
  "$LAGC" header "$TMP/sizes.lag" -o "$TMP/sizes.h" && cat >"$TMP/start.c" <<'END' && "$CC" -std=c99 -Wall -Wextra -Werror -I"$TMP" "$TMP/start.c" -o "$TMP/start" -lm && "$TMP/start"
#define SIZES_IMPLEMENTATION
#include "sizes.h"
int main(void) {
  sizes_params p;
  sizes_state s;
  sizes_defaults(&p);
  if (sizes_start(&p, &s) != SIZES_OK || s.v[0] != 3) return 1;
  p.mu = -0.1;
  if (sizes_start(&p, &s) != SIZES_ESIZE) return 2;
  p.mu = 0.1, p.J = 0;
  if (sizes_start(&p, &s) != SIZES_ESIZE) return 3;
  p.J = 1, p.mu_s = 0.05;
  if (sizes_start(&p, &s) != SIZES_ESIZE) return 5;
  p.mu_s = 0.4, p.g = 0;
  return sizes_start(&p, &s) == SIZES_ESIZE ? 0 : 4;
}
END
}
check "_start of a header" start

# ---- slip maps that vary: x' = g(a) a', where g may vanish
# A ring on x = cos a: J v0^2/2 = Fr (cos 1 - cos a) at the stop, as friction of a path and as a force. Tolerance: 100 of the run's.
model path <<'END_OF'
model path
coord a
let x = cos(a)
kinetic = a'^2/2
friction ring on x: 1
scene s { start a = 1, a' = 1; span 5; tolerance 1e-9 }
END_OF
sed 's/^friction.*/force a = sin(a)*sign(x'"'"')/' "$TMP/path.lag" >"$TMP/force.lag"
for v in 0.2 0.8 1.1; do
  for m in path force; do
    check "$m: a stop from $v" run $m "a'=$v"
    check "where the work is the energy" near "$(final a)" "$(awk -v v=$v 'BEGIN { c = cos(1) - v*v/2; printf "%.17g", atan2(sqrt(1 - c*c), c) }')" 1e-7
    check "and stays" near "$(final "a'")" 0 1e-14
  done
done
check "by time steps" run path --method moreau --step 1e-3
check "to the step's error" near "$(final a)" 1.5304831026006622 1e-3
# Static friction on a path whose slope, cos 2a, changes its sign: it holds 0.3 by 0.3/|cos 1.8|.
model slope <<'END_OF'
model slope
coord a
let x = sin(a)*cos(a)
kinetic = a'^2/2
force a = 0.3
friction rub on x: 0.8, static = 2.5
scene s { start a = 0.9; span 1; output a, rub every 0.5 }
END_OF
check "static friction on a path that turns" run slope -o "$TMP/slope.csv"
check "holds" near "$(final a)" 0.9 1e-14
check "by the load over the slope" near "$(tail -n 1 "$TMP/slope.csv" | cut -d, -f 3)" "$(calc '-0.3/cos(1.8)')" 1e-12
for path in 'sin(3*a)' 'asin(a)' 'sqrt(4 - a^2)' 'hypot(cos(a), 0.5*sin(a))'; do
  sed "s|^let x = .*|let x = $path|; /^force/d; s|^friction.*|friction rub on x: 2|; s|a = 0.9|a = 0.3, a' = 1|; s|span 1|span 3|" "$TMP/slope.lag" >"$TMP/turn.lag"
  check "a stop on $path" run turn
  check "for good" near "$(final "a'")" 0 1e-14
done
# A piston: one coordinate, through asin and its roots, and three with two constraints. Both stop in the third turn.
model crank <<'END_OF'
model crank
coord a
let b = asin(0.4*sin(a))
let x = 0.1*cos(a) + 0.25*cos(b)
kinetic = 0.005*a'^2 + 0.75*x'^2 + 1e-3*b'^2
friction ring on x: 1
scene s { start a = 1, a' = 8; span 5; tolerance 1e-9 }
END_OF
sed -e 's/^coord a/coord a, b, x/; s/^let b = .*/constraint pin: 0.25*sin(b) = 0.1*sin(a)/; s/^let x = \(.*\)/constraint guide: x = \1/' "$TMP/crank.lag" >"$TMP/bars.lag"
check "a piston in one coordinate" run crank
stop=$(final a)
check "it rests" near "$(final "a'")" 0 1e-14
check "in three" run bars
check "they stop at one place" near "$(final a)" "$stop" 1e-7

# ---- two frictions hold one motion: 2 N in all on 1.25 kg, until 2.8125 m; from 5 s on a pull that grows by 1 N/s tears both loose
model shared <<'END_OF'
model shared
coord a [m], c [m]
param m = 1 [kg] > 0, F = 1 [N] > 0, G = 2 [N] > 0
kinetic = m/2*(a'^2 + c'^2)
constraint rod: a = 2*c
force a = -F*sign(a') + 1 [N/s]*max(t - 3 [s], 0 [s])
force c = -G*sign(c')
scene go { start a' = 3 [m/s], c' = 1.5 [m/s]; span 8 [s]; output a }
END_OF
for method in dop853 radau; do
  check "two frictions of one motion by $method" run shared --method $method
  check "stop it, hold it, and let it go" near "$(final a)" "$(calc '2.8125 + 3^3/6/1.25')" 1e-9 # the tolerance
done
tap_end
