#!/bin/sh
# Published problems without constraints (tests/exec/cases) in quadruple precision: taylor reaches the last digit of what is
# published, or what the problem's condition leaves of 34 digits: 1e-18 of the tolerance that is stated for 16. In double
# precision no problem does, but for a top that precesses steadily: there a double can hold what an expected number is rounded to.
. tests/tap.sh
. tests/exec/cases/emit.sh
. tests/exec/lib_precision.sh

has_precision quad || skip_all "there is no gcc with libquadmath"
emit_cases
precise quad tests/exec/cases/cases.c >"$TMP/cases.c"
check "the cases compile" compile_precise quad "$TMP/quad" "$TMP"/*.c
tap_of "$TMP/quad" taylor 1e-33 1e-45 tests/exec/cases/cases.expected digits

cp tests/exec/cases/cases.c "$TMP/cases.c"
check "the cases compile for doubles" "$CC" -std=c11 -O1 -ffp-contract=off -I"$INC" "$TMP"/*.c "$BUILD/liblag.a" -lm -o "$TMP/double"
far() { ! "$TMP/double" taylor 1e-15 1e-25 tests/exec/cases/cases.expected digits >"$TMP/out" && ! grep '^ok' "$TMP/out" | grep -v lagrange_top_fast; }
check "doubles reach none but steady motion" far
tap_end
