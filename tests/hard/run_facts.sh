#!/bin/sh
# Expected values and tolerances of tests/hard are those of cases.json, and none is left out without a reason.
. tests/tap.sh
hard=tests/hard
facts() { awk -f $hard/lib_facts.awk $hard/cases.json $hard/unused.txt "$1" 2>&1; }
empty "values and tolerances are those of the cases" "$(facts $hard/expected.txt)"

differs() { # LINE'S BEGINNING FROM TO WHAT IS SAID
  sed "/^$1/s/$2/$3/" $hard/expected.txt >"$TMP/wrong"
  ! cmp -s "$TMP/wrong" $hard/expected.txt && facts "$TMP/wrong" | grep -q "$4"
}
check "a larger tolerance is seen" differs 'ivp-andrews-0.03 go 0.03 c_beta' 3e-08 3e-07 'the tolerance is 3e-08'
check "a larger one of those in words, too" differs 'kepler-e0.9 go 10' ' 1e-8$' ' 1e-7' 'no such tolerance'
check "a larger relative one, too" differs 'pendulum-th0-1e-8 go 1' ' 1e-17$' ' 2e-17' 'no such tolerance'
check "a value with another digit" differs 'kepler-e0.9 go 10' '-1\.8538537' '-1.8538538' 'no reference value'
check "a value at another time" differs 'ivp-pleiades go 1\.0 c_x1' ' 1\.0 ' ' 2.0 ' 'the value is that of t=1'
check "a value that is missing" differs 'ivp-pleiades go 1\.0 c_x1' '.*' '' 'stands in no line'

cases=$(awk -F'"' '/^   "id": / { print $4 }' $hard/cases.json)
without() { for id in $cases; do [ -f "$hard/cases/$(printf %s "$id" | tr '.-' '__').lag" ] || echo "$id"; done; }
is "there are 73 cases" 73 "$(echo "$cases" | wc -l)"
empty "each has a model" "$(without)"
untold() { for id in $cases; do grep -q "^$id " $hard/expected.txt || [ "$id" = cr3bp-lagrange-points ] || echo "$id"; done; }
empty "and values, or a suite of its own" "$(untold)"
tap_end
