#!/bin/sh
# lagc linearize: A, B, C, D against closed forms of textbooks, as text, JSON, CSV and .npy; with constraints; and what it refuses.
. tests/tap.sh
cat >"$TMP/pole.lag" <<'M'
# R. Murray, K. Astrom, Feedback Systems (2008), example 3.2: a point mass on a cart, upright, pushed by F.
model pole
coord x [m], th [rad]
param M = 3 [kg] > 0, m = 0.5 [kg] > 0, l = 0.7 [m] > 0, g = 9.81 [m/s^2] > 0, c = 0.2 [N*s/m] >= 0
input F [N] = 0
let px = x + l*sin(th)
let py = l*cos(th)
kinetic = M/2*x'^2 + m/2*(px'^2 + py'^2)
potential = m*g*py
dissipation = c/2*x'^2
force x = F
observe a [m/s^2] = x''
observe tip [m] = px
scene up { start th = 0; span 1 [s]; output x, th, a, tip }
scene near { like up; start th = 0.02 }
M
json() { "$LAGC" linearize "$@" --json >"$TMP/out.json" 2>"$TMP/err"; }
# holds FILE NAME: lines of Python that compare the object `o` with closed forms.
cat >"$TMP/entries.py" <<'P'
import json, sys
o = json.load(open(sys.argv[1]))
A, B, C, D = (o[k] for k in "ABCD")
def near(got, want, within):
    for i, (x, y) in enumerate(zip(got, want)):
        assert len(x) == len(y) and all(abs(a - b) <= within*max(1, abs(b)) for a, b in zip(x, y)), (i, x, y)
    assert len(got) == len(want), (got, want)
exec(open(sys.argv[2]).read())
P
holds() { cat >"$TMP/$1.py" && check "$2" python3 "$TMP/entries.py" "$TMP/out.json" "$TMP/$1.py"; }
json "$TMP/pole.lag" up
# exact derivatives: rounding of a few operations; C and D are differences of order 6, to 11 digits
holds upright "an inverted pendulum on a cart: its textbook matrices" <<'P'
M, m, l, g, c = 3, 0.5, 0.7, 9.81, 0.2
rows = [[0, 0, 1, 0], [0, 0, 0, 1], [0, -m*g/M, -c/M, 0], [0, (M + m)*g/(M*l), c/(M*l), 0]]
near(A, rows, 1e-14)
near(B, [[0], [0], [1/M], [-1/(M*l)]], 1e-14)
near(C, [[1, 0, 0, 0], [0, 1, 0, 0], rows[2], [1, l, 0, 0]], 1e-11)
near(D, [[0], [0], [1/M], [0]], 1e-11)
assert [x["name"] for x in o["states"]] == ["x", "th", "x'", "th'"] and o["inputs"][0]["unit"] == "N", o
P
json "$TMP/pole.lag" up F=6 g=1.62
holds moon "parameters and a held input" <<'P'
near([A[3]], [[0, 3.5*1.62/2.1, 0.2/2.1, 0]], 1e-14)
assert abs(o["rate"][2] - 2) < 1e-14 and o["about"] == "start", o["rate"]
P
# x = sin(2 t) on a rod of length 1: the pendulum in Cartesian coordinates; only the rates of a constrained model are differences
cat >"$TMP/rod.lag" <<'M'
model rod
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0
lagrangian = m/2*(x'^2 + y'^2) - m*g*y
constraint rod: x^2 + y^2 = 1 [m^2]
scene hang { start x = 0, y = -1; span 1 [s]; output x }
M
json "$TMP/rod.lag"
# along the tangent space x'' = -g x; 11 digits of differences of order 6
holds rod "a pendulum by a constraint, along its tangent space" <<'P'
assert abs(A[2][0] + 9.81) < 1e-9 and abs(A[3][0]) < 1e-9, A
P
rows() { "$LAGC" linearize "$TMP/pole.lag" up -o "$TMP/m.csv" && "$LAGC" linearize "$TMP/pole.lag" up -o "$TMP/m.npy" && json "$TMP/pole.lag" up; }
check "files are written" rows
holds file "CSV has the rows of [A B; C D]" <<'P'
import csv, os
with open(os.path.join(os.path.dirname(sys.argv[1]), "m.csv")) as f:
    head, *lines = csv.reader(f)
assert head == ["x", "th", "x'", "th'", "F"], head
assert [[float(x) for x in row] for row in lines] == [a + b for a, b in zip(A + C, B + D)], lines
P
text() { "$LAGC" linearize "$TMP/pole.lag" up >"$TMP/text" && grep -q "^  th'' *= 16.35 th + 0.0952381 x' - 0.4761905 F$" "$TMP/text"; }
check "as equations" text
# The header's: exact, so to the rounding of a few operations.
cat >"$TMP/header.c" <<'C'
#define POLE_IMPLEMENTATION
#include "pole.h"
#include <stdio.h>
int main(void) {
  pole_params p;
  pole_state s;
  double u[POLE_NU], C[POLE_NOUT*POLE_NY], D[POLE_NOUT*POLE_NU];
  pole_defaults(&p);
  if (pole_start(&p, &s)) return 1;
  pole_inputs(s.t, &p, u);
  if (pole_output_jacobian(s.t, s.q, s.v, &p, u, C, D)) return 1;
  for (int i = 0; i < POLE_NOUT; i++)
    printf("%s[[%.17g, %.17g, %.17g, %.17g], %.17g]", i ? ", " : "{\"A\": 0, \"B\": 0, \"C\": 0, \"D\": 0, \"rows\": [", C[4*i], C[4*i + 1],
           C[4*i + 2], C[4*i + 3], D[i]);
  puts("]}");
  return 0;
}
C
header() { "$LAGC" header "$TMP/pole.lag" up --with outputs -o "$TMP/pole.h" && "$CC" -O0 -Wall -Werror "$TMP/header.c" -o "$TMP/header" -lm && "$TMP/header" >"$TMP/out.json"; }
check "a header with the Jacobians of outputs" header
holds header "C and D in C" <<'P'
M, m, l, g, c = 3, 0.5, 0.7, 9.81, 0.2
near([r[0] for r in o["rows"]], [[1, 0, 0, 0], [0, 1, 0, 0], [0, -m*g/M, -c/M, 0], [1, l, 0, 0]], 1e-14)
near([[r[1]] for r in o["rows"]], [[0], [0], [1/M], [0]], 1e-14)
P
says() { "$LAGC" linearize "$2" $3 >"$TMP/out" 2>"$TMP/err"; [ $? = "$1" ] && grep -q -e "$4" "$TMP/err"; }
if [ -n "${GSL:-}" ]; then
  json "$TMP/pole.lag" near --equilibrium
  holds rest "about the equilibrium next to the start" <<'P'
assert o["about"] == "equilibrium" and abs(o["states"][1]["value"]) < 1e-12 and max(map(abs, o["rate"])) < 1e-12, o
near([A[3]], [[0, 3.5*9.81/2.1, 0.2/2.1, 0]], 1e-11)
P
fi
jumps() { # as lagc modes says of it; not while it slips
  "$LAGC" linearize tests/exec/sensitivity/rub.lag "x'=0" 2>/dev/null | grep -q "^.* jumps here, at x' = 0: small motions there are not linear" && ! "$LAGC" linearize tests/exec/sensitivity/rub.lag 2>/dev/null | grep -q 'jumps here'
}
check "where dry friction holds what rests, it says so" jumps
check "contacts are refused" says 2 models/billiards.lag "" "contacts open and close"
check "options of runs are refused" says 2 "$TMP/pole.lag" "--until 3" is an option of
tap_end
