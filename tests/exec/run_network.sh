#!/bin/sh
# Networks (network V(x) ... layers 8): values and forces against Python's, loops in C, training by lagc fit --fit V; refusals. slow: the gallery's training.
: "${LAGC:=build/lagc}"
. tests/tap.sh
cat >"$TMP/w.json" <<'W'
{"w1": [[0.5, -1.25], [2, 0.1], [-0.3, 0.7]], "b1": [0.1, -0.2, 0.3], "w2": [[1, -0.5, 0.25], [-2, 0.75, 1.5]],
 "b2": [0.05, -0.4], "w3": [1.1, -0.6], "b3": 0.2}
W
model() { # ACTIVATION
  cat <<M
model net
coord x, y
network V(u, v) from "w.json" layers 3, 2$1
lagrangian = (x'^2 + y'^2)/2 - V(x, y)
scene s { start x = 0.4, y = -0.7; span 1; output V(x, y), d(lagrangian, x), d(lagrangian, y) every 1 }
M
}
cat >"$TMP/reference.py" <<'P'
import json, math, sys
w = json.load(open(sys.argv[1]))
act, slope = (math.tanh, lambda z: 1 - math.tanh(z)**2) if sys.argv[2] == "tanh" else (lambda z: math.log1p(math.exp(z)), lambda z: 1/(1 + math.exp(-z)))
x, d = [0.4, -0.7], [[1, 0], [0, 1]]
for k in "12":
    z = [b + sum(a*c for a, c in zip(row, x)) for row, b in zip(w["w" + k], w["b" + k])]
    d = [[slope(zi)*sum(a*e for a, e in zip(row, by)) for row, zi in zip(w["w" + k], z)] for by in d]
    x = [act(zi) for zi in z]
print("%.17g" % (w["b3"] + sum(a*c for a, c in zip(w["w3"], x))), *("%.17g" % -sum(a*e for a, e in zip(w["w3"], by)) for by in d))
P
for act in tanh softplus; do
  model "$([ $act = tanh ] || echo " $act")" >"$TMP/net.lag"
  "$LAGC" run "$TMP/net.lag" -o - 2>"$TMP/err" | sed -n 2p | tr ',' ' ' >"$TMP/row"
  python3 "$TMP/reference.py" "$TMP/w.json" $act >"$TMP/want"
  # within 4e-15: twenty roundings of numbers below 3
  check "$act: value and forces" awk '{ getline want <ARGV[2]; split(want, w); for (i = 1; i <= 3; i++) { d = $(i + 1) - w[i]; if (d*d > 1.6e-29) { print $0, "not", want; exit 1 } } exit }' "$TMP/row" "$TMP/want"
done
check "its energy is conserved" sh -c '"$1" check "$2" | grep -q "energy is conserved"' - "$LAGC" "$TMP/net.lag"
wide() { printf 'model net\ncoord x\nnetwork V(u) layers %s, %s\nlagrangian = x'"'^2/2 - V(x)\n" "$1" "$1" >"$TMP/wide.lag"; "$LAGC" emit "$TMP/wide.lag" --with derivatives | grep -v '{"V_' | wc -l; }
# 24 units instead of 12 are four times as many weights; forces have a loop for each unit of a layer, derivatives some
check "wider layers are longer loops, and not four times as many" sh -c '[ "$2" -lt "$(($1*2))" ] || { echo "$1 $2 lines"; exit 1; }' - "$(wide 12)" "$(wide 24)"

[ -n "${GSL:-}" ] || [ -e "${BUILD:-build}/liblag_gsl.a" ] || { skip "training" "GSL is not installed"; tap_end; exit; }
train() { "$LAGC" fit "$@" >"$TMP/out" 2>&1; }
says() { text=$1; shift; train "$@"; [ $? = 2 ] && grep -q -e "$text" "$TMP/out" || { cat "$TMP/out"; return 1; }; }
cat >"$TMP/swing.lag" <<'M'
model swing "x'' = -V'(x), with V unknown; z tells V by itself"
coord x [m]
param m = 1 [kg] > 0, x0 = 1 [m] > 0, E0 = 1 [J] > 0
network V(u) layers 5
lagrangian = m/2*x'^2 - E0*V(x/x0)
scene s { start x = 0.9; span 3 [s]; output x every 0.1 [s]; tolerance 1e-7 }
scene later { like s; span 12 [s]; tolerance 1e-9 }
M
awk 'BEGIN { print "t [s],x [m]"; for (i = 1; i <= 30; i++) printf "%.1f,%.6f\n", i/10, cos(2*i/10) }' >"$TMP/x.csv"
check "30 values of cos 2t" train "$TMP/swing.lag" s --data "$TMP/x.csv" --fit "V,x(0)" --sigma 0.003 -o "$TMP/v.json"
check "the report counts weights, and gives other values" grep -q '^16 weights in .*v.json, the largest [0-9.]*; gradients by reverse mode$' "$TMP/out"
sed 's/V(u) layers/V(u) from "v.json" layers/' "$TMP/swing.lag" >"$TMP/known.lag"
x0=$(sed -n 's/^  x(0) *\([^ ]*\) m$/\1/p' "$TMP/out")
"$LAGC" run "$TMP/known.lag" later "x=$x0" -o - --quiet 2>&1 | tail -1 | cut -d, -f2 >"$TMP/x12"
# one error of a value within the record; the period is known to 1e-3 of 4 periods, 2 pi 4 1e-3 = 0.03
near() { awk -v got="$1" -v want="$2" -v by="$3" 'BEGIN { d = got - want; if (got != "" && d*d <= by*by) exit 0; print got, "not", want; exit 1 }'; }
check "x(12) of the learned motion is cos 24" near "$(cat "$TMP/x12")" 0.424179007336997 0.03
check "the same from its file: no more to be gained" train "$TMP/known.lag" s "x=$x0" --data "$TMP/x.csv" --fit V --sigma 0.003 -o "$TMP/again.json"
check "... in few steps" awk '/^converged after/ && $3 <= 90 { found = 1 } END { exit !found }' "$TMP/out"
# Weights that only outputs feel: V along a given motion, x = 0.9 + t, is learned from its values alone.
sed "s/ - E0\*V(x\/x0)//; s/x = 0.9/x = -0.9, x' = 1/" "$TMP/swing.lag" >"$TMP/seen.lag"
awk 'BEGIN { print "t [s],E0*V(x/x0) [J]"; for (i = 1; i <= 18; i++) { x = -0.9 + i/10; printf "%.1f,%.6f\n", i/10, 0.5*x*x } }' >"$TMP/values.csv"
check "weights that outputs alone feel" train "$TMP/seen.lag" s --data "$TMP/values.csv" --fit V --sigma 0.01 -o "$TMP/seen.json"
check "... are found: within the errors given" awk '/^chi squared/ && $3 < 18 { found = 1 } END { exit !found }' "$TMP/out"
check "no place for the weights" says 'where do the weights go? Write -o weights.json' "$TMP/swing.lag" s --data "$TMP/x.csv" --fit V
check "a file, and no network" says 'weights of a network are written there, and --fit x names none' "$TMP/swing.lag" s --data "$TMP/x.csv" --fit x -o "$TMP/no.json"
check "profiles of weights" says 'data do not determine the weights of a network one by one' "$TMP/swing.lag" s --data "$TMP/x.csv" --fit V --profile -o "$TMP/no.json"
check "weights of several scenes" says 'one file of weights is for one scene' "$TMP/swing.lag" s later --data "$TMP/x.csv" --fit V -o "$TMP/no.json"
check "a weight by itself is a value like others" sh -c '"$1" fit "$2" s --data "$3" --fit "V_w2[1]" | grep -q "V_w2\[1\] .* +- "' - "$LAGC" "$TMP/known.lag" "$TMP/x.csv"
check "a network that the model lacks" says 'W: no such parameter or coordinate in model swing' "$TMP/swing.lag" s --data "$TMP/x.csv" --fit W -o "$TMP/no.json"
empty "nothing is written then" "$(ls "$TMP/no.json" 2>/dev/null)"
gallery() {
  sed 's/ from "learned_spring.json"//' models/learned_spring.lag >"$TMP/spring.lag"
  train "$TMP/spring.lag" record --data models/lib/spring_record.csv --fit "V,x(0)" --sigma 0.01 -o "$TMP/spring.json" && awk '/^chi squared/ && $3 < 430 { found = 1 } END { exit !found }' "$TMP/out" || { cat "$TMP/out"; return 1; }
}
slow check "the gallery's spring from its record: chi squared of 400 values below 430, one deviation above" gallery
tap_end
