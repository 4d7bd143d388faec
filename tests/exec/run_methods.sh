#!/bin/sh
# Methods that a model allows, from the .lag file to the run: the compiler finds out which models are separable, the runtime refuses
# unsuitable methods and names suitable ones.
. tests/tap.sh

flags() { # flags MODEL: flags of its first variant
  "$LAGC" emit "$1" -o "$TMP/model.c" && sed -n 's/.*\.flags = \([^,]*\),.*/\1/p' "$TMP/model.c" | head -n 1
}
separable() { flags "$1" | grep -q LAG_SEPARABLE; }
not_separable() { ! separable "$1" && [ -s "$TMP/model.c" ]; }
run() { "$LAGC" run "$@" >"$TMP/out" 2>"$TMP/err"; }
refused() { # refused WORDS ARGS...
  words=$1
  shift
  run "$@"
  [ $? = 2 ] && grep -qF -e "$words" "$TMP/err" && grep -q 'rk45 and dop853' "$TMP/err"
}
says() { # says WORDS ARGS...
  words=$1
  shift
  run "$@" && grep -q -e "$words" "$TMP/out"
}

check "a pendulum is separable" separable models/pendulum.lag
check "Kepler is separable" separable models/kepler.lag
check "a total derivative in L changes nothing" separable tests/exec/models/gauge.lag
check "the double pendulum is not: its mass matrix varies" not_separable models/double_pendulum.lag
check "a magnetic field is not: velocities enter" not_separable tests/exec/models/magnet.lag

for m in symplectic_euler verlet verlet4 verlet6 verlet8; do
  check "$m on the pendulum is explicit" says "explicit steps, the model is separable" models/pendulum.lag --method $m --step 1e-3 --until 1
  check "$m on the double pendulum is implicit" says "implicit steps.*the mass matrix varies" models/double_pendulum.lag --method $m --until 1
  check "$m in a magnetic field is implicit" says "implicit steps.*forces depend on velocities" tests/exec/models/magnet.lag --method $m
  check "$m refuses states" refused "a model with states" tests/exec/models/motor.lag --method $m
done
check "dissipation is a force that depends on velocities" says "implicit steps" models/spring.lag damped --method verlet
check "and ends what symplectic means" says "symplectic for conservative models" models/spring.lag damped --method verlet
check "without it the same model is separable" says "explicit steps" models/spring.lag free --method verlet
# The impulse of a constraint is guessed from those of the steps before: 3.1 systems a step; 5.3 without.
printf "model rod\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 - 9.81*y\nconstraint rod: x^2 + y^2 = 1\nscene s { start x = 1; span 10 [s] }\n" >"$TMP/rod.lag"
systems() { "$LAGC" run "$@" | sed -n 's/.*corrections a system, \([0-9.]*\) systems a step.*/\1/p'; }
near "systems a step on a rod" 0.7 3.1 "$(systems "$TMP/rod.lag" --method 'variational(step=0.01)')"
for m in variational gauss 'variational(order=8)' 'gauss(stages=4)'; do
  check "$m on the double pendulum" says "corrections a system, 1 systems a step" models/double_pendulum.lag --method "$m" --until 1
  check "$m with forces" says "energy balance" models/spring.lag damped --method "$m" --until 1
done
wrong() { # wrong WORDS ARGS...
  words=$1
  shift
  run models/pendulum.lag "$@"
  [ $? = 2 ] && grep -qF -e "$words" "$TMP/err"
}
check "options of methods" says "variational(step=0.1, order=4)" models/pendulum.lag --method 'variational(order=4)' --step 0.1
check "also in front of a scene" says "gauss(step=0.1, stages=3)" models/pendulum.lag --method 'gauss(stages=3)' --step 0.1 wide
check "a method without them says so" wrong 'method rk45 has no option "order": it has step, max_step, ' --method 'rk45(order=4)'
check "reports write the tolerance like an option" wrong 'has no option "tol": the tolerance stands apart, --tol' --method 'rk45(tol=1e-8)'
check "an odd order is refused" wrong "order = 3: it is a number from 2 to 8 in steps of 2" --method 'variational(order=3)'
check "half a stage is refused" wrong "stages = 1.5: it is a whole number from 1 to 4" --method 'gauss(stages=1.5)'
# Failures of steps that are far too long: the message names the failure, the step, and a remedy.
fails() { # fails WORDS ARGS...
  words=$1
  shift
  run "$@"
  [ $? = 3 ] && grep -q -e "$words" "$TMP/out" "$TMP/err"
}
check "Newton's method does not converge" fails 'in a step of 0.5 s Newton.s method did not converge in 25 corrections, the residual is .* of its terms; take smaller steps\|energy is off by' \
  models/double_pendulum.lag --method verlet --step 0.5
check "it leads to where there are no numbers" fails 'in a step of 1e+100 s Newton.s method leaves the domain of the model, the residual is .* of its terms; take smaller steps' \
  models/chain.lag --method verlet --step 1e100
slow check "or the motion does, in steps that all succeed" fails "energy is off by .* caused\|no finite value (of its energy: .*); steps of 20 s may be too long for it: take smaller ones" \
  models/foucault.lag --method verlet --step 20
check "gauss of models with states says the step" fails "in a step of 0.5 s Newton's method did not converge" models/lorenz.lag --method gauss --step 0.5
# x reaches 0, where L ends, at t = sqrt(pi/2) e^(1/2) erfc(1/sqrt(2)) = 0.65568 (from x'^2 = 1 - 2 log x); past it the force 1/x goes on.
cat >"$TMP/slide.lag" <<'EOF'
model slide
coord x [m]
param m = 1 [kg] > 0, k = 1 [J] > 0, l = 1 [m] > 0
lagrangian = m/2*x'^2 - k*log(x/l)
scene fall { start x = 1, x' = -1; span 5 [s] }
EOF
for m in 'rk4(step=0.01)' 'symplectic_euler(step=0.01)' 'verlet(step=0.01)' 'verlet8(step=0.01)' 'rk45(step=0.01, adapt=off)' \
  'dop853(step=0.01, adapt=off)' 'taylor(step=0.01, adapt=off)'; do
  check "$m does not go on where L has ended" fails "left its domain (a pole of x'', which no motion crosses); steps of 0.01 s may be too long.* last good state, t = 0.6[4-6] s: x = 0.0" \
    "$TMP/slide.lag" --method "$m"
done
# With constraints no poles are looked for: the energy tells.
sed 's/^coord x/coord y [m], x/; s/m\/2\*x/m\/2*y'"'"'^2 + &/; /^scene/i constraint flat: y = 0' "$TMP/slide.lag" >"$TMP/held.lag"
for m in 'rk4(step=0.01)' ${SLOW:+'rk45(step=0.01, adapt=off)' 'verlet(step=0.01)'}; do
  check "with a constraint $m does not go on there" fails 'no finite value (of its energy: the motion has left the domain of L); steps of 0.01 s may be too long.* last good state, t = 0.6[4-6] s: y = 0, x = 0.0' \
    "$TMP/held.lag" --method "$m"
done
check "nor does the last row lie beyond" fails 'of its energy: the motion has left the domain of L' "$TMP/held.lag" --method 'rk4(step=0.5)' --until 0.9
check "what was no number at first is not waited for" says "energy: not finite" "$TMP/slide.lag" --method 'rk4(step=0.01)' x=-1 --until 1

# ---- derivatives that only some methods need
built() { # built METHOD: the simulator of the double pendulum, built for it
  "$LAGC" build models/double_pendulum.lag -o "$TMP/sim" ${1:+--method "$1"}
}
sim() { "$TMP/sim" "$@" >"$TMP/out" 2>"$TMP/err"; }
built ''
check "a simulator has its default methods" sim --until 1
sim --method gauss --until 1
is "one that it was built without ends with status 2" 2 $?
check "and the command that builds it in" grep -q 'lagc build MODEL --method gauss' "$TMP/err"
built gauss
check "built with --method it runs" sim --method gauss --until 1
check "and any other that needs the same" sim --method verlet --until 1
for command in emit build; do
  "$LAGC" $command models/double_pendulum.lag -o "$TMP/none" --method verlte 2>"$TMP/err"
  is "$command --method: one that there is not ends with status 2" 2 $?
  check "and is told from one that there is" grep -q 'unknown method verlte; did you mean verlet?' "$TMP/err"
done
# Every listed method finds the functions that it needs in a program.
run models/double_pendulum.lag --method help
for m in $(sed -n 's/^  \([a-z][a-z0-9_-]*\) .* \(adaptive\|fixed\) .*/\1/p' "$TMP/out"); do
  case $m in wisdom_holman) of=kepler ;; *) of=double_pendulum ;; esac
  check "$m has what it needs" run models/$of.lag --method "$m" --until 0.01
done
# A state goes on with the method it was saved with, whatever is in the cache.
run models/double_pendulum.lag --method gauss --step 1e-3 --until 1
grep '^  th' "$TMP/out" >"$TMP/whole"
run models/double_pendulum.lag --method gauss --step 1e-3 --until 0.5 --save-state "$TMP/half"
run models/double_pendulum.lag --resume "$TMP/half" --until 1
grep '^  th' "$TMP/out" >"$TMP/resumed"
check "a resumed run needs no --method" cmp "$TMP/resumed" "$TMP/whole"
check "a push with explicit time is allowed, and the report says what that costs" \
  says "symplectic for conservative models" tests/exec/models/gauge.lag pushed --method verlet4
says "reached" tests/exec/models/gauge.lag go --method verlet4
check "no such note on a conservative model" sh -c "! grep -q 'symplectic for' '$TMP/out'"
check "dop853 on the double pendulum" says "energy drift: [0-9.]*e-1" models/double_pendulum.lag --method dop853 --tol 1e-12
check "steps of equal size by an adaptive method" says "steps 100, rejected 0" models/pendulum.lag --method "rk45(step=0.1, adapt=off)" --until 10
# 0.1 is not a binary fraction: summed a hundred times without compensation it falls short of 10 by rounding, and another step is taken.
for o in 'taylor(adapt=off, step=0.1)' 'taylor(order=2, adapt=off, step=0.1)' 'rk4(step=0.1)' 'rk45(adapt=off, step=0.1)' 'verlet(step=0.1)' \
  'gauss(step=0.1)' 'radau(adapt=off, step=0.1)'; do
  check "$o: 100 steps to 10 s, no rest of rounding's size" says "^steps 100," models/pendulum.lag --method "$o" --until 10
done
check "whose sines a run took" says '"math": "sin and cos: lag_math.h", "build": ".*-ffp-contract=off' models/pendulum.lag --until 1 --json --compile always
check "or the C library's" says '"math": "sin and cos: the C library.*", "build": ".*-ffp-contract=off' models/pendulum.lag --until 1 --math libm --json --compile always
check "and that nothing was compiled" says '"math": "sin and cos: lag_math.h", "build": "evaluated by liblag"' models/pendulum.lag --until 1 --json --compile never
check "for those who ask" sh -c "'$LAGC' run models/pendulum.lag --until 1 >'$TMP/out' && ! grep -q 'arithmetic\|sin and cos' '$TMP/out'"

# ---- the table
"$LAGC" methods >"$TMP/table"
"$LAGC" run models/pendulum.lag --method help >"$TMP/help"
check "lagc methods is what --method help says" cmp "$TMP/table" "$TMP/help"
check "with order, what is kept and what is needed" grep -q '^  gauss  *2-8  *2-8  *fixed  *both  *yes  *alone  *yes  *no$' "$TMP/table"
"$LAGC" methods models/pendulum.lag 2>"$TMP/err"
is "lagc methods takes no model" 2 $?
# A body at rest without forces stays at rest, to the last bit; wisdom_holman takes bodies that fall towards others.
printf "model rest\ncoord x\nlagrangian = x'^2/2 - x^2/2\nscene s { start x = 0; span 1 [s] }\n" >"$TMP/rest.lag"
for m in $(sed -n 's/^  \([a-z][a-z0-9_-]*\)  *[0-9][-0-9]*  *[0-9].*/\1/p' "$TMP/table" | grep -vx wisdom_holman); do
  is "$m leaves a body at rest" "1,0,0" "$("$LAGC" run "$TMP/rest.lag" --method "$m" -o - --quiet 2>"$TMP/err" | tail -n 1 | cut -d, -f1-3)"
done
# A state that begins at 0 and relaxes within 1e-6 of the run has the tolerance of its own size, not of its first rate times the run:
# a' = -k (a - cos(t)) is (k^2 cos(t) + k sin(t))/(k^2 + 1) behind the first 1e-4 s.
printf "model relaxes\nstate a\nparam k = 1e5\nflow a' = -k*(a - cos(t))\nscene s { start a = 0; span 1; tolerance 1e-8 }\n" >"$TMP/relaxes.lag"
for m in dop853 rk45 radau; do
  check "$m has the digits of a state that begins at 0" close_to "$("$LAGC" run "$TMP/relaxes.lag" --method $m --every 1 -o - --quiet 2>"$TMP/err" | tail -n 1 | cut -d, -f2)" 0.54031072 1e-7
done
tap_end
