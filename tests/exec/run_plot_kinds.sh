#!/bin/sh
# lagc plot --portrait, --potential, --distance, --energy-error: level curves, potential, growth of a distance and errors of the energy against closed
# forms; over a circle, in other units, of several runs; what is refused.
. tests/tap.sh

cat >"$TMP/curves.awk" <<'END'
# Prints x and y, in units of the axes, of the points of the paths that match WANTED: "CURVE X Y".
function number(s, key) { match(s, key "=\"[-0-9.]*\""); return substr(s, RSTART + length(key) + 2, RLENGTH - length(key) - 3) + 0 }
function value(a, b, part) { return logarithmic ? a*exp(part*log(b/a)) : a + part*(b - a) }
/, logarithmic<\/text>/ { logarithmic = 1 }
/^<rect x=/ { nx = ny = 0 }
/^<text .*text-anchor="(middle|end)">.*10<tspan/ { if (match($0, />[0-9]·10</)) sub(/·10<tspan[^>]*>/, "e"); else sub(/10<tspan[^>]*>/, "1e") } # powers of ten
/^<text .*text-anchor="middle">/ { v = $0; gsub(/<[^>]*>/, "", v); nx++; px[nx] = number($0, "x"); vx[nx] = v + 0 }
/^<text .*text-anchor="end">/ { v = $0; gsub(/<[^>]*>/, "", v); ny++; py[ny] = number($0, "y") - 5; vy[ny] = v + 0 }
/^<path/ && $0 ~ wanted {
  d = $0; sub(/.* d="/, "", d); sub(/".*/, "", d); gsub(/[ML]/, " ", d)
  n = split(d, c, " ")
  curve++
  for (i = 1; i < n; i += 2)
    printf "%d %.6g %.6g\n", curve, vx[1] + (c[i] - px[1])*(vx[nx] - vx[1])/(px[nx] - px[1]), value(vy[1], vy[ny], (c[i + 1] - py[1])/(py[ny] - py[1]))
}
END
curves() { awk -v wanted="$2" -f "$TMP/curves.awk" "$1" >"$TMP/points" && [ "$(wc -l <"$TMP/points")" -ge "${3:-200}" ]; }
# Numbers of a path have a tenth of a pixel, which is 0.0007 of an axis.

# m = l = 1, g = 9.81: E = v^2/2 - 9.81 cos(th)
"$LAGC" plot models/pendulum.lag wide --vs th=3.1 --vs "th'=6.5" m=1 l=1 g=9.81 --portrait -o "$TMP/pendulum.svg" --quiet >"$TMP/out" 2>&1
equal() { # of one level curve, spread over the range of all
  curves "$TMP/pendulum.svg" 'class="level" fill="none" stroke="#bbb"' 2000 && awk '
    { e = $3*$3/2 - 9.81*cos($2); if (!($1 in low) || e < low[$1]) low[$1] = e; if (!($1 in high) || e > high[$1]) high[$1] = e; n = $1 }
    END { for (k = 1; k <= n; k++) if (high[k] - low[k] > 0.01*(high[n] - low[1])) { print k, low[k], high[k]; bad = 1 } exit bad || n < 10 }' "$TMP/points"
}
check "a level curve has one energy" equal
separatrix() {
  curves "$TMP/pendulum.svg" 'class="level" fill="none" stroke="#666"' && awk '
    { v = 2*sqrt(9.81)*cos($2/2); d = ($3 < 0 ? -$3 : $3) - v; if (d < 0) d = -d; if (d > most) most = d } END { print most; exit !(most < 0.05) }' "$TMP/points"
}
check "the separatrix is 2 sqrt(g/l) cos(th/2)" separatrix
check "also around a small motion" sh -c '"$0" plot models/pendulum.lag small m=1 l=1 g=9.81 --portrait -o "$1" --quiet' "$LAGC" "$TMP/small.svg"
inside() { # the highest point of the separatrix is in the picture
  curves "$TMP/small.svg" 'class="level" fill="none" stroke="#666"' && awk '{ if ($3 > most) most = $3 } END { print most; exit !(most > 6.2 && most < 6.3) }' "$TMP/points" # 2 sqrt(9.81) = 6.264
}
check "the separatrix is inside" inside
circle() { # of the run that turns over 20 times: within one turn, on its own level, 6.5^2/2 where th = 1.5708
  curves "$TMP/pendulum.svg" 'stroke="#009e73" stroke-width="1.6"' 100 && awk '
    { e = $3*$3/2 - 9.81*cos($2); if ($2 > 3.15 || $2 < -3.15 || e > 21.125 + 0.2 || e < 21.125 - 0.2) { print; bad = 1 } } END { exit bad }' "$TMP/points"
}
check "a motion that turns over stays on the circle" circle

# The potential of the same: 9.81 (1 - cos(th)), as the model counts it, to an offset
"$LAGC" plot models/pendulum.lag wide m=1 l=1 g=9.81 --potential -o "$TMP/potential.svg" --quiet >"$TMP/out" 2>&1
potential() {
  curves "$TMP/potential.svg" 'class="level"' && awk '
    { c = $3 + 9.81*cos($2); if (NR == 1 || c < low) low = c; if (NR == 1 || c > high) high = c } END { print low, high; exit !(high - low < 0.02) }' "$TMP/points"
}
check "the potential of a pendulum" potential
line() { # the energy of the motion meets it at the turning points, -pi/2 and pi/2
  curves "$TMP/potential.svg" 'stroke-width="1.6"' 2 && awk '{ if ($2 < low) low = $2; if ($2 > high) high = $2 } END { print low, high; exit !(high > 1.56 && high < 1.58 && low < -1.55 && low > -1.58) }' "$TMP/points"
}
check "the energy line ends at the turning points" line

# In degrees: the separatrix v = 2 sqrt(g/l) cos(th/2) in degrees per second.
cat >"$TMP/units.lag" <<'END'
model units
coord a [deg] periodic
param J = 1e-19 [kg*m^2] > 0, k = 4e-19 [J] > 0
kinetic = J/2*a'^2
potential = -k*cos(a)
scene swing { start a = 90; span 5 [s] }
END
"$LAGC" plot "$TMP/units.lag" --vs "a'=250" --portrait -o "$TMP/units.svg" --quiet
degrees() {
  curves "$TMP/units.svg" 'class="level" fill="none" stroke="#666"' && awk '
    { r = 0.017453292519943295; d = ($3 < 0 ? -$3 : $3)*r - 2*2*cos($2*r/2); if (d < 0) d = -d; if (d > most) most = d } END { print most; exit !(most < 0.04) }' "$TMP/points"
}
check "in degrees" degrees

# Coordinates of first order: H = p^2/2 + x^2/2
cat >"$TMP/first.lag" <<'END'
model first
coord x, p
lagrangian = p*x' - p^2/2 - x^2/2
scene turn { start x = 1, p = 0; span 5 }
END
"$LAGC" plot "$TMP/first.lag" --portrait -o "$TMP/first.svg" --quiet >"$TMP/out" 2>&1
circles() {
  curves "$TMP/first.svg" 'class="level" fill="none" stroke="#bbb"' 1000 && awk '
    { r = sqrt($2*$2 + $3*$3); if (!($1 in low) || r < low[$1]) low[$1] = r; if (!($1 in high) || r > high[$1]) high[$1] = r; n = $1 }
    END { for (k = 1; k <= n; k++) if (high[k] - low[k] > 0.02) { print k, low[k], high[k]; bad = 1 } exit bad || n < 8 }' "$TMP/points"
}
check "coordinates of first order: circles" circles

# A Hamiltonian with its only momentum: the same circles, and the potential x^2/2 under the energy 1/2
cat >"$TMP/phase.lag" <<'END'
model phase
coord x
momentum p of x
hamiltonian = p^2/2 + x^2/2
scene turn { start x = 1; span 7 }
END
"$LAGC" plot "$TMP/phase.lag" --portrait -o "$TMP/first.svg" --quiet >"$TMP/out" 2>&1
check "a Hamiltonian: momentum over coordinate" circles
"$LAGC" plot "$TMP/phase.lag" --potential -o "$TMP/potential.svg" --quiet >"$TMP/out" 2>&1
parabola() {
  curves "$TMP/potential.svg" 'class="level"' 100 && awk '{ d = $3 - $2*$2/2; if (d*d > 1e-6) { print; bad = 1 } } END { exit bad }' "$TMP/points" &&
    curves "$TMP/potential.svg" 'stroke-width="1.6"' 2 && awk '{ d = $3 - 0.5; if (d*d > 1e-6) { print; bad = 1 } } END { exit bad }' "$TMP/points"
}
check "and its potential, H at p = 0" parabola
sed 's/^hamiltonian.*/lagrangian = x'"'"'^2/; s/x = 1/x = 1, x'"'"' = 1/' "$TMP/phase.lag" >"$TMP/named.lag"
"$LAGC" plot "$TMP/named.lag" --portrait -o "$TMP/named.svg" --quiet >"$TMP/out" 2>&1
check "a name of a momentum beside L changes nothing" grep -q ">x'" "$TMP/named.svg"

# The separatrix through th = 0: v^2/2 = w^2 sin(th)^2/2 + g/R (cos(th) - 1), an X, to 0.4 pixels of 400 on 8.2 rad/s.
"$LAGC" plot models/bead_on_hoop.lag fast --portrait -o "$TMP/hoop.svg" --quiet >"$TMP/out" 2>&1
crossing() {
  curves "$TMP/hoop.svg" 'class="level" fill="none" stroke="#666"' && awk '
    function off(a) { v = 36*sin(a)^2 + 2*9.81/0.5*(cos(a) - 1); v = v > 0 ? sqrt(v) : 0; d = ($3 < 0 ? -$3 : $3) - v; return d < 0 ? -d : d }
    $2 < 0.15 && $2 > -0.15 { n++; e = off($2); if (e > most) most = e; if ($2*$2 < 1e-4) at++ } END { print n, at, most; exit !(n > 20 && at > 3 && most < 0.008) }' "$TMP/points"
}
check "a separatrix crosses itself in an X" crossing

# ---- the distance of runs
# x'' = x from x = 0 and x = 1e-8, both from rest: 1e-8 cosh(t)
cat >"$TMP/saddle.lag" <<'END'
model saddle
coord x [m]
param k = 1 [1/s^2]
kinetic = x'^2/2
potential = -k*x^2/2
scene rest { start x = 0; span 10; tolerance 1e-12; output x every 0.07 [s]; monitor energy 1e-8 }
END
distance() {
  "$LAGC" plot "$TMP/saddle.lag" --vs x=1e-8 --distance -o "$TMP/distance.svg" >"$TMP/out" 2>&1 && cat "$TMP/out" && curves "$TMP/distance.svg" 'stroke="#0072b2" stroke-width="1.6"' 50 &&
    awk '{ d = $3/(1e-8*(exp($2) + exp(-$2))/2) - 1; if (d < 0) d = -d; if (d > most) most = d; last = $2 } END { print most; exit !(most < 0.03 && last > 9.9) }' "$TMP/points"
}
check "the distance of two starts grows as cosh" distance
check "its axis is that of the time" grep -q '>t \[s\]</text>' "$TMP/distance.svg"
# The straight line through log cosh(t) at the 1001 times of the picture, to a tenth of the largest.
rate() {
  want=$(awk 'BEGIN { for (i = 0; i <= 1000; i++) { t = i/100; y[i] = log((exp(t) + exp(-t))/2) }
    for (n = 0; y[n] < y[1000] - log(10); n++) { mx += n/100; my += y[n] }
    mx /= n; my /= n
    for (i = 0; i < n; i++) { xx += (i/100 - mx)^2; xy += (i/100 - mx)*(y[i] - my) }
    printf "grows as exp(%.3g t/s) up to t = %.3g s", xy/xx, (n - 1)/100; print xy/xx, my, mx, (n - 1)/100 >"'"$TMP/line"'" }')
  echo "$want" && grep -qF "1e-08 m at first, 0.00011 m at most; $want" "$TMP/out" && want=${want#*as } && grep -qF ">${want%% up*}<" "$TMP/distance.svg"
}
line() { # to half a pixel of 380, which are five decades
  curves "$TMP/distance.svg" 'stroke="#d55e00" stroke-width="1.6"' 2 && awk 'NR == FNR { rate = $1; my = $2; mx = $3; until = $4; next }
    { d = log($3/1e-8) - my - rate*($2 - mx); if (d < 0) d = -d; if (d > most) most = d; last = $2 } END { print most, last; exit !(most < 0.02 && last < until + 0.02 && last > until - 0.02) }' "$TMP/line" "$TMP/points"
}
check "and its rate is fitted" rate
check "and drawn" line
cat >"$TMP/two.lag" <<'END'
model two
coord x [m]
param k = 4 [1/s^2]
kinetic = x'^2/2
potential = k*x^2/2
scene swing { start x = 1; span 10; tolerance 1e-12; output x, x' }
END
relative() { # each is divided by its largest value: (0.1 cos 2t)/1, (0.2 sin 2t)/2
  "$LAGC" plot "$TMP/two.lag" --vs x=1.1 --distance -o "$TMP/two.svg" >"$TMP/out" 2>&1
  cat "$TMP/out" && grep -q 'distance from the first: 0.1 at first, 0.1 at most, each output over the largest value of its unit' "$TMP/out"
}
check "outputs of two units" relative

# ---- the error of the energy
# euler on x'' = -x: E_n = E_0 (1 + h^2)^n; its monitor is not asked.
cat >"$TMP/oscillator.lag" <<'END'
model oscillator
coord x
lagrangian = x'^2/2 - x^2/2
scene swing { start x = 1; span 10; monitor energy 1e-8 }
END
growth() {
  "$LAGC" plot "$TMP/oscillator.lag" --energy-error --method euler,symplectic_euler --step 0.01 -o "$TMP/errors.svg" >"$TMP/out" 2>&1 && cat "$TMP/out" &&
    curves "$TMP/errors.svg" 'stroke="#0072b2" stroke-width="1.6"' 50 &&
    awk '{ d = $3/(exp($2/0.01*log(1 + 1e-4)) - 1) - 1; if (d < 0) d = -d; if ($2 > 0.05 && d > most) most = d; last = $2 } END { print most; exit !(most < 0.03 && last > 9.9) }' "$TMP/points"
}
check "of Euler's method: (1 + h^2)^n" growth
# symplectic_euler keeps x^2 + v^2 - h x v = 1, an ellipse on which h x v is at most h/(2 - h) = 0.005025; rows lie within steps, too
check "the report has the largest error of the picture" grep -q '^symplectic_euler .*|E/E(0) - 1| up to 0.0050' "$TMP/out"
check "two methods, two lines of the legend" sh -c 'grep -c "symplectic_euler\|>euler<" "$0" | grep -qx 2' "$TMP/errors.svg"

# The energy v^2/2 - x begins at 0. By euler v = n h and x = h^2 n(n - 1)/2, which leaves h t/2 at ends of steps, where rows lie.
printf "model zero\ncoord x [m]\nlagrangian = 1 [kg]*x'^2/2 + 1 [N]*x\nscene s { span 5 [s] }\n" >"$TMP/zero.lag"
difference() {
  "$LAGC" plot "$TMP/zero.lag" --energy-error --method euler,rk4 --step 0.1 -o "$TMP/zero.svg" >"$TMP/out" 2>&1 && cat "$TMP/out" && grep '>|E - E(0)| \[J\], logarithmic<' "$TMP/zero.svg" &&
    curves "$TMP/zero.svg" 'stroke="#0072b2" stroke-width="1.6"' 40 && awk '{ d = $3/(0.05*$2) - 1; if ($2 > 0.2 && d*d > 0.0001) { print; bad = 1 } } END { exit bad }' "$TMP/points"
}
check "an energy that begins at 0: |E - E(0)|" difference
# ---- Equal steps: a picture has the ends of steps, not an interpolation between them.
# Symplectic Euler's x' += -h x, x += h x' on x'' = -x keeps x^2 + x'^2 - h x x', from x = 1: 1; numbers have 0.002 of an axis from -1 to 1.
sed 's/; monitor.*/ }/' "$TMP/oscillator.lag" >"$TMP/free.lag"
on_ellipse() {
  "$LAGC" plot "$TMP/free.lag" --x x --y "x'" --method symplectic_euler --step 0.3 --until 9 "$@" -o "$TMP/ellipse.svg" >"$TMP/out" 2>&1 && cat "$TMP/out" && ! grep 'note' "$TMP/out" &&
    curves "$TMP/ellipse.svg" 'stroke-width="1.6"' 30 && awk '{ d = $2*$2 + $3*$3 - 0.3*$2*$3 - 1; if (d > most) most = d; if (-d > most) most = -d } END { print most, NR; exit !(most < 0.01 && NR <= 35) }' "$TMP/points"
}
check "symplectic Euler's points are on its ellipse" on_ellipse
check "rows at each step draw the same, without a note" on_ellipse --every 0.3
# verlet4 on a wide swing: at ends of steps at most 1.31e-8, by rows there; interpolated a thousand times that. The last step ends after 3.87.
few() {
  "$LAGC" run models/pendulum.lag wide th=3 --method verlet4 --step 0.05 --until 3.85 --observe energy --every 0.05 --quiet -o - |
    awk -F, 'NR == 2 { e = $NF } NR > 1 { d = $NF/e - 1; if (d < 0) d = -d; if (d > most) most = d } END { print most }' >"$TMP/most" &&
    "$LAGC" plot models/pendulum.lag wide th=3 --energy-error --method verlet4 --step 0.05 --until 3.87 -o "$TMP/few.svg" --quiet && curves "$TMP/few.svg" 'stroke-width="1.6"' 50 &&
    awk 'NR == FNR { want = $1; next } $3 > most { most = $3 } END { print want, most; d = most/want - 1; exit !(d*d < 0.01) }' "$TMP/most" "$TMP/points"
}
check "the energy of verlet4 is that of its steps" few
check "and so is its drift" sh -c '"$0" run models/pendulum.lag wide th=3 --method verlet4 --step 0.05 --until 3.85 --measure "d=drift(energy)/energy(0)" | awk -v want="$(cat "$1")" "\$1 == \"d\" { d = \$2/want - 1; print \$2, want; ok = d*d < 1e-8 } END { exit !ok }"' "$LAGC" "$TMP/most"
# An event within a step is a corner if it changes the state, and no row if not: a ball from 1 m falls for sqrt(0.2) s, and bounces with half of its velocity.
corner() {
  printf "model ball\ncoord y [m]\nlagrangian = 1 [kg]*y'^2/2 - 10 [N]*y\nevent half: y - 0.5 [m] falling { }\nevent bounce: y falling { y' = -y'/2 }\nscene s { start y = 1 [m]; span 0.8 [s] }\n" >"$TMP/corner.lag"
  "$LAGC" plot "$TMP/corner.lag" --y y --method rk4 --step 0.2 -o "$TMP/corner.svg" --quiet && curves "$TMP/corner.svg" 'stroke-width="1.6"' 4 &&
    awk '{ print } $3 < 0.002 && $2 > 0.445 && $2 < 0.449 { low = 1 } $3 > 0.3 && $2 > 0.21 && $2 < 0.39 { bad = 1 } END { exit !(low && !bad) }' "$TMP/points"
}
check "a bounce within a step is a corner" corner

# A ball that bounces with half of its velocity loses three quarters of its energy, which is no error of the method.
printf "model ball\ncoord y [m]\nlagrangian = 1 [kg]*y'^2/2 - 10 [N]*y\nevent bounce: y falling { y' = -y'/2 }\nscene s { start y = 1 [m]; span 0.8 [s]; tolerance 1e-10 }\n" >"$TMP/ball.lag"
bounce() {
  "$LAGC" plot "$TMP/ball.lag" --energy-error -o "$TMP/ball.svg" >"$TMP/out" 2>&1 && grep -q 'impacts and events: -7.5 J' "$TMP/out" &&
    curves "$TMP/ball.svg" 'stroke-width="1.6"' 2 && awk '{ if ($3 > most) most = $3 } END { print most; exit !(most < 1e-8) }' "$TMP/points"
}
check "a loss at an event is no error" bounce
# Drag takes 1 - exp(-2 t) of the energy, which is no error of the method either: rk4 keeps the balance to h^4.
printf "model drag\ncoord x [m]\nlagrangian = 1 [kg]*x'^2/2\nforce x = -1 [kg/s]*x'\nscene s { start x' = 1 [m/s]; span 5 [s] }\n" >"$TMP/drag.lag"
drag() {
  "$LAGC" plot "$TMP/drag.lag" --energy-error --method rk4,euler --step 0.05 $1 -o "$TMP/drag.svg" >"$TMP/out" 2>&1 && cat "$TMP/out" && grep -q '>|(E - work)/E(0) - 1|, logarithmic<' "$TMP/drag.svg" &&
    curves "$TMP/drag.svg" 'stroke="#0072b2" stroke-width="1.6"' 2 && awk '{ if ($3 > most) most = $3 } END { print most; exit !(most < 1e-6) }' "$TMP/points"
}
check "nor is the work of forces" drag
check "said of each run" sh -c 'grep -c "|(E - work)/E(0) - 1| up to " "$0" | grep -qx 2' "$TMP/out"
check "without a report, too" drag --quiet
check "beside another picture it is the balance, as in one run" sh -c '"$0" plot "$1" --method rk4,euler --step 0.05 --y x -o "$2" | grep -c "energy balance" | grep -qx 2' "$LAGC" "$TMP/drag.lag" "$TMP/none.svg"
none() { "$LAGC" plot "$TMP/oscillator.lag" --vs x=1 --distance -o "$TMP/none.svg" 2>&1 | grep 'no distance from the first'; }
check "two equal runs" none

no() { # WORDS OPTIONS
  words=$1
  shift
  says 2 "$words" "$LAGC" plot "$@" -o "$TMP/no.svg" && [ ! -e "$TMP/no.svg" ]
}
check "two coordinates" no "with two of first order" models/double_pendulum.lag --portrait
check "a family" no "needs a model with one coordinate" models/chain.lag --portrait
check "the potential of coordinates of first order" no "needs a model with one coordinate;" "$TMP/first.lag" --potential
check "both" no "leave one of them out" models/pendulum.lag --portrait --potential
check "other axes" no "chooses the axes" models/pendulum.lag --portrait --phase th
"$LAGC" build models/pendulum.lag -o "$TMP/sim"
check "the distance of one run" no "--distance is between runs" models/pendulum.lag --distance
check "a distance over another axis" no "is over time" models/pendulum.lag --distance --vs th=1 --phase th
check "both differences" no "are two pictures" models/pendulum.lag --distance --vs th=1 --energy-error
check "other columns, by a simulator" says 2 "\`lagc plot\` chooses these" "$TMP/sim" wide --svg "$TMP/no.svg" --plot-x th --plot-y energy --portrait
check "no picture" says 2 "need a picture" "$TMP/sim" wide --portrait

# ---- sizes: an energy of 0 that drifts is no scale; axes of little range have numbers that differ
double=models/double_pendulum.lag
check "two starts 0.03 rad apart" "$LAGC" plot "$double" swing --distance --vs th1=1.6 -o "$TMP/apart.svg"
"$LAGC" plot "$double" swing --distance --vs th1=1.6 -o "$TMP/apart.svg" >"$TMP/said" 2>&1
first=$(sed -n 's/.*distance from the first: \([0-9.e+-]*\) at first.*/\1/p' "$TMP/said")
check "th1 and y2 begin 0.03 and 0.015 of their size apart, the energy 0.03*g*2 of g*6" close_to "$first" 0.02 0.015
check "powers of ten on the axis" grep -q '10<tspan' "$TMP/apart.svg"
printf '%s\n' 'model still' 'coord x' 'param k = 1 > 0' "lagrangian = x'^2/2" 'scene s { start x = 1, '"x' = 0"'; span 1}' >"$TMP/still.lag"
check "a histogram of a range of 1e-9" "$LAGC" sweep "$TMP/still.lag" 'k~uniform(0, 1)' --samples 40 --measure 'max(x + k*1e-9)' --histogram 5 --svg "$TMP/still.svg"
labels() { sed -n 's/.*<text [^>]*text-anchor="middle"[^>]*>\([0-9.e+-]*\)<.*/\1/p' "$TMP/still.svg" | sort | uniq -d; }
is "has no two labels alike" "" "$(labels)"
check "and says what they begin with" grep -q '>1[0-9.]* +<' "$TMP/still.svg"
"$LAGC" plot models/toda.lag --until 1 -o "$TMP/toda.svg" >"$TMP/said" 2>&1
check "without units a family has a panel of its own, without sums that are larger by orders" grep -q '>I1, I2, I3, I4, energy<' "$TMP/toda.svg"
"$LAGC" plot models/fput.lag recurrence --until 10 -o "$TMP/fput.svg" --quiet >"$TMP/out" 2>&1
check "an axis of several members has the name of their family" grep -q 'class="l">mode</text>' "$TMP/fput.svg"
tap_end
