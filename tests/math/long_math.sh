#!/bin/sh
# run_math.sh with a million points a function; and where the coefficients come from.
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
export TMP
POINTS=1000000 sh tests/math/run_math.sh || bad=1
. tests/tap.sh
if /usr/bin/env python3 -c 'import mpmath' 2>/dev/null || /usr/bin/python3 -c 'import mpmath' 2>/dev/null; then
  python=python3
  python3 -c 'import mpmath' 2>/dev/null || python=/usr/bin/python3
  check "the coefficients are those of tests/math/remez.py" $python tests/math/remez.py runtime/include/lag_math.h runtime/include/lag_sincos.h
else
  skip "the coefficients are those of tests/math/remez.py" "there is no python3 with mpmath"
fi
tap_end && [ -z "${bad:-}" ]
