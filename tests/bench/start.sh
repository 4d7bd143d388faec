#!/bin/sh
# Waiting time of a user: `lagc run` of five small models to its report, with nothing kept and again (to reach: 100 ms and 10 ms); of each model the
# first row of output with nothing kept (1 s), and `lagc check` (50 ms). Wall time, medians of several runs; no test depends on them.
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
  XDG_CACHE_HOME=$TMP/cache "$LAGC" run "$1" --until 1e-9 --every 1e-9 -o - | head -n 2
}

# run_of NAME SCENE: to the report; run_anew: with nothing kept
run_of() { XDG_CACHE_HOME=$TMP/cache "$LAGC" run "models/$1.lag" "$2"; }
run_anew() { rm -rf "$TMP/cache"; run_of "$@"; }
for of in 'pendulum small' 'double_pendulum swing' 'kepler orbit' 'bouncing_ball drop' 'slider_crank idle'; do
  # shellcheck disable=SC2086 # two words
  printf '%-28s to the report, anew %8s ms    again %8s ms\n' "$of" "$(median_ms 21 run_anew $of)" "$(median_ms 21 run_of $of)"
done

for model in models/*.lag; do
  check=$(median_ms 21 "$LAGC" check "$model")
  row=$(median_ms 5 first_row "$model")
  printf '%-28s lagc check %8s ms    first row %8s ms\n' "$model" "$check" "$row"
done
