#!/bin/sh
# lagc orbit --manifold: the separatrix of a pendulum against its closed form; heteroclinic connections of
# the restricted problem, published; refusals.
. tests/tap.sh
needs_gsl
LAGC_OPTIMISE=-O0
export LAGC_OPTIMISE

orbit() { "$LAGC" orbit "$@" >"$TMP/out" 2>"$TMP/err" || cat "$TMP/err" >&2; }

# From the upper rest th' = +-2 sqrt(g/l) cos(th/2), forwards and backwards; a start 1e-6 beside it has an energy that is off by 1e-11, 0.3e-12 of th'
orbit models/pendulum.lag wide th=3.1 --equilibrium --manifold both -o "$TMP/rows.csv" --svg "$TMP/picture.svg"
is "a pendulum: runs" "stable -1 201;stable 1 201;unstable -1 201;unstable 1 201;" "$(awk -F, 'NR > 1 { n[$1 " " $3]++ } END { for (k in n) print k, n[k] ";" }' "$TMP/rows.csv" | sort | tr -d '\n')"
near "a pendulum: separatrix" 1e-11 0 "$(awk -F, 'NR > 1 { d = $6^2 - 4*9.81*cos($5/2)^2; d = d < 0 ? -d : d; if (d > most) most = d } END { printf "%.3g", most }' "$TMP/rows.csv")"
check "a pendulum: stable ones run backwards" awk -F, '$1 == "stable" && $4 > 0 { exit 1 }' "$TMP/rows.csv"
check "a pendulum: picture" grep -q "unstable" "$TMP/picture.svg"
orbit models/pendulum.lag wide th=3.1 --equilibrium --manifold unstable --section 'th crossing' -o "$TMP/rows.csv"
near "a pendulum: crosses the lowest place" 1e-11 6.26418390534633 "$(awk -F, 'NR == 2 { printf "%.15g", $6 < 0 ? -$6 : $6 }' "$TMP/rows.csv")" # 2 sqrt(9.81)

# Each direction is the eigenvector at its place: over a period, here a planar Lyapunov orbit's about L1 of Earth and Moon, it grows by the multiplier,
# 2360.866 (run_orbit.sh), backwards along stable ones; half of the difference of both sides is linear but for (0.002/0.05)^2 = 0.2 % of the motion's size
orbit models/cr3bp.lag departure mu=0.01215058560962404 x=0.823385182 "y'=0.1263" --guess 2.743 --hold x --reverse y=-y --tol 1e-12 --manifold both:8 \
  --follow 2.743045609427481 -o "$TMP/rows.csv"
is "a periodic motion: rows" 6432 "$(awk 'END { print NR - 1 }' "$TMP/rows.csv")" # 2 manifolds, 8 places, 2 sides, 201 times
check "a periodic motion: directions" awk -F, '
  NR == 1 { next }
  !(($1, $2, $3) in first) { first[$1, $2, $3] = 1; x[$1, $2, $3] = $5; y[$1, $2, $3] = $6 }
  { ex[$1, $2, $3] = $5; ey[$1, $2, $3] = $6; both[$1 SUBSEP $2] = 1 }
  function length_of(x, y, k) { return sqrt((x[k, 1] - x[k, -1])^2 + (y[k, 1] - y[k, -1])^2) }
  END { for (k in both) { n++; r = length_of(ex, ey, k)/length_of(x, y, k)/2360.866 - 1; if (r > 0.01 || r < -0.01) bad++ } exit !(n == 16 && !bad) }' "$TMP/rows.csv"

connections() {
  # W. S. Koon, M. W. Lo, J. E. Marsden, S. D. Ross, Chaos 10 (2000) 427: Sun and Jupiter, C = 3.037: at x = 1 - mu the second cuts of the unstable
  # manifold of the Lyapunov orbit about L1 and of the stable one of that about L2 cross in two points
  tube() {
    orbit models/cr3bp.lag departure mu=0.0009537 "$@" --reverse y=-y --hold energy --tol 1e-12 --section 'x - 1 + mu crossing' --follow 7
  }
  tube x=0.925566255520263 "y'=0.05603763826396633" --guess 2.9323 --manifold unstable:40 -o "$TMP/from.csv"
  tube x=1.0609578327695723 "y'=0.044639197338073554" --guess 3.19656 --manifold stable:40 -o "$TMP/to.csv"
  is "heteroclinic connections from L1 to L2" 2 "$(awk -F, '
    function side(a, b, c) { return (y[b] - y[a])*(v[c] - v[a]) - (v[b] - v[a])*(y[c] - y[a]) }
    FNR == 1 { file++ }
    FNR > 1 && $3 == (file == 1 ? 1 : -1) && ++cut[file, $2] == 2 { k = file " " n[file]++; y[k] = $6; v[k] = $8 }
    END {
      for (i = 0; i < n[1]; i++) for (j = 0; j < n[2]; j++) {
        a = "1 " i; b = "1 " (i + 1)%n[1]; c = "2 " j; d = "2 " (j + 1)%n[2]
        found += side(a, b, c)*side(a, b, d) < 0 && side(c, d, a)*side(c, d, b) < 0
      }
      print found + 0
    }' "$TMP/from.csv" "$TMP/to.csv")"
}
slow connections

refused() {
  case_words=$1
  shift
  check "refused: $case_words" says "$@"
}
refused "another word" 2 "write unstable, stable or both" "$LAGC" orbit models/pendulum.lag wide --manifold none -o "$TMP/a.csv"
refused "no file" 2 "the runs need a file" "$LAGC" orbit models/pendulum.lag wide --manifold both
refused "no manifold" 2 "are for --manifold" "$LAGC" orbit models/pendulum.lag wide -o "$TMP/a.csv"
refused "nothing unstable" 3 "has no such direction" "$LAGC" orbit models/pendulum.lag wide --manifold both -o "$TMP/a.csv"
refused "a section that is not met" 3 "no run along the manifold crosses it" "$LAGC" orbit models/pendulum.lag wide th=3.1 --equilibrium --manifold both --section "th' - 50 [rad/s] rising" -o "$TMP/a.csv"
refused "a time of no length" 2 "a time above 0" "$LAGC" orbit models/pendulum.lag wide th=3.1 --equilibrium --manifold both --follow -3 -o "$TMP/a.csv"
tap_end
