#!/bin/sh
# lagc orbit --manifold, --to: the separatrix of a pendulum against its closed form; heteroclinic connections of
# the restricted problem, published and by SciPy; refusals.
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

# A section is met in one direction of time by both manifolds: both cross the lowest place upwards
orbit models/pendulum.lag wide th=3.1 --equilibrium --manifold both --section 'th rising' -o "$TMP/rows.csv"
is "a pendulum: rises through the lowest place" "stable 1;unstable 1;" "$(awk -F, 'NR > 1 && $6 > 0 { n[$1]++ } NR > 1 && $6 < 0 { n["falls"]++ } END { for (k in n) print k, n[k] ";" }' "$TMP/rows.csv" | sort | tr -d '\n')"

# W. S. Koon, M. W. Lo, J. E. Marsden, S. D. Ross, Chaos 10 (2000) 427: Sun and Jupiter, C = 3.037: at x = 1 - mu the second cuts of the unstable
# manifold of the Lyapunov orbit about L1 and of the stable one of that about L2 cross in two points; places by SciPy's DOP853 at 3e-14 and fsolve,
# from 1e-6 beside the orbits. Allowed: 1e-9, as the rounding of starts grows
{ cat models/cr3bp.lag && printf "\nscene at_L2 {\n like departure\n mu = 0.0009537\n start x = 1.0609578327695723, y' = 0.044639197338073554\n span 3.2\n}\n"; } >"$TMP/two.lag"
connect() { "$LAGC" orbit "$TMP/two.lag" departure mu=0.0009537 x=0.925566255520263 "y'=0.05603763826396633" --reverse y=-y --hold energy --to at_L2 --section "$@"; }
connect 'x - 1 + mu falling' --follow 6.2 --json >"$TMP/json"
state() { sed 's/{"before"/\n&/g' "$TMP/json" | grep '^{"before"' | sed -n "$1s/.*\"$2\": \([^,}]*\).*/\1/p"; }
is "heteroclinic connections from L1 to L2" 2 "$(grep -o '"before"' "$TMP/json" | wc -l | tr -d ' ')"
near "first: y" 1e-9 0.0411411066519575 "$(state 1 y)"
near "first: x'" 1e-9 -0.0527609804022428 "$(state 1 "x'")"
near "first: y'" 1e-9 -0.0610026718818242 "$(state 1 "y'")"
near "second: y" 1e-9 0.0422374228044829 "$(state 2 y)"
near "second: y'" 1e-9 -0.0134478298654067 "$(state 2 "y'")"
# the scene to paste arrives: a run from the section comes as near to the orbit about L2, whose start it passes, as growth from 1e-9 allows
connect 'x - 1 + mu falling' --follow 6.2 -o "$TMP/path.csv" --svg "$TMP/path.svg" | sed -n '/^scene connection_1/,/^}/p' | cat "$TMP/two.lag" - >"$TMP/arrives.lag"
"$LAGC" run "$TMP/arrives.lag" connection_1 --tol 1e-13 --every 0.001 -o "$TMP/arrives.csv" --quiet
near "it arrives" 1e-4 0 "$(awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } NR > 1 { d = sqrt(($at["x"] - 1.0609578327695723)^2 + $at["y"]^2); if (NR == 2 || d < least) least = d } END { print least }' "$TMP/arrives.csv")"
is "both halves meet" 2 "$(awk -F, 'NR > 1 && $4 == 0 { k = $2 OFS $5 OFS substr($6, 1, 9); n[k]++ } END { for (k in n) if (n[k] == 2) c++; print c }' "$TMP/path.csv")"
# on longer ones rounding grows to some 1e-8 where two runs meet: parts of them meet to 1e-10
long_ones() {
  connect 'x - 1 + mu falling' --follow 8 --json | sed 's/{"before"/\n&/g' | sed -n 's/.*"residual": \([^,]*\),.*"x": \([^,]*\),.*/\1 \2/p' >"$TMP/long"
  check "long connections" awk '!($1 < 1e-9) || ($2 - 1 + 0.0009537)^2 > 1e-20 { bad = 1 } END { exit bad || NR < 6 }' "$TMP/long"
}
slow long_ones
# the same beside 31 oscillators at rest: states of 66 numbers
mv "$TMP/two.lag" "$TMP/alone.lag"
sed "s/^lagrangian = .*/coord r[31]\n& + sum(i in 1..31, r[i]'^2\/2 - (3 + 0.037*i)^2*r[i]^2\/2)/" "$TMP/alone.lag" >"$TMP/two.lag"
connect 'x - 1 + mu falling' --follow 6.2 --json >"$TMP/json"
near "beside 31 oscillators: y" 1e-9 0.0422374228044829 "$(state 2 y)"
near "... y'" 1e-9 -0.0134478298654067 "$(state 2 "y'")"
mv "$TMP/alone.lag" "$TMP/two.lag"
check "picture of paths" grep -q '<svg' "$TMP/path.svg"

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
refused "no section" 2 "where they cross a section" "$LAGC" orbit "$TMP/two.lag" departure --to at_L2
refused "no such scene" 1 "unknown scene" "$LAGC" orbit "$TMP/two.lag" departure --to at_L3 --section 'x rising'
refused "no scene to begin with" 2 "name the scene to begin with" "$LAGC" orbit "$TMP/two.lag" --to at_L2 --section 'x rising'
refused "other values" 2 "write one for both: mu=VALUE" "$LAGC" orbit "$TMP/two.lag" departure x=0.82 "y'=0.15" --reverse y=-y --to at_L2 --section 'x rising'
refused "another energy" 3 "is conserved" "$LAGC" orbit "$TMP/two.lag" departure mu=0.0009537 x=0.92 "y'=0.09" --reverse y=-y --hold x --guess 3 --to at_L2 --section 'x rising'
refused "no crossing" 3 "do not meet in the section" connect 'x - 1 + mu falling' --follow 3
refused "a time of no length" 2 "a time above 0" "$LAGC" orbit models/pendulum.lag wide th=3.1 --equilibrium --manifold both --follow -3 -o "$TMP/a.csv"
tap_end
