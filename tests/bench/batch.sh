#!/bin/sh
# Many runs: 800 double pendulums from starts at rest to t = 10, on one processor, by `lagc sweep` with taylor at 1e-9 (one by one, in 4 and 8 lanes),
# and by what others would write (batch.c): GSL in a loop, Boost.odeint in a loop, a dop853 over lanes written by hand. Time is compared at equal median
# error, between the tolerances of the peers. To reach: 1/8 of GSL's time; 0.9 of the batch by hand with AVX2, 0.65 with AVX-512.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${CXX:=c++}" "${BUILD:=build}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}"
here=tests/bench
awk 'BEGIN { srand(1); print "th1,th2"; for (i = 0; i < 800; i++) printf "%.15g,%.15g\n", 3.14*(rand() - 0.5), 3.14*(rand() - 0.5) }' >"$TMP/starts.csv"
sweep() { "$LAGC" sweep models/double_pendulum.lag swing --until 10 --rows "$TMP/starts.csv" --measure 'X=th1(10)' --measure 'W=th2(10)' --threads 1 "$@"; }
sweep --method taylor --tol 1e-17 --precision long -o "$TMP/exact.csv" --quiet
cut -d, -f1-3 "$TMP/exact.csv" >"$TMP/wanted.csv"

error_of() { # FILE: median of |X - wanted|
  paste -d, "$TMP/wanted.csv" "$1" | awk -F, 'NR > 1 { d = $3 - $6; print d < 0 ? -d : d }' | sort -g | sed -n 400p
}
ours() { # NAME OPTIONS...: name, tolerance, median error, microseconds
  name=$1
  shift
  seconds=$(sweep --method taylor --tol 1e-9 "$@" -o "$TMP/ours.csv" --json | grep -o '"seconds": *[0-9.e+-]*' | sed 's/.*: *//')
  echo "$name 1e-09 $(error_of "$TMP/ours.csv") $(echo "$seconds" | awk '{ print 1e6*$1/800 }')"
}
gsl= odeint= libs=''
[ -z "$(echo '#include <gsl/gsl_odeiv2.h>' | "$CC" -E - 2>&1 >/dev/null)" ] && gsl=-DBENCH_GSL libs="-lgsl -lgslcblas"
if "$CXX" -O2 -c $here/peer_odeint.cc -o "$TMP/odeint.o" 2>/dev/null; then odeint=-DBENCH_ODEINT libs="$TMP/odeint.o $libs -lstdc++"; fi
peer() { # PROGRAM FLAGS...
  program=$1
  shift
  # shellcheck disable=SC2086 # a list of words
  "$CC" -O3 -std=gnu11 -w -I"$INC" -Iruntime "$@" $here/batch.c -o "$TMP/$program" $libs "$BUILD/liblag.a" -lmvec -lm
}
has4= has8=
peer loops ${gsl:+"$gsl"} ${odeint:+"$odeint"}
if grep -q ' fma .* avx2 ' /proc/cpuinfo; then has4=yes; peer hand4 -march=x86-64-v3 -DLANES=4; fi
if grep -q ' avx512dq ' /proc/cpuinfo; then has8=yes; peer hand8 -march=x86-64-v4 -mprefer-vector-width=512 -DLANES=8; fi
# All take turns, as what else a machine does lasts longer than a turn; the least times count.
for _ in 1 2 3 4 5 6 7 8 9; do
  ours lagc_one_by_one --lanes 1
  "$TMP/loops" "$TMP/wanted.csv"
  if [ "$has4" ]; then ours lagc_4_lanes --lanes 4; "$TMP/hand4" "$TMP/wanted.csv"; fi
  if [ "$has8" ]; then ours lagc_8_lanes --lanes 8; "$TMP/hand8" "$TMP/wanted.csv"; fi
done | awk '!(($1, $2) in t) || $4 < t[$1, $2] { t[$1, $2] = $4; e[$1, $2] = $3 } END { for (k in t) { split(k, w, SUBSEP); print w[1], w[2], e[k], t[k] } }' | sort -k1,1 -k2,2gr >"$TMP/rows"
# Each peer's time at the error of lagc's rows, on the line between its two nearest tolerances in logarithms.
printf '| what, at equal error | to reach | microseconds a motion, of ours and the peer | ratio |\n| --- | --- | --- | --- |\n'
awk '$1 ~ /^lagc/ { error[$1] = $3; time[$1] = $4; next } { n[$1]++; e[$1, n[$1]] = $3; t[$1, n[$1]] = $4; peer[$1] = 1 }
  END { for (l in time) for (p in peer) {
    if ((l ~ /4/ && p ~ /8_lanes/) || (l ~ /8/ && p ~ /4_lanes/) || (l ~ /one/ && p ~ /lanes/)) continue
    for (k = 1; k < n[p] && e[p, k + 1] > error[l]; k++);
    if (k == n[p]) k--
    part = log(error[l]/e[p, k])/log(e[p, k + 1]/e[p, k])
    at = exp(log(t[p, k]) + part*log(t[p, k + 1]/t[p, k]))
    reach = l ~ /one/ || p ~ /odeint/ ? "" : p ~ /gsl/ ? "<= 0.125" : l ~ /4/ ? "<= 0.9" : "<= 0.65"
    l0 = l; p0 = p; gsub(/_/, " ", l0); gsub(/_/, " ", p0)
    printf "| %s, %s | %s | %.2f, %.2f | %.3f |\n", l0, p0, reach, time[l], at, time[l]/at } }' "$TMP/rows" | sort
