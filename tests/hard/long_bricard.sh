#!/bin/sh
# Bricard's mechanism: five rods in a loop of six hinges, one constraint too many and one degree of freedom all the same. Two models that share
# nothing but the problem (rigid bodies by rotations; ends of rods and axes of hinges), two methods of different kind, invariants, and
#
# - the motion itself: by threefold symmetry the angles of the hinges are -a and b in turn, and the loop is closed where
#   sin a sin b + sin a - sin b = 0 (Y. Chen, Z. You, T. Tarnai, Int. J. Solids Struct. 42 (2005) 2287). This leaves one equation
#   I(u) u'' + I'(u) u'^2/2 + V'(u) = 0 along the curve; SymPy formed I and V, and two orders of Gragg's extrapolation with 30
#   digits solve it and agree to 20 digits and more;
# - the multipliers at the start, where all is rational: the least of all that the equations allow, by SymPy.
. tests/tap.sh
bodies=tests/hard/cases/bricard.lag points=tests/hard/cases/bricard_points.lag

within() { # GOT EXPECTED TOLERANCE, the numbers a word each
  awk -v a="$1" -v b="$2" -v tol="$3" 'BEGIN { n = split(a, x, " "); m = split(b, y, " "); if (m == 0 || n != m) exit 1
    for (i = 1; i <= m; i++) { d = x[i] - y[i]; print "off by", d; if (!(d <= tol && -d <= tol)) bad = 1 }; exit bad }'
}
run() { # NAME MODEL OPTIONS...
  run_name=$1
  shift
  "$LAGC" run "$@" --json -o "$TMP/$run_name.csv" >"$TMP/$run_name.json"
}
row() { awk -F, -v t="$2" -v n="${3:-10}" '$1 == t { for (i = 2; i <= n; i++) printf "%s ", $i }' "$TMP/$1.csv"; } # P1, P2, P3
value() { sed -n "s/.*\"$2\": \([-+0-9.e]*\).*/\1/p" "$TMP/$1.json"; }
below() { awk -v x="$1" -v most="$2" 'BEGIN { print x; exit !(x <= most && -x <= most) }'; }

# ---- redundant constraints ----
"$LAGC" check $bodies >"$TMP/bodies.txt"
"$LAGC" check $points >"$TMP/points.txt"
check "bodies: one degree of freedom" grep -q '^scene go: 1 degree of freedom; 35 constraints, of rank 34 at the start$' "$TMP/bodies.txt"
check "points: one degree of freedom" grep -q '^scene go: 1 degree of freedom; 24 constraints, of rank 23 at the start$' "$TMP/points.txt"
check "bodies: what is redundant is named" grep -q 'constraint fork\[5\] .* follows from the constraints before it; its multiplier is not unique' "$TMP/bodies.txt"
check "points: what is redundant is named" grep -q 'constraint twist\[5\] .* follows from the constraints before it; its multiplier is not unique' "$TMP/points.txt"
is "and all reactions in the loop, but not the lengths of axes" "20 0" \
  "$(grep -c 'not unique' "$TMP/points.txt") $(grep 'unit\[' "$TMP/points.txt" | grep -c 'not unique')"

# ---- the motion ----
wide_1='0.510501461187219735922034 0 -0.859876885446814171736248 0.274481319264623041216913 -0.886707938734672018281166 -0.462330002687376038073978
  0.510501461187219735922034 -1.64916759939480630807513 0.140123114553185828263752'
wide_10='0.999999963806349409210433 0 -0.000269048880078692745537595 0.999730987303835346514559 -0.999999963825817274814099 -0.000268976512249304597354664
  0.999999963806349409210433 -1.00026901269616334420966 0.999730951119921307254462'
thin_1='0.508664760230061679520388 0 -0.860964669251935019232903 0.273333915809660808871529 -0.886544000791979019045561 -0.462644285234078628461303
  0.508664760230061679520388 -1.64982706321113245292341 0.139035330748064980767097'
thin_10='0.999999729401917774794708 0 -0.000735660309672262038560924 0.999264610089414863674628 -0.999999729799615457127541 -0.000735119511424841117972464
  0.999999729401917774794708 -1.00073538991051202059973 0.999264339690327737961439'
# 200 steps at 1e-12 allow for 2e-10; a tenth of it
check "bodies run for 10 s" run wide $bodies go
check "bodies: digits at 1 s" within "$(row wide 1)" "$wide_1" 2e-11
check "bodies: digits at 10 s" within "$(row wide 10)" "$wide_10" 2e-11
check "thin bodies run" run thin $bodies slender
check "thin bodies: digits at 10 s" within "$(row thin 10)" "$thin_10" 2e-11
check "points run for 10 s" run points $points
check "points: digits at 1 s" within "$(row points 1)" "$thin_1" 2e-11
check "points: digits at 10 s" within "$(row points 10)" "$thin_10" 2e-11
for k in wide points; do
  # The start's potential energy is 29.43 J; 200 steps at 1e-12 allow for 2e-10.
  check "$k: energy" below "$(value $k energy_drift)" 1e-12
  check "$k: on the constraints" within "$(value $k constraint_residual) $(value $k constraint_rate_residual)" "0 0" 1e-14
  # Off the constraints, redundant ones contradict each other: accelerations evaluated there cost 1e4 steps, a third of them rejected.
  check "$k: steps as long as the motion allows" below "$(value $k steps)" 300
  check "$k: none is rejected" below "$(value $k rejected)" 10
done

# ---- another method ----
# Order 2: an error of 1.5e-5 at 0.02 s becomes a quarter at 0.01 s, and their extrapolation to step 0 is of order 4.
check "variational, 0.02 s" run coarse $bodies --method variational --step 0.02 --until 1
check "variational, 0.01 s" run fine $bodies --method variational --step 0.01 --until 1
limit() { echo "$(row fine 1) $(row coarse 1)" | awk '{ for (i = 1; i <= 9; i++) printf "%.17g ", (4*$i - $(i + 9))/3 }'; }
check "variational leads to the same motion" within "$(limit)" "$wide_1" 1e-6
check "but is another one" sh -c '! "$@"' sh awk -v a="$(row fine 1)" -v b="$wide_1" 'BEGIN { split(a, x, " "); split(b, y, " "); exit !((x[1] - y[1])^2 < 1e-12) }'
check "variational: on the constraints" within "$(value fine constraint_residual) $(value fine constraint_rate_residual)" "0 0" 1e-14

# Axes of hinges have no inertia; constraints move them.
check "points by variational" run hinges $points --method variational --step 0.005 --until 0.5
check "on the constraints" within "$(value hinges constraint_residual) $(value hinges constraint_rate_residual)" "0 0" 1e-14
check "with their energy, 8e-8 at 0.001 s and as step^2" below "$(value hinges energy_drift)" 2e-6

# ---- multipliers ----
least='-34989/13000 36951/1625 -48723/13000 -6867/3250 -84039/13000 -6867/3250 -65727/13000 48723/13000 -981/13000 -48723/13000 44799/13000
  -65727/13000 5559/3250 -65727/13000 2943/1625 -44799/13000 -94503/13000 44799/13000 -5559/1625 2943/1625'
least=$(echo "$least" | awk '{ for (i = 1; i <= NF; i++) { split($i, x, "/"); printf "%.17g ", x[1]/x[2] } }')
observed=$(for i in 1 2 3 4 5; do for k in rod first last twist; do printf -- '--observe lambda(%s[%d]) ' $k $i; done; done)
# shellcheck disable=SC2086 # a list of words
check "points: with multipliers" run least $points $observed --until 0.5
check "points: the least multipliers" within "$(awk -F, '$1 == "0" { for (i = 12; i <= 31; i++) printf "%s ", $i }' "$TMP/least.csv")" "$least" 1e-12

# The constraints in another order, and multiplied by other factors
sed 's/dot(n\[i-1\], n\[i\]) = 0/1000*dot(n[i-1], n[i]) = 0/; s/dot(n\[i\], n\[i\]) = 1 }/0.01*dot(n[i], n[i]) = 0.01 }/
  /constraint rod/{h;d;}; /constraint twist/{G;}' $points >"$TMP/other.lag"
check "constraints rewritten" grep -q '1000\*dot' "$TMP/other.lag"
check "and run" run other "$TMP/other.lag"
check "the motion does not depend on how they are written" within "$(row other 10)" "$(row points 10)" 1e-12
tap_end
