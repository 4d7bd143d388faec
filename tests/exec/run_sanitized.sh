#!/bin/sh
# Two models, a constraint and an event, by every command, with a compiler and a runtime under sanitizers. long_sanitized.sh has all of the gallery.
. tests/exec/lib_sanitized.sh
for model in ${SLOW:+models/slider_crank.lag} tests/exec/models/rod.lag models/bouncing_ball.lag; do
  empty "$model" "$(every_command "$model")"
done
# Further code: dry friction that sticks, and the tangent of a flow across events.
cat >"$TMP/slide.lag" <<'X'
model slide
coord x [m]
param mu = 0.3 [1], g = 9.81 [m/s^2] > 0
lagrangian = x'^2/2*1 [kg]
force x = -1 [kg]*mu*g*sign(x')
scene s { start x' = 2 [m/s]; span 10 [s] }
X
said=$TMP/more
for words in "run $TMP/slide.lag" "run $TMP/slide.lag --method rk4" "run models/bouncing_ball.lag --tangent --until 2" "lyapunov models/bouncing_ball.lag --until 2"; do
  # shellcheck disable=SC2086 # some words
  empty "$words" "$(clean $words)"
done
tap_end
