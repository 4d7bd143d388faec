#!/bin/sh
# Golden tests of the equations as people read them, as TAP: of models/NAME.lag, or of its scene S (NAME.S.expected),
#   lagc derive                must print tests/golden/eqns/NAME.expected
#   lagc derive --hamiltonian                      hamilton/
#   lagc noether                                   noether/
# and of NAME.latex.expected, with --format latex. A new test is a new (empty) file; then
#   BLESS=1 sh tests/golden/run_eqns.sh      rewrites the expectations, on purpose
cd "$(dirname "$0")/../.." || exit 2
: "${LAGC:=build/lagc}"
got=$(mktemp) || exit 2
trap 'rm -f "$got"' EXIT
n=0
failed=0
prints() { # prints FOLDER COMMAND [OPTION]
  for want in tests/golden/"$1"/*.expected; do
    [ -f "$want" ] || continue
    n=$((n + 1))
    name=$(basename "$want" .expected)
    scene=${name#"${name%%.*}"}
    scene=${scene#.}
    format=
    case $scene in latex) scene=; format=latex ;; esac
    "$LAGC" "$2" "models/${name%%.*}.lag" ${scene:+"$scene"} ${3:+"$3"} ${format:+--format "$format"} >"$got" 2>&1
    code=$?
    if [ -n "${BLESS:-}" ] && [ "$code" = 0 ]; then cp "$got" "$want"; fi
    if [ "$code" = 0 ] && cmp -s "$got" "$want"; then
      echo "ok $n - $1/$name"
    else
      failed=$((failed + 1))
      echo "not ok $n - $1/$name"
      [ "$code" = 0 ] || echo "# exit status $code, expected 0"
      diff -u "$want" "$got" | sed 's/^/# /'
    fi
  done
}
prints eqns derive
prints hamilton derive --hamiltonian
prints noether noether
echo "1..$n"
[ "$failed" = 0 ]
