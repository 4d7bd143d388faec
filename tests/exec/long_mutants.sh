#!/bin/sh
# `make mutants` at work: of two one-token changes each has a verdict, by a suite that reaches its line.
. tests/tap.sh
one_day_in 3 1
"${MAKE:-make}" mutants N=2 JOBS=1 SUITES=unit/test_sparse ONLY_IN=src/base/sparse_solve.c >"$TMP/log" 2>&1
is 'make mutants: exit status' 0 $?
check 'two changes are judged, and seen' grep -q '^killed 2 of 2' "$TMP/log"
[ "$tap_bad" = 0 ] || tail -n 20 "$TMP/log" | sed 's/^/# /'
check 'a suite that does not exist' says 1 "no suite's name begins with unit/test_nothing" python3 tests/mutants/mutants.py --n 1 --suites unit/test_nothing
tap_end
