#!/bin/sh
# Growth of the time and the memory of lagc with a model: slopes of their logarithms against log N, between two sizes. 1 is linear.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${TMP:=$(mktemp -d)}"
. tests/bench/lib_rows.sh

# grown_model KIND N: a model that grows with N.
grown_model() {
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
  bodies) sed "s/^const N = .*/const N = $n/" tests/bench/models/bodies.lag ;;
  scenes)
    cat <<MODEL
model scenes "an oscillator, started in N ways"
coord x [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0
kinetic = m*x'^2/2
potential = k*x^2/2
MODEL
    awk -v n="$n" 'BEGIN { for (i = 1; i <= n; i++) printf "scene s%d { start x = %d [m]\n span 1 [s] }\n", i, i }' ;;
  turning) cat <<MODEL ;;
model turning "N masses that also turn, with springs: two units"
const N = $n
coord x[N] [m], phi[N] [rad]
param m = 1 [kg] > 0, k = 1 [N/m] > 0, J = 1 [kg*m^2] > 0, c = 1 [N*m] > 0
kinetic = sum(i in 1..N, m/2*x[i]'^2 + J/2*phi[i]'^2)
potential = sum(i in 1..N-1, k/2*(x[i+1] - x[i])^2 - c*cos(phi[i+1] - phi[i]))
scene s {
  start x[i in 1..N] = sin(i) [m], phi[i in 1..N] = cos(i)
  span 1 [s]
}
MODEL
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
}

table
# nothing is known of a run: "$TMP/anew" COMMAND...
# shellcheck disable=SC2016 # for the script
printf '#!/bin/sh\nrm -rf "$XDG_CACHE_HOME"\nexec "$@"\n' >"$TMP/anew"
chmod +x "$TMP/anew"
XDG_CACHE_HOME=$TMP/cache
export XDG_CACHE_HOME

# ---- lagc check, derive, noether
# grows WHAT KIND FEW MANY [COMMAND [WORD...]]: slopes of the logarithms of CPU time and memory against log N. The memory for N = 4 is subtracted.
grows() {
  command=${5:-check} what=$1 kind=$2 few=$3 many=$4
  shift $(($# < 5 ? $# : 5))
  grown_model "$kind" 4 >"$TMP/grows.lag"
  floor=$(kilobytes 1 "$TMP/anew" "$LAGC" "$command" "$TMP/grows.lag" "$@")
  for n in "$few" "$many"; do
    grown_model "$kind" "$n" >"$TMP/grows.lag"
    echo "$n $(seconds 2 "$TMP/anew" "$LAGC" "$command" "$TMP/grows.lag" "$@") $(kilobytes 1 "$TMP/anew" "$LAGC" "$command" "$TMP/grows.lag" "$@")"
  done >"$TMP/grown"
  slopes=$(awk -v floor="$floor" '{ n[NR] = log($1); s[NR] = log($2 + 1e-3); k[NR] = log($3 - floor + 1) }
    END { d = n[2] - n[1]; printf "%.2f %.2f", (s[2] - s[1])/d, (k[2] - k[1])/d }' "$TMP/grown")
  most=$(awk 'END { printf "%s s, %d MB", $2, $3/1024 }' "$TMP/grown")
  row "lagc $command, $what, slope of log time against log N, $few to $many" '<= 1.15' "$most" "${slopes% *}" '' "$(at_most "${slopes% *}" 1.15)"
  row "lagc $command, $what, slope of log memory" '<= 1.15' '' "${slopes#* }" '' "$(at_most "${slopes#* }" 1.15)"
}
grows 'N rods' rods 100 800
grows 'N bodies, a sum over all pairs,' bodies 200 2000
grows 'N scenes' scenes 1000 8000
grows 'N outputs' outputs 10000 100000
grows 'N bodies, a sum over all pairs,' bodies 1000 10000 derive
grows 'N bodies, a sum over all pairs,' bodies 100 1000 noether
grows 'one step of N masses that turn' turning 2000 20000 run --until 0.001 --every 0.001 --compile never -o "$TMP/grows.csv"
grows 'two runs of N masses that turn' turning 1000 10000 sweep c=1,2 --until 0.001 --compile never -o "$TMP/grows.csv"
grows 'N masses that turn' turning 1000 10000 header -o "$TMP/grows.h"

# ---- lagc run, compiled: what a run costs before its motion, which the same run again has alone
for n in 100 1000 10000; do
  set -- "$LAGC" run tests/bench/models/bodies.lag -DN="$n" --compile always --until 0.001 --every 0.001 -o "$TMP/grows.csv"
  echo "$(seconds 1 "$TMP/anew" "$@") $(seconds 1 "$@")" >"$TMP/grown"
  row "lagc run, N = $n bodies, one step, nothing kept, less the motion, s" '' "$(awk '{ print $1 " - " $2 }' "$TMP/grown")" \
    "$(awk '{ printf "%.2f", $1 - $2 }' "$TMP/grown")" '' ''
done
unset XDG_CACHE_HOME

# ---- families from 2048 members on, whose texts follow from small ones: time and memory do not depend on N
ring_of() { cat <<MODEL; }
model ring "N masses on a ring of springs"
const N = 100
coord x[N]
param m = 1 > 0, k = 1 > 0
kinetic = sum(i in 1..N, m/2*x[i]'^2)
potential = sum(i in 1..N-1, k/2*(x[i+1] - x[i])^2) + k/2*(x[1] - x[N])^2
symmetry shift(s): x[i in 1..N] -> x[i] + s
scene s {
  start x[i in 1..N] = sin(i)
  span 1
}
MODEL
rotors_of() { cat <<MODEL; }
model rotors "N rotors, each pulled by all the others, by forces"
const N = 100
coord a[N] [rad]
param J = 1 [kg*m^2] > 0, K = 2 [N*m] > 0, c = 1 [N*m*s] > 0
kinetic = sum(i in 1..N, J/2*a[i]'^2)
for i in 1..N { force a[i] = K*sum(j in 1..N, sin(a[j] - a[i])) - c*a[i]' }
scene s {
  start a[i in 1..N] = sin(i*i)
  span 1 [s]
}
MODEL
ring_of >"$TMP/ring.lag"
rotors_of >"$TMP/rotors.lag"
# even COMMAND WHAT FILE SECONDS MB: least time and memory at N = 200, 10^4, 10^5
even() {
  for n in 200 10000 100000; do
    s=$(seconds 3 "$LAGC" "$1" "$3" -DN=$n) m=$(($(kilobytes 1 "$LAGC" "$1" "$3" -DN=$n)/1024))
    row "lagc $1, $2, N = $n, s" "<= $4" '' "$s" '' "$(at_most "$s" "$4")"
    row "lagc $1, $2, N = $n, MB" "<= $5" '' "$m" '' "$(at_most "$m" "$5")"
    echo "$n $s"
  done >"$TMP/even.rows"
  grep '^|' "$TMP/even.rows"
  slope=$(grep -v '^|' "$TMP/even.rows" | awk '{ n[NR] = log($1); s[NR] = log($2 + 1e-3) } END { printf "%.2f", (s[3] - s[2])/(n[3] - n[2]) }')
  row "lagc $1, $2, slope of log time, 10^4 to 10^5" '<= 0.1' '' "$slope" '' "$(at_most "$slope" 0.1)"
}
even emit 'N bodies' tests/bench/models/bodies.lag 0.1 30
even check 'N bodies' tests/bench/models/bodies.lag 0.1 30
even derive 'N bodies' tests/bench/models/bodies.lag 0.1 30
even check 'a ring' "$TMP/ring.lag" 0.2 100
even noether 'a ring' "$TMP/ring.lag" 0.2 100
even emit 'rotors with forces' "$TMP/rotors.lag" 0.1 30
even check 'rotors with forces' "$TMP/rotors.lag" 0.2 100

# ---- lagc noether: xi of N bodies in space has 9 N^2 + 3 N coefficients, where each may move in its own way
for n in 8 16; do echo "$n $(seconds 2 "$LAGC" noether tests/bench/models/bodies.lag -DN="$n")"; done >"$TMP/grown"
row "lagc noether, N bodies in space, slope of log time against log N, 8 to 16" '' "$(awk 'END { print $2 " s" }' "$TMP/grown")" \
  "$(awk '{ n[NR] = log($1); s[NR] = log($2) } END { printf "%.2f", (s[2] - s[1])/(n[2] - n[1]) }' "$TMP/grown")" '' ''
row 'lagc noether, the five outer planets' '' '' "$(seconds 2 "$LAGC" noether models/outer_planets.lag) s" '' ''
row 'lagc noether, 17 coordinates that move freely, 153 symmetries' '' '' "$(seconds 1 "$LAGC" noether tests/fuzz/corpus/compile/seed_families.lag) s" '' ''
