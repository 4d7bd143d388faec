#!/bin/sh
# lagc action: action variables and frequencies against closed forms, evaluated by mpmath with 30 digits; the adiabatic invariant of an oscillator, its jump at a separatrix,
# Hannay's angle; motions that do not turn, systems that do not separate.
. tests/tap.sh

# action FILE SCENE COORDINATE NAME ARGUMENT...: the number behind "NAME = " on the coordinate's line.
action() { f=$1 s=$2 q=$3 name=$4; shift 4; "$LAGC" action "$TMP/$f.lag" "$s" "$@" | sed -n "s|^$q: \(.*, omega = \)*$name = \([^,]*\).*|\2|p"; }
# 1e-14: relative, beside numbers of size 0.1 to 10; 16 digits are printed.
agrees() { near "$1: J" 1e-14 "$2" "$(action "$4" "$5" "$6" J)"; [ "$3" = - ] || near "$1: omega" 1e-14 "$3" "$(action "$4" "$5" "$6" dE/dJ)"; }
told() { status=$1 words=$2; shift 2; "$LAGC" action "$@" >"$TMP/out" 2>&1; [ $? = "$status" ] && grep -q -F -e "$words" "$TMP/out" || { cat "$TMP/out"; false; }; }

cat >"$TMP/oscillator.lag" <<'END'
model oscillator
coord q
momentum p of q
param m = 2 > 0, w = 3 > 0
hamiltonian = p^2/(2*m) + m*w^2*q^2/2
scene s { start q = 1, p = 2 }
scene released { start q = 1.3 }
scene rest { span 1 }
END
agrees "an oscillator: E/w" 3.33333333333333333 3 oscillator s q
agrees "released at rest" 5.07 3 oscillator released q
near "with values of the command line" 1e-14 18.5 "$(action oscillator s q J q=3 w=2)"
cat >"$TMP/pendulum.lag" <<'END'
model pendulum
coord th periodic
param m = 2 > 0, l = 0.7 > 0, g = 9.81 > 0
lagrangian = m/2*l^2*th'^2 + m*g*l*cos(th)
scene s { start th = 2 }
scene near { start th = 3.1 }
scene round { start th = 0, th' = 20 }
END
# J = (8/pi) m l^2 w0 (E(k) - (1 - k^2) K(k)), omega = pi w0/(2 K(k)), k = sin(th0/2)
agrees "a pendulum" 5.86192359470219384785 2.81703165604276250874 pendulum s th
# going round: J = (2/pi) sqrt(2 m l^2 (E + m g l)) E(k), omega = pi sqrt((E + m g l)/(2 m l^2))/K(k), k^2 = 2 m g l/(E + m g l)
agrees "a pendulum that goes round" 18.8941134266863135722 19.2659864375410984307 pendulum round th
near "the other way" 1e-14 -18.8941134266863135722 "$(action pendulum round th J "th'=-20")"
# 0.04 rad from the top E - V has lost two digits
near "near the separatrix" 1e-13 9.33062020079675179285 "$(action pendulum near th J)"
near "its frequency" 1e-13 1.11798413698563502666 "$(action pendulum near th dE/dJ)"

# ---- beside a separatrix: J = (8/pi)(E(k) - k'^2 K(k)), period 4 K(k), k = sin(th/2) in 40 digits; omega's digits are those that E - H keeps.
cat >"$TMP/top.lag" <<'END'
model top
coord th periodic
lagrangian = th'^2/2 + cos(th)
scene s { start th = 3.141592653 }
scene on { start th = 0, th' = 2 }
END
cat >"$TMP/saddle.lag" <<'END'
model saddle
coord x
lagrangian = x'^2/2 + x^2/2 - x^4/4
scene s { start x = 1e-9 }
END
beside() { # beside FILE SCENE COORDINATE J PERIOD DIGITS ARGS...: J to 12 digits; the period as far as it is printed, and that is DIGITS or more
  f=$1 scene=$2 q=$3 J=$4 period=$5 digits=$6
  shift 6
  "$LAGC" action "$TMP/$f.lag" "$scene" "$@" >"$TMP/out" || { cat "$TMP/out"; return 1; }
  awk -v q="$q:" -v J="$J" -v T="$period" -v least="$digits" '$1 == q { sub(",", "", $4); j = $4; for (i = 1; i < NF; i++) if ($i == "period") t = $(i + 1) }
    END { sub(",", "", t); n = length(t) - 1; unit = 10^(index(t, ".") - length(t)); print j, t
          exit !(j/J - 1 < 1e-12 && 1 - j/J < 1e-12 && n >= least && t - T < 0.51*unit + 1e-13*T && T - t < 0.51*unit + 1e-13*T) }' "$TMP/out" || { cat "$TMP/out"; return 1; }
}
check "a pendulum 6e-10 rad from the top" beside top s th 2.54647908947032537 93.3227625016474865 7
check "4e-9 rad" beside top s th 2.54647908947032528 86.0984510861105567 8 th=3.14159265
check "and 3e-6 rad" beside top s th 2.54647908943576527 59.6761549495602935 9 th=3.14159
# Going round with k = sqrt((E + 1)/2): J = (4/pi) k E(1/k), over a turn in 2 K(1/k)/k
check "just over the top" beside top s th 1.27323954558818351 25.7984396515603 9 th=0 "th'=2.0000000001"
check "just not" beside top s th 2.54647907387578002 46.9917091296203 5 th=0 "th'=1.999999999"
check "on the separatrix, as far as 2 tells" told 3 "th: no action variable: it lies on a separatrix" "$TMP/top.lag" on
check "at the top it rests" told 0 "th: J = 0, at rest" "$TMP/top.lag" th=pi
# V = x^4/4 - x^2/2, between a and b, a^2 + b^2 = 2: the period 2 sqrt(2)/b K(m), m = 1 - a^2/b^2
check "1e-9 from a saddle" beside saddle s x 0.212206590789193777 44.9122675766925489 15
check "1e-5 from it" beside saddle s x 0.212206590570422684 26.4915868336586179 15 x=1e-5
check "over the saddle, around both wells" beside saddle s x 0.424413182015929756 52.9831736637435 14 x=0 "x'=1e-5"
"$LAGC" action "$TMP/top.lag" s --json >"$TMP/json"
check "in JSON" grep -q '"digits": 16, "frequency_digits": \(8\|9\|10\),' "$TMP/json"
cat >"$TMP/kepler.lag" <<'END'
model kepler
coord r, th periodic
param m = 1.5 > 0, k = 2 > 0
lagrangian = m/2*(r'^2 + r^2*th'^2) + k/r
scene s { start r = 1, th' = 1.3, r' = 0.2 }
scene thin { start r = 1, th' = 0.05 }
scene away { start r = 1, th' = 3 }
scene fall { start r = 1 }
END
# J_r = -L + k sqrt(m/(2 |E|))
agrees "Kepler's radial action" 0.116509770954871941994 0.679890325101531847549 kepler s r
agrees "of a thin ellipse" 1.15031937452914565252 3.26139460704736006446 kepler thin r
near "with L as the action of the angle" 1e-14 1.95 "$(action kepler s th J)"
cat >"$TMP/morse.lag" <<'END'
model morse
coord x
momentum p of x
param m = 1 > 0, D = 2 > 0, a = 1.3 > 0
hamiltonian = p^2/(2*m) + D*(1 - exp(-a*x))^2
scene s { start x = 0.5 }
scene high { start p = 1.99 }
scene gone { start p = 2.5 }
END
# J = sqrt(2 m)/a (sqrt(D) - sqrt(D - E))
agrees "Morse" 0.187100392098125417127 2.28380033735416804505 morse s x
agrees "Morse, 1 percent below dissociation" 1.38480781265047554681 0.259674796620696325905 morse high x
cat >"$TMP/poschl.lag" <<'END'
model poschl
coord x
momentum p of x
param m = 1 > 0, U = 3 > 0, a = 0.8 > 0
hamiltonian = p^2/(2*m) - U/cosh(a*x)^2
scene s { start x = 0.5 }
END
# J = sqrt(2 m)/a (sqrt(U) - sqrt(-E))
agrees "Poeschl and Teller" 0.229616846677534046139 1.81263701235292069029 poschl s x
cat >"$TMP/fast.lag" <<'END'
model fast "A fast particle on a spring"
coord x
momentum p of x
hamiltonian = sqrt(1 + p^2) + x^2/2
scene s { start p = 2 }
END
agrees "H that is not quadratic in p, by mpmath's quadrature" 1.49312970141718692123 0.715965868598615928422 fast s x
cat >"$TMP/spherical.lag" <<'END'
model spherical
coord r, th, phi periodic
momentum pr of r, pth of th, pphi of phi
hamiltonian = (pr^2 + pth^2/r^2 + pphi^2/(r^2*sin(th)^2))/2 - 1/r
scene s { start r = 1, th = 1.2, pr = 0.1, pth = 0.4, pphi = 0.6 }
END
# J_r = -L + 1/sqrt(-2 E), J_th = L - |p_phi|
agrees "Kepler in space, one pair after the other: r" 0.0825876932134292853776 1.68424188009156542095 spherical s r
agrees "th" 0.157900942921253837742 - spherical s th
agrees "phi" 0.6 - spherical s phi
cat >"$TMP/sum.lag" <<'END'
model sum
coord x, y
momentum px of x, py of y
hamiltonian = (px^2 + x^2)/2 + (py^2 + 4*y^2)/2
scene s { start x = 0.1, py = 0.2 }
END
agrees "a sum of two oscillators: x" 0.005 1 sum s x
agrees "y" 0.01 2 sum s y

# ---- separation ----
# parts FILE: the separated equations; conserved FILE: those without constants of other parts are conserved, by the code of brackets.
parts() { "$LAGC" action "$TMP/$1.lag" | sed -n 's/^  \([a-z]*: .*\)/\1/p'; }
conserved() {
  parts "$1" | grep -v '= energy$' | sed 's/^[a-z]*: \(.*\) = .*/\1/' | while IFS= read -r left; do
    got=$("$LAGC" derive "$TMP/$1.lag" --bracket "$left, energy" 2>&1)
    [ "${got##*= }" = 0 ] || echo "$left: $got"
  done
}
is "spherical coordinates: L^2 is the constant of th" "phi: pphi = alpha_phi
th: pth^2/2 + pphi^2/(2*sin(th)^2) = alpha_th
r: pr^2/2 - 1/r + alpha_th/r^2 = energy" "$(parts spherical)"
empty "they are conserved" "$(conserved spherical)"
is "polar ones" "th: p_th = alpha_th
r: (p_r^2 + p_th^2/r^2)/(2*m) - k/r = energy" "$(parts kepler)"
is "a sum" "x: px^2/2 + x^2/2 = alpha_x
y: py^2/2 + 2*y^2 + alpha_x = energy" "$(parts sum)"
empty "of conserved energies" "$(conserved sum)"
# L. D. Landau, E. M. Lifshitz, Mechanics, 48: parabolic coordinates xi = r + z, eta = r - z.
cat >"$TMP/parabolic.lag" <<'END'
model parabolic
coord xi, eta, phi periodic
momentum px of xi, pe of eta, pphi of phi
param m = 1 > 0, k = 1 > 0
hamiltonian = 2*(xi*px^2 + eta*pe^2)/(m*(xi + eta)) + pphi^2/(2*m*xi*eta) - 2*k/(xi + eta)
scene s { start xi = 1, eta = 1.2, px = 0.1, pe = 0.2, pphi = 0.6 }
END
is "parabolic coordinates separate together" "phi: pphi = alpha_phi
xi: xi*px^2/2 + pphi^2/(8*xi) - m*k/2 - m*energy*xi/4 = alpha_xi
eta: eta*pe^2/2 + pphi^2/(8*eta) - m*energy*eta/4 = -alpha_xi" "$(parts parabolic)"
empty "by a component of the Runge-Lenz vector, conserved" "$(conserved parabolic)"
near "their actions and p_phi add up to k sqrt(m/(2 |E|))" 1e-14 0.84133864041223487 "$(awk -v a="$(action parabolic s xi J)" -v b="$(action parabolic s eta J)" 'BEGIN { printf "%.17g", a + b + 0.6 }')"
empty "their frequencies are not printed" "$("$LAGC" action "$TMP/parabolic.lag" | grep omega)"
cat >"$TMP/elliptic.lag" <<'END'
model elliptic "Two equal centres, in elliptic coordinates"
coord u, v periodic
momentum pu of u, pv of v
param c = 1 > 0, k = 1 > 0
hamiltonian = (pu^2 + pv^2)/(2*c^2*(cosh(u)^2 - cos(v)^2)) - 2*k*cosh(u)/(c*(cosh(u)^2 - cos(v)^2))
scene s { start u = 1, v = 1.2, pu = 0.1, pv = 0.2 }
END
is "elliptic coordinates" "u: pu^2/2 - 2*c*k*cosh(u) - c^2*energy*cosh(u)^2 = alpha_u
v: pv^2/2 + c^2*energy*cos(v)^2 = -alpha_u" "$(parts elliptic)"
empty "conserved" "$(conserved elliptic)"
# B. Carter, Phys. Rev. 174 (1968) 1559: the constant of th is half of Carter's.
cat >"$TMP/kerr.lag" <<'END'
model kerr
coord T, r, th, ph periodic
momentum pT of T, pr of r, pth of th, pph of ph
param M = 1 > 0, a = 0.6
let Sigma = r^2 + a^2*cos(th)^2, Delta = r^2 - 2*M*r + a^2
hamiltonian = (Delta*pr^2 + pth^2 + (pph/sin(th) + a*sin(th)*pT)^2 - ((r^2 + a^2)*pT + a*pph)^2/Delta)/(2*Sigma)
scene s { start r = 10, th = 1.2, pT = -0.96, pr = 0, pth = 1.5, pph = 3.5 }
END
is "Kerr's metric: Carter's constant" "th: pth^2/2 + (pph/sin(th) + a*pT*sin(th))^2/2 - a^2*energy*cos(th)^2 = -alpha_r" "$(parts kerr | grep '^th')"
empty "conserved by both of its forms" "$(conserved kerr)"
cat >"$TMP/tied.lag" <<'END'
model tied
coord x, y, z
momentum px of x, py of y, pz of z
hamiltonian = (px^2 + py^2 + pz^2)/2 + (x^2 + y^2 + z^2)/2 + y^2*z
scene s { start x = 1, y = 0.1 }
END
# w(t)^2 = (w1^2 + w2^2)/2 + (w2^2 - w1^2)/2 tanh(r t) from t = -20 to 20, where tanh is 1 to 17 digits. J_out/J_in - 1 is a constant and a function of twice the
# phase, so four phases, 45 degrees apart, have the mean of all: 2 sinh^2(pi (w2 - w1)/(2 r))/(sinh(pi w1/r) sinh(pi w2/r)).
cat >"$TMP/slow.lag" <<'END'
model slow
coord x
momentum p of x
param w1 = 1 > 0, w2 = 2 > 0, r = 1 > 0, begin = -20, phase = 0
let w = sqrt((w1^2 + w2^2)/2 + (w2^2 - w1^2)/2*tanh(r*(t + begin)))
hamiltonian = p^2/2 + w^2*x^2/2
scene s { start x = cos(phase), p = sin(phase); span 40; tolerance 1e-14; method taylor }
END
ratios() {
  for k in 0 1 2 3; do
    "$LAGC" run "$TMP/slow.lag" "phase=$k*pi/4" "r=$1" --observe x --observe p --json --quiet >"$TMP/end"
    x=$(sed 's/.*"final": {[^}]*"x": \([^,}]*\).*/\1/' "$TMP/end") p=$(sed 's/.*"final": {[^}]*"p": \([^,}]*\).*/\1/' "$TMP/end")
    echo "$(action slow s x J "phase=$k*pi/4" "r=$1") $(action slow s x J begin=20 "r=$1" "x=$x" "p=$p")"
  done | awk '{ sum += $2/$1 } END { printf "%.15g", sum/4 - 1 }'
}
# 1e-12: 40 units of time at a tolerance of 1e-14, and 15 digits of the final state
near "the action of a slow oscillator" 1e-12 "$(awk 'function sinh(x) { return (exp(x) - exp(-x))/2 } BEGIN { pi = 3.14159265358979324; printf "%.15g", 2*sinh(pi/2)^2/(sinh(pi)*sinh(2*pi)) }')" "$(ratios 1)"
near "of a faster one" 1e-12 "$(awk 'function sinh(x) { return (exp(x) - exp(-x))/2 } BEGIN { pi = 3.14159265358979324; printf "%.15g", 2*sinh(pi/4)^2/(sinh(pi/2)*sinh(pi)) }')" "$(ratios 2)"

# ---- across the separatrix ----
# A pendulum whose w grows slowly from 0 captures what goes round: the area 2 pi p0 of a turn becomes half the area of a swing, J = 2 p0, but for a jump that depends
# on the phase, J - 2 p0 = -(8/pi) (w'/w) ln(2 sin(pi xi)), w where a turn fills the loop, 8 w = 2 pi p0, xi spread evenly over 0 to 1: its mean is 0, its mean square
# (8/pi)^2 (w'/w)^2 pi^2/12, its least value that at 1/2. A. V. Timofeev, Sov. Phys. JETP 48, 656 (1978); J. R. Cary, D. F. Escande, J. L. Tennyson, Phys. Rev. A 34, 4256 (1986).
cat >"$TMP/capture.lag" <<'END'
model capture
coord q
momentum p of q
param top = 3 > 0, T = 400 > 0, p0 = 2, phase = 0
let w = top*(t/T - sin(2*pi*t/T)/(2*pi))
hamiltonian = p^2/2 - w^2*cos(q)
observe J = action(q)
scene s { start q = phase, p = p0; span 400; tolerance 1e-12; method taylor; output J every 100; measure jump = J - 2*p0 }
END
# The mean, over the root of the mean square, and that root and the least value, over their closed forms.
"$LAGC" sweep "$TMP/capture.lag" "phase=0..$(awk 'BEGIN { printf "%.17g", 8*atan2(1, 1)*199/200 }'):200" --quiet -o - | awk -F, '
  BEGIN {
    pi = 4*atan2(1, 1); top = 3; p0 = 2; w = pi*p0/4; least = 9
    tau = 0.5; for (k = 0; k < 9; k++) tau -= (top*(tau - sin(2*pi*tau)/(2*pi)) - w)/(top*(1 - cos(2*pi*tau)))
    unit = 8/pi*top*(1 - cos(2*pi*tau))/400/w
  }
  $2 ~ /^-?[0-9]/ { d = $2; n++; sum += d; squares += d*d; if (d < least) least = d }
  END { if (n == 200) printf "%.6g %.6g %.6g", sum/n/sqrt(squares/n), sqrt(squares/n)/(unit*pi/sqrt(12)), least/(-unit*log(2)) }' >"$TMP/jumps"
# Of the next order, w'/w = 1 percent, is the least value; 200 phases miss a tenth of the logarithm's tail.
near "jumps at the separatrix: their mean" 0.02 0 "$(cut -d ' ' -f 1 "$TMP/jumps")"
near "their mean square" 0.1 1 "$(cut -d ' ' -f 2 "$TMP/jumps")"
near "the least" 0.01 1 "$(cut -d ' ' -f 3 "$TMP/jumps")"

# ---- Hannay's angle ----
# A bead on a hoop that is turned round slowly falls behind by 4 pi A/l, 2 pi/l times which is Hannay's 8 pi^2 A/l^2. The mean over starts at equal lengths along the hoop
# is off by a multiple of 1/T^3, so that (8 m(2 T) - m(T))/7 is the limit. Fifteen starts, an odd number: the ellipse is the same after half a turn.
starts=$(awk 'function speed(u) { return sqrt(4*sin(u)^2 + cos(u)^2) }
  function arc(u,   k, sum) { for (k = 0; k < 200; k++) sum += speed(u*k/200) + 4*speed(u*(k + 0.5)/200) + speed(u*(k + 1)/200); return sum*u/1200 }
  BEGIN { for (i = 0; i < 15; i++) { want = 9.688448220547676*i/15; u = want/1.5; for (k = 0; k < 30; k++) u -= (arc(u) - want)/speed(u); printf "%s%.15g", i ? "," : "", u } }')
behind() { "$LAGC" sweep models/hannay_hoop.lag ellipse "u0=$starts" "T=$1" --until "$1" --tol 1e-13 --measure behind --quiet -o - | awk -F, 'FNR > 1 && $3 == "ok" { n++; sum += $2 } END { if (n == 15) printf "%.15g", sum/n }'; }
# 1e-7 rad: the next order is 1e-8, errors of the motion are 1e-9
near "Hannay's angle of a hoop, in the limit of slow turns" 1e-7 "$(awk 'BEGIN { pi = 4*atan2(1, 1); printf "%.15g", 8*pi*pi*2*pi/9.688448220547676^2 }')" \
  "$(echo "$(behind 800) $(behind 1600)" | awk '{ if (NF == 2) printf "%.15g", 8*atan2(1, 1)/9.688448220547676*(8*$2 - $1)/7 }')"

# ---- no action ----
check "at rest" told 0 "q: J = 0, at rest" "$TMP/oscillator.lag" rest
printf 'model tilt\ncoord q periodic\nmomentum p of q\nhamiltonian = p^2/2 - cos(q) + 0.1*q\nscene s { start p = 30 }\n' >"$TMP/tilt.lag"
check "H that differs from turn to turn has no mean of p" told 3 "q: no action variable: its motion does not turn" "$TMP/tilt.lag"
check "a comet" told 0 "r: no action variable: its motion does not turn" "$TMP/kepler.lag" away
check "a molecule that breaks" told 3 "x: no action variable: its motion does not turn" "$TMP/morse.lag" gone
check "a fall into the centre" told 0 "r: no action variable: its motion ends where H is singular, before it turns" "$TMP/kepler.lag" fall
check "Henon and Heiles" told 3 "x: no action variable: H does not separate in these coordinates: Levi-Civita's condition for x and y fails" models/henon_heiles.lag
check "two of three are tied" told 0 "Levi-Civita's condition for y and z fails" "$TMP/tied.lag"
check "the third has its action" told 0 "x: J = 0.5, omega" "$TMP/tied.lag"
empty "and no separated equations are printed" "$("$LAGC" action "$TMP/tied.lag" | grep 'H separates')"
check "Kepler in Cartesian coordinates" told 3 "Levi-Civita's condition for x and y fails" models/kepler.lag
cat >"$TMP/wells.lag" <<'END'
model wells "two wells in p"
coord x
momentum p of x
hamiltonian = p^4/4 - p^2/2 + x^2/2
scene one { start x = 0.1, p = 1 }
scene both { start x = 0.1, p = 1.6 }
scene inner { start x = 0.1, p = 0.1 }
END
# The closed integral of x dp over 2 pi between the roots of p^4/4 - p^2/2 = E, by mpmath in 25 digits.
near "two wells in p, the motion in one" 1e-15 0.003542211874021359314 "$("$LAGC" action "$TMP/wells.lag" one | sed -n 's/^x: J = \([^,]*\),.*/\1/p')"
check "around both" told 3 "x: no action variable: H is not convex in its momentum along the curve" "$TMP/wells.lag" both
check "from between them" told 3 "x: no action variable: H is not convex in its momentum along the curve" "$TMP/wells.lag" inner
printf 'model wedge\ncoord x\nlagrangian = x'"'^2/2 - abs(x) - 0.3*x"'\nscene s { start x = 1 }\n' >"$TMP/wedge.lag"
# Slopes 1.3 and 0.7, E = 1.3: J = 2 sqrt(2)/(3 pi) E^(3/2) (1/1.3 + 1/0.7), the period 2 sqrt(2 E) (1/1.3 + 1/0.7). The curve is cut at the corner.
near "a corner of H" 1e-14 0.977636703331541 "$(action wedge s x J)"
near "and its frequency" 1e-13 0.886491539969074 "$(action wedge s x dE/dJ)"
# |x|^1.5 has no second derivative at 0, and no corner.
printf 'model root\ncoord x\nmomentum p of x\nhamiltonian = p^2/2 + abs(x)^1.5 + 0.3*x\nscene s { start x = 1 }\n' >"$TMP/root.lag"
check "digits that are not sure are not printed, which is said" told 0 "no more digits are sure, as H is not smooth along the curve" "$TMP/root.lag"
printf 'model spike\ncoord x\nlagrangian = x'"'^2/2 - x^2/2 - 5*exp(-((x - 0.5)/1e-5)^2)"'\nscene s { start x = 1 }\n' >"$TMP/spike.lag"
# From the bottom of a well whose walls are singular: 2 pi J = 2 pi (sqrt(2 E) - sqrt(2 a)) for a/sin(x)^2, here E = 0.425, a = 0.3.
printf 'model walls\ncoord x\nmomentum p of x\nhamiltonian = p^2/2 + 0.3/sin(x)^2\nscene s { start x = 90 [deg], p = 0.5; span 1 }\n' >"$TMP/walls.lag"
near "between singular walls, from the bottom" 1e-14 "$(awk 'BEGIN { printf "%.17g", sqrt(0.85) - sqrt(0.6) }')" "$("$LAGC" action "$TMP/walls.lag" | sed -n 's/^x: J = \([^,]*\),.*/\1/p')"
check "a barrier that the search missed" told 3 "x: no action variable: H has a narrow barrier between the turning points that were found" "$TMP/spike.lag"
printf 'model held\ncoord x, y\nmomentum px of x, py of y\nhamiltonian = px^2/2 + x^2 + x*y\n' >"$TMP/held.lag"
check "H without a momentum does not separate: px depends on y" told 3 "H does not separate in these coordinates: it contains y, and not its momentum" "$TMP/held.lag"
printf 'model tilt\ncoord x, y\nparam e = 0\nlagrangian = (x'"'^2 + y'^2"')/2 - x^2 - y^2 - e*x*y\n' >"$TMP/tilt.lag"
check "a parameter that is 0 by chance" told 3 "Levi-Civita's condition for x and y fails, for general values of the parameters" "$TMP/tilt.lag"
printf 'model slow\ncoord x\nmomentum p of x\nhamiltonian = sqrt(1 + p^2) + x^2/2\nscene s { start p = 1e-6 }\n' >"$TMP/slow_one.lag"
# H = 1 + J - 3 J^2/16: J = e + 3 e^2/16 with e = 5e-13 - 1.25e-25, omega = 1 - 3 J/8.
near "1e-12 of energy beside that of rest has all digits" 1e-27 4.99999999999921875e-13 "$(action slow_one s x J)"
near "its frequency, too" 1e-15 0.9999999999998125 "$(action slow_one s x dE/dJ)"
printf 'model step\ncoord x periodic\nmomentum p of x\nhamiltonian = p^2/2 + if(sin(x) > 0, 1, 0)\n' >"$TMP/step.lag"
check "a step: x is not cyclic" told 3 "x: no action variable: H jumps with the coordinates or momenta" "$TMP/step.lag" p=3
printf 'model later\ncoord x\nmomentum p of x\nhamiltonian = p^2/2 + if(t > 1, 2, 1)*x^2/2\n' >"$TMP/later.lag"
check "a step in time has the action of the start" told 0 "x: J = 4.5, omega = dE/dJ = 1," "$TMP/later.lag" x=0 p=3
printf 'model rotor\ncoord q periodic\nmomentum p of q\nhamiltonian = p^2/2\nkick pulse every 1 { p = p - sin(q) }\n' >"$TMP/rotor.lag"
check "kicks are told" told 0 "kicks, events or impacts change the state: the actions are those of the motion between them" "$TMP/rotor.lag" p=1
check "constraints" told 1 "brackets of a model with constraints, which are Dirac's, are not supported" models/cartesian_pendulum.lag
check "friction is told" told 0 "forces stand outside H: the actions are those of the motion without them" models/damped_oscillator.lag
check "explicit time is told" told 0 "; the actions are those of the start, all else held" "$TMP/slow.lag"
empty "a frequency that would need the others' constants is not printed" "$("$LAGC" action "$TMP/spherical.lag" | grep '^th.*omega')"

# ---- JSON ----
fields() { "$LAGC" action "$@" --json 2>&1 | grep -o '"[^"]*": [[{]\{0,1\}' | sed 's/^"//; s/": *//' | awk '!seen[$0]++' | tr '\n' ' ' | sed 's/ $//'; }
is "fields of --json" "model scene energy remark separates tied[ actions[ coordinate momentum why_not cyclic action frequency digits frequency_digits low high left right" "$(fields models/henon_heiles.lag)"
json() { "$LAGC" action "$@" --json >"$TMP/json" 2>&1; grep -q -F -e "$words" "$TMP/json" || { cat "$TMP/json"; false; }; }
words='"tied": ["x", "y"]'
check "two coordinates that are tied" json models/henon_heiles.lag
words='"action": 0.5, "frequency": 1, "digits": 16, "frequency_digits": 16, "low": -1, "high": 1'
check "numbers" json "$TMP/tied.lag"
if command -v python3 >/dev/null; then check "it is JSON" python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$TMP/json"; else skip "it is JSON" "there is no python3"; fi

check "a name without a value" told 2 "x=: a value is missing" models/damped_oscillator.lag under x=
tap_end
