#!/bin/sh
# lagc orbit: periods against elliptic integrals, Kepler's law and published digits; multipliers against published ones and their own pairs; conditions;
# the scene to paste; refusals. numeric/singular_values has a unit test of its own.
. tests/tap.sh
needs_gsl
LAGC_OPTIMISE=-O0
export LAGC_OPTIMISE
dir=tests/exec/orbits

orbit() {
  title="$*"
  "$LAGC" orbit "$@" --json >"$TMP/json" 2>"$TMP/err" || cat "$TMP/err" >&2
}
value() { sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p" "$TMP/json"; }
word() { is "$title: $1" "$2" "$(value "$1" | tr -d '"')"; }
close() { near "$title: $1" "$3" "$2" "$(value "$1")"; } # MEMBER EXPECTED TOLERANCE
multiplier() { sed 's/.*"multipliers": \[//; s/\]\],.*//; s/\[//g; s/\], */\n/g' "$TMP/json" | sed -n "$1p" | cut -d, -f"$2" | tr -d ' ]'; }
closes() { near "$title: multiplier $1, part $2" "$4" "$3" "$(multiplier "$1" "$2")"; } # NUMBER PART EXPECTED TOLERANCE

# 4 sqrt(l/g) K(sin 45 deg), mpmath; 1e-12 of 2.4
orbit models/pendulum.lag wide --hold energy
close period 2.3678419475762374493 1e-12
word verdict stable
word trivial_multipliers 2
# the same at 179 deg, which on the way is within 2 deg of its start by a turn; the rounding of the start grows by 1e4 on the way
orbit models/pendulum.lag wide 'th=179[deg]' --hold th
close period 7.8257968375376827 1e-9
# Kepler's third law; the charges' symmetries leave nothing
orbit models/kepler.lag orbit --hold energy,spin
close period 6.2831853071795864769 1e-11 # of motions whose speed changes by a factor of 4
word trivial_multipliers 4
# C. Moore, A. Chenciner, R. Montgomery: the period; C. Simo (2002): the angles 0.00842272 and 0.29809253 of a turn of its two pairs
orbit models/figure_eight.lag eight --hold energy,spin,drift_x,drift_y
close period 6.3259139829262116776 1e-11
closes 1 1 -0.2975966675 1e-8 # cos(2 pi 0.29809253)
closes 2 1 0.998599982 1e-8
word trivial_multipliers 8
check "$title: multipliers come in pairs" close_to "$(value pairing)" 0 1e-12 # double precision
# van der Pol, mu = 1: published period
orbit $dir/vanderpol.lag
close period 6.66328685932313 3e-14
word verdict attracts
# M. Garcia, A. Chatterjee, A. Ruina, M. Coleman, J. Biomech. Eng. 120 (1998) 281: the long gait at slope 0.009 has multipliers of size 0.59;
# a strike forgets the swinging leg, a multiplier of 0. SciPy: the return map differentiated
orbit $dir/walker.lag
closes 1 1 -0.190099841 1e-8
closes 1 2 0.557598777 1e-8
closes 3 1 0 1e-12
word verdict attracts

check "the scene to paste has a name of its own" sh -c "'$LAGC' orbit models/kepler.lag orbit --hold energy,spin | sed -n '/^scene/,\$p' | cat models/kepler.lag - >'$TMP/named.lag'; '$LAGC' check '$TMP/named.lag' | grep -q 'scene orbit_2: ok'"
# the scene starts on the motion: a run of it comes back
"$LAGC" orbit $dir/vanderpol.lag | sed -n '/^scene/,$p' >"$TMP/scene"
cat $dir/vanderpol.lag "$TMP/scene" >"$TMP/pasted.lag"
orbit "$TMP/pasted.lag" orbit
close period 6.66328685932313 3e-14
close residual 0 1e-13

# a force that jumps where the motion begins: derivatives of the energy are those of one side. Of one coordinate all multipliers are 1
orbit $dir/bratu.lag --period 2
word trivial_multipliers 2
word verdict stable
long() {
  # R. Arenstorf's orbit: E. Hairer, S. Norsett, G. Wanner, Solving Ordinary Differential Equations I, II.0
  orbit models/cr3bp.lag arenstorf --guess 17
  close period 17.0652165601579625588917206249 1e-11
  # M. Henon, C. Heiles: along x = 0, by SciPy's DOP853 at 1e-13 with the equation of x beside it
  orbit models/henon_heiles.lag regular x=0 y=0.3 "x'=0" "y'=0" --hold y
  close period 6.497297178873413 1e-12
  closes 1 1 0.980866982205496 1e-11
  # planar Lyapunov orbit about L1 of Earth and Moon that begins at x = 0.823385182: the jacobi and the section are kept
  orbit models/cr3bp.lag departure mu=0.01215058560962404 x=0.823385182 "y'=0.1263" --guess 2.743 --hold x,y
  check "$title: pairs of a saddle" close_to "$(value pairing)" 0 1e-9 # of a multiplier of 2361
  near "$title: crosses the axis at a right angle" 1e-12 0 "$(sed -n "s/.*\"x'\": \([^,}]*\).*/\1/p" "$TMP/json")"
  # the same by half, where it alone crosses the axis at right angles
  period=$(value period)
  orbit models/cr3bp.lag departure mu=0.01215058560962404 x=0.823385182 "y'=0.1263" --guess 2.743 --hold x --reverse y=-y
  close period "$period" 1e-13
  # K. Howell, Celestial Mechanics 32 (1984) 53, halo orbits about L1, mu = 0.04: T/2 1.300177, x 0.723268, y' 0.198019, (a + 1/a)/2 1181.69
  orbit $dir/cr3bp_space.lag mu=0.04 x=0.723 z=0.04 "y'=0.198" --guess 2.6 --reverse y=-y --hold z
  near "$title: half a period" 5e-7 1.300177 "$(awk -v T="$(value period)" 'BEGIN { printf "%.9g", T/2 }')"
  close x 0.723268 5e-7
  near "$title: stability index" 5e-3 1181.69 "$(multiplier 1 1 | awk '{ printf "%.9g", ($1 + 1/$1)/2 }')"
  # motions across the plane do not act on those within: their trace by SciPy's DOP853 at 1e-13, 1.9999512850751
  orbit $dir/cr3bp_space.lag "y'=0.12623" --guess 2.743 --hold x,y
  close period 2.7429120843285 1e-11
  closes 2 1 0.99997564253756 1e-10
  # a relative motion has the multipliers that it has without the angle, by Routh; the two programs share no equation
  orbit $dir/elastic_routh.lag --hold energy --guess 1.383
  routh=$(value period) half=$(multiplier 1 1)
  orbit $dir/elastic.lag --hold energy,spin --relative spin --guess 1.383
  close period "$routh" 1e-12
  closes 1 1 "$half" 1e-10
  # the segments do not matter
  orbit models/cr3bp.lag arenstorf --guess 17 --segments 12
  closes 1 1 285.40371175 1e-6
}
slow long

# Symmetries that exchange coordinates: the figure of eight after a third of its period, with a third of Simo's angles (cos 3a = 4 cos^3 a - 3 cos a);
# a driven motion that is its own mirror image half a drive later, whose multipliers have the product exp(-d T) (Liouville)
orbit models/figure_eight.lag eight --hold energy,spin,drift_x,drift_y --relative 'r[i]=r[i+1]'
close whole_period 6.3259139829262116776 1e-11
near "$title: a third of the angle" 1e-8 0.998599982 "$(multiplier 1 1 | awk '{ printf "%.15g", 4*$1^3 - 3*$1 }')"
orbit $dir/oscillator.lag driven --relative x=-x
close period 2.61799387799149437 1e-13
near "$title: product of multipliers" 1e-12 0.877305769098345670 "$(multiplier 1 1 | awk -v im="$(multiplier 1 2)" '{ printf "%.15g", $1^2 + im^2 }')"
check "$title: an event without the symmetry" says 3 "events of the scene do not have this symmetry" "$LAGC" orbit $dir/mirror.lag one_wall --relative x=-x
check "$title: a pair of walls has it" "$LAGC" orbit $dir/mirror.lag two_walls --relative x=-x

# rest in a driven scene, where no error keeps steps short: multipliers have the product 1; a pendulum at its upper rest, whose velocity is rounding
orbit $dir/mathieu.lag a=-0.01998 --period 6.283185307179586
near "$title: product of multipliers" 1e-13 1 "$(multiplier 1 1 | awk -v b="$(multiplier 2 1)" '{ printf "%.17g", $1*b }')"
orbit models/kapitza.lag "th=180[deg]"
near "$title: product of multipliers" 1e-10 1 "$(multiplier 1 1 | awk -v im="$(multiplier 1 2)" '{ printf "%.15g", $1^2 + im^2 }')"
# a block that sticks to a belt forgets on which motion it came; the start lies beside the slide by rounding
orbit models/stick_slip.lag x=0.1
closes 1 1 0 1e-12
# a drive without size is none
check "$title: a drive of size 0" says 3 "starts at rest, at an equilibrium" "$LAGC" orbit $dir/driven.lag shaken x=0 F=0 c=0.1
# Kicks have a period: the standard map's fixed points, multipliers a + 1/a = 2 -+ K, and its motion of period 2 through pi, where they have K = 0.9's
# 2 - K^2, over segments, too; a cell of lenses: 2 - (k T/2)^2 with T = 2 (E. Courant, H. Snyder, Annals of Physics 3 (1958) 1)
orbit models/standard_map.lag q=0.1 p=0.05
close period 1 0
closes 1 1 0.55 1e-13
orbit models/standard_map.lag q=3 p=0.05
closes 1 1 2.5 1e-12
orbit models/standard_map.lag q=3.1 p=3.1 --period 2 --segments 5
closes 1 1 0.595 1e-12
orbit models/storage_ring.lag linear x=1 y=1
close period 2 0
closes 1 1 0.595 1e-12
refused_kicks() { check "kicks: $1" says 3 "$2" "$LAGC" orbit models/standard_map.lag "$3" "$4"; }
refused_kicks "no multiple of their period" "has the period 1 s" --period 1.5
# kicks to and fro: the motion is turned round by each, x = -a/(2 w) tan(w/2), x' = a/2
printf 'model kicked\ncoord x\nparam w = 2, a = 1\nkinetic = x'"'"'^2/2\npotential = w^2*x^2/2\nkick push every 1 { x'"'"' = x'"'"' + a*cos(pi*t) }\nscene go { start x = 0.1; span 20 }\n' >"$TMP/kicked.lag"
orbit "$TMP/kicked.lag"
near "kicks to and fro: period" 1e-14 2 "$(value period)"
near "kicks to and fro: x" 1e-12 -0.389351931163725 "$(value x)"
refused_kicks "backwards" "kicks" --reverse q=-q
# steps on a sphere stay on it: 4/sqrt(2 g (c - a)) K((b - a)/(c - a)) with the roots a, b, c of 2 (E - g z)(1 - z^2) = L^2, mpmath
orbit $dir/sphere.lag --relative spin --guess 1 --hold energy,spin
close period 1.04000924639386669 1e-12
word steady false
# with the energy alone the search ends on the circle, whose rotation carries it: w^2 = g/h at the height -h; its nods turn by sqrt(1 + 3 h^2) w T
orbit $dir/sphere.lag --relative spin --guess 1 --hold energy
word steady true
near "$title: angle of a nod" 1e-11 0 "$(awk -v z="$(value z)" -v T="$(value period)" -v re="$(multiplier 1 1)" 'BEGIN { printf "%.17g", cos(sqrt((1 + 3*z^2)*9.81/-z)*T) - re }')"
# a sleigh on circles: all changes of a start within the constraint are motions that close, so all multipliers are 1. x and y pass 0 together,
# which gave a size of 1e-6 m and multipliers off by 3e-6. Allowed: 1e-9, in Jordan blocks the root of 4 digits more
orbit $dir/skate.lag
word free_directions 5
closes 1 1 1 1e-9
closes 3 1 1 1e-9

# Halves of reversible motions: M. Henon, C. Heiles: a brake orbit, period as below; a pendulum that turns over: 4/v K(4 g/v^2), mpmath
orbit models/henon_heiles.lag regular x=0 y=0.3 "x'=0" "y'=0" --hold y --reverse rest
close period 6.497297178873413 1e-12
word repeats 1
orbit models/pendulum.lag wide --reverse th=-th th=0 "th'=12" --hold energy
close period 0.566048967463181999 1e-14

# a relative motion: with b/r^2 more the ellipse turns by 2 pi (L/sqrt(L^2 + 2 b) - 1) in a period 2 pi/(-2 E)^1.5; here E = -0.375, L = 0.8, b = 0.02
orbit models/kepler.lag rosette --relative spin --guess 9.7 --hold energy,spin
close spin -0.187600204395967282 1e-11
close period 9.67359660924916187 1e-10

# The value of an event function, here 1e13, hides neither a drive, period 2 pi/1.3, nor a force by the place
orbit $dir/far.lag
close period 4.83321946706121992 1e-12
check "$title: a place that matters" says 3 "depend on where it is" "$LAGC" orbit $dir/far.lag --relative x

# Contacts without friction: tangents over impacts. A ball bounces once a period T of a plate: with the plate's phase p, cos p = g T (1 - e)/(2 A w (1 + e)), its
# multipliers have the product e^2 and the sum 1 + e^2 + (1 + e)^2 A w^2 sin p/g.
orbit $dir/plate.lag
closes 1 1 4.00091570084199 1e-11
closes 2 1 0.0624856954490163 1e-12
# A block rocks on a shaken floor, edge to edge: SciPy's DOP853 at 1e-13 of its angle alone about the edge that holds, with Housner's loss 1 - 3/2 sin(al)^2 at
# each of two strokes, by fsolve. The product of its multipliers is the fourth power of that loss.
{ cat models/rocking_block.lag && echo 'param a = 1.5 [m/s^2], w = 6 [rad/s]' && echo 'force x = -m*a*sin(w*t)'; } >"$TMP/shaken.lag"
orbit "$TMP/shaken.lag" x=0.0174588734157936 y=0.804163377048012 th=-0.0217660919714671 "x'=0.44204476705349" "y'=0.10034198550577" "th'=-0.549695223222156" \
  --until 10 --relative x
near "$title: rate" 1e-10 -0.5496952179836674 "$(sed -n "s/.*\"th'\": \([-0-9.e]*\).*/\1/p" "$TMP/json")"
closes 1 1 -0.823844620222081 1e-8
closes 1 2 0.111195636710098 1e-8
# The wheel without a rim: a step takes T = int dp/w(p), and multiplies disturbances by ((I + m l^2 cos 2a)/(I + m l^2))^2; here six steps.
sed 's/th \[rad\]  /th [rad] periodic  /' models/rimless_wheel.lag >"$TMP/wheel.lag"
orbit "$TMP/wheel.lag" th=0 "th'=1.3" "x'=1.3" --relative x,y --guess 4.425
close period 4.42518591398412280 1e-11
closes 1 1 0.00770734662925894 1e-10
check "$title: says where the digits come from" grep -q '"multipliers_by": "tangent"' "$TMP/json"
word trivial_multipliers 3
# A floor that stays closed: multipliers of the slide alone, exp((-0.1 +- i sqrt(0.99)) T), mpmath; a push that opens it decays with e = 1/2, and never with 1
orbit $dir/floor.lag
closes 1 1 0.0594858770842055 1e-12
closes 1 2 0.613855723191055 1e-12
word closed floor
word verdict attracts
orbit $dir/floor.lag e=1
word verdict undecided
slow_orbits() {
  # stick, slip and impacts; by the 33rd peck of a run, whose disturbance has decayed by 0.6^33
  orbit models/woodpecker.lag M=0.0433 S=0.0337 "y'=-0.037" "M'=-3.956" "S'=-4.037" --relative y --guess 0.17
  close period 0.17559869628625435 2e-8
  word verdict attracts
  # M. Garcia, A. Chatterjee, A. Ruina, M. Coleman, The simplest walking model, J. Biomech. Eng. 120 (1998) 281: -0.19 +- 0.56 i a step, by DOP853 of
  # their two equations -0.1900999 +- 0.5575987 i; two steps here, with feet of 1e-6 of the mass
  orbit models/compass_walker.lag h.x=-0.03297665349835344 h.y=0.999456122260527 b.x=-0.13260430313900193 b.y=0.004431332907477703 \
    "h.x'=0.0633665243906833" "h.y'=0.002090753032259507" "b.x'=0.3202317935314121" "b.y'=-0.023628086651566092" \
    --relative h.x+a.x+b.x,h.y+a.y+b.y --guess 7.765
  closes 1 1 -0.2747784 4e-5
  closes 1 2 0.21199887 4e-5
}
slow slow_orbits

# A verdict against runs of 30 periods: from a start that is 1e-4 off in one coordinate the motion stays within 100 times that, or, where it is unstable,
# does not
run_off() { "$LAGC" run "$TMP/beside.lag" orbit "$@" --until "$(awk -v T="$(value period)" 'BEGIN { printf "%.17g", 30*T }')" --every "$(value period)" --quiet -o -; }
beside() { # VERDICT COORDINATE MODEL ARGS...
  kind=$1 name=$2
  shift 2
  orbit "$@"
  word verdict "$kind"
  "$LAGC" orbit "$@" | sed -n '/^scene/,$p' | cat "$1" - >"$TMP/beside.lag"
  start=$(sed -n "s/.*\"start\": {\([^}]*\)}.*/, \1/p" "$TMP/json" | sed -n "s/.*, \"$name\": \([^,]*\).*/\1/p")
  run_off >"$TMP/on"
  run_off "$name=$(awk -v x="$start" 'BEGIN { printf "%.17g", x + 1e-4 }')" >"$TMP/off"
  bounded=$(paste -d, "$TMP/on" "$TMP/off" | awk -F, 'NR == 1 { n = NF/2 }
    NR > 1 { d = $2 - $(n + 2); d = d < 0 ? -d : d; most = d > most ? d : most } END { print (NR < 15 || most > 1e-2 ? "unstable" : "bounded") }')
  is "$title: runs from beside it" "$(if [ "$kind" = unstable ]; then echo unstable; else echo bounded; fi)" "$bounded"
}
# A driven motion from rest, far from where it comes to: RK4 over 300 periods with 1000 and 2000 steps each, extrapolated, in Python.
printf '%s\n' 'model hard' 'coord x [m]' 'param F = 0.5 [N]' "lagrangian = 0.5 [kg]*x'^2 - 0.5 [N/m]*x^2 - 0.25 [N/m^3]*x^4 + F*cos(1.2 [rad/s]*t)*x" \
  "dissipation = 0.05 [N*s/m]*x'^2" 'scene s { start x = 0; span 20 }' >"$TMP/hard.lag"
orbit "$TMP/hard.lag"
word periods_before 200
close x 1.0589677337449088 1e-12
close "x'" 0.41344686064709635 1e-12
runs_from_beside() {
  beside attracts x $dir/vanderpol.lag cycle
  beside attracts x $dir/oscillator.lag driven
  beside "stable by the linearisation" x models/henon_heiles.lag regular x=0 y=0.3 "x'=0" "y'=0" --hold y
  beside unstable x models/cr3bp.lag departure mu=0.01215058560962404 x=0.823385182 "y'=0.1263" --guess 2.743 --hold x,y
  beside unstable x models/cr3bp.lag arenstorf --guess 17
}
slow runs_from_beside

refused() {
  case_words=$1
  shift
  check "refused: $case_words" says "$@"
}
refused "no name" 2 "--hold enrgy: write \`energy\`" "$LAGC" orbit models/pendulum.lag wide --hold enrgy
refused "a symmetry that moves nothing" 2 "--relative energy: write the charge of a symmetry" "$LAGC" orbit models/pendulum.lag wide --relative energy
refused "no return" 3 "does not come back next to its start" "$LAGC" orbit models/free_fall.lag
refused "how near, and when" 3 "it comes nearest after" "$LAGC" orbit models/lorenz.lag --until 3
refused "a period without end" 2 "ten thousand times the span" "$LAGC" orbit models/pendulum.lag wide --guess 1e300
refused "rest" 3 "ends at rest" "$LAGC" orbit models/pendulum.lag fading
refused "a place that matters" 3 "depend on where it is; coordinates that move together are written with +" "$LAGC" orbit models/compass_walker.lag --relative h.x --guess 3.88
refused "another period than the drive's" 3 "has the period 5.2359877559829" "$LAGC" orbit $dir/oscillator.lag driven --period 5
refused "no length" 2 "a period is a positive time" "$LAGC" orbit models/pendulum.lag wide --guess -1
refused "an exchange that is no symmetry" 3 "not a symmetry of the equations" "$LAGC" orbit models/cr3bp.lag departure --relative y=-y
refused "a coordinate taken twice" 2 "write x=y,y=x to exchange them" "$LAGC" orbit models/figure_eight.lag --relative 'r[1]=r[2]'
refused "a period of nothing" 3 "shrinks the period to nothing" "$LAGC" orbit models/free_fall.lag --guess 1
refused "two periods" 2 "leave one out" "$LAGC" orbit models/pendulum.lag wide --period 2.3 --guess 5
refused "no map" 2 "write which coordinate takes the place" "$LAGC" orbit models/pendulum.lag wide --relative 'th=2*th'
refused "too many segments" 2 "up to 200" "$LAGC" orbit models/pendulum.lag wide --segments 201
refused "a start at rest" 3 "starts at rest, at an equilibrium" "$LAGC" orbit models/pendulum.lag wide "th=180[deg]"
refused "friction, backwards" 3 "friction spoils that" "$LAGC" orbit models/pendulum.lag fading --reverse th=-th
refused "no word for rest" 2 "or \`rest\`" "$LAGC" orbit models/pendulum.lag wide --reverse th
refused "a time before the start" 2 "a time after 0 s" "$LAGC" orbit models/pendulum.lag wide --until -3
# x'' = 1 has no periodic motion: the search says how far it came, and what to try.
echo "model push; coord x; lagrangian = x'^2/2; force x = 1; scene s { start x = 0.5; span 20 }" >"$TMP/push.lag"
check "where there is none" says 3 'no periodic motion found near the start of scene s: after ' "$LAGC" orbit "$TMP/push.lag" --guess 3
none() { "$LAGC" orbit "$TMP/push.lag" --guess 3 --json 2>/dev/null | grep -q '"status": "no periodic motion", .*"residuals": \[1, 0\.'; }
check "... as JSON, with the course of the search" none
tap_end
