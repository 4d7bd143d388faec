#!/bin/sh
# Models that give their Hamiltonian, and Poisson brackets: textbook cases proved and, with a sign changed, refused (tests/exec/hamiltonian);
# Hamilton's equations, L from H and back, motions against closed forms and against the same system given by its Lagrangian.
. tests/tap.sh

# ---- brackets of textbooks ----
for m in tests/exec/hamiltonian/*.lag; do
  n=$(grep -c '^expect' "$m")
  check "$m: all $n proved" sh -c '"$1" check "$2" >"$4" 2>&1; grep "^$3 of $3 expectation" "$4" || { cat "$4"; false; }' sh "$LAGC" "$m" "$n" "$TMP/out"
done

# flips MODEL: each expectation with the opposite sign on its right side (1 in the place of 0); lines that are not refused there, with the cure.
flips() {
  grep -n '^expect' "$1" | cut -d : -f 1 | while read -r n; do
    one_of 5 || continue
    awk -v n="$n" 'FNR == n { if (!sub(/ = 0$/, " = 1")) { sub(/ = /, " = -("); $0 = $0 ")" } } { print }' "$1" >"$TMP/flip.lag"
    "$LAGC" check "$TMP/flip.lag" >"$TMP/out" 2>"$TMP/err"
    [ $? = 1 ] && grep -q "flip.lag:$n:.*should \(have the opposite sign\|be .0.\)" "$TMP/err" || { sed -n "${n}p" "$TMP/flip.lag"; cat "$TMP/err"; }
  done
}
for m in tests/exec/hamiltonian/*.lag; do empty "$m: a sign changed is refused, with the term" "$(flips "$m")"; done

# refuses_edit MODEL SED: a sign changed inside a function; the bracket with it is refused.
refuses_edit() {
  sed "$2" "$1" >"$TMP/edit.lag"
  ! cmp -s "$1" "$TMP/edit.lag" && ! "$LAGC" check "$TMP/edit.lag" >"$TMP/out" 2>&1 && grep "expect .* is false" "$TMP/out"
}
check "another vector than Runge and Lenz's" refuses_edit tests/exec/hamiltonian/kepler.lag 's/ - m\*k\*r/ + m*k*r/'
check "another integral than Carter's" refuses_edit tests/exec/hamiltonian/kerr.lag 's/} - 2\*energy/} + 2*energy/; s/)^2 - 2\*energy/)^2 + 2*energy/'
check "another integral than Henon's" refuses_edit tests/exec/hamiltonian/toda.lag 's/ - p\[2\]\*e3/ + p[2]*e3/'
check "a transformation with another sign" refuses_edit tests/exec/hamiltonian/canonical.lag 's/ - p\/(m\*w)\*sin/ + p\/(m*w)*sin/'

# ---- brackets at the command line ----
bracket() { "$LAGC" derive "$1" --bracket "$2" | sed 's/.* = //'; }
is "momenta of a model that gives L" "p_y" "$(bracket models/kepler.lag "x*p_y - y*p_x, p_x")"
is "velocities of a model that gives L" "-1/m" "$(bracket models/cart_pendulum.lag "x', x" | sed 's|-1/(M + m\*sin(th)^2)|-1/m|')"
is "brackets in brackets" "0" "$(bracket tests/exec/hamiltonian/vectors.lag "{L.x, L.y}, L.z")"
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
check "an acceleration in a bracket" refuses 1 "has accelerations" derive models/kepler.lag --bracket "x'', y"
check "one part" refuses 1 "a bracket has two parts" derive models/kepler.lag --bracket x
check "a mistake in a bracket" refuses 2 "bracket" derive models/kepler.lag --bracket "x, )"
check "an unknown name" refuses 1 "unknown name" derive models/kepler.lag --bracket "x, nobody"
check "a bracket as C" refuses 2 "text or latex" derive models/kepler.lag --bracket "x, y" --format c
check "two forms at once" refuses 2 "one of --hamiltonian" derive models/kepler.lag --bracket "x, y" --hamiltonian

refuses_run() { pattern=$1; shift; ! "$LAGC" run "$@" >"$TMP/out" 2>&1 && grep -F "$pattern" "$TMP/out"; }
refuses_claim() { ! "$LAGC" check "$2" >"$TMP/out" 2>&1 && grep "$1" "$TMP/out"; }

# ---- Hamilton's equations, and back to L ----
says() { "$LAGC" derive "$TMP/$1.lag" $2 | grep -q -x -F -e "$3" || { "$LAGC" derive "$TMP/$1.lag" $2; false; }; }
cat >"$TMP/field.lag" <<'END'
model field "A charge in a magnetic field"
coord x [m], y [m]
momentum px of x, py of y
param m = 2 [kg] > 0, b = 3 [kg/s]
hamiltonian = ((px + b*y/2)^2 + (py - b*x/2)^2)/(2*m)
scene s { start x = 1, px = 0.5, py = 1.5; span 2 [s]; tolerance 1e-12; output x, y, x', energy every 0.1 [s] }
END
cat >"$TMP/field_L.lag" <<'END'
model field_L
coord x [m], y [m]
momentum px of x, py of y
param m = 2 [kg] > 0, b = 3 [kg/s]
lagrangian = m/2*(x'^2 + y'^2) - b/2*(y*x' - x*y')
hamiltonian = ((px + b*y/2)^2 + (py - b*x/2)^2)/(2*m)
END
check "H" says field --hamiltonian '  H = ((2*px + b*y)^2 + (2*py - b*x)^2)/(8*m)'
check "x' = dH/dp" says field --hamiltonian "  x' = (2*px + b*y)/(2*m)"
check "L" says field --lagrangian "  L = m*(x'^2 + y'^2)/2 - b*(y*x' - x*y')/2"
check "a model that gives both is proved" sh -c '"$0" check "$1"' "$LAGC" "$TMP/field_L.lag"
sed 's/py - b\*x\/2/py + b*x\/2/' "$TMP/field_L.lag" >"$TMP/wrong.lag"
check "with another sign it is refused" refuses_claim 'expect hamiltonian is false' "$TMP/wrong.lag"
sed "s/b\*x\/2)^2)\/(2\*m)/b*x\/2)^2)\/m/" "$TMP/field_L.lag" >"$TMP/wrong.lag"
check "with another factor, too, which is named" refuses_claim 'expect hamiltonian is false: .m. lacks the factor .2.' "$TMP/wrong.lag"
cat >"$TMP/fast.lag" <<'END'
model fast "A fast particle, pushed"
coord x
momentum p of x
param m = 1 > 0, c = 1 > 0, F = 1
hamiltonian = sqrt(m^2*c^4 + p^2*c^2) - F*x
effect friction_of_air { param k = 0.1; force x = -k*p }
scene s { span 3; tolerance 1e-12; output x, p, x' every 0.1 }
scene air { like s; use friction_of_air }
END
check "no L in closed form: where velocities determine momenta" says fast --lagrangian '  det d2H/dp2 = m^2*c^3/(p^2 + m^2*c^2)^(3/2)'
check "and why" says fast --lagrangian 'no Lagrangian in closed form: H is not quadratic in the momenta'
printf 'model flat\ncoord x, y\nmomentum p of x, s of y\nhamiltonian = p^2/2 + y*s\n' >"$TMP/flat.lag"
check "a Legendre map that is singular" says flat --lagrangian 'no Lagrangian in closed form: det d2H/dp2 = 0 in every state: velocities do not determine the momenta'
printf 'model skew\ncoord q\nmomentum p of q\nparam a = 1\nhamiltonian = (p + q)^2/2 + a*(p - q)^2/2\n' >"$TMP/skew.lag"
check "a parameter that makes it singular" says skew --lagrangian '  det d2H/dp2 = 1 + a'
printf 'model two\ncoord x, y\nmomentum p of x, s of y\nparam a = 1\nhamiltonian = (p + s)^2/2 + a*(p - s)^2/2\n' >"$TMP/two.lag"
check "of two coordinates" says two --lagrangian '  det d2H/dp2 = 4*a'
sed 's/ > 0//' "$TMP/field.lag" >"$TMP/unsigned.lag"
empty "masses as divisors do not" "$("$LAGC" derive "$TMP/unsigned.lag" --lagrangian | grep 'det d2H')"
check "L of a model that gives L" refuses 1 "error: the model gives its Lagrangian" derive models/kepler.lag --lagrangian
check "beside a claim of H, too" refuses 1 "beside one, H is a claim" derive "$TMP/field_L.lag" --lagrangian

# ---- motions ----
# final NAME MODEL ARGUMENT...: a value at the end.
final() { name=$1 m=$2; shift 2; "$LAGC" run "$m" "$@" | awk -v n="$name" '$1 == n && !done { print $2; done = 1 }'; }
# Closed forms: a circle with the frequency b/m; x = (sqrt(1 + t^2) - 1), p = t; p' = 1 - k p. Tolerances of 1e-12 leave 1e-10 at such short times.
near "a circle in a magnetic field" 1e-10 "$(awk 'BEGIN { printf "%.15g", 1 + sin(3)/6 }')" "$(final x "$TMP/field.lag")"
for method in rk45 taylor radau 'gauss --step 0.002 ' 'rk4 --step 0.001 '; do
  # shellcheck disable=SC2086 # a method and its step
  near "by $method" 2e-10 "$(awk 'BEGIN { printf "%.15g", (cos(3) - 1)/6 }')" "$(final y "$TMP/field.lag" --method $method)"
done
near "a push of a fast particle" 1e-10 "$(awk 'BEGIN { printf "%.15g", sqrt(10) - 1 }')" "$(final x "$TMP/fast.lag")"
near "an effect's force adds to p'" 1e-10 "$(awk 'BEGIN { printf "%.15g", 10*(1 - exp(-0.3)) }')" "$(final p "$TMP/fast.lag" air)"
cat >"$TMP/pendulum.lag" <<'END'
model pendulum
coord th [rad] periodic
momentum L of th [kg*m^2/s]
param m = 1 [kg] > 0, l = 1 [m] > 0, g = 9.81 [m/s^2] > 0
hamiltonian = L^2/(2*m*l^2) - m*g*l*cos(th)
effect drag { param c = 0.1 [kg*m^2/s]; dissipation = c/2*th'^2 }
scene free { start th = 2.5; span 10 [s]; tolerance 1e-12; output th, th' every 0.1 [s] }
scene air { like free; use drag }
END
sed 's/^hamiltonian.*/lagrangian = m*l^2\/2*th'"'"'^2 + m*g*l*cos(th)/; s/^momentum.*//' "$TMP/pendulum.lag" >"$TMP/pendulum_L.lag"
for scene in free air; do
  near "a pendulum by H and by L, $scene" 1e-9 "$(final th "$TMP/pendulum_L.lag" $scene)" "$(final th "$TMP/pendulum.lag" $scene)"
done

# ---- forces that are no linear function of velocities: x' is dH/dp ----
# A block with v0 = 1 and friction 0.1 stops at v0^2/0.2 = 5, having lost 1/2; drag of 0.1 x'^2 leaves p = 1/(1 + t/10), x = 10 log(1 + t/10).
cat >"$TMP/block.lag" <<'END'
model block
coord x
momentum p of x
param m = 1 > 0
hamiltonian = p^2/(2*m)
effect dry { friction f on x: 0.1 }
effect by_hand { force x = -0.1*sign(x') }
effect drag { dissipation = 0.1/3*abs(x')^3 }
scene s { start p = 1; span 20; tolerance 1e-12; use dry }
scene hand { start p = 1; span 20; tolerance 1e-12; use by_hand }
scene air { start p = 1; span 20; tolerance 1e-12; use drag }
END
for scene in s hand; do near "a block with dry friction stops, $scene" 1e-11 5 "$(final x "$TMP/block.lag" $scene)"; done
work() { "$LAGC" run "$TMP/block.lag" --json --quiet | sed 's/.*"dry_friction": \([^,}]*\).*/\1/'; }
near "with the work of friction" 1e-11 -0.5 "$(work)"
near "drag with the square of the velocity" 1e-10 "$(awk 'BEGIN { printf "%.15g", 10*log(3) }')" "$(final x "$TMP/block.lag" air)"
# In a magnetic field x' = (p + b y/2)/m sticks, held by up to 0.2, and the model that gives L has the same motion; 1e-9: two runs of tolerance 1e-12 with switches.
cat >"$TMP/rub.lag" <<'END'
model rub
coord x, y
momentum p of x, s of y
param m = 2 > 0, b = 3, k = 1
hamiltonian = ((p + b*y/2)^2 + (s - b*x/2)^2)/(2*m) + k*x^2/2
friction f on x: 0.1, static = 0.2
scene go { start x = 1, p = 1; span 10; tolerance 1e-12; output x, f every 0.1 }
END
sed "/^momentum/d; s/^hamiltonian.*/lagrangian = m\/2*(x'^2 + y'^2) - b\/2*(y*x' - x*y') - k*x^2\/2/; s/start x = 1, p = 1/start x = 1, x' = 0.5, y' = -0.75/" "$TMP/rub.lag" >"$TMP/rub_L.lag"
for name in x y; do near "friction by H and by L, $name" 1e-9 "$(final $name "$TMP/rub_L.lag")" "$(final $name "$TMP/rub.lag")"; done
echo 'scene held { start x = 0.15, s = 0.225; span 10; output x, f every 1 }' >>"$TMP/rub.lag"
near "static friction holds" 1e-12 0.15 "$(final x "$TMP/rub.lag" held)"
near "with the force that it takes" 1e-12 0.15 "$("$LAGC" run "$TMP/rub.lag" held -o - --quiet | awk -F, 'END { print $3 }')"
printf "model pair\ncoord x, y\nlagrangian = x*y' - (x^2 + y^2)/2\nfriction f on x: 0.1\n" >"$TMP/pair.lag"
check "without momenta, a velocity is none" refuses 1 "force on .x. is not linear in the velocities" check "$TMP/pair.lag"

# ---- H = T(p) + V(q): the Verlet family, explicit ----
# With a quadratic T, steps of verlet are those of the same system by L; 1e-12: 1000 steps of rounding.
for method in symplectic_euler verlet; do
  near "$method by H and by L" 1e-12 "$(final th "$TMP/pendulum_L.lag" --method $method --step 0.01)" "$(final th "$TMP/pendulum.lag" --method $method --step 0.01)"
done
cat >"$TMP/spring.lag" <<'END'
model spring "A fast particle on a spring"
coord x
momentum p of x
hamiltonian = sqrt(1 + p^2) + x^2/2
event turn: p falling { }
scene s { start p = 2; span 10; output x, p every 0.3 }
END
# order METHOD STEP LOW HIGH: the ratio of the errors at the step and at half of it. x(10) by mpmath's Taylor series with 25 digits.
order() {
  near "order of $1" "$4" "$3" "$(awk -v a="$(final x "$TMP/spring.lag" --method "$1" --step "$2")" -v b="$(final x "$TMP/spring.lag" --method "$1" --step "$(awk -v h="$2" 'BEGIN { print h/2 }')")" \
    'BEGIN { x = 1.06312157909076; print (a - x)/(b - x) }')"
}
order verlet 0.05 4 0.1
order verlet4 0.1 16 1
order verlet6 0.1 66 6
order verlet8 0.2 256 60
check "explicit, as it says" sh -c '"$0" run "$1" --method verlet4 --step 0.1 | grep -q -x "explicit steps, the model is separable"' "$LAGC" "$TMP/spring.lag"
# Between steps, too: the time of an event, and rows, by another method; 1e-9: 10 steps a unit of time, order 8.
turn() { "$LAGC" run "$TMP/spring.lag" "$@" --json --quiet | sed 's/.*"turn": {"count": [0-9]*, "first": \([^,]*\),.*/\1/'; }
near "events of verlet8" 1e-9 "$(turn --method taylor --tol 1e-14)" "$(turn --method verlet8 --step 0.1)"
slope() { "$LAGC" run "$TMP/spring.lag" --tangent "$@" --json --quiet | sed 's/.*"tangent": {"x": {"x": \([^,]*\),.*/\1/'; }
near "the tangent of verlet8" 1e-8 "$(slope --method taylor --tol 1e-14)" "$(slope --method verlet8 --step 0.1)"
check "an H that does not separate is refused" refuses_run "H is not a sum T(p) + V(q, t)" "$TMP/field.lag" --method verlet
check "forces of velocities are refused as such" refuses_run "forces depend on momenta or velocities" "$TMP/pendulum.lag" air --method verlet
check "a rate is not set: it follows from the momentum" refuses_run "x': the rate of x follows from the equations of model fast: set x, or where H is given its momentum" "$TMP/fast.lag" "x'=1"
check "and forces of momenta" refuses_run "forces depend on momenta or velocities" "$TMP/fast.lag" air --method verlet8 --step 0.1
check "the power of drag in dH/dt" sh -c '"$0" derive "$1" air | grep -q -x -F "  dH/dt = -drag.c*L^2/(m^2*l^4)"' "$LAGC" "$TMP/pendulum.lag"
check "charges are found, and their brackets" sh -c '"$0" noether "$1" | grep -q "total angular momentum"' "$LAGC" tests/exec/hamiltonian/kepler.lag
# ---- rates of inputs are functions of time
printf "model hu\ncoord x [m]\ninput u [m] = 0.1 [m]*sin(2 [1/s]*t)\nparam m = 1 [kg]\nmomentum p of x\nhamiltonian = p^2/(2*m) + p*u%s\nscene s { start x = 1; span 1; output x }\n" "'" >"$TMP/hu.lag"
"$LAGC" run "$TMP/hu.lag" --json >"$TMP/out" 2>"$TMP/err"
check "H = p^2/(2 m) + p u': x follows u" close_to "$(sed "s/.*\"final\": {//" "$TMP/out" | sed -n "s/.*\"x\": \([-0-9.e]*\).*/\1/p")" 1.0909297426825682 1e-9
# ---- a family with two indices: oscillators with the frequencies i + 2 j
cat >"$TMP/lattice.lag" <<'END'
model lattice
const N = 2, K = 3
coord x[N,K]
momentum p[N,K] of x
hamiltonian = sum(i in 1..N, sum(j in 1..K, p[i,j]^2/2 + (i + 2*j)^2*x[i,j]^2/2))
observe q[i in 1..N] = 2*x[i,3]
scene s { start x = 1, p[1,2] = 5; span 1; tolerance 1e-12; output x, p, q }
END
"$LAGC" run "$TMP/lattice.lag" -o "$TMP/lattice.csv" >"$TMP/out" 2>&1
at_end() { tail -1 "$TMP/lattice.csv" | cut -d , -f "$1"; } # t, x[1,1], ..., x[2,3], p, q
check "x[2,3] is cos(8 t)" close_to "$(at_end 7)" "$(awk 'BEGIN { printf "%.17g", cos(8) }')" 1e-10
check "x[1,2] with its momentum is cos(5 t) + sin(5 t)" close_to "$(at_end 3)" "$(awk 'BEGIN { printf "%.17g", cos(5) + sin(5) }')" 1e-10
check "observables of one index read those of two" close_to "$(at_end 15)" "$(awk 'BEGIN { printf "%.17g", 2*cos(8) }')" 1e-10

# ---- names for momenta of families whose Lagrangian is given: m x', twice (i + 10 j) u', i r' and a term of another
cat >"$TMP/names.lag" <<'END'
model names
const N = 3, K = 2
coord x[N], u[N,K], r[N]: vec2
momentum p[N] of x, w[N,K] of u, s[N]: vec2 of r
param m = 2
lagrangian = sum(i in 1..N, m*x[i]'^2/2 - x[i]^2/2 + dot(r[i]', r[i]')/2*i + r[i].x'*x[1] + sum(j in 1..K, (i + 10*j)*u[i,j]'^2))
scene z { start x = 1, x[2]' = 3, u[3,2]' = 1, r[2]' = (1, 2); span 1; output p, w, s[2] }
END
named() { "$LAGC" run "$TMP/names.lag" --quiet -o "$TMP/names.csv" && sed -n 2p "$TMP/names.csv"; }
is "momenta of families have names" "0,0,6,0,0,0,0,0,0,46,3,4" "$(named)"

tap_end
