#!/bin/sh
# Random models, each compared with its text as every compilation is: derivation, programs and hoisting against jets. exec/long_random has the rest of
# them, and thousands more.
. tests/tap.sh
. tests/random/lib_random.sh

agree() {
  random_check "$1" "$2" "$3"
  status=$?
  tail -n 40 "$TMP/random.txt"
  return "$status"
}
check "models 1 to 40 of seed 1 agree with their texts" agree 1 1 40
echo "# $(tail -n 1 "$TMP/random.txt")"
check "-0 below a let that is 0 everywhere: the angle of a negative number" agree 20785 175 175
tap_end
