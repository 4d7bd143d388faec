#!/bin/sh
# Unused parts of a model are not in a scene's program. With an effect off, the emitted C and the header are, to the byte, those of the
# model with the effect's text deleted, by the parser's own spans: for every effect and scene in models/ and in tests' own.
cd "$(dirname "$0")/../.." || exit 2
: "${LAGC:=build/lagc}" "${BIN:=build/test/bin}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$PWD/$LAGC ;; esac
case $BIN in /*) ;; *) BIN=$PWD/$BIN ;; esac
root=$PWD
dir=$TMP/effects
mkdir -p "$dir/cut"

# OUT FOLDER MODEL SCENE: emitted C and header of a scene. Headers of scenes with impossible starts are refused.
emitted() {
  (cd "$2" && { slow "$LAGC" header "$3" "$4" || echo "no header"; } && "$LAGC" emit "$3" "$4" --method variational &&
    slow "$LAGC" emit "$3" "$4" && slow "$LAGC" emit "$3" "$4" --method radau) >"$1" 2>"$1.err" || { cat "$1.err"; return 1; }
}

# The scenes of a model, and their effects: as emitted C lists them.
scenes() {
  for scene in $(sed -n 's/^scene \([A-Za-z0-9_]*\).*/\1/p' "$1"); do
    "$LAGC" emit "$1" "$scene" 2>"$dir/err" | sed -n "s/^ \* Emitted by lagc; effects in use: \(.*\)\.$/$scene \1/p"
  done
}

# Every scene of one file against the file without each effect that is off there, and without all of them.
identical() { # FILE
  from=$(dirname "$1") name=$(basename "$1")
  "$BIN/cut_effects" "$1" >"$dir/effects" || return 1
  cp "$from"/*.csv "$dir/cut" 2>/dev/null
  scenes "$1" >"$dir/scenes"
  [ -s "$dir/scenes" ] || { cat "$dir/err"; return 1; }
  while read -r scene used; do # `none` is not an effect
    off=
    while read -r effect; do
      case " $used " in *" $effect "*) ;; *) off="$off $effect" ;; esac
    done <"$dir/effects"
    [ -n "$off" ] || continue
    emitted "$dir/whole" "$from" "$name" "$scene" || return 1
    for cut in $off "$off"; do
      # shellcheck disable=SC2086
      "$BIN/cut_effects" "$1" $cut >"$dir/cut/$name"
      emitted "$dir/rest" "$dir/cut" "$name" "$scene" || return 1
      cmp "$dir/whole" "$dir/rest" || { echo "$name, scene $scene, without $cut"; return 1; }
      echo "$name $scene: $cut" >>"$dir/done"
    done
  done <"$dir/scenes"
}
: >"$dir/done"
for f in models/*.lag tests/exec/models/*.lag tests/golden/ok/*.lag tests/exec/modes/*.lag tests/exec/effects/*.lag; do
   "$BIN/cut_effects" "$f" >"$dir/effects" 2>/dev/null && [ -s "$dir/effects" ] && one_of 16 || continue
  check "$f: off is as if deleted" identical "$root/$f"
done
# The gallery alone has more than 60 effects.
check "it was compared" sh -c '[ "$(wc -l <"$1")" -gt "$2" ]' - "$dir/done" "$(depth 8 33 68)"

# ---- each kind of statement acts from inside an effect: closed forms, with m = 1
k=tests/exec/effects/kinds.lag
final() { # NAME SCENE
  "$LAGC" run "$k" "$2" --json 2>"$dir/err" | sed -n "s/.*\"final\": {\\(.*\\)}}.*/, \\1/; s/.*, \"$1\": \\([-0-9.e+]*\\).*/\\1/p"
}
last() { "$LAGC" run "$k" "$1" -o - --quiet 2>"$dir/err" | tail -1 | cut -d, -f"$2"; } # SCENE COLUMN
near() { check "$1" within "$2" "$3"; } # NAME EXPECTED GOT; ten times the tolerance of the scenes
within() { echo "got $2, expected $1"; awk -v e="$1" -v g="$2" 'BEGIN { d = g - e; exit !(g != "" && d <= 1e-10 && -d <= 1e-10) }'; }
calc() { awk "BEGIN { e = exp(1); printf \"%.17g\", $1 }"; }
near "none: x = t" 1 "$(final x bare)"
near "a coordinate, with kinetic and potential energy: y = cos(2t)" "$(calc 'cos(2)')" "$(final y coordinates)"
near "a term of L: x = sin(2t)/2" "$(calc 'sin(2)/2')" "$(final x energies)"
near "a constraint: half of the weight moves both masses" 2.5 "$(final x held_up)"
near "and its multiplier as an observable" 5 "$(last held_up 3)"
# falls for 1/sqrt(5) s, rises with sqrt(5) m/s for as long, falls likewise, rises with half of that
near "a contact" "$(calc 'sqrt(5)/2*(1 - 2/sqrt(5)) - 5*(1 - 2/sqrt(5))^2')" "$(final h floors)"
near "dissipation: x = (1 - exp(-2t))/2" "$(calc '(1 - e^-2)/2')" "$(final x drags)"
near "an event: back from 0.5 m, twice as fast" -0.5 "$(final x bounces)"
near "a state and its flow: x'' = exp(-t)" "$(calc 'e^-1')" "$(final x motors)"
near "an input: x'' = sin t" "$(calc '1 - sin(1)')" "$(final x gusts)"
near "parameters, constants, lets, functions: x'' = 2" 1 "$(final x partly)"
near "a family, its forces and observables: s[2]'' = 2" 4 "$(last rowing 3)"
tap_end
