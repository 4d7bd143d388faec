# shellcheck shell=sh
# The cases as C, and a program that runs them: for the suites of this folder.
hard=tests/hard
cases= # their names; empty: all
models=$hard/cases # their folder

# a_part_of_the_cases: half of them by day, in `make test-all` all
a_part_of_the_cases() {
  for id in $(awk '{ print $1 }' $hard/expected.txt | sort -u); do one_of 4 && cases="$cases $id"; done
}

# emit_one NAME SCENE SUFFIX OPTIONS...: several programs of one model need different names.
emit_one() {
  emit_name=$1 emit_scene=$2 emit_suffix=$3
  shift 3
  "$LAGC" emit "$models/$emit_name.lag" "$emit_scene" "$@" -o "$TMP/part" || return 1
  sed "s/^const lag_model /static &/; s/^\\(const lag_scene [A-Za-z_0-9]*\\) = {/\\1$emit_suffix = {/" "$TMP/part" >"$TMP/$emit_name.$emit_scene$emit_suffix.c"
}

# emit_cases WANTS [VARIATION]: writes $TMP/*.c of all cases with a model, and $TMP/scenes.c with the list of their scenes.
# All have the functions for taylor; with `all`, also those for radau, and a second program each for variational.
emit_cases() {
  [ "$1" = all ] && emit_more='--with linear' || emit_more=
  awk '!seen[$1, $2]++ { print $1, $2 }' $hard/expected.txt >"$TMP/pairs"
  while read -r id scene; do
    name=$(printf %s "$id" | tr '.-' '__')
    case " $cases " in '  ' | *" $id "*) ;; *) continue ;; esac
    [ -f "$models/$name.lag" ] || continue
    # shellcheck disable=SC2086 # options
    emit_one "$name" "$scene" '' --method taylor $emit_more || return 1
    [ "$1" != all ] || emit_one "$name" "$scene" _v --method variational || return 1
  done <"$TMP/pairs"
  {
    echo '#include "lag_model.h"'
    sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP"/*.c
    echo 'extern const lag_scene *const all_scenes[];'
    echo 'const lag_scene *const all_scenes[] = {'
    sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP"/*.c
    echo '  0};'
  } >"$TMP/scenes.txt"
  mv "$TMP/scenes.txt" "$TMP/scenes.c"
}

# compile_cases PROGRAM: compiles the output of emit_cases, two files at a time.
compile_cases() {
  for f in "$TMP"/*.c; do echo "$f"; done |
    xargs -P 2 -I FILE "$CC" -std=c11 "${LAGC_OPTIMISE:--O1}" -ffp-contract=off -w -I"$INC" -c FILE -o FILE.o || return 1
  # shellcheck disable=SC2086 # lists of words
  "$CC" -std=c11 -O1 -ffp-contract=off -Wall -Wextra -I"$INC" ${GSL:+-DWITH_GSL} $hard/hard.c "$TMP"/*.c.o ${GSL:+"$BUILD/liblag_gsl.a"} "$BUILD/liblag.a" $LIBS -o "$1"
}

# hard_runs TIER [CASE | METHOD ...]: by the program that compile_cases made.
# shellcheck disable=SC2086 # a list of words
hard_runs() { "$TMP/hard" $hard/cases.json $hard/expected.txt $hard/runs.txt "$@" $cases; }
