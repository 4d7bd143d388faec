#!/bin/sh
# The published problems by every method that integrates them, to the limits in runs.txt: half of them by day, in `make test-all` all.
. tests/tap.sh
. tests/hard/lib_cases.sh
a_part_of_the_cases

check "the cases are emitted, with what every method needs" emit_cases all
check "and compile" compile_cases "$TMP/hard"
relay hard_runs long

# A pendulum in Cartesian coordinates, adaptive, over 1000 s: off the circle by less than 1e-12 at every output. (Without projection rk45 at
# 1e-9 is 1e-3 off by then.)
on_circle() {
  "$LAGC" run $hard/cases/trap_drift_1e6_steps.lag --method rk45 --tol 1e-9 --observe 'x^2 + y^2 - 1' --every 0.1 -o "$TMP/rows.csv" --quiet &&
    awk -F, 'NR > 1 { n++; if ($NF > 1e-12 || $NF < -1e-12) { print; bad = 1 } } END { exit bad || n < 10000 }' "$TMP/rows.csv"
}
check "rk45 at a tolerance of 1e-9 stays on the circle" on_circle
tap_end
