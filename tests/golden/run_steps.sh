#!/bin/sh
# Steps of each method and their costs: steps.txt has a line each,
#   STEPS REJECTED RIGHT-HAND-SIDES SYSTEMS CORRECTIONS MODEL METHOD         five dashes: refused
# Counts, which are the same on every machine, not times. To accept other counts, on purpose:
#   BLESS=1 sh tests/golden/run_steps.sh      writes steps.txt anew
. tests/tap.sh
counts() { # MODEL METHOD
  "$LAGC" run "$1" --method "$2" $3 --json 2>/dev/null >"$TMP/json"
  case $? in 0 | 3) ;; *) echo "- - - - -"; return ;; esac
  sed 's/.*"steps": \([0-9]*\), "rejected": \([0-9]*\), "rhs_calls": \([0-9]*\),.*"newton_systems": \([0-9]*\), "newton_iterations": \([0-9]*\),.*/\1 \2 \3 \4 \5/' "$TMP/json"
}
# The first three in `make test`.
cat >"$TMP/all" <<'END'
double_pendulum 3
slider_crank 2
lorenz 3
kepler 7
bouncing_ball 3
driven_damped_pendulum 10
rattleback 1
END
if [ -n "${SLOW:-}${BLESS:-}" ]; then cp "$TMP/all" "$TMP/models"; else head -n 3 "$TMP/all" >"$TMP/models"; fi
while read -r model until; do
  for method in rk45 dop853 'rk4(step=0.01)' 'euler(step=0.01)' 'symplectic_euler(step=0.01)' 'verlet(step=0.01)' 'verlet4(step=0.05)' 'verlet6(step=0.05)' 'verlet8(step=0.1)' \
    'variational(step=0.02)' 'variational(step=0.05,order=6)' 'gauss(step=0.1)' radau 'taylor' 'taylor(order=12)' 'rk45(adapt=off,step=0.01)' 'moreau(step=0.01)' 'wisdom_holman(step=0.1)'; do
    echo "$(counts "models/$model.lag" "$method" "--until $until") $model $method"
  done
done <"$TMP/models" >"$TMP/steps"
if [ -n "${BLESS:-}" ]; then cp "$TMP/steps" tests/golden/steps.txt; fi
awk 'NR == FNR { taken[$1] = 1; next } taken[$6]' "$TMP/models" tests/golden/steps.txt >"$TMP/expected"
while read -r line; do
  empty "${line#* * * * * }" "$(grep -qxF -e "$line" "$TMP/steps" || { echo "was $line"; grep -F -e " ${line#* * * * * }" "$TMP/steps"; })"
done <"$TMP/expected"
is "no more than these" "$(wc -l <"$TMP/expected")" "$(wc -l <"$TMP/steps")"
tap_end
