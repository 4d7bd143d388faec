#!/bin/sh
# Planets by wisdom_holman: lagc finds bodies and couplings in each way to write them; published positions; which models are refused, and why.
: "${LAGC:=build/lagc}" "${BUILD:=build}" "${INC:=runtime/include}" "${CC:=cc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
. tests/tap.sh

# The largest difference of the last rows of two files.
apart() { { tail -n 1 "$TMP/$1" && tail -n 1 "$TMP/$2"; } | awk -F, 'NR == 1 { n = split($0, x, ",") }
  NR == 2 { for (k = 1; k <= NF; k++) { d = $k - x[k]; d = d < 0 ? -d : d; if (d > worst) worst = d } }
  END { print (NR == 2 && NF == n ? worst + 0 : 1e9) }'; }
near() { awk -v x="$(apart "$1" "$2")" -v most="$3" 'BEGIN { exit !(x < most) }'; }
rows() { "$LAGC" run "$1" --quiet -o "$TMP/$2" ${3:+--method "$3"} $4 >"$TMP/out" 2>&1; }

# A star and two planets, five ways.
cat >"$TMP/family.lag" <<'END'
model family
const N = 3
coord r[N]: vec2
param m[N] = {1, 1e-3, 3e-4} > 0, G = 1 > 0
kinetic = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))
potential = -sum(i in 1..N, sum(j in 1..i-1, G*m[i]*m[j]/norm(r[i] - r[j])))
scene s {
  start r = {(0, 0), (1, 0), (0, 1.9)}, r' = {(0, 0), (0, 1.02), (-0.75, 0)}
  span 60
  output r[1].x, r[2].x, r[2].y, r[3].x, r[3].y every 7
}
END
cat >"$TMP/scalars.lag" <<'END'
model scalars
coord x1, y1, x3, y3, x2, y2
param m1 = 1 > 0, m2 = 1e-3 > 0, m3 = 3e-4 > 0
let r12 = sqrt((x1 - x2)^2 + (y1 - y2)^2)
let r13 = sqrt((x3 - x1)^2 + (y3 - y1)^2)
kinetic = m1/2*(x1'^2 + y1'^2) + m2*(x2'^2/2 + y2'^2/2) + m3/2*(x3'^2 + y3'^2)
potential = -m1*(m2/r12 + m3/r13) - m2*m3/sqrt((x2 - x3)^2 + (y2 - y3)^2)
scene s {
  start x2 = 1, y2' = 1.02, y3 = 1.9, x3' = -0.75
  span 60
  output x1, x2, y2, x3, y3 every 7
}
END
sed 's/const N = 3/const N = 3, M = N/; s/1\.\.i-1, G\*m\[i\]\*m\[j\]\/norm(r\[i\] - r\[j\])/i+1..M, G*m[i]*m[j]*dot(r[i] - r[j], r[i] - r[j])^(-1\/2)/' \
  "$TMP/family.lag" >"$TMP/powers.lag"
sed 's/^potential.*/let star = sum(i in 2..N, m[1]*m[i]\/norm(r[i] - r[1]))\npotential = -G*(star + m[2]*m[3]\/norm(r[2] - r[3]))/' "$TMP/family.lag" >"$TMP/star.lag"
rows "$TMP/family.lag" exact.csv dop853 "--tol 1e-13"
for way in family scalars powers star; do
  check "$way: runs" rows "$TMP/$way.lag" "$way.csv" 'wisdom_holman(step=0.3,scheme=aba864)'
  check "$way: as dop853" near "$way.csv" exact.csv 2e-10 # 60 times 1e-3*(0.3)^8 = 6e-8 of each radian, over 2e3 of the scheme's constant
done
rows "$TMP/family.lag" compiled.csv 'wisdom_holman(step=0.3,scheme=aba864)' "--compile always"
rows "$TMP/family.lag" evaluated.csv 'wisdom_holman(step=0.3,scheme=aba864)' "--compile never"
check "compiled and evaluated: the same digits" cmp "$TMP/compiled.csv" "$TMP/evaluated.csv"

# Two bodies of any masses are one Kepler motion: exact for any step. dop853 at its tolerance over ten turns, 1e-10.
cat >"$TMP/two.lag" <<'END'
model two
coord r[2]: vec3
param m[2] = {1, 0.7} > 0, k = 1.2 > 0
kinetic = sum(i in 1..2, m[i]/2*dot(r[i]', r[i]'))
potential = -k/norm(r[1] - r[2])
scene s { start r[1] = (1, 0, 0), r[2]' = (0, 0.8, 0.3); span 40; output r every 9 }
END
rows "$TMP/two.lag" two_exact.csv dop853 "--tol 1e-14"
rows "$TMP/two.lag" two.csv 'wisdom_holman(step=2.5)'
check "two bodies of comparable masses are exact" near two.csv two_exact.csv 1e-10

# A fixed centre: the ellipse of models/kepler.lag after ten turns is at its start, (0.4, 0); steps of a turn and a half. J2 of a satellite, in the
# kicks, over half a day: positions of 7e6 m to 1e-9 of them.
rows models/kepler.lag turns.csv 'wisdom_holman(step=9.4)' "--every 62.83185307179586"
echo 62.83185307179586,0.4,0 >"$TMP/start.csv"
cut -d, -f1-3 "$TMP/turns.csv" >"$TMP/turns_end.csv"
check "kepler, ten turns in seven steps" near turns_end.csv start.csv 1e-11
for method in 'dop853(max_step=600)' 'wisdom_holman(step=60,scheme=aba864)'; do
  "$LAGC" run models/satellite.lag flat --until 43200 --method "$method" --quiet -o - 2>/dev/null | cut -d, -f1-4 >"$TMP/j2_${method%%(*}.csv"
done
check "a satellite of an oblate planet: as dop853" near j2_wisdom_holman.csv j2_dop853.csv 7e-3

# A sum that stays a loop: two hundred bodies.
sed 's/const N = 3/const N = 200/; s/{1, 1e-3, 3e-4}/1e-6/
  s/start .*/start r[i in 2..N] = (sqrt(i)*cos(2.4*i), sqrt(i)*sin(2.4*i)), r[i in 2..N]'\'' = (-sin(2.4*i), cos(2.4*i))*i^(-0.25); m[1] = 1/' \
  "$TMP/family.lag" >"$TMP/many.lag"
sed -i 's/span 60/span 8/' "$TMP/many.lag"
rows "$TMP/many.lag" many_exact.csv dop853 "--tol 1e-13"
rows "$TMP/many.lag" many.csv 'wisdom_holman(step=0.2)'
check "two hundred bodies: as dop853" near many.csv many_exact.csv 1e-8

# Outer planets after 10^4 years: digits of Taylor series in quadruple precision, tests/bench/planets.h. 1e-9: errors of rounding, 1e-16 a step in the
# energy, move Jupiter by 1e-16*sqrt(18262)*1.5*5300 rad at 5 au, 5e-10.
planets_after() { # STEP SCHEME ERROR
  tr ',' '\n' <tests/bench/planets.h | awk 'NF == 1 && /[0-9]/ { print $1 }' >"$TMP/digits"
  "$LAGC" run tests/bench/models/outer_planets.lag --method "wisdom_holman(step=$1,scheme=$2)" --quiet --every 3652500 -o "$TMP/planets.csv" >"$TMP/out" 2>&1
  tail -n 1 "$TMP/planets.csv" | tr ',' '\n' | sed '1d; 20,$d' | paste - "$TMP/digits" |
    awk -v most="$3" '{ d = $1 - $2; d = d < 0 ? -d : d; if (d > worst) worst = d } END { print NR, worst; exit !(NR == 18 && worst < most) }'
}
check "outer planets, 10^4 years, aba864" planets_after 200 aba864 1e-9
check "outer planets, 10^4 years, sbab2: 7e-3 au" planets_after 400 sbab2 7e-3

refused() { # NAME WORDS: the model $TMP/NAME.lag with the method in its scene
  sed -i 's/span 60/span 60; method wisdom_holman(step = 0.1)/' "$TMP/$1.lag"
  check "refused: $1" says "${3:-1}" "$2" "$LAGC" run --quiet "$TMP/$1.lag"
}
soft() { sed "s/norm(r\[i\] - r\[j\])/sqrt(dot(r[i] - r[j], r[i] - r[j]) + 0.01)/" "$TMP/family.lag"; }
soft >"$TMP/soft.lag"
refused soft 'the potential has no term -k/r of a distance in Cartesian coordinates'
sed 's/^kinetic.*/& + m[2]*r[2].x'\''*r[2].y'\''\/9/' "$TMP/family.lag" >"$TMP/coupled.lag"
refused coupled 'velocities of different coordinates occur in one product'
sed 's/^kinetic.*/& + m[2]*r[2].x'\''^2\/9/' "$TMP/family.lag" >"$TMP/uneven.lag"
refused uneven 'the coordinates of a body have different masses'
sed 's/^coord.*/&\ncoord s/; s/^kinetic.*/& + s'\''^2\/2/' "$TMP/family.lag" >"$TMP/beside.lag"
refused beside 'no term -k/r contains the coordinate `s`'
sed 's/^kinetic.*/&\nforce r[2] = -0.1*r[2]'\''/' "$TMP/family.lag" >"$TMP/drag.lag"
refused drag 'forces depend on velocities'
sed 's/1e-3, 3e-4/0.5, 3e-4/' "$TMP/family.lag" >"$TMP/heavy.lag"
refused heavy 'the mass of r[2].x is 0.5 of the largest' 3
sed "s/(0, 1.9)}/(1, 0)}/; s/(-0.75, 0)}/(0, 1.02)}/" "$TMP/family.lag" >"$TMP/touch.lag"
refused touch "at t = 0 s: the model gives no finite value for r[2].x''" 3
check "figure_eight is refused" says 3 'needs one body that dominates' "$LAGC" run --quiet models/figure_eight.lag --method wisdom_holman
check "pendulum is refused" says 2 'terms -k/r' "$LAGC" run models/pendulum.lag --method wisdom_holman
check "lyapunov names another" says 2 'verlet8 has' "$LAGC" lyapunov models/kepler.lag --method wisdom_holman
check "headers name others" says 2 'verlet8, variational' "$LAGC" header models/kepler.lag --with wisdom_holman
check "cost has it in its table" says 0 'wisdom_holman' "$LAGC" cost models/kepler.lag --until 10 --seconds 1 --methods wisdom_holman,rk4
tap_end
