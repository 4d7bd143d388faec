#!/bin/sh
# Families of contacts beside constraints, single contacts and guides, in one problem of moreau: closed forms, momentum,
# the motion of models with every contact written out, saved states, a pile on a pendulum.
. tests/exec/lib_motion.sh

# ---- a ball of mass m0 meets one of two masses m on a rod, whose direction makes an angle f with the line of impact: the impulse is
# (1 + e) v/(1/m0 + R), R = sin(f)^2/m + cos(f)^2/(2 m), and rod and balls have momentum
model rod <<'END_OF'
model rod
const N = 3
coord r[N]: vec2
param m[N] = {2, 1, 1} > 0, e = 0.6, f = 0, mu = 0
lagrangian = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))
constraint rod: norm(r[2] - r[3]) = 5
contact hit[i in 1..N, j in 1..i-1]: norm(r[i] - r[j]) >= 1, restitution = e
scene s { start r[1] = (-1.5, 0), r[1].x' = 1, r[3] = (5*cos(f), 5*sin(f)); span 1; method moreau(step = 0.01); output r.x', r.y' }
END_OF
for of in 0:1e-13 0.5:2e-4 1.5707963267948966:1e-13; do # a few roundings; within the step of an impact the rod begins to turn, 0.01*v^2/5
  f=${of%:*}
  check "a ball meets a dumbbell at $f" run rod f=$f
  P="1.6/(0.5 + sin($f)^2 + cos($f)^2/2)"
  check "it keeps 1 - P/m0" close_to "$(final "r\[1\].x'")" "$(calc "1 - $P/2")" "${of#*:}"
  # behind the impact the rod turns: momentum, and its mean along x
  check "momentum is kept" close_to "$(calc "2*$(final "r\[1\].x'") + $(final "r\[2\].x'") + $(final "r\[3\].x'")")" 2 1e-13
  check "across, too" close_to "$(calc "$(final "r\[2\].y'") + $(final "r\[3\].y'")")" 0 1e-13
done

# ---- weights on a rope over a pulley, the left one with a load: constant accelerations, which a step meets
model atwood <<'END_OF'
model atwood
const N = 2
coord y[N], z
param g = 10, mu = 0.3
lagrangian = sum(i in 1..N, y[i]'^2/2 - g*y[i]) + 1.5*(z'^2/2 - g*z)
constraint rope: y[1] + z = 0
contact load[i in 2..N]: y[i] - y[i-1] >= 1, restitution = 0
scene s { start y[2] = 1; span 1; method moreau(step = 0.01); output y, z }
END_OF
check "a rope with a load" run atwood
check "(2 - 1.5)/3.5 of g" close_to "$(final z)" "$(calc "10*0.5/3.5/2")" 1e-12
check "the load is carried" close_to "$(calc "$(final 'y\[2\]') - $(final 'y\[1\]')")" 1 1e-12

# ---- blocks on a table, each with a weight on a rope over its edge: (M - mu)/(1 + M) of g, or rest
model table <<'END_OF'
model table
const N = 3
coord r[N]: vec2, w[N]
param g = 10, mu = 0.5 >= 0, M[N] = {0.4, 0.75, 1.5} > 0
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2 - g*r[i].y + M[i]*(w[i]'^2/2 - g*w[i]))
for i in 1..N { constraint rope[i]: r[i].x + w[i] = 0 }
contact top[i in 1..N]: r[i].y >= 0, restitution = 0, friction = mu, slip = r[i].x'
scene s { span 1; method moreau(step = 0.01); output w }
END_OF
check "weights pull blocks" run table
check "friction holds the first" close_to "$(final 'w\[1\]')" 0 1e-15
check "the second slides" close_to "$(final 'w\[2\]')" "$(calc "-5*0.25/1.75")" 1e-12
check "the third, faster" close_to "$(final 'w\[3\]')" "$(calc "-5*1/2.5")" 1e-12
check "friction has its work, 0.5*10 of the paths" close_to "$(number dry_friction)" "$(calc "-5*(5*0.25/1.75 + 2)")" 1e-11 # with the last step's, 0.01*5*v

# ---- a slider on a guide with friction 0.2, pressed by three blocks that lie on it with friction 0.1: 0.2*(1 + 3) + 0.1*3 of g until it stops
model guide <<'END_OF'
model guide
const N = 3
coord x, y, b[N], u, w
param g = 10
lagrangian = (x'^2 + y'^2 + u'^2 + w'^2)/2 - g*y + sum(i in 1..N, b[i]'^2/2 - g*b[i])
guide other: u = 0, friction = 0.3, slip = w'
guide rail: y = 0, friction = 0.2, slip = x'
contact on[i in 1..N]: b[i] - y >= 0, restitution = 0, friction = 0.1, slip = x'
scene s { start x' = 4.4; span 1; method moreau(step = 0.01); output x every 0.25 }
END_OF
check "a slider with blocks" run guide
check "slides" close_to "$(cell 0.25 2)" 0.75625 1e-10 # 4.4 t - 5.5 t^2
check "and stops" close_to "$(final x)" 0.88 1e-10

# ---- a single contact by its name, a floor with friction, under a column of a family
model floor <<'END_OF'
model floor
const N = 5
coord y[N], x
param mu = 0.3
lagrangian = sum(i in 1..N, y[i]'^2/2 - 10*y[i]) + x'^2/2
force x = 12
contact pile[i in 2..N]: y[i] - y[i-1] >= 1, restitution = 0
contact ground: y[1] >= 1, restitution = 0, friction = mu, slip = x'
scene s { start y[i in 1..N] = i; span 1; method moreau(step = 0.01); output y, x }
END_OF
check "a column on a ground" run floor
check "stands" close_to "$(final 'y\[5\]')" 5 1e-12
check "friction by its whole weight, 0.3*50, holds" close_to "$(final x)" 0 1e-15
check "less does not" run floor mu=0.2
check "the rest moves it" close_to "$(final x)" 1 1e-12 # (12 - 0.2*50)/2

# ---- a cart drawn by a spring breaks loose from static friction with its load, which friction holds on it or lets slide
model cart <<'END_OF'
model cart
const N = 2
coord x, b[N], y[N]
param g = 10, k = 200, M = 3, m = 5, mu = 0.4, D = 1.4, S = 2.1
lagrangian = M/2*x'^2 - k/2*(x - t)^2 + sum(i in 1..N, m/2*(b[i]'^2 + y[i]'^2) - m*g*y[i])
friction wheel on x: D, static = S
contact bed[i in 1..N]: y[i] >= 0, restitution = 0, friction = mu, slip = b[i]' - x'
scene s { span 1; method moreau(step = 0.001); output x, b }
END_OF
# from S/k on W u'' = -k u, u = x - t + D/k, which pulls with weight W; the step is of order 2, (h w)^2 = 7e-5 with w^2 = k/M
gone() { calc "$1 - $D/200 + ($D - 2.1)/200*cos((w = sqrt(200/$W))*($1 - 2.1/200)) - sin(w*($1 - 2.1/200))/w"; }
check "a cart with a load" run cart
D=1.4 W=13
check "breaks loose" close_to "$(final x)" "$(gone 1)" 7e-5
check "the load stays on it" close_to "$(final 'b\[2\]')" "$(final x)" 1e-12
check "a light load" run cart m=0.5 mu=0.01 --until 0.7
D=1.5 W=3 # 1.4, and 0.01*10 of the load
check "lets the cart go" close_to "$(final x)" "$(gone 0.7)" 7e-5
check "slides" close_to "$(final 'b\[1\]')" "$(calc "0.01*10*(0.7 - 2.1/200)^2/2")" 7e-5

# ---- impulses of families are no work of forces: drag, z' = exp(-t), and balls that come to rest
model work <<'END_OF'
model work
const N = 2
coord y[N], z
lagrangian = sum(i in 1..N, y[i]'^2/2 - 10*y[i]) + z'^2/2
force z = -z'
contact floor[i in 1..N]: y[i] >= 0, restitution = 0.1
scene s { start y[i in 1..N] = i, z' = 1; span 2; method moreau(step = 0.001); output y }
END_OF
tells() { # tells WORDS COMMAND [MODEL]: its output for the model has these words
  "$LAGC" "$2" "$TMP/${3:-work}.lag" >"$TMP/log" 2>&1 && grep -q -e "$1" "$TMP/log" || { cat "$TMP/log"; return 1; }
}
check "the work is that of drag, (exp(-4) - 1)/2" tells '^energy balance: .*work of forces and explicit time: -0.490842;' run
check "the rest is that of impacts, 30 to the depth at the end" tells '^impacts and events: -30.00[0-9]* of energy' run
check "L has no jumps" tells "energy changes: dE/dt = -z'^2" check
sed '/force z/d' "$TMP/work.lag" >"$TMP/free.lag"
check "conserved, but for contacts" tells 'energy is conserved while contacts of families are open' check free
check "derive says when its equations hold" tells 'equations of motion while contacts of families are open' derive
check "no step is small enough for impacts" model_refused 'near them; compare runs with half the step' run work --accuracy 1e-6
check "noether names impacts" tells 'impacts and contacts change charges' noether

# ---- a pile with a double pendulum, rods and walls: its families against single contacts
pile() { # NAME HIT END FLOOR BOB COUPLING
  model "$1" <<END
model pile
const N = 6
coord r[N]: vec2, th[N] [rad], a[2] [rad], w
param mu = 0.3, R[N] = {0.05, 0.06, 0.07, 0.05, 0.06, 0.07} > 0, L = 0.4, B[2] = 0.05
let h = (0.25 + L*sin(a[1]), 1.3 - L*cos(a[1]))
let c = h + L*(sin(a[2]), -cos(a[2]))
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2 + R[i]^2/4*th[i]'^2 - 9.81*r[i].y) + dot(c', c')/2 - 9.81*c.y + dot(h', h')/2
  + w'^2/2 - 50*(w - 0.7)^2 $6
constraint rod: dot(r[1] - r[4], r[1] - r[4]) = 0.1069
constraint string: r[6].x + r[6].y - w = 0.1
$2 norm(r[i] - r[j]) >= R[i] + R[j], restitution = 0.3, friction = mu,
  slip = ((r[i].x - r[j].x)*(r[i].y' - r[j].y') - (r[i].y - r[j].y)*(r[i].x' - r[j].x'))/norm(r[i] - r[j]) - R[i]*th[i]' - R[j]*th[j]' $3
$4 r[i].y >= R[i], restitution = 0.3, friction = mu, slip = r[i].x' + R[i]*th[i]' $3
$5 norm(r[i] - c) >= R[i] + B[2], restitution = 0.5 $3
contact wall: r[2].x >= R[2], restitution = 0.3, friction = mu, slip = r[2].y' - R[2]*th[2]'
contact right: 0.6 - c.x >= B[1], restitution = 0.3
scene s {
  start r[i in 1..N] = (0.1 + 0.16*(i - 2*floor(i/2)) + 0.01*i, 0.1 + 0.15*floor(i/2)), a[1] = 30 [deg], a[2] = -60 [deg], w = 0.61
  span 0.5; method moreau(step = 0.002); output r, th, a
}
END
}
families() { pile "$1" 'contact hit[i in 1..N, j in 1..i-1]:' '' 'contact floor[i in 1..N]:' 'contact bob[i in 1..N]:' "$2"; }
singles() {
  pile "$1" 'for i in 1..N { for j in 1..i-1 { contact hit[i,j]:' '} }' 'for i in 1..N { for k in 1..1 { contact floor[i]:' \
    'for i in 1..N { for k in 1..1 { contact bob[i]:' "$2"
}
families beside ''
singles single ''
families coupled "+ 0.1*r[1].x'*th[5]'"
singles coupled_single "+ 0.1*r[1].x'*th[5]'"
rows() { run "$1" && cp "$TMP/csv" "$TMP/$1.csv"; }
# rounding, 1e-16, times the growth of differences: 20 impacts, each by a few
same() { paste -d, "$TMP/$1.csv" "$TMP/$2.csv" | awk -F, 'NR > 1 { for (k = 1; k <= NF/2; k++) if (($k - $(k + NF/2))^2 > 1e-22) exit 1 } END { exit NR < 100 }'; }
for name in beside single coupled coupled_single; do check "a pile, $name" rows $name; done
check "it has impacts" test "$(number impacts)" -gt 10
check "single contacts move alike" same beside single
check "where M couples bodies, too" same coupled coupled_single

# ---- in space, with friction in two directions
balls() { # NAME HIT END FLOOR
  model "$1" <<END
model balls
const N = 5
coord r[N]: vec3, x, y
param mu = 0.3, R = 0.1 > 0
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2 - 9.81*r[i].z) + x'^2 + y'^2
constraint rod: norm(r[1] - r[2]) = 0.3
constraint tie: r[3].x - x = 0
$2 norm(r[i] - r[j]) >= 2*R, restitution = 0.2 $3
$4 r[i].z >= R, restitution = 0.2, friction = mu, slip = (r[i].x' - x', r[i].y' - y') $3
contact wall: r[4].x >= 0, restitution = 0.3, friction = mu, slip = (r[4].y', r[4].z')
scene s {
  start r = {(0, 0.01, 0.3), (0.3, 0.01, 0.3), (0, 0.03, 0.6), (0.3, 0.04, 0.75), (0, 0.05, 0.9)}, r[4].x' = -1, x' = 0.5, r[3].x' = 0.5
  span 1; method moreau(step = 0.002); output r, x, y
}
END
}
balls space 'contact hit[i in 1..N, j in 1..i-1]:' '' 'contact floor[i in 1..N]:'
balls space_single 'for i in 1..N { for j in 1..i-1 { contact hit[i,j]:' '} }' 'for i in 1..N { for k in 1..1 { contact floor[i]:'
for name in space space_single; do check "balls, $name" rows $name; done
check "they have impacts" test "$(number impacts)" -gt 10
check "single contacts in space move alike" same space space_single

evaluated() { "$LAGC" run "$TMP/coupled.lag" --compile "$1" -o "$TMP/$1.csv" >"$TMP/log" 2>&1; }
for how in never always; do check "a run, compiled: $how" evaluated "$how"; done
check "evaluated and compiled have the same digits" cmp "$TMP/never.csv" "$TMP/always.csv"
check "a run" run beside
whole=$(final 'r\[3\].x')
check "a run that is cut" run beside --until 0.25 --save-state "$TMP/state"
check "goes on" run beside --resume "$TMP/state"
check "with the same digits" test "$(final 'r\[3\].x')" = "$whole"

# ---- 200 discs in the air poured onto a pendulum in the box; two of them are joined
model pour <<'END_OF'
model pour
const N = 200, K = 8
coord r[N]: vec2 [m], th[N] [rad], a [rad]
param m = 1 [kg] > 0, g = 9.81 [m/s^2], M = 5 [kg] > 0, L = 0.6 [m] > 0, B = 0.1 [m] > 0
param R = 0.05 [m] > 0, W = 0.97 [m], mu = 0.3 >= 0, drag = 0.1 [N*s/m]
let s = 0.12 [m]
let c = (W/2 + L*sin(a), 1.2 [m] - L*cos(a))
kinetic = sum(i in 1..N, m/2*dot(r[i]', r[i]') + m*R^2/4*th[i]'^2) + M/2*dot(c', c')
potential = sum(i in 1..N, m*g*r[i].y) + M*g*c.y
for i in 1..N { force r[i].x = -drag*r[i].x' }
constraint rod: norm(r[1] - r[2]) = s
contact hit[i in 1..N, j in near(i, 2*R)]: norm(r[i] - r[j]) >= 2*R, restitution = 0.1, friction = mu,
  slip = ((r[i].x - r[j].x)*(r[i].y' - r[j].y') - (r[i].y - r[j].y)*(r[i].x' - r[j].x'))/norm(r[i] - r[j]) - R*(th[i]' + th[j]')
contact floor[i in 1..N]: r[i].y >= R, restitution = 0.1, friction = mu, slip = r[i].x' + R*th[i]'
contact left[i in 1..N]: r[i].x >= R, restitution = 0.1
contact right[i in 1..N]: W - r[i].x >= R, restitution = 0.1
contact bob[i in 1..N]: norm(r[i] - c) >= R + B, restitution = 0.1
contact wall: W - c.x >= B, restitution = 0.5
scene s {
  start r[i in 1..N] = (s/2 + s*(i - 1 - K*floor((i - 1)/K)), 1.5 [m] + s/2 + s*floor((i - 1)/K)), a = 10 [deg]
  span 0.65 [s]; method moreau(step = 1e-3); output r[1], r[2], a
}
END_OF
check "200 discs with drag, 190 at once in contact" run pour
check "are so many" test "$(number at_once)" -gt 150
joined() { calc "sqrt(($(final 'r\[1\].x') - $(final 'r\[2\].x'))^2 + ($(final 'r\[1\].y') - $(final 'r\[2\].y'))^2)"; }
check "the rod keeps its length" close_to "$(joined)" 0.12 1e-15

# ---- the manual's 20 discs: their impulses swing for ever by 1e-7 m/s, at 0.647 s, and forces with them, at 0.91 s
sed -n '/^model pour/,/^}/p' grammar/LANGUAGE.md >"$TMP/manual.lag"
check "discs that a pendulum presses" run manual --step 5e-4 --until 0.92

# ---- forces lack the impulses of families
sed 's/output r, th/output lambda(rod), th/' "$TMP/beside.lag" >"$TMP/force.lag"
check "a force" model_refused 'forces beside a family of contacts' run force
tap_end
