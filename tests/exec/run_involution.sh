#!/bin/sh
# lagc noether --involution: sets of charges against what textbooks call integrable. Where T = v^2/2, mpmath differentiates the printed charges in 30 digits: their
# brackets are 0, and their gradients independent.
. tests/tap.sh

model() { cat >"$TMP/m.lag"; }
noether() { "$LAGC" noether "$TMP/m.lag" --involution "$@" >"$TMP/out" 2>"$TMP/err"; }
# count NAME WORDS OPTION...: the line "in involution: ..." ends with the words.
count() {
  name=$1 words=$2
  shift 2
  noether "$@"
  is "$name" "$words" "$(sed -n 's/^in involution: *//p' "$TMP/out" | sed 's/.*: \([0-9]* of \)/\1/; s/ of the / of /; s/ that integrability needs//')"
}
says() { noether; grep -q -F -e "$1" "$TMP/out" || { cat "$TMP/out"; false; }; }
cat >"$TMP/brackets.py" <<'END2'
import json, sys
import mpmath as mp
mp.mp.dps = 30
found = json.load(open(sys.argv[1]))["involution"]
coords = sys.argv[2].split()
n = len(coords)
assert found["integrable"] and len(found["charges"]) == n == found["degrees_of_freedom"], found
names = {f: getattr(mp, f) for f in ("sqrt", "exp", "sin", "cos")}
names.update(A=mp.mpf(2), D=mp.mpf(3), B=mp.mpf(1) if len(sys.argv) < 4 else mp.mpf(sys.argv[3]), k=mp.mpf(3))
def charge(c):
    code = compile(c["charge"].replace("^", "**").replace("'", "_"), "charge", "eval")
    def f(*z):
        at = dict(names)
        for i, x in enumerate(coords):
            at[x], at[x + "_"] = z[i], z[n + i]
        if "r" in code.co_names:
            at["r"] = mp.sqrt(sum(z[i] ** 2 for i in range(n)))
        return eval(code, {}, at)
    return f
at = [mp.mpf(7 * i % 5 + 3) / (i + 5) for i in range(2 * n)]
d = [[mp.diff(charge(c), tuple(at), tuple(int(j == i) for j in range(2 * n))) for i in range(2 * n)] for c in found["charges"]]
for a in d:
    for b in d: # 1e-12: mpmath differences are good for about half of 30 digits
        assert abs(sum(a[i] * b[n + i] - a[n + i] * b[i] for i in range(n))) < mp.mpf(10) ** -12, found
gram = mp.matrix(n, n)
for i in range(n):
    for j in range(n):
        gram[i, j] = sum(x * y for x, y in zip(d[i], d[j])) / mp.sqrt(sum(x * x for x in d[i]) * sum(x * x for x in d[j]))
assert mp.det(gram) > 1e-6, mp.det(gram)
END2
have_mpmath=$(command -v python3 >/dev/null && python3 -c 'import mpmath' 2>/dev/null && echo yes)
# integrable NAME COORDINATES OPTION...: n charges of n, and mpmath agrees.
integrable() {
  name=$1 coords=$2 B=${B_IS-1}
  shift 2
  noether --format json "$@"
  if [ "$have_mpmath" ]; then check "$name" python3 "$TMP/brackets.py" "$TMP/out" "$coords" "$B"; else skip "$name" "there is no python3 with mpmath"; fi
}

model <<'END2'
model kepler
coord x, y
param k = 3 > 0
lagrangian = (x'^2 + y'^2)/2 + k/hypot(x, y)
END2
count "Kepler in the plane: energy and angular momentum" "2 of 2: Liouville-integrable"
check "not superintegrable" says "  2 independent charges in all, by the rank of gradients at random states"
check "with no more said" sh -c '! grep -q superintegrable "$1"' sh "$TMP/out"
noether --degree 2
check "with Runge and Lenz there is one more" grep -q '^  3 independent charges in all, by the rank of gradients at random states: maximally superintegrable$' "$TMP/out"
model <<'END2'
model kepler_z
coord x, y, z
param k = 3 > 0
let r = sqrt(x^2 + y^2 + z^2)
lagrangian = (x'^2 + y'^2 + z'^2)/2 + k/r
END2
integrable "Kepler in space: energy, one angular momentum, and their squares" "x y z"
check "named" grep -q '"squares_of": \[2, 3, 4\]' "$TMP/out"
check "... as text" says "in involution: Q1, Q2, Q2^2 + Q3^2 + Q4^2: 3 of 3: Liouville-integrable"
integrable "or a component of the Runge-Lenz vector" "x y z" --degree 2
is "which says that five are independent" 5 "$(sed -n 's/.*"independent": \([0-9]*\),.*/\1/p' "$TMP/out")"
model <<'END2'
model oscillator
coord x, y, z
param k = 3 > 0
lagrangian = (x'^2 + y'^2 + z'^2)/2 - k/2*(x^2 + y^2 + z^2)
END2
integrable "an isotropic oscillator" "x y z" --degree 2
check "of five independent charges" grep -q '"independent": 5' "$TMP/out"
model <<'END2'
model screened
coord x, y, z
param k = 3 > 0
let r = sqrt(x^2 + y^2 + z^2)
lagrangian = (x'^2 + y'^2 + z'^2)/2 + k*exp(-r)/r
END2
integrable "any central force in space" "x y z"
check "of four independent charges" grep -q '"independent": 4' "$TMP/out"

# ---- Henon and Heiles: Y. F. Chang, M. Tabor, J. Weiss, J. Math. Phys. 23 (1982) 531 ----
henon() { printf "model henon\ncoord x, y\nparam A = 2 > 0, B = 1 > 0, D = 3\nlagrangian = (x'^2 + y'^2)/2 - A/2*x^2 - %s*y^2 - D*x^2*y - %s*y^3\n" "$1" "$2" >"$TMP/m.lag"; }
henon A/2 D/3
integrable "Henon-Heiles, D/C = -1 with A = B" "x y" --degree 2
count "which without --degree has one" "1 of 2"
henon B/2 2*D
integrable "Henon-Heiles, D/C = -1/6" "x y" --degree 2
henon 8*A 16/3*D
integrable "Henon-Heiles, D/C = -1/16 with B = 16 A, at degree 4" "x y" --degree 4
count "which at degree 2 has one" "1 of 2" --degree 2
henon B/2 D/3
count "D/C = -1 with other frequencies has one" "1 of 2" --degree 4
check "within the coefficients that were looked for" grep -q '^  none is left within the coefficients above up to degree 4 in the momenta; others may exist$' "$TMP/out"

# ---- others ----
model <<'END2'
model toda
coord x, y, z
lagrangian = (x'^2 + y'^2 + z'^2)/2 - exp(x - y) - exp(y - z) - exp(z - x)
END2
integrable "Toda's lattice of three, by its cubic charge" "x y z" --degree 3
count "at degree 2 it lacks one" "2 of 3" --degree 2
cp models/double_pendulum.lag "$TMP/m.lag"
count "a double pendulum has its energy" "1 of 2" --degree 2
count "without --degree" "1 of 2"
check "it says where there may be others" grep -q '^  higher degrees in the momenta were not searched: --degree 2, 3, 4$' "$TMP/out"
# L. D. Landau, E. M. Lifshitz, Mechanics, 35 and 36: the tops, in Euler's angles.
model <<'END2'
model euler
coord phi, th, psi
momentum pf of phi, pt of th, ps of psi
param A = 3 > 0, B = 2 > 0, C = 1 > 0
let s = (pf - ps*cos(th))/sin(th)
let Mx = s*sin(psi) + pt*cos(psi), My = s*cos(psi) - pt*sin(psi), Mz = ps
hamiltonian = Mx^2/(2*A) + My^2/(2*B) + Mz^2/(2*C)
observe total = Mx^2 + My^2 + Mz^2
expect {total, energy} = 0
expect {Mx, My} = -Mz
END2
count "Euler's top, with the square of M declared" "3 of 3: Liouville-integrable"
check "by its name" grep -q '^in involution: Q1, Q2, total: ' "$TMP/out"
sed -i.bak '/^observe/d; s/^expect {total, .*/expect {Mx^2 + My^2 + Mz^2, energy} = 0/' "$TMP/m.lag"
count "as an operand of a bracket" "3 of 3: Liouville-integrable"
sed -i.bak '/^expect/d' "$TMP/m.lag"
count "not declared" "2 of 3"
model <<'END2'
model lagrange
coord phi, th, psi
param A = 3 > 0, C = 1 > 0, mgl = 2 > 0
lagrangian = A/2*(th'^2 + phi'^2*sin(th)^2) + C/2*(psi' + phi'*cos(th))^2 - mgl*cos(th)
END2
count "Lagrange's top" "3 of 3: Liouville-integrable"
model <<'END2'
model free
coord x, y
lagrangian = (x'^2 + y'^2)/2
observe boost = x - x'*1
END2
count "a free particle; the energy follows from its momenta" "2 of 2: Liouville-integrable"
check "of which three in all are free of t" says "  3 independent charges in all, by the rank of gradients at random states: maximally superintegrable"
model <<'END2'
model driven
coord x
param w = 2
lagrangian = x'^2/2 - x^4/4 + x*cos(w*t)
observe action = (x'^2 + x^4/2)/2
END2
count "a driven oscillator: observed quantities that change are none" "0 of 1"

# C. G. J. Jacobi, J. reine angew. Math. 19 (1839) 309: geodesics of the ellipsoid x^2/3 + y^2/2 + z^2 = 1 in its elliptic coordinates.
model <<'END2'
model ellipsoid
coord u, v
momentum pu of u, pv of v
let A = (3 - u)*(2 - u)*(1 - u)/u*pu^2, B = (3 - v)*(2 - v)*(1 - v)/v*pv^2
hamiltonian = 2*(A - B)/(u - v)
END2
count "a particle on an ellipsoid, by Jacobi's integral" "2 of 2: Liouville-integrable" --degree 2
count "which is quadratic" "1 of 2"
# F. Joachimsthal, J. reine angew. Math. 26 (1843) 155, of the same motion in x and y.
model <<'END2'
model joachimsthal
coord x, y
param a = 3 > 0, b = 2 > 0, c = 1 > 0
let z = c*sqrt(1 - x^2/a^2 - y^2/b^2)
let zt = -c^2*(x*x'/a^2 + y*y'/b^2)/z
lagrangian = (x'^2 + y'^2 + zt^2)/2
let J = (x^2/a^4 + y^2/b^4 + z^2/c^4)*(x'^2/a^2 + y'^2/b^2 + zt^2/c^2)
expect {J, energy} = 0
END2
count "by Joachimsthal's, in projection" "2 of 2: Liouville-integrable"
sed -i.bak 's|x^2/a^4|x^2/a^2|' "$TMP/m.lag"
count "which is none with another power" "1 of 2"
# B. Carter, Phys. Rev. 174 (1968) 1559: geodesics of Kerr's metric, t called T.
cp models/kerr.lag "$TMP/m.lag"
count "Kerr's metric, with Carter's constant declared" "4 of 4: Liouville-integrable"
sed -i.bak 's|- 2\*a^2|+ 2*a^2|' "$TMP/m.lag"
count "with another sign it is none" "3 of 4"
check "which the search of degree 2 does not reach" sh -c '"$1" noether "$2" --degree 2 --involution | grep -q "^in involution: Q1, Q2, Q3: 3 of the 4 "' sh "$LAGC" "$TMP/m.lag"

sed -n '/^model euler_top "/,/^```/p' grammar/LANGUAGE.md | sed '$d' >"$TMP/m.lag"
noether
is "the language's example prints what it says" "$(grep '^in involution: Q1' grammar/LANGUAGE.md)" "$(grep '^in involution: ' "$TMP/out")"

# ---- false charges ----
model <<'END2'
model kicked_rotor "chaotic: B. V. Chirikov, Phys. Rep. 52 (1979) 263"
coord q periodic
momentum p of q
param K = 0.97
hamiltonian = p^2/2
kick pulse every 1 { p = p - K*sin(q) }
END2
check "kicks change charges" says "no charges in involution: kicks, events or impacts change the state, and the charges with it"
sed -i.bak 's/^kick .*/event wall: q - 1 rising { p = -p }/' "$TMP/m.lag"
check "events do" says "no charges in involution: kicks, events or impacts change the state, and the charges with it"
sed -i.bak 's/{ p = -p }/{ stop }/' "$TMP/m.lag"
count "an event that ends the run does not" "1 of 1: Liouville-integrable"
model <<'END2'
model pumped "h1 commutes with H at each time, and is not conserved"
coord x, y
momentum px of x, py of y
input u = sin(t)
let h1 = px^2/2 + (2 + u)*x^2/2
hamiltonian = h1 + py^2/2 + y^2/2
observe f = h1
END2
count "functions of an input are none" "1 of 2"
model <<'END2'
model irrational "its angles' difference has many values"
coord x, y
momentum px of x, py of y
param w = 1.3 > 0
hamiltonian = (px^2 + x^2 + py^2 + w^2*y^2)/2
observe a = atan2(x, px) - atan2(w*y, py)/w
END2
count "two oscillators" "2 of 2: Liouville-integrable"
check "with the difference of their angles are not superintegrable" says "  2 independent charges in all, by the rank of gradients at random states"
check "no more is said" sh -c '! grep -q superintegrable "$1"' sh "$TMP/out"
model <<'END2'
model torus
coord a periodic, b periodic
momentum pa of a, pb of b
hamiltonian = (pa^2 + pb^2)/2
observe winds = a*pb - b*pa
END2
check "on a torus a*pb - b*pa has many values" says "  2 independent charges in all, by the rank of gradients at random states"
sed -i.bak 's/ periodic//g' "$TMP/m.lag"
check "in the plane it counts" says "  3 independent charges in all, by the rank of gradients at random states: maximally superintegrable"

model <<'END2'
model same "(E + L)^7, expanded, less itself: 0, with a gradient of rounding"
coord x, y
momentum px of x, py of y
let E = (px^2 + py^2)/2 + (x^2 + 3*y^2)^2, L = x*py - y*px
hamiltonian = E
observe zero = (E + L)^7 - E^7 - 7*E^6*L - 21*E^5*L^2 - 35*E^4*L^3 - 35*E^3*L^4 - 21*E^2*L^5 - 7*E*L^6 - L^7
END2
check "zero is not independent" says "  1 independent charge in all, by the rank of gradients at random states"

# ---- many charges ----
{
  echo "model many"
  for i in 1 2 3 4 5 6 7 8 9; do printf 'coord x%d\nmomentum p%d of x%d\n' $i $i $i; done
  printf 'hamiltonian = 0'
  for i in 1 2 3 4 5 6 7 8 9; do printf ' + p%d^2/2 + %d*x%d^2/2' $i $((i * i + 1)) $i; done
  echo
  for i in 1 2 3 4 5 6 7 8; do
    for j in 1 2 3 4 5 6 7 8 9; do echo "observe f${i}_$j = (p$i^2 + $((i * i + 1))*x$i^2)^$((j + 1))"; done
  done
} >"$TMP/m.lag"
[ -z "${SLOW:-}" ] || count "72 functions declared" "9 of 9: Liouville-integrable"
model <<'END2'
model central "36 rotations commute at most in fours"
const N = 9
coord r[N]
lagrangian = sum(i in 1..N, r[i]'^2)/2 - sum(i in 1..N, r[i]^2)^2
END2
count "a central force in nine dimensions" "5 of 9"
check "2 N - 3 independent rotations, and the energy" says "  16 independent charges in all, by the rank of gradients at random states"
check "a search that ends early says so" says "  the search for sets ended after 20000 tries: there may be a larger one"
noether --seconds 0.001
check "so does one whose time is spent" grep -qF "  the search for sets ended after 0 tries, as the time was spent; --seconds gives more: there may be a larger one" "$TMP/out"

# ---- no answer ----
check "friction" says "no charges in involution: forces stand outside L" "$(printf "model m\ncoord x\nlagrangian = x'^2/2 - x^2/2\nforce x = -x'\n" >"$TMP/m.lag")"
check "constraints" sh -c '"$1" noether models/cartesian_pendulum.lag --involution | grep -q "^no charges in involution: the model has constraints, which need Dirac brackets$"' sh "$LAGC"
check "without the option nothing is said" sh -c '! "$1" noether models/kepler.lag | grep involution' sh "$LAGC"
cp models/kepler.lag "$TMP/m.lag"
noether --format latex
check "in LaTeX it is a comment" grep -q '^% in involution: ' "$TMP/out"
tap_end
