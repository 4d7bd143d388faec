#!/bin/sh
# lagc plot, lagc animate and run --observe: curves agree with the rows of the same run. The SVG is measured; the
# page of the animation is opened in Chromium where there is one, and its own test of the controls (#test) is run.
. tests/tap.sh

case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
models=$(pwd)/models
cd "$TMP" || exit 1

# says STATUS WORDS ARGS...: lagc's exit status, and standard error holds the words
says() {
  want=$1 words=$2
  shift 2
  "$LAGC" "$@" >out 2>err
  got=$?
  cat out err
  [ "$got" = "$want" ] && grep -qF -e "$words" err
}
runs() { "$LAGC" "$@" >out 2>err || { cat err; return 1; }; }
# row N FILE: line N of a CSV file (1 is the head; $ the last), commas as spaces
row() { sed -n "$1p" "$2" | tr ',' ' '; }
well_formed() {
  if command -v xmllint >/dev/null; then xmllint --noout "$1"
  else head -n 1 "$1" | grep -q '^<svg ' && tail -n 1 "$1" | grep -qx '</svg>' && ! grep -q '<[^>]*<' "$1"; fi
}

not() { ! "$@"; }
not_grep() { ! grep -n -e "$1" "$2"; }

# ---- measuring an SVG: the frame, the scale by its ticks, the points of each curve ----
# measure FILE: "inside" or "outside"; then "first X Y" and "last X Y" of the last curve, in the units of the axes
cat >measure.awk <<'END'
function number(s, key) { match(s, key "=\"[-0-9.]*\""); return substr(s, RSTART + length(key) + 2, RLENGTH - length(key) - 3) + 0 }
/^<rect x=/ { fx = number($0, "x"); fy = number($0, "y"); fw = number($0, "width"); fh = number($0, "height"); nx = ny = 0 }
/^<text .*text-anchor="middle">/ { v = $0; gsub(/<[^>]*>/, "", v); nx++; px[nx] = number($0, "x"); vx[nx] = v + 0 }
/^<text .*text-anchor="end">/ { v = $0; gsub(/<[^>]*>/, "", v); ny++; py[ny] = number($0, "y") - 5; vy[ny] = v + 0 }
/^<path fill="none"/ {
  d = $0; sub(/.* d="/, "", d); sub(/".*/, "", d); gsub(/[ML]/, " ", d)
  n = split(d, c, " ")
  for (i = 1; i < n; i += 2)
    if (c[i] < fx - 0.1 || c[i] > fx + fw + 0.1 || c[i + 1] < fy - 0.1 || c[i + 1] > fy + fh + 0.1) outside++
  points += n / 2
}
function x(p) { return vx[1] + (p - px[1])*(vx[nx] - vx[1])/(px[nx] - px[1]) }
function y(p) { return vy[1] + (p - py[1])*(vy[ny] - vy[1])/(py[ny] - py[1]) }
END {
  print (points > 10 && !outside ? "inside" : "outside")
  if (nx > 1 && ny > 1) print "first", x(c[1]), y(c[2]) "\nlast", x(c[n - 1]), y(c[n])
  if (nx > 1 && ny > 1) print "scale", (px[nx] - px[1])/(vx[nx] - vx[1]), (py[1] - py[ny])/(vy[ny] - vy[1])
  for (i = 1; all && i < n; i += 2) print "point", x(c[i]), y(c[i + 1])
}
END
measure() { awk -f measure.awk "$1"; }
# near "A B" "C D" TOLERANCE
near() {
  echo "$1 | $2"
  echo "$1 $2" | awk -v tol="$3" '{ for (i = 1; i <= NF/2; i++) { d = $i - $(i + NF/2); if (!(d <= tol && -d <= tol)) exit 1 } exit NF < 2 || NF % 2 }'
}
inside() { measure "$1" | grep -qx inside; }
# ends FILE.svg FILE.csv COLUMN_X COLUMN_Y TOLERANCE: the curve begins and ends where the rows do
ends() {
  near "$(measure "$1" | sed -n 's/^first //p')" "$(row 2 "$2" | awk -v a="$3" -v b="$4" '{ print $a, $b }')" "$5" &&
    near "$(measure "$1" | sed -n 's/^last //p')" "$(row '$' "$2" | awk -v a="$3" -v b="$4" '{ print $a, $b }')" "$5"
}
one_scale() { measure "$1" | awk '/^scale/ { d = $2/$3; exit !(d > 0.99 && d < 1.01) }'; }

# ---- plot ----
p=$models/pendulum.lag
check "plot, everything against time" runs plot "$p" wide
check "its file is MODEL_SCENE.svg, and said" grep -q 'picture in pendulum_wide.svg' out
check "it is well-formed" well_formed pendulum_wide.svg
check "all points are inside the frames" inside pendulum_wide.svg
check "one panel a unit" [ "$(grep -c '^<rect x=' pendulum_wide.svg)" = 4 ]

check "columns that the scene does not have" \
  runs run "$p" wide --observe 'l*sin(th)' --observe '-l*cos(th)' --observe "(l*sin(th))'" l=2 -o rows.csv
is "their names and units" "l*sin(th) [m],-l*cos(th) [m],(l*sin(th))' [m/s]" "$(head -n 1 rows.csv | cut -d, -f 6-)"
is "after those of the scene" "t [s],th [rad],th' [rad/s],pull [N],energy [J]" "$(head -n 1 rows.csv | cut -d, -f 1-5)"

check "a path by expressions" runs plot "$p" wide --x 'l*sin(th)' --y '-l*cos(th)' l=2 -o path.svg
check "it is well-formed" well_formed path.svg
check "all points are inside the frame" inside path.svg
check "it begins and ends where the rows do" ends path.svg rows.csv 6 7 0.01
check "a metre is as long across as it is up" one_scale path.svg

check "a phase portrait" runs plot "$p" fading --phase th -o phase.svg
runs run "$p" fading -o fading.csv
check "it begins and ends where the rows do" ends phase.svg fading.csv 2 3 0.02
check "its axes are named" grep -q "th' \[rad/s\]" phase.svg
check "a phase portrait of an expression" runs plot "$p" fading --phase 'l*sin(th)' -o phase.svg
check "its axes are named" grep -q "(l\*sin(th))' \[m/s\]" phase.svg

check "one expression against time" runs plot "$models/spring.lag" --y "m/2*x'^2 + k/2*x^2 + x*1 [N]" --until 3 -o y.svg
check "a curve with the right ends" near "$(measure y.svg | sed -n 's/^first //p')" "0 3" 0.02
check "long expressions" runs plot "$p" --x "th + 0*(th*th*th*th*th*th*th + th*th*th*th*th + th*th*th*th*th*th*th*th*th*th*th*th*th*th)" \
  --y "th' + 0*(th*th*th*th*th*th*th + th*th*th*th*th + th*th*th*th*th*th*th*th*th*th*th*th*th*th*th*th)*1 [Hz]" -o long.svg
check "constants and the time" runs plot "$p" --x t --y 'g*t^2/2' --until 2 -o fall.svg
check "the last one is g*2" near "$(measure fall.svg | sed -n 's/^last //p')" "2 19.62" 0.05
check "the simulator's own options" runs plot "$p" wide --until 1 --method rk4 --step 1e-3 --sketch --phase th -o a.svg
check "draw in the terminal too" grep -q 'rad/s' out
check "in the order that one likes" runs plot "$p" --until 1 wide l=2 -o a.svg

# labels_apart FILE: no two labels of the axis of x touch, at 6.5 pixels a character
labels_apart() {
  awk '/text-anchor="middle">/ { x = $0; sub(/.*<text x="/, "", x); v = $0; gsub(/<[^>]*>/, "", v); w = 6.5*length(v)
         if (n++ && x - w/2 < end) { print v " touches the label before it"; bad = 1 } end = x + w/2 }
       END { exit bad || n < 3 }' "$1"
}
slow check "a path whose labels are long" runs plot "$p" wide --x '-3.08e7*l + 1e4*x' --y '1e4*y' -o far.svg
slow check "leaves some out" labels_apart far.svg
check "and others in" labels_apart path.svg

check "an unknown name, with its place" says 1 '--x:1:7: error: unknown name `thh`' plot "$p" --x 'l*sin(thh)' --y th -o none.svg
check "shown with a caret" grep -q '\^~~' err
check "what is no expression" says 1 '--y:1:4: error: expected `)`' plot "$p" --y '(th' -o none.svg
check "nothing at all" says 1 'expected an expression' plot "$p" --y '' -o none.svg
check "units that do not match" says 1 'units do not match' plot "$p" --y 'th + l' -o none.svg
check "a condition" says 1 'is a condition, not a number' run "$p" --observe 'th > 0'
check "--x without --y" says 2 'add --y' plot "$p" --x th
check "--phase with --x" says 2 'leave out --x and --y' plot "$p" --phase th --x th
check "an unknown scene" says 1 'unknown scene `wied`' plot "$p" wied --phase th
check "of any command" says 1 'did you mean `wide`?' plot "$p" wied
check "before a simulator is built" not_grep 'this build' err
check "or far from all names" says 1 'the scenes are `small`, `tiny`' modes "$p" nosuch
check "energy, misspelt" says 1 'did you mean `energy`?' plot "$p" --y enrgy
check "or as a title" says 1 'did you mean `energy`?' plot "$p" --y Energy
once() { [ "$("$LAGC" plot "$p" --phase "$1" -o none.svg 2>&1 | grep -c "unknown name")" = 1 ]; }
check "a name of --phase is unknown once" once thx
check "within an expression, too" once '2*thx'
check "a name far from all names, and energy" says 1 'the model has th, m, l, g, x, y, pull, energy' plot "$p" --y nosuch
check "is not to be declared" not_grep 'declare it' err
check "a value is missing" says 2 'needs a value' plot "$p" --x
check "an effect that the scene does not use" says 1 'friction' plot "$p" wide --y 'friction.b*th' -o none.svg
check "a folder that is not there" says 2 'cannot write' plot "$p" -o none/a.svg
check "a value that the model does not allow" says 2 'declares l > 0' plot "$p" l=-1 -o none.svg
check "nothing is left of all that" [ -z "$(ls none* ./*.part* 2>/dev/null)" ]

# ---- plot: curves follow the motion between rows, too ----
f=$models/foucault.lag
# turns FILE: how often its last curve turns round in y
turns() {
  grep '^<path fill="none"' "$1" | tail -n 1 | sed 's/.* d="//; s/".*//; s/[ML]/ /g' |
    awk '{ for (i = 4; i <= NF; i += 2) { d = $i - $(i - 2); if (d*was < 0) n++; if (d) was = d } print n + 0 }'
}
check "swings that are shorter than the scene's rows are long" runs plot "$f" --until 200 --y x -o swings.svg
is "are all there: 12 periods of 16.42 s" 24 "$(turns swings.svg)"
check "an orbit with a row a year" runs plot "$models/outer_planets.lag" --x 'r[2].x' --y 'r[2].y' --until 4e8 -o orbit.svg
# corner FILE: the sharpest corner of its last curve, in degrees
corner() {
  grep '^<path fill="none"' "$1" | tail -n 1 | sed 's/.* d="//; s/".*//; s/[ML]/ /g' | awk '{
    for (i = 5; i < NF; i += 2) {
      ax = $(i - 2) - $(i - 4); ay = $(i - 1) - $(i - 3); bx = $i - $(i - 2); by = $(i + 1) - $(i - 1)
      c = atan2(ax*by - ay*bx, ax*bx + ay*by); c = c < 0 ? -c : c; if (c > worst) worst = c
    }
    printf "%.0f\n", worst*57.3 }'
}
check "has no corners" [ "$(corner orbit.svg)" -lt 10 ]
check "a ball that bounces, at whose impacts two rows have one time" runs plot "$models/bouncing_ball.lag" drop --until 2 -o bounce.svg
check "all points are inside the frames" inside bounce.svg
check "a run that is shorter than a row" runs plot "$f" --until 5 --y x -o short.svg
check "is drawn" [ "$(grep '^<path fill="none"' short.svg | tr 'L' '\n' | wc -l)" -gt 10 ]
check "rows that are asked for are drawn as they are, with a note" \
  says 0 'rows every 10 s are too coarse for this motion' plot "$f" --until 200 --y x --every 10 -o coarse.svg
check "a method that steps to its rows" runs plot "$f" --until 200 --y x --method gsl-rk8pd -o gsl.svg
[ -z "$GSL" ] || is "is drawn as finely" 24 "$(turns gsl.svg)"

# ---- plot: legends, labels, scales ----
cat >names.lag <<'END'
model names
const N = 20
coord u[N] [m], angular_momentum_of_the_body [m]
kinetic = sum(i in 1..N, (1 [kg])*u[i]'^2/2) + (1 [kg])*angular_momentum_of_the_body'^2/2
potential = sum(i in 1..N, (1 [N/m])*i/2*u[i]^2)
scene s { start u = 1 [m]; span 3 [h]; output u, angular_momentum_of_the_body every 1 [s] }
END
check "twenty lines" runs plot names.lag --until 9 -o many.svg
is "are twenty different ones" 20 "$(grep '^<path d=.*h20' many.svg | sed 's/.*h20" //' | sort -u | head -n 20 | wc -l)"
cat >panels.lag <<'END'
model panels
const N = 20
coord u[N] [m]
lagrangian = sum(i in 1..N, (1 [kg])*u[i]'^2/2 - (1 [N/m])*i/2*u[i]^2)
scene s { start u = 1 [m]; span 9 [s]; output u, u' every 1 [s] }
END
check "twenty lines in each of two panels" runs plot panels.lag -o panels.svg
# Thousands of rows in the first second, and a slow curve behind them, which has a point in each pixel column: lines between points leave sin(t) by at
# most a third of a pixel, of 173 a metre.
cat >burst.lag <<'END'
model burst
coord x [m]
param w = 8000 [rad/s]
lagrangian = x'^2/2 - w^2/2*x^2
observe y [m] = x*exp(-t/1[s]) + 1[m]*sin(t/1[s])
scene a { start x = 0.0025; span 20 [s]; tolerance 1e-8 }
END
check "rows that crowd" runs plot burst.lag a --y y -o burst.svg
leaves() { awk -f measure.awk -v all=1 burst.svg | awk '/^point/ { if (n++ && t > 8) { d = (y + $3)/2 - sin((t + $2)/2); if (d < 0) d = -d; if (d > most) most = d } t = $2; y = $3 } END { print n, most; exit !(n > 600 && most < 0.33/173) }'; }
check "leave room for the rest" leaves

# A panel is 230 pixels high, a line of its legend 18: eleven curves are named, and nine are counted.
is "a legend names those that fit beside its panel, and counts the others" "22, 9 9" \
  "$(grep -c '^<path d=.*h20' panels.svg), $(sed -n 's/.*>and \([0-9]*\) more<.*/\1/p' panels.svg | tr '\n' ' ' | sed 's/ $//')"
# legend_fits FILE: no text of it ends right of the picture, at 8.6 pixels a character
legend_fits() {
  awk '/^<svg/ { match($0, "width=\"[0-9]*"); w = substr($0, RSTART + 7, RLENGTH - 7) + 0 }
    /^<text x="[0-9.]*" y="[0-9.]*" >/ { x = $0; sub(/<text x="/, "", x); v = $0; gsub(/<[^>]*>/, "", v); if (x + 8.6*length(v) > w) { print v; exit 1 } n++ }
    END { exit n < 1 }' "$1"
}
check "long names" runs plot names.lag --until 9 -D N=2 -o names.svg
check "are not cut off" legend_fits names.svg
check "and written out" grep -q '>angular_momentum_of_the_body<' names.svg
check "hours" runs plot names.lag -D N=1 -o hours.svg
check "are called so" grep -q '>t \[h\]<' hours.svg
cat >needle.lag <<'END'
model needle
coord x
lagrangian = x'^2/2 - 1e4*x^2/2
scene s { start x = 1; span 1 }
END
check "a quantity and its rate" runs plot needle.lag --phase x -o needle.svg
check "fill the frame" awk '/^<rect x=/ { exit !(match($0, "height=\"520") && match($0, "width=\"600")) }' needle.svg
narrow() { awk '/^<path fill="none"/ { d = $0; sub(/.* d="/, "", d); gsub(/[ML]/, " ", d); n = split(d, c, " ")
  for (i = 1; i < n; i += 2) { if (!lo || c[i] < lo) lo = c[i]; if (c[i] > hi) hi = c[i] } } END { exit hi - lo > 400 }' "$1"; }
check "across, too" not narrow needle.svg
check "long labels" runs plot "$p" --x th --y "th'+0*th'+0*th'+0*th'+0*th'+0*th'+0*th'+0*th'+0*th'+0*th'+0*th'+0*th'" -o label.svg
check "keep their unit" grep -q '\.\.\. \[1/s\]<' label.svg
touching() { awk '/>[-0-9.e]* \+<\/text>/ { match($0, "y=\"[0-9.]*"); y = substr($0, RSTART + 3, RLENGTH - 3); if (y - 11 < 30) exit 1; n++ } END { exit !n }' "$1"; }
check "what labels leave out" runs plot "$p" wide --y 'x/1e7 + 1 [m]' --until 3 -o offset.svg
check "is said below the title" touching offset.svg
check "a picture that plot does not write" says 2 'plot writes SVG' plot "$p" -o path.jpg
check "a page that animate does not write" says 2 'animate writes HTML' animate "$p" -o path.pdf

# ---- families ----
c=$models/chain.lag
check "all members of a family" runs plot "$c" --y th --until 2 -o th.svg
is "have a line each" "th[1] th[2] th[3] " "$(grep '^<text x="[0-9.]*" y="[0-9.]*" >' th.svg | sed 's/<[^>]*>//g' | tr '\n' ' ')"
check "in phase space" runs plot "$c" --phase th --until 2 -o phase.svg
is "a curve each" 3 "$(grep -c '^<path fill="none"' phase.svg)"
check "in the plane" runs plot "$c" --x x --y y --until 2 -o plane.svg
is "in the order of their numbers" "y[0] y[1] y[2] y[3] " "$(grep '^<text x="[0-9.]*" y="[0-9.]*" >' plane.svg | sed 's/<[^>]*>//g' | tr '\n' ' ')"
check "components of a family of vectors" runs plot "$models/outer_planets.lag" --x r.x --y r.y --until 4e8 -o plane.svg
is "a curve each" 6 "$(grep -c '^<path fill="none"' plane.svg)"
check "families of different sizes" says 2 'has 3 parts' plot "$c" --x th --y x -o none.svg

# ---- animate: the file ----
a() { runs animate "$@" --quiet; }
d=$models/double_pendulum.lag
check "animate" runs animate "$d" --until 5
check "its file is MODEL_SCENE.html, and said" grep -q 'animation in double_pendulum_swing.html' out
check "a guess is said" grep -q "guessed drawing: rod, rod, ball at (x1, y1), ball at (x2, y2)" err
page=double_pendulum_swing.html
check "the page without its data is small" [ "$(sed '/^{"t0"/,/]}$/d' $page | wc -c)" -lt 50000 ]
foreign() { grep -n -i -e 'https\{0,1\}:' -e 'src=' -e '[^a-z]url(' -e '@import' -e 'import(' -e 'fetch(' "$1"; }
empty "it asks for nothing from elsewhere" "$(foreign $page)"
unbalanced() {
  for tag in html head title style body h1 canvas form button select label output noscript script span; do
    open=$(grep -o "<$tag[ >]" "$1" | wc -l) shut=$(grep -o "</$tag>" "$1" | wc -l)
    [ "$open" = "$shut" ] && [ "$open" != 0 ] || echo "<$tag>: $open opened, $shut closed"
  done
}
empty "its tags are closed" "$(unbalanced $page)"
check "nothing of the template is left" not_grep '@[A-Z]*@' $page

# hook FILE: its shapes, kind and text
hook() {
  sed -n 's/.*"shapes": \(.*\), "cols".*/\1/p' "$1" | awk '{ gsub(/\]\], \["/, "\n\""); print }' |
    sed 's/^\[*"\([a-z]*\)", "[a-z]*", /\1 /; s/, [0-9]*, \[[-0-9].*//; s/ null$//' | paste -s -d';' -
}
is "rods, from the origin and from the let that is added to" 'rod;rod;ball "(x1, y1)";ball "(x2, y2)"' "$(hook $page)"
# joints FILE: of each rod the columns of its ends
joints() { sed -n 's/.*"shapes": \(.*\), "cols".*/\1/p' "$1" | grep -o '"rod", [^[]*\[[-0-9, ]*\], \[[-0-9, ]*\]' | sed 's/.*null, [0-9]*, //' | paste -s -d' ' -; }
is "the second on the end of the first" '[0, 0, -1], [1, 2, -1] [1, 2, -1], [3, 4, -1]' "$(joints $page)"
check "a family of points hangs from its number 0" a "$c" -o b.html
is "each from the one before" '[0, 0, -1], [1, 2, -1] [1, 2, -1], [3, 4, -1] [3, 4, -1], [5, 6, -1]' "$(joints b.html)"
check "or is named" a "$c" --points 'x,y' --no-rods --until 1 -o b.html
is "point by point" 'ball "(x[0], y[0])";ball "(x[1], y[1])";ball "(x[2], y[2])";ball "(x[3], y[3])"' "$(hook b.html)"
cat >row.lag <<'END'
model row "A row of masses"
coord u[3]
lagrangian = sum(i in 1..3, u[i]'^2/2 - u[i]^2/2)
scene s { start u[1] = 1; span 1 }
END
check "a row of masses" a row.lag -o b.html
is "each at its number" 'ball;ball;ball' "$(hook b.html)"
check "each axis on its own scale" grep -q '"free": true' b.html
cat >only.lag <<'END'
model only "One angle"
coord th periodic
lagrangian = th'^2/2 + cos(th)
scene s { start th = 1; span 4 [s] }
END
check "one angle" a only.lag -o b.html
is "is a rod that hangs" 'rod;ball "(sin(th), -cos(th))"' "$(hook b.html)"
check "points by expressions, with spaces and signs" \
  a "$p" --points "l*sin(th)/2, -l*cos(th)/2; 0 [m],-l  atan2(th, 1)*1 [m],l - 1 [m]" --from '0,l' --no-rods -o b.html
is "are taken apart" 'ball "(l*sin(th)/2, -l*cos(th)/2)";ball "(0 [m], -l)";ball "(atan2(th, 1)*1 [m], l - 1 [m])"' "$(hook b.html)"
check "one point from another" a "$p" --points 'x,y' --from '0,l' -o b.html
is "with its rod" 'rod;ball "(x, y)"' "$(hook b.html)"
# page_frames FILE: how many lines its data have, one a frame
page_frames() { sed -n '/^, "v"/,/]}$/p' "$1" | wc -l; }
check "frames as asked" a "$p" --every 0.001 -o b.html
is "a row is a frame" "20001" "$(page_frames b.html)"
# By default frames follow the motion: 5254 swings of Foucault's pendulum are some 70 frames each, in a few MB.
f=$models/foucault.lag
slow check "a day of swings" a "$f" -o day.html
[ -z "${SLOW:-}" ] || check "has more frames than 20 a swing" [ "$(page_frames day.html)" -gt 105080 ]
[ -z "${SLOW:-}" ] || check "in less than 8 MB" [ "$(wc -c <day.html)" -lt 8000000 ]
check "coarse frames are told" says 0 'note: rows every 60 s are too coarse for this motion' animate "$f" --until 3600 --every 60 -o b.html
check "in the page, too" grep -q '"note": "rows every 60 s' b.html
check "fine ones are not" runs animate "$f" --until 3600 --every 0.25 -o b.html
check "by no word" not_grep note: err

# A curve that hardly moves is flat in the terminal: the ends of its axis differ in the digits that are shown.
flat() {
  "$LAGC" run "$p" wide --until 1 --observe energy --sketch --quiet | awk '/^energy/ { on = 1 } on && /┤/ { v[n++] = $1 } END { exit !(n == 2 && v[0] != v[1]) }'
}
check "a constant, in a terminal" flat
charts() { "$LAGC" run "$p" wide --until 1 --observe energy --sketch --quiet | sed -n 's/^\([a-z].*\) \[.*/\1/p' | tr '\n' ' '; }
is "each column has its chart" "th th' pull energy " "$(charts)"

check "no points" says 2 'no point is given' animate "$p" --points ''
cat >vectors.lag <<'END'
model vectors
const N = 2
coord r: vec2 [m], b[N]: vec3 [m]
lagrangian = dot(r', r')/2 + sum(i in 1..N, dot(b[i]', b[i]')/2)
scene s { start r' = (1, 2); span 1 }
END
check "vectors among the coordinates are points" says 0 'guessed drawing: ball at r, ball, ball;' animate vectors.lag
check "as many as there are" says 0 'guessed drawing: ball at r, ball;' animate vectors.lag -D N=1
printf 'model hangs\ncoord a [deg]\nparam l = 1 [m] > 0, g = 9.81 [m/s^2]\nlagrangian = a%s^2/2 + g/l*cos(a)\n' "'" >hangs.lag
check "an angle that is not declared periodic is a rod, too" says 0 'guessed drawing: rod, ball at (sin(a), -cos(a))' animate hangs.lag
sed 's/\[deg\]/[m]/; s/cos(a)/cos(a\/l)/; s/g\/l/g*l/' hangs.lag >slides.lag
check "a length is a point on a line" says 0 'guessed drawing: ball at a;' animate slides.lag
printf 'model still\nstate n [kg]\nflow n%s = 1 [kg/s]\n' "'" >still.lag
check "nothing to draw" says 2 'write `draw ball at (X, Y)`' animate still.lag
check "half a point" says 2 'each point is x,y' animate "$p" --points 'x,y l' -o none.html
check "three numbers" says 2 'each point is x,y' animate "$p" --points 'x,y,l' -o none.html
check "two places to begin from" says 2 'takes one point' animate "$p" --points 'x,y' --from 'x,y x,y' -o none.html
check "an unknown name, with its place" says 1 '--points:1:1: error: unknown name `xx`' animate "$p" --points 'xx,y' -o none.html
check "two units" says 2 'needs one unit' animate "$p" --points 'x,th' -o none.html
check "nothing is left of all that" [ -z "$(ls none* ./*.part* 2>/dev/null)" ]

# Past the horizon, where no digit is left, curves are grey, and so are the points of an animation; points of a section stay.
check "a chaotic motion" "$LAGC" plot "$d" chaos --until 40 -o chaos.svg --quiet
is "each curve has a grey end" "$(grep -c '<path fill="none" stroke="#[0-9a-f]\{6\}"' chaos.svg)" "$(grep -c '<path fill="none" stroke="#bbb"' chaos.svg)"
check "and the horizon its name" grep -q '>no digit is left<' chaos.svg
"$LAGC" plot "$d" chaos --phase th2 --quiet -o phase.svg
check "over another axis the grey has a line of the legend" sh -c 'grep -A1 "h20. stroke=.#bbb" phase.svg | grep -q ">no digit is left<"'
# An angle th = 2 t that is declared periodic: over more than a turn it is a circle, from -pi to pi, in pieces: 20 rad cross pi, 3 pi and 5 pi.
printf "model rotor\ncoord th [rad] periodic\nlagrangian = 1 [kg*m^2]*th'^2/2\nscene s { start th' = 2 [rad/s]; span 10 [s] }\n" >rotor.lag
ticks() { sed -n 's/.*text-anchor="middle">\(-*[0-9.]*\)<.*/\1/p' rotor.svg | tr '\n' ' '; }
"$LAGC" plot rotor.lag --phase th --quiet -o rotor.svg
is "an angle of several turns is drawn as a circle" "-3 -2 -1 0 1 2 3 " "$(ticks)"
is "in pieces" 4 "$(sed -n 's/^<path fill="none".* d="//p' rotor.svg | tail -1 | tr -cd M | wc -c)"
"$LAGC" plot rotor.lag --phase th th=1 --until 2 --quiet -o rotor.svg
is "one of less than a turn is not" "1 1.5 2 2.5 3 3.5 4 4.5 5 " "$(ticks)"
check "a section of it" "$LAGC" plot "$d" chaos --until 40 --section 'sin(th1) rising' --x th2 --y "th2'" -o section.svg --quiet
is "has no grey" 0 "$(grep -c '#bbb' section.svg)"
check "a page of it" "$LAGC" animate "$d" chaos --until 40 -o chaos.html --quiet
check "knows the horizon" grep -q '"horizon": 1[0-9]\.' chaos.html
check "a regular motion has none" sh -c '"$0" plot "$1" -o regular.svg --quiet && ! grep -q "#bbb" regular.svg' "$LAGC" "$d"

# ---- animate: marks of contacts, friction and events ----
# marks FILE: a line for each mark: time, name, word
marks() {
  awk '/^\{"t0"/ { t0 = $0; sub(/^.*"t0": /, "", t0); tick = $0; sub(/^.*"tick": /, "", tick)
    names = $0; if (!sub(/^.*"marks": \{"names": \["/, "", names)) next
    at = names; sub(/"\], "at": .*/, "", names); sub(/^.*"at": \[/, "", at); sub(/\].*/, "", at)
    split(names, name, "\", \""); split("ends slips sticks acts event", word, " "); n = split(at, x, ", ")
    for (i = 1; i < n; i += 3) printf "%.9f %s %s\n", t0 + x[i]*tick, name[x[i + 1] + 1], word[x[i + 2] + 1] }' "$1"
}
# marked FILE LINE NAME WORD: the time of a mark, if it is this one
marked() { marks "$1" | sed -n "$2p" | grep -F " $3 $4" | cut -d' ' -f 1; }
# Times by closed forms; in the file they are rounded to 1e-9 of the span.
check "a ball that slides until it rolls" a "$models/sliding_ball.lag" pushed -o sliding.html
check "slips at first" near "$(marked sliding.html 1 table slips)" 0 1e-8
check "sticks from 2 v0/(7 mu g) on" near "$(marked sliding.html 2 table sticks)" 0.4368719965 1e-8
is "and has no other mark" 2 "$(marks sliding.html | wc -l | tr -d ' ')"
check "a ball that bounces" a "$models/bouncing_ball.lag" -o bounce.html
check "the first impact, after sqrt(2 h/g)" near "$(marked bounce.html 1 floor event)" 0.4515236410 1e-8
check "the second one, 2 e sqrt(2 h/g) later" near "$(marked bounce.html 2 floor event)" 1.1739614665 1e-8
cat >belt.lag <<'END'
model belt "A block on a belt, held by a spring, without a place to draw"
coord s [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0, N = 1 [N] > 0, v = 0.2 [m/s]
kinetic = m/2*s'^2
potential = k/2*s^2
let slip = s - v*t
friction rub on slip: 0.25*N, static = 0.4*N
scene squeak { start s' = v; span 10 [s] }
END
check "a block that sticks and slips" a belt.lag -o belt.html
check "breaks loose after mu_s N/(k v)" near "$(marked belt.html 2 "slip'" slips)" 2 1e-7
check "slips for pi + 2 atan(v/(0.15 m/s)) seconds" near "$(marked belt.html 3 "slip'" sticks)" 6.9961830896 1e-7
check "a rope that becomes taut" a "$models/rope_catch.lag" -o rope.html
check "acts then" sh -c 'grep -q "rope acts"' <<END
$(marks rope.html)
END
check "balls of time-stepping" a "$models/room.lag" bounce --method 'moreau(step=0.001)' --until 1 -o room.html
check "touch as steps say" sh -c 'grep -q acts' <<END
$(marks room.html)
END
# by moreau: words and impacts to a step
cat >drop.lag <<'END'
model drop
coord y [m]
kinetic = 1 [kg]/2*y'^2
potential = 9.81 [N]*y
contact floor: y >= 0, restitution = 0.8
scene s { start y = 1 [m]; span 2 [s] }
END
check "a ball that bounces, by time-stepping" a drop.lag --method 'moreau(step=0.001)' -o steps.html
check "is marked where it strikes" near "$(marks steps.html | grep 'floor event' | sed -n '1s/ .*//p')" 0.4515236410 1e-3
check "again" near "$(marks steps.html | grep 'floor event' | sed -n '2s/ .*//p')" 1.1739614665 2e-3
check "a ball that slides until it rolls, by time-stepping" a "$models/sliding_ball.lag" pushed --method 'moreau(step=0.001)' -o steps.html
check "slips" near "$(marked steps.html 1 table slips)" 0 1e-8
check "and sticks" near "$(marked steps.html 2 table sticks)" 0.4368719965 2e-3
is "nothing else" 2 "$(marks steps.html | wc -l | tr -d ' ')"
check "a block that sticks and slips, by time-stepping" a belt.lag --method 'moreau(step=0.001)' -o steps.html
check "breaks loose" near "$(marked steps.html 2 "slip'" slips)" 2 2e-3
check "and sticks" near "$(marked steps.html 3 "slip'" sticks)" 6.9961830896 2e-3
empty "a pendulum has no marks" "$(marks double_pendulum_swing.html)"

# ---- animate: the page in a browser ----
for name in chromium chromium-browser google-chrome; do
  browser=$(command -v $name) && break
done
if [ -z "$browser" ]; then
  skip "the page in a browser" "no chromium"
  tap_end
  exit
fi
# visit URL: writes the page after its scripts ran to dom, its console to console
visit() {
  HOME=$TMP timeout 90 "$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --disable-dev-shm-usage --user-data-dir="$TMP/profile" --enable-logging=stderr \
    --window-size=900,700 --dump-dom "file://$TMP/$1" >dom 2>console
  sed -n 's/.* data-frames="\([0-9]*\)".*/\1/p' dom | grep -q . || { tail -n 5 console; return 1; }
}
# the places of all points at the time in the URL
places() { visit "$1" && sed -n 's/.* data-points="\([^"]*\)".*/\1/p' dom | tr -d '[]' | tr ',' ' '; }
quiet_console() { ! grep -e 'CONSOLE' console; }
frames() { sed -n 's/.* data-frames="\([0-9]*\)".*/\1/p' dom; }

runs run "$d" --until 5.004 --every 0.01 --observe x1 --observe y1 -o rows.csv # t th1 th2 x2 y2 energy x1 y1
check "the same run as rows and as a page" a "$d" --until 5.004 --every 0.01 --trace -o double.html
at() { row "$1" rows.csv | awk '{ print $7, $8, $4, $5 }'; }
check "it opens at t = 1.5" near "$(places 'double.html#t=1.5')" "$(at 152)" 4e-5
check "nothing on the console" quiet_console
is "as many frames as rows" "$(($(wc -l <rows.csv) - 1))" "$(frames)"
# said FILE: the marks in words at the time in the URL
said() { visit "$1" && sed -n 's/.* data-marks="\([^"]*\)".*/\1/p' dom; }
is "the page says that the ball slips" "table slips" "$(said 'sliding.html#t=0.3')"
[ -z "${SLOW:-}" ] || is "that it sticks" "table sticks" "$(said 'sliding.html#t=0.6')"
is "and of an impact just now" "floor: now" "$(said 'bounce.html#t=0.5')"
check "with nothing on the console" quiet_console
[ -z "${SLOW:-}" ] || is "and not long before" "" "$(said 'bounce.html#t=0.4')"
between=$(echo "$(at 152) $(at 153)" | awk '{ print ($1 + $5)/2, ($2 + $6)/2, ($3 + $7)/2, ($4 + $8)/2 }')
[ -z "${SLOW:-}" ] || check "between two rows it is between them" near "$(places 'double.html#t=1.505')" "$between" 4e-5
[ -z "${SLOW:-}" ] || check "at the start" near "$(places 'double.html#t=0')" "$(at 2)" 4e-5
[ -z "${SLOW:-}" ] || check "at the end, which is off the grid" near "$(places 'double.html#t=5.004')" "$(at '$')" 4e-5
[ -z "${SLOW:-}" ] || check "after it" near "$(places 'double.html#t=99')" "$(at '$')" 4e-5
# tried FILE: the page's own test of its controls
tried() {
  visit "$1#test" && grep -q '^<*.*ok - seek to the start' dom && ! grep -e '^not ok' -e '>not ok' dom &&
    [ "$(grep -c 'ok - ' dom)" -ge 15 ] && quiet_console
}
check "its controls do what they say" tried double.html
cat >odd.lag <<'END'
model odd "Names that a page must not take for its own"
coord x [m], y [m]
lagrangian = (x'^2 + y'^2)/2 * 1 [kg] + 0 [J]*(x + y)/1 [m]
scene s { start x' = 1 [m/s]; span 1e-3 [s] }
END
check "names with < and quotes, a span of a millisecond" a odd.lag --points 'if(x < y, 1, 0)*1 [m],y' -o odd.html
slow check "open as others do" tried odd.html
# Other spans, units and ends of runs: the same page, a browser for each.
if [ -z "${SLOW:-}" ]; then
  tap_end
  exit
fi
# Position of the pendulum after 3600 s and a bit, by a run that ends there; the period is 16.4 s.
"$LAGC" run "$f" --until 3602.4 -o rows.csv --quiet
check "in a day of swings every place is one that occurs" near "$(places 'day.html#t=3602.4')" "$(row '$' rows.csv | awk '{ print $2, $3 }')" 0.006
check "it plays no faster than one can follow" [ "$(sed -n 's/.*"speed": \([0-9.]*\),.*/\1/p' day.html)" -lt 100 ]
"$LAGC" run "$d" chaos --until 12.5 --tol 1e-6 --observe x1 --observe y1 -o rows.csv --quiet
a "$d" chaos --until 2000 --tol 1e-6 -o long.html
check "and in a long chaos" near "$(places 'long.html#t=12.5')" "$(row '$' rows.csv | awk '{ print $7, $8, $4, $5 }')" 0.008
cat >tiny.lag <<'END'
model tiny "A bond that vibrates, some 20 fs a period"
coord x [m]
param m = 1e-26 [kg] > 0, k = 1000 [N/m] > 0
kinetic = m/2*x'^2
potential = k/2*x^2
scene s { start x = 1e-11 [m]; span 1e-13 [s] }
END
check "a tenth of a picosecond" a tiny.lag -o tiny.html
check "opens as others do" tried tiny.html
visit 'tiny.html#t=5e-14'
check "its clock goes" grep -q '>t = 0.0500[0-9]* ps<' dom
check "and it says how fast" grep -q '>1 s shows 5 fs<' dom
a "$models/mercury.lag" -o mercury.html
check "a span of months" tried mercury.html
check "is told in days" grep -q '>1 s shows 10 d<' dom
"$LAGC" run "$models/projectile.lag" air -o rows.csv --quiet
a "$models/projectile.lag" air --trace -o stone.html
check "a run that an event ends" tried stone.html
check "ends with it" near "$(places 'stone.html#t=1e3')" "$(row '$' rows.csv | awk '{ print $2, $3 }')" 1e-3
a "$p" --until=-3 -o back.html
check "backwards" tried back.html
check "a point that stands still" a "$p" --points '0,0' --until 1 -o still.html
check "opens too" tried still.html
check "places without a value" a odd.lag --points '1 [m^2]/x,y' -o nan.html
check "open too" visit 'nan.html#test'
tap_end
