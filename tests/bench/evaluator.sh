#!/bin/sh
# A call of what is evaluated (`--compile never`) beside the same compiled: accelerations, and a Taylor step of order 16; and whole runs of some 10^7 calls
# with nothing kept: `--compile auto`, which evaluates until its background compiler is done, beside compiling first (`--compile always`).
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${BUILD:=build}" "${TMP:=$(mktemp -d)}"
. tests/bench/lib_rows.sh
"$CC" -O2 -std=gnu11 -Iruntime/include -Iruntime tests/bench/evaluator.c "$BUILD/liblag.a" -ldl -lm -o "$TMP/evaluator"

calls() { # NAME MODEL SCENE REACH REACH_OF_TAYLOR OPTIONS...
  name=$1 model=$2 scene=$3 accel=$4 taylor=$5
  shift 5
  "$LAGC" build "$model" "$@" --bytes -o "$TMP/bytes" && "$LAGC" build "$model" "$@" --shared -o "$TMP/model.so"
  "$TMP/evaluator" "$TMP/bytes" "$TMP/model.so" "$scene" | while read -r what ours theirs ratio; do
    eval "reach=\$$what"
    row "$name, $what" "<= $reach" "$theirs ns" "$ours ns" "$ratio" "$(at_most "$ratio" "$reach")"
  done
}
echo '| what | to reach | compiled | evaluated | ratio | |'
row --- --- --- --- --- ---
calls 'double pendulum' models/double_pendulum.lag swing 3.5 8
sed 's/^const N = 3/const N = 20/' models/chain.lag >"$TMP/chain.lag"
calls 'chain of 20' "$TMP/chain.lag" "$(sed -n 's/^scene \([a-z_0-9]*\).*/\1/p' models/chain.lag | head -1)" 3.5 8
calls 'Kepler' models/kepler.lag orbit 4.5 8
calls 'nest of pairs, six planets' models/outer_planets.lag centuries 4 8

cold() { rm -rf "$TMP/none"; XDG_CACHE_HOME=$TMP/none "$LAGC" run models/double_pendulum.lag swing --method rk4 --step 1e-4 --until 250 --every 250 --compile "$1"; }
wall() { # least wall seconds of 3
  for _ in 1 2 3; do
    t0=$(date +%s%N)
    cold "$1" >/dev/null 2>&1
    echo $(($(date +%s%N) - t0))
  done | sort -n | awk 'NR == 1 { printf "%.3f", $1/1e9 }'
}
always=$(wall always) auto=$(wall auto)
ratio=$(awk -v a="$auto" -v b="$always" 'BEGIN { printf "%.2f", a/b }')
row 'a run of 10^7 calls, nothing kept, wall' '<= 1.05' "$always s" "$auto s" "$ratio" "$(at_most "$ratio" 1.05)"
