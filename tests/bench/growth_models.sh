#!/bin/sh
# growth_models.sh KIND N: a model that grows with N, on standard output. The benchmark of growth compiles each at two sizes.
set -eu
kind=$1 n=$2

case $kind in
rods) cat <<MODEL ;;
model rods "N masses on N rods, in Cartesian coordinates"
const N = $n
coord x[N] [m], y[N] [m]
param m = 1 [kg] > 0, l = 1 [m] > 0, g = 9.81 [m/s^2] > 0
kinetic = sum(i in 1..N, m/2*(x[i]'^2 + y[i]'^2))
potential = sum(i in 1..N, m*g*y[i])
let u[0] = 0 [m], v[0] = 0 [m]
let u[i in 1..N] = x[i], v[i in 1..N] = y[i]
for i in 1..N { constraint rod[i]: (u[i] - u[i-1])^2 + (v[i] - v[i-1])^2 = l^2 }
scene swing {
  start x[i in 1..N] = i*l, y = 0 [m]
  span 1 [s]
}
MODEL
scenes)
  cat <<MODEL
model scenes "an oscillator, started in N ways"
coord x [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0
kinetic = m*x'^2/2
potential = k*x^2/2
MODEL
  awk -v n="$n" 'BEGIN { for (i = 1; i <= n; i++) printf "scene s%d { start x = %d [m]\n span 1 [s] }\n", i, i }' ;;
outputs) cat <<MODEL ;;
model outputs "an oscillator with N outputs"
const N = $n
coord x [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0
kinetic = m*x'^2/2
potential = k*x^2/2
for i in 1..N { observe z[i] = i*x }
scene s {
  start x = 1 [m]
  span 1 [s]
  output z every 0.1 [s]
}
MODEL
esac
