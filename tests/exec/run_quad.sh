#!/bin/sh
# Implicit symplectic methods in quadruple precision: tests/exec/quad_methods.c with the runtime's core and methods, and models
# that lagc emits.
: "${LAGC:=build/lagc}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}"
gcc=
for c in "${CC:-cc}" gcc; do "$c" --version 2>/dev/null | grep -q 'Free Software' && gcc=$c && break; done
flags='-std=gnu11 -O1 -w -ffp-contract=off -include tests/exec/quad_runtime.h'
if [ -z "$gcc" ] || ! echo 'int main(void) { return 0; }' | $gcc $flags -x c - -lquadmath -o "$TMP/probe" 2>/dev/null; then
  echo '1..0 # SKIP there is no gcc with libquadmath'
  exit 0
fi
for m in models/pendulum models/double_pendulum models/kepler tests/exec/models/magnet tests/exec/models/shaken; do
  "$LAGC" emit $m.lag --method gauss --with linear -o "$TMP/$(basename $m).c" || exit 1
done
$gcc $flags -DLAG_REAL=__float128 '-DLAG_FN(x)=x##q' '-DLAG_C(x)=x##Q' -I"$INC" -Iruntime "$TMP"/*.c runtime/core/*.c \
  runtime/methods/*.c tests/exec/quad_methods.c -lquadmath -lm -o "$TMP/quad" || exit 1
"$TMP/quad"
