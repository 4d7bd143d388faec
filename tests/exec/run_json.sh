#!/bin/sh
# The fields of each command's --json, which other programs read: none disappears or appears without a line here. A list has the fields of its
# first element.
. tests/tap.sh
fields() { # COMMAND MODEL ARGS...: names, with [ or { where a list or an object begins
  "$LAGC" "$@" --json 2>"$TMP/err" | grep -o '"[^"]*": [[{]\{0,1\}' | sed 's/^"//; s/": *//' | awk '!seen[$0]++' | tr '\n' ' ' | sed 's/ $//'
}
head="model scene method chosen status message t_end steps rejected rhs_calls form newton_systems newton_iterations wall_s energy_drift error error_growth error_seen_to error_known_to error_up_to_there error_at_most formula_noise horizon energy_drift_absolute"
charge="is initial final work at_events drift drift_absolute unit slope slope_error trend"
is "run" "$head unresolved_period rows_without_value charges{ energy{ $charge monitors{ events{ floor{ count first last tangent{ y{ y y' y'{ math build \
constraint_residual constraint_rate_residual final{ energy" "$(fields run models/bouncing_ball.lag --until 2 --tangent)"
is "run with constraints" "$head unresolved_period rows_without_value charges{ energy{ $charge monitors{ events{ math build constraint_residual \
constraint_rate_residual constraints rank redundant[ rank_beside start_moved{ start_other{ final{ q x p q' x' p' push lambda(across)" "$(fields run models/slider_crank.lag --until 0.5)"
is "lyapunov" "model scene method chosen status from until steps blocks phase_space exponents[ spread[ errors[ at_half[ minus_infinity sum sum_spread divergence sum_error dimension \
dimension_error entropy entropy_error chaotic" "$(fields lyapunov models/lorenz.lag --until 20)"
is "modes" "model scene status verdict reason note steps start{ x y equilibrium{ pairs modes[ re im free repeats shape{ x[ y[" "$(fields modes models/spring_pendulum.lag)"
is "modes --steady" "model scene status verdict reason note steps start{ x y steady_motion{ velocity{ pairs modes[ re im free repeats shape{ x[ y[" \
  "$(fields modes models/kepler.lag circle --steady)"
is "cost" "model scene until reference uncertainty target interrupted precisions[ precision horizon seconds methods[ method order best_of_family left_out_from refused runs[ step error spread steps calls front cheapest growth" \
  "$(fields cost models/pendulum.lag --until 0.2 --seconds 0.5 --methods rk4)"
is "effects" "model scene method span_s integration_error limit operations base shared time_s base_time_s evaluated effects[ name on verdict weight difference together_with[" \
  "$(fields effects models/projectile_world.lag --until 0.5)"
is "sweep" "model scene method chosen status runs failed until seconds threads lanes processes measures{ max(th){ unit mean deviation least q5 q50 q95 largest none none_why failures{" "$(fields sweep models/pendulum.lag th=1,2 --measure 'max(th)' -o "$TMP/rows.csv")"
# json OBJECT: names as fields prints them, of a file
names() { grep -o '"[^"]*": [[{]\{0,1\}' "$1" | sed 's/^"//; s/": *//' | awk '!seen[$0]++' | tr '\n' ' ' | sed 's/ $//'; }
"$LAGC" check --json tests/golden/err/expect_effects.lag >"$TMP/check.json" 2>"$TMP/err"
is "check: status 1, nothing on standard error" "1 0" "$? $(wc -c <"$TMP/err")"
energy_of() { "$LAGC" check --json "models/$1.lag" | sed -n 's/.*"energy": "\([^"]*\)".*/\1/p'; }
is "verdicts of the energy" "conserved changes not decided" "$(echo "$(energy_of pendulum)" "$(energy_of block)" "$(energy_of quarter_car)")"
is "check" "schema file ok facts{ coordinates states parameters constraints contacts energy energy_because scenes[ name kind effects[ symmetries[ expectations[ line column end_line end_column verdict digits \
missing difference units{ report[ messages[ severity message help note messages_not_shown" "$(names "$TMP/check.json")"
is "its messages have places" '"line": 13, "column": 19, "end_line": 13, "end_column": 24, "message": "expect q'"'"' is false: `1 [F]` should be `(1/2) [F]`"' \
  "$(grep -o '"line": 13, "column": 19.*(1/2) \[F\]`"' "$TMP/check.json")"
"$LAGC" check --json tests/golden/err/syntax_foreign.lag >"$TMP/check.json" 2>"$TMP/err"
is "check of a text that does not parse" "1 0 7" "$? $(wc -c <"$TMP/err") $(grep -c '{"severity": "error", "file": "tests/golden/err/syntax_foreign.lag", "line": ' "$TMP/check.json")"
is "check of a good model" '"ok": true' "$("$LAGC" check --json models/pendulum.lag | grep -o '"ok": true' | head -n 1)"
tap_end
