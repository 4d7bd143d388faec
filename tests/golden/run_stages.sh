#!/bin/sh
# Golden tests of the back half. Each is two files, NAME.lag and NAME.expected:
#   tests/golden/prog    the program of the accelerations, as `lagc emit --dump=prog` lists it
#   tests/golden/c       the model's part of the emitted C, without the arithmetic that stands before it
# run_emitted.sh has checksums of the whole gallery; these few show what has changed. BLESS=1 rewrites the expectations, on purpose.
. tests/tap.sh
program() { "$LAGC" emit "$1" --dump=prog -o "$TMP/model.c"; }
text() { "$LAGC" emit "$1"; }
for lag in tests/golden/prog/*.lag; do golden "$lag" "${lag%.lag}.expected" 0 program "$lag"; done
for lag in tests/golden/c/*.lag; do golden "$lag" "${lag%.lag}.expected" 0 text "$lag"; done

# ---- ranges in the names of statements are `for` around them, in another writing: the same C
each='for i in 1..N { force x[i] = -b*x[i]'"'"' }
for i in 1..N { friction rub[i] on y[i]: i*1 [N], static = 2*i*1 [N] }
for i in 1..N { flow w[i]'"'"' = (x[i] - w[i])/(1 [s]) }
for i in 1..N-1 { constraint level[i]: y[i] = y[i+1] }
for i in 1..N { event top[i]: x[i] - 1 [m] rising { x[i]'"'"' = 0 } }
for i in 1..N { kick beat[i] every i*1 [s] { x[i]'"'"' = 1 [m/s] } }
for i in 1..N { for j in 1..K { observe e[i,j] = i*z[i,j] + j*x[i] } }
symmetry drift(s): y[1] -> y[1], for i in 1..N: for j in 1..K: z[i,j] -> z[i,j] + s
param m[N] = {1, 2, 3} [kg] > 0'
ranges='force x[i in 1..N] = -b*x[i]'"'"'
friction rub[i in 1..N] on y[i]: i*1 [N], static = 2*i*1 [N]
flow w[i in 1..N]'"'"' = (x[i] - w[i])/(1 [s])
constraint level[i in 1..N-1]: y[i] = y[i+1]
event top[i in 1..N]: x[i] - 1 [m] rising { x[i]'"'"' = 0 }
kick beat[i in 1..N] every i*1 [s] { x[i]'"'"' = 1 [m/s] }
observe e[i in 1..N, j in 1..K] = i*z[i,j] + j*x[i]
symmetry drift(s): z[i in 1..N, j in 1..K] -> z[i,j] + s, y[1] -> y[1]
param m[i in 1..N] = i*1 [kg] > 0'
said() {
  cat >"$TMP/said.lag" <<END
model said
const N = 3, K = 2
coord x[N] [m], y[N] [m], z[N,K] [m]
state w[N] [m]
param c = 1 [N/m], b = 1 [kg/s]
$1
kinetic = sum(i in 1..N, m[i]/2*(x[i]'^2 + y[i]'^2) + sum(j in 1..K, m[i]/2*z[i,j]'^2))
potential = sum(i in 1..N, c/2*(x[i] - w[i])^2)
scene s { start x[1] = 0.5 [m]; output x, e every 0.1 [s]; span 2 [s] }
END
  text "$TMP/said.lag" | sed 's/friction rub[^"*]*//'
}
is "a range in a name is a for around the statement" "$(said "$each")" "$(said "$ranges")"
is "and the C is there" 1 "$(said "$ranges" | grep -c '{"top.3.", 1}')"
tap_end
