#!/bin/sh
# Which method a model allows, from the .lag file to the run: the compiler finds out what is separable, the runtime refuses
# what does not fit, and names what does.
. tests/tap.sh

flags() { # flags MODEL: those of its first variant
  "$LAGC" emit "$1" -o "$TMP/model.c" && sed -n 's/.*\.flags = \([^,]*\),.*/\1/p' "$TMP/model.c" | head -n 1
}
separable() { flags "$1" | grep -q LAG_SEPARABLE; }
not_separable() { ! separable "$1" && [ -s "$TMP/model.c" ]; }
run() { "$LAGC" run "$@" >"$TMP/out" 2>"$TMP/err"; }
refused() { # refused WORDS ARGS...
  words=$1
  shift
  run "$@"
  [ $? = 2 ] && grep -qF -e "$words" "$TMP/err" && grep -q 'rk45 and dop853' "$TMP/err"
}
says() { # says WORDS ARGS...
  words=$1
  shift
  run "$@" && grep -q -e "$words" "$TMP/out"
}

check "a pendulum is separable" separable models/pendulum.lag
check "Kepler is separable" separable models/kepler.lag
check "a total derivative in L changes nothing" separable tests/exec/models/gauge.lag
check "the double pendulum is not: its mass matrix varies" not_separable models/double_pendulum.lag
check "a magnetic field is not: velocities enter" not_separable tests/exec/models/magnet.lag

for m in symplectic_euler verlet verlet4 verlet6 verlet8; do
  check "$m on the pendulum" says "energy drift" models/pendulum.lag --method $m --step 1e-3 --until 1
  check "$m is refused by the double pendulum" refused "the mass matrix varies" models/double_pendulum.lag --method $m
  check "$m is refused by a magnetic field" refused "they depend on velocities" tests/exec/models/magnet.lag --method $m
done
check "dissipation is a force that depends on velocities" refused "they depend on velocities" models/spring.lag damped --method verlet
check "without it the same model is separable" says "energy drift" models/spring.lag free --method verlet
check "a push with explicit time is allowed, and the report says what that costs" \
  says "symplectic for conservative models" tests/exec/models/gauge.lag pushed --method verlet4
says "reached" tests/exec/models/gauge.lag go --method verlet4
check "no such note on a conservative model" sh -c "! grep -q 'symplectic for' '$TMP/out'"
check "dop853 on the double pendulum" says "energy drift: [0-9.]*e-1" models/double_pendulum.lag --method dop853 --tol 1e-12
check "steps of equal size by an adaptive method" says "steps 100, rejected 0" models/pendulum.lag --method "rk45(step=0.1, adapt=off)" --until 10
tap_end
