#!/bin/sh
# lagc verify: right-hand sides by hand, from textbooks, agree; each with one mistake planted is refused, with the mistake named; what is no
# right-hand side is refused with a way out. tests/exec/verify/hand.c has the functions.
. tests/tap.sh
hand=tests/exec/verify/hand.c
textbook=models/double_pendulum_textbook.c

verify() { "$LAGC" verify "$@"; }

cat >"$TMP/rod.lag" <<'EOF2'
model rod
coord x [m], y [m]
param m = 1 [kg] > 0, l = 1 [m] > 0, g = 9.81 [m/s^2] > 0
kinetic = m/2*(x'^2 + y'^2)
potential = m*g*y
constraint hold: x^2 + y^2 = l^2
scene swing { start x = 0.6 [m], y = -0.8 [m]; span 1 [s] }
EOF2
cat >"$TMP/cancels.lag" <<'EOF2'
model cancels
coord x
param m = 1 > 0, a = 1, b = 1
kinetic = m/2*x'^2
force x = -(a*(1 - cos(x)) + b*(1 - 1/(1 + x^2)))
scene tiny { start x = 1e-6; span 1 [s] }
scene tinier { start x = 1e-9; span 1 [s] }
EOF2

cat >"$TMP/ball.lag" <<'EOF2'
model ball
coord y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0
kinetic = m/2*y'^2
potential = m*g*y
contact floor: y >= 0, restitution = 0.5
scene drop { start y = 1 [m]; span 1 [s] }
EOF2
law() { # NAME FORCE START: x'' = FORCE
  printf "model %s\ncoord x\nkinetic = x'^2/2\nforce x = %s\nscene start { start x = %s; span 1 [s] }\n" "$1" "$2" "$3" >"$TMP/$1.lag"
}
law root '-sqrt(x)^2' 1
law narrow '-sqrt(x - 1.8)' 1.9
law balance '9.81 - x' 9.8100001

# ---- right functions ----
right() { # right MODEL [SCENE] OPTIONS...
  check "agrees: $*" says 0 "agrees with the derived equations" verify "$@"
}
right models/double_pendulum.lag --against $textbook:rhs
right models/pendulum.lag --against $hand:pendulum_gsl
right models/pendulum.lag --against $hand:pendulum
right models/pendulum.lag --against $hand:from_start
right models/kepler.lag --against $hand:kepler
right models/cart_pendulum.lag --against $hand:cart_pendulum --map "x,x',th,th'"
right models/lorenz.lag --against $hand:lorenz
right models/driven_damped_pendulum.lag chaos --against $hand:driven
right models/spherical_pendulum.lag --against $hand:spherical
right models/motor_pendulum.lag --against $hand:motor
right "$TMP/rod.lag" --against $hand:point_on_rod
right "$TMP/cancels.lag" tiny --against $hand:cancels
right "$TMP/cancels.lag" tinier --against $hand:cancels
right models/pendulum.lag --against $hand:loses_digits
right "$TMP/ball.lag" --against $hand:ball
check "a contact is told" says 0 'contacts: open' verify "$TMP/ball.lag" --against $hand:ball
right "$TMP/root.lag" --against $hand:root
# Of states of magnitude 0.3 to 2, one in 17 has x > 1.8.
narrow() { [ "$(verify "$TMP/narrow.lag" --against $hand:narrow | sed -n 's/.* at \([0-9]*\) states$/\1/p')" -ge 40 ]; }
check "states are drawn inside a small domain" narrow
right "$TMP/balance.lag" --against $hand:balance
right models/pendulum.lag --against "$(pwd)/$hand:pendulum"
relative() { cp $hand "$TMP/hand.c" && (cd "$TMP" && says 0 agrees "$tools/lagc" verify rod.lag --against hand.c:point_on_rod); }
case $LAGC in /*) tools=$(dirname "$LAGC") ;; *) tools=$(pwd)/$(dirname "$LAGC") ;; esac
check "a path from the present folder" relative

# ---- values of the command line: a parameter is held, also in other units; a start is that of the first state ----
echo '#include <math.h>
void f(double t, const double *y, double *dydt, const double *p) { (void)t; dydt[0] = y[1], dydt[1] = fabs(y[0] - 3) < 1e-9 ? 0 : -9.81/p[1]*sin(y[0]); }' >"$TMP/number.c"
right models/pendulum.lag 'g=9810[mm/s^2]' th=2 --against "$TMP/number.c:f"
check "it is not held otherwise" says 3 "it has 9.81 for \`g\`" verify models/pendulum.lag --against "$TMP/number.c:f"
check "a start" says 3 'at th = 3,' verify models/pendulum.lag g=9.81 th=3 --against "$TMP/number.c:f"
given() { check "refused: $3" says "$1" "$2" verify models/chain.lag "$3" --against "$TMP/number.c:f"; }
given 1 "did you mean \`g\`?" gg=1
given 2 'write -D N=3' N=3
given 1 'is declared > 0' g=-1
given 2 'a value is missing' g=

# ---- mistakes ----
# wrong MODEL FUNCTION FILE EDIT WORDS [OPTIONS...]: the file with this edit, of sed, differs, and is told these words.
wrong() {
  one_of 8 || return 0
  model=$1 function=$2 edit=$4 words=$5
  sed "$edit" "$3" >"$TMP/edited.c"
  shift 5
  check "the edit $edit changes the file" sh -c '! cmp -s "$1" "$2"' - "$TMP/edited.c" "$hand"
  check "refused: $function with $edit" says 3 "$words" verify "$model" "$@" --against "$TMP/edited.c:$function"
}
double() { wrong models/double_pendulum.lag rhs $textbook "$@"; }
double 's/- m2\*g\*sin(th1 - 2/+ m2*g*sin(th1 - 2/' "one more term, \`m2^2*l1*l2^2*g*sin(th1 - 2*th2)\`"
double 's/- 2\*sin(th1 - th2)\*m2/+ 2*sin(th1 - th2)*m2/' 'with the opposite sign'
double 's/(m1 + m2)\*cos(th1)/(m1 + m2)*sin(th1)/' "sin(th1)*sin(th1 - th2)\` in place of \`(m1 + m2)*m2*l1^2*l2*g*cos(th1)*sin(th1 - th2)\`"
double 's/m1 = p\[0\], m2 = p\[1\]/m1 = p[1], m2 = p[0]/' "\`m1\` and \`m2\` are swapped in it"
double 's/g = p\[4\]/g = 9.81/' "it has 9.81 for \`g\`, whatever p[4] is"
double 's/m1 = p\[0\], m2 = p\[1\], l1 = p\[2\], l2 = p\[3\], g = p\[4\]/m1 = 1, m2 = 1, l1 = 1, l2 = 1, g = 9.81/' "it has the scene's parameters, whatever p is"
double 's/m2 - m2\*cos(2/m2 + m2*cos(2/' 'in det M of'
double 's/+ w2\*w2\*l2\*m2\*cos(th1 - th2)//' "in the numerator over det M of th2'' it lacks \`m2^2*l1^2*l2^2*cos(th1 - th2)*sin(th1 - th2)*th2'^2\`"
double 's/= 2\*sin(th1/= sin(th1/' "in th2'' there is a factor \`1/2\` too many"
double 's/\/(l1\*den)/\/den/' "in th1'' there is a factor \`l1\` too many"
double 's/dydt\[1\] = w2/dydt[1] = w1/' "it has \`dydt[1] = th1'\` in place of \`th2'\`"
double 's/w2\*w2\*l2 + w1/w2*l2 + w1/' "*th2'\` in place of \`-m2^2*l1*l2^3*sin(th1 - th2)*th2'^2\`"
double 's/-g\*(2\*m1/-g*(2.0000000001*m1/' "differs from the derived equations"
double 's/sin(th1) -/sin(th1 + 1e-12) -/' "differs from the derived equations"
double 's/th2 = y\[1\], w1 = y\[2\]/w1 = y[1], th2 = y[2]/; s/dydt\[1\]/dydt[9]/; s/dydt\[2\]/dydt[1]/; s/dydt\[9\]/dydt[2]/' "it has y in another order: --map \"th1,th1',th2,th2'\""
by_hand() { function=$2 model=$1; shift 2; wrong "$model" "$function" $hand "$@"; }
by_hand models/pendulum.lag pendulum_gsl 's/-p->g/p->g/' "in the equation of th it has \`-m*l*g*sin(th)\` with the opposite sign"
by_hand models/pendulum.lag pendulum_gsl 's/l\*sin/l*cos/' "it has \`-m*l*g*cos(th)\` in place of \`-m*l*g*sin(th)\`"
by_hand models/pendulum.lag pendulum_gsl 's/l\*sin(y\[0\])/l*y[0]/' "it has \`-m*l*g*th\` in place of \`-m*l*g*sin(th)\`"
by_hand models/pendulum.lag pendulum_gsl 's/p->g\/p->l/p->g*p->l/' "it has \`-m*l^3*g*sin(th)\` in place of \`-m*l*g*sin(th)\`"
by_hand models/pendulum.lag pendulum_gsl 's/sin(y\[0\])/sin(fabs(y[0]) > 2.2 ? 2.2 : y[0])/' "differs from the derived equations"
by_hand models/kepler.lag kepler 's/(r\*r\*r)/(r*r)/' "differs from the derived equations"
by_hand models/kepler.lag kepler 's/y\[1\]\/(r/y[0]\/(r/' "in place of"
by_hand models/lorenz.lag lorenz 's/y\[1\] - p\[2\]/y[1] + p[2]/' "in the rate of z it has \`-beta*z\` with the opposite sign"
by_hand models/lorenz.lag lorenz 's/- y\[2\]) - y\[1\]/- y[2])/' "in the rate of y it lacks \`-y\`"
by_hand models/driven_damped_pendulum.lag driven 's/-2\*p\[2\]\*y/-p[2]*y/' "in place of" chaos
by_hand models/driven_damped_pendulum.lag driven 's/cos(p\[4\]/sin(p[4]/' "*sin(drive.w*t)\` in place of" chaos
by_hand models/spherical_pendulum.lag spherical 's/-2\*y\[2\]/2*y[2]/' "in ph'' the sign is the opposite one"
by_hand models/spherical_pendulum.lag spherical 's/-2\*y\[2\]/-y[2]/' "in ph'' there is a factor \`1/2\` too many"
by_hand models/motor_pendulum.lag motor 's/- b\*y\[1\]//' "in the equation of th it lacks \`-b*th'\`"
by_hand models/motor_pendulum.lag motor 's/- K\*y\[1\]/+ K*y[1]/' "in the rate of i it has \`-K*th'/L\` with the opposite sign"
by_hand models/cart_pendulum.lag cart_pendulum 's/double M = p\[0\], m = p\[1\]/double M = p[1], m = p[0]/' "\`M\` and \`m\` are swapped in it" --map "x,x',th,th'"
check "the order of y is found" says 3 "--map \"x,x',th,th'\"" verify models/cart_pendulum.lag --against $hand:cart_pendulum
by_hand "$TMP/rod.lag" point_on_rod 's/- p\[2\]\*y\[1\])/+ p[2]*y[1])/' "differs from the derived equations"

# unexplained MODEL FUNCTION FILE EDIT [OPTIONS...]: differs, and no mistake is named.
says_no_cause() { verify "$@" 2>&1 | grep -qx 'lagc: .* differs from the derived equations'; }
unexplained() {
  model=$1 function=$2
  sed "$4" "$3" >"$TMP/edited.c"
  check "no mistake is named: $function with $4" says_no_cause "$model" --against "$TMP/edited.c:$function"
}
unexplained models/double_pendulum.lag rhs $textbook 's/-g\*(2\*m1/-g*(2.0000000001*m1/'
unexplained models/pendulum.lag pendulum $hand 's/-p\[2\]\/p\[1\]/-1e-10*p[2] - p[2]\/p[1]/'
cat >"$TMP/unused.lag" <<'EOF2'
model unused
coord x
param m = 1 > 0, k = 2 > 0, unused = 3
kinetic = m/2*x'^2
potential = k/2*x^2
scene start { start x = 1; span 1 [s] }
EOF2
echo 'void f(double t, double *y, double *dydt, double *p) { dydt[0] = y[1], dydt[1] = -p[1]*y[0]/p[0]; (void)t; }' >"$TMP/unused.c"
check "agrees: a parameter that nothing uses" says 0 agrees verify "$TMP/unused.lag" --against "$TMP/unused.c:f"
unexplained "$TMP/unused.lag" f "$TMP/unused.c" 's/dydt\[1\] = /dydt[1] = -(1 + 1e-9)*/; s/-p\[1\]/p[1]/'
unexplained models/pendulum.lag pendulum $hand 's/-p\[2\]\/p\[1\]\*sin(y\[0\])/-0.7*p[0]*y[1] - 0.3*exp(y[0]) - p[2]*cos(p[1])/'

# ---- no right-hand sides ----
seldom() { one_of 4 && bad "$@"; }
bad() { check "$2" says "$1" "$3" verify models/pendulum.lag --against "$hand:$2"; }
bad 3 crashes 'crashes'
bad 3 crashes_late ', t = '
slow bad 3 loops 'does not return within 5 s'
seldom 3 exits 'ends the program'
bad 3 writes_past 'writes past dydt[1]'
seldom 3 leaves_out 'is nan, or not set'
seldom 3 is_nan 'is nan, or not set'
seldom 3 reads_past_y 'outside y or p'
seldom 3 reads_past_p 'outside y or p'
seldom 3 reads_before_y 'outside y or p'
bad 3 fails 'returns 7'
bad 3 remembers 'other values when it is called once more'
seldom 3 single 'is a float in it?'
seldom 3 random_bits 'fewer than 9 digits'
bad 2 of_floats 'the others are arrays of doubles'
bad 2 of_three 'is called as of_three(t, y, dydt, p)'
bad 2 p_before_dydt 'its third argument should be dydt'
bad 2 pendulun "did you mean \`pendulum\`?"
bad 2 printf 'it has pendulum_gsl, pendulum, from_start, kepler,'
bad 2 'a b' 'write FILE.c:FUNCTION'
echo 'void f(double t, const double *y, double *dydt, const double *p) { dydt[0] = y[1] }' >"$TMP/broken.c"
check "a file that does not compile: the compiler's text" says 2 'broken.c:1' verify models/pendulum.lag --against "$TMP/broken.c:f"
check "no file" says 2 'cannot read' verify models/pendulum.lag --against "$TMP/none.c:f"
check "no --against" says 2 'write --against FILE.c:FUNCTION' verify models/pendulum.lag
check "no function" says 2 'names no function' verify models/pendulum.lag --against $hand
check "a short --map" says 2 'has 1 name, y has 2 components' verify models/pendulum.lag --against $hand:pendulum --map th
check "a name twice in --map" says 2 'stands twice' verify models/pendulum.lag --against $hand:pendulum --map th,th
check "an unknown name in --map" says 2 "\`thh\` is no component of y" verify models/pendulum.lag --against $hand:pendulum --map "thh,th'"
check "a wrong model" says 1 error verify tests/golden/err/sem_unit_of_divisor.lag --against $hand:pendulum
leaves_nothing() {
  for f in pendulum crashes of_three; do XDG_CACHE_HOME=$TMP/cache verify models/pendulum.lag --against $hand:$f; done
  [ -d "$TMP/cache/lagc" ] && [ -z "$(ls "$TMP/cache/lagc" | grep -v "[.]cc$")" ]
}
check "nothing is left in the cache's folder" leaves_nothing

# ---- a correct function is never refused: the emitted header, in doubles, of every model ----
cat >"$TMP/emitted.sh" <<'EOF2'
model=$1
"$LAGC" header "$model" -o "$TMP/x.h" >/dev/null 2>&1 || exit 1
signature=$(grep -m1 -A3 'API int x_accel' "$TMP/x.h" | tr '\n' ' ' | sed 's/;.*//')
q= z= u= a= zd=
case $signature in *'*q,'*) q='y, y + X_NQ,' a=', dydt + X_NQ' ;; esac
case $signature in *'*z,'*) z='y + 2*X_NQ,' zd=', dydt + 2*X_NQ' ;; esac
case $signature in *'*u,'*) u=', u' ;; esac
cat >"$TMP/x.c" <<E
#include <string.h>
#define X_IMPLEMENTATION
#include "x.h"
int f(double t, const double *y, double *dydt, const double *p) {
  x_params P;
  double u[X_NU + 1] = {0};
  x_defaults(&P);
  for (int i = 0; i < X_NP; i++) *x_param(&P, i) = p[i];
  memcpy(dydt, y + X_NQ, sizeof *dydt*X_NQ);
  ${u:+x_inputs(t, &P, u);}
  return x_accel(t, $q $z &P $u $a $zd);
}
E
"$LAGC" verify "$model" --against "$TMP/x.c:f"
EOF2
export LAGC TMP
cat >"$TMP/held.lag" <<'EOF2'
model held
coord x, y, z
param m = 1 > 0, g = 9.81, k = 5
let w = x - y/3
kinetic = m/2*(x'^2 + y'^2 + z'^2) + (x' + y'*cos(z))^2
potential = m*g*z + k/2*(w^2 + x*y*z)
constraint wall: x = 0
scene s { start y = 0.1, z = -0.3, y' = 1; span 1 }
EOF2
# ---- other effects, other languages ----
cat >"$TMP/effects.lag" <<'EOF2'
model effects
coord th [rad]
param l = 1 [m] > 0, g = 9.81 [m/s^2] > 0
lagrangian = l^2*th'^2/2 + g*l*cos(th)
effect drag { param c = 0.3 [m^2/s]; dissipation = c/2*th'^2 }
effect push { param F = 0.2 [m^2/s^2]; force th = F }
scene both { use drag, push; start th = 1 }
scene none_on { start th = 1 }
EOF2
cat >"$TMP/effects.c" <<'EOF2'
#include <math.h>
void plain(double t, const double *y, double *d, const double *p) { d[0] = y[1]; d[1] = -p[1]/p[0]*sin(y[0]); (void)t; }
void drag(double t, const double *y, double *d, const double *p) { plain(t, y, d, p); d[1] -= p[2]*y[1]/(p[0]*p[0]); }
EOF2
check "a function without the scene's effects" says 3 "it agrees with the model without effects" verify "$TMP/effects.lag" both --against "$TMP/effects.c:plain"
check "a function with one of them" says 3 "it agrees with the model with drag" verify "$TMP/effects.lag" both --against "$TMP/effects.c:drag"
slow check "a function with an effect that the scene has not" says 3 "use drag" verify "$TMP/effects.lag" none_on --against "$TMP/effects.c:drag"
check "Python is no C" says 2 "is not C: \`lagc verify\` compiles and calls a C function; from Python" verify models/pendulum.lag --against pendulum.py:rhs
held() { sh "$TMP/emitted.sh" "$TMP/held.lag" >"$TMP/said" && grep -qx "  x''  *0 up to roundings" "$TMP/said"; }
check "a rate that a constraint holds at 0: rounding alone is no float" held
check "inputs by tables: the emitted function agrees" sh "$TMP/emitted.sh" tests/exec/models/tables.lag
check "models/toda.lag, where exp rounds alike beside the start: the emitted function agrees" sh "$TMP/emitted.sh" models/toda.lag
for model in models/*.lag; do
  one_of 50 && light "$model" && has_header "$model" && check "$(basename "$model"): the emitted function agrees" sh "$TMP/emitted.sh" "$model"
done
tap_end
