#!/bin/sh
# Quadruple precision in full: no double is left in the runtime; every method, event, option, table and saved run keeps its digits.
. tests/exec/lib_digits.sh
has_precision quad || skip_all "there is no gcc with libquadmath"
says_nothing() { ! run "$TMP/long.lag" | grep "warning:.* number"; }
# A number, a function or a constant that runtime/precision.awk left a double would lose digits in silence.
no_doubles() {
  gen=$BUILD/gen/quad
  "$CC" -std=gnu11 -fsyntax-only -Werror=float-conversion -Werror=unsuffixed-float-constants \
    -D_GNU_SOURCE -DLAG_REAL=__float128 '-DLAG_PRECISION="quad"' -include quadmath.h -I"$gen/include" -I"$gen" -I"$BUILD/gen" "$gen"/*/*.c
}
check "no doubles are left in the runtime" no_doubles
check "in a table" begins $cos10 "$(quad "$TMP/osc.lag" --method taylor --tol 1e-33 -o - --quiet | tail -1 | cut -d , -f 2)"
check "in JSON" begins $cos10 "$(quad "$TMP/osc.lag" --method taylor --tol 1e-33 --json | sed 's/.*"final": {"x": \([^,]*\),.*/\1/')"
check "gauss" begins -0.83907152907645245225886394782 "$(quad "$TMP/osc.lag" --method 'gauss(stages=4)' --step 1e-3 | value x)"
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
