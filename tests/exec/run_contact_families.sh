#!/bin/sh
# Families of contacts (one text for all members, followed by moreau): closed forms of impacts and rolling, the motion of
# single contacts, lists of neighbours against all pairs, a text that does not grow with N, saved states, refusals.
. tests/exec/lib_motion.sh

# ---- balls on a line: of masses m and 3 m, with restitution e, velocities after one impact (Newton's law)
model line <<'END_OF'
model line
const N = 3
coord r[N]: vec2
param m[N] = 1 > 0, e = 0.6
lagrangian = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))
contact hit[i in 1..N, j in near(i, 1)]: norm(r[i] - r[j]) >= 1, restitution = e
scene s { m[2] = 3; start r[i in 1..N] = (1.5*i, 0), r[3].y = 9, r[1].x' = 1; span 1; method moreau(step = 0.01); output r[1].x', r[2].x', r[3].x' }
END_OF
check "two balls meet" run line
check "the first goes on with (1 - 3 e)/4" close_to "$(final "r\[1\].x'")" -0.2 1e-14 # a few roundings
check "the second with (1 + e)/4" close_to "$(final "r\[2\].x'")" 0.4 1e-14
check "the third is not met" close_to "$(final "r\[3\].x'")" 0 0

# ---- static friction: blocks pulled by i newtons on rough ground, mu_s m g = 6.5 N, mu m g = 3 N; those that rest or come to rest stay up to 6 N, others slide by i - 3
model rows <<'END_OF'
model rows
const N = 12
coord r[N]: vec2
param m = 1 > 0, g = 10, mu = 0.3 >= 0, mu_s = 0.65 >= 0
kinetic = sum(i in 1..N, m/2*dot(r[i]', r[i]'))
potential = sum(i in 1..N, m*g*r[i].y)
for i in 1..N { force r[i].x = i }
contact floor[i in 1..N]: r[i].y >= 0, restitution = 0, friction = mu, static = mu_s, slip = r[i].x'
scene s { span 1; method moreau(step = 0.01); output r }
scene slides { like s; start r[i in 1..N].x' = 0.1*i }
END_OF
check "blocks are pulled" run rows
for i in 1 6; do check "block $i stays" close_to "$(final "r\[$i\].x")" 0 1e-16; done
for i in 7 12; do check "block $i slides" close_to "$(final "r\[$i\].x")" "$(awk "BEGIN { print ($i - 3)/2 }")" 1e-12; done
check "blocks slide" run rows slides
check "the second stops, and stays" close_to "$(final "r\[2\].x")" 0.02 1e-12 # 0.2^2/2, by 1
check "the fourth goes on" close_to "$(final "r\[4\].x")" 0.9 1e-12          # 0.4 + 1/2
check "a static friction below friction" model_refused 'the static limit minus the friction' run rows mu_s=0.2

# ---- discs that slide on a floor until they roll: x' = 2 v/3 for a disc, whatever the friction
model roll <<'END_OF'
model roll
const N = 3
coord x[N], y[N], th[N] [rad]
param R = 0.1 > 0, g = 9.81, mu[N] = {0.1, 0.3, 0.5} >= 0
lagrangian = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2 + R^2/4*th[i]'^2 - g*y[i])
contact floor[i in 1..N]: y[i] >= R, restitution = 0, friction = mu[i], slip = x[i]' + R*th[i]'
scene s { start y = R, x[i in 1..N]' = 1; span 1; method moreau(step = 0.01); output x', th' }
END_OF
check "discs slide and roll" run roll
for i in 1 2 3; do
  check "disc $i rolls with two thirds of its speed" close_to "$(final "x\[$i\]'")" 0.66666666666666667 1e-12 # 64 roundings of the step
done
sed 's/^scene s {/effect drag { force x[1] = -3*x[1]'"'"' }\n&/; $a scene d { like s; use drag }' "$TMP/roll.lag" >"$TMP/drags.lag"
effects() { "$LAGC" effects "$TMP/drags.lag" d >"$TMP/log" 2>&1; cat "$TMP/log"; grep -q 'drag *on.* needed' "$TMP/log"; }
check "effects beside a family are compared" effects
sed 's/moreau(step = 0.01)/moreau/' "$TMP/roll.lag" >"$TMP/stepless.lag"
equal() { "$LAGC" run "$TMP/stepless.lag" >"$TMP/log" 2>&1; cat "$TMP/log"; grep -q '^steps 10000, rejected 0,' "$TMP/log"; }
check "without a step they are equal ones, 10000 of the span" equal

# ---- a pile: its families against single contacts, which constraints make
pile() { # NAME RANGE: discs of different sizes with friction
  model "$1" <<END_OF
model pile
const N = 6
coord r[N]: vec2, th[N] [rad]
param mu = 0.3, R[N] = {0.05, 0.06, 0.07, 0.05, 0.06, 0.07} > 0
let s[i in 1..N] = r[i] - (0, 0.1)
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2 + R[i]^2/4*th[i]'^2 - 9.81*r[i].y)
$2 hypot(s[i].x - s[j].x, s[i].y - s[j].y) >= R[i] + R[j], restitution = 0.3, friction = mu,
  slip = ((r[i].x - r[j].x)*(r[i].y' - r[j].y') - (r[i].y - r[j].y)*(r[i].x' - r[j].x'))
         /hypot(r[i].x - r[j].x, r[i].y - r[j].y) - R[i]*th[i]' - R[j]*th[j]' $3
$4 r[i].y >= R[i], restitution = 0.3, friction = mu, slip = r[i].x' + R[i]*th[i]' $5
$6 r[i].x >= R[i], restitution = 0.3 $5
scene s { start r[i in 1..N] = (0.1 + 0.16*(i - 2*floor(i/2)) + 0.01*i, 0.1 + 0.15*floor(i/2)); span 0.5; method moreau(step = 0.002); output r, th }
END_OF
}
pile near 'contact hit[i in 1..N, j in near(i, 0.14)]:' '' 'contact floor[i in 1..N]:' '' 'contact wall[i in 1..N]:'
pile pairs 'contact hit[i in 1..N, j in 1..i-1]:' '' 'contact floor[i in 1..N]:' '' 'contact wall[i in 1..N]:'
pile single 'for i in 1..N { for j in 1..i-1 { contact hit[i,j]:' '} }' 'for i in 1..N { contact floor[i]:' '}' 'for i in 1..N { contact wall[i]:'
rows() { run "$1" && cp "$TMP/csv" "$TMP/$1.csv"; }
for name in near pairs single; do check "a pile, $name" rows "$name"; done
check "it has impacts" test "$(number impacts)" -gt 10
check "lists of neighbours change no bit" cmp "$TMP/near.csv" "$TMP/pairs.csv"
# rounding, 1e-16, times the growth of differences: 40 impacts, each by a few
same_as() { paste -d, "$TMP/near.csv" "$TMP/$1.csv" | awk -F, 'NR > 1 { for (k = 1; k <= NF/2; k++) if (($k - $(k + NF/2))^2 > 1e-16) exit 1 }'; }
check "single contacts move alike" same_as single
evaluated() { "$LAGC" run "$TMP/near.lag" --compile "$1" -o "$TMP/$1.csv" >"$TMP/log" 2>&1; }
for how in never always; do check "a run, compiled: $how" evaluated "$how"; done
check "evaluated and compiled have the same digits" cmp "$TMP/never.csv" "$TMP/always.csv"
check "a program as bytes" "$LAGC" build "$TMP/near.lag" --bytes -o "$TMP/near.bytes"
check "a run" run near
whole=$(final 'r\[3\].x')
check "a run that is cut" run near --until 0.25 --save-state "$TMP/state"
check "goes on" run near --resume "$TMP/state"
check "with the same digits" test "$(final 'r\[3\].x')" = "$whole"

# ---- a column of 250 bodies: each step gives the floor 250 m g h through all contacts
model column <<'END_OF'
model column
const N = 250
coord y[N]
lagrangian = sum(i in 1..N, y[i]'^2/2 - 9.81*y[i])
contact pile[i in 2..N]: y[i] - y[i-1] >= 1, restitution = 0
contact floor[i in 1..1]: y[i] >= 1, restitution = 0
scene s { start y[i in 1..N] = i; span 0.2; method moreau(step = 0.001); output y[250] }
END_OF
check "a column stands" run column
check "its top does not sink" close_to "$(final 'y\[250\]')" 250 1e-3 # one step's fall is 1e-5: less than 100 of 200 go on
check "by some 7500 sweeps: without momentum they are 250000" test "$(number iterations)" -lt 20000

# ---- a drum that turns: families and single contacts part as starts do that differ by some roundings, which impacts multiply
drum() { # NAME HIT END WALL END
  model "$1" <<END_OF
model drum
const N = 6
coord r[N]: vec2, th[N] [rad]
param mu = 0.3, R = 0.1, D = 0.5, w = 2, eps = 0
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2 + R^2/4*th[i]'^2 - 9.81*r[i].y)
$2 norm(r[i] - r[j]) >= 2*R, restitution = 0.3, friction = mu,
  slip = ((r[i].x - r[j].x)*(r[i].y' - r[j].y') - (r[i].y - r[j].y)*(r[i].x' - r[j].x'))/norm(r[i] - r[j]) - R*(th[i]' + th[j]') $3
$4 D - norm(r[i]) >= R, restitution = 0.3, friction = mu, slip = (r[i].x*r[i].y' - r[i].y*r[i].x')/norm(r[i]) - w*D + R*th[i]' $5
scene s {
  start r[i in 1..N] = (-0.28 + 0.225*(i - 1 - 3*floor((i - 1)/3)) + 0.003*i, -0.15 + 0.23*floor((i - 1)/3)), r[1].x' = eps
  span 4; method moreau(step = 0.001); output r every 0.1
}
END_OF
}
drum drum 'contact hit[i in 1..N, j in 1..i-1]:' '' 'contact wall[i in 1..N]:' ''
drum drum_single 'for i in 1..N { for j in 1..i-1 { contact hit[i,j]:' '} }' 'for i in 1..N { for k in 1..1 { contact wall[i]:' '} }'
apart() { # A B: the largest difference so far, row by row
  paste -d, "$TMP/$1.csv" "$TMP/$2.csv" |
    awk -F, 'NR > 1 { for (k = 2; k <= NF/2; k++) { d = $k - $(k + NF/2); if (d < 0) d = -d; if (d > most) most = d } print most + 0 }'
}
for name in drum drum_single; do check "a $name" rows $name; done
check "all six touch" test "$(number at_once)" -ge 10
check "a start that differs by 1e-14" run drum eps=1e-14
cp "$TMP/csv" "$TMP/drum_eps.csv"
apart drum drum_eps >"$TMP/chaos"
# a step rounds at other places by as much as the start's difference has grown from; 10: of some steps together
as_chaos() { apart drum drum_single | paste "$TMP/chaos" - | awk 'NR > 3 && !($2 <= 10*$1) { print; exit 1 } END { exit NR < 40 }'; }
check "single contacts part no faster" as_chaos
check "which is chaos" awk 'NR == 5 { early = $1 } END { exit !(early < 1e-10 && $1 > 1e6*early) }' "$TMP/chaos"

# ---- a pile in a box on wheels, on a spring balance
model scale <<'END_OF'
model scale
const N = 150, K = 10
coord r[N]: vec2, th[N] [rad], X, Y
param R = 0.05 > 0, mu = 0.3 >= 0, M = 20 > 0, k = 1e5, c = 2000, g = 9.81
let a = 0.12
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2 + R^2/4*th[i]'^2 - g*r[i].y) + M/2*(X'^2 + Y'^2) - M*g*Y - k/2*Y^2
force Y = -c*Y'
contact hit[i in 1..N, j in near(i, 2*R)]: norm(r[i] - r[j]) >= 2*R, restitution = 0, friction = mu,
  slip = ((r[i].x - r[j].x)*(r[i].y' - r[j].y') - (r[i].y - r[j].y)*(r[i].x' - r[j].x'))/norm(r[i] - r[j]) - R*(th[i]' + th[j]')
contact floor[i in 1..N]: r[i].y - Y >= R, restitution = 0, friction = mu, slip = r[i].x' - X' + R*th[i]'
contact left[i in 1..N]: r[i].x - X >= R, restitution = 0
contact right[i in 1..N]: X + K*a - r[i].x >= R, restitution = 0
scene s {
  start r[i in 1..N] = (a/2 + a*(i - 1 - K*floor((i - 1)/K)) + R/10*sin(i), a/2 + a*floor((i - 1)/K)), r[i in 1..N].x' = 0.3, Y = -20*9.81/1e5
  span 2; method moreau(step = 1e-3); output r.x', X', Y, energy every 0.01
}
END_OF
check "discs fall into a box" run scale
check "more of them at once than impulses are found to rounding for" test "$(number at_once)" -gt 200
check "the balance shows 150 discs and the box" close_to "$(awk -F, 'END { print -$(NF - 1)*1e5/9.81 }' "$TMP/csv")" 170 0.03 # it swings by 1 at 1.2 s, and drag takes c/340 = 5.9/s
momentum() { awk -F, 'NR > 1 { P = 20*$(NF - 2); for (k = 2; k <= 151; k++) P += $k; if ((P - 45)^2 > 1e-22) exit 1 } END { exit NR < 200 }' "$TMP/csv"; }
check "momentum is kept to rounding, 2000 steps of 1e-15 of 45" momentum
falls() { awk -F, 'NR > 2 && $NF - was > 1e-8*1331 { print; exit 1 } { was = $NF } END { exit NR < 200 }' "$TMP/csv"; }
check "the energy never rises, but for what impulses lack, 3e-3 squared, of few contacts" falls
# half a step at the speed of a fall of 1.8
check "no gap is deeper" awk -v depth="$(number deepest)" 'BEGIN { exit !(depth > 0 && depth < sqrt(2*9.81*1.8)*1e-3/2) }'

# ---- the text does not grow
member() { sed -n '/^static int family_0(/,/^}/p' "$1"; }
sed 's/{0.05, 0.06, 0.07, 0.05, 0.06, 0.07}/0.05/' "$TMP/near.lag" >"$TMP/many.lag"
for n in 6 1000; do check "$n discs" "$LAGC" emit "$TMP/many.lag" -D N=$n -o "$TMP/$n.c"; done
check "contacts of 1000 discs have the text of six" test "$(member "$TMP/6.c")" = "$(member "$TMP/1000.c")"
check "and it is some" test "$(member "$TMP/6.c" | wc -l)" -gt 20

# ---- parameters as numbers, but for those that a loop reads
fixed() { run near --fix all 2>&1; cp "$TMP/csv" "$TMP/fixed.csv"; grep -q 'note: --fix all leaves `R` a parameter' "$TMP/err"; }
check "all parameters as numbers" fixed
check "with the motion of parameters" same_as fixed
check "a radius as a number" model_refused '`R\[[0-9]\]` of a family of contacts as a number is not supported' emit near --fix R

# ---- refusals
edit() { sed "$2" "$TMP/near.lag" >"$TMP/$1.lag"; }
edit over 's/0.1 + 0.15\*floor/0.1 + 0.05*floor/'
check "bodies that overlap at the start" model_refused 'hit\[[0-9], [0-9]\] is closed by .* at the start' run over
edit beyond 's/^contact wall.*/contact wall[i in 1..N]: r[i+1].x >= 0, restitution = 0/'
check "an index out of range" model_refused 'this index reaches 7, and the members are `r\[1..6\]`' check beyond
edit number 's/^contact wall.*/contact wall[i in 1..N]: r[i].x + i >= 0, restitution = 0/'
check "an index as a number" model_refused 'an index is a number here' check number
edit first 's/near(i, 0.14)/near(k, 0.14)/'
check "near of another index" model_refused '`near` takes the first index' check first
edit moves 's/near(i, 0.14)/near(i, r[1].x)/'
check "a cut-off that moves" model_refused 'the cut-off and the box of `near` move' check moves
edit dop853 's/moreau(step = 0.002)/dop853/'
check "another method" model_refused 'does not follow the family of contacts `hit`' check dop853
check "another method of the command line" model_refused 'does not follow the family of contacts hit' run near --method dop853
check "a header" model_refused '= `lagc build --shared` makes a library' header near
check "modes" model_refused 'families of contacts in `lagc modes` are not supported' modes near
tap_end
