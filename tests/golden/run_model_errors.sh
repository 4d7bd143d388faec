#!/bin/sh
# Golden tests of what a model may not mean, as TAP: `lagc check` of tests/golden/err/model_NAME.lag fails with status 1 and
# prints model_NAME.expected, exactly. A new test is these two files; BLESS=1 rewrites the expectations, on purpose.
cd "$(dirname "$0")/../.." || exit 2
: "${LAGC:=build/lagc}"
got=$(mktemp) || exit 2
trap 'rm -f "$got"' EXIT
n=0
failed=0
for lag in tests/golden/err/model_*.lag; do
  n=$((n + 1))
  want=${lag%.lag}.expected
  "$LAGC" check "$lag" >"$got" 2>&1
  code=$?
  if [ -n "${BLESS:-}" ] && [ "$code" = 1 ]; then cp "$got" "$want"; fi
  if [ "$code" = 1 ] && cmp -s "$got" "$want"; then
    echo "ok $n - $lag"
  else
    failed=$((failed + 1))
    echo "not ok $n - $lag"
    [ "$code" = 1 ] || echo "# exit status $code, expected 1"
    diff -u "$want" "$got" | sed 's/^/# /'
  fi
done
echo "1..$n"
[ "$failed" = 0 ]
