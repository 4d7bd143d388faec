#!/bin/sh
# Constraints that hold while a condition is true: what is refused, commands, methods, and cases with closed forms. Models have facts of their own
# (models/rope_catch, latch, rimless_wheel, compass_walker).
. tests/tap.sh
model() { printf '%s\n' "model m" "$@" >"$TMP/m.lag"; }
run() { "$LAGC" run "$TMP/m.lag" "$@" --json >"$TMP/out.json"; }
ends() { sed 's/.*"final": {\([^}]*\)}}$/\1/' "${1:-$TMP/out.json}"; }
final() { ends | tr ',' '\n' | sed -n 's/^ *"'"$1"'": *//p'; }

# ---- a clutch: two wheels, of which the first is driven. While they slip nothing acts; from 1 s to 2 s they turn as one.
clutch() {
  model 'coord a [rad], b [rad]' 'param I = 1 [kg*m^2] > 0, J = 2 [kg*m^2] > 0, M = 0.1 [N*m]' \
    "kinetic = I/2*a'^2 + J/2*b'^2" 'force a = M' "constraint clutch: a' = b' while $1" \
    "scene s { start a' = 3; span 3 [s]; output a', b', lambda(clutch) every 0.5 [s] }"
}
# rates: 3.1 at 1 s, shared 3.1/3, driven 0.1/3 more in 1 s, then a alone by 0.1
for method in rk45 dop853 radau rk4 verlet variational moreau; do
  clutch 't > 1 [s] and t < 2 [s]'
  run --method $method
  near "clutch by $method: a'" 1e-7 1.1666666666666667 "$(final "a'")"
  near "clutch by $method: b'" 1e-7 1.0666666666666667 "$(final "b'")"
done
run
# loss: I J/(I + J)/2 (3.1)^2; tolerance: rounding of energies of 5 J
near "the energy of the impact has its own entry" 1e-11 -3.2033333333333333 "$(sed -n 's/.*"at_events": \([^,]*\).*/\1/p' "$TMP/out.json")"
check "and its own line" says 0 'impacts and events: -3.20333 J of energy' "$LAGC" run "$TMP/m.lag"
near "the balance has no drift" 1e-12 0 "$(sed -n 's/.*"drift_absolute": \([^,]*\).*/\1/p' "$TMP/out.json" | head -n 1)"
near "torque of the clutch: J M/(I + J)" 1e-9 -0.066666666666666667 "$("$LAGC" run "$TMP/m.lag" --until 1.5 --json | sed -n 's/.*"lambda(clutch)": \([^,]*\).*/\1/p' | tail -n 1)"
clutch 'not (t <= 1 [s] or t >= 2 [s])'
run
near "not and or" 1e-7 1.1666666666666667 "$(final "a'")"
clutch "a' - 2*b' > 3.05 [rad/s]"
check "a condition that the impulse ends ends the run" says 3 'can neither hold nor not hold: its own impulse makes its condition false' "$LAGC" run "$TMP/m.lag" --quiet

# ---- balances: a constraint that moves does work while it holds, and its force counts in the balance of a symmetry
number() { sed 's/.*"'"$1"'": {"is[^}]*"'"$2"'": \([^,]*\).*/\1/' "$TMP/out.json"; }
model 'coord x [m]' "kinetic = x'^2/2 * 1 [kg]" "constraint pull: x' = 1 [m/s]*cos(t/(1 [s])) while t > 1 [s]" 'symmetry shift(s): x -> x + s' \
  'scene s { span 4 [s]; tolerance 1e-12 }'
run
near "energy put in at the switch: cos(1)^2/2" 1e-12 0.14596329086321442 "$(number energy at_events)"
near "work of the moving constraint: (cos(4)^2 - cos(1)^2)/2" 1e-9 0.06766170068463225 "$(number energy work)"
near "nothing drifts" 1e-9 0 "$(number energy drift_absolute)"
near "force of the constraint in the balance of the momentum: cos(4) - cos(1)" 1e-9 -1.1939459267317516 "$(number shift work)"
near "which does not drift either" 1e-9 0 "$(number shift drift_absolute)"

model 'coord x [m], y [m]' "kinetic = (x'^2 + y'^2)/2 * 1 [kg]" 'potential = 1 [N]*y' "constraint rod: x*x' + y*y' = 0 while t > 1/2 [s]" \
  'scene s { start x = 1, y = 1/8; span 20 [s]; output x^2 + y^2 every 1 [s] }'
run --method rk4 --step 0.05
near "a demand on velocities holds the positions that it finds: y(1/2) = 0, so that the length is 1" 1e-13 1 "$(ends | sed 's/.*"x^2 + y^2": //')"

# ---- the state at a switch
model 'coord x [m]' "kinetic = x'^2/2 * 1 [kg]" 'constraint stop: x = 1 [m] while t > 2 [s]' 'scene s { start '"x'"' = 1; span 4 [s] }'
check "positions do not jump" says 3 'begins to hold at t = 2 s, where it is off by 1 m' "$LAGC" run "$TMP/m.lag" --quiet
run "x'=0.5"
near "met where it begins" 1e-12 1 "$(final x)"
near "at rest" 1e-12 0 "$(final "x'")"
model 'coord x [m]' "kinetic = x'^2/2 * 1 [kg]" 'constraint stop: x = 1 [m] while t < 2 [s]' 'scene s { start x = 1; span 4 [s]; output x every 0.1 [s] }' \
  'force x = 1 [N]'
run
near "from the start, and then free" 1e-9 3 "$(final x)"
check "a start that is off is moved" says 0 'start moved to the constraints: x from 0.9 to 1 m' "$LAGC" run "$TMP/m.lag" x=0.9
sed -i 's/t < 2 \[s\]/t > -0.5 [s]/' "$TMP/m.lag"
check "not backwards over a switch" says 2 'ends a run backwards in time' "$LAGC" run "$TMP/m.lag" --until -1
in_two() { # the parts of a run are the run
  "$LAGC" run "models/$1.lag" --until "$2" --save-state "$TMP/s.state" --quiet >/dev/null &&
    "$LAGC" run "models/$1.lag" --resume "$TMP/s.state" --json >"$TMP/b.json" && "$LAGC" run "models/$1.lag" --json >"$TMP/a.json" &&
    [ "$(ends "$TMP/a.json")" = "$(ends "$TMP/b.json")" ]
}
check "a latch in two parts" in_two latch 1
check "a wheel in two parts" in_two rimless_wheel 3.3
check "a rope in two parts" in_two rope_catch 0.8

# ---- a rope is a contact that does not bounce
model 'coord x [m], y [m]' "kinetic = (x'^2 + y'^2)/2 * 1 [kg]" 'potential = 9.81 [N]*y' 'contact rope: 1 [m] - hypot(x, y) >= 0, restitution = 0' \
  'scene s { start x = 0.6; span 2 [s] }'
run
cp "$TMP/out.json" "$TMP/contact.json"
near "the error is known over the jerk" 1e-8 0 "$(sed 's/.*"error": \([^,]*\).*/\1/' "$TMP/out.json")"
sed -i 's/^contact.*/constraint rope: 1 [m] = hypot(x, y) while lambda(rope) > 0/' "$TMP/m.lag"
run
is "to the last digit" "$(ends "$TMP/contact.json")" "$(ends)"
sed -i 's/lambda(rope) > 0/lambda(rope) < 0/' "$TMP/m.lag"
check "the other sign" says 1 'positive with the sides exchanged' "$LAGC" check "$TMP/m.lag"

# ---- by moreau: conditions are events, constraints that hold are projected, beside impulses of contacts
# Two blocks on a rough floor; a hook joins them from 0.1 s to 0.5 s, and from 0.45 s on the first is pulled by F = 6 N. With a = mu g: the impact leaves (5 - 0.1 a)/4, after 0.2 m
# the wall turns what is left round, half of it; back to rest in two parts by a and a + F/4; at last (F - a)(1.1)^2/2 of the first alone.
cat >"$TMP/hook.lag" <<'EOF'
model hook
coord x[2] [m], y[2] [m]
param m = 1 [kg] > 0, M = 3 [kg] > 0, g = 9.81 [m/s^2], mu = 0.2 >= 0, e = 0.5
kinetic = m/2*(x[1]'^2 + y[1]'^2) + M/2*(x[2]'^2 + y[2]'^2)
potential = m*g*y[1] + M*g*y[2]
force x[1] = if(t > 0.45 [s], 6 [N], 0)
contact wall: x[2] <= 0.3 [m], restitution = e
for i in 1..2 { contact floor[i]: y[i] >= 0, restitution = 0, friction = mu, slip = x[i]' }
constraint hook: x[1]' = x[2]' while t > 0.1 [s] and t < 0.5 [s]
scene s { start x[1]' = 5, x[2] = 0.1; span 1.6 [s]; tolerance 1e-11 }
EOF
hook() { "$LAGC" run "$TMP/hook.lag" "$@" --json >"$TMP/out.json"; }
hook
near "a hook between blocks that rub, by events" 1e-12 0.2594191928363571 "$(final 'x\[2\]')"
# the impact is off by at most half a step's path, 1.2 h/2, before and after: order 1
for h in 2e-3 2e-4 2e-5; do
  hook --method "moreau(step=$h)"
  near "by moreau, h = $h" "$(awk "BEGIN { print 1.2*$h }")" 0.2594191928363571 "$(final 'x\[2\]')"
  near "and the rate of the other" 1e-9 4.4418 "$(final "x\[1\]'")"
done
hook --method moreau
near "by the tolerance" 1e-6 0.2594191928363571 "$(final 'x\[2\]')" # a 256th of 1.6e-4 s
# no gap, order 2: the wheel's pins are events of the model, its motion that of a pendulum. dop853 has 1e-10 of it (models/rimless_wheel.facts)
turns() { "$LAGC" run models/rimless_wheel.lag roll --json --quiet "$@" | sed -n "s/.*\"th\": \([0-9.]*\).*/\1/p" | tail -n 1; }
turns --tol 1e-12 >"$TMP/exact"
order() { awk -v a="$1" -v b="$2" -v x="$(cat "$TMP/exact")" 'BEGIN { r = (a - x)/(b - x); exit !(r > 90 && r < 110) }'; }
check "pins by moreau: order 2" order "$(turns --method 'moreau(step=2e-3)')" "$(turns --method 'moreau(step=2e-4)')"
check "no contact is reported where there is none" sh -c "! '$LAGC' run models/latch.lag --method 'moreau(step=1e-3)' --quiet | grep 'act at once'"
clutch 't < -0.5 [s]'
check "nor is one refused backwards" says 2 'that ends a run backwards in time' "$LAGC" run "$TMP/m.lag" --until -1 --method moreau "a'=1" --tol 1e-6 --quiet

# ---- commands
check "lagc check" says 0 'constraint bolt (line 13): holonomic, while its condition is true' "$LAGC" check models/latch.lag
check "lagc derive" says 0 'bolt.closed = if(0 < shut - 1/2, 1, 0)' "$LAGC" derive models/latch.lag
check "lagc noether" says 0 'charges are those of the motion without them' "$LAGC" noether models/latch.lag
check "lagc header" says 2 'a header has no constraints with `while` (bolt)' "$LAGC" header models/latch.lag -o "$TMP/h.h"
check "nothing is written" test ! -e "$TMP/h.h"
check "lagc fmu" says 2 'an FMU has no constraints with `while`' "$LAGC" fmu models/latch.lag -o "$TMP/f.fmu"
check "nothing is written" test ! -e "$TMP/f.fmu"
"$LAGC" modes models/latch.lag >"$TMP/out" 2>&1 # where the lid stands open: sqrt(k/I) = 5
check "lagc modes where the bolt does not act" grep -q '^ *2  5  .*th 1 rad' "$TMP/out"
check "and says so" grep -q 'constraints with `while`, do not act here' "$TMP/out"
check "lagc modes where it acts" says 2 'constraint bolt acts at the start' "$LAGC" modes models/latch.lag th=0 "th'=0" shut=1
check "lagc lyapunov: a lid let go falls back to where it is caught, without speed" says 3 'the motion only touches it' "$LAGC" lyapunov models/latch.lag
check "--tangent: what the bolt held goes on alike" says 0 '  th                             0                 0                 0' "$LAGC" run models/latch.lag --tangent
echo 'void f(double t, const double *y, double *d, const double *p) { d[0] = d[1] = d[2] = t + y[0] + p[0]; }' >"$TMP/f.c"
check "lagc verify" says 2 'those change where `bolt` begins to hold' "$LAGC" verify models/latch.lag --against "$TMP/f.c:f"
for method in taylor gsl-rk8pd; do
  case ${GSL:-}$method in gsl*) continue ;; esac
  check "$method names others" says 2 'rk45, dop853 and variational can' "$LAGC" run models/latch.lag --method $method
done
check "a sweep goes run by run" says 0 'one by one, since the model has contacts' "$LAGC" sweep models/latch.lag k=0.4,0.5 -o "$TMP/s.csv"
tap_end
