#!/bin/sh
# runtime/include/lag_math.h: errors of its functions against libquadmath, special values, the same bits from both compilers and in
# lanes, for 15,000 arguments a function, 100,000 in `make test-long`, a million in `make test-all`; and where the coefficients come from.
points=15000
[ -z "${SLOW:-}" ] || points=100000
[ "${SLOW:-}${ROWS:-all}" != 1all ] || points=1000000
. tests/tap.sh

gcc=
for c in "$CC" gcc; do "$c" --version 2>/dev/null | grep -q 'Free Software' && gcc=$c && break; done
if [ -z "$gcc" ] || ! echo 'int main(void) { return 0; }' | $gcc -include quadmath.h -x c - -lquadmath -o "$TMP/quad" 2>/dev/null; then
  skip_all "there is no gcc with libquadmath"
fi
clang=${CLANG:-$(command -v clang)}

# measured NAME OPTIONS...: errors, to NAME.txt. The right values are gcc's; the header may be compiled by another compiler.
measured() {
  n=$1 c=$2
  shift 2
  $c -std=gnu11 -O2 -Wall -Wextra -Wno-psabi "$@" -I"$INC" -c tests/math/own.c -o "$TMP/own.o" &&
    $gcc -std=gnu11 -O2 -Wall -Wextra "$@" -Wno-psabi tests/math/ulp.c "$TMP/own.o" -I"$INC" -lquadmath -lm -o "$TMP/ulp" &&
    { "$TMP/ulp" "$points" >"$TMP/$n.txt" || { cat "$TMP/$n.txt"; return 1; }; }
}
same_sums() { # FILE FILE: those of the functions that are the same in lanes
  grep -v '^sin\|^cos' "$TMP/$1.txt" >"$TMP/a"
  grep -v '^sin\|^cos' "$TMP/$2.txt" | cmp - "$TMP/a"
}

# Processors that this one can run.
machines=x86-64
case $(uname -m) in
  x86_64 | amd64)
    grep -q ' avx2 .* \(erms\|bmi2\)' /proc/cpuinfo 2>/dev/null && grep -q ' fma ' /proc/cpuinfo && machines="$machines x86-64-v3"
    grep -q ' avx512dq ' /proc/cpuinfo 2>/dev/null && machines="$machines x86-64-v4"
    ;;
  *) machines= ;;
esac
[ -n "${SLOW:-}" ] || machines=${machines##* } # the one with the widest lanes
off=-ffp-contract=off
for m in ${machines:-this}; do
  march=
  [ "$m" = this ] || march=-march=$m
  check "$m: at most 1 unit in the last place, a double" measured "$m.1" "$gcc" $off $march
  check "$m: 4 lanes" measured "$m.4" "$gcc" $off $march -DLAG_LANES=4
  check "$m: 8 lanes" measured "$m.8" "$gcc" $off $march -DLAG_LANES=8
  check "$m: 4 and 8 lanes have the same bits" cmp "$TMP/$m.4.txt" "$TMP/$m.8.txt"
  check "$m: and those of a double, but for sin and cos" same_sums "$m.1" "$m.8"
  if [ -n "$clang" ]; then
    for lanes in ${SLOW:+1 4} 8; do
      only=
      [ $lanes = 1 ] || only=-DLAG_LANES=$lanes
      check "$m: clang, $lanes" measured "$m.clang$lanes" "$clang" $off $march $only
      check "$m: clang, $lanes: the same bits" cmp "$TMP/$m.$lanes.txt" "$TMP/$m.clang$lanes.txt"
    done
  else
    skip "$m: clang" "there is no clang"
  fi
  slow check "$m: contracted by the compiler" measured "$m.fast" "$gcc" -ffp-contract=fast -O3 $march
  slow check "$m: contracted, 8 lanes" measured "$m.fast8" "$gcc" -ffp-contract=fast -O3 $march -DLAG_LANES=8
done
cat "$TMP"/*.1.txt "$TMP"/*.8.txt | sed 's/^/# /' # shown where something fails

clean() { # COMPILER LANGUAGE STANDARD
  printf '#include "lag_math.h"\n%s\n' 'double f(double x); double f(double x) { double s, c; lag_sincos(x, &s, &c); lag_sincos2(s, &s, &c, x, &x, &s); lag_sincos4(s, &s, &c, x, &x, &s, c, &c, &x, 1, &x, &x); return s + lag_exp(c) + lag_log(x) + lag_rsqrt(x) + lag_sin(x) + lag_cos(x); }' >"$TMP/clean.c"
  $1 -x "$2" -std="$3" -O1 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -I"$INC" -c "$TMP/clean.c" -o "$TMP/clean.o"
}
for c in "$CC" $clang; do
  for s in c99 c11; do check "clean: $(basename "$c") $s" clean "$c" c $s; done
done
if [ -n "${CXX:-}" ]; then for s in c++11 c++17; do check "clean: $CXX $s" clean "$CXX" c++ $s; done
else skip "clean as C++" "no C++ compiler"; fi

# shellcheck disable=SC2043 # the first python3 that has mpmath
for python in python3 /usr/bin/python3; do
  $python -c 'import mpmath' 2>/dev/null || continue
  slow check "the coefficients are those of tests/math/remez.py" $python tests/math/remez.py "$INC/lag_math.h" "$INC/lag_sincos.h"
  break
done
tap_end
