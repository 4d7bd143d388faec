#!/bin/sh
# Steps of headers have the digits of `lagc run`: each method that both have, on the models of the gallery. `make test`: one combination in 120.
. tests/tap.sh
here=tests/exec

digits() { # MODEL METHOD
  n=$(basename "$1" .lag) method=$2
  upper=IN_C # the header's own prefix: a scene may be called as one of its functions is
  order=0
  case $method in variational*) order=${method#variational} method=variational ;; esac
  "$LAGC" header "$1" --with "$method" --prefix in_c -o "$TMP/$n.h" 2>"$TMP/err" || { grep -q 'only of models' "$TMP/err"; return; }
  "$LAGC" emit "$1" --method "$method" -o "$TMP/$n.c" || return 1
  scene=$(sed -n 's/^const lag_scene \(.*\) = {/\1/p' "$TMP/$n.c" | head -n 1)
  held= inputs=
  grep -q "${upper}_NU = 0" "$TMP/$n.h" || held=', 0' inputs=', u'
  adaptive=0 start= of=$method
  step="JOIN(M, _${method}_step)(&p, &s, opt[0].value$held)"
  case $method in
    rk45 | dop853)
      adaptive=1 start='JOIN(M, _adaptive) w; JOIN(M, _adaptive_begin)(&w, TOL);'
      step="JOIN(M, _${method}_step)(&p, &s, &w, far$held)"
      ;;
    taylor)
      of=taylor_method
      adaptive=1 start='JOIN(M, _taylor) w; JOIN(M, _taylor_begin)(&w, TOL, 0);'
      step="JOIN(M, _taylor_step)(&p, &s, &w, far$held)"
      ;;
    variational*)
      start="JOIN(M, _variational) w; if (JOIN(M, _variational_begin)(&w, ORDER) != 0) return 2;"
      step="JOIN(M, _variational_step)(&p, &s, &w, opt[0].value$held)"
      ;;
    verlet* | symplectic*)
      start="double a[NQ]; JOIN(M, _accel)(s.t, s.q, s.v, &p$inputs, a);"
      [ -z "$held" ] || start="double u[JOIN(U, _NU)]; JOIN(M, _inputs)(s.t, &p, u); $start"
      step="JOIN(M, _${method}_step)(&p, &s, opt[0].value$held, a)"
      ;;
  esac
  # shellcheck disable=SC2086
  "$CC" -std=c11 -O0 -ffp-contract=off -DM=in_c "-DU=$upper" "-DSCENE=$scene" "-DMETHOD=$of" "-DORDER=$order" "-DNEAR=${near:-0}" ${tol:+-DTOL=$tol -DSTEPS=$steps} -DADAPTIVE=$adaptive "-DSTART=$start" "-DSTEP=$step" \
    "-DHEADER=\"$n.h\"" "-D${upper}_IMPLEMENTATION" -iquote "$TMP" -I"$INC" $here/embed_digits.c "$TMP/$n.c" "$BUILD/liblag.a" -lm -o "$TMP/digits" && "$TMP/digits"
}
for m in models/*.lag; do
  light "$m" || continue
  has_header "$m" || continue
  "$LAGC" header "$m" | grep -q '_hold(' && continue
  "$LAGC" emit "$m" | grep -q 'nmodes\|ntables' && continue # runs end steps where a force jumps, and at the rows of a table; headers do not
  for method in rk4 rk45 dop853 symplectic_euler verlet verlet4 verlet6 verlet8 taylor variational2 variational6; do
    one_of 120 || continue
    check "$(basename "$m" .lag): $method" digits "$m" $method
  done
done

# Paths of taylor that the gallery does not reach, in the digits of the runtime: errors that are rounding and fade, rejected steps, ends in a root's domain, zeros.
along() { tol=$2 steps=$3 digits "$1" taylor; }
check "taylor: errors that are rounding" along $here/taylor/offset.lag 1e-15 3000
check "taylor: steps that are rejected" along $here/taylor/encounter.lag 1e-3 300
check "taylor: steps that leave the domain" along $here/taylor/edge.lag 1e-3 300
check "taylor: a state at rest" along $here/taylor/rest.lag 1e-9 30
tol= steps=

# Under constraints: the start to rounding, which the compiler has found for the header, then each step to the bit. Not where a contact is closed at the start,
# which steps of headers leave to their caller; and not sizes that follow an error above the tolerance, of which `lagc run` takes the part along the constraints.
near=200
for m in models/*.lag; do
  case $m in */cam_follower.lag | */dominoes.lag | */drum_brake.lag | */gripper.lag | */painleve_rod.lag | */rocking_block.lag | */sliding_ball.lag | */sliding_off.lag | */tower.lag | */wheel_bar.lag | */woodpecker.lag) continue ;; esac
  has_header "$m" || continue
  "$LAGC" header "$m" | grep -q '_hold(' || continue
  "$LAGC" emit "$m" | grep -q 'nmodes\|ntables\|nguides' && continue
  for method in rk4 rk45 dop853; do
    case "$m $method" in "models/slider_crank.lag rk45") ;; *) one_of 40 || continue ;; esac
    check "$(basename "$m" .lag), on its constraints: $method" digits "$m" $method
  done
done

# ---- Taylor and variational steps in each scalar type, against closed forms
"$LAGC" header models/pendulum.lag --with taylor,variational,dop853 -o "$TMP/pendulum.h"
closed_forms() { "$@" -iquote "$TMP" $here/embed_steps.c -o "$TMP/steps" -lm && "$TMP/steps"; }
quad() { gcc -std=gnu11 -O0 -DQUAD -iquote "$TMP" $here/embed_steps.c -o "$TMP/steps" -lquadmath -lm && "$TMP/steps"; }
check "double: closed forms" closed_forms "$CC" -std=c99 -O0 -DREAL=double
slow check "float" closed_forms "$CC" -std=c99 -O0 -DREAL=float
check "long double, with less memory" closed_forms "$CC" -std=c99 -O0 "-DREAL=long double" -DPENDULUM_TAYLOR_ORDER=30 -DPENDULUM_VARIATIONAL_ORDER=4
slow check "C++98" closed_forms "${CXX:-g++}" -std=gnu++98 -O0 -x c++ -DREAL=double
if echo 'int main(void) { return 0; }' | gcc -x c - -lquadmath -o "$TMP/quad" 2>/dev/null; then slow check "__float128" quad
else skip "__float128" "there is no libquadmath"; fi

# Momenta of L = (1 + t) x'^2/2: a caller who sets another time finds x' as it was, not the momentum.
printf "model growing\ncoord x\nlagrangian = (1 + t)*x'^2/2\nscene s { start x' = 1 }\n" >"$TMP/growing.lag"
"$LAGC" header "$TMP/growing.lag" --with variational -o "$TMP/growing.h"
cat >"$TMP/growing.c" <<END
#define GROWING_IMPLEMENTATION
#include "growing.h"
int main(void) {
  growing_params p;
  growing_state s;
  growing_variational w;
  growing_defaults(&p);
  growing_start(&p, &s);
  if (growing_variational_begin(&w, 6) != 0 || growing_variational_step(&p, &s, &w, 1e-3) != 0) return 2;
  const double v = s.v[0]*(1 + 5)/(1 + 5.001);
  s.t = 5;
  return growing_variational_step(&p, &s, &w, 1e-3) != 0 || !(fabs(s.v[0] - v) < 1e-13);
}
END
check "variational steps begin anew at another time" sh -c '"$0" -O0 -I"$1" "$1/growing.c" -lm -o "$1/growing" && "$1/growing"' "$CC" "$TMP"

# ---- what is refused leaves no file
refused() { # WORDS OPTIONS...
  words=$1
  shift
  rm -f "$TMP/none.h"
  says 2 "$words" "$LAGC" header models/lorenz.lag "$@" -o "$TMP/none.h" && [ ! -e "$TMP/none.h" ]
}
check "verlet without coordinates is refused" refused 'only of models with accelerations that depend on t and coordinates alone' --with rk45,verlet
check "variational steps with states too" refused 'only of models with coordinates alone, without states and constraints; rk45 and dop853 step every model' --with variational
check "an unknown part is refused, with the known ones" refused 'rk45' --with rk46
check "a prefix that is no identifier is refused" refused 'is no name for C and C++' --prefix 2fast
check "nor a reserved one" refused 'is no name for C and C++' --prefix a__b
prefixed() {
  "$LAGC" header models/pendulum.lag --prefix Arm_2 -o "$TMP/pend.h" && grep -q 'int arm_2_accel' "$TMP/pend.h" && grep -q 'ARM_2_IMPLEMENTATION' "$TMP/pend.h" &&
    ! grep -qi 'pend_' "$TMP/pend.h"
}
check "a prefix of the user's" prefixed
named() { # names that contain `lag`
  sed 's/model pendulum/model phase_lag/' models/pendulum.lag >"$TMP/phase_lag.lag" && "$LAGC" header "$TMP/phase_lag.lag" --with rk45,taylor,jac --prefix flag -o "$TMP/pend.h" &&
    printf '#define FLAG_IMPLEMENTATION\n#include "pend.h"\n' >"$TMP/pend.c" && "$CC" -Werror -c "$TMP/pend.c" -o "$TMP/pend.o"
}
check "a prefix that ends in lag" named
tap_end
