#!/bin/sh
# Forces of 100,000 bodies by a tree (`sum(..., by tree(theta))`), a Plummer sphere, and beside REBOUND's tree, at equal error of the force: its time
# there by interpolation of logarithms. To reach: 1.0. REBOUND is its source folder, with src/librebound.so built; without it there is no ratio.
set -eu
: "${CC:=cc}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}" "${REBOUND:=}" "${BODIES:=100000}"
"$CC" -O2 -std=gnu11 -ffp-contract=off -I"$INC" tests/bench/tree.c -lm -o "$TMP/tree"
"$TMP/tree" "$BODIES" 1 0.85 0.7 >"$TMP/own"
: >"$TMP/peer"
if [ -n "$REBOUND" ]; then
  "$CC" -O3 -std=gnu11 -DREBOUND -I"$REBOUND/src" tests/bench/tree.c -L"$REBOUND/src" -lrebound -Wl,-rpath,"$REBOUND/src" -lm -o "$TMP/peer_tree"
  "$TMP/peer_tree" "$BODIES" 1 0.7 0.5 >"$TMP/peer"
fi
echo '| opening angle | s | error of the force | REBOUND at that error, s | ratio |'
echo '| --- | --- | --- | --- | --- |'
awk 'FILENAME == ARGV[1] { t[++n] = log($2); e[n] = log($3); next }
  { at = ratio = "-"; x = log($3)
    for (k = 1; k < n; k++) if (k == 1 || x <= e[k]) { s = exp(t[k] + (x - e[k])*(t[k + 1] - t[k])/(e[k + 1] - e[k])); at = sprintf("%.2f", s); ratio = sprintf("%.2f", $2/s) }
    printf "| %s | %.2f | %.1e | %s | %s |\n", $1, $2, $3, at, ratio }' "$TMP/peer" "$TMP/own"
