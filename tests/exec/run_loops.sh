#!/bin/sh
# Long models: their C has loops, is short, compiles fast, and agrees with straight-line code to the last bit.
. tests/tap.sh
mkdir -p "$TMP/m" "$TMP/c"

# ---- models
longer() { sed "s/^const N = .*/const N = $2/; s/^model $1/model $1_$2/" "models/$1.lag" >"$TMP/m/$1_$2.lag"; }
longer chain 120
longer string 500

# The chain without families, links one by one.
awk 'BEGIN {
  print "model by_hand\nparam m = 1 > 0, l = 1 > 0, g = 9.81 > 0\nlet x0 = 0, y0 = 0"
  for (i = 1; i <= 100; i++) {
    printf "coord a%d\nlet x%d = x%d + l*sin(a%d)\nlet y%d = y%d - l*cos(a%d)\n", i, i, i-1, i, i, i-1, i
    L = L (i > 1 ? " + " : "") sprintf("m/2*(x%d'"'"'^2 + y%d'"'"'^2) - m*g*y%d", i, i, i)
  }
  print "lagrangian = " L
}' >"$TMP/m/by_hand.lag"

# Pairs of bodies in space; a lattice with two indices, hard springs and friction; links with two angles.
cat >"$TMP/m/bodies.lag" <<'END'
model bodies
const N = 20
coord r[N]: vec3
param m[N] = 1 > 0, G = 1, soft = 0.1
kinetic = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))
potential = -sum(i in 1..N, sum(j in 1..i-1, G*m[i]*m[j]/sqrt(dot(r[i] - r[j], r[i] - r[j]) + soft^2)))
END
cat >"$TMP/m/lattice.lag" <<'END'
model lattice
const N = 16
coord u[N,N]
param m = 1 > 0, k = 1, b = 0.1
let up[i in 1..N, j in 1..N] = if(i > 1, u[i,j] - u[i-1,j], u[i,j])
let side[i in 1..N, j in 1..N] = if(j > 1, u[i,j] - u[i,j-1], u[i,j])
kinetic = sum(i in 1..N, sum(j in 1..N, m/2*u[i,j]'^2))
potential = sum(i in 1..N, sum(j in 1..N, k/2*(up[i,j]^2 + side[i,j]^2) + b/4*up[i,j]^4))
dissipation = sum(i in 1..N, sum(j in 1..N, 0.01*u[i,j]'^2))
END
cat >"$TMP/m/spatial.lag" <<'END'
model spatial
const N = 60
coord th[N], ph[N]
param m = 1 > 0, I = 0.1 > 0, g = 9.81 > 0
let x[0] = 0, y[0] = 0, z[0] = 0
let x[i in 1..N] = x[i-1] + sin(th[i])*cos(ph[i])
let y[i in 1..N] = y[i-1] + sin(th[i])*sin(ph[i])
let z[i in 1..N] = z[i-1] - cos(th[i])
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2 + z[i]'^2) + I/2*ph[i]'^2)
potential = sum(i in 1..N, m*g*z[i])
END
# Bodies without families, one by one, pairs in another order; a net of hard springs with two indices.
awk 'BEGIN {
  print "model bodies_by_hand\nparam G = 0.7, e = 0.01"
  for (i = 1; i <= 24; i++) {
    printf "param mass%d = %d > 0\ncoord x%d, y%d\n", i, i, i, i
    T = T (i > 1 ? " + " : "") sprintf("mass%d/2*(x%d'"'"'^2 + y%d'"'"'^2)", i, i, i)
    for (d = 1; d < i; d++) V = V sprintf(" - G*mass%d*mass%d/sqrt((x%d - x%d)^2 + (y%d - y%d)^2 + e)", i, i - d, i, i - d, i, i - d)
  }
  print "kinetic = " T "\npotential = 0" V
}' >"$TMP/m/bodies_by_hand.lag"
cat >"$TMP/m/net.lag" <<'END'
model net
const N = 20, K = 30
coord u[N,K]
param m = 1 > 0, k = 1, b = 0.3
kinetic = sum(i in 1..N, sum(j in 1..K, m/2*u[i,j]'^2))
potential = sum(i in 1..N, sum(j in 1..K-1, k/2*(u[i,j+1] - u[i,j])^2 + b/4*(u[i,j+1] - u[i,j])^4)) +
            sum(i in 1..N-1, sum(j in 1..K, k/2*(u[i+1,j] - u[i,j])^2 + b/4*(u[i+1,j] - u[i,j])^4))
END
# Choices, functions, and steps of two.
cat >"$TMP/m/odd.lag" <<'END'
model odd
const N = 200
coord x[N]
param k = 1, c[N] = 0.5
kinetic = sum(i in 1..N, x[i]'^2/2)
potential = sum(i in 1..N, k*sqrt(1 + x[i]^2)) + sum(i in 3..N, if(x[i] > x[i-2], (x[i] - x[i-2])^2, 0))
for i in 2..N { force x[i] = -c[i]*max(x[i]', 0.1)*sign(x[i-1]) }
END
# Edge cases of loops: a number known only from later turns; a value of the first turn that all turns read.
cat >"$TMP/m/comb.lag" <<'END'
model comb
const N = 40
coord th[N], s[N]
param m = 1 > 0, n = 0.3 > 0
let x[0] = 0, y[0] = 0
let x[i in 1..N] = x[i-1] + sin(th[i])
let y[i in 1..N] = y[i-1] - cos(th[i])
let u[i in 1..N] = x[i] + 0.5*sin(s[i])
let w[i in 1..N] = y[i] - 0.5*cos(s[i])
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2) + n/2*(u[i]'^2 + w[i]'^2))
potential = sum(i in 1..N, m*y[i] + n*w[i])
END
cat >"$TMP/m/star.lag" <<'END'
model star
const N = 600
coord x[N]
param k[N] = 1, c[N] = 1
kinetic = sum(i in 1..N, x[i]'^2/2)
for i in 1..N { force x[i] = c[i]*(tanh(x[i]) + k[i])*tanh(x[1]) }
END
# A mass matrix without zeros, and one of a band.
cat >"$TMP/m/full.lag" <<'END'
model full
const N = 30
coord x[N]
param m = 1 > 0
kinetic = sum(i in 1..N, m/2*x[i]'^2) + sum(i in 1..N, x[i]')^2/300
potential = sum(i in 1..N, x[i]^4/4)
END
cat >"$TMP/m/band.lag" <<'END'
model band
const N = 30
coord x[N]
param m = 1 > 0, c = 0.1
kinetic = sum(i in 1..N, m/2*x[i]'^2) + sum(i in 2..N, c*x[i]*x[i]'*x[i-1]')
potential = sum(i in 1..N, x[i]^4/4)
END
# A full definite matrix that no sum makes.
cat >"$TMP/m/dense.lag" <<'END'
model dense
const N = 22
coord x[N]
param m = 1 > 0, c = 0.1 > 0
kinetic = sum(i in 1..N, m/2*x[i]'^2) + sum(i in 2..N, sum(j in 1..i-1, c*exp(x[i]*x[j])*(x[i]' - j*x[j]')^2))
potential = sum(i in 1..N, x[i]^4/4)
END
models=$(ls "$TMP"/m/*.lag)
[ -n "${SLOW:-}" ] || models=$(echo "$models" | grep -v '/odd\|/string_500') # the slowest to compile

# ---- emitted C
emit_all() {
  n=10 # of two digits, as files are sorted
  for m in $models; do
    n=$((n + 1))
    "$LAGC" emit "$m" -o "$TMP/c/m$n.c" || return 1
  done
}
check "lagc emit" emit_all
has_loops() { # MODEL LINES: at most so many between the braces of accel
  "$LAGC" derive "$TMP/m/$1.lag" --format c >"$TMP/accel.c" && grep -q 'for (int [ijk]' "$TMP/accel.c" || { echo "no loop"; return 1; }
  lines=$(wc -l <"$TMP/accel.c")
  [ "$lines" -le "$2" ] || { echo "$lines lines"; return 1; }
}
check "a chain of 120 links: as long as one of 20" has_loops chain_120 300
check "a chain by hand rolls, too" has_loops by_hand 300
check "500 masses on springs" has_loops string_500 60
check "a lattice" has_loops lattice 140
check "a net of springs" has_loops net 80
check "links in space" has_loops spatial 800
check "pairs of 20 bodies" has_loops bodies 70
check "24 bodies by hand" has_loops bodies_by_hand 80
check "2,415 pairs, which stay a sum, run" "$LAGC" run tests/bench/models/bodies.lag -DN=70 --until 0.001 --quiet -o "$TMP/seventy.csv"
check "and stays one where all parameters are numbers" "$LAGC" emit tests/bench/models/bodies.lag -DN=70 --fix all -o "$TMP/seventy.c"
is "with one nest for its forces" 1 "$(sed -n '/^static int accel/,/^}/p' "$TMP/seventy.c" | grep -c 'for (int i = 0; i < 69')"
slow check "choices and functions" has_loops odd 120
check "side rods along a chain" has_loops comb 330
check "all pulled by the first" has_loops star 20
short() { lines=$("$LAGC" derive "$TMP/m/$1.lag" --format c | wc -l); [ "$lines" -le "$2" ] || { echo "$lines lines"; return 1; }; }
check "a mass matrix that one sum makes full: ten lines a row" short full 330
check "a band: zeros take none" short band 320
solved_by() { "$LAGC" derive "$TMP/m/$1.lag" --format c | grep -q "$2" || { "$LAGC" derive "$TMP/m/$1.lag" --format c | grep lag_solve; return 1; }; }
check "a full matrix by a loop" solved_by dense 'lag_solve(22, w, w + 484)'
check "one that may be indefinite by a loop" solved_by band 'lag_solve(30, w, w + 900)'
# Two coordinates a body, coupled around a ring by velocities of no declared sign: M, in the order of the text as wide as the ring, is a band in another one.
# A mode x = y = cos(2 pi 5 i/60) cos(w t) has w^2 = 1/(2 + 2 c cos(2 pi 5/60) + d); other modes, of negative inertia, grow from rounding by no more than e^(1/sqrt(0.02)) = 1e3
cat >"$TMP/m/around.lag" <<'END'
model around
const N = 60
coord x[N], y[N]
param m = 2, c = 1.5, d = 0.7
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2) + d*x[i]'*y[i]') + sum(i in 1..N-1, c*(x[i]'*x[i+1]' + y[i]'*y[i+1]')) + c*(x[N]'*x[1]' + y[N]'*y[1]')
potential = sum(i in 1..N, x[i]^2 + y[i]^2)/2
scene s { start x[i in 1..N] = cos(pi*i/6), y[i in 1..N] = cos(pi*i/6); span 1; tolerance 1e-11 }
END
"$LAGC" run "$TMP/m/around.lag" --json >"$TMP/around.json" 2>&1
final() { sed 's/.*"y\['"$1"'\]": \([^,}]*\).*/\1/' "$TMP/around.json"; }
of_mode() { awk "BEGIN { printf \"%.17g\", $1*cos(1/sqrt(2.7 + 3*cos(4*atan2(1, 1)/6))) }"; }
near "an indefinite ring: its mode" "$(final 60)" "$(of_mode 1)" 1e-9
near "at another place" "$(final 2)" "$(of_mode 0.5)" 1e-9
few() { n=$("$LAGC" emit "$TMP/m/around.lag" | sed -n 's/.*Accelerations: \([0-9]*\) operations.*/\1/p' | head -1); [ "$n" -lt 15000 ] || { echo "$n operations"; return 1; }; }
check "in the operations of a band, 170 a body, not of a full matrix, 20,000" few
is "a string of 10,000 is not written out" "" "$("$LAGC" emit models/string.lag -DN=10000 2>&1 >"$TMP/string.c")"
in_one_loop() { "$LAGC" derive "$TMP/m/string_500.lag" --format c | grep -q '^    a\[k + [0-9]*\] = '; }
check "a string's accelerations are stored where they are computed" in_one_loop
small() { "$LAGC" emit models/string.lag hard -DN=10000 -o "$TMP/string.c" && [ "$(wc -c <"$TMP/string.c")" -lt 131072 ]; }
slow check "10,000 masses on springs: less than 128 kB of C" small
start_agrees() { # the start of the mode, and the names, against their formulas
  cat >"$TMP/start.c" <<'END'
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "lag_model.h"
extern const lag_scene string_hard;
static double p[8], q[10000], v[10000];
int main(void) {
  static const unsigned char none[8];
  char name[16];
  string_hard.params(&string_hard, p, none);
  string_hard.start(&string_hard, p, q, v, NULL);
  for (int i = 1; i <= 10000; i++) {
    snprintf(name, sizeof name, "u[%d]", i);
    if (strcmp(string_hard.model->q[i - 1].name, name) != 0 || strcmp(string_hard.model->q[i - 1].unit, "m") != 0) return 1;
    if (!(fabs(q[i - 1] - sin(i*3.14159265358979323846/10001)) < 1e-15)) return 2; /* rounding of an argument up to pi */
  }
  return string_hard.model->nq != 10000;
}
END
  "$CC" -std=c11 -w -I"$INC" "$TMP/start.c" "$TMP/string.c" -lm -o "$TMP/start" && "$TMP/start"
}
slow check "its start and its names" start_agrees
bodies() {
  timeout 100 "$LAGC" emit tests/bench/models/bodies.lag -DN=256 -o "$TMP/bodies.c" || { echo "not emitted in 100 s"; return 1; }
  bytes=$(wc -c <"$TMP/bodies.c")
  [ "$bytes" -lt 65536 ] || { echo "$bytes bytes"; return 1; }
  timeout 100 "$CC" -O2 -std=c11 -I"$INC" -c "$TMP/bodies.c" -o "$TMP/bodies.o" || { echo "not compiled in 100 s"; return 1; }
  "$CC" -std=c11 -w -I"$INC" tests/exec/bodies_256.c "$TMP/bodies.o" -lm -o "$TMP/bodies" && "$TMP/bodies"
}
slow check "256 bodies: less than 64 kB of C, which computes what loops by hand do" bodies
is "a short model has none" 0 "$("$LAGC" derive models/chain.lag --format c | grep -c 'for (int k')"

strict='-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror'
# shellcheck disable=SC2086 # flags
check "the C is clean" "$CC" -std=c11 $strict -fsyntax-only -I"$INC" "$TMP"/c/*.c
# shellcheck disable=SC2086
[ -z "${CLANG:-}" ] || slow check "the C is clean with clang" "$CLANG" -std=c11 $strict -fsyntax-only -I"$INC" "$TMP"/c/*.c
header() {
  "$LAGC" header "$TMP/m/chain_120.lag" -o "$TMP/chain.h" && printf '#define CHAIN_IMPLEMENTATION\n#include "chain.h"\nint main(void) { return 0; }\n' >"$TMP/header.c" &&
    grep -q 'for (int k' "$TMP/chain.h" && "$CC" -std=c11 $strict -I"$TMP" -c "$TMP/header.c" -o "$TMP/header.o"
}
slow check "a header of a long chain" header

# ---- values
ids=
for f in "$TMP"/c/*.c; do ids="$ids $(sed -n 's/^const lag_scene \([a-z0-9_]*\) = .*/\1/p' "$f" | head -1)"; done
{
  echo '#include "lag_model.h"'
  for i in $ids; do echo "extern const lag_scene $i;"; done
  echo 'extern const lag_scene *const all_scenes[];'
  echo 'const lag_scene *const all_scenes[] = {'
  for i in $ids; do echo "  &$i,"; done
  echo '  0};'
} >"$TMP/scenes.c"
agrees() {
  "$CC" -std=gnu11 "${LAGC_OPTIMISE:--O1}" -w -ffp-contract=off -D_XOPEN_SOURCE=700 -Isrc -I"$BUILD/gen" -I"$INC" -DMAX=1200 '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L' \
    tests/exec/emit_agree.c "$TMP"/c/*.c "$TMP/scenes.c" "$BUILD/liblagc.a" -lm -o "$TMP/agree" && "$TMP/agree" $models
}
check "loops compute what the program says, to the last bit" agrees
# Side by side, by two and by four, against one after the other: pairs that stay a sum, turns, and roots written out.
avx=
! grep -q ' avx ' /proc/cpuinfo 2>/dev/null || avx=-mavx
turns() { # N
  for flag in -DLAG_REAL=double '' $avx; do
    CC="$CC $flag" "$LAGC" build tests/bench/models/bodies.lag -DN="$1" -o "$TMP/turns" && "$TMP/turns" --quiet --until 0.05 -o "$TMP/turns$flag.csv" || return 1
    cmp "$TMP/turns-DLAG_REAL=double.csv" "$TMP/turns$flag.csv" || return 1
  done
}
for n in 6 20 70; do check "$n bodies: turns side by side have the bits of turns one by one" turns $n; done

# ---- chains of point masses: the tridiagonal system of the rods' tensions, by hand (tests/bench/hand/chain.c)
# Masses and lengths of 0.01 to 30: condition numbers of some 1e6 (bench/driver.c: within 1e-8 of the largest acceleration). 5 and 6: an odd and an even
# number of rods, which wait for one division by twos; 41: loops.
sed 's/^scene swing.*/&\n  m[2] = 0.01 [kg]\n  m[4] = 30 [kg]\n  l[3] = 0.2 [m]\n  l[5] = 3 [m]/' models/chain.lag >"$TMP/uneven.lag"
tensions() {
  "$LAGC" emit "$TMP/uneven.lag" -DN="$1" -o "$TMP/uneven.c" || return 1
  "$CC" -std=gnu11 -w -I"$INC" -Itests/bench -DSCENE=chain_swing '-DPEERS=X(linear) X(dense)' -DN="$1" tests/bench/driver.c "$TMP/uneven.c" \
    tests/bench/hand/chain.c -lm -o "$TMP/uneven" && "$TMP/uneven" check
}
for n in 5 6 41; do check "a chain of $n: as by tensions" tensions $n; done
# A division a rod, and one that every two rods wait for: 41 + 40/2. Without the recursion there are 41, one behind the other.
is "two rods wait for one division" "61 divisions" "$("$LAGC" emit models/chain.lag -DN=41 -o - | sed -n 's/.*Accelerations: .*, \([0-9]* divisions\).*/\1/p' | head -1)"

# ---- neighbours' velocities multiplied: a tridiagonal mass matrix, positive definite by its diagonal, which no turn alone shows.
# Elimination and substitution: ten operations a mass; as a dense matrix they would be N^3/3.
cat >"$TMP/coupled.lag" <<'END'
model coupled
const N = 2000
coord x[N]
param m = 1, k = 1
kinetic = sum(i in 1..N, m*x[i]'^2) + sum(i in 1..N-1, m/4*x[i]'*x[i+1]')
potential = sum(i in 1..N, k/2*x[i]^2)
END
fewest() { [ "$("$LAGC" derive "$TMP/coupled.lag" --ops | sed 's/ .*//;q')" -le 20000 ]; }
check "neighbours' velocities multiplied: ten operations a mass" fewest
is "definite where the diagonal outweighs" "positive definite by the signs of its parameters' values" \
  "$("$LAGC" check "$TMP/coupled.lag" | sed -n 's/.*constant, \(.*values\);.*/\1/p')"

# ---- memory and time of compilation
# 3160 pairs of charges, three scenes: each program that a pass replaces, and each block that an array outgrows, is given up. With them it takes 360 MB.
within() { (ulimit -v 250000 && "$LAGC" build models/electron_cloud.lag -DN=80 -o "$TMP/cloud"); }
slow check "sums over 3160 pairs are compiled within 250 MB" within
grows() {
  "$LAGC" emit models/chain.lag -DN=1000 -o "$TMP/long.c" && awk '/^static int accel/,/^}/' "$TMP/long.c" | wc -l >"$TMP/lines" && [ "$(cat "$TMP/lines")" -le 300 ] || return 1
  timeout 60 "$CC" -O2 -std=c11 -I"$INC" -c "$TMP/long.c" -o "$TMP/long.o"
}
slow check "a chain of 1000 links is emitted and compiled" grows
tap_end
