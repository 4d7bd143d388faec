#!/bin/sh
# Canonical transformations: textbook cases proved and, with a sign changed, refused with the bracket that is wrong (tests/exec/canonical: each line has its
# change and the verdict after it); the Hamiltonian and the equations in new variables; other coordinates of a Lagrangian; messages.
. tests/tap.sh

# ---- textbooks: Goldstein, chapter 9; Landau and Lifshitz, 45 to 50 ----
for m in tests/exec/canonical/*.lag; do
  n=$(grep -c '^canonical' "$m")
  check "$m: all $n proved" sh -c '"$1" check "$2" >"$4" 2>&1 && [ "$(grep -c ": canonical .*: proved" "$4")" = "$3" ] || { cat "$4"; false; }' sh "$LAGC" "$m" "$n" "$TMP/out"
done

# flips MODEL: lines that are not refused, with the verdict that their comment gives, once their sign is changed.
flips() {
  grep -v '^canonical' "$1" >"$TMP/head.lag"
  grep '^canonical' "$1" | while IFS= read -r line; do
    edit=$(echo "$line" | sed 's/.*# //; s/ | .*//') verdict=$(echo "$line" | sed 's/.* | //') text=$(echo "$line" | sed 's/ *#.*//')
    { cat "$TMP/head.lag"; echo "$text" | sed "$edit"; } >"$TMP/flip.lag"
    "$LAGC" check "$TMP/flip.lag" >"$TMP/out" 2>&1
    [ $? = 1 ] && [ "$(tail -n 1 "$TMP/flip.lag")" != "$text" ] && grep -q -e "error: .* \(is not canonical\|has another Hamiltonian\): .*$verdict" "$TMP/out" || { tail -n 1 "$TMP/flip.lag"; cat "$TMP/out"; }
  done
}
for m in tests/exec/canonical/*.lag; do empty "$m: a sign changed is refused, with the bracket" "$(flips "$m")"; done

# ---- Delaunay's elements: C.-E. Delaunay, Theorie du mouvement de la lune (1860); M. Born, Atommechanik (1925), 21 and 22 ----
sed -n '/^model delaunay "/,/^```/p' grammar/PHASE_SPACE.md | sed '$d' >"$TMP/delaunay.lag"
check "the generating function of Delaunay's elements, K = -k^2/(2 L^2)" sh -c '"$1" check "$2" | grep -q "canonical elements: proved, where det d2F2/dq dP = .* is not 0; its Hamiltonian is as given$"' sh "$LAGC" "$TMP/delaunay.lag"
delaunay() { sed "$1" "$TMP/delaunay.lag" >"$TMP/flip.lag"; ! cmp -s "$TMP/flip.lag" "$TMP/delaunay.lag" && ! "$LAGC" check "$TMP/flip.lag" 2>&1 | grep -e 'canonical elements: proved'; }
for edit in 's/- L\*atan/+ L*atan/' 's/- G\*atan((k/+ G*atan((k/' 's/- G\*atan(G\*c/+ G*atan(G*c/' 's/+ H\*atan/- H*atan/' 's/-k^2\/(2\*L/-k^2\/(L/'; do
  check "refused after $edit" delaunay "$edit"
done

# ---- the Hamiltonian in new variables ----
# in_new MODEL NAME LINE: `derive --in` prints the line.
in_new() { "$LAGC" derive "$1" --in "$2" >"$TMP/out" 2>&1; grep -q -x -F -e "$3" "$TMP/out" || { cat "$TMP/out"; false; }; }
one=tests/exec/canonical/one.lag two=tests/exec/canonical/two.lag
check "an oscillator in action and angle: K = w J" in_new $one action "  K = w*J"
check "its motion: th' = w" in_new $one action "  th' = w"
check "by F1, with the inverse that the text gives" in_new $one F1_oscillator "  K = w*P"
check "the values at t = 0 stay: K = 0" in_new $one start "  K = 0"
check "by a linear inverse" in_new $one rotated "  q = Q*cos(a) - P*sin(a)"
check "constant force: the start values move as the oscillator's force says" in_new $one fall "  Q' = w^2*t*Q - g*t - w^2*g*t^3/2 + w^2*t^2*P/m"
check "F2 that depends on t: K = H + dF/dt, without P^2/(2 m)" in_new $one F2_free "  K = m*w^2*(Q + t*P/m)^2/2"
check "a map that grows: K has c Q P/2" in_new $one grown "  K = c*Q*P/2 + P^2*exp(c*t/2)^2/(2*m) + m*w^2*Q^2/(2*exp(c*t/2)^2)"
check "R is not F, and the listing says so" in_new $one grown "Hamiltonian: K = H + R, R found from the map's own change in time, up to a function of t"
check "the centre of mass" in_new $two centre "  R' = P/(m1 + m2)"
check "and the reduced mass" in_new $two centre "  r' = (m1 + m2)*p/(m1*m2)"
check "spherical coordinates by F3" in_new tests/exec/canonical/three.lag spherical "  phi' = P_phi/(R^2*sin(th)^2)"
check "with centrifugal forces" in_new tests/exec/canonical/three.lag spherical "  P_th' = P_phi^2*cos(th)/(R^2*sin(th)^3)"
cat >"$TMP/planet.lag" <<'END'
model planet
coord x, y
momentum px of x, py of y
param m = 1 > 0, k = 1 > 0, w = 1, c = 0.1
hamiltonian = (px^2 + py^2)/(2*m) - k/sqrt(x^2 + y^2)
force x = -c*x'
force y = -c*y'
canonical polar: r = sqrt(x^2 + y^2), pr = (x*px + y*py)/sqrt(x^2 + y^2), th = atan2(y, x), L = x*py - y*px,
  x = r*cos(th), y = r*sin(th), px = pr*cos(th) - L*sin(th)/r, py = pr*sin(th) + L*cos(th)/r
canonical turning: X = x*cos(w*t) + y*sin(w*t), PX = px*cos(w*t) + py*sin(w*t), Y = y*cos(w*t) - x*sin(w*t), PY = py*cos(w*t) - px*sin(w*t)
canonical bent: Q1 = x^2, P1 = px/(2*x), Q2 = y, P2 = py
END
check "a planet in polar coordinates" in_new "$TMP/planet.lag" polar "  K = (L^2/r^2 + pr^2)/(2*m) - k/r"
check "with forces: the torque" in_new "$TMP/planet.lag" polar "  L' = -c*L/m"
check "and the radial force" in_new "$TMP/planet.lag" polar "  pr' = L^2/(m*r^3) - k/r^2 - c*pr/m"
check "in a frame that turns, Coriolis" in_new "$TMP/planet.lag" turning "  X' = w*Y + PX/m"
sed 's/^canonical polar.*/canonical polar(r, th): x = r*cos(th), y = r*sin(th)/; /^  x = r/d' "$TMP/planet.lag" >"$TMP/lifted.lag"
check "other coordinates of a Hamiltonian: momenta follow" in_new "$TMP/lifted.lag" polar "  py = p_r*sin(th) + p_th*cos(th)/r"
check "the same torque" in_new "$TMP/lifted.lag" polar "  p_th' = -c*p_th/m"
check "as LaTeX" sh -c '"$0" derive "$1" --in polar --format latex | grep -q -F "\\dot{L} &= -\\frac{c L}{m}"' "$LAGC" "$TMP/planet.lag"
refuses() { pattern=$1; shift; ! "$LAGC" "$@" >"$TMP/out" 2>"$TMP/err" && ! [ -s "$TMP/out" ] && grep -q -F -e "$pattern" "$TMP/err" || { cat "$TMP/err"; false; }; }
check "no inverse" refuses "the inverse of \`bent\` is not found" derive "$TMP/planet.lag" --in bent
check "no such name" refuses "did you mean \`polar\`?" derive "$TMP/planet.lag" --in pola
check "no canonical transformation at all" refuses "declare it: \`canonical polar: Q = ..., P = ...\`" derive models/kepler.lag --in polar
check "two forms" refuses "give one of --hamiltonian, --lagrangian, --bracket and --in" derive "$TMP/planet.lag" --in polar --hamiltonian
sed 's/- L\*sin(th)/+ L*sin(th)/' "$TMP/planet.lag" >"$TMP/wrong.lag"
check "a wrong inverse" refuses "\`polar\` is not canonical: px = px, as the inverse gives it, is false" derive "$TMP/wrong.lag" --in polar

# ---- a Lagrangian ----
cat >"$TMP/disc.lag" <<'END'
model disc "A spring on a disc that turns, with drag"
coord x, y
param m = 1 > 0, k = 2 > 0, w = 3, c = 0.1 > 0
lagrangian = m/2*(x'^2 + y'^2) - k/2*(x^2 + y^2)
dissipation = c/2*(x'^2 + y'^2)
canonical disc(X, Y): x = X*cos(w*t) - Y*sin(w*t), y = X*sin(w*t) + Y*cos(w*t)
canonical polar(r, th): x = r*cos(th), y = r*sin(th)
canonical swapped: Q1 = p_x, P1 = -x, Q2 = y, P2 = p_y
END
check "a change of coordinates is proved where its Jacobian is not 0" sh -c '"$0" check "$1" | grep "change of coordinates polar: proved, where det dq/dQ = r is not 0"' "$LAGC" "$TMP/disc.lag"
check "centrifugal and Coriolis force, and drag" in_new "$TMP/disc.lag" disc "  m*X'' = w*c*Y - (k - m*w^2)*X - c*X' + 2*m*w*Y'"
check "polar coordinates" in_new "$TMP/disc.lag" polar "  m*r^2*th'' = -2*m*r*r'*th' - c*r^2*th'"
check "momenta of L in a canonical transformation" in_new "$TMP/disc.lag" swapped "  Q1' = k*P1 - c*Q1/m"

# ---- functions with jumps and corners: derivatives are those of the branches, and each verdict says so
cat >"$TMP/jumps.lag" <<'END'
model jumps
coord x, y
momentum p of x, r of y
hamiltonian = (p^2 + r^2)/2
expect {floor(x), p} = 0
expect {sign(x), p} = 0
expect {abs(x), p} = sign(x)
expect {if(x > 1, x^2, x), p^2} = 2*p*if(x > 1, 2*x, 1)
expect {max(x, y), p} = if(x > y, 1, 0)
expect {x*floor(p), energy} = p*floor(p)
expect {abs(x), {abs(p), y*r}} = 0
canonical c: Q1 = floor(x) + x, P1 = p, Q2 = y, P2 = r
canonical d: Q1 = abs(x), P1 = p*sign(x), Q2 = y, P2 = r
END
"$LAGC" check "$TMP/jumps.lag" >"$TMP/out" 2>&1
is "between jumps: expectations and maps" "7 2" "$(grep -c ': expect .*: proved between jumps$' "$TMP/out") $(grep -c ': canonical .: proved between jumps, ' "$TMP/out")"
wrong() { sed "$1" "$TMP/jumps.lag" >"$TMP/flip.lag"; ! cmp -s "$TMP/flip.lag" "$TMP/jumps.lag" && ! "$LAGC" check "$TMP/flip.lag" >"$TMP/out" 2>&1 && grep -q "$2" "$TMP/out" || { cat "$TMP/out"; false; }; }
check "a wrong factor is refuted" wrong 's/{abs(x), p} = sign(x)/{abs(x), p} = 2*sign(x)/' 'the factor `2` should not be there'
check "a map without its sign" wrong 's/P1 = p\*sign(x)/P1 = p/' '`d` is not canonical: {Q1, P1} is sign(x), and must be 1'

# ---- Hamilton and Jacobi: W of an oscillator with asin, acos and atan of the same angle, where dW/dq exists
for angle in 'asin(q*w*sqrt(m/(2*al)))' '-acos(q*w*sqrt(m)/sqrt(2*al))' 'atan2(m*w*q, sqrt(2*m*al - m^2*w^2*q^2))'; do
  cat >"$TMP/oscillator.lag" <<END
model oscillator
coord q
momentum p of q
param m = 1 > 0, w = 2 > 0
hamiltonian = p^2/(2*m) + m*w^2*q^2/2
canonical c: F2(q, al) = q*sqrt(2*m*al - m^2*w^2*q^2)/2 + al/w*($angle), hamiltonian = al
END
  check "W with $angle" sh -c '"$1" check "$2" | grep -q "canonical c: proved, where .* is not 0; its Hamiltonian is as given$"' sh "$LAGC" "$TMP/oscillator.lag"
  sed 's/ + al/ - al/' "$TMP/oscillator.lag" >"$TMP/flip.lag"
  check "refused with another sign" sh -c '"$1" check "$2" 2>&1 | grep -q "has another Hamiltonian: H + dF/dt is .*, and must be al"' sh "$LAGC" "$TMP/flip.lag"
done
tap_end
