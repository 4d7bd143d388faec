#!/bin/sh
# Impacts of several contacts, and contacts that stay closed after them, against closed forms: no impulse and no force pulls.
. tests/tap.sh

model() { cat >"$TMP/$1.lag"; }
# rows go to out.csv, events to ev.csv: time, name, state before, state after
run() {
  name=$1
  shift
  rm -f "$TMP/out.csv" "$TMP/ev.csv"
  "$LAGC" run "$TMP/$name.lag" "$@" -o "$TMP/out.csv" --events "$TMP/ev.csv" >"$TMP/log" 2>"$TMP/err" || { cat "$TMP/log" "$TMP/err"; return 1; }
}
fails() { # fails STATUS WORDS MODEL ARGS...
  status=$1
  words=$2
  shift 2
  run "$@" >/dev/null
  [ $? != 0 ] && cat "$TMP/log" "$TMP/err" && grep -qF -e "$words" "$TMP/log" "$TMP/err"
}
near() { close_to "$@"; }
calc() { awk "BEGIN { printf \"%.17g\", $1 }"; }
cell() { awk -F, -v t="$1" -v c="$2" '$1 == t { print $c }' "$TMP/out.csv"; }         # TIME COLUMN
after() { awk -F, -v e="$1" -v c="$2" '$2 == e { x = $(NF - c) } END { print x }' "$TMP/ev.csv"; } # EVENT COLUMN-FROM-THE-END, of the last one
first() { awk -F, -v e="$1" -v c="$2" '$2 == e { print $(NF - c); exit }' "$TMP/ev.csv"; } # likewise, of the first one
count() { sed -n "s/^event $1: \\([0-9]*\\) time.*/\\1/p" "$TMP/log"; } # EVENT: how often

# ---- a plank on two supports, at -a and a; a ball falls on its end at 3a
model seesaw <<'END'
model seesaw "A ball falls on the end of a plank"
coord y [m], th [rad], b [m]
param M = 2 [kg] > 0, I = 1 [kg*m^2] > 0, m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, a = 1 [m] > 0
kinetic = M/2*y'^2 + I/2*th'^2 + m/2*b'^2
potential = g*(M*y + m*b)
contact left: y - a*th >= 0, restitution = 0
contact right: y + a*th >= 0, restitution = 0
contact ball: b - y - 3*a*th >= 0, restitution = 0
scene s { start b = 1 [m]; span 0.5 [s]; output y, th, b, lambda(left), lambda(right), lambda(ball) every 0.5 [s] }
END
for m in 1 10; do
  check "a ball of $m kg falls on a plank" run seesaw s m=$m
  # Momentum about the right support, which alone pushes: (I + M a^2 + 4 m a^2) th' = -2 a m v. The solution is exact to rounding, the time of
  # the impact to the tolerance, 1e-9.
  check "it turns about the right support" near "$(after ball 1)" "$(calc "-2*$m*sqrt(2*9.81)/(3 + 4*$m)")" 1e-8
  check "the left one does not hold it" near "$(count 'left opens')" 1 0
  check "nor later" near "$(cell 0.5 5)" 0 0
done

# ---- a block on two legs rocks from one to the other
model block <<'END'
model block "A block on two legs"
coord y [m], th [rad]
param M = 2 [kg] > 0, I = 3 [kg*m^2] > 0, g = 9.81 [m/s^2] > 0, a = 1 [m] > 0, e = 0
kinetic = M/2*y'^2 + I/2*th'^2
potential = M*g*y
contact left: y - a*th >= 0, restitution = e
contact right: y + a*th >= 0, restitution = e
scene tilted { start y = 0.1 [m], th = 0.1 [rad]; span 0.5 [s]; method dop853; tolerance 1e-12; output y, th, lambda(left), lambda(right) every 0.5 [s] }
scene flat { like tilted; start y = 1 [m], th = 0; e = 0.5 }
END
# Turning about the left leg with th', the right one strikes: the momentum about the right leg is (I - M a^2) th' before and, where the left
# leg leaves, (I + M a^2) th' after (G. Housner, Bull. Seismol. Soc. Am. 53 (1963) 403, for this block). The block falls through 0.1 rad:
# M g a th = (I + M a^2) th'^2/2.
check "a block rocks" run block tilted
check "it turns on about the other leg, slower" near "$(first right 0)" "$(calc '-sqrt(2*2*9.81*0.1/5)*(3 - 2)/5')" 1e-10
check "the first leg leaves" near "$(awk -F, '$2 == "right" { t = $1 } $2 == "left opens" { print $1 - t; exit }' "$TMP/ev.csv")" 0 0
# a fifth of the speed at each impact: flights of 2 v/(g_eff), which come to an end
check "it comes to rest on both legs" near "$(cell 0.5 4)" 9.81 1e-12
# With I < M a^2 the left leg would have to go down: both push, and all stops.
check "a block that does not rock" run block tilted I=1
check "stops dead" near "$(after right 0)" 0 1e-14
check "on both legs" near "$(cell 0.5 4)" 9.81 1e-12
check "a block falls flat" run block flat --until 0.6
check "both legs strike at once" near "$(after right 1)" "$(calc '0.5*sqrt(2*9.81)')" 1e-10
check "and it does not turn" near "$(after right 0)" 0 1e-13

# ---- balls in a row, without gravity, e = 1: the first strikes a row that rests
model cradle <<'END'
model cradle "A ball strikes a row"
const N = 4
coord x[N] [m]
param m[N] = {1, 1, 1, 1} [kg] > 0, e = 1
lagrangian = sum(i in 1..N, m[i]/2*x[i]'^2)
for i in 1..N-1 { contact c[i]: x[i+1] - x[i] >= 0.1 [m], restitution = e }
scene s { start x = {-0.1, 0.1, 0.2, 0.3}, x[1]' = 1 [m/s]; span 1 [s]; output x', energy every 0.5 [s] }
scene heavy { like s; m = {1, 2, 3, 4} }
END
# The row moves on as one body of mass m2 + m3 + m4: v1 = (m1 - m)/(m1 + m), V = 2 m1/(m1 + m); energy is conserved (Moreau).
check "a ball strikes a row of three" run cradle s
check "comes back with half its speed" near "$(cell 1 2)" -0.5 1e-14
check "the first of the row" near "$(cell 1 3)" 0.5 1e-14
check "and the last" near "$(cell 1 5)" 0.5 1e-14
check "energy is conserved" near "$(cell 1 6)" 0.5 1e-14
check "a row of unlike balls" run cradle heavy
check "which is nine times as heavy" near "$(cell 1 2)" -0.8 1e-14
check "moves on as one" near "$(cell 1 4)" 0.2 1e-14
check "with the energy that was there" near "$(cell 1 6)" 0.5 1e-14

# ---- two balls that lie on a shelf are hit from below
model shelf <<'END'
model shelf "A ball strikes two that lie on a shelf, from below"
coord y[3] [m]
param m[3] = {2, 1, 3} [kg] > 0, g = 9.81 [m/s^2] > 0, e = 0.5, h = 1 [m] > 0
lagrangian = sum(i in 1..3, m[i]*(y[i]'^2/2 - g*y[i]))
contact shelf: y[2] >= h, restitution = e
contact pair: y[3] - y[2] >= 0.1 [m], restitution = e
contact hit: y[2] - y[1] >= 0.1 [m], restitution = e
scene s { start y = {0, 1, 1.1}, y[1]' = 5 [m/s]; span 0.25 [s]; method dop853; tolerance 1e-12; output y, y' every 0.05 [s] }
END
slow check "a stack is hit from below" run shelf s
v=$(calc 'sqrt(25 - 2*9.81*0.9)')
# 1: v - V = -e v + ..., momentum m1 v = m1 v1 + (m2 + m3) V with V - v1 = e v
[ -z "${SLOW:-}" ] || check "both leave the shelf as one" near "$(after hit 1)" "$(calc "1.5*2*$v/6")" 1e-10
[ -z "${SLOW:-}" ] || check "the upper one with the lower" near "$(after hit 0)" "$(calc "1.5*2*$v/6")" 1e-10
[ -z "${SLOW:-}" ] || check "and the one below falls" near "$(after hit 2)" "$(calc "$v - 1.5*4*$v/6")" 1e-10
[ -z "${SLOW:-}" ] || check "the shelf lets go" near "$(count 'shelf opens')" 1 0

# ---- a load moves along a plank on three supports: two supports carry it where one of three would have to pull
model plank <<'END'
model plank "A load walks along a plank, and over its edge"
coord y [m], th [rad]
param M = 2 [kg] > 0, I = 1 [kg*m^2] > 0, F = 100 [N], g = 9.81 [m/s^2] > 0, a = 1 [m] > 0, x = -0.95 [m], u = 1 [m/s], e = 0.3
kinetic = M/2*y'^2 + I/2*th'^2
potential = M*g*y + F*(y + (x + u*t)*th)
contact left: y - a*th >= 0, restitution = e
contact middle: y >= 0, restitution = e
contact right: y + a*th >= 0, restitution = e
scene walk { span 2.2 [s]; method dop853; tolerance 1e-12; output y, th, lambda(left), lambda(middle), lambda(right) every 0.1 [s] }
END
check "a load walks along a plank" run plank walk
# at x = -0.85 the right support would have to pull, and carries nothing: (M g + F, -F x) = (l + c, l - r)
check "the left one carries" near "$(cell 0.10000000000000001 4)" 85 1e-10
check "the middle one the rest" near "$(cell 0.10000000000000001 5)" "$(calc '2*9.81 + 15')" 1e-10
# in the middle all three: the least ones, (M g + F)/3 - x F/2, ...
check "then all three, the least forces" near "$(cell 1.1000000000000001 4)" "$(calc '119.62/3 - 0.15*50')" 1e-10
# it tips where F (x + u t - a) = M g a
opens() { sed -n "s/^event $1 opens: .* \\([0-9][0-9.]*\\) s\$/\\1/p" "$TMP/log"; }
check "it tips over its edge" near "$(opens middle)" "$(calc '1.95 + 0.1962')" 1e-10
# th'' = -F u (t - t0)/(I + M a^2) from there
check "and turns about it" near "$(cell 2.2000000000000002 3)" "$(calc '-100*(2.2 - 2.1462)^3/18')" 1e-10
check "nothing chatters" near "$(awk 'END { print NR < 10 }' "$TMP/ev.csv")" 1 0

# ---- forces that jump, and loads that change in an event
model jump <<'END'
model jump "A mass on the floor is pulled by what an event sets"
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, k = 4 [N*s/m]
lagrangian = m/2*(x'^2 + y'^2) - m*g*y
force y = k*x'
contact floor: y >= 0, restitution = 0.5
event kick: t - 0.5 [s] rising { x' = 5 [m/s] }
scene s { span 1 [s]; output y, lambda(floor) every 0.5 [s] }
END
check "an event's force lifts what lies" run jump s
check "at once" near "$(cell 1 2)" "$(calc '(20 - 9.81)*0.25/2')" 1e-10

# ---- several contacts at one place, and contacts high above zero
model corner <<'END'
model corner "A ball falls into a corner, of which one side is there twice"
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, e = 0.5, h = 0 [m], w = 0 [m/s]
lagrangian = m/2*(x'^2 + y'^2) - m*g*y
contact a: y - x - h >= 0, restitution = e
contact b: y + x - h >= 0, restitution = e
contact twice: 2*(y + x - h) >= 0, restitution = e
contact floor: y - h >= 0, restitution = e
scene s { start y = 1 [m]; span 2 [s]; method dop853; output x, y, lambda(a), lambda(b), lambda(twice), lambda(floor) every 1 [s] }
END
check "four contacts are struck at once" run corner s
check "and lie still at 3 sqrt(2/g)" near "$(after floor 0)" 0 1e-12
# impacts end when a flight is 1e-7 of the time: remaining speeds are of that size
check "after a geometric series of flights" near "$(awk -F, '{ t = $1 } END { print t }' "$TMP/ev.csv")" "$(calc '3*sqrt(2/9.81)')" 1e-6
# m g = l_a + l_b + 2 l_t + l_f, l_a = l_b + 2 l_t, least: (1, 1, 1)/... by hand: rows (-1,1), (1,1), (2,2), (0,1); l = A mu, A^T l = (0, m g)
# where A^T A mu = (0, m g), A^T A = [6 4; 4 7]: mu = (-4, 6) m g/26
check "the least forces hold it: a" near "$(cell 2 4)" "$(calc '10*9.81/26')" 1e-12
check "b" near "$(cell 2 5)" "$(calc '2*9.81/26')" 1e-12
check "the same, twice" near "$(cell 2 6)" "$(calc '4*9.81/26')" 1e-12
check "the floor" near "$(cell 2 7)" "$(calc '6*9.81/26')" 1e-12
for case in "h=10 y=11 e=0.1" "h=100 y=101 e=0.1" "h=1e6 y=1000001 e=0.9" "h=0.3 y=0.300001 e=0.5"; do
  # shellcheck disable=SC2086
  check "a floor that is not at zero: $case" run corner s $case --until 12
  h=${case%% *}
  check "is not passed" near "$(awk -F, 'END { print $3 }' "$TMP/out.csv")" "${h#h=}" "$(calc "${h#h=}*1e-14")"
done

# ---- a beam falls flat on three supports in a line, its mass between the middle and the right one: any two of them could carry it
model beam <<'END'
model beam "A beam on three supports"
coord y [m], th [rad]
param m = 1 [kg] > 0, I = 0.2 [kg*m^2] > 0, g = 9.81 [m/s^2] > 0, a = 1 [m], c = 0.9 [m], e = 0
let yc = y + c*th
kinetic = m/2*yc'^2 + I/2*th'^2
potential = m*g*yc
contact l: y - a*th >= 0, restitution = e
contact n: y >= 0, restitution = e
contact r: y + a*th >= 0, restitution = e
scene drop { start y = 0.1 [m]; span 1 [s]; output y, th, lambda(l), lambda(n), lambda(r) every 0.1 [s] }
END
slow check "a beam falls flat on three supports" run beam drop
[ -z "${SLOW:-}" ] || check "and lies" near "$(cell 1 2)" 0 1e-15
[ -z "${SLOW:-}" ] || check "the one that would pull does nothing" near "$(cell 1 4)" 0 1e-14
[ -z "${SLOW:-}" ] || check "the others carry: in the middle" near "$(cell 1 5)" 0.981 1e-12
[ -z "${SLOW:-}" ] || check "and right" near "$(cell 1 6)" 8.829 1e-12
slow check "it bounces" run beam drop e=0.5
tau=$(calc '0.2 - sqrt(0.2/9.81)')
[ -z "${SLOW:-}" ] || check "as a ball does" near "$(cell 0.20000000000000001 2)" "$(calc "0.5*sqrt(0.2*9.81)*$tau - 9.81*$tau*$tau/2")" 1e-12
[ -z "${SLOW:-}" ] || check "and does not turn" near "$(cell 0.20000000000000001 3)" 0 1e-15
slow check "which contacts are closed is not for others to say" fails 2 "l.closed: no such parameter" beam drop l.closed=1

# ---- contradictory contacts, and states without a past
model squeeze <<'END'
model squeeze "A ball between a wall and one that moves toward it"
coord x [m]
param m = 1 [kg] > 0, e = 0
lagrangian = m/2*x'^2
contact l: x >= 0, restitution = e
contact r: 1 [m] - 0.6 [m/s]*t - x >= 0, restitution = e
scene s { start x = 0.5 [m], x' = 1 [m/s]; span 3 [s] }
END
check "a ball that is squeezed ends the run" fails 3 "the contacts r and l contradict each other" squeeze s
model back <<'END'
model back "A ball that bounces, seen backwards"
coord y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, e = 1
lagrangian = m/2*y'^2 - m*g*y
contact floor: y >= 0, restitution = e
scene s { start y = 1 [m]; span -1 [s]; method dop853; tolerance 1e-12; output y, y' every 0.5 [s] }
END
check "an elastic ball runs backwards" run back s
# the same motion: from 1 m at rest it has fallen from there 2 sqrt(2/g) earlier
check "as it runs forwards" near "$(cell -1 2)" "$(calc '1 - 9.81/2*(2*sqrt(2/9.81) - 1)^2')" 1e-10
check "one that loses energy has no past" fails 2 "cannot be reversed" back s e=0.5

# ---- impacts that accumulate are judged by their own series, whenever they begin
model latch <<'END'
model latch "A ball held until t = T, then dropped from h"
coord y [m]
param g = 9.81 [m/s^2], e = 0.9, h = 0.02 [m], T = 1e6 [s]
lagrangian = y'^2/2 - g*y
contact floor: y >= 0, restitution = e
constraint held: y = h while t < T
scene s { start y = h; span 1000000.8 [s]; output y, y' every 1000000.8 [s] }
END
# By hand: 10 impacts, then y = v u - g u^2/2. Times are doubles near 1e6 s, 1.2e-10 s apart: y moves by 1e-11 m in that.
check "a ball that is dropped late bounces on" run latch s
check "as high" near "$(cell 1000000.8 2)" 0.00196177174248 1e-9
# It rests at sqrt(2 h/g) (1 + e)/(1 - e); flights below the rounding of the gap, 64 2^-52 h, are left out, and said: 2 sqrt(2 (that)/g)/(1 - e) s.
rests() { # rests ARGS...
  "$LAGC" run "$TMP/latch.lag" s T=0 e=0.99 --until 20 --json >"$TMP/json" || return 1
  awk -v last="$(sed -n 's/.*"floor": {[^}]*"last": \([^,}]*\).*/\1/p' "$TMP/json")" -v out="$(sed -n 's/.*"left_out": \([^,}]*\).*/\1/p' "$TMP/json")" \
    'BEGIN { d = last + out - sqrt(0.04/9.81)*199; print last, out, d; exit !(out > 0 && out < 1e-5 && d < 1e-8 && d > -1e-8) }'
}
check "and rests when the series ends" rests
# A branch that ends 700 times a second does not rattle, late in a run, either: x'' = -k sign(x) from h crosses 0 every 2 sqrt(2 h/k) s.
model relay <<'END'
model relay "A mass between two sides that pull, held until t = T"
coord x [m]
param T = 1e6 [s], k = 40000 [m/s^2], h = 0.01 [m]
lagrangian = x'^2/2 - k*abs(x)
constraint held: x = h while t < T
scene s { start x = h; span 1000001 [s] }
END
crossings() { "$LAGC" run "$TMP/relay.lag" >"$TMP/log" 2>&1 && grep -q '^surface x = 0: crossed 707 times' "$TMP/log" || { cat "$TMP/log"; false; }; }
check "a switch that is passed often, late" crossings
tap_end
