#!/bin/sh
# Sensitivities and gradients beside SUNDIALS' CVODES, at an error of 1e-8, and beside differences, at 1e-6, of the double pendulum and a chain of 8; where it is installed
# (Debian: libsundials-dev).
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${BUILD:=build}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}"

one() { # MODEL SCENE END ARGS...
  model=$1 scene=$2 end=$3
  shift 3
  "$LAGC" header "models/$model.lag" "$scene" "$@" --with rhs,jac,params --prefix bench -o "$TMP/model.h"
  "$LAGC" emit "models/$model.lag" "$scene" "$@" --with derivatives -o "$TMP/model.c"
  "$CC" -O2 -std=gnu11 -w -DSCENE="${model}_$scene" -DBENCH_IMPLEMENTATION -I"$INC" -I"$TMP" tests/bench/peer_cvodes.c "$TMP/model.c" \
    "$BUILD/liblag.a" -lsundials_cvodes -lsundials_nvecserial -lm -o "$TMP/sensitivity" 2>"$TMP/err" ||
    { echo "there is no CVODES"; return; }
  "$TMP/sensitivity" "$end"
}
one double_pendulum swing 3
one chain swing 1 -DN=8
