#!/bin/sh
# A constraint is the same whatever it is multiplied by, and a coordinate in whatever unit: ranks, reports and motions do not change. Expected: the model
# as it stands, to the run's tolerance.
. tests/tap.sh

# The report of `lagc check` on constraints, and of the run its status, rank and redundant constraints; the final state goes to "$TMP/end".
look() { # look MODEL SCENE
  "$LAGC" check --allow-numeric "$1" "$2" >"$TMP/out" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }
  sed -n '/degree. of freedom\|degrees of freedom\|^  constraint\|^  contact\|^  singular/s/ (line [0-9]*)//p' "$TMP/out"
  "$LAGC" run "$1" "$2" --until "$until" --json >"$TMP/out" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }
  sed 's/.*\("status": "[a-z]*"\).*\("constraints": [0-9]*, "rank": [0-9]*, "redundant": [^]]*\]\), "rank_beside": \([0-9]*\).*/\1 \2 \3/' "$TMP/out"
  sed 's/.*"final": {\(.*\)}}.*/\1/; s/, "/\n"/g' "$TMP/out" | grep -v 'lambda\|press\|push\|bend\|"pull' >"$TMP/end"
}

# ends_alike WITHIN: whether "$TMP/end" is "$TMP/first", value by value, up to WITHIN of the larger of it and 1.
ends_alike() {
  paste -d' ' "$TMP/first" "$TMP/end" | awk -v t="$1" '{ d = $2 - $4; m = $2 < 0 ? -$2 : $2; m = m > 1 ? m : 1; if ($1 != $3 || d > t*m || -d > t*m || d != d) { print; bad = 1 } } END { exit bad || !NR }'
}

# The outermost factors in `make test`, those between them too in `make test-long`.
factors="1e-12 1e12 ${SLOW:+1e-9 1e-3 3e6 1e9}"

# scaled MODEL SCENE WITHIN CONSTRAINT: each factor at one constraint of a model of the gallery, whose line is turned into `F*(left - (right)) relation 0`.
scaled() {
  look "models/$1.lag" "$2" >"$TMP/plain" || { cat "$TMP/plain"; return 1; }
  cp "$TMP/end" "$TMP/first"
  for f in $factors; do
    awk -v f="$f" -v name="$4" '
      $1 ~ /^(constraint|contact)$/ && $2 == name ":" {
        head = $1 " " $2; tail = ""; sub(/^[^:]*: /, "")
        if (match($0, /, restitution.*/)) { tail = substr($0, RSTART); $0 = substr($0, 1, RSTART - 1) }
        if (match($0, / \[[^]]*\]$/)) $0 = substr($0, 1, RSTART - 1)
        match($0, / (=|>=) /); relation = substr($0, RSTART, RLENGTH)
        left = substr($0, 1, RSTART - 1); right = substr($0, RSTART + RLENGTH)
        if (right ~ /^0/) right = ""
        print head " " f "*(" left (right == "" ? "" : " - (" right ")") ")" relation "0" tail; next
      } { print }' "models/$1.lag" >"$TMP/$1.lag"
    cmp -s "models/$1.lag" "$TMP/$1.lag" && { echo "no constraint $4"; return 1; }
    look "$TMP/$1.lag" "$2" >"$TMP/other" || { echo "times $f:"; cat "$TMP/other"; return 1; }
    diff "$TMP/plain" "$TMP/other" && ends_alike "$3" || { echo "times $f"; return 1; }
  done
}

# Tolerances 1e-12 and 1e-13 of the scenes, times the growth of errors along the motion.
until=3
for c in touch roll_x roll_y; do one_of 4 && check "rattleback, $c" scaled rattleback stubborn 1e-9 $c; done
for c in along across; do one_of 4 && check "slider_crank, $c" scaled slider_crank spun 1e-10 $c; done
for c in roll_x roll_y; do one_of 4 && check "turntable, $c" scaled turntable circle 1e-10 $c; done
for c in floor left right; do one_of 4 && check "room, $c" scaled room bounce 1e-9 $c; done

# Hand-written models, in which a constraint has the factor F and a coordinate the factor S.
until=2
written() { # written NAME WITHIN TEXT: TEXT contains F and S, and has the same outputs for any values of these
  printf '%s\n' "$3" >"$TMP/text"
  for pair in '1 1' '1e-12 1e12' ${SLOW:+'1e12 1' '1 1e-12' '1e-12 1' '3e6 1' '1 1e-6' '1 1e6' '1 1e12' '1e12 1e-12' '1e12 1e12'}; do
    f=${pair% *} s=${pair#* }
    sed "s/\\bF\\b/$f/g; s/\\bS\\b/$s/g" "$TMP/text" >"$TMP/$1.lag"
    look "$TMP/$1.lag" run >"$TMP/other" || { echo "F = $f, S = $s:"; cat "$TMP/other"; return 1; }
    grep '"out' "$TMP/end" >"$TMP/outputs"
    mv "$TMP/outputs" "$TMP/end"
    [ "$pair" != '1 1' ] || { cp "$TMP/other" "$TMP/plain"; cp "$TMP/end" "$TMP/first"; }
    diff "$TMP/plain" "$TMP/other" && ends_alike "$2" || { echo "F = $f, S = $s"; return 1; }
  done
}
run='span 2
  method dop853
  tolerance 1e-12
  output'
slow check "a free particle on a circle" written circle 1e-9 "model circle \"a bead\"
coord x [m], y
param s = S [1/m] > 0, g = 1 [1/s^2], w = 1 [1/s]
kinetic = ((s*x')^2 + y'^2)/2
potential = g*y
constraint r: F*((s*x)^2 + y^2 - 1) = 0
observe outx = s*x
observe outy = y
scene run { start y = 0, x = 1/s
  $run outx, outy
}"
check "two particles, a rod that follows from the others, and one of another scale" written rods 1e-9 "model rods \"redundant\"
coord x1 [m], y1, x2, y2
param s = S [1/m] > 0, g = 1 [1/s^2], w = 1 [1/s]
kinetic = ((s*x1')^2 + y1'^2 + x2'^2 + y2'^2)/2
potential = g*(y1 + y2)
constraint a: F*((s*x1)^2 + y1^2 - 1) = 0
constraint b: (x2 - s*x1)^2 + (y2 - y1)^2 = 1
constraint c: (s*x1)^2 + y1^2 - 1 + 2*((x2 - s*x1)^2 + (y2 - y1)^2 - 1) = 0
observe outx = s*x1
observe outy = y2
scene run { start x1 = 1/s, y1 = 0, x2 = 1, y2 = 1
  $run outx, outy
}"
slow check "a coordinate without inertia" written light 1e-9 "model light \"a slider without mass\"
coord x, y, u [m]
param s = S [1/m] > 0, g = 1 [1/s^2], w = 1 [1/s]
kinetic = (x'^2 + y'^2)/2
potential = g*(y + (s*u)^2)
constraint tie: F*(s*u - x) = 0
constraint rod: x^2 + y^2 = 1
observe outx = x
observe outu = s*u
scene run { start x = 1, y = 0, u = 1/s
  $run outx, outu
}"
check "a rolling coin of another scale" written coin 1e-9 "model coin \"nonholonomic\"
coord x [m], y, a
param s = S [1/m] > 0, g = 1 [1/s^2], w = 1 [1/s]
kinetic = ((s*x')^2 + y'^2 + a'^2)/2
potential = g*y
constraint roll: F*(s*x'*sin(a) - y'*cos(a)) = 0
observe outx = s*x
observe outy = y
scene run { start x' = 0.5*w/s, a' = 1, a = 0.3
  $run outx, outy
}"
slow check "inertia that cancels with a constraint's, seen by sign alone" written sign 1e-9 "model sign \"indefinite\"
coord x [m], y
param s = S [1/m] > 0, g = 1 [1/s^2], w = 1 [1/s]
kinetic = (y'^2 - 4*(s*x')^2)/2
potential = g*y^2
constraint c: F*(2*s*x - w*t) = 0
observe outx = s*x
observe outy = y
scene run { start y = 1
  $run outx, outy
}"

# Next to a rest whose forces cancel: a tolerance of 1e-14 of 1e-8 is below their rounding, and was refused without end. 12,000: four times as many steps as it takes.
balance() { [ "$(timeout 100 "$LAGC" run models/magnetic_pendulum.lag middle --tol 1e-14 --json | sed 's/.*"steps": \([0-9]*\).*/\1/')" -lt 12000 ]; }
check "forces in balance have a size" balance
tap_end
