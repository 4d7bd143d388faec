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

printf '%s\n' 'model m' 'coord x [m]' "kinetic = x'^2/2 * 1 [kg]" 'event down: 1/2 [s] - t falling {}' 'event up: t - 1/2 [s] rising {}' 'scene s { span 1 [s] }' >"$TMP/end.lag"
is "at the end of a step" "0.5 0.5" "$("$LAGC" run "$TMP/end.lag" --method rk4 --step 0.125 --json | sed 's/.*"down": {"count": 1, "first": \([^,]*\).*"up": {"count": 1, "first": \([^,]*\).*/\1 \2/')"

piles_up() { # METHOD
  "$LAGC" run models/bouncing_ball.lag drop --until 4.2 --method "$1" >"$TMP/out" 2>&1
  [ $? = 3 ] && grep -q 'event floor repeats in ever shorter intervals: .* at t = 4.0637' "$TMP/out"
}
for method in rk45 dop853 rk4 verlet4; do
  check "$method: bounces without end" piles_up $method
done
tap_end
