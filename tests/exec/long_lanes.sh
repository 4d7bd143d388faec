#!/bin/sh
# run_lanes.sh with every model, and with clang.
ALL_MODELS=1
. tests/exec/run_lanes.sh
