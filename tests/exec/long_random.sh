#!/bin/sh
# 10,000 random models against their texts. RANDOM_SEED=N takes others.
. tests/tap.sh
. tests/random/lib_random.sh
seed=${RANDOM_SEED:-2}

agree() {
  random_check "$seed" "$1" "$2"
  status=$?
  tail -n 40 "$TMP/random.txt"
  return "$status"
}
i=0
while [ "$i" -lt 10 ]; do
  check "seed $seed, models $((i * 1000 + 1)) to $(((i + 1) * 1000))" agree $((i * 1000 + 1)) $(((i + 1) * 1000))
  echo "# $(tail -n 1 "$TMP/random.txt")"
  i=$((i + 1))
done
tap_end
