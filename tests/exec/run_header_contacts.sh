#!/bin/sh
# Contacts and dry friction in headers: steps by Moreau's method with the digits of `lagc run`, against closed forms in each scalar type, in C and C++, without variables; refusals.
. tests/exec/lib_motion.sh
here=tests/exec

model slope <<'END_OF'
model slope
coord x [m], y [m]
param m = 2 [kg] > 0, g = 9.81 [m/s^2] > 0, mu = 0.3, a = 0 [deg], e = 0, et = 0, c = 0 [N*s/m]
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*(x*sin(a) + y*cos(a))
force x = -c*x'
contact plane: y >= 0, restitution = e, friction = mu, slip = x', tangential = et
scene s { start x' = 3 [m/s]; method moreau(step = 0.001); span 4 [s] }
scene thrown { like s; start y = 0.5 [m]; span 30 [s]; e = 0.5; et = 0.4; c = 1 [N*s/m] }
END_OF
model puck <<'END_OF'
model puck
coord x [m], y [m], z [m], a [rad], b [rad]
param m = 2 [kg] > 0, r = 0.1 [m] > 0, g = 9.81 [m/s^2] > 0, mu = 0.2 >= 0
kinetic = m/2*(x'^2 + y'^2 + z'^2) + m*r^2/5*(a'^2 + b'^2)
potential = m*g*z
contact floor: z >= 0, restitution = 0.3, friction = mu, slip = (x' - r*b', y' + r*a')
scene falls { start x' = 3 [m/s], y' = 1 [m/s], a' = 20 [rad/s], z = 0.1 [m]; span 10 [s] }
scene rolls { span 3 [s] }
END_OF
model wall <<'END_OF'
model wall
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2], l = 1 [m] > 0, e = 0
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*y
constraint rod: x^2 + y^2 = l^2
contact wall: x >= 0.2 [m], restitution = e
scene swing { start x = 0.4 [m], y = -0.9 [m]; span 30 [s] }
scene bounces { like swing; start x' = -1 [m/s]; e = 1; span 15 [s] } # for 300 steps it does not turn, where its velocity is rounding
END_OF
model hoop <<'END_OF'
model hoop
coord x [m], y [m]
param m = 1 [kg] > 0, R = 1 [m] > 0, w = 2 [rad/s], a = 0.1 [m]
kinetic = m/2*(x'^2 + y'^2)
contact wall: R + a*sin(w*t) - sqrt(x^2 + y^2) >= 0, restitution = 0.5, friction = 0.1, slip = (x*y' - y*x')/R
scene s { start x = 0.99 [m], y' = 3 [m/s]; span 5 [s] }
END_OF
model tower <<'END_OF'
model tower
const N = 8
coord x[N] [m], y[N] [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, h = 0.1 [m] > 0, mu = 0.5 >= 0, a = 0.3
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2)) + m/20*x[1]'*x[2]'
potential = sum(i in 1..N, m*g*(y[i] - a*x[i]))
let X[0] = 0 [m]
let X[i in 1..N] = x[i]
let Y[0] = 0 [m]
let Y[i in 1..N] = y[i]
for i in 1..N { contact c[i]: Y[i] - Y[i-1] >= h, restitution = 0.2, friction = mu, slip = X[i]' - X[i-1]' }
scene drop { start y[i in 1..N] = i*h + i*0.01 [m]; span 10 [s] }
END_OF
model gate <<'END_OF'
model gate
coord x [m]
state z
param k = 4 [N/m]
input F [N] = 0.5 [N]*sin(3 [rad/s]*t)
kinetic = 1 [kg]/2*x'^2
potential = k/2*x^2
force x = F - z*1 [N]
flow z' = (x/1 [m] - z)/0.1 [s]
contact stop: x + 0.1 [m] >= 0, restitution = 0.6
scene s { start x = 0.3 [m]; span 40 [s] }
END_OF

# ---- the digits of `lagc run`
digits() { # FILE SCENE
  n=$(basename "$1" .lag) upper=$(basename "$1" .lag | tr '[:lower:]' '[:upper:]')
  "$LAGC" header "$1" "$2" --with moreau --prefix "$n" -o "$TMP/$n.$2.h" && "$LAGC" emit "$1" "$2" --method moreau -o "$TMP/$n.c" || return 1
  scene=$(sed -n 's/^const lag_scene \(.*\) = {/\1/p' "$TMP/$n.c" | head -n 1)
  "$CC" -std=c11 -O0 -ffp-contract=off "-DM=$n" "-DU=$upper" "-DSCENE=$scene" -DMETHOD=moreau -DORDER=0 "-DNEAR=${near:-0}" -DADAPTIVE=0 -DSTART= "-DSTEP=JOIN(M, _moreau_step)(&p, &s, opt[0].value${inputs-, 0})" \
    "-DHEADER=\"$n.$2.h\"" "-D${upper}_IMPLEMENTATION" -iquote "$TMP" -I"$INC" $here/embed_digits.c "$TMP/$n.c" "$BUILD/liblag.a" -lm -o "$TMP/digits" && "$TMP/digits" >"$TMP/log" 2>&1 &&
    grep -q '^300 steps, status 0$' "$TMP/log" || { cat "$TMP/log"; return 1; }
}
check "digits of a throw, with drag" digits "$TMP/slope.lag" thrown
check "of a ball with spin in space" digits "$TMP/puck.lag" falls
check "of a tower that falls together, its masses coupled" digits "$TMP/tower.lag" drop
check "of a bead inside a hoop that breathes" digits "$TMP/hoop.lag" s
sed 's/friction = mu,/friction = mu, static = 2*mu,/; s/^model slope/model held/' "$TMP/slope.lag" >"$TMP/held.lag"
check "of a throw that static friction ends" digits "$TMP/held.lag" thrown
check "with a state and an input, without friction" digits "$TMP/gate.lag" s
model bouncy <<'END_OF'
model bouncy
coord y [m]
lagrangian = 1 [kg]/2*y'^2 - 9.81 [N]*y
contact floor: y >= 0, restitution = min(1, 0.8*(abs(y')/(1 [m/s]))^(-1/4))
scene s { start y = 1 [m]; span 40 [s] }
END_OF
check "with a restitution of the speed" digits "$TMP/bouncy.lag" s
slow check "of a superball" digits models/superball.lag thrown
near=200 # _hold ends its iteration by a simpler rule than the runtime
check "beside a constraint, to rounding" digits "$TMP/wall.lag" bounces

# ---- closed forms
"$LAGC" header "$TMP/slope.lag" s -o "$TMP/slope.h" && "$LAGC" header "$TMP/puck.lag" rolls -o "$TMP/puck.h" && "$LAGC" header "$TMP/wall.lag" swing --with moreau -o "$TMP/wall.h"
strict='-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wundef -Werror'
closed_forms() { "$@" -O0 -iquote "$TMP" $here/embed_contacts.c -lm -o "$TMP/contacts" && "$TMP/contacts"; }
# shellcheck disable=SC2086
check "closed forms" closed_forms "$CC" -std=c99 $strict -DREAL=double -DNEAR=1e-14
slow check "long double" closed_forms "$CC" -std=c99 '-DREAL=long double' -DNEAR=1e-14
check "float" closed_forms "$CC" -std=c99 -DREAL=float -DNEAR=1e-6
if command -v "${CXX:-g++}" >/dev/null; then
  # shellcheck disable=SC2086
  check "C++17" closed_forms "${CXX:-g++}" -x c++ -std=c++17 $strict -DREAL=double -DNEAR=1e-14
else
  skip "C++17" "there is no C++ compiler"
fi
no_data() {
  printf '#define SLOPE_IMPLEMENTATION\n#include "slope.h"\n' >"$TMP/one.c"
  "$CC" -std=c99 -O0 -fno-pie -c "$TMP/one.c" -o "$TMP/one.o" && size "$TMP/one.o" | awk 'NR == 2 { print "data", $2, "bss", $3; exit !($2 == 0 && $3 == 0) }' && ! nm "$TMP/one.o" | grep -E ' U (malloc|calloc|free|memcpy)$'
}
check "no variables, no allocation" no_data

# ---- who has them
has() { grep -q "$1" "$2"; }
check "a header of contacts with friction follows them unasked" has 'int slope_moreau_step(' "$TMP/slope.h"
check "its example steps as the scene says" has 'slope_moreau_step(&p, &s, 0.001, NULL)' "$TMP/slope.h"
check "without friction the loop with events stays, unless asked" sh -c "$LAGC header $TMP/gate.lag | grep -q 'gate_rk4_step(&p, &s, 0.004, u)'"
check "models without contacts" says 2 'only of models with contacts or dry friction' "$LAGC" header models/pendulum.lag --with moreau -o "$TMP/none.h"

# ---- dry friction of joints and sliders
model spring <<'END_OF'
model spring
coord x [m]
param m = 1 [kg] > 0, k = 10 [N/m] > 0, R = 1 [N] >= 0
kinetic = m/2*x'^2
potential = k/2*x^2
friction rub on x: R
scene free { start x = 1.05 [m]; span 6 [s] }
scene turns { like free; span 200 [s] } # 300 steps to its rest
END_OF
model belt <<'END_OF'
model belt
coord x [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0, N = 1 [N] > 0, v = 0.2 [m/s], mu = 0.25 >= 0, mu_s = 0.4 >= 0
let slip = x - v*t
kinetic = m/2*x'^2
potential = k/2*x^2
friction rub on slip: mu*N, static = mu_s*N
scene squeak { start x' = v; span 20 [s] }
END_OF
model plank <<'END_OF'
model plank
coord x [m], y [m]
let slip = x - y
kinetic = 1 [kg]/2*x'^2 + 2 [kg]/2*y'^2
friction top on slip: 3 [N]
friction below on y: 1 [N]
scene s { start x' = 4 [m/s]; span 5 [s] }
scene stops { like s; span 100 [s] }
END_OF
model wire <<'END_OF'
model wire
coord x [m], y [m]
param R = 2 [N] >= 0
input F [N] = 0
kinetic = 1 [kg]/2*(x'^2 + y'^2)
potential = 10 [N]*y
constraint wire: y = 3/4*x
friction rub on x: R
force x = F
scene s { span 10 [s] }
END_OF
model ring <<'END_OF'
model ring
coord x [m], y [m]
kinetic = 1 [kg]/2*(x'^2 + y'^2)
potential = 10 [N]*y
constraint ring: x^2 + y^2 = 1 [m^2]
friction rub on x: 2 [N]
scene s { start x = 0.6 [m], y = -0.8 [m]; span 10 [s] }
END_OF
for n in spring belt plank wire ring; do "$LAGC" header "$TMP/$n.lag" --with moreau -o "$TMP/$n.h" || echo "# no header of $n"; done
dry() { "$@" -O0 -iquote "$TMP" $here/embed_friction.c -lm -o "$TMP/friction" && "$TMP/friction"; }
# shellcheck disable=SC2086
check "dry friction: closed forms" dry "$CC" -std=c99 $strict -DREAL=double -DNEAR=1e-14
slow check "long double" dry "$CC" -std=c99 '-DREAL=long double' -DNEAR=1e-14
slow check "float" dry "$CC" -std=c99 -DREAL=float -DNEAR=1e-5
if command -v "${CXX:-g++}" >/dev/null; then check "C++98" dry "${CXX:-g++}" -x c++ -std=c++98 -DREAL=double -DNEAR=1e-14
else skip "C++98" "there is no C++ compiler"; fi
model relay <<'END_OF'
model relay
state x, y
param a = 2
flow x' = y - a*sign(x)
flow y' = -x
scene s { start x = 1; span 5 }
scene slides { like s; span 50 }
END_OF
relay() { # x falls to 0 and slides there, y' = 0, as |y| < a
  cat >"$TMP/relay.c" <<'END_OF'
#define RELAY_IMPLEMENTATION
#include "relay.h"
int main(void) {
  relay_params p;
  relay_state s;
  relay_defaults(&p);
  relay_start(&p, &s);
  for (int i = 0; i < 5000; i++)
    if (relay_moreau_step(&p, &s, 1e-3) != RELAY_OK) return 2;
  return !(fabs(s.z[0]) < 1e-12 && s.touch[0] == RELAY_STICKS && fabs(2*s.mode[0] - s.z[1]) < 1e-12);
}
END_OF
  "$LAGC" header "$TMP/relay.lag" --with moreau -o "$TMP/relay.h" && "$CC" -std=c99 -O0 "$TMP/relay.c" -lm -o "$TMP/relay" && "$TMP/relay"
}
check "a relay without coordinates slides on its surface" relay
inputs='' # models without them
check "dry friction has the digits of a run: a spring" digits "$TMP/spring.lag" turns
check "a belt, with static friction, in time" digits "$TMP/belt.lag" squeak
check "two surfaces" digits "$TMP/plank.lag" stops
check "a relay" digits "$TMP/relay.lag" slides
unset inputs
near=200
check "beside a constraint, with an input, to rounding" digits "$TMP/wire.lag" s
model guided <<'END_OF'
model guided
coord a [rad], b [rad], x [m], y [m]
state z
param r = 0.1 [m] > 0, l = 0.3 [m] > 0, mu = 0.1 >= 0
input F [N] = 3 [N]*sin(20 [rad/s]*t)
kinetic = 0.05/2 [kg*m^2]*a'^2 + 0.01/2 [kg*m^2]*b'^2 + 0.75 [kg]*(x'^2 + y'^2)
potential = 15 [N]*y
flow z' = a'/3 - z/1 [s]
friction brake on a: 0.2 [N*m]
force x = F
guide pin: (x, y) = (r*cos(a) + l*cos(b), r*sin(a) - l*sin(b)), friction = mu, slip = 15 [mm]*b'
guide rail: y = 0, friction = mu, static = 1.5*mu
scene coast { start a = 1, a' = 5 [rad/s], b = asin(r*sin(1)/l), x = r*cos(1) + l*cos(asin(r*sin(1)/l)); span 20 [s]; output a }
END_OF
inputs=', 0'
check "journals and rails beside dry friction, a state and an input" digits "$TMP/guided.lag" coast
unset inputs
near=0
check "a header without it says so" sh -c "$LAGC header $TMP/spring.lag | grep -q 'go to and fro where a body sticks; .lagc header --with moreau. adds a step'"
model both <<'END_OF'
model both
coord x [m], y [m]
kinetic = 1 [kg]/2*(x'^2 + y'^2)
potential = 9.81 [N]*y
force x = -sign(x')*1 [N]
contact floor: y >= 0, restitution = 0.6
scene s { start x' = 0.5 [m/s], y = 0.3 [m]; span 100 [s] }
END_OF
check "dry friction beside a contact" digits "$TMP/both.lag" s
model stuck <<'END_OF'
model stuck
coord x [m], y [m]
kinetic = 1 [kg]/2*(x'^2 + y'^2) + 0.3 [kg]*x'*y'
potential = 50 [N/m]/2*y^2
force x = -3 [N] + 4.5 [N]*sin(3 [rad/s]*t)
friction rub on x: 1 [N], static = 2 [N]
contact wall: x >= 0, restitution = 0
scene s { start x = 0.01, y = 0.02, y' = 0.1 [m/s]; span 100 [s] }
END_OF
check "static friction of a body that a wall has held" digits "$TMP/stuck.lag" s
near=200
sed 's/span 0.6/span 10/' $here/fmu/stopped.lag >"$TMP/stopped.lag" # an impact in 300 steps
check "guides and dry friction beside a contact with friction" digits "$TMP/stopped.lag" coast
model tele <<'END_OF'
model tele
coord x[3] [m], y [m]
input F [N] = 12 [N]*sin(5 [rad/s]*t)
param mu = 0.3, g = 9.81 [m/s^2]
kinetic = 1 [kg]/2*(x[1]'^2 + x[2]'^2 + x[3]'^2 + y'^2)
potential = 1 [kg]*g*y
force x[1] = F
let d = x[2] - x[1], e = x[3] - x[2]
friction one on d: 1 [N]
friction two on e: 0.5 [N], static = 0.8 [N]
guide rail: y + 0.1*x[3] = 0, friction = mu
for i in 1..2 { contact out[i]: x[i+1] - x[i] >= 0, restitution = 0.4
 contact back[i]: 0.2 [m] - (x[i+1] - x[i]) >= 0, restitution = 0.4 }
contact wall: 0.5 [m] - x[3] >= 0, restitution = 0.3, friction = 0.2, slip = y'
scene s { start x[2] = 0.1, x[3] = 0.2 , y = -0.02; span 100 [s] }
END_OF
model wedge <<'END_OF'
model wedge
coord s [m], x [m], y [m]
kinetic = 10 [kg]*s'^2 + 1 [kg]/2*(x'^2 + y'^2)
potential = 9.81 [N]*y - 40 [N]*s + 60 [N/m]/2*s^2
guide rail: x = 0, friction = 0.5, slip = y'
contact lift: y - 1.2*(s - x) >= 0, restitution = 0, friction = 0.1, slip = y' + s'
scene go { span 100 [s]; output s }
END_OF
unset inputs
check "a wedge that presses a rod against its guide" digits "$TMP/wedge.lag" go
check "a telescope on a slope: slides that rub between stops" digits "$TMP/tele.lag" s
near=0
model puck2 <<'END_OF'
model puck2
coord x [m], y [m]
kinetic = 1 [kg]/2*(x'^2 + y'^2)
force x = -1 [N]*x'/hypot(x', y')
force y = -1 [N]*y'/hypot(x', y')
scene s { start x' = 1 [m/s]; span 2 [s] }
END_OF
check "a direction in a plane" says 2 'dry friction along coordinates, and not against the direction of a velocity' "$LAGC" header "$TMP/puck2.lag" --with moreau -o "$TMP/none.h"

# ---- frictions that become negative: of a rail where 1 - x does, x = 1 at t = 0.18489 (run_guides), and 0.3 N of N = 20 - 15 t, beyond 4/3
printf '%s\n' 'model worn; coord x, y' "lagrangian = (x'^2 + y'^2)/2 - 9.81*y" 'constraint rail: y = 0' 'friction rub on x: (1 - x)*abs(lambda(rail))' "scene s { start x' = 6 }" >"$TMP/worn.lag"
printf '%s\n' 'model push; coord x; input N = 20' "kinetic = x'^2" 'friction f on x: 0.3*N' "scene s { start x' = 9; N = 20 - 15*t }" >"$TMP/push.lag"
ends() { # MODEL STEP LAST: the last state before the friction is negative
  "$LAGC" header "$TMP/$1.lag" --with moreau --prefix in_c -o "$TMP/$1.h" && cat >"$TMP/ends.c" <<END_OF
#define IN_C_IMPLEMENTATION
#include "$1.h"
int main(void) {
  in_c_params p;
  in_c_state s;
  int status = 0, steps = 0;
  in_c_defaults(&p);
  in_c_start(&p, &s);
  while (steps < 1000 && (status = in_c_moreau_step(&p, &s, $2, 0)) == IN_C_OK) steps++;
  return !(status == IN_C_ESIZE && fabs(s.t - $3) < 1e-9);
}
END_OF
  "$CC" -std=c99 -O0 "$TMP/ends.c" -lm -o "$TMP/ends" && "$TMP/ends"
}
check "the friction of a guide becomes negative" ends worn 1e-3 0.184
check "a friction that follows an input" ends push 1e-2 1.33

tap_end
