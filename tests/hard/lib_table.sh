#!/bin/sh
# `make hard`: a row a case, by the method that reaches its accuracy fastest (the first in runs.txt that does not refuse the model).
# Environment: as tests/run.sh says.
set -e
TMP=$(mktemp -d)
trap 'rm -rf "$TMP"' EXIT
. tests/hard/lib_cases.sh
emit_cases taylor
compile_cases "$TMP/hard"
status=0
TABLE=1 hard_runs quick >"$TMP/rows" || status=1
printf '%-41s %-34s %-12s %8s %8s %8s %9s %8s\n' case 'what is hard' method 'err/tol' residual energy steps 'time [s]'
awk 'FNR == NR { at[$1] = at[$1] ? at[$1] : NR; next }
     !/ refuses$/ { c = substr($0, 1, 41); id = c; sub(/[, ].*/, "", id); if (!seen[c]++) printf "%06d %s\n", at[id], $0 }' \
  $hard/expected.txt "$TMP/rows" | sort -s -k1,1n | cut -c8-
echo
echo 'err/tol: the largest error, in units of what the case allows. residual: the largest error of a constraint, in positions or rates.'
echo 'energy: the drift, relative to the larger of |E0| and the median of |p.v| + |L|, where forces or explicit time leave it: its change.'
echo "Lagrange's points and the chain's frequencies: tests/hard/run_points.sh. Why a row does not pass, or is not here: tests/hard/README.md."
exit $status
