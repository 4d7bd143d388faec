#!/bin/sh
# Headers say what they cannot do: values that are not finite, tolerances that are none, compilers that drop NaN. Digits do not depend on fused
# multiply-add where NO_FMA is defined.
. tests/tap.sh

cat >"$TMP/pole.lag" <<'END'
model pole "A mass that is pushed off, with a constant mass matrix"
coord x, y
param k = 1
kinetic = x'^2/2 + y'^2/2
potential = k/x + sin(y)
scene s { start x = 1, y' = 1; span 3; output x }
END
check 'header' "$LAGC" header "$TMP/pole.lag" --with rk45,dop853,taylor,verlet,variational -o "$TMP/pole.h"
built() { "$CC" -std=c99 -O1 -Wall -Wextra -Werror -ffp-contract=off "$@" -I"$TMP" tests/exec/embed_faults.c -lm; }
check 'compiles' built -o "$TMP/faults"
check 'each failure is a status, and keeps the state' "$TMP/faults"
for flag in -ffast-math ${SLOW:+-Ofast -ffinite-math-only}; do
  check "$flag is refused" says 1 'compile it without -ffast-math' built "$flag" -fsyntax-only
done
if grep -q '\bfma\b' /proc/cpuinfo 2>/dev/null; then
  check 'compiles for fused multiply-add' built -mfma -DPOLE_NO_FMA -o "$TMP/no_fma"
  is 'its digits are the same' "$("$TMP/faults" digits || echo none)" "$("$TMP/no_fma" digits)"
else
  skip 'digits with and without fused multiply-add' 'the processor has none'
fi
tap_end
