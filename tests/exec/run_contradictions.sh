#!/bin/sh
# Constraints that contradict each other: at the start, soon after it, at some time later. No state may be written that does not obey them.
: "${LAGC:=build/lagc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
. tests/tap.sh

# model NAME SECOND: a mass whose x is 0, and is to obey SECOND, too.
model() {
  cat >"$TMP/$1.lag" <<END
model $1
coord x [m], y [m]
param m = 1 [kg] > 0, a = 1 [m]
kinetic = m/2*(x'^2 + y'^2)
constraint p: x = 0 [m]
constraint q: $2
scene s { span 1; output x, y every 0.1 }
END
}

# ---- later
# One that jumps at half a second: it agreed until then. From 0, where no coordinate shows how large it is.
model jumps 'x = if(t > 0.5 [s], a, 0 [m])'
for method in dop853 rk45 rk4 radau verlet variational; do
  check "$method ends where one of two jumps" says 3 'constraint q (line 6)' "$LAGC" run "$TMP/jumps.lag" --method $method -o "$TMP/rows.csv"
  is "$method writes what was before" 0.5 "$(tail -n 1 "$TMP/rows.csv" | cut -d, -f1)"
done
tap_end
