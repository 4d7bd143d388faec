#!/bin/sh
# `lagc header --for`: Jacobians of all models against differences; motions by GSL, CVODE, ARKODE and IDA, against closed forms and `lagc run`; CasADi's external functions
# by a loader of its interface; what is left out, and refused. `make test`: one model in 32.
. tests/tap.sh
here=tests/exec/callbacks
python=
for p in /usr/bin/python3 python3; do "$p" -c 'import ctypes' 2>/dev/null && { python=$p; break; }; done
libs="-lsundials_cvode -lsundials_arkode -lsundials_ida -lsundials_nvecserial -lsundials_sunmatrixdense -lsundials_sunmatrixsparse -lsundials_sunmatrixband
  -lsundials_sunlinsoldense -lsundials_sunlinsolklu -lsundials_generic -lgsl -lgslcblas -lm"
time_step= # an option, for models that need another
# shellcheck disable=SC2086 # a list
solvers() { printf '%s\n' '#include <sunlinsol/sunlinsol_klu.h>' '#include <gsl/gsl_odeiv2.h>' 'int main(void) { return SUNLinSol_KLU == 0; }' |
  $CC -isystem /usr/include/suitesparse -x c - -o "$TMP/solvers" $libs 2>/dev/null; }

header() { "$LAGC" header "$1" --for "$2" --prefix mm -o "$TMP/mm.h"; }
has() { if grep -q "$1" "$TMP/mm.h"; then echo 1; else echo 0; fi; }
# program FILE ARGUMENT...: compiled around the header, and run.
program() {
  file=$1
  shift
  # shellcheck disable=SC2086 # a list
  $CC -std=gnu11 -Wall -Wextra -Wno-unused -Werror -isystem /usr/include/suitesparse "-DFILE_H=\"$TMP/mm.h\"" "-DHAS_JAC=$(has mm_cvode_jac)" "-DHAS_EVENTS=$(has mm_cvode_root)" "-DHAS_INPUTS=$(has mm_inputs)" $time_step \
    "$here/$file.c" -o "$TMP/$file" $libs && "$TMP/$file" "$@"
}
derivatives() { header "$1" gsl,cvode,arkode,ida && program derivatives; }
motions() { header "$1" gsl,cvode,arkode,ida && shift && program motions "$@"; }
run_end() { "$LAGC" run "$@" | awk '/^steps/ { exit } on { print $2 } /^reached/ { on = 1 }'; }

models=$(grep -LE '^ *contact|^ *kick |^ *guide .* friction |^ *friction .*lambda|^ *constraint .* while ' models/*.lag)

# ---- GSL and SUNDIALS
# x'' + 4 x = cos(3 t)/4 + t/2 and z' = x - z, from x = 1; at t = 4
driven=$(awk 'function part(t) { return A*(cos(2*t) + 2*sin(2*t))/5 + B*(sin(2*t) - 2*cos(2*t))/5 - (cos(3*t) + 3*sin(3*t))/200 + (t - 1)/8 }
  BEGIN { t = 4; A = 1.05; B = -1/16; CONVFMT = OFMT = "%.15g"
    print A*cos(2*t) + B*sin(2*t) - cos(3*t)/20 + t/8, -2*A*sin(2*t) + 2*B*cos(2*t) + 3*sin(3*t)/20 + 1/8, part(t) - part(0)*exp(-t) }')
# free fall between bounces; at t = 2
ball=$(awk 'BEGIN { g = 9.81; at = sqrt(2/g); v = g*at; CONVFMT = OFMT = "%.15g"
  while (at + 2*(v *= 0.8)/g < 2) at += 2*v/g
  d = 2 - at; print v*d - g*d*d/2, v - g*d }')
if solvers; then
  for m in $models; do
    one_of 32 && light "$m" || continue
    time_step=
    [ "$m" != models/cyclotron.lag ] || time_step=-DTIME_STEP=1e-12 # its field turns by 1e8 radians a second
    check "Jacobians: $(basename "$m" .lag)" derivatives "$m"
  done
  check "Jacobians: time, input and state" derivatives $here/driven.lag
  check "Jacobians: inputs that the caller holds" derivatives $here/spring_by_input.lag
  check "motions: time, input and state" motions $here/driven.lag 4 $driven
  check "motions: events" motions models/bouncing_ball.lag 2 $ball
  check "motions: two angles" motions models/double_pendulum.lag 5 $(run_end models/double_pendulum.lag --until 5 --tol 1e-13)
  check "motions: constraints" motions models/slider_crank.lag 0.5 $(run_end models/slider_crank.lag --until 0.5 --tol 1e-13)
else skip "GSL and SUNDIALS" "they are not installed"; fi

# ---- CasADi
# library MODEL: the shared library, and the sizes of its vectors.
library() {
  header "$1" casadi && grep -q 'mm_ode_n_in' "$TMP/mm.h" &&
    $CC -O1 -shared -fPIC -x c -DMM_IMPLEMENTATION -Wall -Wextra -Wpedantic -Wconversion -Werror "$TMP/mm.h" -o "$TMP/mm.so" -lm
}
values() { awk -v n="$(sed -n "s/^  MM_$1 = \([0-9]*\),\$/\1/p" "$TMP/mm.h")" -v a="$2" 'BEGIN { for (i = 1; i <= n; i++) printf "%s ", a + 0.3*sin(5*i) }'; }
casadi() {
  library "$1" && "$python" -B $here/casadi_loader.py "$TMP/mm.so" "$(has jac_mm_ode)" "$(values NY 0.7)" "$(values NU 0.4)" "$(values NP 1.5)" 0.25
}
if [ -n "$python" ]; then
  for m in $models; do
    one_of 32 && light "$m" || continue
    case $m in
      models/cyclotron.lag) continue ;; # its differences by time are for its own frequency, not for parameters of order one
      models/asteroid.lag) continue ;;  # an ellipse has no eccentricity of order one
    esac
    check "CasADi: $(basename "$m" .lag)" casadi "$m"
  done
  check "CasADi: time, input and state" casadi $here/driven.lag
  # p = m, k: v' = (u + t - k x)/m, z' = x - z
  given() { library $here/driven.lag && "$python" -B $here/casadi_loader.py "$TMP/mm.so" 1 '0.5 -2 3' '4' '2 8' '0.25 -2 0.125 -2.5'; }
  check "CasADi: closed form" given
else skip "CasADi" "there is no Python"; fi

# ---- what is left out, and refused
alone() { header models/pendulum.lag casadi && ! grep -qE 'sundials|gsl' "$TMP/mm.h" && header models/pendulum.lag gsl && ! grep -qE 'sundials|casadi' "$TMP/mm.h"; }
check "a header for one library does not name others" alone
plain() { "$LAGC" header models/pendulum.lag --with rhs,jac >"$TMP/plain.h" && ! grep -qE 'sundials|gsl|casadi|_to_y' "$TMP/plain.h"; }
check "none without --for" plain
refused() {
  rm -f "$TMP/none.h"
  says 2 "$1" "$LAGC" header "$2" --for "$3" -o "$TMP/none.h" && [ ! -e "$TMP/none.h" ]
}
check "no contacts" refused 'only of models with no contacts' models/room.lag cvode
check "an unknown library" refused 'takes gsl, cvode, arkode, ida, casadi, with commas between several, not `cvodes`: did you mean `cvode`?' models/pendulum.lag gsl,cvodes
tap_end
