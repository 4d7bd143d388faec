#!/bin/sh
# Momenta over 10^6 steps: tests/unit/test_rt_variational.c, optimised and with the runtime that users get.
: "${CC:=cc}" "${INC:=runtime/include}" "${LIBLAG:=build/liblag.a}" "${LIBS:=-lm}" "${TMP:=$(mktemp -d)}"
# shellcheck disable=SC2086 # lists
$CC -std=gnu11 -O2 -w -D_XOPEN_SOURCE=700 -I"$INC" -Iruntime -ffp-contract=off tests/unit/test_rt_variational.c $LIBLAG \
  $LIBS -lcmocka -o "$TMP/variational" || exit 1
LAG_STEPS=1000000 "$TMP/variational"
