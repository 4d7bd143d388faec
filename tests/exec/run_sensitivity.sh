#!/bin/sh
# lagc run --sensitivity: derivatives of outputs by parameters and starts. Expected digits are closed forms of the motions,
# differentiated by mpmath with 40 digits (sensitivity/reference.py prints them); slow: differences of runs in 34 digits.
. tests/tap.sh
M=tests/exec/sensitivity

# last MODEL NAMES ARGS...: the derivatives at the end, `close NAME WANT` compares one
last() {
  model=$1 names=$2
  shift 2
  title="$(basename "$model") $*"
  "$LAGC" run "$model" "$@" --sensitivity "$names" >"$TMP/out" 2>&1 || cat "$TMP/out"
}
close() { # NAME WANT [TOLERANCE]: relative, absolute below 1; 1e-10 is a hundred times the tolerance of the runs
  check "$title: $1" awk -v name="$1" -v want="$2" -v tolerance="${3:-1e-10}" '
    $1 == name { got = $2; d = got - want; size = want < 0 ? -want : want; if (size < 1) size = 1
      if (d <= tolerance*size && -d <= tolerance*size) good = 1; else print got, "not", want }
    END { exit !good }' "$TMP/out"
}

# A parameter acts by the equations, by another parameter (w), by the start and by the formula of an input.
last "$M/drive.lag" "m,k,A,F0,nu,x,x'(0)"
close dx/dm 0.584445026300899
close dx/dk -0.105003335275178
close dx/dA 0.632040896055269
close dx/dF0 -0.657726740800754
close dx/dnu 0.120415891372683
close "dx/dx(0)" 0.136737218207834
close "dx/dx'(0)" 0.495303677847435
close "dx'/dnu" 2.56449923352381
close dF/dnu 2.75124603649364
close dF/dk 0
check "units" grep -q "^  dx/dk .* m/(N/m)$" "$TMP/out"
for method in $(one_of 2 rk45 radau taylor dop853); do # of radau the tolerance is that of y
  last "$M/drive.lag" "m,nu" --method "$method"
  close dx/dm 0.584445026300899
  close dx/dnu 0.120415891372683
done
last "$M/drive.lag" "m,nu" --method 'verlet8(step=0.01)' # wrong by 1e-12
close dx/dm 0.584445026300899
close dx/dnu 0.120415891372683

# Two impacts: their times move with g, h and the height a of the floor; e acts at each.
last "$M/ball.lag" "m,g,e,h,a"
close dy/dm 0
close dy/dg -0.195798191111357
close dy/de 4.74779971688621
close dy/dh 1.44895776063031
close dy/da -0.448957760630311
close "dy'/de" 6.10557122634729
close "dy'/da" -2.89211268616451
check "what outputs feel" grep -q '^outputs feel g, e, h, a; not m$' "$TMP/out"
# The same as a contact: the impact law and the gap depend on parameters.
sed "s/^event hit:.*/contact hit: y >= a, restitution = e/" "$M/ball.lag" >"$TMP/contact.lag"
last "$TMP/contact.lag" "m,g,e,h,a"
close dy/dg -0.195798191111357
close dy/de 4.74779971688621
close dy/da -0.448957760630311
close "dy'/de" 6.10557122634729
close "dy'/da" -2.89211268616451

# Kicks: the fourth comes 4 dT later.
last "$M/kick.lag" "m,T,J"
close dx/dm -0.00699817323281686
close dx/dT -0.268168684022316
close dx/dJ 0.155600413062901
close "dx'/dT" 2.02126618282834

# Dry friction: stops move with w and R.
last "$M/rub.lag" "w,R,x0,v0"
close dx/dw 0.95489999247555
close dx/dR 0.134041747754437
close dx/dx0 -0.361953206478156
close "dx'/dw" 2.59668761427852
close "dx'/dR" -2.20862119467902
close "dx'/dv0" -0.277396046844462

# A rod whose length is a parameter: as by the angle. Differences of the constraint have 11 digits.
last "$M/angle.lag" "l,g,a,w"
cp "$TMP/out" "$TMP/angle"
last "$M/rod.lag" "l,g,a,w"
as_angle() {
  awk 'FNR == NR { if (/^  d.*\/d/) want[$1] = $2; next }
    $1 in want { n++; d = $2 - want[$1]; if (d*d > 1e-20) { print; bad = 1 } }
    END { exit bad || n != 12 }' "$TMP/angle" "$TMP/out"
}
check "$title: as by the angle" as_angle
# The scaling (g, l) -> (s g, s l) keeps the angle: g d/dg + l d/dl = 0; by time, g dth/dg = t th'/2 - w/2 dth/dw.
scales() {
  "$LAGC" run "$M/angle.lag" th --sensitivity "l,g,a,w" >"$TMP/out" 2>&1 &&
    awk '/^  dth\/d/ { d[$1] = $2 } $1 == "th\047" { v = $2 } END { x = 1.2*d["dth/dl"] + 9.81*d["dth/dg"]; y = 9.81*d["dth/dg"] - 1.5*v + 0.25*d["dth/dw"]; exit !(x*x < 1e-20 && y*y < 1e-20 && d["dth/dl"]) }' "$TMP/out"
}
check "a pendulum's scaling" scales

# ---- columns, JSON
rows() {
  "$LAGC" run "$M/ball.lag" --sensitivity g,y --every 0.7 --quiet -o "$TMP/rows.csv" &&
    head -1 "$TMP/rows.csv" | grep -q "^t \[s\],y \[m\],y' \[m/s\],dy/dg \[m/(m/s^2)\],dy/dy(0),dy'/dg " &&
    awk -F, 'NR == 2 { exit !(NF == 7 && $4^2 + ($5 - 1)^2 + $6^2 + $7^2 < 1e-26) }' "$TMP/rows.csv"
}
check "columns of rows" rows
json() { "$LAGC" run "$M/ball.lag" --sensitivity 'g,y(0)' --json | grep -q '"sensitivity": {"y": {"g": -0.19579819111[0-9]*, "y(0)": 1.4489577606[0-9]*}, '; }
check "as JSON" json

# Measures, by reverse mode: the period of a pendulum of 60 degrees is 4 sqrt(l/g) K(1/4), the amplitude
# is the start.
measures() {
  "$LAGC" run models/pendulum.lag small --sensitivity g,th --measure 'T=period(th)' --measure 'top=max(th)' --tol 1e-12 "th=60[deg]" --quiet --json >"$TMP/json" &&
    awk '{ T = 4*sqrt(1/9.81)*1.68575035481259604; d = $0; sub(/.*"T": {"g": /, "", d); got = d + 0 + T/(2*9.81)
      sub(/.*"top": {"g": /, "", d); top = d + 0; sub(/^[^}]*"th": /, "", d); exit !(got*got < 1e-22 && top*top < 1e-20 && (d - 1)^2 < 1e-20) }' "$TMP/json"
}
check "measures" measures

# ---- refusals
refused() { # TEXT MODEL NAMES ARGS...
  text=$1 model=$2 names=$3
  shift 3
  "$LAGC" run "$model" "$@" --sensitivity "$names" >"$TMP/out" 2>&1
  [ $? = 2 ] && grep -q -e "$text" "$TMP/out" || { cat "$TMP/out"; return 1; }
}
check "an unknown name" refused "l0: no such parameter or coordinate in model ball" "$M/ball.lag" g,l0
check "a name twice" refused "y(0) is named twice" "$M/ball.lag" "y,y(0)"
check "an input" refused "F is an input; name the parameters of its formula" "$M/drive.lag" F
check "a method in momenta" refused "variational steps in momenta, and has no derivative of its steps by parameters" "$M/drive.lag" k --method 'variational(step=0.1)'
check "two tangents" refused "each takes the tangent of the run for itself" "$M/ball.lag" g --tangent
without() { "$LAGC" build "$M/ball.lag" --with linear -o "$TMP/ball" && ! "$TMP/ball" --sensitivity g >"$TMP/out" 2>&1 && grep -q 'lagc build --with sensitivities' "$TMP/out"; }
check "a simulator without derivatives" without

# Slow: every parameter of the chaotic double pendulum against differences of order 6 in 34 digits, over steps of 1e-4:
# wrong by 1e-24 times a seventh derivative, some 1e9 here.
quad_differences() {
  "$LAGC" run models/double_pendulum.lag chaos --until 3 --tol 1e-14 --method dop853 --sensitivity 'm1,l2,g,th1' >"$TMP/out" || return 1
  for name in m1 l2 g th1; do
    at=$(awk -v n="$name" 'BEGIN { split("m1 1 l2 1 g 9.81 th1 2", v, " "); for (i = 1; i < 8; i += 2) if (v[i] == n) print v[i + 1] }')
    for k in -3 -2 -1 1 2 3; do
      x=$(awk -v x="$at" -v k=$k 'BEGIN { printf "%.17g", x + k*1e-4 }')
      "$LAGC" run models/double_pendulum.lag chaos --until 3 --precision quad --method taylor --tol 1e-25 "$name=$x" --json |
        sed -n "s/.*\"final\": {\"th1\": \([-0-9.e]*\),.*/$name $k \1/p"
    done
  done | sed 's/th1 /th1(0) /' >"$TMP/values"
  awk 'FNR == NR { w = $2 < 0 ? -$2 : $2; c = w == 1 ? 0.75 : w == 2 ? -0.15 : 1/60; d[$1] += ($2 < 0 ? -c : c)*$3/1e-4; next }
    /^  dth1\/d/ { split($1, of, "/d"); n++; e = ($2 - d[of[2]])/$2; if (e*e > 1e-16) { print $1, $2, d[of[2]]; bad = 1 } }
    END { exit bad || n != 4 }' "$TMP/values" "$TMP/out"
}
[ ! -e "${BUILD:-build}/liblag_quad.a" ] || slow check "against differences in 34 digits" quad_differences
# 2100 oscillators w = w0 cos(sqrt(k) t): of the Jacobian only the elements are read that the model lists, in 0.03 s,
# 10 s if all are.
cat >"$TMP/family.lag" <<'E'
model family
const N = 2100
param k = 1
coord w[N]
lagrangian = sum(i in 1..N, i*(w[i]'^2 - k*w[i]^2)/2)
scene s { start w[i in 1..N] = i/N; span 1; tolerance 1e-10; output w[1], w[N] every 1 }
E
last "$TMP/family.lag" "k,w[2100],w[2100]'" --method dop853
close "dw[2100]/dk" -0.420735492403948 # -sin(1)/2
close "dw[2100]/dw[2100](0)" 0.54030230586814 # cos(1)
close "dw[2100]/dw[2100]'(0)" 0.841470984807897
close "dw[1]/dw[2100](0)" 0
check "2100 coordinates within 2 s" awk '/^steps/ { s = $(NF - 1) + 0; exit } END { print s; exit !(s > 0 && s < 2) }' "$TMP/out"

quad_of_one() { # an odd number of names: arrays of 16-byte numbers behind pointers; y = 1 - g t^2/2
  printf '%s\n' 'model fall' 'coord y [m]' 'param g = 9.81 [m/s^2]' "lagrangian = 1 [kg]*(y'^2/2 - g*y)" 'scene s { start y = 1; span 1 }' >"$TMP/fall.lag"
  "$LAGC" run "$TMP/fall.lag" --precision quad --sensitivity g | grep -E 'dy/dg +-0\.(50{19}|49{19})'
}
[ ! -e "${BUILD:-build}/liblag_quad.a" ] || slow check "of one name in 34 digits" quad_of_one
tap_end
