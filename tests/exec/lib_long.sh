# shellcheck shell=sh
# Unit tests of the runtime over 10^6 steps, optimised and with the runtime that users get: long NAME for tests/unit/test_NAME.c.
: "${CC:=cc}" "${INC:=runtime/include}" "${LIBLAG:=build/liblag.a}" "${LIBS:=-lm}" "${TMP:=$(mktemp -d)}"
long() {
  # shellcheck disable=SC2086 # lists
  $CC -std=gnu11 -O2 -w -D_XOPEN_SOURCE=700 -I"$INC" -Iruntime -ffp-contract=off "tests/unit/test_$1.c" $LIBLAG $LIBS -lcmocka -o "$TMP/$1" || exit 1
  LAG_STEPS=1000000 "$TMP/$1"
}
