#!/bin/sh
# --precision: simulators that compute with long doubles and in quadruple precision give as many digits as they have, and refuse numbers with fewer.
# Expected digits: closed forms, by mpmath with 50 digits. long_precision.sh has quadruple precision from the command line to the table.
. tests/exec/lib_digits.sh

is "a double has 16 digits" -0.839071529076452 "$(run "$TMP/osc.lag" --method taylor --tol 1e-15 | value x)"
[ -z "${SLOW:-}" ] || check "a long double has 18" begins -0.83907152907645245 "$(run "$TMP/osc.lag" --precision long --method taylor --tol 1e-18 | value x)"
[ -z "${SLOW:-}" ] || check "a long double in a table" begins -0.839071529076452452 "$(run "$TMP/osc.lag" --precision long --method taylor --tol 1e-18 -o - --quiet | tail -1 | cut -d , -f 2)"
check "in double precision: a tolerance of 1e-20" refuses 2 "--precision quad has 34 digits" "$TMP/osc.lag" --tol 1e-20
slow check "in long precision: a tolerance of 1e-20" refuses 2 "below what long precision can give" "$TMP/osc.lag" --precision long --tol 1e-20
check "no such precision" refuses 2 "--precision takes double, long, quad" "$TMP/osc.lag" --precision triple
same_as_double() { [ "$(run "$TMP/osc.lag" --precision double | grep -v steps)" = "$(run "$TMP/osc.lag" | grep -v steps)" ]; }
check "--precision double is the default" same_as_double

# Where no library of these numbers is: LAG_HOME of a tree with the runtime for doubles.
mkdir -p "$TMP/doubles/lib" && cp "$BUILD/liblag.a" "$TMP/doubles/lib" && ln -s "$(cd "$INC" && pwd)" "$TMP/doubles/include"
no_library() { LAG_HOME=$TMP/doubles refuses 2 "\`make precisions\` builds it, where the C compiler has libquadmath" "$TMP/osc.lag" --precision quad; }
check "quad needs libquadmath" no_library
if [ -z "${SLOW:-}" ] || ! has_precision quad; then
  slow skip "the digits of quad" "there is no gcc with libquadmath"
  tap_end
  exit
fi
[ -n "$CLANG" ] && no_quadmath() { CC=$CLANG refuses 2 "which comes with gcc" "$TMP/osc.lag" --precision quad; } &&
  check "a compiler without libquadmath" no_quadmath
check "taylor: the motion has 33 digits" begins $cos10 "$(quad "$TMP/osc.lag" --method taylor --tol 1e-33 | value x)"
# Refused: numbers with fewer digits.
check "a formula whose digits lagc does not know" refuses 2 "write other values as decimals" "$TMP/osc.lag" --precision quad 'x=2^0.5'
check "the coefficients of dop853" refuses 2 "have digits for a tolerance of 1e-27" "$TMP/osc.lag" --precision quad --method dop853 --tol 1e-30
check "past what quad gives" refuses 2 "write 9e-34 or more" "$TMP/osc.lag" --precision quad --tol 1e-35
check "GSL has doubles" refuses 2 "gsl-rk8pd computes with doubles" "$TMP/osc.lag" --precision quad --method gsl-rk8pd
check "NumPy files have doubles" refuses 2 "write to a .csv file" "$TMP/osc.lag" --precision quad -o "$TMP/x.npy"
tap_end
