#!/bin/sh
# What the estimate of a run's error and horizon costs, as a share of the run, compilation included; and of the run alone, as when a simulator is kept.
# Processor time of the simulator with a report, less that with --quiet, the least of five each.
: "${LAGC:=build/lagc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
used() { # COMMAND...: its processor time [s]
  sh -c '"$@" >/dev/null 2>&1; times' - "$@" | awk 'NR == 2 { for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); s += 60*t[1] + t[2] } printf "%.3f", s }'
}
least() { for _ in 1 2 3 4 5; do used "$@"; echo; done | sort -g | head -n 1; }
echo '| model | build [s] | run [s] | estimate [s] | of build and run | of the run |'
echo '| --- | ---: | ---: | ---: | ---: | ---: |'
for m in pendulum double_pendulum kepler outer_planets henon_heiles lorenz slider_crank rattleback chain pleiades fput; do
  built=$(used "$LAGC" build "models/$m.lag" -o "$TMP/sim")
  quiet=$(least "$TMP/sim" --quiet -o "$TMP/rows.csv")
  told=$(least "$TMP/sim" -o "$TMP/rows.csv")
  echo "$m $built $quiet $told" | awk '{ e = $4 - $3; if (e < 0) e = 0; printf "| %s | %.2f | %.3f | %.3f | %.0f %% | %s |\n", $1, $2, $3, e, 100*e/($2 + $3), (($3 > 0.02) ? sprintf("%.0f %%", 100*e/$3) : "-") }'
done
