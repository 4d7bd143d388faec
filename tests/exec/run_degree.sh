#!/bin/sh
# lagc noether --degree: charges of degree 2, 3 and 4 in the momenta, against formulas of the literature, compared in 50 digits by mpmath.
. tests/tap.sh

noether() { "$LAGC" noether "$TMP/m.lag" --degree "$@"; }
model() { cat >"$TMP/m.lag"; } # radii r are of the plane, or of space where the model's name has a z
says() { noether "$1" >"$TMP/out" 2>&1 && grep -q -e "$2" "$TMP/out" || { cat "$TMP/out"; return 1; }; }

# literature NAME DEGREE FORMULA...: --degree finds as many new charges as there are formulas, and each formula, a polynomial in x' .. with m's parameters,
# is a constant combination of the new charges, of products of charges known before, and of 1.
literature() {
  name=$1 degree=$2
  shift 2
  noether "$degree" --format json >"$TMP/found" 2>"$TMP/err" || cat "$TMP/err" >&2
  check "$name" python3 "$TMP/compare.py" "$TMP/found" "$degree" "$@"
}

cat >"$TMP/compare.py" <<'END2'
import itertools, json, random, sys
import mpmath as mp
mp.mp.dps = 50
found = json.load(open(sys.argv[1]))
degree, formulas = int(sys.argv[2]), sys.argv[3:]
names = {f: getattr(mp, f) for f in ("sqrt", "exp", "sin", "cos")}
names["hypot"] = lambda a, b: mp.sqrt(a * a + b * b)
def code(text):
    return compile(text.replace("^", "**").replace("'", "_"), text, "eval")
new = [(c["degree"], code(c["charge"])) for c in found["degree"]["charges"]]
known = [(1 if s["delta_t"] == "0" else 2, code(s["charge"])) for s in found["symmetries"]
         if "t" not in code(s["charge"]).co_names]
assert found["degree"]["certain"] and found["degree"]["not_proved"] == 0, found["degree"]
assert len(new) == len(formulas), "%d charges found, %d in the literature" % (len(new), len(formulas))
products = [c for n in range(degree + 1) for c in itertools.combinations_with_replacement(known + new, n) if sum(d for d, _ in c) <= degree]
rng = random.Random(5)
fixed = {p: mp.mpf(rng.uniform(0.5, 2)) for p in "m k A B C D F a b c g".split()}
def state():
    at = dict(names, **fixed)
    for x in "xyzw":
        at[x], at[x + "_"], at["p" + x] = (mp.mpf(rng.uniform(-2, 2)) for _ in range(3))
    at["r"] = mp.sqrt(at["x"] ** 2 + at["y"] ** 2 + (at["z"] ** 2 if "z" in found["model"] else 0))
    return at
states = [state() for _ in range(len(products) + 8)]
def column(product, at):
    value = mp.mpf(1)
    for _, c in product:
        value *= eval(c, {}, at)
    return value
rows = [[column(p, at) for p in products] for at in states]
for f in formulas:
    m = mp.matrix([row + [eval(code(f), {}, at)] for row, at in zip(rows, states)])
    # Gram-Schmidt over columns: the formula, last, must lie in the span of the others. 50 digits: 1e-25 is far above rounding, far below a wrong term.
    basis, left = [], None
    for j in range(m.cols):
        v = m[:, j]
        size = mp.norm(v)
        for _ in range(2):
            for q in basis:
                v -= q * (q.T * v)[0]
        left = mp.norm(v) / size
        if left > mp.mpf(10) ** -25 and j < m.cols - 1:
            basis.append(v / mp.norm(v))
    assert left < mp.mpf(10) ** -25, "not in the span: %s (%s left)" % (f, mp.nstr(left, 3))
# The charges found are independent of products and of one another, or the formulas would not be: their number agrees.
END2
command -v python3 >/dev/null && python3 -c 'import mpmath' 2>/dev/null || { skip "charges of the literature" "there is no python3 with mpmath"; tap_end; exit; }

# Goldstein, Poole, Safko: Classical Mechanics, 3rd ed. (2002), (3.82): A = p x L - m k r/|r|.
model <<'END2'
model kepler
coord x, y
param m = 2 > 0, k = 3 > 0
lagrangian = m/2*(x'^2 + y'^2) + k/sqrt(x^2 + y^2)
END2
literature "Runge and Lenz in the plane" 2 "m*y'*m*(x*y' - y*x') - m*k*x/r" "-m*x'*m*(x*y' - y*x') - m*k*y/r"
model <<'END2'
model kepler_z
coord x, y, z
param m = 2 > 0, k = 3 > 0
let r = sqrt(x^2 + y^2 + z^2)
lagrangian = m/2*(x'^2 + y'^2 + z'^2) + k/r
END2
literature "Runge and Lenz in space" 2 "m^2*(y'*(x*y' - y*x') - z'*(z*x' - x*z')) - m*k*x/r" "m^2*(z'*(y*z' - z*y') - x'*(x*y' - y*x')) - m*k*y/r" \
  "m^2*(x'*(z*x' - x*z') - y'*(y*z' - z*y')) - m*k*z/r"
check "which is printed in a form to read" says 2 '^  Q5 = m^2\*(x\*y.^2 + x\*z.^2 - y\*x.\*y. - z\*x.\*z.) - m\*k\*x/r$'
sed -n '/^model planet "A planet, in C/,/^```/p' grammar/LANGUAGE.md | sed '$d' >"$TMP/planet.lag"
"$LAGC" noether "$TMP/planet.lag" --degree 2 >"$TMP/out" 2>&1
is "the language's example prints what it says" "$(grep '^  Q[34] = .*r' grammar/LANGUAGE.md)" "$(grep '^  Q[34] = ' "$TMP/out")"
# A uniform field leaves one component: P. J. Redmond, Phys. Rev. 133 (1964) B1352.
sed -i.bak 's|k/r$|k/r + F*z|; s|^param|param F = 1,|' "$TMP/m.lag"
literature "Kepler in a uniform field" 2 "m^2*(x'*(z*x' - x*z') - y'*(y*z' - z*y')) - m*k*z/r + m*F/2*(x^2 + y^2)"
model <<'END2'
model polar
coord x [m], y [rad] periodic
param m = 2 [kg] > 0, k = 3 [N*m^2] > 0
lagrangian = m/2*(x'^2 + x^2*y'^2) + k/x
END2
literature "in polar coordinates, with an angle declared periodic" 2 "m^2*(x'*sin(y) + x*y'*cos(y))*x^2*y' - m*k*cos(y)" "-m^2*(x'*cos(y) - x*y'*sin(y))*x^2*y' - m*k*sin(y)"
# Two fixed centres at x = -c, c: H. A. Erikson, E. L. Hill, Phys. Rev. 75 (1949) 29.
model <<'END2'
model centres
coord x, y
param a = 2 > 0, b = 3 > 0, c = 1 > 0
lagrangian = (x'^2 + y'^2)/2 + a/hypot(x - c, y) + b/hypot(x + c, y)
END2
literature "two fixed centres" 2 "(x*y' - y*x')^2 - c^2*y'^2 - 2*c*(a*(x - c)/hypot(x - c, y) - b*(x + c)/hypot(x + c, y))"
# J. Fradkin, Am. J. Phys. 33 (1965) 207: A_ij = p_i p_j/(2 m) + k x_i x_j/2; its trace is the energy.
model <<'END2'
model oscillator
coord x, y, z
param m = 2 > 0, k = 3 > 0
lagrangian = m/2*(x'^2 + y'^2 + z'^2) - k/2*(x^2 + y^2 + z^2)
END2
literature "Fradkin's tensor" 2 "m*x'^2 + k*x^2" "m*y'^2 + k*y^2" "m*x'*y' + k*x*y" "m*y'*z' + k*y*z" "m*z'*x' + k*z*x"

# Henon-Heiles, A x^2 + B y^2, D x^2 y - C y^3/3: Y. F. Chang, M. Tabor, J. Weiss, J. Math. Phys. 23 (1982) 531; Hietarinta (1987), 3.3.
model <<'END2'
model henon
coord x, y
param A = 2 > 0, D = 3
lagrangian = (x'^2 + y'^2)/2 - A/2*(x^2 + y^2) - D*x^2*y - D*y^3/3
END2
literature "Henon-Heiles, D/C = -1" 2 "x'*y' + A*x*y + D*x*y^2 + D*x^3/3"
model <<'END2'
model henon
coord x, y
param A = 2 > 0, B = 1 > 0, D = 3
lagrangian = (x'^2 + y'^2)/2 - A/2*x^2 - B/2*y^2 - D*x^2*y - 2*D*y^3
END2
literature "Henon-Heiles, D/C = -1/6" 2 "D*x^4 + 4*D*x^2*y^2 - 4*x'*(x'*y - y'*x) + 4*A*x^2*y + (4*A - B)/D*(x'^2 + A*x^2)"
model <<'END2'
model henon
coord x, y
param A = 2 > 0, D = 3
lagrangian = (x'^2 + y'^2)/2 - A/2*x^2 - 8*A*y^2 - D*x^2*y - 16/3*D*y^3
END2
literature "Henon-Heiles, D/C = -1/16" 4 "3*x'^4 + 6*(A + 2*D*y)*x^2*x'^2 - 4*D*x^3*x'*y' - 4*D*x^4*(A*y + D*y^2) + 3*A^2*x^4 - 2*D^2*x^6/3"
check "of which none is of degree 2" says 2 '^found: none but products of the charges above'
model <<'END2'
model henon
coord x, y
param A = 2 > 0, B = 1 > 0, C = 1, D = 3
lagrangian = (x'^2 + y'^2)/2 - A/2*x^2 - B/2*y^2 - D*x^2*y + C*y^3/3
END2
literature "all other members of the family have none" 4
check "which is said together with the ansatz" says 4 '^looked for: charges of degree 4 in the momenta, free of t: coefficients at p^4 are polynomials of the coordinates of degree 4; at p^2 of degree 7; at p^0 of degree 10$'

# M. Henon, Phys. Rev. B 9 (1974) 1921; H. Flaschka, Phys. Rev. B 9 (1974) 1924.
model <<'END2'
model toda
coord x, y, z
lagrangian = (x'^2 + y'^2 + z'^2)/2 - exp(x - y) - exp(y - z) - exp(z - x)
END2
literature "Toda's cubic charge" 3 "x'*y'*z' - x'*exp(y - z) - y'*exp(z - x) - z'*exp(x - y)"
# J. Moser, Adv. Math. 16 (1975) 197: trace of the cube of Lax's matrix.
model <<'END2'
model calogero
coord x, y
param g = 2 > 0, k = 3 > 0
lagrangian = (x'^2 + y'^2)/2 - g/(x - y)^2 - k*(x^2 + y^2)/2
END2
literature "two particles that repel, in an oscillator" 2 "(x' + y')^2 + k*(x + y)^2" "(x*y' - y*x')^2 + 2*g*(x^2 + y^2)/(x - y)^2"

# A term linear in velocities mixes even and odd degrees: an oscillator in a magnetic field keeps its two charges, and no others.
model <<'END2'
model larmor
coord x, y
param m = 2 > 0, k = 3 > 0, b = 1
lagrangian = m/2*(x'^2 + y'^2) + b/2*(x*y' - y*x') - k/2*(x^2 + y^2)
END2
literature "an oscillator in a magnetic field" 2
# Hamiltonians as input: the same charges in q and p; and H with terms linear in p.
model <<'END2'
model kepler
coord x, y
momentum px of x, py of y
param m = 2 > 0, k = 3 > 0
hamiltonian = (px^2 + py^2)/(2*m) - k/hypot(x, y)
END2
literature "a Hamiltonian" 2 "py*(x*py - y*px) - m*k*x/hypot(x, y)" "-px*(x*py - y*px) - m*k*y/hypot(x, y)"
model <<'END2'
model rotating
coord x, y
momentum px of x, py of y
param c = 2, k = 3 > 0
hamiltonian = (px^2 + py^2)/2 + c*(y*px - x*py) - k/hypot(x, y)
END2
literature "Kepler in a frame that turns, where the vector turns with t" 2
# Geodesics of the half-plane of Poincare: an isometry that is not affine gives a charge of degree 1, and its products none of degree 2.
model <<'END2'
model hyperbolic
coord x, y
lagrangian = (x'^2 + y'^2)/(2*y^2)
END2
literature "the half-plane's third isometry" 2 "((x^2 - y^2)*x' + 2*x*y*y')/y^2"
check "is of degree 1" says 2 '^Q4: of degree 1 in the momenta$'
# A screened potential is central, and keeps no vector.
model <<'END2'
model yukawa
coord x, y
param m = 2 > 0, k = 3 > 0
let r = sqrt(x^2 + y^2)
lagrangian = m/2*(x'^2 + y'^2) + k*exp(-r)/r
END2
literature "a screened potential" 3
model <<'END2'
model catenary
coord y
lagrangian = y*sqrt(1 + y'^2)
END2
literature "the square of an energy that is a root is none" 2

# ---- what is not searched, and mistakes ----
says_not() { "$LAGC" noether "$1" --degree 2 >"$TMP/out" 2>&1 && grep -q -e "^not searched to degree 2 in the momenta: $2" "$TMP/out" || { cat "$TMP/out"; return 1; }; }
check "constraints" says_not models/cartesian_pendulum.lag "the model has constraints"
check "an L of first order" says_not models/point_vortices.lag "L is linear in velocities"
check "states" says_not models/motor_pendulum.lag "the model has states beside its coordinates"
check "too many coordinates" says_not models/fput.lag "too many unknowns"
cat >"$TMP/step.lag" <<'END2'
model step
coord x, y
lagrangian = (x'^2 + y'^2)/2 - (if(x > 0, 1, 0) + y^2)
END2
check "a potential with a step" says_not "$TMP/step.lag" "L is discontinuous"
refuses() { ! "$LAGC" noether models/kepler.lag --degree "$1" >"$TMP/out" 2>&1 && grep -q -e "--degree takes 2, 3, 4, not .$1." "$TMP/out" || { cat "$TMP/out"; return 1; }; }
check "degree 1" refuses 1
check "degree 5" refuses 5
check "without --degree there are none" sh -c '! "$0" noether models/kepler.lag | grep -e momenta' "$LAGC"
tap_end
