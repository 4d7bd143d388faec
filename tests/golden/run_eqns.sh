#!/bin/sh
# Golden tests of the equations as people read them: of models/NAME.lag, or of its scene S (NAME.S.expected),
#   lagc derive                must print tests/golden/eqns/NAME.expected
#   lagc derive --hamiltonian                      hamilton/
#   lagc noether                                   noether/
# and of NAME.latex.expected, with --format latex. A new test is a new (empty) file; then
#   BLESS=1 sh tests/golden/run_eqns.sh      rewrites the expectations, on purpose
. tests/tap.sh
prints() { # prints FOLDER COMMAND [OPTION]
  for want in tests/golden/"$1"/*.expected; do
    [ -f "$want" ] || continue
    name=$(basename "$want" .expected)
    scene=${name#"${name%%.*}"}
    scene=${scene#.}
    format=
    case $scene in latex) scene=; format=latex ;; esac
    golden "$1/$name" "$want" 0 "$LAGC" "$2" "models/${name%%.*}.lag" ${scene:+"$scene"} ${3:+"$3"} ${format:+--format "$format"}
  done
}
prints eqns derive
prints hamilton derive --hamiltonian
prints noether noether
tap_end
