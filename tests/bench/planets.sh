#!/bin/sh
# Outer planets, 10^4 years, by wisdom_holman. To reach: 8 ms at an error of 7e-3 au, the time of REBOUND's WHFast; 15 at 5e-6; 25 at 2.1e-9.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${INC:=runtime/include}" "${LIBLAG:=build/liblag.a}" "${TMP:=$(mktemp -d)}"
"$LAGC" emit tests/bench/models/outer_planets.lag --fix all -o "$TMP/outer_planets.c"
# shellcheck disable=SC2086 # lists of libraries
"$CC" -O2 -std=gnu11 -I"$INC" -Iruntime -Itests/bench tests/bench/planets.c "$TMP/outer_planets.c" $LIBLAG ${LIBS:-} -lm -o "$TMP/planets"
echo '| scheme | step [d] | error [au] | ms | forces |'
echo '| --- | --- | --- | --- | --- |'
"$TMP/planets" wh 160 sbab2 400 sbab3 600 sbab4 400 aba864 360 aba864 300 aba864 220
