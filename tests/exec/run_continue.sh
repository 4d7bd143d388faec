#!/bin/sh
# lagc continue: folds and bifurcations against closed forms, published energies and SciPy; families of periodic motions; rows, picture; refusals.
. tests/tap.sh
needs_gsl
LAGC_OPTIMISE=-O0
export LAGC_OPTIMISE
dir=tests/exec/orbits

follow() {
  title="$*"
  "$LAGC" continue "$@" --json >"$TMP/json" 2>"$TMP/err" || cat "$TMP/err" >&2
  sed 's/{"kind"/\n&/g' "$TMP/json" | grep '^{"kind"' >"$TMP/points"
}
kinds() { is "$title: kinds" "$1" "$(sed 's/^{"kind": "\([^"]*\)".*/\1/' "$TMP/points" | tr '\n' ';')"; }
of_point() { sed -n "$1s/.*\"$2\": \([^,}]*\).*/\1/p" "$TMP/points"; }
close() { near "$title: point $1, $2" "$4" "$3" "$(of_point "$1" "$2")"; } # NUMBER MEMBER EXPECTED TOLERANCE

# pitchfork of the bead at w = sqrt(g/R); the other branch: cos(th) = g/(w^2 R)
follow models/bead_on_hoop.lag slow th=0 w=1..8 --branches -o "$TMP/bead.csv" --svg "$TMP/bead.svg"
kinds "branch point;end;end;end;end;"
close 1 parameter 4.42944691807002 1e-11
near "$title: the branch that leaves" 1e-11 1.2592167912414885 "$(of_point 4 th | tr -d -)" # acos(9.81/32)
check "$title: rows" awk -F, 'NR == 1 { ok = $1 == "w [rad/s]" && $3 == "kind" && $7 == "th [rad]" }
  NR > 1 && $3 == "branch point" { found = $7 == 0 } END { exit !(ok && found && NR > 30) }' "$TMP/bead.csv"
check "$title: picture" grep -q '<svg' "$TMP/bead.svg"
# Lorenz (1963): rolls begin at rho = 1, and lose stability by Hopf at sigma (sigma + beta + 3)/(sigma - beta - 1) = 470/19
follow models/lorenz.lag x=0 y=0 z=0 rho=0..26 --branches
kinds "branch point;end;end;Hopf;end;Hopf;end;end;end;"
close 1 parameter 1 1e-10
close 4 parameter 24.7368421052631579 1e-9
# H. Ziegler (1952), masses 2 and 1: without friction frequencies collide at (7 - 2 sqrt(2))/2 though no energy is conserved; with it a Hopf point, 41/28 + c^2/2
follow $dir/ziegler.lag P=0..6
kinds "frequencies collide;end;end;"
close 1 parameter 2.0857864376269049 1e-10
follow $dir/ziegler.lag P=0..6 c=0.1
kinds "Hopf;end;end;"
close 1 parameter 1.4692857142857143 1e-9
# a Hopf point at which a step ends; all motions that leave it have one parameter, and rounding makes no folds
follow $dir/vanderpol.lag mu=-1..3 --branches --most 40
kinds "end;Hopf;end;end;"
close 2 parameter 0 1e-10
check "$title: the branch stands" grep -q 'stays along this branch, a family at this value' "$TMP/json"
# Hill's problem: M. Henon, Astronomy and Astrophysics 1 (1969) 223: family g loses stability at C = -2 E = 4.49999; the begin stays at a right angle to y = 0
follow $dir/hill.lag g energy=-2.4..-2.2 --reverse y=-y --guess 1
close 1 parameter -2.249995 5e-6
close 2 y 0 1e-14
# the body on the axis by DOP853 and Brent's method (SciPy): the begin stays at rest, however long the period
follow $dir/sitnikov.lag period=3..150
kinds "end;end;"
close 1 z 10.39416442119 1e-9
close 1 "z'" 0 1e-12
# a parameter's bound is a place like any other: differences are one-sided there
check "to a bound" sh -c "'$LAGC' continue models/lorenz.lag x=0 y=0 z=0 rho=3..0 | grep -q 'end of the range   rho = 0, '"
# a driven mass: x(0) is the real part of 1/(k - w^2 + i c w); its period is the drive's at w, from 30 times the first one
follow $dir/driven.lag c=0..0.5
close 1 x 0.246153846153846154 1e-11
close 2 parameter 0 0
close 2 x 0.25 1e-11
follow $dir/driven.lag c=1 w=0..4
close 1 period 1.57079632679489662 1e-11
close 1 x -0.080291970802919708 1e-11
near "$title: where the period is 30 times the first" 1e-4 0.0333333333333 "$(of_point 2 parameter)"
# transcritical points: the prey meets the predators at u = 1/3, p = p2 u (1 - u)/(1 - exp(-p3 u)), and vanishes at p = p2/p3
follow $dir/prey.lag p=0.3..1 u=0.95 --branches --most 60
near "$title: predators" 1e-11 0.8219043453739907 "$(sed -n 's/^{"kind": "branch point", "parameter": \([^,]*\),.*/\1/p' "$TMP/points" | sed -n 1p)"
near "$title: no prey" 1e-10 0.6 "$(sed -n 's/^{"kind": "branch point", "parameter": \([^,]*\),.*/\1/p' "$TMP/points" | sed -n 2p)"
# Hopf's normal form: at the end of the range, lam = 0.25, a circle of radius 0.5, period 2 pi, multiplier exp(-pi)
follow $dir/hopf.lag lam=-1..0.25 --branches
kinds "Hopf;end;end;end;"
close 1 parameter 0 1e-12
close 4 period 6.28318530717959 1e-11
near "$title: radius" 1e-11 0.5 "$(sed -n '4s/.*"x": \([^,]*\), "y": \([^}]*\)}.*/\1 \2/p' "$TMP/points" | awk '{ printf "%.17g", sqrt($1*$1 + $2*$2) }')"
near "$title: multiplier" 1e-10 0.0432139182637723 "$(sed -n '4s/.*"multipliers": \[\[\([^,]*\),.*/\1/p' "$TMP/points")"
# a constant of the text is compiled as a parameter; rates +- i sqrt(k) {1, 2, 3}
follow $dir/springs.lag k=1..4
kinds "end;end;"
near "$title: frequencies" 1e-9 24 "$(sed -n '1s/.*"rates": //p' "$TMP/points" | tr -d '[]{}' | awk -F', ' '{ for (i = 2; i <= 12; i += 2) s += $i < 0 ? -$i : $i; printf "%.15g", s }')"
near "$title: no growth" 1e-9 0 "$(sed -n '1s/.*"rates": //p' "$TMP/points" | tr -d '[]{}' | awk -F', ' '{ for (i = 1; i <= 11; i += 2) s += $i < 0 ? -$i : $i; printf "%.15g", s }')"
check "a constant: said" grep -q 'compiled as a parameter' "$TMP/err"
check "a range that begins at a Hopf point" sh -c "'$LAGC' continue $dir/hopf.lag lam=0..0.25 --branches | grep -q '^branch 2, .* from branch 1'"
check "a steady Hopf point: what is not followed" sh -c "'$LAGC' continue $dir/turntable.lag --steady lam=-1..1 --branches | grep -A1 'Hopf' | grep -q 'not followed: .*--relative'"
check "motions that are the same backwards" sh -c "'$LAGC' continue models/pendulum.lag wide l=1..1.1 --reverse rest | grep -q 'periodic motions over l'"
# parametric resonance with friction: a multiplier of -1 at a = 0.2001..., by SciPy's DOP853 at 1e-13 and Brent's method; the motions of twice the period
follow $dir/oscillator.lag parametric a=0.05..0.3
kinds "period doubling;end;end;"
close 1 parameter 0.20010934214887058 1e-11
close 1 period 3.14159265358979 1e-13
# the pendulum's family by energy: 4 sqrt(l/g) K(k), k^2 = E/(2 m g l), at the end of the range
follow models/pendulum.lag wide energy=9..18
close 1 period 3.40802289484 1e-10
# Kepler's third law, 2 pi/(-2 E)^1.5, with the spin kept and two segments, whose ends differ in the size of the energy's terms
follow models/kepler.lag orbit energy=-0.7..-0.3
kinds "end;end;"
close 1 period 13.5192622532453730 1e-9
close 2 period 3.79304342543609208 1e-9
# a velocity led from a turning point keeps its coordinate: 4 sqrt(l/g) K, k^2 = (v^2/2 + g)/(2 g), v = 3, mpmath; ranges of energy and period have units
follow models/pendulum.lag wide "th'=0..3"
kinds "end;end;"
close 1 period 2.70882647918168306 1e-11
follow models/double_pendulum.lag apart th1=0.2 th2=-0.28 "th1'=0..0.5"
kinds "end;end;" # no folds
follow models/pendulum.lag wide 'energy=9000..18000[mJ]'
close 1 period 3.40802289484 1e-10
follow models/pendulum.lag wide 'period=2300..2500[ms]'
close 1 parameter 2.5 1e-14
# the energy over a place that keeps its value, a turning point first: k^2 = E/(2 m g l)
follow models/pendulum.lag wide energy=9..18 --hold th
kinds "end;end;" # no fold at the turning point
near "$title: period" 1e-10 3.40802289484 "$(sed -n '/"kind": "end"/{s/.*"period": \([^,]*\).*/\1/p;q;}' "$TMP/points")"
# a value beside its range is where it begins
check "begins at a value" sh -c "'$LAGC' continue models/pendulum.lag wide l=0.8 l=0.5..1 | grep -q 'begins  *l = 0.8'"
# edges of the tongues of x'' + (a - 2 q cos 2t) x = 0 at q = 0.2: eigenvalues of Hill's matrices, mpmath. The second tongue, 0.02 wide, lies within a step
follow $dir/mathieu.lag a=-0.5..5
kinds "period doubling;period doubling;branch point;branch point;end;branch point;end;"
close 1 parameter 0.795123868083863287 1e-12
close 2 parameter 1.19487405920446156 1e-12
close 3 parameter 3.99666724513820446 1e-12
close 4 parameter 4.01657915296946699 1e-12
close 6 parameter -0.0199132963584375184 1e-12
# a ball bounces once a period T of a plate (run_orbit.sh): A w^2 cos p = g T w (1 - e)/(2 (1 + e)) has two motions that meet at cos p = 1; where
# (1 + e)^2 A w^2 sin p/g is -2 (1 + e^2) the period doubles. (Behind the plate's zero by
# 1: no bounce at the start of the period.)
sed 's/sin(w\*t)/sin(w*t + 1)/' $dir/plate.lag >"$TMP/plate.lag"
follow "$TMP/plate.lag" A=0.005..0.011
kinds "end;fold;period doubling;end;"
close 2 parameter 0.00642062998577413993 1e-12
close 3 parameter 0.00936133781380749192 1e-12
# a begin whose velocity the motions of a branch need not have: digits of AUTO-07p for its demo pen (tests/bench/folds.sh)
follow tests/bench/models/pendulums.lag rotate I=0.4..0.14 --guess 1.57 --branches --most 110
kinds "end;period doubling;end;fold;branch point;branch point;fold;end;"
close 2 parameter 0.17916377628 1e-9
close 4 parameter 0.39907438898 1e-9
close 7 parameter 0.15859485742 1e-8
# --period names the first motion, and holds no other: cos of the amplitude where 4 sqrt(l/g) K(sin(th/2)) = 3, mpmath
follow models/pendulum.lag wide period=2.4..3 --period 2.5
kinds "end;end;"
near "$title: amplitude" 1e-10 -0.672828117724294 "$(sed -n "1s/.*\"th\": \([^,]*\), \"th'\": \([^}]*\)}.*/\1 \2/p" "$TMP/points" | awk '{ printf "%.15g", cos($1) - $2^2/(2*9.81) }')"
# --period is kept in place of the energy while a parameter moves. The fold of Bratu's problem: 8 x^2/cosh(x)^2 where x tanh(x) = 1, mpmath
follow $dir/bratu.lag p=2..4 --period 2 u=0.01 "u'=1.24"
kinds "fold;end;end;"
close 1 parameter 3.51383071912516121 1e-12
# the standard map: its island's centre doubles at K = 4; the period follows that of the kicks
follow models/standard_map.lag q=0.1 p=0.05 K=0.5..4.5 --guess 1
kinds "period doubling;end;end;"
close 1 parameter 4 1e-12
# there motions of twice the period leave it, on which q turns to -q, and 4 q = K sin(q): at K = 4.5 by Newton
follow models/standard_map.lag q=0.1 p=0.05 K=3.5..4.5 --guess 1 --branches
near "$title: twice the period" 1e-10 0.830716795826628 "$(sed -n '/"period": 2,/{s/.*"q": \([^,]*\),.*/\1/p}' "$TMP/points" | tail -1 | tr -d -)"
# states of rest end where a contact closes: m g/k = 1
check "a family ends: at a contact" sh -c "'$LAGC' continue tests/exec/modes/ball.lag k=5..80 | grep -A1 'k = 9.8100' | grep -q 'it ends there: contact floor closes'"
follow models/standard_map.lag q=0.1 p=0.05 T=1..2 --guess 1
close 1 period 2 1e-14
# Duffing's backbone by energy: 4 K(k)/sqrt(1 + A^2), k^2 = A^2/(2 (1 + A^2)), A^2 + A^4/2 = 2 E; at 24 by mpmath
follow $dir/backbone.lag energy=0.7..24
close 1 period 2.31119416692599250 1e-11
close 1 x 2.97470297707117386 1e-12
# the double pendulum's nonlinear modes: next to rest 2 pi/w, w^2 = (2 -+ sqrt 2) g/l, and as far apart as A^2/24 (lagc modes: 0.0424 A^2, 0.926 A^2 with A = 0.0143
# of th2); at the other end SciPy's DOP853 at 1e-13: released at rest, both rods hang straight after a quarter of a period
follow models/double_pendulum.lag together th1=0.02 th2=0.0282842712474619 energy=-29.428..-26.927900718198647
close 1 period 2.6494630421318380 1e-11
close 1 th2 0.5 1e-9 # the energy has a rounding of 1e-15 of 29
near "$title: mode" 1e-6 0.0424332 "$(of_point 2 period | awk '{ w = 8*atan2(1, 1)/$1; printf "%.12g", (1 - w/sqrt((2 - sqrt(2))*9.81))/0.01427834712^2 }')"
follow models/double_pendulum.lag apart th1=0.02 th2=-0.0282842712474619 energy=-29.428..-28.81651650833325
close 1 period 1.1460683553031663 1e-11

# --resume: the rows so far stay as they are, but for the word at the end of the branch; then the same end as above
"$LAGC" continue models/pendulum.lag wide energy=9..12 -o "$TMP/family.csv" >"$TMP/log"
cp "$TMP/family.csv" "$TMP/before.csv"
follow models/pendulum.lag wide energy=9..18 --resume "$TMP/family.csv"
close 1 period 3.40802289484 1e-10
without_ends() { sed 's/,[a-z]*,$/,,/' "$1"; }
without_ends "$TMP/before.csv" >"$TMP/before"
without_ends "$TMP/family.csv" >"$TMP/after"
is "$title: rows changed, added in the middle" "0 1" "$(diff "$TMP/before" "$TMP/after" | grep -c '^<') $(diff "$TMP/before" "$TMP/after" | grep -c '^[0-9]')"
# driven: both folds lie behind the last of 12 points; SciPy as below
"$LAGC" continue $dir/oscillator.lag driven w=1.2..2.5 --most 12 -o "$TMP/driven.csv" >"$TMP/log"
follow $dir/oscillator.lag driven w=1.2..2.5 --resume "$TMP/driven.csv" -o "$TMP/more.csv" --svg "$TMP/more.svg"
kinds "fold;fold;end;"
close 1 parameter 2.39964925875596 1e-10
close 2 parameter 1.32917435250243 1e-10
check "$title: -o leaves the file" awk -F, 'END { exit !(NR < 16) }' "$TMP/driven.csv"

# Steady motions. A conical pendulum turns at w with cos th = g/(l w^2); disturbed, it nods at w sqrt(1 + 3 cos^2 th)
follow models/spherical_pendulum.lag cone --steady "ph'=3.3..8"
kinds "end;end;"
near "$title: angle" 1e-12 1.4169084130608005 "$(of_point 1 th)"
near "$title: nods" 1e-10 8.27714124486830 "$(sed -n '1s/.*"rates": \[\[[^,]*, \([^]]*\)\].*/\1/p' "$TMP/points")"
# Watt's governor opens at w^2 = (m + M) g/(m l), where its angular momentum is J w; then cos th = (m + M) g/(m l w^2), and spin = (2 m l^2 sin^2 th + J) w
follow $dir/governor.lag spin --steady spin=4..20 --branches
kinds "branch point;end;end;end;end;"
close 1 parameter 7.67202711152665 1e-11
near "$title: spin" 1e-10 20 "$(sed -n '4s/.*"th": \([^,]*\),.*"ph.": \([^}]*\)}.*/\1 \2/p' "$TMP/points" | awk '{ printf "%.15g", (2*sin($1)^2 + 2)*$2 }')"
near "$title: balance" 1e-10 0 "$(sed -n '4s/.*"th": \([^,]*\),.*"ph.": \([^}]*\)}.*/\1 \2/p' "$TMP/points" | awk '{ printf "%.15g", cos($1) - 1.5*9.81/$2^2 }')"

long() {
  # van der Pol's period over mu: at 5 by SciPy's DOP853 at 1e-13; published 11.612 (C. Andersen, J. Geer, SIAM J. Appl. Math. 42 (1982) 678)
  follow $dir/vanderpol.lag cycle mu=1..5 --guess 6.66
  close 1 period 11.61223066771953 1e-9
  # the bead by a constraint: w = sqrt(g/R); on the other branch at w = 8 the height -g/w^2
  follow $dir/hoop.lag w=1..8 --branches
  kinds "branch point;end;end;end;end;"
  close 1 parameter 4.42944691807002 1e-9
  close 4 y -0.15328125 1e-10
  # a block rocks on a shaken floor, and may stand anywhere on it: no branch point is found where a multiplier stays 1
  { cat models/rocking_block.lag && echo 'param a = 1.5 [m/s^2], w = 6 [rad/s]' && echo 'force x = -m*a*sin(w*t)'; } >"$TMP/shaken.lag"
  follow "$TMP/shaken.lag" a=1.49..1.505 x=0.0174588734157936 y=0.804163377048012 th=-0.0217660919714671 "x'=0.44204476705349" \
    "y'=0.10034198550577" "th'=-0.549695223222156" --until 10 --hold x
  kinds "end;end;"
  # AUTO's manual: folds at 0.105739 and 0.0889318, a Hopf point at 0.1309; here p1 = u exp(-14 u/3)/(1 - u) where u (1 - u) = 3/14, (14 u - 4)(1 - u) = u
  follow $dir/reaction.lag p1=0..0.15
  kinds "fold;fold;Hopf;end;end;"
  close 1 parameter 0.105738978271651651 1e-11
  close 2 parameter 0.0889318461857728026 1e-11
  close 3 parameter 0.130900044820043325 1e-11
  # folds of Duffing's oscillator, by SciPy: P(u) = u, det(P' - 1) = 0 by fsolve, period map by DOP853 at 1e-13
  follow $dir/oscillator.lag driven w=0.5..2.5
  kinds "fold;fold;end;end;"
  close 1 parameter 2.39964925875596 1e-10
  close 2 parameter 1.32917435250243 1e-10
  # M. Brack, in Foundations of Physics 31 (2001) 209: the straight motion of Henon and Heiles bifurcates at 6 E = 0.969309, 0.986709
  follow models/henon_heiles.lag regular x=0 y=0.3 "x'=0" "y'=0" energy=0.03..0.165 --guess 6.5
  kinds "period doubling;period doubling;branch point;branch point;end;end;"
  close 1 parameter 0.1352859193003538 1e-11 # SciPy: trace of the equation across is -2
  close 3 parameter 0.1615515151108141 1e-11 # SciPy: it is 2
  near "$title: 6 E" 5e-7 0.986709 "$(of_point 4 parameter | awk '{ printf "%.12g", 6*$1 }')"
  # the first over the period: motions of twice it, whose branch point is that of the family over the energy
  follow models/henon_heiles.lag regular x=0 y=0.3 "x'=0" "y'=0" energy=0.13..0.16 y=0.71 --guess 7.8 --branches --most 40
  doubled=$(sed -n '/"kind": "branch point"/{s/.*"period": \([^,]*\),.*/\1/p;q;}' "$TMP/points")
  follow models/henon_heiles.lag regular x=0 y=0.71 "x'=0" "y'=0" period=7.7..16 --guess 7.8 --branches --most 40
  near "$title: twice the period" 1e-9 "$doubled" "$(sed -n '/"kind": "branch point", "parameter": 15/{s/.*"parameter": \([^,]*\),.*/\1/p;q;}' "$TMP/points")"
  check "$title: twice a period outside" sh -c "'$LAGC' continue models/henon_heiles.lag regular x=0 y=0.71 \"x'=0\" \"y'=0\" period=7.7..8 --guess 7.8 --branches | grep -q 'not followed: .* outside of the range'"
  # halo orbits leave the planar ones about L1 where motions across the plane have a trace of 2: SciPy's DOP853 at 1e-13 and Brent's method
  follow $dir/cr3bp_space.lag period=2.71..2.75 --guess 2.743 --hold y --branches
  kinds "end;branch point;end;end;end;"
  close 2 parameter 2.7429940694621724 1e-11
  close 2 x 0.8233908986333198 1e-10
  # the family of halo orbits at mu = 0.063004722392: folds of its period by AUTO-07p (demo r3b, 100 intervals), behind a branch point at 2.1804842
  follow $dir/cr3bp_space.lag mu=0.063004722392 x=0.6637384 z=0.1213414 "y'=0.32624754" --guess 2.5996 --hold y period=1.9..3.2 --most 170
  is "$title: folds" "2.692128169 2.014663112 3.080375913 " "$(sed -n 's/.*"fold", "parameter": \([^,]*\),.*/\1/p' "$TMP/points" | head -3 | awk '{ printf "%.9f ", $1 }')"
  is "$title: the branch point, in both directions" "2.180484199 2.180484199 " \
    "$(sed -n 's/.*"branch point", "parameter": \([^,]*\),.*/\1/p' "$TMP/points" | awk '{ printf "%.9f ", $1 }')"
  # M. Garcia et al. (1998): the walker's gait doubles at a slope of 0.0151; its motions of two steps at 0.0177
  follow $dir/walker.lag slope=0.008..0.018 --guess 3.88 --branches
  kinds "period doubling;end;end;period doubling;end;end;"
  close 1 parameter 0.0151 5e-5
  close 4 parameter 0.0177 5e-5
  # J. R. Taylor, Classical Mechanics, 12.5: the driven pendulum's period doubles at 1.0663, 1.0793, 1.0821, 1.0827; M. Feigenbaum's ratio 4.6692
  follow models/driven_damped_pendulum.lag taylor drive.gamma=1.06..1.085 th=-0.56 "th'=18.2" --branches
  sed -n 's/.*"period doubling", "parameter": \([^,]*\),.*/\1/p' "$TMP/points" >"$TMP/doublings"
  is "$title: doublings" "1.0664 1.0793 1.0821 1.0827 " "$(head -4 "$TMP/doublings" | awk '{ printf "%.4f ", $1 }')"
  near "$title: ratio" 0.01 4.6692 "$(awk '{ x[NR] = $1 } END { print (x[4] - x[3])/(x[5] - x[4]) }' "$TMP/doublings")"
}
slow long

# branches over the points of a section: x(0) is the real part of 1/(k - w^2 + i c w), as above; the picture's line and its points have one height
"$LAGC" continue $dir/driven.lag c=1 w=1..2 -o "$TMP/response.csv" >"$TMP/log"
over() { "$LAGC" sweep $dir/driven.lag c=1 w=1..2:5 --skip 150 --until 180 --quiet "$@"; }
over --y x --section 'sin(w*t) rising' --branches "$TMP/response.csv" --svg "$TMP/over.svg"
check "branches over a section: a line" grep -q 'stroke="#000".* d="M' "$TMP/over.svg"
check "branches over a section: a legend" grep -q 'continued, unstable' "$TMP/over.svg"
check "branches without a section" says 2 "over the points of a section" over --branches "$TMP/response.csv" --svg "$TMP/over.svg"
check "branches of another model" says 2 "there is no column" over --y x --section 'sin(w*t) rising' --branches "$TMP/bead.csv" --svg "$TMP/over.svg"

refused() {
  case_words=$1
  shift
  check "refused: $case_words" says "$@"
}
ends() { check "$1" sh -c "'$LAGC' continue $2 | grep -q 'it ends there: $3'"; }
ends "a family ends: at a value that the model refuses" "models/lorenz.lag x=0 y=0 z=0 rho=0.5..-3" "rho = .*: the model declares rho >= 0"
ends "a family ends: at a bound that is no value" "models/pendulum.lag wide l=0..1" "l = .*: the model declares l > 0"
ends "a family ends: in a rest" "models/pendulum.lag wide th=0..1.6" "the motion shrinks to a state of rest"
ends "a longer period than branches go to" "$dir/sitnikov.lag z=0.5..50" ".*30 times that at the begin: begin there to go on"
# the least gap between bounces is 0 at A = 0.01535448909, t = 0.006925004, by the closed form above
ends "a family ends: where an impact is grazed" "'$TMP/plate.lag' A=0.01..0.02" "the motion grazes plate at t = 0.00692"
slow ends "a family ends: next to the separatrix" "models/pendulum.lag wide energy=9..40" "the period grows without limit"
refused "no range" 2 "a range is missing: NAME=A..B" "$LAGC" continue models/pendulum.lag wide
refused "no such name" 2 "the model has no parameter of this name" "$LAGC" continue models/pendulum.lag wide gg=1..2
refused "an input" 2 "G is an input: declare a parameter" "$LAGC" continue tests/exec/modes/driven.lag G=1..2
refused "a range of another dimension" 2 "but [J] is needed here" "$LAGC" continue models/pendulum.lag wide 'energy=9..12[kg]'
refused "a range without length" 2 "the ends of the range are equal" "$LAGC" continue models/pendulum.lag wide l=1..1
refused "two ranges" 2 "one value runs over a range" "$LAGC" continue models/pendulum.lag wide l=1..2 m=1..2
refused "a branch point to begin with" 3 "let the range begin beside it" "$LAGC" continue models/lorenz.lag x=0 y=0 z=0 rho=1..2
refused "outside" 2 "outside of 10..18: start within" "$LAGC" continue models/pendulum.lag wide energy=10..18
refused "a period of steady motions" 2 "a steady motion has none" "$LAGC" continue $dir/governor.lag --steady period=1..2
# impacts once a period T of the table: its velocity at the impact is g T/2 (1 - e)/(1 + e), at most A w
follow $dir/table.lag A=0.01..0.016
close 2 parameter 0.01141445330804292 1e-12 # pi g/2700
# an impact passes the begin of the period: the rest of the branch begins later on the motion, and its rows at the scene's time: impacts at the table's phase p,
# cos p = g T (1 - e)/(2 A w (1 + e)), (phase - p)/w before
follow $dir/table.lag phase=-2.4..3 -o "$TMP/over.csv"
kinds "end;end;end;"
close 2 z 0.0596059168229455 1e-9
near "$title: product of multipliers" 1e-8 0.25 "$(sed -n '2s/.*"multipliers": \[\[\([^,]*\), \([^]]*\)\].*/\1 \2/p' "$TMP/points" | awk '{ printf "%.12g", $1^2 + $2^2 }')" # e^2
"$LAGC" continue $dir/table.lag phase=-2.4..1 -o "$TMP/before.csv" >"$TMP/log"
follow $dir/table.lag phase=-2.4..3 --resume "$TMP/before.csv"
close 1 z 0.0596059168229455 1e-9
family="$TMP/family.csv"
refused "rows of another model" 2 "column 7 is \`th [rad]\`, and should be \`x\`" "$LAGC" continue models/lorenz.lag x=0 y=0 z=0 energy=1..2 --resume "$family"
refused "rows of other values" 2 "the file was written by \`pendulum wide over energy" "$LAGC" continue models/pendulum.lag wide l=2 energy=9..18 --resume "$family"
refused "rows of other options" 2 "1e-13, --hold th, values" "$LAGC" continue models/pendulum.lag wide energy=9..18 --hold th --resume "$family"
refused "rows of another NAME" 2 "column 1 is \`energy\`" "$LAGC" continue models/pendulum.lag wide period=2..3 --resume "$family"
refused "no branch to go on" 2 "no branch can go on within 9..18" "$LAGC" continue models/pendulum.lag wide energy=9..18 --resume "$family"
sed '3s/^[^,]*/nine/' "$family" >"$TMP/bad.csv"
refused "a row without number" 2 "bad.csv:3: energy: \`nine\` is no number" "$LAGC" continue models/pendulum.lag wide energy=9..20 --resume "$TMP/bad.csv"
sed '4s/^[^,]*,/nan,/' "$family" >"$TMP/bad.csv"
refused "a row without a place" 2 "bad.csv:4: energy: \`nan\` is no place" "$LAGC" continue models/pendulum.lag wide energy=9..20 --resume "$TMP/bad.csv"
sed '4s/,1,/,99999999999,/' "$family" >"$TMP/bad.csv"
refused "a row of no branch" 2 "bad.csv:4: branch: \`99999999999\` is no number of a branch" "$LAGC" continue models/pendulum.lag wide energy=9..20 --resume "$TMP/bad.csv"
tap_end
