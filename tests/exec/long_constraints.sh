#!/bin/sh
# A million steps of a pendulum in Cartesian coordinates: the length of its rod at every output, computed from the rows themselves, and its
# energy. Without care x^2 + y^2 - 1 is 7e-5 after as many steps of rk4, and rk45 leaves the circle.
. tests/tap.sh
model=tests/exec/models/rod.lag

# rows OPTIONS...: the largest |x^2 + y^2 - 1|, and the line through the energies over the run, against their spread
rows() {
  "$LAGC" run $model drop "$@" -o - 2>"$TMP/err" | awk -F, 'NR > 1 {
    c = $2*$2 + $3*$3 - 1; c = c < 0 ? -c : c; worst = c > worst ? c : worst
    e = ($4*$4 + $5*$5)/2 + 9.81*$3; n++; st += $1; stt += $1*$1; se += e; ste += $1*e; most = e > most ? e : most; least = e < least ? e : least }
    END { printf "%d %.3g %.3g %.3g\n", n, worst, (n*ste - st*se)/(n*stt - st*st)*$1, most - least }' >"$TMP/worst"
  cat "$TMP/worst"
}
below() { awk -v l="$1" '{ exit !($1 >= 1000000 && $2 < l) }' "$TMP/worst"; }
level() { awk '{ x = $3/$4; exit !(x*x < 1e-4) }' "$TMP/worst"; } # a trend would be as large as the spread

check "variational, 10^6 steps" rows --method variational --step 1e-3 --until 1000 --every 1e-3
check "stays within 1e-14" below 1e-14
check "its energy has no trend" level
check "verlet, 10^6 steps" rows --method verlet --step 0.01 --until 10000 --every 0.01
check "stays within 1e-14" below 1e-14
check "its energy has no trend" level
check "rk45, 10^6 steps" rows --method rk45 --tol 1e-9 --until 13700 --every 0.0137
grep -q 'steps [0-9]\{6,7\}' "$TMP/err" && sed -n 's/^steps/# steps/p' "$TMP/err"
check "stays within 1e-12" below 1e-12
check "rk4, 10^6 steps" rows --method rk4 --step 1e-3 --until 1000 --every 1e-3
check "stays within 1e-14" below 1e-14
tap_end
