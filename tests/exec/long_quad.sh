#!/bin/sh
# Methods in quadruple precision: tests/exec/quad_methods.c on models that lagc emits.
. tests/tap.sh
. tests/exec/lib_precision.sh
has_precision quad || skip_all "there is no gcc with libquadmath"
for m in models/pendulum models/double_pendulum models/kepler tests/exec/models/magnet tests/exec/models/shaken; do
  sed 's/^\(scene .*{\)/\1 method gauss;/' $m.lag >"$TMP/model.lag" # gauss needs other derivatives than those requested here
  "$LAGC" emit "$TMP/model.lag" --method taylor --with linear -o "$TMP/$(basename $m).c" || exit 1
done
precise quad tests/exec/quad_methods.c >"$TMP/methods.c"
check "the methods compile in quadruple precision" compile_precise quad "$TMP/quad" "$TMP"/*.c
relay "$TMP/quad"
tap_end
