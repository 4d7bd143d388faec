#!/bin/sh
# The plan of `lagc cost`: the setting that it recommends in its default time, beside that of a sweep ten times as long, for random scenes, starts and
# targets. In the long sweep both settings are timed; where the short one's setting is not among its runs, its own time counts.
#   SEED=2 SHORT=10 LONG=100 sh tests/bench/cost_plan.sh
: "${LAGC:=build/lagc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
cheapest() { # FILE: method, setting and seconds of the run that is named
  sed 's/{"method"/\n&/g; s/{"tolerance"/\n&/g; s/{"step"/\n&/g' "$1" | tr -d '{}[]' | awk -F ', ' '
    /^"method"/ { split($1, m, "\""); method = m[4] }
    /"cheapest": true/ { for (i = 1; i <= 3; i++) sub(/.*: /, "", $i); print method, $1, $3 }'
}
# time_of FILE METHOD SETTING: seconds of that run, if there is one
time_of() {
  sed 's/{"method"/\n&/g; s/{"tolerance"/\n&/g; s/{"step"/\n&/g' "$1" | tr -d '{}[]' | awk -F ', ' -v wanted="$2" -v setting="$3" '
    /^"method"/ { split($1, m, "\""); method = m[4] }
    /^"(tolerance|step)"/ { for (i = 1; i <= 3; i++) sub(/.*: /, "", $i); if (method == wanted && $1 == setting) print $3 }'
}
awk -v seed="${SEED:-1}" 'BEGIN { srand(seed) }
  { target = 10^(-3 - 8*rand()); printf "%s %s %s=%.4g %s %.2e\n", $1, $2, $3, $4*(0.8 + 0.4*rand()), $5, target }' <<'END' >"$TMP/scenes"
double_pendulum swing th1 1.5708 --until=10
double_pendulum swing th2 1.2 --until=5
kepler orbit x 1 --until=20
kepler orbit x 0.8 --until=60
henon_heiles regular y 0.1 --until=100
henon_heiles chaos y 0.1 --until=30
lorenz butterfly x 1 --until=15
lorenz butterfly y 2 --until=5
spring_pendulum resonance x 0.1 --until=20
spring_pendulum resonance x 0.3 --until=50
pendulum wide th 2 --until=20
pendulum wide th 3 --until=100
swinging_atwood smile M 3 --until=10
swinging_atwood smile M 2 --until=20
cart_pendulum workshop th 0.5 --until=10
cart_pendulum workshop th 2 --until=5
lagrange_top nodding m 0.5 --until=5
lagrange_top nodding m 1 --until=10
kapitza upright th 0.1 --until=5
kapitza upright th 0.3 --until=2
END
within=0
n=0
printf '%-48s %-9s %-34s %-34s %s\n' 'scene' 'target' 'default time' 'ten times as long' ratio
while read -r model scene value until target; do
  "$LAGC" cost "models/$model.lag" "$scene" "$value" "$until" --target "$target" --seconds "${SHORT:-10}" --json >"$TMP/short" 2>"$TMP/err" || { echo "$model $scene $value: $(head -n 1 "$TMP/err")"; continue; }
  "$LAGC" cost "models/$model.lag" "$scene" "$value" "$until" --target "$target" --seconds "${LONG:-100}" --json >"$TMP/long" 2>"$TMP/err" || continue
  short=$(cheapest "$TMP/short")
  long=$(cheapest "$TMP/long")
  # shellcheck disable=SC2086 # method and setting
  set -- $short
  own=$(time_of "$TMP/long" "$1" "$2")
  row=$(echo "$short $long ${own:-$3}" | awk '{ r = $7/$6; if (r < 1) r = 1; printf "%-34s %-34s %.2f", $1 " " $2, $4 " " $5, r }')
  printf '%-48s %-9s %s\n' "$model $scene $value $until" "$target" "$row"
  n=$((n + 1))
  echo "$row" | awk '{ exit !($NF <= 1.5) }' && within=$((within + 1))
done <"$TMP/scenes"
echo "within a factor of 1.5: $within of $n"
