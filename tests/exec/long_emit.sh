#!/bin/sh
# Emitted C with every compiler, and in every precision; headers run. run_emit.sh: with one compiler, in doubles; run_compilers.sh: headers in every standard.
part=16
. tests/exec/lib_emit.sh
# The first compiler of each kind.
gcc=
for c in "$CC" gcc; do "$c" --version 2>/dev/null | grep -q 'Free Software' && gcc=$c && break; done
clang=${CLANG:-$(command -v clang)}
compilers="$CC"
[ "$CC" = "$clang" ] || compilers="$compilers $clang"

for c in $compilers; do
  for s in c11 gnu17; do check "emitted C is clean with $(basename "$c"), $s" sources_clean "$c" $s; done
done
[ -n "$clang" ] || skip "emitted C is clean with clang" "there is no clang"
# ---- headers run
for c in $compilers; do
  for real in double float 'long double'; do check "headers run: $(basename "$c") c11 $real" runs "$c" c11 "$real"; done
done
check "headers run: c99 long double" runs "$CC" c99 'long double' -DC99_LONG_DOUBLE
check "headers run: c99 float" runs "$CC" c99 float
if command -v "$(cxx "$CC")" >/dev/null; then
  for real in double float 'long double'; do check "headers run: c++11 $real" runs "$(cxx "$CC")" c++11 "$real"; done
else
  skip "headers run as C++" "there is no C++ compiler"
fi

# ---- one text for every LAG_REAL
check "double: evaluated" evaluate double "$CC"
evaluate float "$CC" -DLAG_REAL=float '-DLAG_FN(x)=x##f'
check "float agrees to 1e-4" agree 1e-4 float
evaluate long "$CC" '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L'
check "long double agrees to 1e-12" agree 1e-12 long
echo '#include <quadmath.h>' >"$TMP/quad.h"
if [ -n "$gcc" ] && echo 'int main(void) { return 0; }' | "$gcc" -include "$TMP/quad.h" -x c - -lquadmath -o "$TMP/quad" 2>/dev/null; then
  evaluate quad "$gcc" -include "$TMP/quad.h" -DLAG_REAL=__float128 '-DLAG_FN(x)=x##q' '-DLAG_C(x)=x##Q'
  check "quadruple precision agrees to 1e-12" agree 1e-12 quad
else
  skip "quadruple precision agrees" "there is no libquadmath"
fi
# long_lanes.sh: vectors.
for c in $compilers; do
  [ "$c" != "$CC" ] || continue
  evaluate other "$c"
  check "the same bits by $(basename "$c")" cmp "$TMP/double.txt" "$TMP/other.txt"
done


# ---- the same bytes
same_bytes() { # LAGC
  rm -rf "$TMP/again"
  emit_all "$1" "$TMP/again" || return 1
  for f in "$TMP"/again/*.c; do cmp "$f" "$TMP/c/$(basename "$f")" || return 1; done
  for f in "$TMP"/again/*.h; do cmp "$f" "$TMP/h/$(basename "$f")" || return 1; done
}
check "two runs emit the same bytes" same_bytes "$LAGC"
if [ -n "${LAGC_CLANG:-}" ] && [ -x "$LAGC_CLANG" ]; then LAG_HOME=$LAG_TREE check "lagc built by clang emits the same bytes" same_bytes "$LAGC_CLANG"
else skip "lagc built by clang emits the same bytes" "there is no clang"; fi
tap_end
