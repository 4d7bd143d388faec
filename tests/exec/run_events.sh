#!/bin/sh
# Events that turn many times within one step of an adaptive method: a clock sin(w t) strikes
# floor(10 w / (2 pi)) times in 10 s, whatever the method's steps are. And events that accumulate: the bounces of a ball
# with restitution e end at sqrt(2 h/g)*(1 + e)/(1 - e), 4.0637 s; no run hangs there.
. tests/tap.sh
strikes() { # METHOD W
  "$LAGC" run tests/exec/models/clock.lag "w=$2" --method "$1" --json | sed 's/.*"n": \([0-9.e+]*\).*/\1/'
}
for method in rk45 dop853; do
  is "$method: 20 rad/s" 31 "$(strikes $method 20)"
  is "$method: 200 rad/s" 318 "$(strikes $method 200)"
  is "$method: 500 rad/s, near a multiple of the sampling" 795 "$(strikes $method 500)"
done

# A strike that changes the motion begins a new step, so that strikes lie anywhere in steps: floor(2 w/(2 pi)) in 2 s. And an
# oscillation that is above the event for a moment only, a hundred times.
"$LAGC" build tests/exec/models/kicks.lag -o "$TMP/kicks" >"$TMP/out" 2>&1
while read -r w n; do
  is "kicked at $w rad/s" "$n" "$("$TMP/kicks" --json "w=$w" | sed 's/.*"j": {"count": \([0-9]*\).*/\1/')"
done <<'END'
500 159
800 254
850 270
900 286
950 302
1000 318
1037 330
1100 350
1150 366
1200 381
END
for method in rk45 dop853 'verlet8 --step 0.3' taylor; do
  # shellcheck disable=SC2086
  is "$method: short excursions" 100 "$("$LAGC" run tests/exec/models/graze.lag --method $method --json |
    sed 's/.*"up": {"count": \([0-9]*\).*/\1/')"
done

# Functions that jump over zero: x = sin t is above 1/2 from pi/6 to 5 pi/6, modulo 2 pi, 10 times in 60 s; x or -x also rises where x falls through 0, at
# pi + 2 pi k. Reflected at 1/2 the motion comes back every 4 pi/3, 15 times. A change of another state at the jump leaves the count. At a pole g has no zero.
. tests/exec/lib_oscillator.sh
oscillator <<'END'
state n
flow n' = 0 [1/s]
event hop
scene s { start x' = 2 [m/s]
  span 30 [s] }
END
jumps() { # G ACTION METHOD: the count, the phases 2 t of the first and the last time in units of pi/12
  sed "s!event hop.*!event e: $1 $2!" "$TMP/osc.lag" >"$TMP/jump.lag"
  # shellcheck disable=SC2086
  "$LAGC" run "$TMP/jump.lag" --method $3 >"$TMP/out" 2>&1 || return 1
  sed -n 's/^event e: never/none/p; s/^event e: \([0-9]*\) times, first at t = \([^ ]*\) s, last at \([^ ]*\) s/\1 \2 \3/p' "$TMP/out" |
    awk '/none/ {print; next} {u = 24/3.14159265358979; printf "%d %.4f %.4f\n", $1, $2*u, $3*u}'
}
for method in taylor dop853 rk45 'rk4 --step 0.01'; do
  while IFS='|' read -r g action want; do
    is "$method: $g $action" "$want" "$(jumps "$g" "$action" "$method")"
  done <<'END'
x - 0.5 [m]|rising {}|10 2.0000 218.0000
if(x > 0.5 [m], 1, -1)|rising {}|10 2.0000 218.0000
if(x > 0.5 [m], 1, -1)|falling {}|10 10.0000 226.0000
if(x > 0.5 [m], 1, -1)|crossing {}|20 2.0000 226.0000
sign(x - 0.5 [m])|rising {}|10 2.0000 218.0000
floor(x/(0.5 [m])) - 0.5|rising {}|10 2.0000 218.0000
if(x > 0.5 [m], x, -x)|rising {}|20 2.0000 228.0000
if(x > 0.5 [m], 1, -1)|rising { x' = -x' }|15 2.0000 226.0000
if(x > 0.5 [m], 1, -1)|crossing { x' = -x' }|15 2.0000 226.0000
sign(x - 0.5 [m])|rising { n = n + 1 }|10 2.0000 218.0000
if(x > 0.5 [m], 1, -1)*1e-5|crossing {}|20 2.0000 226.0000
tan(2*t/(1 [s]))|rising {}|19 12.0000 228.0000
tan(2*t/(1 [s]))|falling {}|none
END
done

printf '%s\n' 'model m' 'coord x [m]' "kinetic = x'^2/2 * 1 [kg]" 'event down: 1/2 [s] - t falling {}' 'event up: t - 1/2 [s] rising {}' 'scene s { span 1 [s] }' >"$TMP/end.lag"
is "at the end of a step" "0.5 0.5" "$("$LAGC" run "$TMP/end.lag" --method rk4 --step 0.125 --json | sed 's/.*"down": {"count": 1, "first": \([^,]*\).*"up": {"count": 1, "first": \([^,]*\).*/\1 \2/')"

# A run ends where it was asked to, however near to a row: kicks and events between the two happen (times are 1e-10 s apart at 1e6).
printf '%s\n' 'model m' 'coord x' 'param T = 1' "lagrangian = x'^2/2" "kick k every T { x' = x' + 1 }" "event e: t - T rising { x' = x' + 2 }" 'scene s { start x = 0 }' >"$TMP/late.lag"
for times in '1000000 1000000.0001' '1000000 1000000.000001' '3 3.0000000001'; do
  T=${times% *} end=${times#* }
  is "behind the last row: T = $T, to $end" "$end 3" "$("$LAGC" run "$TMP/late.lag" "T=$T" --until "$end" --every "$T" -o "$TMP/late.csv" --quiet && sed -n '$s/\([^,]*\),[^,]*,\([^,]*\),.*/\1 \2/p' "$TMP/late.csv")"
done

piles_up() { # METHOD
  "$LAGC" run models/bouncing_ball.lag drop --until 4.2 --method "$1" >"$TMP/out" 2>&1
  [ $? = 3 ] && grep -q 'event floor repeats in ever shorter intervals: .* at t = 4.0637' "$TMP/out"
}
for method in rk45 dop853 rk4 verlet4; do
  check "$method: bounces without end" piles_up $method
done

# A pawl that slips back by 1e-13 m each time it is reached: 1e13 events to the end
printf '%s\n' 'model m' 'coord x [m]' "kinetic = x'^2/2 * 1 [kg]" 'event pawl: x - 1 [m] rising { x = 1 [m] - 1e-13 [m] }' "scene s { start x' = 1; span 2 [s] }" >"$TMP/pawl.lag"
goes_on() { timeout 5 "$LAGC" run "$TMP/pawl.lag" s >"$TMP/out" 2>&1; [ $? = 3 ] && grep -q 'FAILED: at t = 1.00000000.* s event pawl and others happen again and again: the last 1000 advanced the time by only 1e-10 s' "$TMP/out"; }
check "events that do not advance the time end the run" goes_on
tap_end
