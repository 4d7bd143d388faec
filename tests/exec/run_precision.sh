#!/bin/sh
# --precision: simulators that compute with long doubles and in quadruple precision give as many digits, from the command line to
# the table, and refuse numbers with fewer. Expected digits: closed forms, by mpmath with 50 digits.
. tests/tap.sh
. tests/exec/lib_precision.sh

cat >"$TMP/osc.lag" <<'END'
model osc
coord x
param k = 0.1
lagrangian = x'^2/2 - 10*k*x^2/2
scene go { start x = 1; span 10; output x, x' every 5 }
scene turns { like go; span 20*pi }
END
cat >"$TMP/pend.lag" <<'END'
model pend
coord th [deg] periodic
lagrangian = th'^2/2 + cos(th)
event down: th falling { stop }
scene go { start th = 90 [deg]; span 10 }
END
run() { "$LAGC" run "$@" 2>&1; }
value() { awk -v name="$1" '$1 == name { print $2; exit }'; }
begins() { case $2 in "$1"*) ;; *) printf 'expected: %s...\n     got: %s\n' "$1" "$2"; return 1 ;; esac; }
refuses() { # STATUS TEXT ARGUMENTS...
  wanted=$1 text=$2
  shift 2
  run "$@" >"$TMP/said"
  status=$?
  [ $status = "$wanted" ] && grep -qF -e "$text" "$TMP/said" || { echo "status $status"; cat "$TMP/said"; return 1; }
}

# cos 10 = -0.83907152907645245225886394782406483..., a quarter of the period of a pendulum that starts at a right angle
# pi/2/agm(1, sqrt(1/2)) = 1.85407467730137191843385034719526004...
cos10=-0.83907152907645245225886394782406
is "a double has 16 digits" -0.839071529076452 "$(run "$TMP/osc.lag" --method taylor --tol 1e-15 | value x)"
check "a long double has 18" begins -0.83907152907645245 "$(run "$TMP/osc.lag" --precision long --method taylor --tol 1e-18 | value x)"
check "a long double in a table" begins -0.839071529076452452 "$(run "$TMP/osc.lag" --precision long --method taylor --tol 1e-18 -o - --quiet | tail -1 | cut -d , -f 2)"
check "in double precision: a tolerance of 1e-20" refuses 2 "--precision quad has 34 digits" "$TMP/osc.lag" --tol 1e-20
check "in long precision: a tolerance of 1e-20" refuses 2 "below what long precision can give" "$TMP/osc.lag" --precision long --tol 1e-20
check "no such precision" refuses 2 "--precision takes double, long, quad" "$TMP/osc.lag" --precision triple
same_as_double() { [ "$(run "$TMP/osc.lag" --precision double | grep -v steps)" = "$(run "$TMP/osc.lag" | grep -v steps)" ]; }
check "--precision double is the default" same_as_double

if ! has_precision quad; then
  check "quad needs libquadmath" refuses 2 "built without it, as where the C compiler has no libquadmath" "$TMP/osc.lag" --precision quad
  skip "the digits of quad" "there is no gcc with libquadmath"
  tap_end
  exit
fi
[ -n "$CLANG" ] && no_quadmath() { CC=$CLANG refuses 2 "which comes with gcc" "$TMP/osc.lag" --precision quad; } &&
  check "a compiler without libquadmath" no_quadmath
says_nothing() { ! run "$TMP/long.lag" | grep "warning:.* number"; }
# A number, a function or a constant that runtime/precision.awk left a double would lose digits in silence.
no_doubles() {
  gen=$BUILD/gen/quad
  "$CC" -std=gnu11 -fsyntax-only -Werror=float-conversion -Werror=unsuffixed-float-constants \
    -D_XOPEN_SOURCE=700 -DLAG_REAL=__float128 '-DLAG_PRECISION="quad"' -include quadmath.h -I"$gen/include" -I"$gen" -I"$BUILD/gen" "$gen"/*/*.c
}
check "no doubles are left in the runtime" no_doubles
quad() { run "$@" --precision quad; }
check "taylor: the motion has 33 digits" begins $cos10 "$(quad "$TMP/osc.lag" --method taylor --tol 1e-33 | value x)"
check "in a table" begins $cos10 "$(quad "$TMP/osc.lag" --method taylor --tol 1e-33 -o - --quiet | tail -1 | cut -d , -f 2)"
check "in JSON" begins $cos10 "$(quad "$TMP/osc.lag" --method taylor --tol 1e-33 --json | sed 's/.*"final": {"x": \([^,]*\),.*/\1/')"
check "gauss" begins -0.83907152907645245225886394782 "$(quad "$TMP/osc.lag" --method gauss --stages 4 --step 1e-3 | value x)"
check "dop853" begins -0.83907152907645245225 "$(quad "$TMP/osc.lag" --method dop853 --tol 1e-23 | value x)"
check "the time of an event" begins 1.8540746773013719184338503471952 "$(quad "$TMP/pend.lag" --method taylor --tol 1e-33 | sed -n 's/^stopped by an event at t = //p')"
check "a span of 20 pi" begins 62.831853071795864769252867665590 "$(quad "$TMP/osc.lag" turns --method taylor --tol 1e-33 | sed -n 's/^reached t = //p')"
back() { awk -v x="$(quad "$TMP/osc.lag" turns --method taylor --tol 1e-33 | value "x'")" 'BEGIN { exit !(x < 1e-31 && x > -1e-31) }'; }
check "after ten turns it is back" back

# The command line: as many digits as are written, units and pi in full.
start() { quad "$@" --until 1e-40 --method taylor | value "$start_of"; }
start_of=x
check "35 digits of a value" begins 1.23456789012345678901234567890123 "$(start "$TMP/osc.lag" x=1.2345678901234567890123456789012345)"
check "pi/3" begins 1.0471975511965977461542144610931 "$(start "$TMP/osc.lag" x=pi/3)"
check "a third" begins 0.33333333333333333333333333333333 "$(start "$TMP/osc.lag" x=1/3)"
start_of=th
check "a radian in degrees" begins 57.295779513082320876798154814105 "$(start "$TMP/pend.lag" 'th=1[rad]')"
check "a time" begins 31.41592653589793238462643383279 "$(quad "$TMP/osc.lag" --until '10*pi' | sed -n 's/^reached t = //p')"
# Refused: numbers with fewer digits.
check "a formula whose digits lagc does not know" refuses 2 "write other values as decimals" "$TMP/osc.lag" --precision quad 'x=2^0.5'
check "the coefficients of dop853" refuses 2 "have digits for a tolerance of 1e-27" "$TMP/osc.lag" --precision quad --method dop853 --tol 1e-30
check "past what quad gives" refuses 2 "write 9e-34 or more" "$TMP/osc.lag" --precision quad --tol 1e-35
check "GSL has doubles" refuses 2 "gsl-rk8pd computes with doubles" "$TMP/osc.lag" --precision quad --method gsl-rk8pd
check "NumPy files have doubles" refuses 2 "write to a .csv file" "$TMP/osc.lag" --precision quad -o "$TMP/x.npy"
sed 's/k = 0.1/k = 0.10000000000000000000000001/' "$TMP/osc.lag" >"$TMP/long.lag"
check "a number of the model with too many digits" refuses 0 ":3:11: warning: this number is rounded to 17 digits" "$TMP/long.lag" --precision quad
sed 's/10\*k/1.234567890123456*1.234567890123457/' "$TMP/osc.lag" >"$TMP/long.lag"
check "a product of numbers with too many digits" refuses 0 "a product of numbers of the model" "$TMP/long.lag" --precision quad
check "doubles say nothing" says_nothing
# Saved runs go on in their precision, bit by bit, and in no other.
quad "$TMP/osc.lag" --until 3 --save-state "$TMP/state" >/dev/null
goes_on() { [ "$(quad "$TMP/osc.lag" --resume "$TMP/state" | value x)" = "$(quad "$TMP/osc.lag" | value x)" ]; }
check "a saved run goes on" goes_on
check "not in another precision" refuses 2 "equations differ, or --precision" "$TMP/osc.lag" --resume "$TMP/state"
check "lagc build" "$LAGC" build "$TMP/osc.lag" --precision quad --method taylor -o "$TMP/sim"
check "the simulator" begins $cos10 "$("$TMP/sim" --method taylor --tol 1e-33 | value x)"
tap_end
