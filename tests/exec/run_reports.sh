#!/bin/sh
# Reports that claim no more than is known: lost energy in a blow-up, poles that are stepped over, friction that holds, rounding larger than
# the motion, floors that a coarse method would miss, Lyapunov exponents with their errors.
. tests/tap.sh

run() { "$LAGC" run "$@" --no-gsl --json >"$TMP/json" 2>"$TMP/err"; }
number() { sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p" "$TMP/json"; }
ends() { # STATUS WORDS ARGS...
  status=$1 words=$2
  shift 2
  "$LAGC" run "$@" >"$TMP/out" 2>&1 </dev/null
  got=$?
  cat "$TMP/out"
  [ "$got" = "$status" ] && grep -q -e "$words" "$TMP/out"
}

# ---- the scale of a drift. Verlet from x = 1 at rest keeps v^2 + (1 - h^2/4) x^2, so E is off by h^2/8 at most; |p.v| + |L| = sin^2 + |cos 2t|/2 is
# 1/2 + 1/pi in the mean of many periods.
cat >"$TMP/spring.lag" <<'X'
model spring
coord x [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0
lagrangian = m/2*x'^2 - k/2*x^2
scene s { start x = 1; span 1000 }
X
run "$TMP/spring.lag" --method verlet --step 0.2
near "absolute drift" 1e-4 0.005 "$(number energy_drift_absolute)"
near "relative to the median" 1e-4 0.00611 "$(number energy_drift)" # bins hold not quite whole periods
check "with its unit" ends 0 '^energy drift: 0.006[0-9]* (0.005 J; relative to the larger of |E0| and the median of |p.v| + |L|), oscillates' "$TMP/spring.lag" --method verlet --step 0.2
cat >"$TMP/zero.lag" <<'X'
model zero "An energy that begins at 0, at rest"
coord y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0
lagrangian = m/2*y'^2 - m*g*y
scene s { span 10 }
X
run "$TMP/zero.lag" --method rk4
near "an energy of 0 at first" 1e-12 0 "$(number energy_drift)" # exact up to rounding: the motion is a parabola

# ---- a fall into the pole of -1/x takes pi/(2 sqrt 2) = 1.1107 s
cat >"$TMP/pole.lag" <<'X'
model pole
coord x
lagrangian = x'^2/2 + 1/x
scene s { start x = 1; span 10 }
X
over() { # MODEL METHOD
  check "$1: over a pole by $2" ends 3 "FAILED: at t = [0-9.]* s: the model left its domain (a pole of [xz]'*, which no motion crosses); steps of" "$TMP/$1.lag" --method "$2"
}
for method in rk4 'rk4(step=0.01)' verlet 'verlet4(step=0.01)' symplectic_euler 'rk45(adapt=off,step=0.01)'; do
  over pole "$method"
done
check "by variational: Newton's method, or the energy" ends 3 'FAILED: at t = 1.1[12][0-9]* s' "$TMP/pole.lag" --method variational
# The energy does not reveal a pole where L jumps, an input acts, or there is only a flow; nor where the steps before and behind the pole mirror each
# other. Poles of forces are of second and first order.
echo 'model jumps; coord x; lagrangian = x'"'"'^2/2 + 0.1/(x - 0.5) - if(x > 100, 1, 0); scene s { start x = 2, x'"'"' = -1; span 20 }' >"$TMP/jumps.lag"
echo 'model signal; coord x; input F = 0.01; lagrangian = x'"'"'^2/2 + 0.1/(x - 0.5) + F*x; scene s { start x = 2, x'"'"' = -1; span 20 }' >"$TMP/signal.lag"
echo 'model flow; state z; flow z'"'"' = -1/z^3; scene s { start z = 1; span 2 }' >"$TMP/flow.lag"
echo 'model log; coord x; lagrangian = x'"'"'^2/2 - log(abs(x)); scene s { start x = 1; span 10 }' >"$TMP/log.lag"
for method in 'rk4(step=0.01)' 'rk4(step=0.037)' 'rk4(step=0.1)' 'rk45(adapt=off,step=0.01)'; do
  for model in jumps signal flow log; do one_of 3 && over $model "$method"; done
done
for method in verlet 'verlet(step=0.01)' 'verlet(step=0.1)' 'verlet6(step=0.01)' 'symplectic_euler(step=0.01)'; do
  for model in jumps signal log; do one_of 4 && over $model "$method"; done
done
# Finite forces, and a corner of a root, are not poles: a barrier that a step leads over, a fall past a centre, a force of 1/sqrt(x).
echo 'model barrier; coord x; lagrangian = x'"'"'^2/2 - 0.1*exp(-(x/1e-5)^2); scene s { start x = 1, x'"'"' = -1; span 3 }' >"$TMP/barrier.lag"
echo 'model root; coord x; lagrangian = x'"'"'^2/2 - sqrt(abs(x)); scene s { start x = 1; span 20 }' >"$TMP/root.lag"
echo 'model past; coord x, y; lagrangian = (x'"'"'^2 + y'"'"'^2)/2 + 1/hypot(x, y); scene s { start x = 1, y'"'"' = 0.01; span 3 }' >"$TMP/past.lag"
for method in 'rk4(step=0.01)' 'rk4(step=0.037)' 'rk4(step=0.1)' 'verlet(step=0.00987)' 'symplectic_euler(step=0.01)'; do
  check "no pole in a barrier, by $method" ends 0 'reached t = 3 s' "$TMP/barrier.lag" --method "$method"
  for model in root past; do # such steps may lose the energy of these models
    "$LAGC" run "$TMP/$model.lag" --method "$method" >"$TMP/out" 2>&1
    empty "nor in $model, by $method" "$(grep "a pole of [xy]'" "$TMP/out")"
  done
done
for method in rk45 dop853 radau; do
  check "in front of it by $method" ends 3 'FAILED: at t = 1.11072[0-9]* s: the step became too small' "$TMP/pole.lag" --method $method
  run "$TMP/pole.lag" --method $method
  check "its many steps there do not hide the drift" awk -v d="$(number energy_drift)" -v a="$(number energy_drift_absolute)" 'BEGIN { exit !(d > a/4 && d < a) }'
done

# ---- steps that are too long for a stiff spring: w = 1e6
cat >"$TMP/stiff.lag" <<'X'
model stiff
coord x [m]
param m = 1 [kg] > 0, k = 1e12 [N/m] > 0, c = 0 [N*s/m] >= 0
lagrangian = m/2*x'^2 - k/2*x^2
dissipation = c/2*x'^2
scene s { start x = 1; span 10 }
X
check "by variational: a note" ends 0 'note: steps are longer than half a period, about 6.3e-06 s' "$TMP/stiff.lag" --method variational
run "$TMP/stiff.lag" --method variational
near "and in JSON" 1e-9 6.2832e-6 "$(number unresolved_period)"
check "with friction: no balance" ends 3 'the energy is off by .* the numbers mean nothing' "$TMP/stiff.lag" --method variational c=0.1
run "$TMP/spring.lag" --method variational --step 0.5
is "steps that resolve it: none" null "$(number unresolved_period)"

# ---- dry friction in a plane, which no run follows (along a line: exec/run_friction)
cat >"$TMP/plane.lag" <<'X'
model plane
coord x [m], y [m]
param m = 1 [kg] > 0, mu = 0.3 [1], g = 9.81 [m/s^2] > 0
lagrangian = m/2*(x'^2 + y'^2)
force x = -mu*m*g*x'/hypot(x', y')
force y = -mu*m*g*y'/hypot(x', y')
scene s { start x' = 1.2 [m/s], y' = 1.6 [m/s]; span 10 [s] }
X
for method in rk45 ${SLOW:+dop853 rk4} verlet ${SLOW:+radau}; do
  check "in a plane by $method" ends 3 "FAILED: at t = 0\.6[78][0-9]* s: the motion gets stuck (it stays where hypot(x', y') is 0: .* in line 5 jumps" "$TMP/plane.lag" --method $method
done
check "and is warned of" says 0 '' "$LAGC" check "$TMP/plane.lag"
check "at the place" grep -q "plane.lag:5:[0-9]*: warning: a force jumps where .hypot(x', y'). is 0; a motion that sticks there" "$TMP/err"
# Branches with roots of what they exclude, which no run holds: x'' = -(1 + sqrt(x')) comes to rest at 2 (2 - log 3) = 1.80277 s, to a step.
echo "model grip; coord x; lagrangian = x'^2/2; force x = if(x' > 0, -1 - sqrt(x'), 1 + sqrt(-x')); scene s { start x' = 4; span 10 }" >"$TMP/grip.lag"
for method in dop853 verlet 'rk4(step=0.01)' 'rk4(step=0.0372)'; do
  check "a branch that nothing holds, by $method" ends 3 "FAILED: at t = 1\.8[012][0-9]* s: the motion gets stuck (it stays where x' is 0: .* pulls back from both sides" "$TMP/grip.lag" --method "$method"
done
# x'' = -x - 0.1 sign(x') from x = 2: each half swing loses 0.2, and at its end the spring is stronger than friction
cat >"$TMP/swings.lag" <<'X'
model swings
coord x
lagrangian = x'^2/2 - x^2/2
dissipation = 0.1*abs(x')
scene s { start x = 2; span 3*pi }
scene rests { start x = 2; span 100 }
X
for method in dop853 rk45 radau; do
  run "$TMP/swings.lag" --method $method
  near "it turns where friction is weaker, by $method" 1e-6 -1.4 "$(sed -n 's/.*"final": {"x": \([^,]*\).*/\1/p' "$TMP/json")"
done
check "and rests where it is stronger, after 10 half swings" ends 0 "surface x' = 0: crossed 9 times; stuck or slid there 1 time, for 68.5841 s" "$TMP/swings.lag" rests

# ---- numbers that are too coarse
cat >"$TMP/far.lag" <<'X'
model far
coord x [m]
lagrangian = x'^2/2 - if(x > 1e17 [m], (x - 1e17 [m])^2/2 [s^2], 0)
scene s { start x' = 1 [m/s]; span 1e18 [s] }
scene away { start x = 1e13 [m], x' = 1e-3 [m/s]; span 10 [s] }
X
check "a time of 1e17 s" ends 3 'or the time too late: times are 2e+01 s apart here' "$TMP/far.lag" s
check "what is far away may move slowly" ends 0 'reached' "$TMP/far.lag" away --method rk4
check "a tolerance of 1e300" ends 2 'a tolerance of 1e+300 leaves no digit' "$TMP/spring.lag" --tol 1e300
sed 's/span 1000/span 1000; tolerance 1e300/' "$TMP/spring.lag" >"$TMP/loose.lag"
check "and in the model" says 1 'the tolerance must be positive and below 1' "$LAGC" check "$TMP/loose.lag"

# ---- a closed form that ends
echo 'model ends; coord x; lagrangian = x'"'"'^2/2; scene s { start x = 1; span 2; exact x = if(t < 1, 1, sqrt(1 - t)) }' >"$TMP/ends.lag"
check "a closed form without a value is none" ends 0 '^exact x: the closed form has no finite value at some states of the run' "$TMP/ends.lag"
check "before that it is one" ends 0 '^exact x: largest deviation 0, final 0$' "$TMP/ends.lag" --until 0.5

# ---- Lyapunov exponents: 0 for an oscillator; a limit cycle has dimension 1
"$LAGC" lyapunov "$TMP/spring.lag" --until 2000 >"$TMP/out"
check "an oscillator is not known to be chaotic" grep -q 'not known to be chaotic: the first exponent is 0 within three errors' "$TMP/out"
check "and errors do not grow by e in so many seconds" sh -c "! grep -q 'factor of e in [0-9.e+]* s' '$TMP/out'"
cat >"$TMP/cycle.lag" <<'X'
model cycle "Van der Pol's"
coord x
lagrangian = x'^2/2 - x^2/2
force x = (1 - x^2)*x'
scene s { start x = 2; span 100 }
X
"$LAGC" lyapunov "$TMP/cycle.lag" --until 2000 --json >"$TMP/json"
near "a limit cycle has dimension 1" 1e-9 1 "$(number dimension)"
near "its error" 1e-3 0 "$(number dimension_error)"
is "it is not said to be chaotic" null "$(number chaotic)"
"$LAGC" lyapunov models/lorenz.lag --json >"$TMP/json"
is "Lorenz's is" true "$(number chaotic)"
near "its entropy, the sum of the positive exponents" "$(number entropy_error)" 0.9056 "$(number entropy)"

# ---- numbers are the shortest that read back: 0.1 is 0.10000000000000001 with 17 digits
sed 's/span 1000/span 0.1/' "$TMP/spring.lag" >"$TMP/short.lag"
run "$TMP/short.lag"
is "JSON: 0.1" 0.1 "$(number t_end)"
run "$TMP/short.lag" --until 0.30000000000000004
is "JSON: all digits that count" 0.30000000000000004 "$(number t_end)"
sed 's/^scene.*/event end: t - 0.5 [s] rising { stop }\n&/' "$TMP/spring.lag" >"$TMP/stop.lag"
check "text: 0.5" ends 0 "^stopped by an event at t = 0.5 s" "$TMP/stop.lag" --method rk4 --step 0.1
slow run "$TMP/short.lag" --precision quad
slow is "JSON with 34 digits: 0.1" 0.1 "$(number t_end)"

# ---- an energy that fades by the method alone: rk4 multiplies it by 1 - z^6/72 + z^8/576 = 0.886 each step, z = 1.5
printf 'model fades\ncoord x\nlagrangian = x'"'"'^2/2 - x^2/2\nscene s { start x = 1; span 1000; method rk4(step=1.5) }\n' >"$TMP/fades.lag"
check "an energy that the method loses" ends 3 'FAILED: up to t = 1000 s the energy has an error of 0.5, of 0.5 at the start: the numbers mean nothing; take smaller steps' "$TMP/fades.lag"
check "and one that it keeps" sh -c "! '$LAGC' run '$TMP/fades.lag' --step 0.1 | grep 'the numbers mean nothing'"

# ---- outputs without a value: cos t is below 0 from pi/2 to 3 pi/2, at 2 to 4.5 of 0, 0.5, .. 5
cat >"$TMP/root.lag" <<'X'
model root
coord x
lagrangian = x'^2/2 - x^2/2
scene s { start x = 1; span 5; output x, sqrt(x) every 0.5 }
X
check "an output without a value" ends 0 'note: the output sqrt(x) has no finite value at t = 2 s; the same in 6 of 11 rows' "$TMP/root.lag" -o "$TMP/root.csv"
run "$TMP/root.lag" -o "$TMP/root.csv"
is "and in JSON" 6 "$(number rows_without_value)"
tap_end
