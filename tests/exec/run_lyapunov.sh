#!/bin/sh
# lagc lyapunov: exponents of linear models against closed forms, of Lorenz's against the published 0.9056, 0, -14.5723 (J.C. Sprott,
# Chaos and Time-Series Analysis (2003), table 4.3), pairs of Hamiltonian ones, the sum against the divergence; rows, JSON, refusals.
. tests/tap.sh

# find MODEL ARGS...: the JSON object; list KEY K; number KEY
find_them() {
  title="$*"
  "$LAGC" lyapunov "$@" --json >"$TMP/json" 2>"$TMP/err" || cat "$TMP/err" >&2
}
list() { sed -n "s/.*\"$1\": \[\([^]]*\)\].*/\1/p" "$TMP/json" | cut -d, -f"$2"; }
number() { sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p" "$TMP/json"; }
close() { # NAME EXPRESSION GOT TOLERANCE
  check "$title: $1" awk -v got="$3" -v tolerance="$4" "
    BEGIN { want = $2; d = got - want
      if (got != \"\" && d <= tolerance && -d <= tolerance) exit 0
      printf \"%.17g, not %.17g within %g\\n\", got, want, tolerance; exit 1 }"
}

# ---- linear: the real parts of eigenvalues. Embedded methods keep their steps so short that Y is right to some 1e-8.
cat >"$TMP/saddle.lag" <<'X'
model saddle "Uphill on both sides"
coord x
lagrangian = x'^2/2 + 2*x^2
X
find_them "$TMP/saddle.lag" --transient 10 --until 40 # directions of vectors are right to exp(-40); x rests at 0
close "it grows as exp(2t)" 2 "$(list exponents 1)" 1e-7
close "and decays as exp(-2t)" -2 "$(list exponents 2)" 1e-7
cat >"$TMP/stairs.lag" <<'X'
model stairs "A triangular flow: its diagonal"
state a, b, c
flow a' = -a + 3*b - c
flow b' = -4*b + c
flow c' = 0.5*c
scene s { start a = 1, b = 2, c = 0
  span 10
  method dop853 }
X
find_them "$TMP/stairs.lag" # other directions have decayed by exp(-1.5 20) after 20 s
close "first" 0.5 "$(list exponents 1)" 1e-9
close "second" -1 "$(list exponents 2)" 1e-9
close "third" -4 "$(list exponents 3)" 1e-9
close "sum" -4.5 "$(number sum)" 1e-9
close "divergence" -4.5 "$(number divergence)" 1e-12

find_them models/damped_oscillator.lag over # -w (z -+ sqrt(z^2 - 1)) with w = 2, z = 3
close "slow" "-2*(3 - sqrt(8))" "$(list exponents 1)" 1e-7
close "fast" "-2*(3 + sqrt(8))" "$(list exponents 2)" 1e-7
close "sum" -12 "$(number sum)" 1e-7
find_them models/damped_oscillator.lag over --method radau # its steps could be too long to follow the fast decay
close "slow" "-2*(3 - sqrt(8))" "$(list exponents 1)" 1e-7
close "fast" "-2*(3 + sqrt(8))" "$(list exponents 2)" 1e-7
find_them models/damped_oscillator.lag under # both c/(2m) = 0.2, up to the swing of the ellipse, at most log(w), over 360 s
close "one" -0.2 "$(list exponents 1)" 0.004
close "other" -0.2 "$(list exponents 2)" 0.004
close "sum" -0.4 "$(number sum)" 1e-6
find_them models/spring.lag free
close "nothing grows" 0 "$(list exponents 1)" 0.004
close "nothing decays" 0 "$(list exponents 2)" 0.004
find_them models/spring.lag free --until 4000 # ten times as near
close "nothing grows" 0 "$(list exponents 1)" 0.0004

# ---- chaos
within() { awk -v x="$1" -v want="$2" -v s="$3" 'BEGIN { d = x - want; if (d < 0) d = -d; if (d > 4*s || s <= 0 || s > 0.02) { print x, "+-", s, "not", want; exit 1 } }'; }
find_them models/lorenz.lag --until 2000 --tol 1e-9
check "Lorenz: the first" within "$(list exponents 1)" 0.9056 "$(list spread 1)"
check "Lorenz: the second" within "$(list exponents 2)" 0 "$(list spread 2)"
check "Lorenz: the third" within "$(list exponents 3)" -14.5723 "$(list spread 3)"
close "the sum is -(sigma + 1 + beta)" "-(10 + 1 + 8/3)" "$(number sum)" 1e-9
close "the dimension" 2.062 "$(number dimension)" 0.002
if [ -n "${SLOW:-}" ]; then
  # Roessler's flow with a = b = 0.2, c = 5.7, and the simplest one, x''' = -A x'' + x'^2 - x with A = 2.017 (J.C. Sprott, ibid.; Phys. Lett. A 228 (1997) 271)
  cat >"$TMP/roessler.lag" <<'END'
model roessler
state x, y, z
flow x' = -y - z
flow y' = x + 0.2*y
flow z' = 0.2 + z*(x - 5.7)
scene s { start x = 1, y = 1; span 500; tolerance 1e-9 }
END
  cat >"$TMP/simplest.lag" <<'END'
model simplest
state x, v, a
flow x' = v
flow v' = a
flow a' = -2.017*a + v^2 - x
scene s { start x = 0, v = 0, a = 1; span 500; tolerance 1e-9 }
END
  for flow in "roessler 0.0714 -5.3943" "simplest 0.0551 -2.0721"; do
    # shellcheck disable=SC2086 # words
    set -- $flow
    find_them "$TMP/$1.lag" --until 10000
    check "$1: the first" within "$(list exponents 1)" "$2" "$(list spread 1)"
    check "$1: the second" within "$(list exponents 2)" 0 "$(list spread 2)"
    check "$1: the third" within "$(list exponents 3)" "$3" "$(list spread 3)"
  done
  find_them models/lorenz.lag --until 2000 --tol 1e-9
fi
first=$(list exponents 1)
find_them models/lorenz.lag --until 2000 --tol 1e-9 --exponents 1
is "the first alone is the same" "$first" "$(list exponents 1)"
check "and no sum" grep -q '"sum": null' "$TMP/json"

pairs() { # METHOD TOLERANCE
  find_them models/henon_heiles.lag chaos --until 3000 --method "$1"
  close "first and last" "-($(list exponents 1))" "$(list exponents 4)" "$2"
  close "second and third" "-($(list exponents 2))" "$(list exponents 3)" "$2"
  close "sum" 0 "$(number sum)" "$2"
  check "$title: chaos" awk -v x="$(list exponents 1)" 'BEGIN { exit !(x > 0.02 && x < 0.08) }'
}
pairs 'verlet8(step=0.1)' 1e-8 # the vectors' first directions leave a number of order 1 in logarithms, over the time
slow pairs 'gauss(stages=3, step=0.1)' 1e-8
pairs dop853 1e-8
slow pairs taylor 1e-8

# ---- events that change the state. Flights under g = 1 that begin with velocity v take 2v and end with -v; the next begins with f(v). So one exponent is
# 0, along the motion, and the other the mean of log |f'| over the mean of 2v.
cat >"$TMP/floor.lag" <<'X'
model floor "Half of the velocity and 1: in the end v = 2. Of a floor that moves, u, the same: Galilei"
coord y
param u = 0
lagrangian = y'^2/2 - y
event bounce: y - u*t falling { y' = u - 0.5*(y' - u) + 1 }
scene rest { start y = 1; span 100 }
X
for u in 0 3; do
  find_them "$TMP/floor.lag" u=$u --until 4000 # the sum counts bounces: one more or less in 3600 s is 2e-4; vectors turn within each
  close "nothing grows" 0 "$(list exponents 1)" 1e-3
  close "velocities after a bounce halve their difference, log(1/2)/4" "log(0.5)/4" "$(list exponents 2)" 1e-3
  close "the sum" "log(0.5)/4" "$(number sum)" 4e-4
  close "is the divergence, with that of bounces" "$(number sum)" "$(number divergence)" 1e-6
done
# On a table that vibrates, s(t), impacts of restitution e repeat every T = 2 v/g with the table's velocity u = v (1 - e)/(1 + e). From
# s(t) + v tau - g tau^2/2 = s(t + tau) and v+ = -e (v - g tau) + (1 + e) s'(t + tau) small changes of t and v become M times them, with
# M = [1, (1 + e)/g; (1 + e) a, e^2 + (1 + e)^2 a/g] and a = s'': det M = e^2. Here g = T = 1, e = 1/2, a = -1/20.
cat >"$TMP/table.lag" <<'X'
model table
const w = 2*pi
coord y
lagrangian = y'^2/2 - y
event bounce: y - (sin(w*t)/(6*w) + 0.05*cos(w*t)/w^2) falling { y' = -0.5*y' + 1.5*(cos(w*t)/6 - 0.05*sin(w*t)/w) }
scene steady { start y = 0.01, y' = 0.5; span 100 }
X
find_them "$TMP/table.lag" --until 2000
close "the slow one" "log((1.1375 + sqrt(1.1375^2 - 1))/2)" "$(list exponents 1)" 1e-3
close "the fast one" "log((1.1375 - sqrt(1.1375^2 - 1))/2)" "$(list exponents 2)" 1e-3
cat >"$TMP/tripling.lag" <<'X'
model tripling "v = 1 + x becomes 1 + 3x modulo 1: chaos, with x uniform between 0 and 1"
coord y
lagrangian = y'^2/2 - y
event bounce: y falling { y' = 1 + 3*(-y' - 1) - if(-y' - 1 < 1/3, 0, if(-y' - 1 < 2/3, 1, 2)) }
scene chaos { start y = 0.1, y' = 1.2345; span 100 }
X
find_them "$TMP/tripling.lag" --until 3000 # log(3) a flight of 3 s in the mean; over 900 flights, correlated as 3^-k, the mean is known to 0.9 %
close "chaos" "log(3)/3" "$(list exponents 1)" 0.01
close "along the motion" 0 "$(list exponents 2)" 1e-3
cat >"$TMP/rough.lag" <<'X'
model rough "Friction in proportion to the cube of the velocity: the trace of Df jumps where the velocity does"
coord y
lagrangian = y'^2/2 - y
force y = -0.01*y'^3
event bounce: y falling { y' = -0.5*y' + 2 }
scene rest { start y = 1; span 100 }
X
find_them "$TMP/rough.lag" --until 200 --method 'rk4(step=0.01)' # the trapezoidal rule over steps: 0.01^2/12 of the second derivative of 0.03 v^2
close "the sum is the divergence" "$(number divergence)" "$(number sum)" 1e-5

# ---- constraints: vectors lie in their tangent space, whose dimension is the number of exponents
cat >"$TMP/rods.lag" <<'X'
model rods "A double pendulum in x and y, upside down at rest: rates sqrt(g (2 +- sqrt(2))), from det(K - s^2 M) = 0 in angles"
coord x1, y1, x2, y2
param g = 9.81
lagrangian = (x1'^2 + y1'^2 + x2'^2 + y2'^2)/2 - g*(y1 + y2)
constraint upper: x1^2 + y1^2 = 1
constraint lower: (x2 - x1)^2 + (y2 - y1)^2 = 1
scene up { start x1 = 0, y1 = 1, x2 = 0, y2 = 2; span 20; tolerance 1e-10 }
scene chaos { start x1 = sin(2), y1 = -cos(2), x2 = sin(2) + sin(2.5), y2 = -cos(2) - cos(2.5); span 20; tolerance 1e-10 }
X
for method in dop853 radau; do # of radau longer steps are allowed; others vectors have decayed by exp(-3.4 15)
  find_them "$TMP/rods.lag" up --transient 15 --until 30 --method $method
  close "first" "sqrt(9.81*(2 + sqrt(2)))" "$(list exponents 1)" 1e-7
  close "second" "sqrt(9.81*(2 - sqrt(2)))" "$(list exponents 2)" 1e-7
  close "third" "-sqrt(9.81*(2 - sqrt(2)))" "$(list exponents 3)" 1e-7
  close "fourth" "-sqrt(9.81*(2 + sqrt(2)))" "$(list exponents 4)" 1e-7
done
is "four, not eight" 4 "$(number phase_space)"
says_dimension() { "$LAGC" lyapunov "$TMP/rods.lag" up --until 20 | grep -q 'phase space: 4 dimensions, the 8 coordinates, velocities and states less 4 that constraints fix'; }
check "the report says so" says_dimension
as_angles() { # in the mean over 600 s, within the errors of both
  find_them "$TMP/rods.lag" chaos --until 600
  rods="$(list exponents 1) $(list errors 1)"
  find_them models/double_pendulum.lag chaos --until 600 --tol 1e-10 --method dop853
  check "a double pendulum by rods is as chaotic as by angles" awk -v a="$rods $(list exponents 1) $(list errors 1)" 'BEGIN { split(a, x); d = x[1] - x[3]; exit !(x[1] > 1 && d*d < 9*(x[2]^2 + x[4]^2)) }'
}
slow as_angles
cat >"$TMP/sleigh.lag" <<'X'
model sleigh "Chaplygin's sleigh, its blade behind the centre of mass: w' = -m a u w/(I + m a^2), u' = a w^2 (Neimark, Fufaev, Dynamics of Nonholonomic Systems, 1972)"
coord x, y, th
param m = 2, I = 3, a = 0.5
lagrangian = m/2*(x'^2 + y'^2) + I/2*th'^2
constraint blade: -x'*sin(th) + y'*cos(th) = a*th'
scene straight { start x = 0, y = 0, th = 0.3, x' = 0.7*cos(0.3), y' = 0.7*sin(0.3); span 20; tolerance 1e-10; method dop853 }
X
find_them "$TMP/sleigh.lag" --transient 100 --until 300 # vectors turn as 1/t
is "a constraint on velocities takes one dimension" 5 "$(number phase_space)"
close "turning decays" "-2*0.5*0.7/(3 + 2*0.25)" "$(list exponents 5)" 1e-3
close "as volumes do" "-2*0.5*0.7/(3 + 2*0.25)" "$(number sum)" 1e-3
close "by the divergence, too" "-2*0.5*0.7/(3 + 2*0.25)" "$(number divergence)" 1e-7
zeros() { awk -v a="$(list exponents 1-"$1")" -v e="$(list errors 1-"$1")" 'BEGIN { n = split(a, x, ","); split(e, d, ","); for (i = 1; i <= n; i++) if (x[i]^2 > 9*d[i]^2) { print x[i], d[i]; bad = 1 } exit bad || !n }'; }
check "the other four are 0" zeros 4
cat >"$TMP/damped.lag" <<'X'
model damped "A pendulum by a rod, damped, hanging at rest: both exponents -c/2, their sum -c"
coord x, y
param c = 0.3
lagrangian = (x'^2 + y'^2)/2 - 9.81*y
dissipation = c/2*(x'^2 + y'^2)
constraint rod: x^2 + y^2 = 1
scene s { start x = 0, y = -1; span 20; tolerance 1e-10; method dop853 }
X
find_them "$TMP/damped.lag" --until 200
close "damping" -0.15 "$(list exponents 1)" 0.02 # log(w)/180 of the ellipse
close "the sum" -0.3 "$(number sum)" 1e-7
find_them models/free_body.lag --until 100
is "a rotation has six dimensions" 6 "$(number phase_space)"
check "and a free body six zeros" zeros 6
find_them models/turntable.lag --until 200
check "a ball on a turntable, too" zeros 6
turned() { # an angle of thousands: differences are taken over 1 rad all the same
  find_them models/sphere.lag bowl --until 200
  check "a spherical pendulum has zeros only" zeros 8
}
slow turned
bicycle() { # J.P. Meijaard et al., Proc. R. Soc. A 463 (2007) 1955, table 2, v = 5 m/s
  find_them models/bicycle.lag straight --until 100 --method 'rk4(step=0.02)' # (14 0.02)^4/120 of the fastest
  close "castering" -14.0783896927 "$(list exponents 10)" 0.02 # one factor of e in 90 s
  close "weave" -0.7753413822 "$(list exponents 9)" 0.02
  close "weave" -0.7753413822 "$(list exponents 8)" 0.02
  close "capsize" -0.3228664290 "$(list exponents 7)" 0.02
}
slow bicycle

# ---- dry friction: a block on a belt sticks and slips; where it begins to stick neighbouring motions become one
cat >"$TMP/belt.lag" <<'X'
model belt
coord x
param v = 0.2, mu = 0.25, mu_s = 0.4
let slip = x - v*t
lagrangian = x'^2/2 - x^2/2
friction rub on slip: mu, static = mu_s
scene squeak { start x = 0.5; span 20 }
X
find_them "$TMP/belt.lag"
close "along the motion nothing grows" 0 "$(list exponents 1)" 1e-3
is "the other exponent is minus infinity" "null 1" "$(list exponents 2 | tr -d ' ') $(number minus_infinity)"
find_them "$TMP/belt.lag" "x'=0.2"
is "a start that sticks" "null 1" "$(list exponents 2 | tr -d ' ') $(number minus_infinity)"
is "of dimension 1: a closed path" 1 "$(number dimension)"
joined() { "$LAGC" lyapunov "$TMP/belt.lag" | grep -q 'minus infinity: where the motion begins to slide, or a body to stick, neighbouring motions become one'; }
check "the report says why" joined
cat >"$TMP/rubs.lag" <<'X'
model rubs "Steady swing by Den Hartog (1931), that crosses v = 0 without a stop"
coord x
param F = 3, w = 2, k = 10, R = 1
lagrangian = x'^2/2 - k*x^2/2
friction rub on x: R
force x = F*cos(w*t)
scene s { start x = 0.8, x' = 0.1; span 40; tolerance 1e-10 }
X
find_them "$TMP/rubs.lag" # S = diag(1, a+/a-): volumes change by the ratio of the accelerations beside the stop
close "the sum is the divergence, with that of crossings" "$(number divergence)" "$(number sum)" 1e-6
check "$title: it decays" awk -v s="$(number sum)" 'BEGIN { exit !(s < -0.1) }'

# ---- printed report
"$LAGC" lyapunov models/lorenz.lag --until 100 --tol 1e-9 -o "$TMP/rows.csv" --svg "$TMP/it.svg" >"$TMP/out"
check "a table" grep -q '^ *exponent \[1/s\] *error *at half the time$' "$TMP/out"
check "rows of running estimates" sh -c "head -1 '$TMP/rows.csv' | grep -q '^t \[s\],exponent 1 \[1/s\],exponent 2' && [ \$(wc -l <'$TMP/rows.csv') -gt 400 ]"
check "a picture" grep -q 'Lyapunov exponents so far' "$TMP/it.svg"
coarse() { "$LAGC" lyapunov models/damped_oscillator.lag over --method 'rk4(step=0.2)' | grep -q 'the sum should be the mean divergence of the flow, -12: the steps are too long'; }
check "steps that are too long are seen" coarse
# A ball that bounces once a period T of a plate, where that attracts: both multipliers have the size e, which takes 1/t to be seen
find_them tests/exec/orbits/plate.lag A=0.008 y=0.01583188557565483 "y'=-0.6137140555989241" --until 40
close "size" "log(0.5)/(2*3.14159265358979/40)" "$(list exponents 1)" 0.1
close "sum" "2*log(0.5)/(2*3.14159265358979/40)" "$(number sum)" 0.1

refused() { # STATUS TEXT ARGS...
  status=$1
  text=$2
  shift 2
  "$LAGC" lyapunov "$@" >"$TMP/out" 2>&1
  [ $? = "$status" ] && grep -q -e "$text" "$TMP/out" || { cat "$TMP/out"; return 1; }
}
if [ -n "${GSL:-}" ] || [ -e "${BUILD:-build}/liblag_gsl.a" ]; then
  check "a method without" refused 2 "method gsl-rk8pd has no derivative of its steps; dop853 has" models/lorenz.lag --method gsl-rk8pd
else
  skip "a method without" "GSL is not installed"
fi
cat >"$TMP/rubs.lag" <<'X'
model rubs
coord x, y
lagrangian = (x'^2 + y'^2)/2 - y
contact floor: y >= 0, restitution = 0, friction = 0.3, slip = x'
scene s { start y = 1, x' = 9; span 5 }
X
rests() { "$LAGC" lyapunov "$TMP/rubs.lag" --until 50 --json >"$TMP/json" && grep -q '"minus_infinity": 3' "$TMP/json"; }
check "a contact that rubs: once it sticks, motions differ by their place alone" rests
check "methods that vary the action, with constraints" refused 2 "method verlet has no derivative of its steps with constraints; dop853, rk45, rk4 and radau have" "$TMP/damped.lag" --method verlet
check "too many with constraints" refused 2 "from 1 to 2, the coordinates, velocities and states of the model that constraints leave free" "$TMP/damped.lag" --exponents 3
check "an event that accumulates" refused 3 "event floor repeats in ever shorter intervals" models/bouncing_ball.lag drop
check "an event that stops" refused 3 "an event stopped the run at t = 50.88" models/henon_heiles.lag free
check "too many" refused 2 "from 1 to 3" models/lorenz.lag --exponents 4
echo "model fixed; coord x; lagrangian = x'^2/2; constraint c: x = 1; scene s { start x = 1; span 1 }" >"$TMP/fixed.lag"
check "nothing moves" refused 2 "there are no neighbouring motions" "$TMP/fixed.lag"
check "no time left" refused 2 "between 0 and 10 s" models/lorenz.lag --until 10 --transient 10
check "backwards" refused 2 "write a later one" models/lorenz.lag --until -10
libm() { "$LAGC" lyapunov models/double_pendulum.lag --until 20 --json --math "$1" | sed -n 's/.*"exponents": \[\([^]]*\)\].*/\1/p'; }
check "--math libm: other last digits of a sine" sh -c "[ -n '$(libm libm)' ] && [ '$(libm libm)' != '$(libm own)' ]"
check "an option of run" refused 2 "is an option of .lagc run." models/lorenz.lag --section 'x rising'
tap_end
