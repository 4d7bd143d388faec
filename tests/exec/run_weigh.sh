#!/bin/sh
# lagc effects: cost, weight and consequence of each effect. Operations are compared with `lagc derive --ops` of texts from which effects
# are deleted; weights and differences with closed forms.
cd "$(dirname "$0")/../.." || exit 2
: "${LAGC:=build/lagc}" "${BIN:=build/test/bin}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
. tests/tap.sh
. tests/exec/lib_push.sh
dir=$TMP/weigh
mkdir -p "$dir"
weigh() { "$LAGC" effects "$@" --json >"$dir/json" 2>"$dir/err" || cat "$dir/err"; }
# of FIELD: a field of the whole; of EFFECT FIELD: of one effect
of() {
  case $# in
    1) sed -n "s/.*\"$1\": \(\"[^\"]*\"\|\[[^]]*\]\|[^,}]*\).*/\1/p" "$dir/json" ;;
    2) sed "s/.*{\"name\": \"$1\"//; s/}.*/,/; s/.*\"$2\": \(\"[^\"]*\"\|\[[^]]*\]\|[^,]*\),.*/\1/" "$dir/json" ;;
  esac | tr -d '"'
}
whole() { sed 's/"effects": \[.*\]//' "$dir/json" | sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p"; }

# ---- a mass that is pushed: x = a t^2/2, and everything is a ratio of accelerations
push_model >"$dir/push.lag" <<'END'
effect more { requires hand; param f = 0.1 [N]; force x = f*cos(0 [1/s]*t) }
effect other { excludes hand; force x = 1 [N] }
effect rider { coord y [m]; kinetic = 1 [kg]/2*y'^2; force y = 1 [N]; force x = 1 [N] }
effect pole { force x = 1 [N*s]/(1 [s] - t) }
scene all { use hand, breath; span 2; tolerance 1e-9; method rk45; output hand.f; monitor (hand.f) 1e-9; exact x = 0.5*hand.f/m*t^2 }
scene cancel { use there, back, hand(f = 2e-9); span 2; tolerance 1e-9; method rk45 }
scene nested { use hand, more; span 2; tolerance 1e-9; method rk45; more.f = 0.25 }
scene ridden { use rider; start rider.y = 3 [m]; span 2; method rk45 }
scene stopped { use wall; span 2; method rk45; tolerance 1e-9 }
scene made { use hand, there; start x = hand.f*1 [m/N], x' = there.f*2 [m/N/s]; span 2; method rk45; tolerance 1e-9 }
scene pure { span 2; method rk45 }
END
push=$dir/push.lag
weigh "$push" all
near "difference: 3.001 N without 1 N" 1e-12 "$(calc "1/3.001")" "$(of hand difference)"
near "weight: the same" 1e-8 "$(calc "1/3.001")" "$(of hand weight)"
near "of a breath" 1e-12 "$(calc "0.001/3.001")" "$(of breath difference)"
is "both are needed" "needed needed" "$(of hand verdict) $(of breath verdict)"
near "what is off is compared with what it would be" 1e-12 "$(calc "0.5/3.001")" "$(of there difference)"
near "its weight: of what it would be" 1e-8 "$(calc "0.5/3.501")" "$(of there weight)"
is "and would matter" "would matter" "$(of there verdict)"
is "what excludes one that is on is not" "hand" "$(of other excluded_by)"
near "what is off and requires what is on" 1e-12 "$(calc "0.1/3.001")" "$(of more difference)"
check "the error of integration is rounding: rk45 is exact here" sh -c 'awk -v e="$1" "BEGIN { exit !(e < 1e-14) }"' - "$(of integration_error)"
weigh "$push" all hand.f=4 there.f=1
near "values of the command line" 1e-12 "$(calc "4/6.001")" "$(of hand difference)"
near "also of what is off" 1e-12 "$(calc "1/6.001")" "$(of there difference)"
slow weigh "$push" nested
[ -z "${SLOW:-}" ] || is "with those that require it" "[more]" "$(of hand together_with)"
[ -z "${SLOW:-}" ] || near "left out together" 1e-12 "$(calc "1.25/3.25")" "$(of hand difference)"
[ -z "${SLOW:-}" ] || near "alone, what requires it, with the scene's value" 1e-12 "$(calc "0.25/3.25")" "$(of more difference)"
weigh "$push" ridden
near "an effect with a coordinate: of those that both have" 1e-9 "$(calc "1/3")" "$(of rider difference)"
[ -z "${SLOW:-}" ] || near "an effect that ends the run: at 0.5 m instead of 2" 1e-9 3 "$(weigh "$push" stopped; of wall difference)"
# from x = 1 m, x' = 1 m/s with a = 1.75 m/s^2 to 6.5 m, 4.5 m/s at 2 s; without the hand, a = 1.25, from the same start to 1 m, 1 m/s less
slow weigh "$push" made
[ -z "${SLOW:-}" ] || near "values and starts that are made of what is left out stay" 1e-12 "$(calc "1/4.5")" "$(of hand difference)"
weigh "$push" pure
is "with a pole on the way the run fails" "would matter" "$(of pole verdict)"
check "and says so" says 0 'with pole the run fails: ' "$LAGC" effects "$push" pure
near "until" 1e-9 "$(calc "0.5/2")" "$(weigh "$push" pure --until 1; of there difference)"

# A weight where the acceleration vanishes on the way: an oscillator with friction, a = -w^2 x - 2 h v; |2 h v| is largest where x is 0.
cat >"$dir/swing.lag" <<'END'
model swing "An oscillator with friction"
coord x [m]
lagrangian = 1 [kg]/2*x'^2 - 1 [N/m]/2*x^2
effect friction { param c = 1e-6 [kg/s]; dissipation = c/2*x'^2 }
scene s { start x = 1; use friction; span 20 [s]; tolerance 1e-12 ; method dop853 }
END
weigh "$dir/swing.lag" s
near "beside the root mean square: c sqrt(2), as far as steps and the mean over them are dense" 1e-7 1.414e-6 "$(of friction weight)"
# dx = -c/2 (t cos t - sin t), dv = c/2 t sin t, at 256 times, as parts of the largest cos and sin there
most=$(awk 'BEGIN { for (k = 1; k <= 256; k++) { t = 20*k/256; x = cos(t); v = sin(t); a = t*x - v; b = t*v
  if (x*x > X*X) X = x; if (v*v > V*V) V = v; if (a*a > A*A) A = a; if (b*b > B*B) B = b }
  a = A/X; b = B/V; a = a < 0 ? -a : a; b = b < 0 ? -b : b; printf "%.15g", 5e-7*(a > b ? a : b) }')
near "difference: c t/2" 1e-10 "$most" "$(of friction difference)"

# ---- operations add up: the cost of an effect is the difference to a call of the text without it, by the head of emitted C
uses() { # MODEL SCENE EFFECTS: operations of the scene when it uses these
  sed "/^scene $2 /,/}/s/ use [^;}]*/ use $3 /" "$1" >"$dir/with.lag"
  "$LAGC" emit "$dir/with.lag" "$2" -o - | sed -n 's/^ \* Accelerations: \([0-9]*\) operations.*/\1/p'
}
adds_up() { # MODEL SCENE EFFECT...
  model=$1 scene=$2
  shift 2
  weigh "$model" "$scene"
  sum=$(whole base)
  all=$(echo "$*" | sed 's/ /, /g')
  [ "$(whole operations)" = "$(uses "$model" "$scene" "$all")" ] || return 1
  [ "$(whole base)" = "$(uses "$model" "$scene" none)" ] || return 1
  for e; do
    rest=$(for x; do [ "$x" = "$e" ] || echo "$x"; done | paste -sd, -)
    direct=$(($(whole operations) - $(uses "$model" "$scene" "$rest")))
    echo "$e: $(of "$e" operations), without it $direct"
    [ "$(of "$e" operations)" = "$direct" ] || return 1
    sum=$((sum + direct))
  done
  echo "base and effects $sum, shared $(whole shared), scene $(whole operations)"
  [ "$((sum + $(whole shared)))" = "$(whole operations)" ]
}
slow check "satellite: operations add up" adds_up models/satellite.lag low oblate drag moon sunlight relativity
slow check "foucault_lab: with a coordinate more" adds_up models/foucault_lab.lag lab rotation amplitude air support
# wind requires drag: the cost of drag is counted without wind
weigh models/projectile_world.lag stadium
is "what requires another is counted apart from it" \
  "$(($(uses models/projectile_world.lag stadium 'drag, magnus, coriolis, falloff') - $(uses models/projectile_world.lag stadium 'magnus, coriolis, falloff')))" "$(of drag operations)"
sum() { sed 's/.*"effects": //' "$dir/json" | grep -o '"on": true[^}]*"operations": [0-9-]*' | awk '{ s += $NF } END { print s }'; }
is "and all add up" "$(whole operations)" "$(($(whole base) + $(sum) + $(whole shared)))"
table() { "$LAGC" effects models/satellite.lag low | sed -n 's/^  \([a-z]*\)  *\(on\|off\)*  *\(-*[0-9]*\) .*/\1 \3/p' | awk '$1 == "scene" { scene = $2; next } { s += $2 } END { print s, scene }'; }
check "the table adds up" sh -c 'echo "$*"; [ -n "$1" ] && [ "$1" = "$2" ]' - $(table)
positive() { echo "$1"; awk -v x="$1" 'BEGIN { exit !(x > 0 && x < 1e-3) }'; }
check "a call takes time" positive "$(whole time_s)"
check "and the base less" sh -c 'awk "BEGIN { exit !($1 < $2) }"' - "$(weigh models/satellite.lag low; whole base_time_s)" "$(whole time_s)"

# ---- the smallest set
smallest() { "$LAGC" effects "$@" 2>&1 | sed -n 's/^  use/use/p'; }
is "nothing but what is needed" "use hand" "$(smallest "$push" all --accuracy 0.01)"
is "none" "use none" "$(smallest "$push" all --accuracy 0.5)"
check "all" says 0 'no effect of the scene can be left out' "$LAGC" effects "$push" all --accuracy 1e-5
# each alone makes a quarter; both together make nothing, which no estimate shows
[ -z "${SLOW:-}" ] || is "two that cancel: runs say that both can go" "use none" "$(smallest "$push" cancel --accuracy 1e-6)"
is "with its values" "use hand(f = 2e-9)" "$(smallest "$push" cancel --accuracy 1e-10)"
is "what one requires stays" "use hand" "$(weigh "$push" nested --accuracy 0.1; of use)"
two_of_five() { weigh models/satellite.lag low --accuracy 1e-4 && of effects | tail -1 | grep -x '\[oblate, drag\]'; }
slow check "satellite: two of five" two_of_five
pasted() { # the proposed `use` line, put into the scene, gives a result of that accuracy
  use=$(smallest models/satellite.lag low --accuracy 1e-4)
  sed "/^scene low /s/use [a-z, ]*/$use /" models/satellite.lag >"$dir/pasted.lag"
  for f in models/satellite.lag "$dir/pasted.lag"; do "$LAGC" run "$f" low -o - --quiet 2>/dev/null | tail -1 | tr , '\n' | sed -n 2,4p; done >"$dir/ends"
  awk '{ x[NR] = $1 } END { d = sqrt((x[1]-x[4])^2 + (x[2]-x[5])^2 + (x[3]-x[6])^2)/sqrt(x[1]^2 + x[2]^2 + x[3]^2); print d; exit !(NR == 6 && d > 0 && d < 1e-4) }' "$dir/ends"
}
slow check "pasted into the scene it does what was promised" pasted

{
  echo 'model many "Eleven"'
  echo 'coord x [m]'
  echo "lagrangian = 1 [kg]/2*x'^2 + 1 [N]*x"
  for i in 1 2 3 4 5 6 7 8 9 10 11; do echo "effect e$i { param f = 1e-$i [N]; force x = f }"; done
  echo 'scene s { use e1, e2, e3, e4, e5, e6, e7, e8, e9, e10, e11; span 1; method rk45 }'
} >"$dir/many.lag"
check "more than ten are refused" says 2 'the scene has 11 effects; all sets of up to 10 are searched' "$LAGC" effects "$dir/many.lag" s --accuracy 2e-3

# A force that is always 0: the two runs differ by rounding in steps of other sizes.
cat >"$dir/nothing.lag" <<'END'
model nothing "An effect that does nothing"
coord x [m], y [m]
param m = 1 [kg] > 0, k = 1 [N/m] > 0
kinetic = m/2*(x'^2 + y'^2)
potential = k/2*(x^2 + y^2)
effect f { state q; flow q' = -q*1 [1/s]; force x = q*1 [N] }
scene s { start x = 1, y' = 1; span 10 }
END
weigh "$dir/nothing.lag" s
is "an effect that does nothing" "would not matter" "$(of f verdict)"

check "below the smallest tolerance there is none: a larger one tells" sh -c 'awk -v e="$1" "BEGIN { exit !(e > 0 && e < 1e-10) }"' - "$(weigh models/mercury.lag advance --until 1e7; of integration_error)"

# ---- mistakes
sed "/^effect/d; /^scene/d" "$push" >"$dir/none.lag"
check "no effects" says 1 'the model has no effects to compare' "$LAGC" effects "$dir/none.lag"
check "an accuracy that is none" says 2 'a difference that does not matter' "$LAGC" effects "$push" all --accuracy small
check "an accuracy that steps do not keep" says 3 'add --tol with a smaller number' "$LAGC" effects "$dir/swing.lag" s --tol 1e-3 --accuracy 1e-3
slow check "an accuracy that the run does not have" says 3 'add --tol with a smaller number' "$LAGC" effects models/satellite.lag low --tol 1e-5 --accuracy 1e-6
check "no such scene" says 1 'did you mean `all`?' "$LAGC" effects "$push" al
check "no such value" says 2 'no such parameter' "$LAGC" effects "$push" all xx=3
check "a run that fails" says 3 '' "$LAGC" effects "$push" all --method 'rk45' hand.f=1e308 F=1e308
# A force with a pole: fields that cannot be measured are null, with a reason.
printf "model pole\ncoord x\nlagrangian = x'^2/2\neffect pole { force x = 1/(0.5 - t)^3 }\nscene s { start x = 1; span 1 }\n" >"$dir/pole.lag"
weigh "$dir/pole.lag"
is "no difference where a run fails" null "$(of pole difference)"
is "and no time" null "$(of pole time_s)"
check "the reason" grep -q '"failed": "at t = 0.5 s: the step became too small' "$dir/json"
tap_end
