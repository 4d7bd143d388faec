#!/bin/sh
# lagc modes: equilibria, frequencies, shapes and verdicts against closed forms, each from a textbook or two lines of algebra
# beside it; refusals; the printed report.
. tests/tap.sh
needs_gsl
dir=tests/exec/modes

# find_modes MODEL ARGS...: the JSON object, a line a mode after the first
find_modes() {
  title="$*"
  "$LAGC" modes "$@" --json >"$TMP/json" 2>"$TMP/err" || cat "$TMP/err" >&2
  sed 's/{"re"/\n&/g' "$TMP/json" >"$TMP/modes"
}
# Fields of the object: head KEY, mode K KEY, shape K NAME (1: real part, 2: imaginary part)
head_text() { sed -n "1s/.*\"$1\": \"\([^\"]*\)\".*/\1/p" "$TMP/modes"; }
at_rest() { sed -n "1s/.*\"equilibrium\": {[^}]*\"$1\": \([^,}]*\).*/\1/p" "$TMP/modes"; }
of_mode() { sed -n "$(($1 + 1))s/.*\"$2\": \([^,}]*\).*/\1/p" "$TMP/modes"; }
shape() { sed -n "$(($1 + 1))s/.*\"shape\": {.*\"$2\": \[\([^]]*\)\].*/\1/p" "$TMP/modes" | cut -d ',' -f "${3:-1}"; }
count() { grep -c '^{"re"' "$TMP/modes"; }
calc() { awk "BEGIN { printf \"%.17g\", $1 }"; } # put values in parentheses: -2^2 is -4

# close WHAT EXPRESSION GOT [TOLERANCE]: relative, or absolute below 1. 1e-12: rounding in matrices of some ten
# rows and in closed forms; larger tolerances have a reason beside them.
close() {
  check "$title: $1" awk -v got="$3" -v tolerance="${4:-1e-12}" "
    BEGIN { pi = atan2(0, -1); want = $2; d = got - want; size = want < 0 ? -want : want; if (size < 1) size = 1
      if (got != \"\" && d <= tolerance*size && -d <= tolerance*size) exit 0
      printf \"%.17g, not %.17g\\n\", got, want; exit 1 }"
}
verdict() { is "$title: verdict" "$1" "$(head_text verdict)"; }
because() { check "$title: because $1" grep -q "\"reason\": \"[^\"]*$1" "$TMP/modes"; }

# ---- conservative: w^2 of M and K
g=9.81
find_modes models/double_pendulum.lag # w^2 = (2 -+ sqrt 2) g/l for equal masses and rods (Landau & Lifshitz, Mechanics, par. 23, problem 2)
verdict stable
because "minimum"
is "$title: a mode a coordinate" 2 "$(count)"
close "the slow one" "sqrt((2 - sqrt(2))*$g)" "$(of_mode 1 im)"
close "the fast one" "sqrt((2 + sqrt(2))*$g)" "$(of_mode 2 im)"
close "its shape" "sqrt(2)" "$(shape 1 th2)"
close "its shape" "-sqrt(2)" "$(shape 2 th2)"
close "neither grows nor decays" 0 "$(of_mode 1 re)" 0

# 0.1 beside a rest at 1e8 is no rest: there w^2 = 1 + 3*0.1^2; at rest w = 1
echo "model far; coord x; param X = 1e8; let u = x - X; lagrangian = x'^2/2 - u^2/2 - u^4/4; scene s { start x = X + 0.1 }" >"$TMP/far.lag"
find_modes "$TMP/far.lag"
close "where it rests" 1e8 "$(at_rest x)" 1e-15
close "its frequency" 1 "$(of_mode 1 im)"

find_modes models/double_pendulum.lag th1=3.1 th2=-0.1 # upside down: one mode grows. M^-1 K with K = diag(-2, 1) g: w^2 = -+ sqrt 2 g
verdict unstable
close "it stands" "pi" "$(at_rest th1)"
close "growth" "sqrt(sqrt(2)*$g)" "$(of_mode 1 re)"
close "and one oscillates" "sqrt(sqrt(2)*$g)" "$(of_mode 2 im)"

string() { # N TOLERANCE: w_k = 2 sqrt(k/m) sin(k pi/(2 (N + 1))), u_i ~ sin(i k pi/(N + 1)) (Lagrange, 1759)
  find_modes models/string.lag -D N="$1"
  verdict stable
  title="string of $1"
  check "$title: all frequencies" awk -v N="$1" -v tolerance="$2" '
    /^\{"re"/ { k++; split($0, w, /"im": /); split(w[2], im, ","); want = 2*sin(k*atan2(0, -1)/(2*(N + 1))); d = im[1] - want
      if (d > tolerance || -d > tolerance) { print "mode", k, im[1], "not", want; bad = 1 } }
    END { exit bad || k != N }' "$TMP/modes"
  close "the slowest shape" "sin(3*pi/($1 + 1))/sin(pi/($1 + 1))" "$(calc "$(shape 1 'u\[3\]')/$(shape 1 'u\[1\]')")" 1e-11 # error of w^2 over the distance to the next
}
string 10 1e-12
slow string 200 1e-11 # the error of w^2 is rounding times its largest, 4: 1e-13 at 2w = 0.03

if [ -n "${SLOW:-}" ]; then
  find_modes models/cart_pendulum.lag # w^2 = (M + m) g/(M l), x at -m l/(M + m) th; no force along x
  verdict neutral
  is "$title: two modes" 2 "$(count)"
  close "free along the rail" 0 "$(of_mode 1 im)" 0
  is "$title: free" true "$(of_mode 1 free)"
  close "without the pendulum" 0 "$(shape 1 th)" 0
  find_modes models/cart_pendulum.lag M=3 m=2 l=0.7
  close "the pendulum" "sqrt((3 + 2)*$g/(3*0.7))" "$(of_mode 2 im)"
  close "the cart goes against it" "-2*0.7/(3 + 2)" "$(calc "$(shape 2 x)/$(shape 2 th)")"
fi

find_modes $dir/coupled.lag # w1^2 = g/l, w2^2 = g/l + 2 k/m; b is in degrees
close "together" "sqrt($g/0.5)" "$(of_mode 1 im)"
close "against each other" "sqrt($g/0.5 + 2*3/2)" "$(of_mode 2 im)"
close "shapes in declared units" "180/pi" "$(shape 1 b)"
close "shapes in declared units" "-180/pi" "$(shape 2 b)"
find_modes $dir/coupled.lag up # upside down the spring's forces are as before: rates sqrt(g/l), sqrt(g/l - 2 k/m)
close "in degrees" 180 "$(at_rest b)"
close "together they fall" "sqrt($g/0.5)" "$(of_mode 1 re)"
close "against the spring slower" "sqrt($g/0.5 - 2*3/2)" "$(of_mode 2 re)"

find_modes models/pendulum.lag th=3
verdict unstable
close "growth rate of the inverted pendulum" "sqrt($g)" "$(of_mode 1 re)"

find_modes $dir/triatomic.lag # 0, k/m, k/m (1 + 2m/M) (Landau & Lifshitz, par. 24, problem 1)
verdict neutral
because "a push causes an endless drift"
close "translation" 0 "$(of_mode 1 im)" 0
is "$title: free" true "$(of_mode 1 free)"
close "all alike" 1 "$(shape 1 x2)"
close "symmetric" "sqrt(3)" "$(of_mode 2 im)"
close "the middle rests" 0 "$(shape 2 x2)"
close "antisymmetric" "sqrt(3*(1 + 2/2))" "$(of_mode 3 im)"
find_modes $dir/triatomic.lag damped # friction 2R = c (relative velocity)^2, c = 0.2: C = (c/k) K, so 2 d = c/k w^2
verdict neutral
because "a push causes an endless drift; all other modes decay"
close "translation is not damped" 0 "$(of_mode 1 re)" 0
close "decay" "-0.2/3*3/2" "$(of_mode 2 re)"
close "frequency" "sqrt(3 - 0.1^2)" "$(of_mode 2 im)"
close "decay" "-0.2/3*6/2" "$(of_mode 3 re)"
find_modes $dir/triatomic.lag held # walls that leave the equilibrium where it is
verdict stable
close "the rest lengths" -1 "$(at_rest x1)"

find_modes $dir/sums.lag # free where b = -2 d and a + b = c: two directions, reported by the basis with most zeros
for mode in "1 0 1 1 -0.5" "2 1 0 1 0"; do
  # shellcheck disable=SC2086 # five words
  set -- $mode
  for i in "a $2" "b $3" "c $4" "d $5"; do close "free direction $1" "(${i#* })" "$(shape "$1" "${i% *}")"; done
done

if [ -n "${SLOW:-}" ]; then
  find_modes $dir/triangle.lag # breathing: 3 k u back for u outwards; the sum of all w^2 is the trace of K/m, 6 k/m; rotation is not along a straight line
  verdict neutral
  because "minimum in all other directions"
  for i in 1 2 3; do is "$title: translations, rotation" true "$(of_mode $i free)"; done
  close "the pair" "sqrt(3*3/(2*2))" "$(of_mode 4 im)"
  close "the pair" "sqrt(3*3/(2*2))" "$(of_mode 5 im)"
  close "breathing" "sqrt(3*3/2)" "$(of_mode 6 im)"
fi

find_modes $dir/hoop.lag # below g/R = 4.43^2 the bottom is stable: w^2 = g/R - W^2
verdict stable
close "at the bottom" 0 "$(at_rest th)" 0
close "frequency" "sqrt($g/0.5 - 9)" "$(of_mode 1 im)"
find_modes $dir/hoop.lag fast # above, where cos th = g/(R W^2): w^2 = W^2 sin(th)^2
verdict stable
close "cos th" "$g/(0.5*36)" "$(calc "cos($(at_rest th)*atan2(0, -1)/180)")"
close "frequency" "6*sqrt(1 - ($g/(0.5*36))^2)" "$(of_mode 1 im)"
find_modes $dir/hoop.lag fast th=0 # and the bottom is not
verdict unstable
close "growth" "sqrt(36 - $g/0.5)" "$(of_mode 1 re)"
find_modes $dir/hoop.lag th=0 g=9 R=100 W=3 # the threshold itself, in numbers that are exact
verdict undecided
because "a zero mode"

if [ -n "${SLOW:-}" ]; then
  find_modes $dir/vectors.lag # w^2 = kx, ky times the number of the mass, which cancels no mass
  close "components of vectors" "sqrt(3*4)" "$(of_mode 6 im)"
  close "and their names" 1 "$(shape 6 'r\[3\].y')"
fi

# ---- soft forces beside stiff ones: rest, and slow modes
find_modes $dir/sag.lag # k x = 2 m g, K (y - x) = m g
close "it sags" "2*$g/100" "$(at_rest x)" 1e-7 # the rounding of K (y - x), 4e-6 N, over k
close "a slow mode" "sqrt(100/2)" "$(of_mode 1 im)" 1e-6 # rounding of K over k: 1e-7
find_modes $dir/sag.lag floating
close "it goes back" 0 "$(at_rest x)" 1e-9
close "slowly: w^2 = k/2m, less k/(4K) of it" 1 "$(calc "$(of_mode 1 im)/sqrt(1e-6/2)")" 1e-4 # rounding of K over k: 2e-5
if [ -n "${SLOW:-}" ]; then
  find_modes $dir/molecule.lag # x = -d/2, y = d/2, less k/2K of it; w^2 = k/m together
  verdict stable
  close "in the middle of the trap" -0.05 "$(at_rest x)" 1e-6
  close "in the middle of the trap" 0.05 "$(at_rest y)" 1e-6
  close "together" "sqrt(1e-6/2e-26)" "$(of_mode 1 im)" 1e-6
fi
title="the rim of a circle, where equilibria go on along one coordinate"
for scene in top side; do
  find_modes "$dir/rim.lag" $scene
  is "$title: free, $scene" true "$(of_mode 1 free)"
done
for k in 1e5 1e6 1e7 1e10; do # a rod, almost; the floor of its valley is a circle
  find_modes models/spring_pendulum.lag x=0.6 y=-0.7 k=$k
  verdict stable
  close "it hangs" "-1 - $g/$k" "$(at_rest y)" 1e-11 # the rounding of a position, k times, over m g/l
  close "as a pendulum" "sqrt($g/(1 + $g/$k))" "$(of_mode 1 im)" 1e-6
  find_modes models/spring_pendulum.lag x=0.6 y=-0.8 k=$k
  is "$title: not sideways" 0 "$(at_rest x)"
done
find_modes $dir/apart.lag # sqrt(k/m), sqrt(K/M): 3e9 and 3e-5
verdict stable
is "$title: nothing to note" "" "$(head_text note)"
close "of the house" 1 "$(calc "$(of_mode 1 im)/sqrt(1e-3/1e6)")"
close "of the atom" 1 "$(calc "$(of_mode 2 im)/sqrt(1e-6/1e-25)")"
find_modes $dir/apart.lag alike
verdict stable
close "the slow one" 1 "$(calc "$(of_mode 1 im)/sqrt(1e-6)")"
find_modes $dir/apart.lag damped # the decay of the house, 1e-9, is rounding beside 3e9
is "$title: both" 2 "$(count)"
close "of the atom" 1 "$(calc "$(of_mode 2 im)/sqrt(1e-6/1e-25)")"
find_modes $dir/valley.lag # x^3 y - y^2/2: no force at 0 alone, where x moves along y = x^3
verdict undecided
close "the end of the valley" 0 "$(at_rest x)" 0
find_modes $dir/body.lag
close "it stops" 0 "$(at_rest w3)" 0
close "as it stood" 0.8 "$(at_rest a)" 0
close "as it stood" 0.6 "$(at_rest b)" 0

# ---- zero stiffness up to rounding
for of in "go m=0.7 l=0.2" "go m=0.1 l=0.7" "go m=0.7 l=1.3" "damped m=0.7 l=0.2" "damped m=0.1 l=0.7" "damped m=0.7 l=1.3"; do
  find_modes $dir/buckle.lag $of # m g l - k l^2 = 0; it falls
  verdict undecided
  because "a zero mode"
done
find_modes models/bead_on_hoop.lag critical # the bifurcation of th = 0
verdict undecided
close "at the bottom" 0 "$(at_rest th)" 0
find_modes models/lorenz.lag rho=1 # the bifurcation of 0, which the search reaches slowly
verdict undecided
because "a zero mode"
close "at 0" 0 "$(at_rest x)" 0
close "-8/3" "-8/3" "$(of_mode 2 re)"
close "-11" -11 "$(of_mode 3 re)"

# ---- damped
find_modes $dir/oscillator.lag # x'' + 2 d x' + w^2 x = 0, d = 0.2, w = 2
verdict "asymptotically stable"
close "decay" -0.2 "$(of_mode 1 re)"
close "frequency" "sqrt(4 - 0.04)" "$(of_mode 1 im)"
find_modes $dir/oscillator.lag critical # d = w: one double eigenvalue, to full precision although it is defective
verdict "asymptotically stable"
is "$title: one mode" 1 "$(count)"
close "decay" -2 "$(of_mode 1 re)"
close "no oscillation" 0 "$(of_mode 1 im)" 0
is "$title: double" 2 "$(of_mode 1 repeats)"
find_modes $dir/oscillator.lag over # -d +- sqrt(d^2 - w^2), d = 5
is "$title: two modes" 2 "$(count)"
close "slow" "-5 + sqrt(21)" "$(of_mode 1 re)"
close "fast" "-5 - sqrt(21)" "$(of_mode 2 re)"
find_modes $dir/oscillator.lag loose # no spring: every position is an equilibrium
verdict neutral
close "where it is" 3 "$(at_rest x)"
close "anywhere" 0 "$(of_mode 1 re)" 0
close "decay" -0.4 "$(of_mode 2 re)"
find_modes $dir/oscillator.lag pushed # negative damping
verdict unstable
close "growth" 0.2 "$(of_mode 1 re)"

# ---- a minimum of an energy that nothing can raise is stable, though some mode does not decay (Thomson & Tait, par. 345; Chetaev)
while read -r scene why; do # c >= 0, as declared; 0 in the second scene
  find_modes $dir/braked.lag "$scene"
  verdict stable
  because "$why"
  close "what is not braked" 2 "$(of_mode 2 im)"
done <<'EOF'
one nothing raises it
none conserved at these values
EOF
close "nor this, without a brake" 1 "$(of_mode 1 im)"
find_modes $dir/braked.lag pulled F=4 # an input that is held: 4 k y = F
verdict stable
close "pulled aside" 1 "$(at_rest y)"
for scene in driven rubbed "led F=1"; do # a belt may drive; -x'^3 does not, but is not proved; F x in y has no energy
  find_modes $dir/braked.lag $scene
  verdict undecided
  because "no energy is known"
done

# ---- gyroscopic: z'' = -i W z' + z, z = x + i y, W = b/m, on a hill of strength k/m = 1: w = (W -+ sqrt(W^2 - 4))/2
find_modes $dir/hill.lag
verdict undecided
because "the energy falls in 2 directions"
close "slow" "(3 - sqrt(5))/2" "$(of_mode 1 im)"
close "fast" "(3 + sqrt(5))/2" "$(of_mode 2 im)"
close "circles: as far" 0 "$(shape 1 y 1)"
close "a quarter of a period apart" 1 "$(shape 1 y 2)"
find_modes $dir/hill.lag weak # W = 1.5: w complex
verdict unstable
close "growth" "sqrt(4 - 1.5^2)/2" "$(of_mode 1 re)"
close "turning" "1.5/2" "$(of_mode 1 im)"
find_modes $dir/hill.lag critical # W = 2: a double w = 1 with one shape
verdict undecided
because "multiple frequency with too few shapes"
close "frequency" 1 "$(of_mode 1 im)"
is "$title: one mode" 1 "$(count)"
find_modes $dir/hill.lag valley # k < 0: w = (sqrt(W^2 + 4) -+ W)/2, and the energy has a minimum
verdict stable
close "slow" "(sqrt(13) - 3)/2" "$(of_mode 1 im)"
# A block that dry friction holds neither drifts for ever nor swings without end.
printf '%s\n' 'model block' 'coord x, th' "kinetic = x'^2/2 + th'^2/2" 'potential = -9.81*cos(th)' 'friction f on x: 5' 'scene s { start x = 0.5 }' >"$TMP/block.lag"
find_modes "$TMP/block.lag"
verdict undecided
check "$title: why" grep -q "dry friction holds" "$TMP/json"
find_modes $dir/hill.lag rubbed # friction destroys the stability by gyroscopic forces (Thomson & Tait, Natural Philosophy, par. 345)
verdict unstable
close "growth, to first order in c/m = 0.01" "0.01*0.381966/(2*0.381966 - 3)*-1" "$(of_mode 1 re)" 1e-5 # second order: 1e-4 of 1.7e-3

# The Lagrange point L4: w^4 - w^2 + 27/4 mu (1 - mu) = 0; stable below Routh's mu = (1 - sqrt(23/27))/2 = 0.0385208965...
L4() { find_modes $dir/cr3bp.lag mu="$1"; }
L4 0.01215
verdict undecided
close "its place" "0.5 - 0.01215" "$(at_rest x)"
close "its place" "sqrt(3)/2" "$(at_rest y)"
close "long" "sqrt((1 - sqrt(1 - 27*0.01215*(1 - 0.01215)))/2)" "$(of_mode 1 im)"
close "short" "sqrt((1 + sqrt(1 - 27*0.01215*(1 - 0.01215)))/2)" "$(of_mode 2 im)"
L4 0.03852
verdict undecided
because "all modes oscillate"
L4 0.03853
verdict unstable
L4 0.038520896504551397 # Routh's value itself
because "multiple frequency"
close "w^2 = 1/2" "sqrt(1/2)" "$(of_mode 1 im)" 1e-9 # mu has an error of 1e-17, its square root that of w: 3e-9/2 at the worst
find_modes $dir/cr3bp.lag L1 # l^4 + (2 - c) l^2 + (1 + 2 c)(1 - c) = 0 with c = (1 - mu)/r1^3 + mu/r2^3 (Szebehely, 1967, ch. 5)
verdict unstable
x=$(at_rest x)
c="((1 - 0.01215)/($x + 0.01215)^3 + 0.01215/(1 - 0.01215 - $x)^3)"
close "forces at L1" 0 "$(calc "$x - (1 - 0.01215)/($x + 0.01215)^2 + 0.01215/(1 - 0.01215 - $x)^2")" 1e-13
close "growth" "sqrt(($c - 2 + sqrt(9*$c^2 - 8*$c))/2)" "$(of_mode 1 re)"
close "oscillation" "sqrt((2 - $c + sqrt(9*$c^2 - 8*$c))/2)" "$(of_mode 2 im)"

# ---- states
find_modes $dir/lorenz.lag # at the origin: -8/3, (-11 -+ sqrt(81 + 40 r))/2 (Lorenz, 1963)
verdict unstable
close "growth" "(-11 + sqrt(81 + 40*28))/2" "$(of_mode 1 re)"
close "along z" "-8/3" "$(of_mode 2 re)"
close "decay" "(-11 - sqrt(81 + 40*28))/2" "$(of_mode 3 re)"
find_modes $dir/lorenz.lag wing # x = y = sqrt(b (r - 1)); l^3 + (s + b + 1) l^2 + b (s + r) l + 2 s b (r - 1) = 0: sums and products of roots
close "its place" "sqrt(8/3*27)" "$(at_rest x)"
close "the sum of the eigenvalues" "-(10 + 8/3 + 1)" "$(calc "2*$(of_mode 1 re) + $(of_mode 2 re)")"
close "their product" "-2*10*8/3*27" "$(calc "(($(of_mode 1 re))^2 + $(of_mode 1 im)^2)*$(of_mode 2 re)")"
if [ -n "${SLOW:-}" ]; then
  find_modes $dir/motor.lag # w sin th = K i, i = U/R; l^3 + R/L l^2 + (K^2/L + w cos th)/J l + R w cos th/(L J) = 0
  close "current" 3 "$(at_rest i)"
  close "angle" "atan2(0.6, 0.8)" "$(at_rest th)"
  close "the sum of the eigenvalues" "-2/0.5" "$(calc "$(of_mode 1 re) + 2*$(of_mode 2 re)")"
  close "their product" "-2*0.5*0.8/(0.5*0.01)" "$(calc "(($(of_mode 2 re))^2 + $(of_mode 2 im)^2)*$(of_mode 1 re)")"
fi
find_modes $dir/indefinite.lag # x'' = -2 x, y'' = -2 y
close "an indefinite mass matrix" "sqrt(2)" "$(of_mode 2 im)"
verdict undecided

cat >"$TMP/cooling.lag" <<'END'
model cooling "Newton's law: T' = (T0 - T)/tau"
state T [degC]
param T0 = 20 [degC], tau = 5 [s] > 0
flow T' = (T0 - T)/tau
scene cup { start T = 80 [degC] }
END
find_modes "$TMP/cooling.lag"
title="Newton's law of cooling"
close "a scale with a zero of its own" 20 "$(at_rest T)"
close "a change has none" 1 "$(shape 1 T)"
close "decay" -0.2 "$(of_mode 1 re)"

# ---- cases that the linearisation does not decide, and poor starts
find_modes $dir/quartic.lag bowl
verdict undecided
because "a zero mode"
close "flat, but found" 0 "$(at_rest x)" 0
is "$title: not free" false "$(of_mode 1 free)"
find_modes $dir/quartic.lag crest # the derivative of the force is 0 at the start
close "downhill from a stationary slope" "-pi/2" "$(at_rest x)"
verdict stable

for scene in hill valley; do # neither moves along x or y alone; V = -x^2 y^2 falls between them
  find_modes $dir/cross.lag $scene
  verdict undecided
  because "a zero mode, or several together"
  is "$title: free alone" true "$(of_mode 1 free)"
done
find_modes $dir/cross.lag along # on the x axis nothing pulls; y'' = 2 x^2 y
verdict unstable
close "it stays there" 0.3 "$(at_rest x)" 0
close "growth" "sqrt(2)*0.3" "$(of_mode 2 re)"
find_modes $dir/root.lag # x'' = -3/2 sqrt(x)
verdict undecided
because "jump here, or have no limit"
find_modes $dir/root.lag two
verdict undecided
because "jump here, or have no limit"
find_modes $dir/root.lag one
verdict stable
close "frequency" 1 "$(of_mode 1 im)"

# ---- refusals
refuses() { # STATUS WORDS ARGS...
  want=$1 words=$2
  shift 2
  "$LAGC" modes "$@" >"$TMP/out" 2>"$TMP/err"
  got=$?
  [ $got = "$want" ] && grep -qF -e "$words" "$TMP/err" || { echo "status $got"; cat "$TMP/out" "$TMP/err"; return 1; }
}
check "explicit time" refuses 2 "t stands in its equations" $dir/driven.lag rattled
check "an input that changes" refuses 2 "by its input F, so nothing stays at rest; hold it: F=0" $dir/driven.lag
check "holding another does not help" refuses 2 "hold it: F=0" $dir/driven.lag G=1
find_modes $dir/driven.lag F=1
close "an input that is held" 2 "$(at_rest x)" # (1 + 3)/k
check "no equilibrium: what is left" refuses 3 "x'' is still -1 m/s^2. A force that vanishes nowhere has none: add a force that balances it, such as a spring; where it vanishes, start near there: x=VALUE" $dir/quartic.lag incline
# the advice works as printed
sed "s/potential = F\*x }/potential = F*x + 1 [N\/m]*x^2 }/" $dir/quartic.lag >"$TMP/held.lag"
check "held by a spring" sh -c "'$LAGC' modes '$TMP/held.lag' incline | grep -q '^equilibrium: '"
# contacts that are open are no constraint: rest at y = 1 - m g/k, a rate -c/(2 m) across the floor, where small motion has no modes once it is met
find_modes $dir/ball.lag
close "open contacts" 1e-12 0.8038 "$(at_rest y)"
check "open contacts: said" sh -c "'$LAGC' modes $dir/ball.lag | grep -q '^note: contacts, and constraints with .while., do not act here' && '$LAGC' modes $dir/ball.lag | grep -q 'decays 1 '"
check "a contact closed at the start" refuses 2 "contact floor is closed at the start" $dir/ball.lag stands
check "a contact closed at the equilibrium" refuses 2 "contact floor is closed at the equilibrium next to the start" $dir/ball.lag k=5
check "no equilibrium: it runs away" refuses 3 "forces only vanish at infinity" $dir/quartic.lag repelled
check "no equilibrium: it fades at once" refuses 3 "forces only vanish at infinity" $dir/quartic.lag escaping
slow check "no equilibrium: and leads nowhere" refuses 3 "no equilibrium found" models/swinging_atwood.lag
check "no equilibrium, as JSON" sh -c "! '$LAGC' modes $dir/quartic.lag incline --json 2>/dev/null | grep -v '\"status\": \"no equilibrium\"'"
check "a singular mass matrix" refuses 3 "the mass matrix is singular at the start: choose other coordinates" $dir/spherical.lag pole
check "options of a run" refuses 2 '`--until` is an option of `lagc run`' models/pendulum.lag --until 3
check "an output file" refuses 2 '`-o` is an option of `lagc derive`' models/pendulum.lag -o x.csv
check "an unknown name" refuses 2 "no such parameter, coordinate or input" models/pendulum.lag nothing=3
check "without GSL" refuses 2 "built without GSL" models/pendulum.lag --no-gsl
"$LAGC" build models/pendulum.lag -o "$TMP/plain"
plain() { "$TMP/plain" --modes 2>&1 | grep -q "lagc build models/pendulum.lag --with linear"; }
check "a simulator without linearisation says what to write" plain
"$LAGC" build models/pendulum.lag --with linear -o "$TMP/full"
check "a simulator with it takes --modes" sh -c "'$TMP/full' --modes th=3 | grep -q 'grows 0.3192754'"

# ---- frequency over amplitude. Tolerance: 1e-12, some ten thousand roundings; coefficients of order 1 and less
bends() { sed -n "2s/.*\"amplitude\": {.*\"$1\": \([^,}]*\).*/\1/p" "$TMP/modes"; }
bend_of() { sed -n "s/.*\"of\": \"$1\", \"a2\": \([^,]*\), \"a4\": \([^,]*\),.*/\\$2/p" "$TMP/modes"; }
find_modes models/pendulum.lag small --amplitude # pi/(2 K(sin(A/2)))
close "1 - A^2/16" "-1/16" "$(bends a2)" 1e-12
close "+ A^4/3072" "1/3072" "$(bends a4)" 1e-12
# by powers of k3 in mm^2: 3/8 k3, -21/256 k3^2 (A. Nayfeh, Introduction to Perturbation Techniques, 1981, chapter 4)
find_modes $dir/duffing.lag --amplitude
close "hardens" "3/8*0.7" "$(bends a2)" 1e-12
close "then less" "-21/256*0.49" "$(bends a4)" 1e-12
# the potential x^2/2 + x^3/3: mpmath, by quadrature of the period and A half the distance of turning points
find_modes $dir/duffing.lag one_sided --amplitude
close "softens" "-5/12" "$(bends a2)" 1e-12
close "faster" "-455/1728" "$(bends a4)" 1e-12
# beside growth: y = A^2/2 + A^2/10 cos 2 w t to the second order, so w^2 = 1 + 2 (1/2 + 1/20) A^2
find_modes $dir/pass.lag --amplitude
close "across growth" "11/20" "$(bend_of x 1)" 1e-12
# Henon and Heiles: H = I - 5/12 I^2 + 7/12 L^2 + ... (F. Gustavson, Astron. J. 71 (1966) 670), I = A^2/2 and L = 0; A^4 by
# Lindstedt's series in fractions; y is the one-sided spring above. The equal frequencies excite each other in neither.
find_modes models/henon_heiles.lag x=0.01 y=0 --amplitude
close "across its valley" "-5/12" "$(bend_of x 1)" 1e-12
close "by the fourth power" "553/1728" "$(bend_of x 2)" 1e-12
close "along its valley" "-5/12" "$(bend_of y 1)" 1e-12
# L4, by coefficients of Birkhoff's normal form in actions (A. Deprit, A. Deprit-Bartholome, Astron. J. 72 (1967) 173), times A^2
# over the action, the energy of the linear mode over w^2, in 30 digits
find_modes $dir/cr3bp.lag L4 --amplitude
close "a libration of long period" "-0.119016462697392" "$(bends a2)" 1e-12
close "one of short period" "0.0300862102547055" "$(sed -n 3p "$TMP/modes" | sed 's/.*"a2": \([^,]*\),.*/\1/')" 1e-12
by_action() { sed -n 's/.*"by_action": \[\[\(.*\)\]\].*/\1/p' "$TMP/modes" | tr -d '[] ' | cut -d, -f"$1"; }
close "of the long one by that of short period" "1.7126241458983780" "$(by_action 2)" 1e-11 # -B of theirs: the long one's action is < 0
close "and back" "1.7126241458983780" "$(by_action 3)" 1e-11
close "their C" "0.67717405509006792" "$(by_action 1)" 1e-11
close "their A" "0.23135546980127810" "$(by_action 4)" 1e-11
# Henon and Heiles with y at 3/2 of x: -1/2 sum of k d/dJ |h_k|^2/(k w), h_k the harmonics of x^2 y - y^3/3, is 1/(w1 w2^3) - 2/(w1 w2 (4 w1^2 - w2^2)) for J1 J2
sed 's|(x^2 + y^2)/2 + x^2|(x^2 + 9/4*y^2)/2 + x^2|; /^expect/d' models/henon_heiles.lag >"$TMP/detuned.lag"
find_modes "$TMP/detuned.lag" regular x=0.01 y=0 --amplitude
close "x by the action of y" "8/27 - 4/3/1.75" "$(by_action 2)" 1e-12
close "y by the action of x" "8/27 - 4/3/1.75" "$(by_action 3)" 1e-12
check "equal frequencies exchange amplitudes" sh -c "'$LAGC' modes models/henon_heiles.lag x=0.01 y=0 --amplitude | grep -q '^modes 1, 2: no shifts by amplitudes alone: resonance w1 = w2$'"
printf "model sum\ncoord x, y, z\nkinetic = (x'^2 + y'^2 + z'^2)/2\npotential = (x^2 + 9/4*y^2 + 25/4*z^2)/2 + x*y*z\n" >"$TMP/sum.lag"
check "a sum that resonates" sh -c "'$LAGC' modes '$TMP/sum.lag' --amplitude | grep -q '^modes 1, 2: no shifts by amplitudes alone: resonance w1 + w2 = w3$'"
check "a resonance is not divided by" sh -c "'$LAGC' modes $dir/cr3bp.lag L4 mu=0.024293897142052 --amplitude | grep -q '^mode 1: no series of its own: resonance 2 w1 = w2$'"
check "a near one is printed" sh -c "'$LAGC' modes $dir/cr3bp.lag L4 mu=0.0242 --amplitude | grep -q '^mode 1: .*for small A only, near the resonance 2 w1 = w2, but for 0.0063 w1$'"
check "three bodies in a triangle: two equal modes" sh -c "'$LAGC' modes $dir/triangle.lag --amplitude | grep -q '^mode 4: frequency times 1 - 0.4.* A^2, no A^4: resonance 1 w4 = w5;'"
check "a shift that grows" sh -c "'$LAGC' modes $dir/valley.lag --amplitude | grep -q 'it drifts along mode 1$'"
# first order, Lotka and Volterra: mpmath, in 60 digits, by the period as an integral over a turn
printf 'model prey\nstate u, v\nflow u%s = u - u*v\nflow v%s = -v + u*v\nscene s { start u = 1.1, v = 1 }\n' "'" "'" >"$TMP/prey.lag"
find_modes "$TMP/prey.lag" --amplitude
close "predators and prey" "-1/12" "$(bends a2)" 1e-12
close "to the fourth power" "17/1728" "$(bends a4)" 1e-12
# the mean of x^2 x'^2 over a period of A cos t is A^4/8
printf "model slow\ncoord x\nkinetic = x'^2/2\npotential = x^2/2\nforce x = -x^2*x'\nscene s { start x = 0.1 }\n" >"$TMP/slow.lag"
find_modes "$TMP/slow.lag" --amplitude
close "friction that grows" "-1/8" "$(bends growth)" 1e-12
check "as text" sh -c "'$LAGC' modes '$TMP/slow.lag' --amplitude | grep -qF \"no family of periodic motions: A' = -0.125 A^3\""
"$LAGC" build models/double_pendulum.lag --with linear --method taylor -o "$TMP/compiled" && "$TMP/compiled" --modes --amplitude >"$TMP/compiled.txt"
check "compiled C agrees" sh -c "'$LAGC' modes models/double_pendulum.lag --amplitude | tail -2 | grep -qxF -f '$TMP/compiled.txt'"
check "no series" refuses 2 "needs a model without if, abs" $dir/root.lag --amplitude
check "frequency of a steady motion" refuses 2 "is for modes about rest" models/spherical_pendulum.lag cone --steady --amplitude

# ---- printed report
text() { "$LAGC" modes "$@" 2>&1; }
is "velocities of the start do not matter" "equilibrium: 0" "$(text models/pendulum.lag th=0 "th'=1" | sed -n 's/: the start itself, at rest (with the velocities of the start: --steady)/: 0/p')"
check "how far from the start" sh -c "'$LAGC' modes models/pendulum.lag th=3 | grep -q 'from the start th moved by 0.141593 rad'"
check "components that are not 0" sh -c "'$LAGC' modes models/string.lag -D N=8 | grep -q 'u\[1\] 1, u\[2\] 1, u\[4\] -1, u\[5\] -1, u\[7\] 1, u\[8\] 1'"
slow check "a large family in part" sh -c "'$LAGC' modes models/string.lag -D N=30 | grep -q ' (every 2)$'"
check "phases" sh -c "'$LAGC' modes $dir/hill.lag | grep -q 'y 1@90' && '$LAGC' modes $dir/hill.lag | grep -q '^a@p: '"
check "damping ratio and decay time" sh -c "'$LAGC' modes $dir/oscillator.lag | grep -q '0.1  *decays 5 '"
check "a model with abs or if: a note" sh -c "'$LAGC' modes tests/exec/models/motor.lag volt=0 | grep -q '^note: the model has if, abs'"
check "a coordinate that lost its meaning: a note" sh -c "'$LAGC' modes $dir/spherical.lag | grep -q '^note: the mass matrix is nearly singular'"
check "a note on the pole is not all" sh -c "'$LAGC' modes $dir/spherical.lag | grep -q '^undecided .*as a longitude does at a pole'"
twins() { "$LAGC" modes "$@" | grep -q '^a mode that grows stands for two: another decays as fast'; }
check "growth has a twin" twins models/pendulum.lag th=3 # +-sqrt(g/l)
check "and so has a spiral" twins $dir/cr3bp.lag mu=0.04 # +-a +- bi
check "not where energy is lost" sh -c "! '$LAGC' modes $dir/hill.lag rubbed | grep -q 'stands for two'"
check "help" sh -c "'$LAGC' help modes | grep -q Lagrange || '$LAGC' help modes | grep -q equilibrium"
tap_end
