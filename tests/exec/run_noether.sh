#!/bin/sh
# lagc noether and lagc derive --hamiltonian as commands: refusals, output files, effects, JSON. Their results are tested by
# unit/test_found, test_brackets and test_hamilton, their printed form by golden/run_eqns.
. tests/tap.sh

# refuses STATUS PATTERN COMMAND...: nothing on standard output, the pattern in the messages.
refuses() {
  status=$1 pattern=$2
  shift 2
  "$LAGC" "$@" >"$TMP/out" 2>"$TMP/err"
  code=$?
  [ "$code" = "$status" ] && ! [ -s "$TMP/out" ] && grep -q -e "$pattern" "$TMP/err" && return 0
  echo "exit status $code, expected $status; messages:"
  cat "$TMP/err"
  return 1
}
says() { pattern=$1; shift; "$LAGC" "$@" >"$TMP/out" 2>&1 || return 1; grep -q -e "$pattern" "$TMP/out" || { cat "$TMP/out"; return 1; }; }
is_silent() { pattern=$1; shift; "$LAGC" "$@" >"$TMP/out" 2>&1 || return 1; ! grep -e "$pattern" "$TMP/out"; }

# ---- refusals ----
check "a model without a Lagrangian" refuses 1 "no symmetries to look for: the model has no Lagrangian" noether models/lorenz.lag
check "a scene that is not there" refuses 1 "scene" noether models/kepler.lag nowhere
check "a format that it does not have" refuses 2 "json" noether models/kepler.lag --format c
check "the file of the model for an output" refuses 2 "would be overwritten" noether models/kepler.lag -o models/kepler.lag
cat >"$TMP/false.lag" <<'END'
model m
coord x, y
lagrangian = (x'^2 + y'^2)/2 + 1/hypot(x, y)
symmetry spin(s): x -> x*cos(s) + y*sin(s), y -> x*sin(s) + y*cos(s)
END
check "a declared symmetry that is false" refuses 1 "the symmetry .spin. is false" noether "$TMP/false.lag"
check "a Hamiltonian of an L of first order" refuses 1 "no Hamiltonian by momenta: L is linear in velocities" derive models/point_vortices.lag --hamiltonian
check "a Hamiltonian without a Lagrangian" refuses 1 "no Hamiltonian: the model has no Lagrangian" derive models/lorenz.lag --hamiltonian
check "a Hamiltonian as C" refuses 2 "text or latex" derive models/kepler.lag --hamiltonian --format c
check "a Hamiltonian's operations" refuses 2 "text or latex" derive models/kepler.lag --hamiltonian --ops

# ---- names ----
printf 'model m\ncoord x, y\nlagrangian = x'"'"'^2/2 + y'"'"'^2/(2*y^2)\n' >"$TMP/stretched.lag"
check "what stretches the last coordinate turns no parts of the motion" says "^Q3: linear map of the coordinates" noether "$TMP/stretched.lag"

# ---- output files ----
"$LAGC" noether models/kepler.lag >"$TMP/kepler" 2>&1
check "to a file" sh -c '"$0" noether models/kepler.lag -o "$1" && cmp "$1" "$2"' "$LAGC" "$TMP/file" "$TMP/kepler"

# ---- nothing is found ----
printf '%s\n' 'model pulled' 'coord x' 'input U = 0' "lagrangian = x'^2/2 - x^2/2 - U*x" >"$TMP/pulled.lag"
check "an input: what is not looked for" says '^looked for: .*no tau since L contains an input' noether "$TMP/pulled.lag"
# rates 2, 5, their sum, their difference and their doubles: sin((2 - 5) t) is sin(3 t) again
echo "model two; coord x; lagrangian = x'^2/2 + x*cos(5*t) + x*cos(2*t)" >"$TMP/two.lag"
check "each function of time is looked for once" says "cos(10\*t), sin(10\*t), cos(7\*t), sin(7\*t), cos(3\*t), sin(3\*t), cos(4\*t), sin(4\*t), t^3, " noether "$TMP/two.lag"
# x'' = cos(a t) + cos(b t), integrated once
echo "model named; coord x; param a = 2, b = 5; lagrangian = x'^2/2 + x*cos(b*t) + x*cos(a*t)" >"$TMP/named.lag"
check "two rates with names" says "^  Q2 = x' - sin(b\*t)/b - sin(a\*t)/a\$" noether "$TMP/named.lag"
check "where there is none" says '^found: none$' noether models/kapitza.lag
check "no symmetry is called proved" is_silent 'proved' noether models/kapitza.lag

# ---- many bodies on a line: random equations tell not all solutions ----
cat >"$TMP/calogero.lag" <<'END'
model calogero
const N = 34
coord x[N]
lagrangian = sum(i in 1..N, x[i]'^2/2) - sum(i in 1..N, sum(j in 1..i-1, 1/(x[i] - x[j])^2))
END
for n in 34 60 400; do # of 400 at random places, some nearly touch
  "$LAGC" noether "$TMP/calogero.lag" -D N=$n >"$TMP/calogero" 2>&1
  check "$n bodies have momentum and centre of mass" grep -q "^Q3: boost along x: the centre of mass moves uniformly" "$TMP/calogero"
  check "$n bodies scale and expand" grep -q "^found: 5 symmetries, each proved" "$TMP/calogero"
  check "a boost and a translation have the mass as bracket" grep -q "^  {Q2, Q3} = $n\$" "$TMP/calogero"
  for bracket in '{Q1, Q3} = Q2' '{Q1, Q4} = -2.Q1' '{Q1, Q5} = Q4' '{Q2, Q4} = -Q2' '{Q2, Q5} = -Q3' '{Q3, Q4} = Q3' '{Q4, Q5} = -2.Q5'; do
    check "$bracket" grep -q "^  $bracket\$" "$TMP/calogero"
  done
  [ $n -gt 100 ] || check "and more is not excluded, which is said" grep -q "^the linear equations of the full search could not be solved reliably" "$TMP/calogero"
done

cat >"$TMP/swarm.lag" <<'END'
model swarm "Charged bodies in a magnetic field"
const N = 34
coord r[N]: vec3
param B = 1, K = 1
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2 + B/2*(r[i].x*r[i].y' - r[i].y*r[i].x')) - sum(i in 1..N, sum(j in 1..i-1, K/norm(r[i] - r[j])))
END
check "translations across a magnetic field are no momenta, of many bodies too" says "^Q2: magnetic translation of all bodies along x" noether "$TMP/swarm.lag"
check "those along it are" says "^Q4: total momentum along z" noether "$TMP/swarm.lag"

# ---- scenes and effects ----
check "without a scene effects are off, and each is judged alone" says "effect drag breaks 8 of 8" noether models/projectile.lag
check "a scene has its own" says "scene air, with wind_resistance" noether models/projectile.lag air
check "and its balances" says "dQ2/dt = -wind_resistance.k\*sqrt(x'^2 + y'^2)\*x'" noether models/projectile.lag air
printf "model m\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2\neffect bounce { event wall: x - 1 rising { x' = -x' } }\neffect floor { contact ground: y >= 0, restitution = 0.5 }\n" >"$TMP/bounce.lag"
check "events of an effect are no part of a balance, which is said" says "^  its events change charges: the balances hold between them" noether "$TMP/bounce.lag"
check "nor are impacts" says "^  its impacts and contacts change charges: the balances hold between them" noether "$TMP/bounce.lag"
check "which no list of effects follows" is_silent "^effect" noether models/projectile.lag air
cat >"$TMP/wider.lag" <<'END'
model m "A planet; with a moon, which is a coordinate of an effect; in a field; and in one that L cannot tell"
coord x, y
param k = 1 > 0
lagrangian = (x'^2 + y'^2)/2 + k/hypot(x, y)
effect moon { coord u; kinetic = u'^2/2; potential = u^2*(x^2 + y^2) }
effect field { param g = 1; potential = g*x }
effect again { requires field; param h = 1; potential = h*y }
effect gauge { lagrangian = x*x' }
END
"$LAGC" noether "$TMP/wider.lag" >"$TMP/wider" 2>&1
verdict() { sed -n "/^effect $1 /,/^\$/p" "$TMP/wider" | sed '/^$/d'; }
is "an effect with a coordinate of its own, which stays" "effect moon breaks none of them" "$(verdict moon)"
is "the torque of a field" "effect field breaks 1 of 2
  dQ2/dt = field.g*y" "$(verdict field)"
is "an effect with what it requires" "effect again breaks 1 of 2
  dQ2/dt = field.g*y - again.h*x" "$(verdict again)"
is "a total derivative breaks nothing" "effect gauge breaks none of them" "$(verdict gauge)"

# ---- an effect with a term of L makes another charge, reported with dQ/dt ----
cat >"$TMP/breathing.lag" <<'END'
model breathing
coord x
param k = 2 > 0
lagrangian = x'^2/2 - k/2*x^2
effect field { param E = 1; potential = -E*x }
effect air { param c = 1; force x = -c*x' }
END
"$LAGC" noether "$TMP/breathing.lag" >"$TMP/wider" 2>&1
check "it is printed before" sh -c "grep -A1 '^  Q[45] = .*field.E' '$TMP/wider' | grep -q '^  dQ[45]/dt = .*field.E'"
is "a force makes none" "" "$(verdict air | grep '^  Q')"

# ---- roots of parameters whose signs are not known ----
printf "model m\ncoord x, y\nparam k = 2, m = 1 > 0\nlagrangian = m*(x'^2 + y'^2)/2 - k*x^2/2 - y^4\n" >"$TMP/roots.lag"
check "what holds for some values of a parameter" says "^  for k > 0$" noether "$TMP/roots.lag"
is "says so, once for each" 2 "$(grep -c '^  for k > 0$' "$TMP/out")"
check "in JSON" says '"positive": \["k"\]' noether "$TMP/roots.lag" --format json

# ---- names of charges do not collide with names of the model ----
printf "model m\ncoord Q1, y\nlagrangian = (Q1'^2 + y'^2)/2 - (Q1^2 + y^2)^2\n" >"$TMP/names.lag"
check "a coordinate called Q1" says "^  C2 = Q1\*y' - y\*Q1'" noether "$TMP/names.lag"
check "in the head, too" says "; C = p.delta q - E delta t - F" noether "$TMP/names.lag"
check "in LaTeX" says '^  C_{2} &= Q_{1}' noether "$TMP/names.lag" --format latex

# ---- brackets whose coefficients are not recognised ----
cat >"$TMP/driven.lag" <<'END'
model m
coord x, z
param m = 2 > 0, k = 3 > 0, g = 1, a = 1 > 0, b = 3 > 0
lagrangian = m/2*(x'^2 + z'^2) - g*cos(k*t)*x - (a^2 + b)*z^2/2
END
check "a combination that is not recognised is called so" says "2 of them are combinations of these charges with coefficients that were not recognised" noether "$TMP/driven.lag"
check "and never no combination" is_silent "no combination" noether "$TMP/driven.lag"

cat >"$TMP/pushed.lag" <<'END'
model m
coord x, y
param a = 1
lagrangian = (x*y' - y*x')/2 - (x^2 + y^2)^2/4
force x = -a*x'
END
check "brackets of an L of first order with forces are refused" says "^no Poisson brackets: L is linear in velocities, and forces change the two-form" noether "$TMP/pushed.lag"

# ---- names ----
cat >"$TMP/screw.lag" <<'END'
model m
coord x, y, z
param k = 2
kinetic = (x'^2 + y'^2 + z'^2)/2
potential = cos(atan2(y, x) - k*z)*(x^2 + y^2)
END
cat >"$TMP/top.lag" <<'END'
model m
coord R: rotation
param A = 1 > 0, C = 3 > 0, g = 9.8
let w = omega(R)
let tip = R*(0, 0, 1)
kinetic = A/2*(w.x^2 + w.y^2) + C/2*w.z^2
potential = g*tip.z
END
check "a screw is no rotation" says "^Q2: rotation and translation at once" noether "$TMP/screw.lag"
check "turns in space and of the body's own, together" says "^Q3: turns about z in space and about the body's own: the difference of the angular momenta" noether "$TMP/top.lag"
printf "model m\ncoord x\nlagrangian = x'^4/4 + x'^2/2 - x^2/2\n" >"$TMP/quartic.lag"
check "a mass matrix with velocities is dp/dq', not p over q'" says "^mass matrix: M = dp/dq'" derive "$TMP/quartic.lag" --hamiltonian

# ---- cyclic coordinates ----
check "check says so" says "^cyclic coordinate: ph; L does not contain it, and p_ph is conserved" check models/spherical_pendulum.lag
check "and says when forces or constraints act on it" says "^cyclic coordinate: x; .* changed by forces and constraints alone" check models/turntable.lag
check "one that L contains is none" is_silent "cyclic coordinate: th" check models/spherical_pendulum.lag

# ---- LaTeX and JSON ----
blocks() { "$LAGC" "$@" --format latex | grep -c "$pattern"; }
balanced() {
  pattern='^.begin{align' && a=$(blocks "$@")
  pattern='^.end{align' && b=$(blocks "$@")
  [ "$a" -gt 2 ] && [ "$a" = "$b" ]
}
check "LaTeX closes what it opens" balanced noether models/charged_particle.lag
check "and the Hamiltonian's" balanced derive models/charged_particle.lag --hamiltonian
check "a last line of a block has no line break" sh -c '! "$0" noether models/spring.lag --format latex | grep -B1 "^.end" | grep -F "\\\\"' "$LAGC"
if python3 -c 'import json' 2>/dev/null; then
  cat >"$TMP/read.py" <<'END'
import json, sys
r = json.load(sys.stdin)
assert r["searched"] and r["not_proved"] == 0, r
assert [s["name"] for s in r["symmetries"]] == ["energy", "momentum of x", "momentum of th", "boost along x"], r
assert r["symmetries"][3]["F"] == "m*x" and r["symmetries"][3]["delta"] == {"x": "t"}, r
assert r["cyclic"] == ["x", "th"], r
assert r["brackets"][-1] == {"of": [2, 4], "proved": True, "constant": "m", "charges": {}}, r
assert r["effects"] == [{"effect": "drag", "note": "", "powers": ["-drag.c*x'^2", "-drag.c*x'", "0", "-drag.c*t*x'"]}], r
END
  cat >"$TMP/json.lag" <<'END'
model m
coord x, th
param m = 1 > 0
lagrangian = m/2*x'^2 + cosh(th')
effect drag { param c = 1; dissipation = c/2*x'^2 }
END
  check "JSON" sh -c '"$0" noether "$1" --format json >"$2" && python3 "$3" <"$2" || { cat "$2"; exit 1; }' "$LAGC" "$TMP/json.lag" "$TMP/report" "$TMP/read.py"
  check "JSON of every model" sh -c 'for m in turntable point_vortices $1; do "$0" noether models/$m.lag --format json | python3 -m json.tool >/dev/null || exit 1; done' "$LAGC" ${SLOW:+"pendulum room kepler"}
else skip "JSON" "there is no python3"
fi

# ---- states where L has values: |v| < c, coordinates above a; by hand, 5 and 3 symmetries for all values of the parameters
cat >"$TMP/charge.lag" <<'END'
model charge
coord x, y, z
param m = 1 > 0, c = 3 > 0, b = 1
lagrangian = -m*c^2*sqrt(1 - (x'^2 + y'^2 + z'^2)/c^2) + b/2*(x*y' - y*x')
END
cat >"$TMP/far.lag" <<'END'
model far
coord x, y, z
param m = 1 > 0, k = 1 > 0
lagrangian = m/2*(x'^2 + y'^2 + z'^2) + k*log(x - 9)
END
found() { "$LAGC" noether "$@" >"$TMP/out" && grep -q "^found: $n symmetries, each proved" "$TMP/out" || { cat "$TMP/out"; false; }; }
n=5; check "a relativistic charge in a field" found "$TMP/charge.lag"
n=6; check "a logarithm that begins at 9: energy, momenta and boosts along y and z, a rotation" found "$TMP/far.lag"

# ---- bounded time: what was not searched is said; memory near linear in what is found
cat >"$TMP/wave.lag" <<'END'
model wave
const N = 16
param T = 1 > 0, mu = 1 > 0
coord u[N]
lagrangian = sum(i in 1..N, mu/2*u[i]'^2 - T/2*(if(i < N, u[i+1], u[1]) - u[i])^2)
END
bounded() { (ulimit -t 4 && "$LAGC" noether "$TMP/wave.lag" --seconds 0.3 >"$TMP/out") && grep -q '^0.3 s did not suffice for more, and nothing was searched beyond: --seconds 3 ' "$TMP/out" &&
  grep -q '^found: .*' "$TMP/out" || { cat "$TMP/out"; false; }; } # on a fast processor energy, momentum, boost
check "a ring of 16: 40 s without a limit" bounded
printf '%s\n' 'model plane' 'const N = 480' 'coord x[N], y[N]' 'param m = 1 > 0, k = 3 > 0, l = 1 > 0' \
  "lagrangian = sum(i in 1..N, m*(x[i]'^2 + y[i]'^2)/2) - sum(i in 1..N-1, k*(hypot(x[i+1] - x[i], y[i+1] - y[i]) - l)^2/2)" >"$TMP/plane.lag"
check "scalings and brackets of 960 coordinates keep to the time: 4 s without" sh -c 'ulimit -t 2; "$0" noether "$1" --seconds 0.4 | grep -q "^found: "' "$LAGC" "$TMP/plane.lag"
printf '%s\n' 'model driven' 'const N = 20' 'coord u[N]' 'param k = 3' "lagrangian = sum(i in 1..N, u[i]'^2/2 - u[i]^6 + cos(t)*u[i]^2) - sum(i in 1..N-1, k*(u[i+1] - u[i])^6)" >"$TMP/driven.lag"
check "a matrix that the time does not suffice for takes no memory: 620 MB before" sh -c 'ulimit -v 200000; "$0" noether "$1" --seconds 0.5 | grep -q "did not suffice"' "$LAGC" "$TMP/driven.lag"
check "a time that is none" sh -c '"$0" noether "$1" --seconds 0 2>&1 | grep -q "the time for the search, for example --seconds 60"; ' "$LAGC" "$TMP/wave.lag"
cat >"$TMP/rods.lag" <<'END'
model rods
const N = 60
param m = 1 > 0, J = 0.1 > 0
coord x[N], y[N], th[N]
lagrangian = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2) + J/2*th[i]'^2)
END
rods() { (ulimit -v 200000 && "$LAGC" noether "$TMP/rods.lag" | grep -q '^found: 188 symmetries, each proved'); } # 180 momenta, energy; 3 sums, 3 boosts, the rotation of all
check "60 free rods" rods

# sums over pairs of a square: sin(y[j] - y[i])*y[i]*y[j] is equal and opposite, and 1 + 0.001*y[j] beside the other is not
cat >"$TMP/opposite.lag" <<'END'
model opposite
const N = 100
coord x[N], y[N]
lagrangian = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2)
for i in 1..N {
  force x[i] = sum(j in 1..N, sin(x[j] - x[i])*(1 + 0.001*y[j]))
  force y[i] = sum(j in 1..N, sin(y[j] - y[i])*y[j]*y[i])
}
END
opposite() { "$LAGC" noether "$TMP/opposite.lag" | sed -n "/total momentum along $1/,/^$/p" | grep -c 'dQ.*/dt'; }
is "forces of pairs that are opposite keep the momentum" 0 "$(opposite y)"
is "and others do not" 1 "$(opposite x)"
check "a thousand free members are not listed one by one" sh -c 'sed "s/^const N = .*/const N = 1000/" "$1/rods.lag" >"$1/many.lag"; "$2" noether "$1/many.lag" | grep -q "the momenta of cyclic coordinates are those above"' - "$TMP" "$LAGC"

# ---- many bodies: the members of a family move alike, and each charge is proved on one pair. 600 bodies: 0.4 s of processor, 90 MB
many() { (ulimit -t 4; ulimit -v 400000; "$LAGC" noether "$@" >"$TMP/out") && has 'members of a family move alike' && has 'the others are 0: all proved'; }
has() { grep -qF -- "$1" "$TMP/out" || { echo "no $1"; head -c 2000 "$TMP/out"; false; }; }
check "600 bodies" many tests/bench/models/bodies.lag -DN=600
check "the ten charges of the Galilei group" has 'found: 10 symmetries, each proved'
check "named so" has 'the ten charges of the Galilei group are among them'
check "a boost and its momentum: the mass" has '{Q2, Q3} = sum(i in 1..600, m[i])'
check "turns about x and y: z" has '{Q8, Q9} = Q10'
no_scaling() { ! grep '^scaling' "$TMP/out"; }
check "softened: no scaling" no_scaling
sed "/^param/s/, soft = 0.1//; s/ + soft^2//" tests/bench/models/bodies.lag >"$TMP/points.lag"
check "600 points" many "$TMP/points.lag" -DN=600
check "Kepler's third law" has 'scaling: r[i].x -> s^2*r[i].x  for i in 1..600, r[i].y -> s^2*r[i].y  for i in 1..600, r[i].z -> s^2*r[i].z  for i in 1..600, t -> s^3*t maps'
sed 's/^potential = /&sum(i in 1..N, r[i].x^2) /' "$TMP/points.lag" >"$TMP/trap.lag"
check "600 points in a trap across y and z" many "$TMP/trap.lag" -DN=600
check "energy; momenta and boosts along y and z, a turn about x" has 'found: 6 symmetries, each proved'
check "no scaling" no_scaling

# ---- every model of the gallery with few coordinates is searched ----
unsearched() {
  for m in models/*.lag; do
    case $m in */outer_planets.lag | */pleiades.lag | */lennard_jones.lag | */string.lag) continue ;; esac # seconds each
    one_of 8 || continue
    "$LAGC" noether "$m" 2>&1 | grep -e "not searched" -e "^ *[0-9]* of [0-9]* proved" | sed "s|^|$m: |"
  done
}
empty "every model is searched, every bracket proved" "$(unsearched)"
tap_end
