#!/bin/sh
# The runs of tests/unit/test_rt_geometry.c over 10^6 steps.
LAG_STEPS=1000000 "$BIN/test_rt_geometry"
