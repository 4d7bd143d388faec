#!/bin/sh
# Momenta over 10^6 steps: tests/unit/test_rt_variational.c.
. tests/tap.sh
one_day_in 3 2
. tests/exec/lib_long.sh
long rt_variational
