#!/bin/sh
# A liquid of 110,592 Lennard-Jones atoms with `near`, a step of all an atom, beside a loop by hand with lists from cells (near.c). To reach: 1.2.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}" "${SIDE:=48}" "${STEPS:=100}"
. tests/bench/lib_rows.sh
sed '/start r\[i in 1..N\] = /d' tests/bench/models/liquid.lag >"$TMP/liquid.lag" # near.c sets places: by floor, they are a statement each
"$LAGC" emit "$TMP/liquid.lag" -D M="$SIDE" -o "$TMP/liquid.c" 2>"$TMP/said" || { cat "$TMP/said"; exit 1; }
"$CC" -O2 -march=native -ffp-contract=off -I"$INC" -DSCENE=liquid_flow tests/bench/near.c "$TMP/liquid.c" -lm -o "$TMP/near"
"$TMP/near" "$STEPS" >"$TMP/times"
table
awk '{ print }' "$TMP/times" | while read -r n ours hand ratio apart; do
  row "a liquid of $n atoms, ns a step and atom; places differ by $apart" '<= 1.2' "by hand $hand" "$ours" "$ratio" "$(at_most "$ratio" 1.2)"
done
