#!/bin/sh
# Models with an event and a constraint, by every command, with a compiler and a runtime under sanitizers. long_sanitized.sh has all of the gallery.
. tests/exec/lib_sanitized.sh
[ "${ROWS:-}" = all ] || turn=${DAY:-0}
for model in models/bouncing_ball.lag ${SLOW:+models/slider_crank.lag tests/exec/models/rod.lag}; do
  empty "$model" "$(every_command "$model")"
done
# Further code: dry friction that sticks, also of contacts, the tangent of a flow across events, and a family of contacts.
cat >"$TMP/slide.lag" <<'X'
model slide
coord x [m]
param mu = 0.3 [1], g = 9.81 [m/s^2] > 0
lagrangian = x'^2/2*1 [kg]
force x = -1 [kg]*mu*g*sign(x')
scene s { start x' = 2 [m/s]; span 10 [s] }
X
cat >"$TMP/pair.lag" <<'X'
model pair
coord x[2] [m]
param F = 2 [N]
lagrangian = 1 [kg]/2*(x[1]'^2 + x[2]'^2) - 3 [N/m]/2*(x[2] - x[1])^2
for i in 1..2 { friction rub[i] on x[i]: 1 [N], static = 1.2 [N] }
force x[1] = F*sin(2 [rad/s]*t) + 0.1 [N]*floor(3*t/1 [s])
event blow: t - 3 [s] rising { x[2]' = 1 [m/s] }
scene s { span 6 [s]; output x, rub[1], rub[2] every 0.1 [s] }
X
cat >"$TMP/drops.lag" <<'X'
model drops
coord y[3]
lagrangian = sum(i in 1..3, y[i]'^2/2 - 10*y[i])
contact floor[i in 1..3]: y[i] >= 0, restitution = 0
scene s { start y[i in 1..3] = 0.01*i; span 0.1; method moreau(step = 0.01) }
X
said=$TMP/more
for words in "run tests/exec/models/rod.lag --until 0.1" "modes tests/exec/models/rod.lag" "run $TMP/slide.lag" "run $TMP/slide.lag --method rk4" "run $TMP/pair.lag" "run $TMP/pair.lag --method radau" "run $TMP/drops.lag" "orbit models/cartesian_pendulum.lag" "run models/sliding_ball.lag dropped" "run models/painleve_rod.lag pulled" "run models/bouncing_ball.lag --tangent --until 2" "lyapunov models/bouncing_ball.lag --until 2"; do
  # shellcheck disable=SC2086 # some words
  empty "$words" "$(clean $words)"
done
# A function by hand that is right, one with a wrong term, and one with another order of y.
sed 's/- m2[*]g[*]sin/+ m2*g*sin/' models/double_pendulum_textbook.c >"$TMP/wrong.c"
for words in "models/double_pendulum.lag --against models/double_pendulum_textbook.c:rhs" "models/double_pendulum.lag --against $TMP/wrong.c:rhs" \
  "models/cart_pendulum.lag --against tests/exec/verify/hand.c:cart_pendulum" "models/lorenz.lag --against tests/exec/verify/hand.c:kepler"; do
  # shellcheck disable=SC2086 # some words
  empty "verify $words" "$(clean verify $words)"
done
tap_end
