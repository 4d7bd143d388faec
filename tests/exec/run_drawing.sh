#!/bin/sh
# Drawings: what `draw` statements and guesses hand to a page. The data of the page are read back: numbers of each
# shape at the last frame, against closed forms of motions that are known.
. tests/tap.sh

case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
cd "$TMP" || exit 1

# A line a shape: kind, role, count, a | b | size | turn with numbers for columns, `-` where there is none; text last.
cat >shapes.awk <<'END'
/"shapes": / {
  s = $0
  sub(/.*"shapes": \[\[/, "", s)
  cols = s
  sub(/.*\]\]\], "cols": \[/, "", cols)
  sub(/\].*/, "", cols)
  ncols = split(cols, zero, /, /)/2
  sub(/\]\]\], "cols".*/, "", s)
  n = split(s, shape, /\]\], \[/)
}
/^, "v"/ { on = 1 }
on { last = $0 }
/\]\}$/ { on = 0 }
function number(i, k) {
  if (i < 0) return "-"
  k = zero[2*i + 1] + zero[2*i + 2]*value[i]
  return sprintf("%.4g", k < 5e-6 && k > -5e-6 ? 0 : k)
}
END {
  sub(/.*\[/, "", last)
  sub(/\].*/, "", last)
  split(last, v, ",")
  for (i = k = 0; i < ncols; i++) value[i] = zero[2*i + 2] ? v[++k] : 0
  for (i = 1; i <= n; i++) {
    split(shape[i], part, /, \[/)
    m = split(part[1], word, /, /)
    gsub(/"/, "", word[1]); gsub(/"/, "", word[2])
    line = word[1] " " word[2] " " word[m]
    for (p = 2; p <= 5; p++) {
      gsub(/\]/, "", part[p])
      line = line " |"
      c = split(part[p], at, /, /)
      for (j = 1; j <= c; j++) line = line " " number(at[j])
    }
    text = part[1]
    sub(/^"[a-z]*", "[a-z]*", /, "", text)
    sub(/, [0-9]*$/, "", text)
    print line " " text
  }
}
END
# shapes FILE.lag ARGS...: those of its page
shapes() { "$LAGC" animate "$@" --quiet -o page.html >out 2>err || cat err; awk -f shapes.awk page.html; }

# x = 2 t and a turn of t: at 1 s x is 2 m, the angle 1, the rotation (cos 1/2, 0, 0, sin 1/2).
cat >all.lag <<'END'
model all "Each shape, and each option"
const N = 2
coord x [m], th [rad], R: rotation
param m = 1 [kg] > 0, r = 5 [cm] > 0
let w = omega(R)
kinetic = m/2*x'^2 + (1 [kg*m^2])/2*(th'^2 + dot(w, w))
potential = 0 [J]
draw rod from (0, 0) to (x, 2*x) width r
draw spring from (x, 0) to (0, x) coils 8 radius 0.1
draw damper from (x, 0) to (0, x) as second
draw disc at (x, 1 [m]) radius r turn th spokes 3
draw box at x size (r, 2*r) turn 45 [deg]
draw body R at (x, 0, x) box (1, 2, 3)
draw wall from (-1, 0) to (-1 [m], x)
draw ground at x
draw path of (x, -x)
draw arrow (m*x', m*3 [m/s]) at (0, 0) scale 0.5 [s/kg]
draw arrow (m*x', m*3 [m/s]) at (0, 0)
draw text "pivot" at (0, x)
draw ball[i in 1..N] at (i*x, 0)
for i in 1..2 { draw ball at (0, i*x) }
effect shown { draw ball at (7, 7) as star }
scene s { start x' = 2, th' = 1, omega(R) = (0, 0, 1); span 1 }
scene t { like s; use shown; draw ball at (8, 8) }
END
cat >expected <<'END'
rod link 0 | 0 0 - | 2 4 - | 0.05 - - | - - - - null
spring spring 8 | 2 0 - | 0 2 - | 0.1 - - | - - - - null
damper second 0 | 2 0 - | 0 2 - | - - - | - - - - null
disc body 3 | 2 1 - | - - - | 0.05 - - | 1 - - - "(x, 1 [m])"
box body 0 | 2 - - | - - - | 0.05 0.1 - | 0.7854 - - - "x"
body body 0 | 2 0 2 | - - - | 1 2 3 | 0.8776 0 0 0.4794 "(x, 0, x)"
wall support 0 | -1 0 - | -1 2 - | - - - | - - - - null
ground support 0 | - 2 - | - - - | - - - | - - - - "x"
path path 0 | 2 -2 - | - - - | - - - | - - - - null
arrow force 0 | 0 0 - | 1 1.5 - | - - - | - - - - "(0, 0)"
arrow force 1 | 0 0 - | 2 3 - | - - - | - - - - "(0, 0)"
text text 0 | 0 2 - | - - - | - - - | - - - - "pivot"
ball body 0 | 2 0 - | - - - | - - - | - - - - null
ball body 0 | 4 0 - | - - - | - - - | - - - - null
ball body 0 | 0 2 - | - - - | - - - | - - - - null
ball body 0 | 0 4 - | - - - | - - - | - - - - null
END
is "each shape with its numbers" "$(cat expected)" "$(shapes all.lag)"
is "an effect that is on, and the scene, add to it" 'ball star 0 | 7 7 - | - - - | - - - | - - - - "(7, 7)";ball body 0 | 8 8 - | - - - | - - - | - - - - "(8, 8)"' \
  "$(shapes all.lag t | tail -n 2 | paste -s -d';' -)"
is "the last scene first" 16 "$(shapes all.lag s | wc -l | tr -d ' ')"
as_compiled() {
  "$LAGC" animate all.lag s --quiet --compile always -o compiled.html &&
    "$LAGC" animate all.lag s --quiet --compile never -o page.html && cmp compiled.html page.html
}
slow check "evaluated as compiled" as_compiled

# A curve has 65 points, its ends where the range has them; its variable hides the coordinate of that name.
cat >curve.lag <<'END'
model curve "A bead on a parabola"
coord x [m]
param m = 1 [kg] > 0, a = 2 [1/m] > 0
kinetic = m/2*x'^2
draw curve y = a*x^2 for x in -1..1.5 [m]
draw ball at (x, a*x^2)
scene s { start x' = 1; span 1 }
END
shapes curve.lag >got
is "a curve has its points" 66 "$(wc -l <got | tr -d ' ')"
is "the first" 'curve support 65 | -1 2 - | - - - | - - - | - - - - null' "$(sed -n 1p got)"
is "the middle, at 1/4" 'curve support 33 | 0.25 0.125 - | - - - | - - - | - - - - null' "$(sed -n 33p got)"
is "the last" 'curve support 1 | 1.5 4.5 - | - - - | - - - | - - - - null' "$(sed -n 65p got)"

# ---- guesses ----
# Two pendulums on a beam at rest at their start: rods of 0.25 m from X - 0.3 m and X + 0.3 m, not one bent rod.
cat >clocks.lag <<'END'
model clocks "Two pendulum clocks on one beam"
coord X [m], a [rad] periodic, b [rad] periodic
param M = 5 [kg] > 0, m = 0.5 [kg] > 0, l = 0.25 [m] > 0, g = 9.81 [m/s^2] > 0
let x1 = X - 0.3 [m] + l*sin(a), y1 = -l*cos(a)
let x2 = X + 0.3 [m] + l*sin(b), y2 = -l*cos(b)
kinetic = M/2*X'^2 + m/2*(x1'^2 + y1'^2 + x2'^2 + y2'^2)
potential = m*g*(y1 + y2)
scene s { start X = 0.1, a = 90 [deg]; span 1e-9 [s] }
END
is "each hangs on the sum that it adds to, and both on the beam" 'rod link 0 | -0.2 0 - | 0.05 0 - | - - - | - - - - null;rod link 0 | 0.4 0 - | 0.4 -0.25 - | - - - | - - - - null;rod support 0 | -0.2 0 - | 0.4 0 - | - - - | - - - - null' \
  "$(shapes clocks.lag | grep '^rod' | paste -s -d';' -)"
# A distance in a constraint, one in a spring, a floor under a ball with its radius, a slope, a rotation.
cat >links.lag <<'END'
model links "Joints of all kinds"
coord p: vec2 [m], q: vec2 [m], R: rotation, c: vec3 [m]
param m = 1 [kg] > 0, l = 1 [m] > 0, k = 1 [N/m] > 0, r = 0.2 [m] > 0, I = 1 [kg*m^2] > 0
let w = omega(R)
kinetic = m/2*(dot(p', p') + dot(q', q') + dot(c', c')) + I/2*dot(w, w)
potential = k/2*(norm(q - p) - l)^2
constraint rod: hypot(p.x - 3 [m], p.y) = l
contact floor: q.y >= r, restitution = 1
contact slope: 0.6*q.x + 0.8*q.y + 1 [m] >= 0, restitution = 1
scene s { start p = (3, 1), q = (1, 1), c = (0, 0, 5); span 1e-9 [s] }
END
cat >expected <<'END'
ground support 0 | 0 0 - | - - - | - - - | 0 - - - null
ground support 0 | -0.6 -0.8 - | - - - | - - - | -0.6435 - - - null
rod link 0 | 3 0 - | 3 1 - | - - - | - - - - null
spring spring 0 | 1 1 - | 3 1 - | - - - | - - - - null
body body 0 | 0 0 5 | - - - | - - - | 1 0 0 0 "c"
ball body 0 | 3 1 - | - - - | - - - | - - - - "p"
ball body 0 | 1 1 - | - - - | 0.2 - - | - - - - "q"
END
is "constraints, springs, contacts, rotations" "$(cat expected)" "$(shapes links.lag)"
cat >spring.lag <<'END'
model two "Two masses on a spring, in a line"
coord x1 [m], x2 [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0, l = 1 [m] > 0
kinetic = m/2*(x1'^2 + x2'^2)
potential = k/2*(x2 - x1 - l)^2
scene s { start x2 = 1; span 1e-9 [s] }
END
is "a spring in a line" 'spring | 0 0 - | 1 0 - ' "$(shapes spring.lag | sed -n 's/^\(spring\) spring 0\( | [^|]*| [^|]*\).*/\1\2/p')"
sed 's/^potential.*/potential = k\/2*(x1 - l)^2 + k\/2*(x2 - x1 - l)^2 + k\/2*(3*l - x2 - l)^2/' spring.lag >walls.lag
is "between walls" ' | - - - | 0 0 - ; | 0 0 - | 1 0 - ; | 1 0 - | - - - ' "$(shapes walls.lag | sed -n 's/^spring spring 0\( | [^|]*| [^|]*\).*/\1/p' | paste -s -d';' -)"
cat >polar.lag <<'END'
model polar "A planet by distance and angle: no spring holds it"
coord r, phi
lagrangian = (r'^2 + r^2*phi'^2)/2 + 1/r
let x = r*cos(phi), y = r*sin(phi)
scene s { start r = 1, phi' = 1; span 1e-9 }
END
is "a distance that no spring holds has no link" 'ball body 0 | 1 0 - | - - - | - - - | - - - - "(x, y)"' "$(shapes polar.lag)"
printf '%s\n' 'model bead; coord r [m], phi [rad]' "kinetic = 1 [kg]/2*(r'^2 + r^2*phi'^2)" 'scene s { start r = 2, phi = 30 [deg]; span 1e-9 [s] }' >bead.lag
is "polar coordinates" 'ball body 0 | 1.732 1 - | - - - | - - - | - - - - "(r, phi)"' "$(shapes bead.lag)"
printf '%s\n' 'model wheels; coord a [rad], b [rad]' "kinetic = 1 [kg*m^2]/2*(a'^2 + b'^2)" 'scene s { start a = 0.5, b = 1; span 1e-9 [s] }' >wheels.lag
is "angles alone are wheels side by side" 'disc body 0 | 0 0 - | - - - | 1 - - | 0.5 - - - "a";disc body 0 | 2.5 0 - | - - - | 1 - - | 1 - - - "b"' "$(shapes wheels.lag | paste -s -d';' -)"

# ---- lagc plot --drawing ----
# Both rods of a double pendulum are as long in the picture as a metre of its axes; positions are written to 0.1 pixels.
picture() { "$LAGC" plot "$1" --drawing "$2" --quiet -o drawing.svg >out 2>err || cat err; }
rods() { grep 'stroke="#777"' drawing.svg | sed 's/.* d="M//; s/".*//; s/L/ /' | awk '{ print sqrt(($3 - $1)^2 + ($4 - $2)^2) }'; }
metre() { # pixels between the labels 0 and -1 of y
  sed -n 's/^<text x="[0-9.]*" y="\([0-9.]*\)" text-anchor="end">\(0\|-1\)<.*/\2 \1/p' drawing.svg | sort -n | awk '{ y[NR] = $2 } END { print y[1] - y[2] }'
}
picture "$OLDPWD/models/double_pendulum.lag" 3
is "two balls at three times" 6 "$(grep -c '<circle' drawing.svg)"
check "rods have their length" sh -c 'echo "$1" | awk -v m="$2" "{ d = \$1 - m; n++; if (d > 0.3 || d < -0.3) exit 1 } END { exit n != 6 }"' - "$(rods)" "$(metre)"
check "well-formed" sh -c 'head -n 1 drawing.svg | grep -q "^<svg " && tail -n 1 drawing.svg | grep -qx "</svg>" && ! grep -q "<[^>]*<" drawing.svg'
# Shapes in the plane, first and last points of their lines, from pixels back to metres by the labels 0 and 1 of both axes; damper: 0.35 and 0.55 of its length.
cat >flat.lag <<'END'
model flat; coord x [m], th [rad]
kinetic = 1 [kg]/2*x'^2 + 1 [kg*m^2]/2*th'^2
draw ground at -2
draw wall from (0, -1) to (4, -1)
draw damper from (0, 0) to (4, 0)
draw disc at (1, 2) radius 0.5 turn th spokes 2
draw box at (3, 2) size (1, 0.5) turn 90 [deg]
draw path of (x, 1 [m])
draw curve y = 3 [m] + 0*x for x in 2..4 [m]
draw arrow (1 [kg]*x', 2 [kg]*x') at (2 [m], 1 [m]) scale 1 [s/kg]
scene s { start x' = 1; span 1 }
END
lines() {
  awk -F '"' '/^<text .*>[01]<.text>$/ { n = substr($0, index($0, ">") + 1, 1); if (/middle/) px[n] = $2; else py[n] = $4 - 5 } # text stands 5 pixels lower
    / stroke-width="0.5"/ || !/^<path/ || /class/ { next }
    { sub(/.* d="[ML]/, ""); sub(/Z?".*/, ""); n = split($0, at, /[L ]/); print metres(at[1], at[2]) " to " metres(at[n - 1], at[n]) }
    function metres(x, y) { return sprintf("%.2f %.2f", (x - px[0])/(px[1] - px[0]) + 1e-6, (y - py[0])/(py[1] - py[0]) + 1e-6) }' drawing.svg
}
picture flat.lag 1
lines >got
while read -r name line; do check "$name: $line" grep -qxF -e "$line" got; done <<'END'
wall 0.00 -1.00 to 4.00 -1.00
damper 0.00 0.00 to 1.40 0.00
rod 2.20 0.00 to 4.00 0.00
spoke 1.00 2.00 to 1.50 2.00
spoke 1.00 2.00 to 0.50 2.00
box 3.25 1.50 to 2.75 1.50
path 0.00 1.00 to 1.00 1.00
curve 2.00 3.00 to 4.00 3.00
END
check "the ground" grep -q '^-[0-9.]* -2.00 to [0-9.]* -2.00$' got
check "an arrow's tip begins its head" grep -q '^3.00 3.00 to ' got
picture links.lag 1
is "in space: a box of three faces, each on a white one" 6 "$(grep -c 'fill="#fff" fill-opacity\|fill="#0072b2" fill-opacity' drawing.svg)"

# ---- mistakes ----
says() {
  want=$1 words=$2
  shift 2
  "$LAGC" "$@" >out 2>err
  [ "$?" = "$want" ] && grep -qF -e "$words" err || { cat err; false; }
}
printf 'model m\ncoord x [m]\nlagrangian = x%s^2\ndraw ball at (x, 2 [s])\n' "'" >bad.lag
check "units that do not match, before a run" says 1 'bad.lag:4:18: error: units do not match' animate bad.lag
check "lagc check says so, too" says 1 'bad.lag:4:18: error: units do not match' check bad.lag
check "no instant" says 2 "from 1 to 100" plot all.lag --drawing 0
check "two pictures in one" says 2 "a picture of its own" plot all.lag --drawing 2 --y x
check "--from without points" says 2 "needs --points" animate all.lag --from '0,0'
tap_end
