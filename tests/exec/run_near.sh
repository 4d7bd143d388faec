#!/bin/sh
# Sums over neighbours: the same digits evaluated, compiled, in lanes and after a stop; their C stands alone, and its length does not know N.
. tests/tap.sh

cat >"$TMP/gas.lag" <<'END'
model gas
const N = 36
coord x[N], y[N]
param L = 8 > 0, cut = 2.5 > 0
kinetic = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2)
function pair(s) = (cut^2 - s)^3/20
potential = sum(i in 1..N, sum(j in near(i, cut, x, y, L),
  pair(image(x[i] - x[j], L)^2 + image(y[i] - y[j], L)^2)))
scene s { start x[i in 1..N] = 1.3*(i - 6*floor(i/6)), y[i in 1..N] = 1.3*floor(i/6), x[1]' = 3, y[2]' = -4
  span 1
  method verlet(step = 0.01)
  output x[1], y[36], energy every 0.25 }
END

rows() { "$LAGC" run "$TMP/gas.lag" -o "$TMP/$1.csv" "$2" "$3" >"$TMP/$1.out" 2>&1 && cat "$TMP/$1.csv"; }
rows evaluated --compile never >"$TMP/evaluated"
rows compiled --compile always >"$TMP/compiled"
check "five rows" test "$(grep -c '^[0-9]' "$TMP/evaluated")" = 5
check "evaluated and compiled: the same digits" cmp "$TMP/evaluated" "$TMP/compiled"

# Lists of other steps, and none: half a run, saved and gone on with.
"$LAGC" run "$TMP/gas.lag" --until 0.5 --save-state "$TMP/half.state" --compile never >/dev/null 2>&1
"$LAGC" run "$TMP/gas.lag" --resume "$TMP/half.state" --compile never -o "$TMP/rest.csv" >/dev/null 2>&1
is "a run that is resumed has the same digits" "$(tail -1 "$TMP/evaluated")" "$(tail -1 "$TMP/rest.csv")"

sweep() { "$LAGC" sweep "$TMP/gas.lag" 'L=8,8.1,8.2,8.3,8.4,8.5,8.6,8.7' --measure 'a=x[1](end)' "$@" >/dev/null 2>&1; }
slow sweep -o "$TMP/lanes.csv"
[ -z "${SLOW:-}" ] || is "a sweep in lanes has the digits of a run" "$(sed -n 's/^8,\(.*\),ok/\1/p' "$TMP/lanes.csv")" \
  "$(sed -n 's/^1,\([^,]*\),.*/\1/p' "$TMP/compiled")"

refused() { check "$1 is refused" says 2 "$2" "$LAGC" run "$TMP/gas.lag" "$1"; }
refused L=4.9 "the box of near less twice its cut-off has a length of -0.1, which must be at least 0: it is L - 2*cut"
sed 's/, cut = 2.5 > 0/, cut = 2.5/' "$TMP/gas.lag" >"$TMP/any.lag"
check "a negative cut-off is refused" says 2 "the cut-off of near has a length of -1" "$LAGC" run "$TMP/any.lag" cut=-1

"$LAGC" emit "$TMP/gas.lag" --standalone -o "$TMP/gas.c"
check "its C stands alone" "$CC" -std=c11 -Wall -Wextra -pedantic -Werror -I "$INC" -fsyntax-only "$TMP/gas.c"
lines() { "$LAGC" emit "$TMP/gas.lag" -D "N=$1" | sed -n '/^static int accel/,/^}/p' | wc -l; }
is "the length of the forces does not know N" "$(lines 36)" "$(lines 144)"

# ---- sums in definitions by an index stay sums: on a square lattice each atom has 4 neighbours at each of the distances a, sqrt(2) a, 2 a
cat >"$TMP/lattice.lag" <<'END'
model lattice
const N = 1024
coord x[N], y[N]
param a = 1.3, cut = 2.7 > 0, L = 32*a > 0
kinetic = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2)
function inside(s, d) = if(s < d^2, 1, 0)
potential = sum(i in 1..N, sum(j in near(i, cut, x, y, L), (cut^2 - image(x[i] - x[j], L)^2 - image(y[i] - y[j], L)^2)^2))
observe shell[k in 1..3] = sum(i in 1..N, sum(j in near(i, cut, x, y, L),
  inside(image(x[i] - x[j], L)^2 + image(y[i] - y[j], L)^2, 1 + 0.55*k)))
let mode[k in 1..3] = sum(i in 1..N, cos(2*pi*16*k*x[i]/L))/N
observe alternating = mode[1], whole = mode[2]
scene s { start x[i in 1..N] = a*mod(i - 1, 32), y[i in 1..N] = a*floor((i - 1)/32)
  span 1
  method verlet(step = 0.01)
  output shell, alternating, whole every 1 }
END
"$LAGC" run "$TMP/lattice.lag" -o "$TMP/lattice.csv" >"$TMP/lattice.out" 2>&1
is "families of observes and lets over sums" "0 2048 4096 6144 0 1" "$(awk -F, '$1 == "0" { printf "%d %d %d %d %.9g %.9g", $1, $2, $3, $4, 1e-12*int(1e12*$5), $6 }' "$TMP/lattice.csv")"
tap_end
