#!/bin/sh
# lagc derive of families: equations of members as one with an index, sums with their signs, indices of LaTeX; judged by the potential as Python has it.
. tests/tap.sh

model() { # NAME N POTENTIAL [COORD]
  printf 'model %s\nconst N = %s\ncoord u[N%s]\nparam k = 2, c = 3\nobserve used = k + c\n%s\n' "$1" "$2" "${4:+,N}" "$3" >"$TMP/$1.lag"
}
kinetic="kinetic = sum(i in 1..N, u[i]'^2/2)"
both='sum(i in 1..N, sum(j in 1..i-1,'
model springs 200 "$kinetic
potential = $both k*(u[i] - u[j])^2/2)) - sum(i in 1..N, c*u[i]^4/4)"
sed 's/N = 200/N = 40/' "$TMP/springs.lag" >"$TMP/spelt.lag" # whose sums are written out first
model sines 400 "$kinetic
potential = $both k*sin(u[i] - u[j])))"
model skew 300 "$kinetic
potential = $both k*(u[i]^2*u[j] - 2*u[j]^3*u[i])))"
model string 12 "let r[i in 0..N] = if(i < N, u[i+1], 0) - if(i > 0, u[i], 0)
$kinetic
potential = sum(i in 0..N, k/2*r[i]^2 + c/4*r[i]^4)"
model tied 10 "param w[N] = 1
$kinetic
potential = sum(i in 1..5, k/2*(u[i] - w[i])^2) + sum(i in 6..N, k/2*(u[i] - w[5])^2)"
model dimer 21 "let r[i in 1..N-1] = u[i+1] - u[i]
$kinetic
potential = sum(i in 1..N-1, if(i - 2*floor(i/2) > 0.5, k, c)/2*r[i]^2)"
model odd 1000 "$kinetic
potential = sum(i in 1..N, k*u[i]^2/2) + sum(i in 1..N-1, c*(u[i+1] - u[i])^2/2) + u[500]^4"
model stiff 1000 "$kinetic
potential = sum(i in 1..499, k*u[i]^2/2) + c*u[500]^2/2 + sum(i in 501..N, k*u[i]^2/2)"
model net 9 "kinetic = sum(i in 1..N, sum(j in 1..N, u[i,j]'^2/2))
potential = sum(i in 1..N-1, sum(j in 1..N, k/2*(u[i+1,j] - u[i,j])^2 + c/3*(u[j,i+1] - u[j,i])^3))" pairs
sed 's/N = 9$/N = 40/' "$TMP/net.lag" >"$TMP/wide.lag"
model grid 60 "kinetic = sum(i in 1..N, sum(j in 1..N, u[i,j]'^2/2))
potential = sum(i in 1..N-1, sum(j in 1..N, k/2*(u[i+1,j] - u[i,j])^2)) + sum(i in 1..N, sum(j in 1..N-1, c/2*(u[i,j+1] - u[i,j])^2))" pairs
if command -v python3 >/dev/null; then
  # NAME MEMBERS LINES KIND: rounding of sums of up to 400 terms
  while read -r name n lines kind; do
    "$LAGC" derive "$TMP/$name.lag" >"$TMP/$name.txt"
    size=$(sed -n 's/^const N = //p' "$TMP/$name.lag")
    python3 tests/exec/listing.py "${kind:-$name}" "$size" <"$TMP/$name.txt" >"$TMP/judged" 2>&1
    read -r members difference <"$TMP/judged"
    check "each member's force in $name" sh -c "cat '$TMP/judged'; [ '$members' = $n ] && awk 'BEGIN { exit !($difference < 1e-12) }'"
    [ "$lines" = - ] || is "lines of it" "$lines" "$(sed -n "/^equations of motion/,/^\$/p" "$TMP/$name.txt" | grep -c "'' = ")"
  done <<'END'
springs 200 3
spelt 40 11 springs
sines 400 3
skew 300 3
string 12 2
tied 10 2
dimer 21 5
odd 1000 5
stiff 1000 3
net 81 -
wide 1600 - net
grid 3600 9
END
else
  skip "forces of members" "no python3"
fi
"$LAGC" derive models/string.lag --format latex >"$TMP/string.tex"
check "in LaTeX" grep -q -F 'm \ddot{u}_{i} &= d_{\mathrm{stretch}_{i - 1}} - d_{\mathrm{stretch}_{i}} \quad (i = 2, \dots, 10)' "$TMP/string.tex"
"$LAGC" derive models/string.lag >"$TMP/wall.txt"
check "downwards, too" grep -q -F '  d_stretch[i] = -b*stretch[i]^3 - k*stretch[i]  for i in 1..10' "$TMP/wall.txt"
check "the letter is no name of the line" sh -c "sed 's/, c = 3/, n = 3/; s/k + c/k + n/; s/c\*u/n*u/' '$TMP/springs.lag' >'$TMP/named.lag'; '$LAGC' derive '$TMP/named.lag' | grep -q \"^  u\[m\]'' = n\*u\[m\]^3 - sum(i in m + 1\.\.200, .* for m in 2\.\.199$\""
"$LAGC" derive models/chain.lag -D N=4 >"$TMP/four.txt" 2>&1
check "four members keep their rows" grep -q '^  p_th\[3\] = ' "$TMP/four.txt"
# Members of one shape are not written out: 0.8 s of processor and 270 MB, of which the list has 0.05 s; 9 s and 1.8 GB where each was
vast() { (ulimit -t 4; ulimit -v 500000; "$LAGC" derive tests/bench/models/bodies.lag -DN=10000 --format "$1" >"$TMP/vast.txt") && [ "$(wc -l <"$TMP/vast.txt")" = "$2" ]; }
check "10000 bodies" vast text 27
check "the force on one of them" grep -q -F "  m[k]*r[k].x'' = -sum(i in k + 1..10000, m[k]*G*m[i]*(r[k].x - r[i].x)/(soft^2 + (r[k].x - r[i].x)^2 + " "$TMP/vast.txt"
check "in LaTeX" vast latex 34
check "momenta of vectors" grep -q -F 'p_{y_{\mathrm{r[i]}}} &= m_{i} \dot{y}_{\mathrm{r[i]}} \quad (i = 1, \dots, 10000)' "$TMP/vast.txt"
canonical() { (ulimit -t 3; ulimit -v 700000; "$LAGC" derive tests/bench/models/bodies.lag -DN=2000 --hamiltonian >"$TMP/vast.txt"); }
check "Hamilton's equations of 2000 bodies: 0.5 s, 400 MB; 14 s and 2 GB by one coordinate after the other" canonical
check "the rate of one" grep -q -F "  r[i].x' = p_r[i].x/m[i]  for i in 1..2000" "$TMP/vast.txt"
check "momenta alone in H" sh -c "! grep '^  H = ' '$TMP/vast.txt' | grep \"'\""
cat >"$TMP/corner.lag" <<'END'
model corner
coord x, u[5]
param k = 2
kinetic = x'^2/2 + sum(i in 1..5, u[i]'^2/2)
potential = max(u[1] - k, x + u[2] + u[3] + u[4] + u[5])
END
corner() { "$LAGC" derive "$TMP/corner.lag" | grep -q -F ' + max(u[1] - k, x + u[2] + u[3] + u[4] + u[5])'; }
check "terms stay on their side of a comma" corner
printf "model third\ncoord x\nkinetic = x'^2/2\npotential = x/3\n" >"$TMP/third.lag"
check "the sign of a fraction in LaTeX" sh -c "'$LAGC' derive '$TMP/third.lag' --format latex | grep -q -F '  \\ddot{x} &= -\\frac{1}{3}'"
tap_end
