#!/bin/sh
# The runs of tests/unit/test_rt_geometry.c over 10^6 steps.
. tests/exec/lib_long.sh
long rt_geometry
