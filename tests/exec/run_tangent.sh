#!/bin/sh
# lagc run --tangent: dx/dy(0) of emitted models against closed forms; methods that use different derivatives of the model
# against each other; columns, units, JSON; what is refused. tests/unit/test_rt_tangent.c has the properties of methods.
: "${LAGC:=build/lagc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
export TMP
. tests/tap.sh

# last MODEL ARGS...: the last row, by `entry K`; columns: by `column NAME`
last() {
  title="$*"
  "$LAGC" run "$@" --tangent --quiet -o "$TMP/rows.csv" && head -1 "$TMP/rows.csv" >"$TMP/head" && tail -1 "$TMP/rows.csv" >"$TMP/last"
}
column() { # NAME [UNIT]
  tr ',' '\n' <"$TMP/head" | grep -n -x -F -e "$1" -e "$1 [${2:-}]" | cut -d: -f1
}
entry() { cut -d, -f"$(column "$@")" "$TMP/last"; }
close() { # WHAT EXPRESSION GOT TOLERANCE: relative, absolute below 1
  check "$title: $1" awk -v got="$3" -v tolerance="$4" "
    BEGIN { want = $2; d = got - want; size = want < 0 ? -want : want; if (size < 1) size = 1
      if (got != \"\" && d <= tolerance*size && -d <= tolerance*size) exit 0
      printf \"%.17g, not %.17g\\n\", got, want; exit 1 }"
}

# x = x0 cos wt + v0/w sin wt with w = 2
for method in rk45 dop853 radau 'verlet8(step=0.01)' 'gauss(stages=4, step=0.05)' 'variational(order=8, quadrature=lobatto, step=0.05)' 'rk4(step=1e-3)'; do
  last models/spring.lag free --until 3.3 --method "$method"
  close "dx/dx" "cos(6.6)" "$(entry 'dx/dx(0)')" 1e-9 # the scene's tolerance is 1e-11
  close "dx/dx'" "sin(6.6)/2" "$(entry "dx/dx'(0)" 'm/(m/s)')" 1e-9
  close "dx'/dx" "-2*sin(6.6)" "$(entry "dx'/dx(0)" '(m/s)/m')" 1e-9
  close "dx'/dx'" "cos(6.6)" "$(entry "dx'/dx'(0)")" 1e-9
done

# Damped, underdamped: the determinant is exp(-c t/m) (Liouville), dx/dv = exp(-g t) sin(wt)/w
last models/damped_oscillator.lag under --until 5
close "dx/dx'" "exp(-0.2*5)*sin(sqrt(4 - 0.04)*5)/sqrt(4 - 0.04)" "$(entry "dx/dx'(0)" 'm/(m/s)')" 1e-10
det2() { awk -F, -v a="$(column "dx/dx(0)")" 'END { printf "%.17g", $a*$(a + 3) - $(a + 1)*$(a + 2) }' "$TMP/last"; }
close "determinant" "exp(-0.4*5)" "$(det2)" 1e-10

# Lorenz: volumes shrink by exp(-(sigma + 1 + beta) t) along every motion.
last models/lorenz.lag --until 1
det3() {
  awk -F, -v a="$(column 'dx/dx(0)')" '{ printf "%.17g", $a*($(a+4)*$(a+8) - $(a+5)*$(a+7)) - $(a+1)*($(a+3)*$(a+8) - $(a+5)*$(a+6)) + $(a+2)*($(a+3)*$(a+7) - $(a+4)*$(a+6)) }' "$TMP/last"
}
close "volumes" "exp(-(10 + 1 + 8/3))*1e6" "$(awk -v d="$(det3)" 'BEGIN { printf "%.17g", d*1e6 }')" 1e-7 # of 1e-6: entries of 1 cancel to that

# M^-1 of the linearisation in dop853, second derivatives of L in gauss and the implicit verlet8: the same flow.
same_flow() { # MODEL METHOD STEP...
  "$LAGC" run "$1" --tangent --until 1 --method dop853 --tol 1e-13 --every 1 --quiet -o "$TMP/a.csv" &&
    "$LAGC" run "$1" --tangent --until 1 --method "$2" --every 1 --quiet -o "$TMP/b.csv" &&
    paste -d, "$TMP/a.csv" "$TMP/b.csv" | tail -1 | awk -F, '{ for (i = 1; i <= NF/2; i++) { d = $i - $(i + NF/2); s = $i*$i > 1 ? $i : 1
      if (d/s > 1e-8 || -d/s > 1e-8) { print "column", i, $i, $(i + NF/2); bad = 1 } } exit bad || NF < 40 }'
}
for model in double_pendulum spring_pendulum kepler; do
  check "$model: gauss as dop853" same_flow models/$model.lag 'gauss(stages=4, step=0.005)'
  check "$model: verlet8 as dop853" same_flow models/$model.lag 'verlet8(step=0.002)'
done

# ---- what a person sees
"$LAGC" run models/spring.lag free --tangent --until 1 >"$TMP/out"
check "the report has the matrix" sh -c "grep -q \"x(0) *x'(0)\" '$TMP/out' && grep -q '^  x  *-0.416146' '$TMP/out'"
json() { "$LAGC" run models/spring.lag free --tangent --until 1 --json | grep -q "\"tangent\": {\"x\": {\"x\": -0.41614[0-9]*, \"x'\": 0.454[0-9]*}, \"x'\": {\"x\": -1.81[0-9]*, \"x'\": -0.416[0-9]*}}, "; }
check "--json has it by names" json
degrees() { # declared units: the derivative of an angle in degrees by one in radians has the factor of both
  "$LAGC" run tests/exec/modes/coupled.lag --tangent --until 0.1 --quiet -o "$TMP/rows.csv" && head -1 "$TMP/rows.csv" | grep -q 'deg/rad'
}
check "units are those declared" degrees

# ---- refusals
refused() { # STATUS TEXT ARGS...
  status=$1
  text=$2
  shift 2
  "$LAGC" run "$@" --tangent >"$TMP/out" 2>&1
  [ $? = "$status" ] && grep -q -e "$text" "$TMP/out" || { cat "$TMP/out"; return 1; }
}
check "a method without" refused 2 "method taylor has no derivative of its steps; dop853 has" models/spring.lag free --method taylor
check "an event that changes the state" refused 3 "event floor changes the state" models/bouncing_ball.lag drop
check "a saved state" refused 2 "a saved state holds no tangent" models/spring.lag free --save-state "$TMP/state"
without() { "$LAGC" build models/spring.lag -o "$TMP/spring" && ! "$TMP/spring" --tangent >"$TMP/out" 2>&1 && grep -q 'lagc build --with linear' "$TMP/out"; }
check "a simulator without derivatives" without
with() { "$LAGC" build models/spring.lag --with linear -o "$TMP/spring" && "$TMP/spring" --tangent >"$TMP/out" && grep -q '^tangent' "$TMP/out"; }
check "and one with them" with
tap_end
