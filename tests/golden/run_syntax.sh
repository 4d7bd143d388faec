#!/bin/sh
# Golden tests of the front end, as TAP. Each is two files:
#   tests/golden/ast/NAME.lag + NAME.expected   the listing of its Ast
#   tests/golden/err/NAME.lag + NAME.expected   the messages, exactly as printed
# Files of golden/err whose name begins with `syntax_` (and `include_`) belong to the front end.
#   sh tests/golden/run_syntax.sh [DUMP]   DUMP: the built tests/unit/dump_syntax.c
#   BLESS=1 rewrites the expectations, on purpose.
cd "$(dirname "$0")/../.." || exit 2
dump=${1:-${BIN:-build/test/bin}/dump_syntax}
got=${TMPDIR:-/tmp}/golden_syntax.$$
trap 'rm -f "$got"' EXIT
n=0
failed=0

for lag in tests/golden/ast/*.lag tests/golden/err/syntax_*.lag tests/golden/err/include_*.lag; do
  [ -f "$lag" ] || continue
  n=$((n + 1))
  want=${lag%.lag}.expected
  case $lag in tests/golden/ast/*) status=0 ;; *) status=1 ;; esac
  "$dump" "$lag" >"$got" 2>&1
  code=$?
  if [ -n "$BLESS" ] && [ "$code" = "$status" ]; then cp "$got" "$want"; fi
  if [ "$code" = "$status" ] && cmp -s "$got" "$want"; then
    echo "ok $n - $lag"
  else
    failed=$((failed + 1))
    echo "not ok $n - $lag"
    [ "$code" = "$status" ] || echo "# exit status $code, expected $status"
    diff -u "$want" "$got" | sed 's/^/# /'
  fi
done
echo "1..$n"
[ "$failed" = 0 ]
