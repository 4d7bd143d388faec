#!/bin/sh
# The Lagrange points of models/cr3bp.lag, found by `lagc modes` from 0.01 beside them, and the squares of their characteristic
# exponents. Expected: roots of Euler's equation of degree 5 and of the characteristic equation, in 45 digits.
. tests/tap.sh
[ -n "$GSL" ] || skip_all "lagc modes needs GSL"

modes() { "$LAGC" modes models/cr3bp.lag departure "mu=$1" "x=$2" "y=$3" --json >"$TMP/out.json" 2>"$TMP/err"; }
equilibrium() { sed -n 's/.*"equilibrium": {"x": \([^,]*\), "y": \([^}]*\)}.*/\1 \2/p' "$TMP/out.json"; }
squares() { # squares of the exponents, a line each: re^2 - im^2
  grep -o '"re": [^,]*, "im": [^,]*' "$TMP/out.json" | awk '{ gsub(/,/, ""); print $2^2 - $4^2 }' OFMT=%.17g
}
near() { # GOT EXPECTED TOLERANCE: lists of numbers
  echo "$1 against $2"
  echo "$1 $2" | awk -v tol="$3" '{ if (NF == 0 || NF % 2) exit 1
    for (i = 1; i <= NF/2; i++) { d = $i - $(i + NF/2); if (!(d <= tol && -d <= tol)) exit 1 } }'
}
point() { # NAME MU X Y EXPONENTS...
  name="$1, mu = $2" mu=$2 x=$3 y=$4
  shift 4
  check "$name: found" modes "$mu" "$(echo "$x" | awk '{ print $1 + 0.01 }' OFMT=%.17g)" "$y"
  check "$name: where it is" near "$(equilibrium)" "$x $y" 1e-13
  [ $# = 0 ] || check "$name: exponents" near "$(squares | sort -g | tr '\n' ' ')" "$*" 2e-12
}
s3=0.8660254037844386467637232
point L1 0.012150585609624 0.8369151257723573513650754 0 -5.449357460490216615424 8.596951998006098270937
point L2 0.012150585609624 1.155682165444883968161768 0
point L3 0.012150585609624 -1.005062645810277826297183 0
point L4 0.012150585609624 0.487849414390376 $s3 -0.9110718855224368325399 -0.08892811447756316746014
point L1 0.012277471 0.8362925908999327172358459 0 -5.453965313952652095414 8.606136873268852309296
point L2 0.012277471 1.156168165905524721778467 0
point L3 0.012277471 -1.005115511606891843003897 0
point L4 0.012277471 0.487722529 $s3 -0.9100543143725620243215 -0.08994568562743797567851
point L1 0.3 0.2861297820506890144595634 0 -8.021048888232375392286 13.72917929462400842456
point L2 0.3 1.256734695811981861691367 0
point L3 0.3 -1.123205595880868176165536 0
point L4 0.3 0.2 $s3 -0.5                # squares -0.5 +- 1.08 i: one mode that grows and swings
tap_end
