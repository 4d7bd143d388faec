#!/bin/sh
# Sums of 1/r by a tree: the same digits evaluated, compiled and in lanes; the direct sum's at the opening angle 0; errors are said, and are as small.
: "${LAGC:=build/lagc}" "${BUILD:=build}" "${INC:=runtime/include}" "${CC:=cc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
. tests/tap.sh

cat >"$TMP/disc.lag" <<'END'
model disc "Charges of unequal mass on a spiral, held by springs"
const N = 90
coord r[N]: vec2
param k = 2 > 0, e = 0.3 > 0, m[N] = 1 > 0, theta = 0.5
kinetic = sum(i in 1..N, m[i]*dot(r[i]', r[i]')/2)
potential = sum(i in 1..N, dot(r[i], r[i])*m[i]/2) +
  k/N*sum(i in 1..N-1, sum(j in i+1..N, m[i]*m[j]/sqrt(e^2 + dot(r[i] - r[j], r[i] - r[j])), by tree(theta)))
scene s { start r[i in 1..N] = (sqrt(i)*cos(2.4*i), sqrt(i)*sin(2.4*i)), r[1]' = (1, 0)
  m[3] = 2; m[40] = 5
  span 1; method verlet(step = 0.05); output r[1].x, r[90].y, energy every 0.5 }
END
sed 's/, by tree(theta)//' "$TMP/disc.lag" >"$TMP/direct.lag"

rows() { "$LAGC" run "$TMP/$1.lag" -o "$TMP/rows.csv" $2 >"$TMP/out" 2>&1 && cat "$TMP/rows.csv"; }
rows disc "--compile never" >"$TMP/evaluated"
rows disc "--compile always" >"$TMP/compiled"
check "three rows" test "$(grep -c '^[0-9]' "$TMP/evaluated")" = 3
check "evaluated and compiled: the same digits" cmp "$TMP/evaluated" "$TMP/compiled"

# Differences of the last row from that of the direct sum, in the largest of its values. The springs keep errors as they are: the rounding of
# 100 sums at the angle 0; at 0.5, where one force is right to 1e-3 of the mean and errors differ in sign, less than that.
rows direct "--compile never" >"$TMP/direct"
apart() { { tail -1 "$TMP/direct"; tail -1 "$TMP/$1"; } | awk -F, -v limit="$2" -v below="$3" '
  NR == 1 { for (k = 2; k <= NF; k++) x[k] = $k }
  NR == 2 { for (k = 2; k <= NF; k++) { d = $k - x[k]; d = d < 0 ? -d : d; if (d > worst) worst = d }
            bad = !(below ? worst < limit : worst > limit) }
  END { exit NR < 2 || bad }'; }
rows disc "theta=0 --compile never" >"$TMP/angle_0"
check "the opening angle 0 is the direct sum" apart angle_0 1e-11 1
check "the opening angle 0.5 is close to it" apart evaluated 3e-3 1
check "and another sum" apart evaluated 1e-9 0

# One body has no pairs: its spring alone holds it.
sed 's/N = 90/N = 1/; s/m\[3\] = 2; m\[40\] = 5//; s/r\[90\]/r[1]/; s/1\.\.N-1/1..N/; s/i+1\.\.N/1..i-1/' "$TMP/disc.lag" >"$TMP/alone.lag"
sed '/^potential/s/ +$//; /sum(j in/d' "$TMP/alone.lag" >"$TMP/sprung.lag"
rows alone >"$TMP/alone"
rows sprung >"$TMP/sprung"
check "a tree of one body" test "$(grep -c '^[0-9]' "$TMP/alone")" = 3
check "moves as its spring alone does" cmp "$TMP/alone" "$TMP/sprung"

check "check says the error at the start" says 0 "a tree takes this sum of 1/r over 90 bodies: at the start its forces differ" "$LAGC" check "$TMP/disc.lag"
check "an angle above 1 is refused" says 2 "1 less the opening angle of the tree" "$LAGC" run "$TMP/disc.lag" theta=1.5

# Time in a sum that stays one: work is done on the charges.
for way in disc direct; do
  sed 's|  k/N|  cos(t)*k/N|; s|, by|/(2 + sin(t)), by|' "$TMP/$way.lag" >"$TMP/driven.lag"
  check "time is seen, $way" says 0 "work of forces and explicit time" "$LAGC" run "$TMP/driven.lag"
done

sweep() { "$LAGC" sweep "$TMP/disc.lag" 'k=2,2.1,2.2,2.3,2.4,2.5,2.6,2.7' --measure 'a=r[1].x(end)' "$@" >/dev/null 2>&1; }
slow sweep -o "$TMP/lanes.csv"
[ -z "${SLOW:-}" ] || is "a sweep in lanes has the digits of a run" "$(sed -n 's/^2,\(.*\),ok/\1/p' "$TMP/lanes.csv")" \
  "$(sed -n 's/^1,\([^,]*\),.*/\1/p' "$TMP/compiled")"

"$LAGC" emit "$TMP/disc.lag" --standalone -o "$TMP/disc.c"
check "its C stands alone" "$CC" -std=c11 -Wall -Wextra -pedantic -Werror -I "$INC" -fsyntax-only "$TMP/disc.c"
lines() { "$LAGC" emit "$TMP/disc.lag" -D "N=$1" | sed -n '/^static int accel/,/^}/p' | wc -l; }
is "the length of the forces does not know N" "$(lines 90)" "$(lines 160)"
tap_end
