#!/bin/sh
# Corrections of `lagc check` are what they say: "`A` should be `B`" with B in the place of A, as the caret shows it, makes the expectation true.
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
cat >"$TMP/head" <<'EOF2'
model pasted
coord x [m], th [rad]
state q [A*s]
param a = 2 > 0, b = 3 > 0, R = 5 [ohm] > 0, l = 1 [m] > 0, w = 3 [1/s] > 0
lagrangian = x'^2/2 - w^2*x^2/2 + l^2*(th'^2/2 + w^2*cos(th))
flow q' = -2*q/(R*1 [F])
EOF2
# One expectation a line: each is false, and one edit of its text makes it true.
cat >"$TMP/wrong" <<'EOF2'
expect log(sqrt(2 + th^2)) = log(2 + th^2)
expect sqrt(a*th^2 + a) = a*th^2 + a
expect cbrt(th + 1) = (th + 1)
expect 4*sqrt(1 + th^2) = 4*(1 + th^2)
expect a/sqrt(1 + th^2) = a/(1 + th^2)
expect exp(-th^2)*b = exp(th^2)*b
expect q' = -q/(R*1 [F])
expect x''/l = -w^2*x/(2*l)
expect x'' = -w*x
expect th'' = -w^2*cos(th)
expect th''*b = -w^2*a*sin(th)
expect a^2*th'' = -w^2*a^(1/2)*sin(th)
expect sin(th)^2 + cos(a*th)^2 = 1
expect x''*l^3 = -w^2*l^(2)*x  # a remark with `should be`
expect a*(th''
  + w^2*sin(b*th)) = 0
expect (a + b)*th'' = -w^2*(a*sin(th) + b*sin(th/2))
EOF2
# pasted FILE: the file with the replacement that its check proposes for its last statement
pasted() {
  "$LAGC" check "$1" >"$TMP/out" 2>&1
  awk -v text="$1" '
    / is false: `.* should be `/ && !line { split(substr($0, length(text) + 2), at, ":"); line = at[1]; column = at[2]; new = $0; sub(/.* should be `/, "", new); sub(/`[^`]*$/, "", new); next }
    line && /^ *\| *\^/ && !width { match($0, /\^~*/); width = RLENGTH }
    END {
      while ((getline row < text) > 0) {
        n++
        if (n == line) row = substr(row, 1, column - 1) new substr(row, column + width)
        print row
      }
    }' "$TMP/out"
}
proposals=0
awk '{ if (!sub(/^  /, "&")) n++; print > (d "/e" n) }' d="$TMP" "$TMP/wrong"
for e in "$TMP"/e[0-9]*; do
  cat "$TMP/head" "$e" >"$TMP/before.lag"
  pasted "$TMP/before.lag" >"$TMP/after.lag"
  cmp -s "$TMP/before.lag" "$TMP/after.lag" && continue # another kind of advice
  proposals=$((proposals + 1))
  check "pasted: $(tail -n 1 "$TMP/after.lag" | sed 's/ *#.*//')" sh -c '"$0" check "$1" >"$2/said" 2>&1 || { cat "$2/said"; exit 1; }' "$LAGC" "$TMP/after.lag" "$TMP"
done
check "most mistakes have a text to paste" [ "$proposals" -ge 10 ]
tap_end
