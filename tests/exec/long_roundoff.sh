#!/bin/sh
# 10^7 steps of Stoermer-Verlet on a harmonic oscillator q'' = -q, h = 0.01, from q = 1 at rest. The method's own invariant is
# p^2 + q^2 (1 - h^2/4), and after n steps q = cos(n phi), p = -sin(phi)/h sin(n phi) with cos(phi) = 1 - h^2/2: every difference is round-off.
. tests/tap.sh

run() { "$LAGC" run models/spring.lag free m=1 k=1 --method verlet --step 0.01 --until 100000 --json >"$TMP/run.json"; }
final() { sed -n "s/.*\"final\": {\"x\": \([^,]*\), \"x'\": \([^,]*\),.*/\1 \2/p" "$TMP/run.json"; }

check "10^7 steps" run
is "as many as that" 1 "$(grep -c '"steps": 10000000,' "$TMP/run.json")"
# Plain sums reach 7e-13; sums with compensation stay below 5e-14.
drift=$(final | awk '{ k = 1 - 0.01^2/4; printf "%.3g", ($2^2 + $1^2*k)/k - 1 }')
check "the invariant: $drift" close_to "$drift" 0 5e-14
# Digits in multiple precision. 1e-11: the double 0.01 is 2e-19 too large, 2e-12 of phase.
check "q" close_to "$(final | cut -d' ' -f1)" -0.9283248778690301431766079349586789749273 1e-11
check "p" close_to "$(final | cut -d' ' -f2)" 0.3717653370157336662083299955145841784346 1e-11
tap_end
