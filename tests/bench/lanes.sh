#!/bin/sh
# The functions of lag_math.h and the accelerations of the double pendulum, of a double and in lanes: nanoseconds a lane. To reach: 2.8 ns
# a lane for the accelerations with 8 lanes; instructions a call of theirs as valgrind counts them are in code.sh.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}"
"$LAGC" emit models/double_pendulum.lag swing -o "$TMP/own.c"

run() { # NAME FILE OPTIONS...
  name=$1 file=$2
  shift 2
  "$CC" -O2 -std=gnu11 -ffp-contract=off -fno-tree-slp-vectorize -Wno-psabi "$@" -DSCENE=double_pendulum_swing -I"$INC" tests/bench/lanes.c "$TMP/$file.c" -lm -o "$TMP/lanes"
  printf '%-24s' "$name"
  "$TMP/lanes"
}
run 'doubles' own
grep -q ' fma .* avx2 ' /proc/cpuinfo 2>/dev/null || exit 0
run 'doubles, x86-64-v3' own -march=x86-64-v3
run '4 lanes, x86-64-v3' own -march=x86-64-v3 -DLAG_LANES=4
grep -q ' avx512dq ' /proc/cpuinfo || exit 0
run '8 lanes, x86-64-v4' own -march=x86-64-v4 -mprefer-vector-width=512 -DLAG_LANES=8
