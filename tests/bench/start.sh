#!/bin/sh
# Waiting time of a user: from .lag to the first row of output (nothing cached), and for `lagc check`.
# Targets: 1 s and 50 ms. Medians of several runs; no test depends on them.
set -eu
: "${LAGC:=build/lagc}" "${TMP:=$(mktemp -d)}"

# median_ms RUNS COMMAND...: the median wall time in milliseconds.
median_ms() {
  runs=$1
  shift
  i=0
  while [ "$i" -lt "$runs" ]; do
    t0=$(date +%s%N)
    "$@" >/dev/null 2>&1
    t1=$(date +%s%N)
    echo $(((t1 - t0) / 10000))
    i=$((i + 1))
  done | sort -n | awk '{ t[NR] = $1 } END { printf "%.2f", t[int((NR + 1) / 2)] / 100 }'
}

# first_row MODEL: builds the simulator afresh and stops at the first row after the head.
first_row() {
  rm -rf "$TMP/cache"
  XDG_CACHE_HOME=$TMP/cache "$LAGC" run "$1" --until 0.01 --every 0.01 -o - | head -n 2
}

for model in models/*.lag; do
  check=$(median_ms 21 "$LAGC" check "$model")
  row=$(median_ms 5 first_row "$model")
  printf '%-28s lagc check %8s ms    first row %8s ms\n' "$model" "$check" "$row"
done
