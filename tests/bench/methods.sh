#!/bin/sh
# Time against error of dop853 and taylor, next to GSL's rk8pd with right-hand sides written by hand, in one run. In brackets:
# the time over that of rk8pd. To reach (issue 5): see RESULTS.md.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${BUILD:=build}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}"

here=tests/bench
"$LAGC" emit models/double_pendulum.lag swing --method taylor -o "$TMP/double_pendulum.c"
"$LAGC" emit $here/models/henon_heiles.lag --method taylor -o "$TMP/henon_heiles.c"
"$LAGC" emit $here/models/kepler.lag hundred --method taylor -o "$TMP/kepler.c"
"$LAGC" emit $here/models/kepler.lag narrow --method taylor -o "$TMP/narrow.c"
"$LAGC" emit $here/models/outer_planets.lag --method taylor -o "$TMP/outer_planets.c"
sed -i 's/\<kepler\>/kepler_model_2/g' "$TMP/narrow.c" # two scenes of a model in one program

gsl='' libs=''
[ -n "${GSL:-}" ] && gsl=-DBENCH_GSL libs='-lgsl -lgslcblas'
for arch in '' -march=x86-64-v3; do
  # shellcheck disable=SC2086 # lists of words
  "$CC" -O2 -std=gnu11 -ffp-contract=off $arch $gsl -I"$INC" "$TMP"/*.c $here/methods.c "$BUILD/liblag.a" $libs -lm -o "$TMP/methods" 2>"$TMP/err" || {
    echo "not with $arch: $(head -n 1 "$TMP/err")"
    continue
  }
  echo "emitted C compiled with -O2 $arch"
  "$TMP/methods" || echo "cannot run here"
done
