#!/bin/sh
# The compiler's table of methods, src/base/method_rows.def, is the runtime's: names, options and needs.
#   BLESS=1 sh tests/golden/run_method_rows.sh      writes it anew, from a build with GSL
. tests/tap.sh
rows=src/base/method_rows.def
# shellcheck disable=SC2086 # lists of flags and libraries
"$CC" -std=c11 -I$INC -Iruntime ${GSL:+-DWITH_GSL} -o "$TMP/list_methods" tests/golden/list_methods.c $LIBLAG $LIBLAG $LIBS >"$TMP/log" 2>&1 || cat "$TMP/log"
"$TMP/list_methods" >"$TMP/rows"
if [ -n "${BLESS:-}" ] && [ -n "$GSL" ]; then cp "$TMP/rows" "$rows"; fi
if [ -n "$GSL" ]; then cp "$rows" "$TMP/want"; else sed '/^#ifdef/,/^#endif/d' "$rows" >"$TMP/want"; fi
empty "the compiler's methods are the runtime's" "$(diff "$TMP/want" "$TMP/rows")"
tap_end
