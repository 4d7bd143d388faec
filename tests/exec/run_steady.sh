#!/bin/sh
# lagc modes of models with constraints, and --steady: motions that run steadily, against closed forms and published digits
. tests/tap.sh
needs_gsl
dir=tests/exec/modes

# find_modes MODEL ARGS...: the JSON object, a line a mode that is not zero after the first. of_simulator: of one that is built
find_modes() { of_simulator "$LAGC" modes "$@"; }
of_simulator() {
  title="$*"
  "$@" --json >"$TMP/json" 2>"$TMP/err" || cat "$TMP/err" >&2
  sed 's/{"re"/\n&/g' "$TMP/json" >"$TMP/all"
  grep -v '^{"re": 0, "im": 0,' "$TMP/all" >"$TMP/modes"
}
verdict() { is "$title: verdict" "$1" "$(sed -n '1s/.*"verdict": "\([^"]*\)".*/\1/p' "$TMP/modes")"; }
zeros() { is "$title: zero modes" "$1" "$(grep -c '^{"re": 0, "im": 0, "free": true' "$TMP/all")"; }
of_mode() { sed -n "$(($1 + 1))s/.*\"$2\": \([^,}]*\).*/\1/p" "$TMP/modes"; }
# close WHAT EXPRESSION GOT [TOLERANCE]: absolute below 1, else relative. 1e-10: extrapolated differences of accelerations keep 11 to 13 digits
close() {
  check "$title: $1" awk -v got="$3" -v tolerance="${4:-1e-10}" "
    BEGIN { g = 9.81; pi = atan2(0, -1); want = $2; d = got - want; size = want < 0 ? -want : want; if (size < 1) size = 1
      if (got != \"\" && d <= tolerance*size && -d <= tolerance*size) exit 0
      printf \"%.17g, not %.17g\\n\", got, want; exit 1 }"
}

# ---- at rest, with a constraint: the pendulum's w^2 = g/l, by a rod and by its angle
find_modes models/cartesian_pendulum.lag
verdict stable
close "by its angle" "sqrt(g)" "$(of_mode 1 im)"
close "by a rod" "sqrt(g)" "$(of_mode 2 im)"
find_modes models/cartesian_pendulum.lag x=0.01 y=1 th=3.1
verdict unstable
close "upside down, by a rod" "sqrt(g)" "$(of_mode 1 re)"
find_modes models/rattleback.lag "R=turn((1, 0, 0), 0)" # at rest it may be shifted and turned
zeros 3

# a mass that is negative oscillates on the top of its hill: the energy has no minimum; a kink has no linearisation
cat >"$TMP/hill.lag" <<'END'
model hill "A rod's end in the plane, and a negative mass"
coord x [m], y [m], u [m]
param k = 1 [N/m]
kinetic = 1 [kg]/2*(x'^2 + y'^2) - 1 [kg]/2*u'^2
potential = 1 [N]*y - k/2*u^2
constraint rod: x^2 + y^2 = 1 [m^2]
effect kink { potential = 1 [N]*abs(x) }
scene still { start y = -1 [m]; span 1 [s] }
scene kinked { like still; use kink }
END
find_modes "$TMP/hill.lag"
verdict undecided
close "it oscillates" 1 "$(of_mode 1 im)"
find_modes "$TMP/hill.lag" kinked
verdict undecided
check "$title: because of the kink" grep -q "derivatives jump here" "$TMP/json"

# ---- rods: the point at rest obeys the constraints to rounding, from any start; then turns about the vertical displace nothing, and w^2 = g/l alone is left. The
# sixth bar, which follows from the others, changes nothing
rods() {
  find_modes $dir/rods.lag "$@"
  verdict stable
  for k in 1 2 3; do close "rod $k" "sqrt(g)" "$(of_mode $k im)"; done
}
rods
near "$title: as low as the rod allows" 1e-15 -1 "$(sed -n 's/.*"equilibrium": {[^}]*"r.z": \([^,]*\),.*/\1/p' "$TMP/json")"
for start in "0.05 0.2" "0.4 0.1" "0.15 0.25" "0.2 0" "0.35 0.2" "0.1 0.1"; do
  ! one_of 3 || rods "r.x=${start% *}" "r.y=${start#* }"
done
find_modes $dir/rods.lag dragged # r'' = ... - 0.2 r'
close "a damped rod" -0.1 "$(of_mode 1 re)"
close "a damped rod" "sqrt(g - 0.01)" "$(of_mode 1 im)"
for start in "w=1 from=0.25" "w=1 from=0.24" "w=2 from=0.3"; do
  find_modes $dir/linkage.lag "${start% *}" "${start#* }"
  verdict stable
  close "a linkage" "sqrt(g)" "$(of_mode 1 im)"
done

# ---- any size, and a soft spring beside gravity: w = sqrt(k/m) and sqrt(g/l), to 1e-10 of themselves
for case in l=1e-9:1 l=1e9:2 g=1e12:1 k=1e-8:1; do
  find_modes $dir/soft.lag "${case%:*}"
  verdict stable
  (l=1 g=9.81 k=1 && eval "${case%:*}" && echo "$l $g $k") >"$TMP/size"
  check "$title: both rates" awk -v spring="$(of_mode "${case#*:}" im)" -v rod="$(of_mode $((3 - ${case#*:})) im)" '
    { a = spring/sqrt($3) - 1; b = rod/sqrt($2/$1) - 1; print a, b; exit !(a*a < 1e-20 && b*b < 1e-20) }' "$TMP/size"
done

# ---- a hinge R n = S n, whose third equation follows from the others: both arms sway as one body at w^2 = 4 a m g/(2 J + 10 m a^2), and swing in their plane as
# a double pendulum: M = (J + 5 m a^2, 2 m a^2; 2 m a^2, J + m a^2), K = m g a (3, 0; 0, 1)
hinge() {
  find_modes $dir/hinge.lag "$@"
  verdict neutral
  zeros 1
  root="sqrt(11.772^2 - 4*0.2225*14.715*4.905)"
  close "in the plane" "sqrt((11.772 - $root)/0.445)" "$(of_mode 1 im)" 1e-9
  close "swaying" "sqrt(2*g/2.7)" "$(of_mode 2 im)" 1e-9
  close "in the plane" "sqrt((11.772 + $root)/0.445)" "$(of_mode 3 im)" 1e-9
}
hinge
slow hinge "R=turn((0,0,1),0.5)" "S=turn((0,0,1),0.5)"
slow hinge "R=turn((0,0,1),1)*turn((0,1,0),0.2)" "S=turn((0,0,1),1)"

# ---- a zero that is no family of steady motions is decided by nonlinear terms: the top of u^4; a valley that falls as -y^4; an arm at its critical spin
cat >"$TMP/top.lag" <<'END'
model top "On a flat top"
coord u
lagrangian = u'^2/2 + u^4
dissipation = u'^2/2
scene still { span 1 }
END
cat >"$TMP/falls.lag" <<'END'
model falls "A round valley that falls along its floor"
coord x, y
lagrangian = (x'^2 + y'^2)/2 - (x^2 + y^2 - 1)^2/4 + y^4
dissipation = 0.05*(x'^2 + y'^2)
scene beside { start x = 0.9; span 1 }
END
cat >"$TMP/arm.lag" <<'END'
model arm "A mass on a damped spring along an arm that spins"
coord u, ph
kinetic = (1 + u^2)/2*ph'^2 + u'^2/2
potential = u^2/2 - u^4
dissipation = u'^2/2
scene critical { start ph' = 1; span 1 }
END
for model in top falls arm; do
  find_modes "$TMP/$model.lag" --steady
  verdict undecided
done
find_modes "$TMP/arm.lag" --steady "ph'=0.9"
verdict neutral

# ---- a circle about the Earth, in metres: the body comes back to the same radius once a turn (Kepler)
find_modes models/satellite.lag kepler --steady e=0
check "$title: the start itself" grep -q '"steps": 0' "$TMP/json"
check "$title: the Earth" awk -v got="$(of_mode 1 im)" 'BEGIN { d = got/sqrt(3.986004418e14/6778136.6^3) - 1; print got; exit !(d*d < 1e-18) }'
cat >"$TMP/thin.lag" <<'END'
model thin "A circle in an atmosphere that thins out"
coord x, y
param c = 2e-5 >= 0
lagrangian = (x'^2 + y'^2)/2 + 1/hypot(x, y)
force (x, y) = -c*exp((1 - hypot(x, y))/0.006)*hypot(x', y')*(x', y')
scene circle { start x = 1, y' = 1; span 1 }
END

# ---- a conical pendulum: it nods at w^2 = g/l (1 + 3 cos^2)/cos (P. Appell, Traite de mecanique rationnelle, chapter on the spherical pendulum)
nods="sqrt(g/2*(1 + 3*cos(pi/4.5)^2)/cos(pi/4.5))"
find_modes $dir/cone.lag circle --steady
close "by angles" "$nods" "$(of_mode 1 im)"
close "by a rod" "$nods" "$(of_mode 2 im)"
check "$title: the start itself" grep -q '"steps": 0' "$TMP/json"
find_modes $dir/cone.lag near --steady
check "$title: one near the start" grep -q '"steps": [1-9]' "$TMP/json"
check "$title: with its rates" grep -q '"velocity": {"x": ' "$TMP/json"

# ---- Lagrange's top, A = m g h = 1, C = 1/2. Asleep it falls below C^2 w^2 = 4 A m g h, at the rate sqrt(4 A m g h - C^2 w^2)/(2 A); in steady
# precession by p at the lean u it nods at (p sin u)^2 + (C w/A - 2 p cos u)^2, w its spin (from the effective potential of u)
find_modes models/lagrange_top.lag sleeping --steady "omega(R)=(0, 0, 3)"
verdict unstable
close "it falls" "sqrt(4 - 2.25)/2" "$(of_mode 1 re)"
find_modes models/lagrange_top.lag sleeping --steady "omega(R)=(0, 0, 3.99)"
verdict unstable
find_modes models/lagrange_top.lag sleeping --steady "omega(R)=(0, 0, 4.01)"
verdict undecided
close "it sways" "0" "$(of_mode 1 re)" 0
for way in slow:- fast:+; do
  find_modes models/lagrange_top.lag "${way%:*}" --steady lean=0.7
  p="(3 ${way#*:} sqrt(9 - 4*cos(0.7)))/2/cos(0.7)"
  spin="(6)" # about the axis, with the share of the precession
  close "it nods" "sqrt(($p*sin(0.7))^2 + ($spin/2 - 2*$p*cos(0.7))^2)" "$(of_mode 1 im)"
done

# ---- a thin disc, A = m a^2/4, C = m a^2/2: rolling it is upright while v^2 > g a/3 (J. I. Neimark and N. A. Fufaev, Dynamics of nonholonomic
# systems, 1972), w^2 = (3 v^2/a^2 - g/a)/(5/4); spinning upright while 5 a spin^2 > 4 g, w^2 = (5/4 spin^2 - g/a)/(5/4) (E. J. Routh, 1905)
find_modes $dir/disc.lag rolling --steady
close "it wobbles" "sqrt((48 - 2*g)/1.25)" "$(of_mode 1 im)"
close "and neither grows nor decays" 0 "$(of_mode 1 re)" 0
find_modes $dir/disc.lag rolling --steady v=1.2
verdict unstable
close "too slow" "sqrt((2*g - 17.28)/1.25)" "$(of_mode 1 re)"
find_modes $dir/disc.lag spinning --steady
close "it wobbles" "sqrt((20 - 2*g)/1.25)" "$(of_mode 1 im)"
find_modes $dir/disc.lag spinning --steady spin=3.9
verdict unstable

# ---- the rattleback: one way the fast rattle grows, the other way the slow one (H. Bondi, Proc. R. Soc. A 405 (1986) 265). Digits: Newton's and
# Euler's equations in the body's frame, the rolling put in, differentiated and solved by mpmath with 40 digits
rattles() { # SPIN SIGN, which modes are the fast and the slow rattle
  find_modes models/rattleback.lag --steady "R=turn((1, 0, 0), 0)" "omega(R)=(0, 0, $1)"
  verdict unstable
  close "fast" "$2*2.120692397891901" "$(of_mode "$3" re)" 1e-8 # differences over hundredths of a radian, as the stone is thin
  close "fast" 109.3923228379318 "$(of_mode "$3" im)" 1e-9
  close "slow" "-($2)*0.202521283292215" "$(of_mode "$4" re)" 1e-8
  close "slow" 34.14369166586759 "$(of_mode "$4" im)" 1e-9
}
rattles -5 1 1 2
rattles 5 -1 2 1
# sin(pi) is 1.2e-16 in doubles, which is no rate of y
echo "model rest; coord x, y; lagrangian = x*y' - cos(x); scene s { start x = pi }" >"$TMP/rest.lag"
check "a drift at rest does not run at what rounding leaves" says 0 "equilibrium: the start itself" "$LAGC" modes "$TMP/rest.lag" --steady

# ---- the benchmark bicycle: table 2 of Meijaard et al. (2007), to its digits
one_of 3 || { tap_end; exit; } # the rest takes a third of this suite
check "the bicycle is built" "$LAGC" build models/bicycle.lag --with linear -o "$TMP/bicycle"
eigenvalues() { # v, then re:im of each mode that is listed
  of_simulator "$TMP/bicycle" --modes straight --steady "v=$1"
  zeros 5
  shift
  k=0
  for value; do
    k=$((k + 1))
    close "mode $k" "${value%:*}" "$(of_mode $k re)" 1e-11
    close "mode $k" "${value#*:}" "$(of_mode $k im)" 1e-11
  done
}
eigenvalues 0 5.53094371765393:0 3.13164324790656:0 -3.13164324790656:0 -5.53094371765393:0
verdict unstable
eigenvalues 5 -0.322866429004087:0 -14.0783896927982:0 -0.775341882195845:4.46486771378823
verdict neutral
check "it comes back" grep -q 'so the motion comes back to one of them' "$TMP/json"
eigenvalues 10 0.161053386531716:0 -24.6245963501740:0 -3.72016840437288:10.9068113947629
verdict unstable
# the speeds between which it is stable: 4.292382536341 and 6.024262015388 m/s
for v in 4.29238:unstable 4.29239:neutral 6.02426:neutral 6.02427:unstable; do
  of_simulator "$TMP/bicycle" --modes straight --steady "v=${v%:*}"
  verdict "${v#*:}"
done

of_simulator "$TMP/bicycle" --modes straight --steady v=6.02426201538837 # to the last digit: circles begin here, and no linear term decides
verdict undecided
is "$title: one zero mode beside the free ones" 1 "$(grep -c '^{"re": 0, "im": 0, "free": false' "$TMP/all")"

# ---- Hamiltonians, and an L linear in velocities: coordinates of which H is free run at constant rates
cat >"$TMP/conical.lag" <<'END'
model conical "A spherical pendulum that goes round on a cone"
coord th [rad], ph [rad] periodic
momentum pt of th, pp of ph
param m = 2 [kg] > 0, l = 1.5 [m] > 0, g = 9.81 [m/s^2] > 0, lean = 0.6
hamiltonian = pt^2/(2*m*l^2) + pp^2/(2*m*l^2*sin(th)^2) - m*g*l*cos(th)
scene cone { start th = lean, pp = m*l^2*sin(lean)^2*sqrt(g/(l*cos(lean))) }
scene near { like cone; start th = 0.62 }
END
find_modes "$TMP/conical.lag" cone --steady
close "w^2 = g/l (1 + 3 cos^2)/cos" "sqrt(g/1.5*(1 + 3*cos(0.6)^2)/cos(0.6))" "$(of_mode 1 im)"
close "it runs at sqrt(g/(l cos))" "sqrt(g/1.5/cos(0.6))" "$(sed -n 's/.*"velocity": {"th": 0, "ph": \([^,}]*\).*/\1/p' "$TMP/json")"
zeros 2 # a turn, and another cone
find_modes "$TMP/conical.lag" near --steady # between the two
lean=$(sed -n 's/.*"steady_motion": {"th": \([^,}]*\).*/\1/p' "$TMP/json")
close "at the cone that is found" "sqrt(g/1.5*(1 + 3*cos($lean)^2)/cos($lean))" "$(of_mode 1 im)"
cat >"$TMP/precession.lag" <<'END'
model precession "Lagrange's top in Euler's angles"
coord th, ph periodic, ps periodic
momentum pt of th, pz of ph, p3 of ps
param lean = 0.7, spin = 3, branch = -1
param rate = (spin + branch*sqrt(spin^2 - 4*cos(lean)))/(2*cos(lean))
hamiltonian = pt^2/2 + (pz - p3*cos(th))^2/(2*sin(th)^2) + p3^2 + cos(th)
scene s { start th = lean, p3 = spin, pz = rate*sin(lean)^2 + spin*cos(lean) }
END
# V(th) = (pz - p3 cos(th))^2/(2 sin(th)^2) + cos(th), w^2 = V'' by mpmath
find_modes "$TMP/precession.lag" --steady
close "nutation of the slow precession" 2.44883269293191756901973125022 "$(of_mode 1 im)"
zeros 4
find_modes "$TMP/precession.lag" --steady branch=1
close "of the fast one" 3.34429278646797758337495800471 "$(of_mode 1 im)"
cat >"$TMP/pair.lag" <<'END'
model pair "Two vortices of opposite strength"
coord x[2], y[2]
param d = 3 > 0
lagrangian = x[1]*y[1]' - x[2]*y[2]' + log((x[1] - x[2])^2 + (y[1] - y[2])^2)
scene s { start x[1] = d/2, x[2] = -d/2 }
END
find_modes "$TMP/pair.lag" --steady
close "a pair of vortices runs at 2/d" "-2/3" "$(sed -n 's/.*"velocity": .*"y\[2\]": \([^,}]*\)}, "pairs".*/\1/p' "$TMP/json")"
zeros 4

# ---- refusals, and the printed report
refuses() { # STATUS WORDS ARGS...
  want=$1 words=$2
  shift 2
  "$LAGC" modes "$@" >"$TMP/out" 2>"$TMP/err"
  got=$?
  [ $got = "$want" ] && grep -qF -e "$words" "$TMP/err" || { echo "status $got"; cat "$TMP/out" "$TMP/err"; return 1; }
}
cat >"$TMP/chute.lag" <<'END'
model chute "A point that slides down"
coord x [m], y [m]
kinetic = 1 [kg]/2*(x'^2 + y'^2)
potential = 9.81 [N]*y
constraint plane: x + y = 0 [m]
scene slide { span 1 [s] }
END
check "nothing steady near" refuses 3 "no steady motion found near the start of scene" models/projectile.lag --steady
printf 'model fall\ncoord x\nmomentum p of x\nhamiltonian = p^2/2 + x + x^3\nscene s { start p = 1 }\n' >"$TMP/fall.lag"
check "of a Hamiltonian turns are not looked for" refuses 3 "coordinates that run at constant rates (a circle in x and y is found in polar coordinates); start near one" "$TMP/fall.lag" --steady
check "no equilibrium with constraints" refuses 3 "for a motion that runs steadily, as a wheel that rolls, write --steady" "$TMP/chute.lag"
for c in 2e-5 1e-6; do check "nothing steady in an atmosphere of $c" refuses 3 "no steady motion found" "$TMP/thin.lag" --steady c=$c; done
check "nor about the Earth" refuses 3 "no steady motion found" models/satellite.lag falling --steady i=0
cat >"$TMP/flat.lag" <<'END'
model flat "A parallelogram of rods that a spring holds flat, where it may fold"
coord x1 [m], y1 [m], x2 [m], y2 [m]
kinetic = 1 [kg]/2*(x1'^2 + y1'^2 + x2'^2 + y2'^2)
potential = 3 [N/m]/2*(y1^2 + y2^2)
constraint a: x1^2 + y1^2 = 1 [m^2]
constraint b: (x2 - 2 [m])^2 + y2^2 = 1 [m^2]
constraint c: (x2 - x1)^2 + (y2 - y1)^2 = 4 [m^2]
scene s { start x1 = 1, x2 = 3; span 1 }
END
check "a singular configuration" refuses 3 "the constraints are dependent, or nearly, at the equilibrium and independent beside it" "$TMP/flat.lag"
check "not for runs" sh -c "'$LAGC' run models/bicycle.lag --steady 2>&1 | grep -q 'is an option of .lagc modes'"
# x'' = 1 neither rests nor runs steadily, on a rail or without
echo "model tube; coord x, y; constraint rail: y = 0; lagrangian = (x'^2 + y'^2)/2; force x = 1; scene s { start x = 1; span 1 }" >"$TMP/tube.lag"
check "no rest on a rail" says 3 'no equilibrium found near the start of scene s: start near one: name=VALUE; for a motion' "$LAGC" modes "$TMP/tube.lag"
check "... and no steady motion" says 3 'no steady motion found near the start of scene s: one along whose path' "$LAGC" modes "$TMP/tube.lag" --steady
is "... as JSON" '"no equilibrium"}' "$("$LAGC" modes "$TMP/tube.lag" --json 2>/dev/null | sed 's/.*"status": //')"
check "a steady motion is printed with its rates" sh -c "'$TMP/bicycle' --modes --steady | grep -q \"moving with x' 5 m/s, rear' -16.6667 rad/s, front' -14.2857 rad/s\""
tap_end
