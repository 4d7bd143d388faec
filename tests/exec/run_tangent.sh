#!/bin/sh
# lagc run --tangent: dx/dy(0) of emitted models against closed forms; methods that use different derivatives of the model
# against each other; columns, units, JSON; refusals. tests/unit/test_rt_tangent.c has the properties of methods.
. tests/tap.sh

# last MODEL ARGS...: the last row, by `entry K`; columns: by `column NAME`
last() {
  title="$*"
  "$LAGC" run "$@" --tangent --quiet -o "$TMP/rows.csv" && head -1 "$TMP/rows.csv" >"$TMP/head" && tail -1 "$TMP/rows.csv" >"$TMP/last"
}
column() { # NAME [UNIT]
  tr ',' '\n' <"$TMP/head" | grep -n -x -F -e "$1" -e "$1 [${2:-}]" | cut -d: -f1
}
entry() { cut -d, -f"$(column "$@")" "$TMP/last"; }
close() { # NAME EXPRESSION GOT TOLERANCE: relative, absolute below 1
  check "$title: $1" awk -v got="$3" -v tolerance="$4" "
    BEGIN { want = $2; d = got - want; size = want < 0 ? -want : want; if (size < 1) size = 1
      if (got != \"\" && d <= tolerance*size && -d <= tolerance*size) exit 0
      printf \"%.17g, not %.17g\\n\", got, want; exit 1 }"
}

# x = x0 cos wt + v0/w sin wt with w = 2
for method in rk45 dop853 taylor radau 'verlet8(step=0.01)' 'gauss(stages=4, step=0.05)' 'variational(order=8, step=0.05)' 'rk4(step=1e-3)'; do
  last models/spring.lag free --until 3.3 --method "$method"
  close "dx/dx" "cos(6.6)" "$(entry 'dx/dx(0)')" 1e-9 # the scene's tolerance is 1e-11
  close "dx/dx'" "sin(6.6)/2" "$(entry "dx/dx'(0)" 'm/(m/s)')" 1e-9
  close "dx'/dx" "-2*sin(6.6)" "$(entry "dx'/dx(0)" '(m/s)/m')" 1e-9
  close "dx'/dx'" "cos(6.6)" "$(entry "dx'/dx'(0)")" 1e-9
done

# Damped, underdamped: the determinant is exp(-c t/m) (Liouville), dx/dv = exp(-g t) sin(wt)/w
last models/damped_oscillator.lag under --until 5
close "dx/dx'" "exp(-0.2*5)*sin(sqrt(4 - 0.04)*5)/sqrt(4 - 0.04)" "$(entry "dx/dx'(0)" 'm/(m/s)')" 1e-10
det2() { awk -F, -v a="$(column "dx/dx(0)")" 'END { printf "%.17g", $a*$(a + 3) - $(a + 1)*$(a + 2) }' "$TMP/last"; }
close "determinant" "exp(-0.4*5)" "$(det2)" 1e-10

# Impacts of contacts. A ball bounces once a period T of a plate: with the plate's phase p, cos p = g T (1 - e)/(2 A w (1 + e)), the matrix of a period has the
# determinant e^2 and the trace 1 + e^2 + (1 + e)^2 A w^2 sin p/g, here 4.0634013962910063
last tests/exec/orbits/plate.lag y=0.006821195225698461 "y'=0.556222705653584" --until 0.15707963267948966 --every 0.15707963267948966 --tol 1e-13
close "determinant" 0.25 "$(awk -F, -v a="$(column "dy/dy(0)")" 'END { printf "%.17g", $a*$(a + 3) - $(a + 1)*$(a + 2) }' "$TMP/last")" 1e-11
close "trace" 4.0634013962910063 "$(awk -F, -v a="$(column "dy/dy(0)")" 'END { printf "%.17g", $a + $(a + 3) }' "$TMP/last")" 1e-11
# A superball grips: an impulse of -4/7 m (x' + r th') along the floor. The first bounce is at t1 = sqrt(2 h/g), and y' = 2 g t1 - g t behind it.
sed 's/output x, y, th.*/output x, y, th, x'"'"', y'"'"', th'"'"' every 1/; s/span 2.5/span 1/' models/superball.lag >"$TMP/superball.lag"
last "$TMP/superball.lag" thrown
close "spin by spin" "-3/7" "$(entry "dth'/dth'(0)")" 1e-10
close "speed by speed" "3/7" "$(entry "dx'/dx'(0)")" 1e-10
close "spin by speed" "-400/7" "$(entry "dth'/dx'(0)" '(rad/s)/(m/s)')" 1e-10
close "rise by height" "sqrt(2*9.81)" "$(entry "dy'/dy(0)" '(m/s)/m')" 1e-9 # the tolerance of the scene

# Lorenz: volumes shrink by exp(-(sigma + 1 + beta) t) along every motion.
last models/lorenz.lag --until 1
det3() {
  awk -F, -v a="$(column 'dx/dx(0)')" '{ printf "%.17g", $a*($(a+4)*$(a+8) - $(a+5)*$(a+7)) - $(a+1)*($(a+3)*$(a+8) - $(a+5)*$(a+6)) + $(a+2)*($(a+3)*$(a+7) - $(a+4)*$(a+6)) }' "$TMP/last"
}
close "volumes" "exp(-(10 + 1 + 8/3))*1e6" "$(awk -v d="$(det3)" 'BEGIN { printf "%.17g", d*1e6 }')" 1e-7 # of 1e-6: entries of 1 cancel to that

# M^-1 of the linearisation in dop853, second derivatives of L in gauss and the implicit verlet8: the same flow.
same_flow() { # MODEL METHOD STEP...
  "$LAGC" run "$1" --tangent --until 1 --method dop853 --tol 1e-13 --every 1 --quiet -o "$TMP/a.csv" &&
    "$LAGC" run "$1" --tangent --until 1 --method "$2" --every 1 --quiet -o "$TMP/b.csv" &&
    paste -d, "$TMP/a.csv" "$TMP/b.csv" | tail -1 | awk -F, '{ for (i = 1; i <= NF/2; i++) { d = $i - $(i + NF/2); s = $i*$i > 1 ? $i : 1
      if (d/s > 1e-8 || -d/s > 1e-8) { print "column", i, $i, $(i + NF/2); bad = 1 } } exit bad || NF < 40 }'
}
for model in double_pendulum ${SLOW:+spring_pendulum kepler}; do
  check "$model: gauss as dop853" same_flow models/$model.lag 'gauss(stages=4, step=0.005)'
  check "$model: taylor as dop853" same_flow models/$model.lag 'taylor'
  check "$model: verlet8 as dop853" same_flow models/$model.lag 'verlet8(step=0.002)'
done

# The tangent of a composed step depends on the time of each of its parts: a swing that is pumped.
cat >"$TMP/pumped.lag" <<'X'
model pumped
coord x
lagrangian = (1 + x^2/4)*x'^2/2 - (1 + 0.5*cos(3*t))*x^2/2
scene s { start x = 1; span 2 }
X
last "$TMP/pumped.lag" --method dop853 --tol 1e-13
cp "$TMP/last" "$TMP/sure"
last "$TMP/pumped.lag" --method 'verlet8(step=0.01)'
for entry in 'dx/dx' "dx/dx'" "dx'/dx" "dx'/dx'"; do
  close "$entry" "$(cut -d, -f"$(column "$entry(0)")" "$TMP/sure")" "$(entry "$entry(0)")" 1e-11
done

# ---- across events that change the state
# A ball from h at rest: w = sqrt(2 g h) at the first bounce, after n of them up with e^n w at T = w/g (1 + 2 e + ... + 2 e^(n-1)).
ball="g = 9.81; e = 0.8; w = sqrt(2*g); a = g/w; for (k = 1; k < 19; k++) s += e^k; dT = (1 + 2*s)/w; T = w*w*dT/g; du = e^19*a; u = e^19*w; r = 4 - T"
sums() { awk "BEGIN { $ball; printf \"%.17g\", $1 }"; } # 19 bounces in 4 s
for method in dop853 taylor radau rk45 'verlet(step=0.01)' 'gauss(stages=2, step=0.02)'; do
  last models/bouncing_ball.lag drop --method "$method"
  close "dy/dy, 19 bounces" "$(sums 'du*r - (u - g*r)*dT')" "$(entry 'dy/dy(0)')" 2e-8 # the last bounces are 1e-2 s apart, found to 1e-10 of that
  close "dy'/dy" "$(sums 'du + g*dT')" "$(entry "dy'/dy(0)" '(m/s)/m')" 2e-8
  close "dy'/dy'" 1 "$(entry "dy'/dy'(0)")" 2e-8 # a later start: T moves, u does not
done
last models/bouncing_ball.lag rubber --method 'verlet(step=0.01)'
close "a ball that loses nothing keeps areas" 1 "$(det2_of() { awk -F, -v a="$(column 'dy/dy(0)')" 'END { printf "%.17g", $a*$(a + 3) - $(a + 1)*$(a + 2) }' "$TMP/last"; }; det2_of)" 1e-9

# Hit once, at cos T = T/10 - 1/2 with speed -sin T: by the chain rule along x0 cos t, the bounce, and the motion after it.
wall="T = 1.9; for (k = 0; k < 30; k++) T -= (cos(T) - T/10 + 0.5)/(-sin(T) - 0.1); e = 0.7; x = cos(T); m = -sin(T); p = -e*m + (1 + e)/10; h = 4 - T
  c = cos(h); s = sin(h); dT = by_v ? -sin(T)/(m - 0.1) : -cos(T)/(m - 0.1); dx = (by_v ? sin(T) : cos(T)) + m*dT; dp = -e*((by_v ? cos(T) : -sin(T)) - x*dT)"
after() { awk "BEGIN { by_v = $1; $wall; printf \"%.17g\", $2 }"; }
for method in dop853 taylor 'verlet8(step=0.05)' 'gauss(stages=4, step=0.05)'; do
  last tests/exec/models/moving_wall.lag --method "$method"
  close "dx/dx" "$(after 0 'dx*c + dp*s - (p*c - x*s)*dT')" "$(entry 'dx/dx(0)')" 1e-9
  close "dx'/dx" "$(after 0 'dp*c - dx*s + (x*c + p*s)*dT')" "$(entry "dx'/dx(0)" '1/s')" 1e-9
  close "dx/dx'" "$(after 1 'dx*c + dp*s - (p*c - x*s)*dT')" "$(entry "dx/dx'(0)" s)" 1e-9
  close "dx'/dx'" "$(after 1 'dp*c - dx*s + (x*c + p*s)*dT')" "$(entry "dx'/dx'(0)")" 1e-9
done

# Everything by everything, two hits: differences of order 4 over starts 1e-3 apart; their error is 1e-12 times a fifth derivative,
# and 1e-13, the error of the runs, over 1e-3.
differences() {
  "$LAGC" build tests/exec/models/jumps.lag --method taylor --with linear -o "$TMP/jumps" && "$TMP/jumps" --tangent --tol 1e-14 --json >"$TMP/json" &&
    awk -v sim="$TMP/jumps" 'function end(name, x, i, line, out, n) {
        command = sim " --tol 1e-14 --json \"" name "=" sprintf("%.17g", x) "\""
        command | getline line; close(command); line = substr(line, index(line, "\"final\": {"))
        n = split(line, out, /[:,]/); for (i = 1; i <= 6; i++) { sub(/[^-+.e0-9]*/, "", out[2*i + 1]); y[i] = out[2*i + 1] + 0 }; return n > 13 }
      { $0 = substr($0, index($0, "\"tangent\"")); n = split($0, J, /[^-+.e0-9]+/); for (i = 1; i <= n; i++) if (J[i] ~ /^-?[0-9.]+/) D[++m] = J[i] + 0 }
      END { split("x y x\047 y\047 z s", name, " "); split("1 0.3 0.2 0 0.1 0", start, " "); h = 1e-3
        for (c = 1; c <= 6; c++) { for (i = 1; i <= 6; i++) d[i] = 0
          for (k = -2; k <= 2; k++) if (k) { if (!end(name[c], start[c] + k*h)) exit 1
            for (i = 1; i <= 6; i++) d[i] += (k == 1 || k == -1 ? 8*k : -k/2)*y[i]/(12*h) }
          for (i = 1; i <= 6; i++) { off = d[i] - D[6*(i - 1) + c]; seen++
            if (off > 2e-9 || off < -2e-9) { print name[i], "by", name[c], d[i], D[6*(i - 1) + c]; bad = 1 } } }
        exit bad || seen != 36 }' "$TMP/json"
}
check "two events that depend on everything, against differences" differences

# ---- constraints: columns are changes of the start projected onto the constraints
cat >"$TMP/rod.lag" <<'X'
model rod "A pendulum by a rod"
coord x, y
lagrangian = (x'^2 + y'^2)/2 - 9.81*y
constraint rod: x^2 + y^2 = 1
scene s { start x = sin(2), y = -cos(2), x' = cos(2), y' = sin(2); span 3; tolerance 1e-13; output x every 3 }
X
cat >"$TMP/angle.lag" <<'X'
model angle "The same by its angle"
coord th
lagrangian = th'^2/2 + 9.81*cos(th)
scene s { start th = 2, th' = 1; span 3; tolerance 1e-13; method dop853; output th, th' every 3 }
X
last "$TMP/angle.lag"
cp "$TMP/last" "$TMP/angle"
as_angle() { # q = (sin th, -cos th), v = th' (cos th, sin th): both sides of dy(3)/dy(0) Dy(0) = Dy(3) Dth(3)/Dth(0); along the rod nothing changes
  paste -d, "$TMP/angle" "$TMP/last" | awk -F, -v tolerance="$1" 'function embed(th, w, dth, dw, e) {
      e[1] = cos(th)*dth; e[2] = sin(th)*dth; e[3] = cos(th)*dw - w*sin(th)*dth; e[4] = sin(th)*dw + w*cos(th)*dth }
    { for (c = 0; c < 4; c++) {
        for (i = 1; i <= 4; i++) want[i] = 0
        if (c < 2) { embed(2, 1, c == 0, c == 1, from); embed($2, $3, $(4 + c), $(6 + c), want) }
        else { from[1] = from[2] = from[3] = from[4] = 0; from[2*c - 3] = sin(2); from[2*c - 2] = -cos(2) }
        for (i = 1; i <= 4; i++) { got = 0
          for (j = 1; j <= 4; j++) got += $(9 + 4*(i - 1) + j)*from[j]
          if ((got - want[i])^2 > tolerance^2) { print c, i, got, want[i]; bad = 1 } } } }
    END { exit bad || NF != 25 }'
}
for method in "dop853 1e-10" "rk45 1e-9" "radau 1e-8" "rk4(step=2e-4) 1e-9"; do # entries of 10; of radau the steps are for y; of rk4 (g h^2)^2 with h = 2e-4
  last "$TMP/rod.lag" --method "${method% *}"
  check "$title: as by the angle" as_angle "${method#* }"
done
# Struck at the lowest point: half of the angle's rate comes back.
sed 's/^constraint/event knock: x falling { x'"'"' = -x'"'"'\/2 }\nconstraint/' "$TMP/rod.lag" >"$TMP/knocked.lag"
sed 's/^scene s/event knock: th falling { th'"'"' = -th'"'"'\/2 }\nscene s/' "$TMP/angle.lag" >"$TMP/knocked_angle.lag"
last "$TMP/knocked_angle.lag"
cp "$TMP/last" "$TMP/knocked_angle"
cp "$TMP/angle" "$TMP/free_angle"
cp "$TMP/knocked_angle" "$TMP/angle"
last "$TMP/knocked.lag"
check "$title: struck, as by the angle" as_angle 1e-9
cp "$TMP/free_angle" "$TMP/angle"
last "$TMP/rod.lag" --method 'rk4(step=0.05)' --observe y # steps leave the circle by 1e-5, and are projected
check "$title: columns are tangent to the circle" awk -v a="$(entry x)" -v b="$(entry y)" -v c="$(entry 'dx/dx(0)')" -v d="$(entry 'dy/dx(0)')" 'BEGIN { e = a*c + b*d; exit !(c*c > 1e-4 && e*e < 1e-26) }'
# A ball on a turntable: its centre circles at 2/7 W = w from any start. By Gauss, a velocity 1 of the centre loses 2/7 to the spin, as I/(m R^2) = 2/5; one of x needs y' = w.
last models/turntable.lag --until 3 --tol 1e-12
close "dx/dx" "cos(18/7)" "$(entry 'dx/dx(0)')" 1e-9
close "dy/dx" "sin(18/7)" "$(entry 'dy/dx(0)')" 1e-9
close "dx/dx'" "5/7*sin(18/7)*7/6" "$(entry "dx/dx'(0)" 'm/(m/s)')" 1e-9
close "dx/db'" "0.05*2/7*sin(18/7)*7/6" "$(entry "dx/db'(0)" 'm/(rad/s)')" 1e-9

# ---- dry friction: around the centres +-R/w^2 the phase goes on, and the amplitude falls by 2 R/w^2 at each stop
cat >"$TMP/rub.lag" <<'X'
model rub
coord x
param w = 3, R = 0.9
lagrangian = x'^2/2 - w^2*x^2/2
friction table on x: R
scene s { start x = 1, x' = -0.5; span 2; tolerance 1e-12; output x every 10 }
X
rub="c0 = 0.1; a0 = sqrt(0.81 + 1/36); p0 = atan2(0.5/3, 0.9); by = by_v ? -sin(p0)/3 : cos(p0); bp = (by_v ? -cos(p0)/3 : -sin(p0))/a0; p = p0 + 3*T; n = int(p/3.14159265358979); a = a0 - 0.2*n"
swung() { awk "BEGIN { by_v = $1; T = $2; $rub; printf \"%.17g\", $3 }"; }
for method in dop853 rk45 radau 'rk4(step=1e-3)'; do # stops are found to 1e-10
  last "$TMP/rub.lag" --method "$method" --until 3.5
  close "dx/dx, after three stops" "$(swung 0 3.5 'by*cos(p) - a*sin(p)*bp')" "$(entry 'dx/dx(0)')" 2e-9
  close "dx'/dx" "$(swung 0 3.5 '-3*(by*sin(p) + a*cos(p)*bp)')" "$(entry "dx'/dx(0)" 1/s)" 2e-9
  close "dx/dx'" "$(swung 1 3.5 'by*cos(p) - a*sin(p)*bp')" "$(entry "dx/dx'(0)" s)" 2e-9
  close "dx'/dx'" "$(swung 1 3.5 '-3*(by*sin(p) + a*cos(p)*bp)')" "$(entry "dx'/dx'(0)")" 2e-9
done
last "$TMP/rub.lag" --until 8 # it stays where its fifth half-swing would begin
close "dx/dx, at rest" "-cos(atan2(0.5/3, 0.9))" "$(entry 'dx/dx(0)')" 1e-9
close "dx'/dx" 0 "$(entry "dx'/dx(0)" 1/s)" 1e-12
check "the report says that a rank is lost" sh -c "'$LAGC' run '$TMP/rub.lag' --tangent --until 8 | grep -q 'rank of the tangent falls by 1 where a slide begins: 1 time'"
# Sticking and slipping, broken loose by static friction: the flow takes its own rate along, dy(t)/dy(0) y'(0) = y'(t).
cat >"$TMP/belt.lag" <<'X'
model belt
coord x
let slip = x - 0.2*t
lagrangian = x'^2/2 - x^2/2
friction rub on slip: 0.25, static = 0.4
scene squeak { start x = 0.5; span 19; tolerance 1e-11; output x, x', x'' every 19 }
X
last "$TMP/belt.lag"
rides() { awk -F, '{ for (i = 0; i < 2; i++) { d = -0.25*$(6 + 2*i) - $(3 + i); if (d*d > 1e-18) { print i, d; bad = 1 } } det = $5*$8 - $6*$7; exit bad || det*det > 1e-18 || NF != 8 }' "$TMP/last"; }
check "the flow takes its rate along, and has one rank left" rides
cp "$TMP/belt.lag" "$TMP/stuck.lag" # from x' = 0.2 it sticks at once: x = x(0) + t/5, as for velocities beside it
last "$TMP/stuck.lag" "x=-0.3" "x'=0.2" --until 3
sticks() { awk -F, '{ exit !(NF == 8 && ($5 - 1)^2 + $6^2 + $7^2 + $8^2 < 1e-20) }' "$TMP/last"; }
check "a start that sticks" sticks
last models/falling_cat.lag --until 1 --method dop853 # surfaces of time alone, two at once, where the rates jump: all motions meet them together
close "a start that is turned stays so" 1 "$(entry 'dpsi/dpsi(0)')" 1e-9
# A bounce turns the friction, too: the acceleration is -0.8 down and -1.2 up.
cat >"$TMP/drop.lag" <<'X'
model drop
coord y
lagrangian = y'^2/2 - y
friction rub on y: 0.2
event floor: y falling { y' = -0.5*y' }
scene s { start y = 1, y' = -1; span 1.1; tolerance 1e-12; output y every 2 }
X
last "$TMP/drop.lag" # W = sqrt(v^2 + 1.6 y) at the floor, after (W + v)/0.8 s; y = W s/2 - 0.6 s^2 after s more
drop="W = sqrt(2.6); s = 1.1 - (W - 1)/0.8; V = W/2 - 1.2*s; dW = by_v ? -1/W : 0.8/W; ds = -(dW + by_v)/0.8"
dropped() { awk "BEGIN { by_v = $1; $drop; printf \"%.17g\", $2 }"; }
close "dy/dy, up from a floor" "$(dropped 0 'dW*s/2 + V*ds')" "$(entry 'dy/dy(0)')" 1e-9
close "dy'/dy" "$(dropped 0 'dW/2 - 1.2*ds')" "$(entry "dy'/dy(0)" 1/s)" 1e-9
close "dy/dy'" "$(dropped 1 'dW*s/2 + V*ds')" "$(entry "dy/dy'(0)" s)" 1e-9

# ---- printed report
"$LAGC" run models/spring.lag free --tangent --until 1 >"$TMP/out"
check "the report has the matrix" sh -c "grep -q \"x(0) *x'(0)\" '$TMP/out' && grep -q '^  x  *-0.416146' '$TMP/out'"
json() { "$LAGC" run models/spring.lag free --tangent --until 1 --json | grep -q "\"tangent\": {\"x\": {\"x\": -0.41614[0-9]*, \"x'\": 0.454[0-9]*}, \"x'\": {\"x\": -1.81[0-9]*, \"x'\": -0.416[0-9]*}}, "; }
check "--json has it by names" json
degrees() { # declared units: the derivative of an angle in degrees by one in radians has the factor of both
  "$LAGC" run tests/exec/modes/coupled.lag --tangent --until 0.1 --quiet -o "$TMP/rows.csv" && head -1 "$TMP/rows.csv" | grep -q 'deg/rad'
}
check "units are those declared" degrees

# ---- refusals
refused() { # STATUS TEXT ARGS...
  status=$1
  text=$2
  shift 2
  "$LAGC" run "$@" --tangent >"$TMP/out" 2>&1
  [ $? = "$status" ] && grep -q -e "$text" "$TMP/out" || { cat "$TMP/out"; return 1; }
}
if [ -n "${GSL:-}" ] || [ -e "${BUILD:-build}/liblag_gsl.a" ]; then
  check "a method without" refused 2 "method gsl-rk8pd has no derivative of its steps; dop853 has" models/spring.lag free --method gsl-rk8pd
else
  skip "a method without" "GSL is not installed"
fi
cat >"$TMP/driven.lag" <<'X'
model driven
coord x
input u = sin(t)
lagrangian = x'^2/2 - x^2/2
event wall: x + u/10 falling { x' = -x' }
event one: x - 0.5 falling { x' = 0.9*x' }
event other: x^2 - 0.25 falling { x' = 0.8*x' }
scene go { start x = 0.3; span 4 }
scene both { like go
  start x = 1 }
X
check "an event that depends on an input" refused 3 'event wall changes the state at t = .*: it depends on an input' "$TMP/driven.lag"
cat >"$TMP/corner.lag" <<'X'
model corner "Two surfaces at once"
coord x, y
lagrangian = (x'^2 + y'^2)/2
force x = 0.1*if(x > 0, 1, 2)
force y = 0.1*if(y > 0, 1, 2)
scene s { start x = -1, y = -1, x' = 1, y' = 1; span 3 }
X
slow check "a linkage that lies in one line" refused 3 "constraint .* nearly depends on the others: neighbouring motions part there" tests/exec/models/four_bars.lag turn --method 'rk4(step=1e-4)' --until 4
check "two surfaces at once" refused 3 "a force jumps, and two surfaces are met at once" "$TMP/corner.lag"
check "two at once" refused 3 'event other changes the state at t = .*: another event does so at the same time' "$TMP/driven.lag" both
cat >"$TMP/touch.lag" <<'X'
model touch
coord x
lagrangian = x'^2/2 + x*0
event floor: (x - 1)^3 rising { x' = 2*x' }
scene go { start x = 0, x' = 1; span 3 }
X
check "one that is only touched" refused 3 'the motion only touches it' "$TMP/touch.lag"
check "a saved state" refused 2 "a saved state holds no tangent" models/spring.lag free --save-state "$TMP/state"
without() { "$LAGC" build models/spring.lag -o "$TMP/spring" && ! "$TMP/spring" --tangent >"$TMP/out" 2>&1 && grep -q 'lagc build --with linear' "$TMP/out"; }
check "a simulator without derivatives" without
with() { "$LAGC" build models/spring.lag --with linear -o "$TMP/spring" && "$TMP/spring" --tangent >"$TMP/out" && grep -q '^tangent' "$TMP/out"; }
check "and one with them" with
tap_end
