#!/bin/sh
# Outputs `action(x)`: values against closed forms and mpmath's elliptic integrals, along runs that keep J, and that do not; other precisions, lanes, headers; what is refused.
. tests/tap.sh

# value FILE SCENE MEASURE ARGUMENT...: the value of a measure, in 17 digits.
value() { f=$1 s=$2 m=$3; shift 3; "$LAGC" run "$TMP/$f.lag" "$s" --measure "$m" --json --quiet "$@" 2>&1 | sed -n 's/.*"measures": {[^}]*: \([^,}]*\)}.*/\1/p'; }

# ---- values ----
cat >"$TMP/pendulum.lag" <<'END'
model pendulum
coord th periodic
param m = 2 > 0, l = 0.7 > 0, g = 9.81 > 0, a = 0, b = 0
lagrangian = m/2*l^2*th'^2 + m*g*l*cos(th) + (a + b*cos(th))*th'
observe J = action(th)
observe more = 1 + action(th)
scene s { output J, more every 1; start th = 2; span 10; tolerance 1e-14; method taylor }
scene round { output J every 1; start th' = 20; span 10; tolerance 1e-14; method taylor }
END
# 1e-13: E - V loses two digits near the turning points, and the run 1e-14 of the energy. (8/pi) m l^2 w0 (E(k) - (1 - k^2) K(k)), k = sin(th0/2)
near "a pendulum" 1e-13 5.86192359470219384785 "$(value pendulum s 'J(0)')"
near "at the end of a run" 1e-13 5.86192359470219384785 "$(value pendulum s 'J(10)')"
near "p = m l^2 th' + a + b cos(th) is put in for the momentum" 1e-13 5.86192359470219384785 "$(value pendulum s 'J(10)' a=3 b=2)"
# (2/pi) sqrt(2 m l^2 (E + m g l)) E(k), k^2 = 2 m g l/(E + m g l)
near "going round" 1e-13 18.8941134266863135722 "$(value pendulum round 'J(10)')"
near "the other way: the mean of p has its sign" 1e-13 -18.8941134266863135722 "$(value pendulum round 'J(10)' "th'=-20")"
near "the mean of p has that of a + b cos(th)" 1e-13 21.8941134266863135722 "$(value pendulum round 'J(10)' a=3 b=2)"
near "the way round is that of p - b, where p has the sign of b" 1e-12 -18.8941134266863135722 "$(value pendulum round 'max(J)' b=200 "th'=-20")"
near "constant along the run" 1e-12 0 "$(value pendulum s 'drift(J)')"
near "also going round" 1e-12 0 "$(value pendulum round 'drift(J)')"
near "in an expression" 1e-13 6.86192359470219384785 "$(value pendulum s 'more(0)')"

cat >"$TMP/kepler.lag" <<'END'
model kepler
coord r, th periodic
param m = 1.5 > 0, k = 2 > 0
lagrangian = m/2*(r'^2 + r^2*th'^2) + k/r
observe Jr = action(r)
observe Jth = action(th)
scene s { start r = 1, th' = 1.3, r' = 0.2; span 20; tolerance 1e-14; method taylor; output Jr, Jth every 5 }
END
# -L + k sqrt(m/(2 |E|)); m l^2 th'
near "two coordinates, that separate" 1e-12 0.116509770954871941994 "$(value kepler s 'Jr(20)')"
near "and one that is cyclic" 1e-13 1.95 "$(value kepler s 'Jth(20)')"

# E(t + T) = E(t) exp(-2 gamma T) after whole turns T of the damped motion, here three; J = E/w at every moment.
cat >"$TMP/damped.lag" <<'END'
model damped
coord x
param w = 2 > 0, gamma = 0.1, mu = 0
input shift = 0
let wd = sqrt(w^2 - gamma^2)
lagrangian = x'^2/2 - w^2*x^2/2 + shift*x
force x = -2*gamma*x' - mu*sign(x')
observe J = action(x)
scene s { start x = 1; span 9.43658106866400514; tolerance 1e-14; method dop853; output J, energy every 1 }
scene beside "inputs, a mode and closed forms stand before actions" { start x = 1; span 3; exact x = x(0)*exp(-gamma*t)*(cos(wd*t) + gamma/wd*sin(wd*t)); output error(x), J, energy every 1 }
END
near "drag is no part of H" 1e-12 0.151477797832447947204 "$(value damped s 'J(end)/J(0)')"
near "J = E/w" 1e-13 2 "$(value damped s 'energy(3)/J(3)')"
near "beside inputs, modes and closed forms" 1e-13 2 "$(value damped beside 'energy(3)/J(3)' mu=1e-3)"
near "inputs are held: about 1, to which the input pulls, it rests" 1e-13 0 "$(value damped s 'J(0)' shift=4)"
near "and about 2 it swings by 1" 1e-13 1 "$(value damped s 'J(0)' shift=8)"

# ---- adiabatic invariance ----
# w^2 from w1^2 to w2^2 by tanh(r t): J_out/J_in - 1 is a constant and a function of twice the phase, so four phases, 45 degrees apart, have the mean of all.
cat >"$TMP/slow.lag" <<'END'
model slow
coord x
momentum p of x
param w1 = 1 > 0, w2 = 2 > 0, r = 1 > 0, phase = 0
let w = sqrt((w1^2 + w2^2)/2 + (w2^2 - w1^2)/2*tanh(r*(t - 20)))
hamiltonian = p^2/2 + w^2*x^2/2
observe J = action(x)
scene s { start x = cos(phase), p = sin(phase); span 40; tolerance 1e-14; method taylor; output J, x every 10; measure kept = J(40)/J(0) }
END
jump() {
  "$LAGC" sweep "$TMP/slow.lag" "phase=0..$(awk 'BEGIN { printf "%.17g", 3*atan2(1, 1) }'):4" "r=$1" -o - 2>"$TMP/told" | awk -F, '$2 ~ /^[0-9]/ { n++; sum += $2 } END { if (n == 4) printf "%.15g", sum/4 - 1 }'
}
expected() { awk -v r="$1" 'function sinh(x) { return (exp(x) - exp(-x))/2 } BEGIN { pi = 3.14159265358979324; printf "%.15g", 2*sinh(pi/(2*r))^2/(sinh(pi/r)*sinh(2*pi/r)) }'; }
# 1e-12: 40 units of time at a tolerance of 1e-14
near "the mean jump of a slow oscillator" 1e-12 "$(expected 1)" "$(jump 1)"
near "of a faster one" 1e-12 "$(expected 2)" "$(jump 2)"
check "sweeps do so in lanes" grep -q 'at once in lanes' "$TMP/told"
for precision in ${PRECISIONS:-}; do
  near "in $precision" 1e-15 0.5 "$("$LAGC" run "$TMP/slow.lag" --precision "$precision" --until 1 -o - 2>/dev/null | sed -n '2s/^0,\([^,]*\),.*/\1/p')"
done
check "lagc plot --y J --y energy" "$LAGC" plot "$TMP/slow.lag" --y J --y energy -o "$TMP/slow.svg"
check "the picture has both" sh -c 'grep -q ">J<" "$0" && grep -q ">energy<" "$0"' "$TMP/slow.svg"

# ---- no value ----
cat >"$TMP/morse.lag" <<'END'
model morse
coord x
momentum p of x
hamiltonian = p^2/2 + 2*(1 - exp(-1.3*x))^2
observe J = action(x)
scene s { start p = 2.5; span 1; output J every 0.5 }
END
run_text() { "$LAGC" run "$@" -o /dev/null 2>&1; }
has() { words=$1; shift; "$@" >"$TMP/out" 2>&1; grep -q -F -e "$words" "$TMP/out" || { cat "$TMP/out"; false; }; }
check "a molecule that breaks: the report says which rows have none" has "the output J has no finite value at t = 0 s; the same in 3 of 3 rows" run_text "$TMP/morse.lag"

# ---- headers ----
check "headers leave it out, with a warning" has "the output \`J\` is left out: liblag computes action variables" "$LAGC" header "$TMP/slow.lag" -o "$TMP/slow.h"
check "and a remark" grep -q 'Those with closed forms or action variables.*left out' "$TMP/slow.h"
check "the momentum of a cyclic coordinate stays" sh -c '"$0" header "$1" 2>/dev/null | grep -q OUT_JTH' "$LAGC" "$TMP/kepler.lag"

# ---- refused ----
# refused WORDS LINE: the statement in a model whose coordinates do not separate; the place is shown by a caret.
refused() {
  printf 'model bad\ncoord x, y, n\nparam k = 1\nlagrangian = (x'"'^2 + y'^2 + n'^2"')/2 - x^2*y^2 - k*x^2\n%s\nscene s { start x = 1; %s }\n' "$2" "${3:-}" >"$TMP/bad.lag"
  "$LAGC" run "$TMP/bad.lag" >"$TMP/out" 2>&1
  grep -q -F -e "$1" "$TMP/out" && grep -q 'bad.lag:[56]:' "$TMP/out" && grep -q '\^' "$TMP/out" || { cat "$TMP/out"; false; }
}
check "two coordinates that are tied" refused "\`y\` has no action variable: H does not separate in these coordinates: Levi-Civita's condition for x and y fails" "" "output action(y)"
check "a cyclic one that is no angle" refused "\`n\` has no action variable: it is cyclic, and not declared periodic" "" "output action(n)"
check "of a name that is no coordinate" refused "\`action\` takes the name of a coordinate, and \`k\` is none" "observe J = action(k)" "output J"
check "of a momentum" refused "and \`p_x\` is none" "observe J = action(p_x)" "output J"
check "of an expression" refused "and \`x + y\` is an expression" "observe J = action(x + y)" "output J"
check "of an unknown name" refused "unknown name \`w\`" "observe J = action(w)" "output J"
check "in a let, a potential" refused "cannot stand in the equations" "let U = action(x)"
check "in a force" refused "cannot stand in the equations" "force x = action(x)"
check "in an event" refused "cannot stand in the equations" "event e: action(x) - 1 { stop }"
check "in a claim" refused "has its value in a run only" "expect action(x) = 1"
check "in a claim by its name" refused "has its value in a run only" "observe J = action(x)
expect J = 1"
check "its rate" refused "a time derivative of the energy, a charge or an action" "observe J = (action(x))'" "output J"
check "constraints" has "an action variable needs a phase space, as brackets do: brackets of a model" "$LAGC" run models/cartesian_pendulum.lag --observe 'action(x)'
tap_end
