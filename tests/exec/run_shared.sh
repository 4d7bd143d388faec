#!/bin/sh
# lagc build --shared: a position-independent library that shows lag_* only, and that a program links or opens; what is refused. shared.c is the program.
. tests/tap.sh
so=$TMP/lib/libspring.so
mkdir -p "$TMP/lib"
check "a shared library" "$LAGC" build models/spring.lag --shared --with linear -o "$so"
if command -v nm >/dev/null && command -v readelf >/dev/null; then
  empty "shows lag_* only" "$(nm -D --defined-only "$so" | awk '$3 !~ /^lag_/')"
  declared=$(sed -n '/#define LAG_VERSION/,$p' runtime/include/lag.h runtime/include/lag_method.h | grep -v '^typedef' | grep -oE '\blag_[a-z_0-9]+\(' | tr -d '(' | LC_ALL=C sort -u | grep -vxE 'lag_(png|hdf5)_write') # (in archives of their own)
  nm -D --defined-only "$so" | awk '{ print $3 }' >"$TMP/shown"
  empty "shows each function of lag.h" "$(printf '%s\n' "$declared" | grep -vxFf "$TMP/shown")"
  is "its name" "$(readelf -d "$so" | sed -n 's/.*soname: \[\(.*\)\]/\1/p')" libspring.so
  empty "no relocations in code" "$(readelf -d "$so" | grep TEXTREL)"
  empty "needs the C library only: no GSL" "$(readelf -d "$so" | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | grep -vE '^(libc|libm|ld-|libasan|libgcov|libubsan)')"
else skip "its symbols" "there is no readelf"; fi
check "another library" "$LAGC" build models/bouncing_ball.lag --shared -o "$TMP/lib/libball.so"
program() {
  $CC -std=c11 -I"$INC" -o "$TMP/program" tests/exec/shared.c -L"$TMP/lib" -lspring -ldl -lm && LD_LIBRARY_PATH=$TMP/lib "$TMP/program" "$TMP/lib/libball.so"
}
check "a program of both: rates, rows, tangent, batch, events" program
first=$("$LAGC" build models/spring.lag --shared)
check "without -o: the path of one in the cache" [ -s "$first" ]
is "the same again" "$first" "$("$LAGC" build models/spring.lag --shared)"
check "another one with another option" [ "$first" != "$("$LAGC" build models/spring.lag --shared --with linear)" ]

bad() {
  words=$1
  shift
  check "refused: build $*" says 2 "$words" "$LAGC" build models/spring.lag "$@"
}
bad 'write -o libNAME.so' --shared -o "$TMP/spring"
bad 'or --shared for a library' -o "$TMP/spring.so"
bad 'needs -o SIMULATOR'
bad 'leave --precision out' --shared --precision quad -o "$TMP/x.so"
check "a wrong model leaves no file" sh -c '"$1" build tests/golden/err/sem_unit_of_divisor.lag --shared -o "$2" 2>/dev/null; [ $? = 1 ] && [ ! -e "$2" ]' - "$LAGC" "$TMP/x.so"
tap_end
