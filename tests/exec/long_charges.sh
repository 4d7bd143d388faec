#!/bin/sh
# Charges of models over 10^6 steps of `variational`: momenta to 1e-12, energies bounded and without trend. Rounding alone would walk to
# 1000 units of the last place, 2e-13.
. tests/tap.sh
. tests/exec/lib_charges.sh

# million NAME CHARGES ARGS...: a run that keeps these charges
million() {
  what=$1 charges=$2
  shift 2
  check "$what: 10^6 steps" "$LAGC" run "$@" --method variational --step 0.01 --until 10000 --json
  cp "$TMP/tap_output" "$TMP/out"
  check "all of them" grep -q '"steps": 1000000,' "$TMP/out"
  for charge in $charges; do
    check "$what: $charge to 1e-12" below "$(of "$charge" drift)" 1e-12
  done
  is "$what: the energy oscillates" oscillates "$(of energy trend)"
  # the trend over the whole run is within the oscillation
  check "and has no trend" below "$(awk -v s="$(of energy slope)" -v d="$(of energy drift)" 'BEGIN { x = s*10000/d; print x < 0 ? -x : x }')" 0.5
}
sed '/monitor/d' models/kepler.lag >"$TMP/kepler.lag"
sed '/monitor/d' models/figure_eight.lag >"$TMP/eight.lag"
million "Kepler's problem" spin "$TMP/kepler.lag" orbit e=0.3
million "two light planets" "spin momentum boost" tests/exec/models/planets.lag quiet 'm[2]=0.01' 'm[3]=0.005' "r[1].x'=0" "r[1].y'=-0.00775"
million "three equal bodies" "spin drift_x drift_y" "$TMP/eight.lag"
million "the spherical pendulum" spin models/spherical_pendulum.lag
tap_end
