#!/bin/sh
# Families and vectors against the same model written out by hand: both put out the same numbers, or
# `lagc check` proves the equations of the other; and large families, within limits of time and memory.
. tests/tap.sh
dir=$TMP

# same NAME MODEL_A MODEL_B SED [SETTINGS...]: the two put out the same columns, to 1e-9, after SED renames those of A
same() {
  name=$1 a=$2 b=$3
  shift 3
  check "$name" same_rows "$@"
}
same_rows() {
  "$LAGC" run "$a" "$@" --output "$dir/a.csv" && "$LAGC" run "$b" --output "$dir/b.csv" &&
    paste -d, "$dir/a.csv" "$dir/b.csv" | grep -v '^#' | awk -F, 'NR > 1 {
      for (i = 1; i <= NF/2; i++) { d = $i - $(i + NF/2); if (d < 0) d = -d; if (d > worst) worst = d }
      rows++
    } END { printf "worst %g in %d rows of %d columns\n", worst, rows, NF/2; exit !(rows > 50 && NF > 5 && worst < 1e-9) }'
}

cat >"$dir/chain3.lag" <<'LAG'
model by_hand
coord a [rad], b [rad], c [rad]
param m1 = 1 [kg], m2 = 2 [kg], m3 = 1/2 [kg], g = 9.81 [m/s^2], l1 = 1 [m], l2 = 3 [m], l3 = 1/2 [m]
let x1 = l1*sin(a), y1 = -l1*cos(a)
let x2 = x1 + l2*sin(b), y2 = y1 - l2*cos(b)
let x3 = x2 + l3*sin(c), y3 = y2 - l3*cos(c)
kinetic = m1/2*(x1'^2 + y1'^2) + m2/2*(x2'^2 + y2'^2) + m3/2*(x3'^2 + y3'^2)
potential = g*(m1*y1 + m2*y2 + m3*y3)
scene s { start a = 1 [rad], b = 1/2 [rad], c = 1/3 [rad]; span 1 [s]; tolerance 1e-13; output a, b, c, x3, y3, energy every 0.01 [s] }
LAG
cat >"$dir/family3.lag" <<'LAG'
model family
const N = 3
coord th[N] [rad]
param m[N] = {1, 2, 1/2} [kg], g = 9.81 [m/s^2], l[N] [m] = {1, 3, 1/2}
let r[0] = (0 [m], 0 [m])
let r[i in 1..N] = r[i-1] + l[i]*(sin(th[i]), -cos(th[i]))
kinetic = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))
potential = sum(i in 1..N, m[i]*g*r[i].y)
scene s { start th[i in 1..N] = 1/i; span 1 [s]; tolerance 1e-13; output th, r[N], energy every 0.01 [s] }
LAG
same "a chain of three as a family of vectors" "$dir/family3.lag" "$dir/chain3.lag"

cat >"$dir/bodies.lag" <<'LAG'
model bodies
const N = 3
coord r[N]: vec3 [m]
param m[N] = {1, 2, 3} [kg] > 0, G = 1 [N*m^2/kg^2]
kinetic = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))
potential = -sum(i in 1..N, sum(j in 1..i-1, G*m[i]*m[j]/norm(r[i] - r[j])))
dissipation = sum(i in 1..N, 0.1 [kg/s]/2*dot(r[i]', r[i]'))
for i in 1..N { force r[i] = cross((0, 0, 1 [kg/s]), r[i]') }
scene s { start r = {(1, 0, 0), (0, 2, 0), (0, 0, 3)}, r[1]' = (0, 1, 0), r[2].x' = 1; span 1 [s]; tolerance 1e-13; output r, r' every 0.01 [s] }
LAG
cat >"$dir/bodies_by_hand.lag" <<'LAG'
model by_hand
coord x1, y1, z1, x2, y2, z2, x3, y3, z3
kinetic = (x1'^2 + y1'^2 + z1'^2)/2 + (x2'^2 + y2'^2 + z2'^2) + 3*(x3'^2 + y3'^2 + z3'^2)/2
potential = -2/sqrt((x1-x2)^2 + (y1-y2)^2 + (z1-z2)^2) - 3/sqrt((x1-x3)^2 + (y1-y3)^2 + (z1-z3)^2) - 6/sqrt((x2-x3)^2 + (y2-y3)^2 + (z2-z3)^2)
dissipation = (x1'^2 + y1'^2 + z1'^2 + x2'^2 + y2'^2 + z2'^2 + x3'^2 + y3'^2 + z3'^2)/20
force (x1, y1) = (-y1', x1')
force (x2, y2) = (-y2', x2')
force (x3, y3) = (-y3', x3')
scene s { start x1 = 1, y2 = 2, z3 = 3, y1' = 1, x2' = 1; span 1; tolerance 1e-13
  output x1, y1, z1, x2, y2, z2, x3, y3, z3, x1', y1', z1', x2', y2', z2', x3', y3', z3' every 0.01 }
LAG
same "three bodies as a family of vec3" "$dir/bodies.lag" "$dir/bodies_by_hand.lag"

cat >"$dir/lattice.lag" <<'LAG'
model lattice
const N = 2, K = 3
coord u[N,K]
param k[N] = {1, 2}
kinetic = sum(i in 1..N, sum(j in 1..K, u[i,j]'^2/2))
potential = sum(i in 1..N, sum(j in 1..K-1, k[i]/2*(u[i,j+1] - u[i,j])^2)) + sum(j in 1..K, (u[2,j] - u[1,j])^4/4)
scene s { start u[i in 1..N, j in 1..K] = i - j/3; span 1; tolerance 1e-13; output u, u' every 0.01 }
LAG
cat >"$dir/lattice_by_hand.lag" <<'LAG'
model by_hand
coord a, b, c, d, e, f
kinetic = (a'^2 + b'^2 + c'^2 + d'^2 + e'^2 + f'^2)/2
potential = ((b-a)^2 + (c-b)^2)/2 + (e-d)^2 + (f-e)^2 + ((d-a)^4 + (e-b)^4 + (f-c)^4)/4
scene s { start a = 2/3, b = 1/3, c = 0, d = 5/3, e = 4/3, f = 1; span 1; tolerance 1e-13
  output a, b, c, d, e, f, a', b', c', d', e', f' every 0.01 }
LAG
slow same "a lattice with two indices" "$dir/lattice.lag" "$dir/lattice_by_hand.lag"

# ---- at the command line: a family is set at once, a vector by its components ----
sed 's/start u.*- j\/3; span/start u[1,1] = 0; span/' "$dir/lattice.lag" >"$dir/still.lag"
sed "s/scene s {.*/scene s { start a = 2, b = 2, c = 2, d = 2, e = 2, f = 2, a' = 1, b' = 1, c' = 1, d' = 1, e' = 1, f' = 1; span 1; tolerance 1e-13/" \
  "$dir/lattice_by_hand.lag" >"$dir/still_by_hand.lag"
same "all members of a family are set by its name" "$dir/still.lag" "$dir/still_by_hand.lag" u=2 "u'=1"
cat >"$dir/vector.lag" <<'LAG'
model vector
coord r: vec2
param k[2] = 1 > 0
lagrangian = dot(r', r')/2 - k[1]*r.x^2 - k[2]*r.y^2
scene s { start r = (1, 2); span 1 }
LAG
check "a vector has parts" says 2 "r has parts: set r.x, and so on" "$LAGC" run "$dir/vector.lag" r=1
check "and so has its velocity" says 2 "r' has parts: set r.x', and so on" "$LAGC" run "$dir/vector.lag" "r'=1"
check "a family of the wrong sign" says 2 "k = -1: the model declares k[1] > 0" "$LAGC" run "$dir/vector.lag" k=-1
two_curves() { "$LAGC" plot "$dir/vector.lag" --y r -o "$dir/r.svg" && [ "$(grep -c '>r\.[xy]<' "$dir/r.svg")" = 2 ]; }
check "an output that is a vector" two_curves
check "a name that is none" says 2 "kk: no such parameter, coordinate or input in model vector" "$LAGC" run "$dir/vector.lag" kk=1

# proved NAME MODEL...: its expectations hold
proved() {
  name=$1
  shift
  check "$name" "$LAGC" check "$@"
}

sed 's/^const N = .*/const N = 2/; /^scene/,$d' models/chain.lag >"$dir/double.lag"
sed -n '/^expect/,/^$/p' models/double_pendulum.lag |
  sed -E 's/th1/th[1]/g; s/th2/th[2]/g; s/\<m([12])\>/m[\1]/g; s/\<l([12])\>/l[\1]/g' >>"$dir/double.lag"
proved "a chain of two is the double pendulum, by the textbook's equations" "$dir/double.lag"
{ sed 's/^const N = .*/const N = 1/; /^scene/,$d' models/chain.lag; echo "expect th[1]'' = -g/l[1]*sin(th[1])"; } >"$dir/single.lag"
proved "a chain of one is the pendulum" "$dir/single.lag"

# Every limit is in seconds of processor time; a machine of ten years ago needs a tenth of it.
large() { # NAME SECONDS KIBIBYTES COMMAND...
  name=$1 seconds=$2 memory=$3
  shift 3
  check "$name" limited "$@"
}
limited() { (ulimit -t "$seconds" -v "$memory"; "$@"); }
slow large "a string of 10000 masses" 30 1500000 "$LAGC" derive models/string.lag -D N=10000 --ops
roots() { "$LAGC" derive tests/bench/models/bodies.lag -D N=40 --ops | tee "$dir/out" && grep -q ', 780 square roots$' "$dir/out"; }
check "40 bodies: a square root of each of 40*39/2 pairs" roots
shared() { "$LAGC" derive models/slider_crank.lag --ops | awk '{ print; exit !($1 <= 208) }'; }
check "slider_crank: the products that many share are found" shared
# The text has 3 MB; its derivation needs some 400 MB.
for f in text latex; do
  slow large "a string of 10000 masses, printed as $f" 30 1000000 "$LAGC" derive models/string.lag -D N=10000 --format $f
done
large "a chain of 300 links" 30 1500000 "$LAGC" check models/chain.lag swing -D N=300
slow large "a chain of 4000 links, whose lets are not walked through for each entry" 15 1000000 "$LAGC" emit models/chain.lag -D N=4000 -o "$dir/chain.c"
cat >"$dir/ring.lag" <<'LAG'
model ring
const N = 100000
coord x[N] [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0
kinetic = sum(i in 1..N, m/2*x[i]'^2)
potential = sum(i in 1..N, k/2*(x[if(i < N, i+1, 1)] - x[i])^2)
symmetry shift(s): for i in 1..N: x[i] -> x[i] + s
scene s { start x[1] = 0.1; span 1 }
LAG
stays_a_sum() { limited "$LAGC" check "$dir/ring.lag" >"$dir/out" 2>&1 && cat "$dir/out" && grep -q 'shift: proved' "$dir/out" && ! grep -q 'written out' "$dir/out"; }
seconds=8 memory=700000
slow check "a ring of 100000 masses, closed by a condition in an index" stays_a_sum
cat >"$dir/long.lag" <<'LAG'
model long
const N = 100000
coord q
let up[0] = q
let up[i in 1..N] = up[i-1]/2 + q
let down[i in 1..N] = if(i == N, q, down[i+1]/2 + q)
lagrangian = q'^2/2 - up[N] - down[1] + sum(i in 1..1000000, i)*0
LAG
slow large "a hundred thousand lets, each defined by the next" 30 1500000 "$LAGC" check "$dir/long.lag"
for f in chain string; do
  named() { "$LAGC" emit models/$f.lag -o "$dir/$f.c" && grep -q "$([ $f = chain ] && echo th_3 || echo u_8)" "$dir/$f.c"; }
  check "the members of $f have names in C" named
done
# The attraction of 66 pairs in loops, where two outputs show one pair each: that pair is computed once.
cat >"$dir/pairs.lag" <<'LAG'
model pairs
const N = 12
coord r[N]: vec2 [m]
param k = 1 [J*m]
lagrangian = sum(i in 1..N, dot(r[i]', r[i]')/2*1 [kg]) - sum(i in 2..N, sum(j in 1..i - 1, k/norm(r[i] - r[j])))
observe U [J] = sum(i in 2..N, sum(j in 1..i - 1, k/norm(r[i] - r[j])))
observe d [J] = k/norm(r[2] - r[1])
observe e [J] = k/norm(r[5] - r[3])
scene s { start r[i in 1..N] = (cos(6.28*i/N), sin(6.28*i/N)); span 1 [s]; output U, d, e }
LAG
once() { "$LAGC" emit "$dir/pairs.lag" -o "$dir/pairs.c" && [ "$(grep -cE '^  out\[[12]\] = w[0-9]+; /\* [de] \*/$' "$dir/pairs.c")" = 2 ]; }
check "what loops add and outputs show is computed once" once
tap_end
