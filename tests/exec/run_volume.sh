#!/bin/sh
# Liouville's theorem: lagc run --volume against closed forms of determinants, for methods that keep volumes and methods that do not; lagc plot --cloud, whose areas say the same.
. tests/tap.sh

# volume FIELD MODEL ARGUMENT...: a number of the report
volume() {
  field=$1
  shift
  "$LAGC" run "$@" --volume --json | tr '{}' '\n\n' | sed -n "s/.*\"$field\": \([^,]*\).*/\1/p; /\"space\"/q"
}
cat >"$TMP/osc.lag" <<'X'
model osc
coord x [m]
param m = 3 [kg] > 0, k = 12 [N/m] > 0, c = 0.9 [N*s/m]
lagrangian = m/2*x'^2 - k/2*x^2
effect drag { dissipation = c/2*x'^2 }
scene free { start x = 1 [m]; span 100 [s] }
scene damped { like free; use drag }
X

# 10^5 steps whose roundings, some 1e-16 each, come from all directions: 1e-16 sqrt(10^5) = 3e-14, and a hundred times that at most.
for method in 'verlet' 'gauss' 'variational' 'symplectic_euler' 'verlet8'; do
  near "the volume under $method, 10^5 steps" 1e-11 0 "$(volume largest models/pendulum.lag --until 1000 --method "$method" --step 0.01)"
done
# Two coordinates, with a mass matrix that varies: roundings are times its condition, about 6.
near "and of a double pendulum under gauss" 1e-11 0 "$(volume largest models/double_pendulum.lag th1=0.3 th2=0.2 --until "${SLOW:+10}100" --method 'gauss(stages=2, step=0.01)')"
near "of two coordinates with their momenta" 1e-11 0 "$(volume largest models/sommerfeld.lag --method 'gauss(step=0.05)' --until 100)"

# By other methods: N log |R(i w h)|^2 of a linear oscillator, w = 2, R the polynomial of the method.
near "under euler" 1e-12 "$(awk 'BEGIN { printf "%.17g", 100*log(1 + 0.02^2) }')" "$(volume log "$TMP/osc.lag" free --method euler --step 0.01 --until 1)"
near "under rk4" 1e-12 "$(awk 'BEGIN { x = 0.2; printf "%.17g", 1000*log((1 - x^2/2 + x^4/24)^2 + (x - x^3/6)^2) }')" "$(volume log "$TMP/osc.lag" free --method rk4 --step 0.1)"
is "the largest on the way, of a log that falls" 1 "$(awk -v a="$(volume log "$TMP/osc.lag" free --method rk4 --step 0.1)" -v b="$(volume largest "$TMP/osc.lag" free --method rk4 --step 0.1)" 'BEGIN { print a < 0 && a + b == 0 }')"

# Friction: the integral of the divergence, -c/m t; with a mass that varies, p' = ... - c p, whatever the mass at the end.
near "with friction, exp(-c t/m)" 1e-8 -30 "$(volume log "$TMP/osc.lag" damped --tol 1e-13)"
near "at a time within a step" 1e-9 -0.1 "$(volume log "$TMP/osc.lag" damped --tol 1e-13 --until 0.33333333333333333)"
cat >"$TMP/mass.lag" <<'X'
model mass
coord x
param c = 0.2
kinetic = (1 + x^2)*x'^2/2
potential = x^2
effect drag { dissipation = c*(1 + x^2)*x'^2/2 }
scene free { start x = 2; span 7.3 }
scene damped { like free; use drag }
X
near "with a mass that varies" 1e-9 -1.46 "$(volume log "$TMP/mass.lag" damped --tol 1e-12)"
near "and without friction" 1e-9 0 "$(volume log "$TMP/mass.lag" free --tol 1e-12)"
near "of states, as Lorenz's" 1e-8 "$(awk 'BEGIN { printf "%.17g", -(10 + 1 + 8/3) }')" "$(volume log models/lorenz.lag --until 1 --tol 1e-12)"
near "each bounce takes e^2" 1e-9 "$(awk 'BEGIN { printf "%.17g", 19*2*log(0.8) }')" "$(volume log models/bouncing_ball.lag drop)"
check "a slide: neighbouring motions become one" says 0 "volume of phase space: 0" "$LAGC" run models/block.lag --volume
check "a form that varies is told" says 0 "not that of Liouville" "$LAGC" run models/lotka_volterra.lag --volume

# Refusals
check "constraints" says 2 "constraints" "$LAGC" run models/cartesian_pendulum.lag --volume
check "beside --tangent" says 2 "make two runs" "$LAGC" run models/spring.lag --volume --tangent
check "a saved state" says 2 "holds no tangent" "$LAGC" run models/spring.lag --volume --save-state "$TMP/state"
check "a method without a derivative" says 2 "no derivative" "$LAGC" run models/spring.lag --volume --method gsl-rk8pd

# ---- clouds: N points on an ellipse; the area inside the trigonometric interpolant is exact for linear maps, and spectral for smooth ones
# factor METHOD T: the area at t = T over that at first
areas() { "$LAGC" plot "$@" -o "$TMP/cloud.svg" 2>"$TMP/err"; }
factor() { areas "$TMP/osc.lag" free --cloud 8 --until 2 --step 0.01 --method "$1" | sed -n 's/.* \([^ ]*\) at t = 2 s$/\1/p'; }
near "the area of a cloud under euler" 1e-8 "$(awk 'BEGIN { printf "%.17g", 1.0004^200 }')" "$(factor euler)" # nine digits are printed
for method in symplectic_euler verlet gauss; do near "under $method" 1e-8 1 "$(factor $method)"; done
is "it begins as an ellipse: half-axes a tenth of the motion's, in x and p" "times pi/100" "$(areas "$TMP/osc.lag" free --cloud 12 --until 10 --tol 1e-10 | awk '{ a = $6/(3*2*3.14159265*0.01); print (a - 1)^2 < 1e-7 ? "times pi/100" : $0 }; { exit }')" # 400 samples miss the extremes by (pi/80)^2/16 at most
is "by three methods at once" "euler: symplectic_euler: verlet:" "$(areas models/pendulum.lag --cloud 20 --method euler,symplectic_euler,verlet --step 0.02 --until 1 | awk '/area/ { printf "%s%s", s, $1; s = " " }')"
check "a curve a method, five clouds each" sh -c '[ "$(grep "stroke-width=\"1.6\"" "$1" | tr -dc "M\n" | tr "\n" " ")" = "MMMMM MMMMM MMMMM " ]' sh "$TMP/cloud.svg"
near "a nonlinear map" 1e-8 1 "$(areas models/pendulum.lag --cloud 60:0.3 --method verlet --step 0.05 --until 4 | sed -n 's/.* \([^ ]*\) at t = 4 s$/\1/p')"
is "a curve that is too coarse has no area" "?" "$(areas models/pendulum.lag th=3 --cloud 20 | sed -n 's/.* \([^ ]*\) at t = 20 s.*/\1/p')"
check "a run that fails is drawn up to then" sh -c '"$1" plot models/pendulum.lag --cloud 20 --method euler --step 0.1 --until 4 -o "$2/c.svg" >"$2/o" 2>"$2/e" && grep -q "its cloud is drawn up to then" "$2/e" && grep -q "at t = 3 s" "$2/o"' sh "$LAGC" "$TMP"
is "of one of two coordinates" 1 "$(areas models/henon_heiles.lag --cloud 8 --x x --y "x'" --until 0.1 | grep -c area)"
printf 'model h\ncoord q\nmomentum p of q\nhamiltonian = p^2/2 + q^2/2\nscene s { start q = 1; span 3 }\n' >"$TMP/h.lag"
near "of a Hamiltonian over its momentum" 1e-8 1 "$(areas "$TMP/h.lag" --cloud 8 | sed -n 's/.* \([^ ]*\) at t = 3 s$/\1/p')"
check "a quantity that cannot be displaced" says 2 "give two by --x and --y" "$LAGC" plot models/kepler.lag --cloud 20 --x x --y energy -o "$TMP/no.svg"
check "two coordinates, and none named" says 2 "one coordinate" "$LAGC" plot models/kepler.lag --cloud 20 -o "$TMP/no.svg"
check "too few starts" says 2 "from 8 to" "$LAGC" plot models/pendulum.lag --cloud 3 -o "$TMP/no.svg"
while IFS='|' read -r words of; do
  # shellcheck disable=SC2086 # a list of words
  check "--cloud $of" says 2 "$words" "$LAGC" plot models/pendulum.lag -o "$TMP/no.svg" --cloud $of
done <<'END'
"x" is not a number; write for example --cloud 60|x
after the colon stands the size of the cloud|20:0
the time between two clouds must be positive|20 --every -1
--every 0.001: that makes 20001 clouds; 100 can be told apart at most|20 --every 0.001
two scenes are named, small and wide; a cloud is around the start of one|20 small wide
th does not change along the motion, which gives the cloud its size|20 th=0 th'=0
END
check "a cloud and a section" says 2 "leave one of them out" "$LAGC" plot models/pendulum.lag --cloud 30 --section "th rising" -o "$TMP/no.svg"
check "--phase" says 2 "leave out --phase" "$LAGC" plot models/pendulum.lag --cloud 30 --phase th -o "$TMP/no.svg"
tap_end
