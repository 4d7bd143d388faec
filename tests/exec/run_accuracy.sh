#!/bin/sh
# The error that a run reports, its horizon, and --accuracy: against closed forms and GSL's rk8pd.
. tests/tap.sh
dp=models/double_pendulum.lag

# value KEY: a number of the JSON in $TMP/json
value() { sed -n "s/.*\"$1\": *\([^,}]*\).*/\1/p" "$TMP/json" | head -n 1; }
run() { "$LAGC" run "$@" --json >"$TMP/json" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }; }
# within NAME FACTOR A B: A and B agree within a factor
within() { check "$1" awk -v f="$2" -v a="$3" -v b="$4" 'BEGIN { print a, b; exit !(a != "" && b != "" && a + 0 > 0 && a <= f*b && b <= f*a) }'; }

# A closed form: the estimate is the largest deviation over all components, relative to the largest value of its kind.
cat >"$TMP/oscillator.lag" <<'EOF'
model oscillator
coord x
lagrangian = x'^2/2 - x^2/2
scene run { start x = 1; span 50; exact x = cos(t) }
EOF
# Long series round alike at any tolerance: their steps of 4 s turn the phase by 2e-16 of the time, steps of 0.1 s by a thousandth of this.
for how in "--method rk45 --tol 1e-6" "--method dop853 --tol 1e-9" "--method rk4 --step 0.05" "--method verlet --step 0.01" "--method taylor --tol 1e-15 --until 10000" \
  "--method taylor --tol 1e-14 --until 10000" "--method taylor --tol 1e-12 --until 10000"; do
  # shellcheck disable=SC2086 # a list of words
  run "$TMP/oscillator.lag" $how
  within "an oscillator by $how: the error of its closed form" 3 "$(value error)" "$(sed -n 's/.*"largest": *\([^,}]*\).*/\1/p' "$TMP/json" | head -n 1)"
done
is "the phase of Verlet's method drifts in proportion to time" '"t"' "$(value error_growth)"
# Beside 5e5 steps of verlet8 dop853 rounds more: its difference bounds the error, 8e-13 by the cosine, and is called a bound; 5e4 steps are run again.
while read -r until bound; do
  run "$TMP/oscillator.lag" --method verlet8 --step 0.02 --until "$until"
  is "rounding of verlet8 to $until s: a bound in a long run" "$bound" "$(value error_at_most)"
  check "and not below the error" awk -v e="$(value error)" -v t="$(sed -n 's/.*"largest": *\([^,}]*\).*/\1/p' "$TMP/json" | head -n 1)" \
    'BEGIN { print e, t; exit !(e > 0.5*t && e < 5*t) }'
done <<EOF
10000 true
1000 false
EOF
run "$TMP/oscillator.lag" --method rk4 --step 0.05
is "Runge-Kutta's, too: an error of the frequency" '"t"' "$(value error_growth)"
run "$dp" chaos --until 12
is "chaos: neighbours part exponentially" '"exponential"' "$(value error_growth)"

# Impacts, whose times are found just behind: that all runs share, so that 1,000 of them were said to be off by a tenth of what they are. Between walls x goes on
# as the distance from an even number; of a ball that loses a hundredth of its speed, the flights' times add up (30 digits).
printf '%s\n' "model walls" "coord x" "lagrangian = x'^2/2" "contact l: x >= 0, restitution = 1" "contact r: 1 - x >= 0, restitution = 1" \
  "scene s { start x = 0.3, x' = 1; span 1000.3 }" >"$TMP/walls.lag"
printf '%s\n' "model ball" "coord z" "lagrangian = z'^2/2 - 9.81*z" "contact floor: z >= 0, restitution = 0.99" "scene s { start z = 1; span 89 }" >"$TMP/ball.lag"
while read -r model column true scale words; do
  # shellcheck disable=SC2086 # a list of words
  run "$TMP/$model.lag" $words --method dop853
  off=$(awk -v a="$(value "$column")" -v b="$true" -v s="$scale" 'BEGIN { d = (a - b)/s; print d < 0 ? -d : d }')
  within "$model: the error of impacts" 5 "$(value error)" "$off"
done <<'EOF'
walls x 0.6 1 --tol 1e-9
walls x 0.6 1 --tol 1e-9 --until 100.3
ball z' -0.0304190160877746 4.43 --tol 1e-9
EOF

# Kepler's problem, a hundred turns: geometric methods keep the energy, and their phases drift in proportion to time; others lose energy in proportion
# to time, and the phase as its square (E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration (2006), X.3.1 and table I.2.1).
while read -r growth trend how; do
  # shellcheck disable=SC2086 # a list of words
  run tests/exec/kepler.lag $how
  is "Kepler by $how: the error grows, and the energy" "\"$growth\" \"$trend\"" "$(value error_growth) $(sed 's/.*"energy": {[^}]*"trend": \("[a-z]*"\).*/\1/' "$TMP/json")"
done <<'EOF'
t oscillates --method verlet --step 0.005
t oscillates --method verlet4 --step 0.02
t oscillates --method variational --step 0.005
t^2 grows --method rk45 --tol 1e-7
t^2 grows --method rk4 --step 0.01
t^2 grows --method dop853 --tol 1e-8
t^2 grows --method taylor --tol 1e-8
EOF

# 37 turns by equal steps of order 8, whose error is rounding: the estimate was that of the second method's rounding, 40 times as much. x' behind the pericentre
# by Kepler's equation, 40 digits.
printf '%s\n' "model orbit" "coord x, y" "lagrangian = (x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)" "scene s { start x = 1, y' = 0.8; span 148.5603 }" >"$TMP/orbit.lag"
run "$TMP/orbit.lag" --method verlet8 --step 0.01
within "an error that is rounding alone" 5 "$(value error)" "$(awk -v a="$(value "x'")" 'BEGIN { d = (a + 8.9458549998437671e-6)/1.7; print d < 0 ? -d : d }')"

# GSL's rk8pd as an independent integrator: the difference at the end.
if [ -n "${GSL:-yes}" ] && "$LAGC" run "$dp" --method gsl-rk8pd --tol 1e-13 --json >"$TMP/gsl" 2>/dev/null; then
  final() { sed 's/.*"final": *{//; s/}.*//' "$1" | tr ',' '\n' | sed 's/[" ]//g; s/:/ /' | grep '^th[12]'; }
  for how in "--method dop853 --tol 1e-7" "--method rk45 --tol 1e-8" "--method rk4 --step 2e-3" "--method taylor --tol 1e-8"; do
    # shellcheck disable=SC2086 # a list of words
    run "$dp" $how
    final "$TMP/json" >"$TMP/a"
    final "$TMP/gsl" >"$TMP/b"
    # angles reach 1.8 rad, rates 10 rad/s in this scene
    true=$(paste -d ' ' "$TMP/a" "$TMP/b" | awk '{ d = $2 - $4; if (d < 0) d = -d; d /= ($1 ~ /\047/ ? 10 : 1.8); if (d > m) m = d } END { print m }')
    within "double pendulum by $how: the error against GSL" 10 "$(value error)" "$true"
  done
  # Chaos: the time at which rows of two methods part by 0.3 of the size of an angle.
  for how in "--method dop853 --tol 1e-10" "--method rk45 --tol 1e-9"; do
    # shellcheck disable=SC2086 # a list of words
    run "$dp" chaos --until 40 $how -o "$TMP/a.csv" --every 0.05
    "$LAGC" run "$dp" chaos --until 40 --method gsl-rk8pd --tol 1e-14 -o "$TMP/b.csv" --every 0.05 --quiet
    parted=$(paste -d , "$TMP/a.csv" "$TMP/b.csv" | awk -F , 'NR > 1 { h = NF/2; for (i = 2; i <= 3; i++) { v = $i < 0 ? -$i : $i; if (v > s) s = v; d = $i - $(i + h); if (d < 0) d = -d; if (d > 0.3*s) { print $1; exit } } }')
    check "chaos by $how: the horizon is within 20 % of where GSL's motion parts" \
      awk -v a="$(value horizon)" -v b="$parted" 'BEGIN { print a, b; exit !(a > 0 && a < 1.2*b && a > 0.8*b) }'
  done
fi

# Other chaos, by long double runs: where motions part by 0.3 of the largest value of the columns, which are of one kind and unit.
. tests/exec/lib_precision.sh
horizon() { # NAME COLUMNS MODEL WORDS...
  name=$1 columns=$2
  shift 2
  run "$@" -o "$TMP/a.csv"
  "$LAGC" run "$@" --precision long --tol 1e-18 -o "$TMP/b.csv" --quiet 2>"$TMP/err" || { cat "$TMP/err"; return 1; }
  parted=$(paste -d , "$TMP/a.csv" "$TMP/b.csv" | awk -F , -v n="$columns" 'NR > 1 { h = NF/2; for (i = 2; i <= n + 1; i++) { v = $i < 0 ? -$i : $i; if (v > s) s = v
    d = $i - $(i + h); if (d < 0) d = -d; if (!t && NR > 5 && d > 0.3*s) t = $1 } } END { print t }')
  check "$name: the horizon is within 20 % of where long doubles part" awk -v a="$(value horizon)" -v b="$parted" 'BEGIN { print a, b; exit !(a > 0 && a < 1.2*b && a > 0.8*b) }'
}
cat >"$TMP/three.lag" <<'EOF'
model three_bodies
coord r[3]: vec2
param G = 1
lagrangian = sum(i in 1..3, dot(r[i]', r[i]')/2) + sum(i in 2..3, sum(j in 1..i-1, G/norm(r[i] - r[j])))
scene s { start r[1] = (-1, 0.05), r[2] = (1, 0), r[1]' = (0.3, 0.5), r[2]' = (0.3, 0.5), r[3]' = (-0.6, -1); span 300
  output r[1].x, r[1].y, r[2].x, r[2].y, r[3].x, r[3].y every 0.1 }
EOF
# At 30.3 s two of them nearly meet: velocities differ there, and agree again.
run "$TMP/three.lag" --method taylor --tol 1e-12 --until 60
is "a close encounter is no horizon" null "$(value horizon)"
if has_precision long; then
  horizon "a billiard, whose flights have no error" 2 models/stadium.lag chaos --until 300 --every 0.5 --observe x --observe y
  slow horizon "Lorenz" 1 models/lorenz.lag butterfly --until 60 --method taylor --tol 1e-12 --every 0.05 --observe x
  slow horizon "Henon and Heiles" 2 models/henon_heiles.lag chaos --until 1000 --method taylor --tol 1e-10 --every 0.5 --observe x --observe y
  slow horizon "three bodies" 6 "$TMP/three.lag" --method taylor --tol 1e-12
fi
check "a horizon is told" says 0 'no digit is left: the motion there' "$LAGC" run "$dp" chaos --until 40
check "the number asked stands beside the estimate" says 0 '(asked 1e-06)' "$LAGC" run "$dp" --accuracy 1e-6
check "a run that is saved and continued keeps its bits; what is resumed has no estimate" sh -c '
  "$0" run models/kepler.lag --until 3 --save-state "$1/s" --quiet && "$0" run models/kepler.lag --until 5 --resume "$1/s" --json >"$1/r" &&
  grep -q "\"error\": null" "$1/r"' "$LAGC" "$TMP"

# A run that is cheap has a whole second run; a long one part of it: its law of growth is continued for as long again, and what is later is not known.
cat >"$TMP/pendulum.lag" <<'EOF'
model spring_pendulum
coord r, th
let x = r*sin(th)
let y = -r*cos(th)
kinetic = (x'^2 + y'^2)/4
potential = 20*(r - 1)^2 + 4.905*y
scene run { start r = 1.2, th = 1; span 2000; tolerance 1e-9 }
EOF
if [ -n "${GSL:-yes}" ] && "$LAGC" run "$TMP/pendulum.lag" --method gsl-rk8pd --tol 1e-13 --json >"$TMP/gsl" 2>/dev/null; then
  run "$TMP/pendulum.lag"
  ends() { sed 's/.*"final": *{//; s/}.*//' "$1" | tr ',' '\n' | sed 's/[" ]//g; s/:/ /' | grep '^r\|^th'; }
  ends "$TMP/json" >"$TMP/a"
  ends "$TMP/gsl" >"$TMP/b"
  # largest values in this run: r 1.4, th 1.1 rad, r' 3.6, th' 5
  true=$(paste -d ' ' "$TMP/a" "$TMP/b" | awk 'BEGIN { s["r"] = 1.4; s["th"] = 1.1; s["r\047"] = 3.6; s["th\047"] = 5 }
    { d = $2 - $4; if (d < 0) d = -d; d /= s[$1]; if (d > m) m = d } END { print m }')
  within "a run of 48,000 steps, against GSL" 5 "$(value error)" "$true"
fi
run "$TMP/pendulum.lag" --until 60000 --tol 1e-8
check "a long run: what was not seen is not known" awk -v s="$(value error_seen_to)" -v k="$(value error_known_to)" -v e="$(value error)" -v h="$(value horizon)" \
  'BEGIN { print s, k, e, h; exit !(s > 1000 && (h + 0 > 0 || e == "null" && k <= 2.001*s && k < 60000)) }'
cat >"$TMP/stiff.lag" <<'EOF'
model stiff
coord x, y
lagrangian = (x'^2 + y'^2)/2 - x^2/2 - 0.5e8*(y - x)^2
scene run { start x = 1, y = 1; span 100; method gauss(step = 0.01, stages = 2) }
EOF
check "a second run that creeps is left" says 0 'the error is not known' "$LAGC" run "$TMP/stiff.lag"
sed 's/0.5e8/0.5e7/' "$TMP/stiff.lag" >"$TMP/stiff2.lag"
check "so where a few rows were reached" says 0 'the error is not known' "$LAGC" run "$TMP/stiff2.lag"
run models/bouncing_ball.lag
check "impacts, which two runs have at times that differ by rounding, are no error" awk -v e="$(value error)" 'BEGIN { print e; exit !(e != "" && e < 1e-12) }'
cat >"$TMP/nothing.lag" <<'EOF'
model nothing
state z
flow z' = 0
scene run { start z = 0; span 10 }
EOF
check "a motion that stands still" says 0 'error below 2e-16' "$LAGC" run "$TMP/nothing.lag"
cat >"$TMP/hit.lag" <<'EOF'
model hit
coord x
lagrangian = x'^2/2 - x^2/2
event there: x - 0.999 falling { stop }
scene run { start x = 1; span 10; tolerance 1e-9; method taylor }
EOF
check "a run that an event ends in its first step" says 0 'the error is not known: the run ended at an event in its first step' "$LAGC" run "$TMP/hit.lag"

# The claim, in different methods: the estimate is below what was asked.
for how in "1e-4" "1e-8" "1e-12" "1e-6 --method rk4" "1e-5 --method verlet" "1e-8 --method gauss"; do
  # shellcheck disable=SC2086 # a list of words
  check "--accuracy $how is kept" run $dp --accuracy $how
  check "--accuracy $how: the estimate is below it" awk -v e="$(value error)" -v x="${how%% *}" 'BEGIN { print e, x; exit !(e > 0 && e <= x) }'
done

# The end of the run counts, though it lies between places: beside an unstable equilibrium the error grows a hundredfold in the last step. The end in
# quadruple precision, taylor(tol=1e-30): x' = 1.35945e-7; the largest is 2.
cat >"$TMP/hop.lag" <<'EOF'
model hop
coord x
lagrangian = x'^2/2 - cos(x)
scene near { start x = 1e-9; span 40 }
EOF
check "beside an unstable equilibrium" run "$TMP/hop.lag" --accuracy 1e-6
check "the end is as accurate as was asked, and the estimate" awk -v v="$(sed "s/.*\"final\": {.*\"x'\": \([^,}]*\).*/\1/" "$TMP/json")" -v e="$(value error)" \
  'BEGIN { d = (v - 1.35945e-7)/2; if (d < 0) d = -d; print d, e; exit !(d < 1e-6 && e < 10*d && d < 10*e) }'
# Every step of taylor ends at a wall.
cat >"$TMP/bounce.lag" <<'EOF'
model bounce
coord x
lagrangian = x'^2/2
event right: x - 1 rising { x' = -x' }
event left: x + 1 falling { x' = -x' }
scene s { start x' = 1.37; span 1000 }
EOF
check "each step ends at an event" run "$TMP/bounce.lag" --accuracy 1e-9
printf 'model kick\ncoord x\nlagrangian = x%s^2/2 - x^2/2\nevent up: sin(5*t) rising { x%s = x%s + 0.1 }\nscene s { start x = 1; span 20 }\n' "'" "'" "'" >"$TMP/kick.lag"
"$LAGC" run "$TMP/kick.lag" --method taylor --tol 1e-2 --json >"$TMP/kick.json"
check "such steps show how the error grows" grep -q '"error_growth": "t"' "$TMP/kick.json"
check "and the error is known" awk -v e="$(value error)" 'BEGIN { print e; exit !(e != "" && e != "null" && e < 1e-9) }'
check "a setting that a monitor of the scene stops is refined" run models/kepler.lag orbit --accuracy 1e-3
sed "s/span 50; exact x = cos(t)/span 10/" "$TMP/oscillator.lag" >"$TMP/alike.lag"
check "refused: what rounds alike is not exact" says 2 'the smallest error found is' "$LAGC" run "$TMP/alike.lag" --accuracy 1e-17
check "where the scene names a method, another is chosen" run models/slider_crank.lag --until 1 --accuracy 1e-9
# Errors of the logistic map u -> 4 u (1 - u) double at each kick, and two settings round alike: no digit is left after 52 kicks, up to some.
printf 'model logistic\ncoord x\nstate u\nlagrangian = x%s^2/2\nflow u%s = 0\nkick map every 1 { u = 4*u*(1 - u) }\nscene s { start x = 0.5, x%s = 1, u = 0.3; span 80; output u every 0.25 }\n' "'" "'" "'" >"$TMP/logistic.lag"
sed "s/^kick.*/event map: sin(pi*x) { u = 4*u*(1 - u) }/" "$TMP/logistic.lag" >"$TMP/logistic_event.lag"
lost_after() { "$LAGC" run "$1" --json | sed -n 's/.*"horizon": \([^,]*\),.*/\1/p'; }
near "a chaotic map by kicks" 6 52 "$(lost_after "$TMP/logistic.lag")"
near "a chaotic map by events" 6 52 "$(lost_after "$TMP/logistic_event.lag")"
# A long series and a shorter one round alike here by chance: their difference is a fifth of the error, of which 1.7e-13 are seen in long double, taylor(tol=2e-18).
cat >"$TMP/chance.lag" <<'EOF'
model chance
state x, y, z
flow x' = 10*(y - x)
flow y' = x*(28 - z) - y
flow z' = x*y - 2.5*z
scene s { start x = -2.06941509246826171875, y = -0.4054705798625946044921875, z = 13.15065860748291015625; span 7.604333877563477 }
EOF
run "$TMP/chance.lag" --method 'taylor(order=20)' --tol 7.19e-15
check "two series that round alike" awk -v e="$(value error)" 'BEGIN { print e; exit !(e > 1.7e-13/3 && e < 5*1.7e-13) }'
# ---- many bodies: the estimate costs about as much as the run, by half the step of its own method
cat >"$TMP/ball.lag" <<'EOF'
model ball
const N = 300
coord r[N]: vec3
param m = 1/N > 0, soft = 0.1
kinetic = sum(i in 1..N, m/2*dot(r[i]', r[i]'))
potential = -sum(i in 1..N, sum(j in 1..i-1, m^2/sqrt(dot(r[i] - r[j], r[i] - r[j]) + soft^2)))
scene s { start r[i in 1..N] = (cos(i), sin(1.7*i), sin(0.6*i)); span 1 }
EOF
rows() { "$LAGC" run "$TMP/ball.lag" "$@" --every 0.01 --quiet -o -; }
# The truth: rows within steps, against dop853. An estimate of the first order in small steps: a factor of 2.
rows --method dop853 --tol 1e-11 >"$TMP/best"
while read -r method step; do
  run "$TMP/ball.lag" --method "$method" --step "$step"
  is "$method with 300 bodies: its error is known to the end" 1 "$(value error_known_to)"
  rows --method "$method" --step "$step" >"$TMP/these"
  true=$(paste -d , "$TMP/these" "$TMP/best" | awk -F, 'NR == 1 { n = NF/2; for (i = 2; i < n; i++) kind[i] = $i ~ /\047/; next }
    { for (i = 2; i < n; i++) { k = kind[i]; x = $(i + n); d = $i - x; if (d < 0) d = -d; if (x < 0) x = -x
      if (d > m[k]) m[k] = d; if (x > s[k]) s[k] = x } }
    END { a = m[0]/s[0]; b = m[1]/s[1]; print (a > b ? a : b) }')
  within "and right" 2 "$(value error)" "$true"
done <<EOF
verlet 0.1
symplectic_euler 0.02
rk4 0.05
verlet4 0.05
EOF

# Forces of a tree jump by their errors, so that dop853 creeps from jump to jump. A program counts evaluations of
# forces and energy: a constant number for sizes of terms, and both at each of twice as many steps as the run's.
sed 's/soft^2)))/soft^2), by tree(0.5)))/; s/N = 300/N = 3000/' "$TMP/ball.lag" >"$TMP/tree.lag"
{
  echo 'static long calls;'
  "$LAGC" emit "$TMP/tree.lag" | sed '/^static int \(accel\|energy\)(/,/{$/ s/{$/{ calls++;/'
  cat <<'EOF'
#include <stdio.h>
int main(int argc, char **argv) {
  static const lag_scene *const scenes[] = {&ball_s};
  static const lag_program program = {"tree", "", "tree.lag", "", 1, scenes};
  int rc = lag_app_main(argc, argv, &program, 0);
  fprintf(stderr, "calls %ld\n", calls);
  return rc;
}
EOF
} >"$TMP/tree.c"
$CC -O2 -w -I"$INC" "$TMP/tree.c" $LIBLAG $LIBS -o "$TMP/tree" || exit 1
calls() { "$TMP/tree" --method verlet --step 0.01 "$@" 2>&1 >"$TMP/report" | sed -n 's/^calls //p'; }
alone=$(calls --until 0.1 --quiet)
check "a run of 10 steps by a tree takes few evaluations besides its steps" test "$alone" -le 65
check "and its estimate few, too" test "$(calls --until 0.1)" -le $((alone + 140))
check "which gives an error" says 0 'error about' cat "$TMP/report"
alone=$(calls --quiet)
check "so with 100 steps" test "$(calls)" -le $((alone + 2*200 + 160))
check "to their end" says 0 'error about' cat "$TMP/report"

# Refusals
check "refused: --accuracy 0" says 2 'a relative error between 0 and 1' "$LAGC" run "$dp" --accuracy 0
check "refused: --accuracy -1e-3" says 2 'a relative error between 0 and 1' "$LAGC" run "$dp" --accuracy -1e-3
check "refused: --accuracy good" says 2 'is not a number' "$LAGC" run "$dp" --accuracy good
check "refused: --accuracy 1e-6 --tol 1e-9" says 2 'chooses the tolerance or step; leave out --tol' "$LAGC" run "$dp" --accuracy 1e-6 --tol 1e-9
check "refused: --accuracy 1e-6 --step 1e-3" says 2 'chooses the tolerance or step; leave out --step' "$LAGC" run "$dp" --accuracy 1e-6 --step 1e-3
check "refused: chaos --until 60 --accuracy 1e-6" says 2 'no digit is left' "$LAGC" run "$dp" chaos --until 60 --accuracy 1e-6
check "refused: --accuracy 1e-17" says 2 'the smallest error found is' "$LAGC" run "$dp" --accuracy 1e-17
check "refused: --accuracy 1e-14 --method verlet" says 2 'steps of verlet; leave out --method' "$LAGC" run "$dp" --accuracy 1e-14 --method verlet

# ---- rounding of the time, which all runs share: half a unit in the last place from t = 128 on is 2^-46 s, and th' = w a for small swings of size a
printf '%s\n' 'model clock' 'coord th' 'param w = 3' "lagrangian = th'^2/2 + w^2*cos(th)" 'scene s { start th = 0.0625; span 140 }' >"$TMP/clock.lag"
"$LAGC" run "$TMP/clock.lag" --method taylor --tol 1e-15 --quiet --json >"$TMP/clock.json"
check "no error below that of the time" sh -c 'awk -v e="$(sed -n "s/.*\"error\": \([0-9.e-]*\),.*/\1/p" "$1")" "BEGIN { print e; exit !(e > 0.9*3*2^-46 && e < 10*3*2^-46) }"' sh "$TMP/clock.json"
tap_end
