#!/bin/sh
# lagc cost --budget: effects are left out where the budget allows, by closed forms: a mass that is pushed by several forces moves by F t^2/2m, and every
# method is exact there, so that the error of a smaller set is the share of the force that is left out. Times are not tested.
. tests/tap.sh
. tests/exec/lib_push.sh
[ -z "${SLOW:-}" ] || unset LAGC_OPTIMISE
push_model >"$TMP/push.lag" <<'END'
effect ghost { coord y [m]; kinetic = 1 [kg]/2*y'^2; force y = 1 [N] }
scene all { use hand, breath; span 2; tolerance 1e-9; method rk45 }
scene cancel { use there, back, hand(f = 0.25); span 2; tolerance 1e-9; method rk45 }
scene haunted { use hand, ghost; span 2; tolerance 1e-9; method rk45 }
scene stopped { use hand, breath, wall; span 2; tolerance 1e-9; method rk45 }
scene begun { use hand, breath; start x = breath.f*1000 [m/N]; span 2; tolerance 1e-9; method rk45 }
scene bare { span 2; tolerance 1e-9; method rk45 }
END
budget() { "$LAGC" cost "$@" --seconds 1 --methods rk45 --json >"$TMP/json" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }; }
# of FIELD of the smallest set of effects
of() { sed 's/{"left_out"/\n&/g' "$TMP/json" | tail -n 1 | sed "s/.*\"$1\": \(\[[^]]*\]\|[^,}]*\).*/\1/" | tr -d '"'; }

check "a budget of 1e-3" budget "$TMP/push.lag" all --budget 1e-3
is "leaves out 1e-3 N of 3.001" "[breath]" "$(of left_out)"
near "which is its error, compared with the whole" 1e-9 "$(calc "0.001/3.001")" "$(of error)"
check "a budget of 3e-4" budget "$TMP/push.lag" all --budget 3e-4
is "leaves out nothing" "[]" "$(of left_out)"
check "with values" budget "$TMP/push.lag" all breath.f=1e-5 hand.f=4 --budget 3e-4
near "they count" 1e-9 "$(calc "1e-5/6.00001")" "$(of error)"
check "forces that cancel" budget "$TMP/push.lag" cancel --budget 1e-2
is "go together" "[there, back]" "$(of left_out)"
check "an effect with a coordinate of its own" budget "$TMP/push.lag" haunted --budget 1e-6
is "that nothing else depends on" "[ghost]" "$(of left_out)"
check "a start that an effect's parameter gives" budget "$TMP/push.lag" begun --budget 1e-3
is "stays without it" "[breath]" "$(of left_out)"
near "so that the error is that of its force: of velocities, 3.001 m/s at the end" 1e-9 "$(calc "0.001/3.001")" "$(of error)"
check "a run that an event ends" budget "$TMP/push.lag" stopped --budget 1e-3
is "is compared up to there" "[breath]" "$(of left_out)"
check "a scene without effects" budget "$TMP/push.lag" bare --budget 1e-3
is "has none to leave out" "[]" "$(of left_out)"
told() { "$LAGC" cost "$TMP/push.lag" all hand.f=2 --budget 1e-3 --seconds 2 >"$TMP/text"; }
check "as text" told
for line in '^cheapest: ' '^[* ] breath  ' '^  lagc run .*push.lag all hand.f=2 --method "' '^error: the largest difference from the motion with all effects'; do
  check "says: $line" grep -q -e "$line" "$TMP/text"
done
kept() { # the command that it names has the error that it says: x(2 s) against F t^2/2m with all forces
  sed 's/^scene all { use hand, breath;/scene all { use hand;/' "$TMP/push.lag" >"$TMP/smaller.lag"
  set -- $(grep '^  lagc run' "$TMP/text" | sed 's/.* --method "\([^"]*\)" --\([a-z]*\) \(.*\)/\1 \2 \3/')
  "$LAGC" run "$TMP/smaller.lag" all hand.f=2 --method "$1" "--$2" "$3" -o "$TMP/rows.csv" --quiet
  tail -n 1 "$TMP/rows.csv" | awk -F, '{ x = $2; exact = 4.001; d = (exact - x)/exact; print x, d; exit !(d > 0 && d < 1e-3) }'
}
check "and holds it" kept
refused() { # NAME PATTERN ARGS...
  name=$1 pattern=$2
  shift 2
  "$LAGC" cost "$TMP/push.lag" all "$@" >"$TMP/text" 2>"$TMP/err"
  check "$name is refused" [ $? = 2 ]
  check "with a way out" grep -q -e "$pattern" "$TMP/err"
}
refused "a budget of nothing" 'for example 1e-6' --budget 0
refused "--target with --budget" 'leave one of them out' --budget 1e-3 --target 1e-3
refused "a picture" 'leave one of them out' --budget 1e-3 -o "$TMP/x.svg"
refused "an error of something" 'a budget is of the whole motion' --budget 1e-3 --error energy
refused "no time" 'for example --seconds 60' --budget 1e-3 --seconds 0
digits() { "$LAGC" cost models/pendulum.lag --until 1 --budget 1e-17 --seconds 3 >"$TMP/text" 2>&1; grep -q -e '--precision \(long\|quad\)$' "$TMP/text"; }
case " ${PRECISIONS:-} " in *" long "*) slow check "a budget below the rounding of doubles takes more digits" digits ;; esac
interrupted() { # Ctrl-C, sent to the whole group: what is known is printed
  timeout -s INT 6 "$LAGC" cost models/double_pendulum_real.lag --budget 1e-4 --seconds 60 >"$TMP/text" 2>"$TMP/err"
  grep -q '^lagc: interrupted: ' "$TMP/err" && grep -q '^cheapest: ' "$TMP/text"
}
slow check "an interrupted budget prints what it knows" interrupted
tap_end
