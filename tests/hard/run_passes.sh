#!/bin/sh
# The four-bar mechanism with N = 2 comes through the position where its bars lie in one line, four times a turn, whatever the tolerance:
# at 60 of them from 1e-14 to 1e-8, of which each puts the ends of its steps elsewhere. Steps that creep towards that position take
# 10,000 steps to end with an error; a run takes 1000.
: "${LAGC:=build/lagc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
. tests/tap.sh

bars=tests/hard/cases/mbs_a02_fourbar_N2.lag
"$LAGC" build $bars -o "$TMP/bars" || exit 1
passes() { # METHOD OPTIONS
  for k in $(seq 1 60); do
    tol=$(awk -v k="$k" 'BEGIN { printf "%.3e", 1e-14*10^(k/10) }')
    "$TMP/bars" --method "$1$2" --tol "$tol" >"$TMP/log" 2>&1 && continue
    echo "$tol:" && tail -n 3 "$TMP/log" && return 1
  done
}
check "by dop853" passes dop853 '(atol=1e-15)'
tap_end
