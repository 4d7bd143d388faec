#!/bin/sh
# Sweeps on two threads and on two ranks: least times of nine, in turns, as ratios to one; to reach: 1.9 of both, on two free processors. And the time
# that rank 0 takes for a message and a chunk, the least of nine, with two ranks that only ask: runtime/sweep/README.md takes from it how many ranks there can be.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${BUILD:=build}" "${TMP:=$(mktemp -d)}"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
row() { printf '| %s | %s | %s |\n' "$@"; }
seconds() { "$LAGC" sweep models/pendulum.lag 'th=5..175[deg]:2500' l=1,2,3,4,5 --measure 'period(th)' --until 60 --json -o "$TMP/rows.csv" "$@" | sed 's/.*"seconds": \([^,]*\),.*/\1/'; }
ratio() { # OPTIONS...
  for _ in 1 2 3 4 5 6 7 8 9; do echo "$(seconds --threads 1) $(seconds "$@")"; done 2>/dev/null | awk 'NR == 1 || $1 < a { a = $1 } NR == 1 || $2 < b { b = $2 } END { printf "%.2f", a/b }'
}
mpi=
[ ! -e "$BUILD/liblag_mpi.a" ] || ! command -v mpirun >/dev/null || mpi=yes
row what 'to reach' ours
row --- --- ---
row 'two threads, times as fast as one' '>= 1.9' "$(ratio --threads 2)"
[ "$mpi" ] || exit 0
row 'two ranks, times as fast as one process' '>= 1.9' "$(ratio --mpi 2)"
# shellcheck disable=SC2046 # words
"$CC" -O2 -std=c11 -D_XOPEN_SOURCE=700 -Iruntime -Iruntime/include tests/bench/ranks.c "$BUILD/liblag_mpi.a" "$BUILD/liblag.a" $(cat "$BUILD/liblag_mpi.libs") -lm -o "$TMP/ranks"
for _ in 1 2 3 4 5 6 7 8 9; do mpirun -n 3 "$TMP/ranks" "$TMP/journal"; done >"$TMP/times"
for what in '1 chunk a message' '64 chunks a message'; do row "rank 0, $what" '' "$(sed -n "s/^$what \(.*\) us a chunk/\1/p" "$TMP/times" | sort -n | head -n 1) us a chunk"; done
