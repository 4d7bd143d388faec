#!/bin/sh
# Golden tests of false expectations, and of other models that only `lagc check` refuses, as TAP: for tests/golden/err/expect_NAME.lag and
# check_NAME.lag it fails with status 1 and prints NAME.expected, exactly. A new test is these two files; BLESS=1 rewrites the expectations, on purpose.
. tests/tap.sh

# The verdicts come first, then the messages.
run() {
  "$LAGC" check "$1" >"$TMP/out" 2>"$TMP/messages"
  code=$?
  cat "$TMP/messages" >>"$TMP/out"
}
golden() {
  run "$1"
  [ -z "${BLESS:-}" ] || [ "$code" != 1 ] || cp "$TMP/out" "${1%.lag}.expected"
  [ "$code" = 1 ] || echo "exit status $code, expected 1"
  diff -u "${1%.lag}.expected" "$TMP/out" && [ "$code" = 1 ]
}
for lag in tests/golden/err/expect_*.lag tests/golden/err/check_*.lag; do
  check "$lag" golden "$lag"
done

# Names in a listing are unique.
twice() { "$LAGC" derive tests/exec/models/chain4.lag | sed -n '/^where/,/^$/s/^  \([^ ]*\) = .*/\1/p' | sort | uniq -d; }
listed() { "$LAGC" derive tests/exec/models/chain4.lag | grep -c '^  d_'; }
empty "derivatives of lets have names of their own" "$(twice)"
check "some are listed" [ "$(listed)" -gt 2 ]

# With 14 coordinates and 13 lets with primes: a rate and a force for each let, and an equation for each coordinate.
equations() { "$LAGC" derive tests/exec/models/many.lag | sed -n '/^equations of motion/,/^$/p' | grep -c ' = '; }
check "no equation is left out" [ "$(equations)" = 40 ]

allowed() { "$LAGC" check --allow-numeric tests/golden/err/expect_undecided.lag 2>&1 | grep -q 'warning: expect th'; }
check "--allow-numeric: a warning" allowed
refused() { ! "$LAGC" check --allow-numeric tests/golden/err/expect_rod.lag >"$TMP/rod" 2>&1 && grep -q '(million): refuted' "$TMP/rod"; }
check "--allow-numeric: what differs by a part in a million is refuted" refused
check "--allow-numeric: exit status 0" "$LAGC" check --allow-numeric tests/golden/err/expect_undecided.lag

if [ -n "$LAGC_CLANG" ]; then
  same() {
    run tests/golden/err/expect_double_pendulum.lag
    "$LAGC_CLANG" check tests/golden/err/expect_double_pendulum.lag >"$TMP/clang" 2>"$TMP/clang_messages"
    cat "$TMP/clang_messages" >>"$TMP/clang"
    diff "$TMP/out" "$TMP/clang"
  }
  check "built by clang: the same messages" same
else
  slow skip "built by clang: the same messages" "no clang"
fi
tap_end
