# shellcheck shell=sh
# oscillator <<END: $TMP/osc.lag, x'' = -k x, with effects, events and scenes from standard input.
oscillator() {
  {
    printf '%s\n' 'model osc' 'coord x [m]' 'param k = 4 [1/s^2] > 0' "lagrangian = x'^2/2 - k/2*x^2"
    cat
  } >"$TMP/osc.lag"
}
