#!/bin/sh
# Golden tests of the equations as people read them, as TAP: `lagc derive` of models/NAME.lag must print
# tests/golden/eqns/NAME.expected, and of its scene S NAME.S.expected. A new test is a new (empty) file; then
#   BLESS=1 sh tests/golden/run_eqns.sh      rewrites the expectations, on purpose
cd "$(dirname "$0")/../.." || exit 2
: "${LAGC:=build/lagc}"
got=$(mktemp) || exit 2
trap 'rm -f "$got"' EXIT
n=0
failed=0
for want in tests/golden/eqns/*.expected; do
  [ -f "$want" ] || continue
  n=$((n + 1))
  name=$(basename "$want" .expected)
  scene=${name#"${name%%.*}"}
  scene=${scene#.}
  "$LAGC" derive "models/${name%%.*}.lag" ${scene:+"$scene"} >"$got" 2>&1
  code=$?
  if [ -n "${BLESS:-}" ] && [ "$code" = 0 ]; then cp "$got" "$want"; fi
  if [ "$code" = 0 ] && cmp -s "$got" "$want"; then
    echo "ok $n - $name"
  else
    failed=$((failed + 1))
    echo "not ok $n - $name"
    [ "$code" = 0 ] || echo "# exit status $code, expected 0"
    diff -u "$want" "$got" | sed 's/^/# /'
  fi
done
echo "1..$n"
[ "$failed" = 0 ]
