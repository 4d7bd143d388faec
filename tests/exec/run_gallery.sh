#!/bin/sh
# The gallery by name: `lagc models`, `@NAME` in the place of a file, `lagc new`.
. tests/tap.sh
case $LAGC in /*) lagc=$LAGC ;; *) lagc=$PWD/$LAGC ;; esac
models=$PWD/models
# ---- the page ----
sed -n '/^## By topic/,/^## \[/s/^| [^|]* | \(\[.*\) |$/\1/p' models/README.md | tr ',' '\n' | sed 's/^ *//' | sort -u >"$TMP/topics"
for m in models/*.lag; do m=$(basename "$m" .lag); echo "[$m]($m.lag)"; done | sort >"$TMP/models"
empty "each model has a topic, and each topic has models" "$(diff "$TMP/models" "$TMP/topics")"
empty "each model has a section, once" "$(sed -n 's/^## \(\[[^:]*\): .*/\1/p' models/README.md | sort | diff "$TMP/models" -)"
few_facts() { for m in models/*.lag; do n=$(grep -c '^[A-Za-z_][^#|]*|.* = .*|.*|.*[a-z]' "${m%.lag}.facts"); [ "$n" -ge 3 ] || echo "$m: $n"; done; }
empty "each model has three facts" "$(few_facts)"
empty "each model has a picture" "$(for m in models/*.lag; do grep -q "^Drawn by .build/lagc [a-z]* $m " models/README.md || echo "$m"; done)"
empty "each picture has its command as a caption" "$(awk '/^!\[/ && last !~ /^Drawn by `build\/lagc .*`:$/ { print } { last = $0 }' models/README.md)"
empty "each text has less than 60 lines" "$(for m in models/*.lag; do [ "$(wc -l <"$m")" -lt 60 ] || echo "$m"; done)"
empty "no section is longer than 60 lines" "$(awk '/^## / { if (n > 60) print name; name = $0; n = 0 } { n++ }' models/README.md)"
cd "$TMP" || exit 1

# ---- by name ----
"$lagc" models >list
is "all models are listed" "$(cd "$models" && grep -l '^model ' ./*.lag | sed 's|./||; s/\.lag$//' | LC_ALL=C sort)" "$(sed -n 's/^@\([a-z_0-9]*\) .*/\1/p' list)"
check "with their titles" grep -q '^@pendulum  *A point mass on a massless rod$' list
check "and their folder" grep -q "^Files in $models" list
for c in "check @pendulum" "derive @pendulum small" "plot @pendulum small --until 1 --quiet -o a.svg" "header @pendulum -o pend.h" "modes @pendulum small"; do
  case ${GSL:-}$c in modes*) continue ;; esac
  # shellcheck disable=SC2086 # words
  check "lagc $c" "$lagc" $c
done
is "as by its file" "$("$lagc" run "$models/pendulum.lag" wide --until 1 --json | sed 's/"wall_s": [^,]*//')" "$("$lagc" run @pendulum wide --until 1 --json | sed 's/"wall_s": [^,]*//')"
check "no model is overwritten" says 2 'pendulum.lag would be overwritten' "$lagc" derive @pendulum -o "$models/pendulum.lag"
check "the nearest name" says 2 'did you mean @double_pendulum?' "$lagc" run @double_pendlum
check "or one that begins so" says 2 'did you mean @damped_oscillator?' "$lagc" run @damped
check "no name behind @" says 2 'the name of a gallery model, for example @pendulum' "$lagc" run @
check "a name without @" says 2 'the gallery has @pendulum' "$lagc" run pendulum
check "or its file, where it is not" says 2 'the gallery has @pendulum' "$lagc" check no/pendulum.lag
check "or the list" says 2 '`lagc models` lists them' "$lagc" run @xyzzy

check "a new model" "$lagc" new swing --like pendulum
is "is a copy under its name" "$(sed 's/^model pendulum/model swing/' "$models/pendulum.lag")" "$(cat swing.lag)"
check "that holds" "$lagc" check swing.lag
check "by the name of its file" says 0 'rope.lag begins as a copy of chain;' "$lagc" new rope.lag --like chain
check "a name that its file lacks" says 2 'did you mean swing.lag?' "$lagc" run swing
check "of a model whose name it has" says 0 'a copy of double_pendulum;' "$lagc" new my_double_pendulum
check "or nearly" says 0 'a copy of kepler;' "$lagc" new keppler
check "or of pendulum" says 0 'a copy of pendulum;' "$lagc" new xyzzy
echo kept >mine.lag
check "no file is overwritten" says 2 'mine.lag is there already' "$lagc" new mine
is "it is as it was" kept "$(cat mine.lag)"
check "an unknown model" says 2 'did you mean @pendulum?' "$lagc" new other --like pendulumm
check "a name with other characters" says 2 "a model's name has letters" "$lagc" new ../up
check "which _ could stand for" says 2 'write lagc new my_swing' "$lagc" new my-swing
check "no name" says 2 'a name is missing' "$lagc" new
check "one word too many" says 2 'one word too many' "$lagc" new one two
check "one word too many" says 2 'one word too many' "$lagc" models two words
"$lagc" models Swings >some
is "models by a word of their names and titles, in capitals or not" "$(grep -i '^@.*swings' list)" "$(grep '^@' some)"
check "there are some, and others" sh -c '[ "$(grep -c "^@" some)" -ge 2 ] && [ "$(grep -c "^@" some)" -lt "$(grep -c "^@" list)" ]'
check "by a word that none has" says 2 'no model has `xyzzy` in its name or title' "$lagc" models xyzzy
check "help on a model says where it is" says 0 'Models: `lagc models woodpecker`' "$lagc" help woodpecker
is "nothing is left of these" "" "$(ls other.lag one.lag ../up.lag 2>/dev/null)"
printf 'model flat\ninclude "bodies.lag"\ncoord a [rad]\nparam m = 5 [kg] > 0, r = 0.5 [m] > 0\nlagrangian = ball(m, r)/2*a'"'"'^2\nexpect p: d(lagrangian, a'"'"') = 2/5*m*r^2*a'"'"'\n' >flat.lag
check "a model anywhere includes the library" "$lagc" check flat.lag
check "a model with a table of the library" "$lagc" new car --like quarter_car
check "finds it from anywhere" "$lagc" run car.lag --quiet --until 0.1
mkdir sub && echo 'function ball(m, r) = m*r^2' >sub/bodies.lag && sed 's/2\/5/1/' flat.lag >sub/flat.lag
check "a file beside the model comes first" "$lagc" check sub/flat.lag
sed 's/bodies/bodys/' flat.lag >no.lag
check "an unknown file is missed beside the model" says 1 'cannot read `bodys.lag`' "$lagc" check no.lag

mkdir -p bin && cp "$lagc" bin/lagc
check "without a gallery" says 2 '`make install` brings it along' bin/lagc models
check "names have none" says 2 '`make install` brings it along' bin/lagc run @pendulum
mkdir -p share/lagc/models && cp "$models/kepler.lag" share/lagc/models
is "an installation has its own" "@kepler" "$(bin/lagc models | head -n 1 | cut -d " " -f 1)"
is "completion of names" "@toda" "$("$lagc" complete run @tod | cut -f 1)"
is "and of scenes" "wide" "$("$lagc" complete run @pendulum wi | cut -f 1)"
is "of --like" "toda" "$("$lagc" complete new x --like tod | cut -f 1)"
tap_end
