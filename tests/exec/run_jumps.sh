#!/bin/sh
# Lagrangians that jump: warnings, and statements on charges. A step of the potential, a force that is switched, a mass that
# changes: the charges that hold across the jump are derived by hand.
. tests/tap.sh
. tests/exec/lib_charges.sh

# model TERM: two coordinates, a term of L, three symmetries that its branches have
model() {
  cat >"$TMP/jump.lag" <<END
model jump
param V = 0.3, w = 2 > 0
coord x, y
lagrangian = (x'^2 + y'^2)/2 - ($1)
symmetry shift(s): x -> x + s
symmetry lift(s): y -> y + s
symmetry later(s): t -> t + s
scene s { start x = 0, y = 0; start x' = 1, y' = 0.5; span 3 }
END
}
lagc() { "$LAGC" "$@" >"$TMP/out" 2>"$TMP/err"; }
# claims TERM WARNINGS SYMMETRIES...: number of warnings; these symmetries hold between jumps only, the others always
claims() {
  model "$1"
  warnings=$2
  shift 2
  lagc check "$TMP/jump.lag" || { cat "$TMP/err"; return 1; }
  [ "$(grep -c 'lack the impulse of the jump' "$TMP/err")" = "$warnings" ] || { cat "$TMP/err"; return 1; }
  got=$(sed -n 's/.*symmetry \([a-z]*\): proved between jumps.*/\1/p' "$TMP/out" | tr '\n' ' ')
  [ "$got" = "$*${*:+ }" ] || { echo "between jumps: $got"; return 1; }
  [ "$(grep -c ': proved' "$TMP/out")" = 3 ]
}

check "a step: its shift is none, and the energy lacks V" claims 'if(x > 1, V, 0)' 1 shift later
check "a sign" claims 'V*sign(x - 1)' 1 shift later
check "a step along x + y: both shifts move it" claims 'if(x + y > 1, V, 0)' 1 shift lift later
check "a term switched at a time: only the energy jumps" claims 'if(t > 1, V, w)' 0 later
check "a mass that changes: momentum is kept, not the velocity" claims "if(t > 1, V, w)*x'^2" 1 shift later
check "a momentum that jumps at rest" claims "V*abs(x')" 1 shift
check "a jump of velocities" claims "if(x' > 0.5, V, 0)" 1 later
check "branches that agree" claims "if(x' > 0.5, (x' - 0.5)^2, 0)" 0

model 'if(x > 1, V, 0)'
check "the run warns" lagc run "$TMP/jump.lag" s --json
check "with the place" grep -q 'jump.lag:4:36: warning: L jumps here' "$TMP/err"
# nothing pushes at the step: E goes from 0.625 to 0.925
is "the energy is not said to be conserved" "not known" "$(of energy is)"
check "it changes by V" between "$(of energy final)" 0.924999 0.925001
is "nor the charge of the shift" "not known" "$(of shift is)"
is "that of y is" conserved "$(of lift is)"
check "the report says why" lagc run "$TMP/jump.lag" s
check "of the energy" grep -q '^energy change: .* (jumps where L does)$' "$TMP/out"
check "of the shift" grep -q '^shift change: 0 (from 1; jumps where L does)$' "$TMP/out"
check "lagc check does not call it conserved" lagc check "$TMP/jump.lag"
check "in the facts" grep -q 'energy changes (L jumps, and the energy with it)' "$TMP/out"
check "nor x cyclic" sh -c "! grep -q 'cyclic coordinate: x' '$TMP/out'"
check "y is" grep -q 'cyclic coordinate: y; L does not contain it, and p_y is conserved$' "$TMP/out"
check "lagc noether lists what holds" lagc noether "$TMP/jump.lag" s
check "and says where" grep -q '^found: 6 symmetries, each proved, some between jumps of L only;' "$TMP/out"
is "of four of them" 4 "$(grep -c '^Q[0-9]: .*; between jumps of L only$' "$TMP/out")"
check "in JSON" lagc noether "$TMP/jump.lag" s --format json
is "too" 4 "$(grep -c '"between_jumps": true' "$TMP/out")"

model 'V*x^2/2'
printf 'effect step { lagrangian = if(y > 1, V, 0) }\neffect switch { lagrangian = if(t > 1, V, 0)*y }\n' >>"$TMP/jump.lag"
sed -i.bak '/^symmetry shift/d' "$TMP/jump.lag"
check "an effect that jumps" lagc noether "$TMP/jump.lag"
check "breaks charges" grep -q '^effect step breaks [1-9]' "$TMP/out"
check "between jumps only" grep -q 'Q[0-9]*, between jumps of L only:' "$TMP/out"

# a Hamiltonian of first order that jumps
printf 'model hall\ncoord x, y\nlagrangian = (x*y%s - y*x%s)/2 - if(x > 0, 1, 0)\nscene s { start x = 1 }\n' "'" "'" >"$TMP/hall.lag"
check "of first order: a model" lagc check "$TMP/hall.lag"
check "is warned of, too" grep -q 'hall.lag:3:35: warning: L jumps here' "$TMP/err"
check "its energy jumps" grep -q 'energy changes (L jumps, and the energy with it)' "$TMP/out"

# an input that is switched
model 'V*x^2'
sed -i.bak -e '/^symmetry shift/d' -e "s/^lagrangian = /input u = if(t > 1, 1, 0)\nlagrangian = u*y + /" -e '/^symmetry lift/d' "$TMP/jump.lag"
check "an input that is switched" lagc check "$TMP/jump.lag"
check "draws no warning of it" sh -c "! grep -q 'warning: .*jumps' '$TMP/err'"
check "its energy jumps with it" grep -q 'symmetry later: proved between jumps' "$TMP/out"
# The side of an if that does not hold may have no value: a Hertz contact, whose force is that of the root of a negative depth outside. The ball comes back as fast
# as it came, and is in contact for 2.9432 (d/v), d = (5 m v^2/4K)^(2/5) (Johnson, Contact Mechanics (1985), eq. 11.24): here K = 2.5, so that d = 0.5^0.4, and v = 1.
cat >"$TMP/hertz.lag" <<'END'
model hertz
coord x, y
lagrangian = x'^2/2 + y'^2/2 - if(x < 0, (-x)^2.5, 0) - if(y < 0, max(0, log(1 - y)), min(y^2, sqrt(y)))
expect x'' = if(x < 0, 2.5*(-x)^1.5, 0)
scene bounce { start x = 1, x' = -1, y = 0.5; span 8; method dop853; tolerance 1e-12; output x, x' }
event touch: x falling { x' = x' }
event leave: x rising { x' = x' }
END
check "sides without a value" lagc check "$TMP/hertz.lag"
bounced() {
  "$LAGC" run "$TMP/hertz.lag" bounce --json --events "$TMP/events.csv" >"$TMP/json" || return 1
  awk -F, 'NR > 1 { t[$2] = $1; v = $NF; print } END { d = 0.5^0.4; dt = t["leave"] - t["touch"]; print dt, 2.9432*d; exit !(dt > 2.9432*d*0.9999 && dt < 2.9432*d*1.0001) }' "$TMP/events.csv" &&
    grep -q "\"x'\": 0.99999999" "$TMP/json"
}
check "a Hertz contact lasts as long as it should" bounced
tap_end
