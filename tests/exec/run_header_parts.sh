#!/bin/sh
# What `lagc header --with` adds: matrices, inverse dynamics and derivatives of every model against quadruple precision; constraints, events,
# names; adaptive steps over lanes; refusals. `make test`: one model in twelve.
. tests/tap.sh
here=tests/exec

# A model's header in doubles with prefix a, in quadruple precision with prefix b.
agrees() { # MODEL
  "$LAGC" header "$1" --with all --prefix a -o "$TMP/a.h" && "$LAGC" header "$1" --prefix b -o "$TMP/b.h" || return 1
  has() { grep -q "$1" "$TMP/a.h"; }
  q= q1= rates='k + 2*NQ' rates1='' u= call=
  has 'A_NQ = 0' || { q=', q, v' q1=', q1, v1' call=', y, y + NQ' rates='k + NQ' rates1=', a'; }
  has 'A_NZ = 0' || { q="$q, z" q1="$q1, z1" call="$call, y + 2*NQ"; }
  has 'A_NQ = 0' || has 'A_NZ = 0' || { rates='k + NQ, k + 2*NQ' rates1=', a, zd'; }
  has 'A_NU = 0' || u=', u'
  lin="a_linearize(t$q, p$u, A${u:+, B})"
  for n in NQ NZ NY NU NP; do echo "#define a_$n $(sed -n "s/^  A_$n = \([0-9]*\),\$/\1/p" "$TMP/a.h")"; done >"$TMP/sizes.h"
  flag() { if has "$1"; then echo 1; else echo 0; fi; }
  gcc -std=gnu11 -O0 -Wno-unused -include "$TMP/sizes.h" -Da_OK=A_OK -DA_REAL=double -DA_IMPLEMENTATION -DB_REAL=__float128 '-DB_FN(f)=f##q' '-DB_C(x)=x##Q' -DB_LIBM -DB_IMPLEMENTATION \
    "-DFILE_A=\"$TMP/a.h\"" "-DFILE_B=\"$TMP/b.h\"" "-DARGS=t$q, p$u" "-DARGS1=t$q1, p$u" "-DLINEARIZE=$lin" "-DACCEL1=a_accel(t$q1, p$u$rates1)" \
    "-DCALL_B=b_accel(t$call, p$u, $rates)" "-DHAS_JAC=$(flag a_jac)" "-DHAS_PARAMS=$(flag a_dparams)" "-DHAS_MASS=$(flag a_mass)" \
    "-DCONSTRAINED=$(flag a_constraints)" -include quadmath.h $here/embed_linear.c -lquadmath -lm -o "$TMP/linear" && "$TMP/linear"
}
if echo 'int main(void) { return 0; }' | gcc -x c - -lquadmath -o "$TMP/quad" 2>/dev/null; then
  for m in models/slider_crank.lag models/*.lag tests/exec/models/constrained.lag tests/exec/models/[fkrst]*.lag; do
    one_of 30 && light "$m" && has_header "$m" || continue
    check "$(basename "$m" .lag)" agrees "$m"
  done
else
  skip "derivatives against quadruple precision" "there is no libquadmath"
fi

# ---- closed forms
closed_forms() {
  for m in double_pendulum slider_crank bouncing_ball; do "$LAGC" header models/$m.lag --with all -o "$TMP/$m.h" || return 1; done
  "$CC" -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror -iquote "$TMP" $here/embed_parts.c -lm -o "$TMP/parts" && "$TMP/parts"
}
check "mass, bias, constraints, multipliers, events, names" closed_forms

# Steps end on the constraints: of loose ones, 50 s of which would drift by 1e-3 and more, to the rounding that projection leaves.
kept() { # METHOD
  "$LAGC" header models/slider_crank.lag --with "$1,constraints" --prefix m -o "$TMP/kept.h" || return 1
  cat >"$TMP/kept.c" <<END
#define M_IMPLEMENTATION
#include "kept.h"
#include <stdio.h>
int main(void) {
  m_params p;
  m_state s;
  m_adaptive w;
  double c[M_NQ], r[M_NQ], worst = 0;
  m_defaults(&p);
  m_start(&p, &s);
  m_adaptive_begin(&w, 1e-4);
  while (s.t < 50) {
    if (m_$1_step(&p, &s, &w, 50) != M_OK || m_constraints(s.t, s.q, s.v, &p, c, r) != M_OK) return 1;
    for (int i = 0; i < M_NC; i++) worst = fabs(c[i]) > worst ? fabs(c[i]) : worst;
  }
  printf("%g\\n", worst);
  return !(worst < 1e-13);
}
END
  "$CC" -std=c11 -w -O1 -iquote "$TMP" "$TMP/kept.c" -lm -o "$TMP/kept" && "$TMP/kept"
}
check "steps of dop853 end on the constraints" kept dop853
slow check "and those of rk45" kept rk45

# ---- adaptive steps over lanes: each lane has its own sizes, times and end, and the bits of its motion alone
printf "model fed\ncoord x [m]\nstate z [m]\nparam m = 1 [kg] > 0, k = 4 [N/m] > 0\ninput u [N] = 0.3 [N]*sin(2 [rad/s]*t)\nlagrangian = m/2*x'^2 - k/4*x^4/1 [m^2]\nforce x = u\nflow z' = (x - z)/0.3 [s]\nscene run { start x = 1, z = 0.5; span 5 }\n" >"$TMP/fed.lag"
lanes() { # MODEL LANES METHOD COMPILER OPTIONS...
  model=$1 n=$2 method=$3
  shift 3
  "$LAGC" header "$model" --with "$method" --prefix all -o "$TMP/all.h" && "$LAGC" header "$model" --with "$method" --prefix one -o "$TMP/one.h" || return 1
  "$@" "${LAGC_OPTIMISE:--O1}" -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wundef -Werror -Wno-psabi "-DLANES=$n" "-DMETHOD=$method" -iquote "$TMP" \
    $here/embed_adaptive.c -lm -o "$TMP/adaptive" && "$TMP/adaptive"
}
check "4 lanes of rk45" lanes models/henon_heiles.lag 4 rk45 gcc -std=c99
check "8 lanes of taylor, with sines and a solver" lanes models/double_pendulum.lag 8 taylor gcc -std=c99 -DTAYLOR -DSINGULAR
check "4 lanes of taylor, of powers" lanes models/henon_heiles.lag 4 taylor gcc -std=c99 -DTAYLOR
check "4 lanes of taylor whose errors are rounding" lanes $here/taylor/offset.lag 4 taylor gcc -std=c99 -DTAYLOR -DTOL=1e-15
check "4 lanes of taylor that leave the domain, each at its time" lanes $here/taylor/edge.lag 4 taylor gcc -std=c99 -DTAYLOR -DTOL=1e-3
check "8 lanes of dop853, with sines and a solver" lanes models/double_pendulum.lag 8 dop853 gcc -std=c99 -DSINGULAR
check "4 lanes on constraints: dop853" lanes models/slider_crank.lag 4 dop853 gcc -std=c99 -DHOLD
slow check "and rk45" lanes models/slider_crank.lag 4 rk45 gcc -std=c99 -DHOLD
check "4 lanes with inputs and states" lanes "$TMP/fed.lag" 4 dop853 gcc -std=c99 '-DGIVEN=, 0'
if command -v g++ >/dev/null; then
  check "in C++" lanes "$TMP/fed.lag" 8 rk45 g++ -x c++ -std=c++17 '-DGIVEN=, 0'
  check "taylor in C++, with inputs and states" lanes "$TMP/fed.lag" 4 taylor g++ -x c++ -std=c++17 -DTAYLOR '-DGIVEN=, 0'
else
  skip "8 lanes in C++" "there is no g++"
  skip "4 lanes of taylor in C++" "there is no g++"
fi
# What computes one state has no lanes: the header compiles over lanes, a call does not, and says why.
one_state() { # MODEL PART CALL
  "$LAGC" header "$1" --with "$2" --prefix all -o "$TMP/all.h" || return 1
  printf '#define ALL_LANES 4\n#define ALL_STATIC\n#include "all.h"\nint main(void) { all_params p; all_state s; all_defaults(&p); (void)all_start(&p, &s); %s }\n' 'return 0;' >"$TMP/lanes.c"
  gcc -std=c99 -O1 -w -iquote "$TMP" "$TMP/lanes.c" -lm -o "$TMP/lanes" || return 1
  sed "s/return 0;/$3/" "$TMP/lanes.c" >"$TMP/call.c"
  ! gcc -std=c99 -O0 -w -iquote "$TMP" "$TMP/call.c" -lm -o "$TMP/lanes" 2>"$TMP/err" && grep -q 'computes one state, not ALL_LANES: .* by a second header without ALL_LANES' "$TMP/err"
}
check "steps to an event over lanes are refused by the compiler" one_state models/bouncing_ball.lag events 'int e; return all_step_until_event(\&p, \&s, ALL_C(0.1), \&e);'
check "and variational ones" one_state models/pendulum.lag variational 'all_variational w; return all_variational_step(\&p, \&s, \&w, ALL_C(0.1));'
check "and Moreau's" one_state models/room.lag moreau 'return all_moreau_step(\&p, \&s, ALL_C(0.1), 0);'

march=
grep -q ' fma .* avx2 ' /proc/cpuinfo 2>/dev/null && march=-march=x86-64-v3
grep -q ' avx512dq ' /proc/cpuinfo 2>/dev/null && march=-march=x86-64-v4
# shellcheck disable=SC2086
slow check "8 lanes of the processor" lanes models/double_pendulum.lag 8 rk45 gcc -std=c99 $march
# shellcheck disable=SC2086
slow check "and of taylor" lanes models/double_pendulum.lag 8 taylor gcc -std=c99 -DTAYLOR $march
if command -v clang >/dev/null; then
  # shellcheck disable=SC2086
  slow check "by clang" lanes models/slider_crank.lag 8 dop853 clang -std=c99 $march -DHOLD
else
  skip "8 lanes by clang" "there is no clang"
fi

# Steps of one size: lane 1, whose mass is 0, stays where it is; the others have the bits of their motions alone.
fixed() { # MODEL METHOD MASS ARGUMENTS_OF_LANES ARGUMENTS
  with="--with $2"
  [ "$2" = rk4 ] && with=
  # shellcheck disable=SC2086
  "$LAGC" header "$1" $with --prefix all -o "$TMP/all.h" && "$LAGC" header "$1" $with --prefix one -o "$TMP/one.h" || return 1
  cat >"$TMP/fixed.c" <<END
#define ALL_LANES 4
#define ALL_STATIC
#include "all.h"
#define ONE_STATIC
#define ONE_AS_LANES 1
#include "one.h"
#include <stdio.h>
#include <string.h>
int main(void) {
  all_params p;
  all_state s;
  ALL_REAL all_a[ALL_NQ] = {{0}};
  (void)all_a;
  all_defaults(&p);
  all_start(&p, &s);
  for (int k = 0; k < 4; k++) s.q[0][k] += 0.1*k;
  p.$3[1] = 0;
  const all_state from = s;
  for (int n = 0; n < 20; n++)
    if (all_$2_step(&p, &s, ALL_C(0.01)$4) != -2) return 3;
  for (int k = 0; k < 4; k++) {
    one_params q;
    one_state r;
    double one_a[ONE_NQ] = {0};
    (void)one_a;
    one_defaults(&q);
    one_start(&q, &r);
    r.q[0] += 0.1*k;
    for (int n = 0; n < 20 && k != 1; n++)
      if (one_$2_step(&q, &r, 0.01$5)) return 4;
    for (int i = 0; i < ONE_NQ; i++)
      if (s.q[i][k] != (k == 1 ? from.q[i][k] : r.q[i]) || s.v[i][k] != (k == 1 ? from.v[i][k] : r.v[i])) return printf("lane %d: %.17g %.17g\\n", k, s.q[i][k], r.q[i]), 1;
    if (s.t[k] != (k == 1 ? from.t[k] : r.t)) return 5;
  }
  return 0;
}
END
  gcc -std=c99 -O1 -ffp-contract=off -Wall -Wextra -Wno-psabi -Werror -iquote "$TMP" "$TMP/fixed.c" -lm -o "$TMP/fixed" && "$TMP/fixed"
}
check "rk4 over lanes: one that fails does not stop the others" fixed models/double_pendulum.lag rk4 m2
printf "model pair\ncoord x [m], y [m]\nparam m = 1 [kg], n = 0 [kg], k = 2 [N/m] > 0\nkinetic = m/2*(x'^2 + y'^2) + n*x'*y'\npotential = k/2*x^2 + k*y^2\nscene run { start x = 1, y = 0.5; span 5 }\n" >"$TMP/pair.lag"
check "and verlet" fixed "$TMP/pair.lag" verlet m ', all_a' ', one_a'

# ---- constraints that cannot be met: a circle of radius sqrt(w)
printf "model ring\ncoord x, y\nparam w = 1\nlagrangian = (x'^2 + y'^2)/2 - y\nconstraint c: x^2 + y^2 = w\nscene s { start x = 1 }\n" >"$TMP/ring.lag"
"$LAGC" header "$TMP/ring.lag" --with rk45,dop853 -o "$TMP/ring.h"
cat >"$TMP/ring.c" <<'END'
#define RING_IMPLEMENTATION
#include "ring.h"
static int begin(ring_state *s, double w) {
  ring_params p;
  ring_defaults(&p);
  p.w = w;
  return ring_start(&p, s);
}
int main(void) {
  ring_params p;
  ring_state s, was;
  ring_adaptive w;
  ring_defaults(&p);
  if (begin(&s, 4) != RING_OK || !(fabs(s.q[0] - 2) < 1e-15)) return 1;
  if (begin(&s, -1) != RING_EUNMET || begin(&s, 0.0/0.0) != RING_EUNMET) return 2;
  if (begin(&s, 1) != RING_OK) return 3;
  was = s;
  p.w = -1;
  if (ring_rk4_step(&p, &s, 0.01) != RING_EUNMET) return 4;
  ring_adaptive_begin(&w, 1e-6);
  if (ring_rk45_step(&p, &s, &w, 1) != RING_ESTEP) return 5;
  ring_adaptive_begin(&w, 1e-6);
  if (ring_dop853_step(&p, &s, &w, 1) != RING_ESTEP) return 6;
  return s.q[0] != was.q[0] || s.v[1] != was.v[1] || s.t != was.t;
}
END
unmet() { "$@" -O1 -Wall -Wextra -Werror -iquote "$TMP" "$TMP/ring.c" -o "$TMP/ring" -lm && "$TMP/ring"; }
check "constraints that cannot be met are a status, and the state stays" unmet "$CC" -std=c99
# The crank is longer than the rod: Newton's method leads there by a turn that comes no nearer.
"$LAGC" header models/slider_crank.lag -o "$TMP/crank.h"
cat >"$TMP/crank.c" <<'END'
#define CRANK_IMPLEMENTATION
#include "crank.h"
int main(void) {
  crank_params p;
  crank_state s;
  crank_defaults(&p);
  p.a = 3;
  return crank_start(&p, &s) != CRANK_OK || !(fabs(sin(s.q[2]) + 3*sin(s.q[0])) < 1e-14) || !(fabs(s.q[1] - cos(s.q[2]) - 3*cos(s.q[0])) < 1e-14);
}
END
far_off() { "$CC" -O1 -iquote "$TMP" "$TMP/crank.c" -o "$TMP/crank" -lm && "$TMP/crank"; }
check "a start that is far from its constraints gets there" far_off

# A long rod beside a gear that turns fast: what is left of the rod's constraint is rounding, and more than what the gear's is off by after a step. A gear doubled by
# one with another offset contradicts it, and least changes have no way to go. Two units, over lanes too: one that fails for good says so.
cat >"$TMP/gears.lag" <<'END'
model gears
coord x [m], y [m], a [rad], b [rad]
param L = 3e9 [m] > 0, th = 1, off = 0
kinetic = 1 [kg]/2*(x'^2 + y'^2) + 1 [kg*m^2]/2*(a'^2 + b'^2)
constraint rod: x^2 + y^2 = L^2
constraint gear: a = 2*b + b^3
constraint doubled: 2*a = 4*b + 2*b^3 + off
scene s { start x = L*cos(th), y = L*sin(th), a = 0.864, b = 0.4, a' = 14.88, b' = 6 }
END
"$LAGC" header "$TMP/gears.lag" --with rk45 --prefix one -o "$TMP/gear.h"
"$LAGC" header "$TMP/gears.lag" --with rk45 --prefix all -o "$TMP/gears.h"
cat >"$TMP/gears.c" <<'END'
#define ONE_IMPLEMENTATION
#include "gear.h"
#define ALL_LANES 4
#define ALL_STATIC
#include "gears.h"
static int alone(void) {
  one_params p;
  one_state s;
  one_defaults(&p);
  for (p.th = 0.01; p.th < 6; p.th += 0.01) {
    if (one_start(&p, &s) != ONE_OK) return 1;
    for (int i = 0; i < 10; i++)
      if (one_rk4_step(&p, &s, 0.01) != ONE_OK || !(fabs(s.q[2] - 2*s.q[3] - s.q[3]*s.q[3]*s.q[3]) < 1e-14)) return 2;
  }
  p.off = 0.1;
  return one_start(&p, &s) != ONE_EUNMET ? 3 : 0;
}
int main(void) {
  all_params p;
  all_state s;
  all_adaptive w;
  ALL_REAL until = ALL_C(0.0) + 0.1;
  int status = 0;
  all_defaults(&p);
  if (alone() != 0) return alone();
  if (all_start(&p, &s) != ALL_OK) return 4;
  p.off[1] = 0.1;
  if (all_hold(&p, &s) != -2 || all_rk4_step(&p, &s, ALL_C(0.01)) != -2 || s.t[0] != 0.01 || s.t[1] != 0) return 5;
  all_adaptive_begin(&w, ALL_C(1e-6));
  for (int i = 0; i < 2000 && status == 0; i++) status = all_rk45_step(&p, &s, &w, until);
  return status != -2 || s.t[3] != until[3] ? 6 : 0;
}
END
beside() { gcc -std=c99 -O1 -Wall -Wextra -Wno-psabi -Werror -iquote "$TMP" "$TMP/gears.c" -o "$TMP/gears" -lm && "$TMP/gears"; }
check "rounding of long rods is no fault of short ones, contradictions are, and over lanes" beside

# ---- only what is asked for
asked() {
  "$LAGC" header models/double_pendulum.lag --with mass -o "$TMP/one.h" && grep -q '_mass(' "$TMP/one.h" && ! grep -qE '_(jac|linearize|dparams|inverse_dynamics|rk45_step|adapt)\(' "$TMP/one.h"
}
check "a part that is not asked for is not there" asked
lists_license() { "$LAGC" header models/pendulum.lag | sed -n 2p | grep -q 'SPDX-License-Identifier: 0BSD'; }
check "the licence stands in the second line, for machines" lists_license

# ---- refusals leave no file
refused() { # WORDS MODEL PART
  rm -f "$TMP/none.h"
  says 2 "$1" "$LAGC" header "models/$2.lag" --with "$3" -o "$TMP/none.h" && [ ! -e "$TMP/none.h" ]
}
check "no Jacobian with contacts" refused 'only of models with no contacts' room jac
check "no mass matrix of a flow" refused 'only of models with coordinates' lorenz mass
check "no events where there are none" refused 'only of models with events' pendulum events
check "no constraints where there are none" refused 'only of models with constraints' pendulum constraints
tap_end
