#!/bin/sh
# The method of a run that names none, and its report of the choice.
. tests/tap.sh

cat >"$TMP/van_der_pol.lag" <<'EOF'
model van_der_pol "an oscillator that takes in energy when small, and loses it when large"
state x, y
param mu = 1000
flow x' = y
flow y' = mu*(1 - x^2)*y - x
scene run { start x = 2; span 2000 [s] }
EOF
cat >"$TMP/wall.lag" <<'EOF'
model wall
coord x
lagrangian = x'^2/2 - if(x > 0, x^2, 3*x^2)
scene run { start x = 1; span 2 [s] }
EOF

# takes METHOD MODEL ARGS...: the method is chosen, and the report says so
takes() {
  method=$1
  shift
  "$LAGC" run "$@" >"$TMP/out" 2>"$TMP/err" && grep -q "method $method(" "$TMP/out" && grep -q "^chosen: $method, since" "$TMP/out" || { cat "$TMP/out" "$TMP/err"; return 1; }
}
vdp=$TMP/van_der_pol.lag
# x^(3/2) has no series at 0; friction in space is followed by events at up to three contacts, by moreau at more.
printf "model pull\ncoord x\nkinetic = x'^2/2\npotential = -2/3*x^(3/2)\nscene s { start x = 0, x' = 1; span 1 }\n" >"$TMP/pull.lag"
starts() { takes dop853 "$TMP/pull.lag" --tol 1e-12 && grep -q '^chosen: dop853, since taylor cannot start here (at t = 0 s: the model gives no finite value' "$TMP/out"; }
check "a series that does not exist at the start: dop853" starts
cat >"$TMP/puck.lag" <<'EOF'
model puck "slides to its rest: 2 s, 2 m along (0.6, 0.8)"
coord r: vec3 [m]
param m = 1 [kg] > 0, g = 10 [m/s^2] > 0, mu = 0.1 >= 0
kinetic = m/2*dot(r', r')
potential = m*g*r.z
contact ice: r.z >= 0, restitution = 0, friction = mu, slip = (r.x', r.y')
scene s { start r.x' = 1.2 [m/s], r.y' = 1.6 [m/s]; span 3 [s]; output r.x, r.y }
EOF
# on four feet, which slide alike
sed 's/^model puck/model stool/; s/^contact ice: \(.*\)/for i in 1..4 { contact foot[i]: \1 }/' "$TMP/puck.lag" >"$TMP/stool.lag"
check "friction in space: dop853" takes dop853 "$TMP/puck.lag"
stool() { "$LAGC" run "$TMP/stool.lag" >"$TMP/out" 2>&1; cat "$TMP/out"; grep -q '^chosen: moreau, since dop853 cannot start here (method dop853 follows friction in space at up to 3 contacts, and there are 4 here' "$TMP/out"; }
check "at four contacts: moreau" stool
near "and follows it: mu g t^2/2 = 2 m" 1e-3 1.2 "$(sed -n 's/^ *r\.x  *\([-0-9.e]*\) m$/\1/p' "$TMP/out")"
check "stiff: radau" takes radau "$vdp" --tol 1e-9
# x(2000) = 1.706167732170469, y(2000) = -0.8928097010248e-3 for mu = 1000: problem vdpol of F. Mazzia, C. Magherini, Test Set
# for Initial Value Problem Solvers, release 2.4 (2008). 1e-6: the tolerance, and the slow drift along the limit cycle.
published() { awk '$1 == "x" { x = $2 } $1 == "y" { y = $2 } END { dx = x - 1.706167732170469; dy = y + 0.8928097010248e-3
  if (dx*dx < 1e-12 && dy*dy < 1e-18) exit 0; print x, y; exit 1 }' "$TMP/out"; }
check "with the published values at t = 2000" published
cat >"$TMP/spring.lag" <<'EOF'
model spring "a stiff damped spring joins two masses that swing together; rates of 501 and 399499 beside 0.7"
coord x, y
param k = 1e8, c = 2e5
lagrangian = x'^2/2 + y'^2/2 - k/2*(x - y)^2 - y^2/2
dissipation = c/2*(x' - y')^2
scene run { start x = 1, y = 1.0001; span 10 [s] }
scene back { start x = 1, y = 1.0001; span -1e-4 [s] }
EOF
cat >"$TMP/sensor.lag" <<'EOF'
model sensor "a pendulum, and a sensor that follows it within a microsecond; the pendulum alone conserves its energy"
coord th
state z
lagrangian = th'^2/2 + cos(th)
flow z' = -1e6*(z - sin(th))
scene run { start th = 1, z = 0.84; span 10 [s] }
EOF
for tol in 1e-3 1e-5 1e-7 1e-11 1e-13; do
  check "stiff at a tolerance of $tol: radau, where h*rho goes up and down about the bound of stability" takes radau "$TMP/spring.lag" --tol $tol
  check "a stiff state beside coordinates that conserve energy, at $tol: radau" takes radau "$TMP/sensor.lag" --tol $tol
done
few() { takes radau "$TMP/spring.lag" --tol 1e-11 && awk '$1 == "steps" && $2 + 0 < 1000 { fine = 1 } END { exit !fine }' "$TMP/out"; }
check "in hundreds of steps, where stability alone would demand 650,000: 399499*10 s/6.1" few
check "and says so, where the tolerance limits the first steps to less than stability does" grep -q 'stability alone would demand 6.*e+05 steps of dop853' "$TMP/out"
# Backwards in time decaying parts grow: no method may take long steps over them.
check "backwards the same model is not stiff: rk45" takes rk45 "$TMP/spring.lag" --until -1e-4 --tol 1e-3
check "at a fine tolerance: dop853" takes dop853 "$TMP/spring.lag" --until -1e-4 --tol 1e-7
check "at a finer one: taylor" takes taylor "$TMP/spring.lag" --until -1e-4 --tol 1e-11
check "nor where the scene goes backwards" takes rk45 "$TMP/spring.lag" back --tol 1e-3
check "a sensor backwards: rk45" takes rk45 "$TMP/sensor.lag" --until -2e-5 --tol 1e-5
# th is 1 within 2e-10 there, so z - sin(1) = (0.84 - sin(1)) exp(20) within 1e-9; tolerance 1e-2: growth by exp(20) in steps of tolerance 1e-5.
grown() { awk '$1 == "z" { off = ($2 - sin(1))/((0.84 - sin(1))*exp(20)) - 1 } END { print off; exit !(off != "" && off*off < 1e-4) }' "$TMP/out"; }
check "which grows as it must, and does not follow" grown
check "what is stiff backwards takes radau" takes radau "$vdp" --until -2000 --tol 1e-7
check "not stiff at rough tolerances: rk45" takes rk45 models/pendulum.lag --tol 1e-2 --until 2
check "nor with friction" takes rk45 models/damped_oscillator.lag --tol 1e-2
check "not stiff: dop853" takes dop853 "$vdp" mu=1 --until 20
check "a rough tolerance: rk45" takes rk45 "$vdp" mu=1 --until 20 --tol 1e-4
check "a tolerance below 1e-9: taylor" takes taylor "$vdp" mu=1 --until 20 --tol 1e-11
check "by the scene's tolerance, too" takes taylor models/double_pendulum.lag swing
check "with if: dop853" takes dop853 "$TMP/wall.lag" --tol 1e-11
check "with --tangent: taylor, too" takes taylor models/double_pendulum.lag swing --tangent
check "past 40 coordinates: dop853" takes dop853 models/chain.lag -D N=50 --until 0.1
named() { "$LAGC" run "$@" >"$TMP/out" 2>&1 && ! grep -q '^chosen' "$TMP/out"; }
check "nothing is chosen where the command line names one" named "$vdp" mu=1 --until 20 --method rk45
check "or the scene" named models/lorenz.lag --until 1
json() { "$LAGC" run "$vdp" --json >"$TMP/json" && grep -q '"method": "radau", "chosen": "radau, since the model is stiff' "$TMP/json"; }
check "as JSON" json
built() { "$LAGC" build "$vdp" -o "$TMP/vdp" && "$TMP/vdp" --until 1 >"$TMP/out" && grep -q '^chosen: radau' "$TMP/out"; }
check "a simulator that was built chooses, too" built
resumed() { "$LAGC" run "$vdp" --until 100 --save-state "$TMP/state" --quiet && "$LAGC" run "$vdp" --resume "$TMP/state" --until 200 >"$TMP/out" && grep -q 'method radau' "$TMP/out"; }
check "a run goes on with what it began with" resumed
# The series that taylor needs are compiled in where it may be chosen, below a tolerance of 1e-9, and nowhere else.
can_take_taylor() { # TOLERANCE, or nothing
  printf 'model free\ncoord x\nlagrangian = x'"'"'^2/2 - x^4/4\nscene run { start x = 1; span 2 [s]%s }\n' "${1:+; tolerance $1}" >"$TMP/free.lag"
  "$LAGC" build "$TMP/free.lag" -o "$TMP/free" && "$TMP/free" --method taylor --quiet 2>"$TMP/err"
}
cannot_take_taylor() { ! can_take_taylor "$@" && grep -q "built without" "$TMP/err"; }
check "series for a tolerance of 1e-12" can_take_taylor 1e-12
for tolerance in '' 1e-9 1e-6; do
  check "none for ${tolerance:-no tolerance}" cannot_take_taylor $tolerance
done
tap_end
