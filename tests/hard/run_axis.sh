#!/bin/sh
# A constraint with time in it: the axis of a car on a road that moves. Two methods of different kind agree with each other, and with the
# published digits as far as these are right.
. tests/tap.sh
model=tests/hard/cases/car_axis.lag

run() { # NAME METHOD TOL
  "$LAGC" run $model --method "$2" --tol "$3" --json >"$TMP/$1.json"
}
value() { sed -n "s/.*\"$2\": \([-+0-9.e]*\).*/\1/p" "$TMP/$1.json"; }
final() { for k in xl yl xr yr "xl'" "yl'" "xr'" "yr'"; do sed "s/.*\"final\"//" "$TMP/$1.json" | sed -n "s/.*\"$k\": \([-+0-9.e]*\).*/\1/p"; done | tr '\n' ' '; }
within() { # GOT EXPECTED TOLERANCE, the numbers a word each
  awk -v a="$1" -v b="$2" -v tol="$3" 'BEGIN { n = split(a, x, " "); m = split(b, y, " "); if (m == 0 || n < m) exit 1
    for (i = 1; i <= m; i++) { d = x[i] - y[i]; print "off by", d; if (!(d <= tol && -d <= tol)) bad = 1 }; exit bad }'
}
check "dop853 runs" run dop853 dop853 1e-13
check "rk45 runs" run rk45 rk45 1e-12
# Velocities of 1 and accelerations of 1e3: errors of 1e-12 a step have grown a hundredfold.
check "they agree" within "$(final dop853)" "$(final rk45)" 1e-8
# Test Set for IVP Solvers, release 2.4, II-6. Off from the tenth digit on.
check "and with the published end of the motion" within "$(final dop853)" \
  "0.4934557842755629e-1 0.4969894602303324 0.1041742524885400e1 0.3739110272652214" 1e-9
for m in dop853 rk45; do
  check "$m: on the constraints" within "$(value $m constraint_residual) $(value $m constraint_rate_residual)" "0 0" 1e-14
done
tap_end
