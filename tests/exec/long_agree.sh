#!/bin/sh
# Emitted C against the evaluator of programs, and programs against the graphs that they come from, at random states: of every model under the address
# and undefined-behaviour sanitizers, of a third of them under valgrind. (exec/run_emit compares without them.)
: "${LAGC:=build/lagc}" "${BUILD:=build}" "${INC:=runtime/include}" "${CC:=cc}" "${BIN:=build/test/bin}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
. tests/tap.sh

models=
for m in models/*.lag tests/exec/models/*.lag; do
  case $m in */mutants_*) continue ;; esac # they share names with other models
  one_of 16 && self_contained "$m" && models="$models $m"
done
third=$(printf '%s\n' $models | grep -v /bicycle | awk 'NR % 3 == 1') # the bicycle alone would take as long as all others
mkdir -p "$TMP/c"
name_of() { sed -n 's/^model \([^ ]*\).*/\1/p' "$1" | tr '[:upper:]' '[:lower:]'; }
emit_all() { for m in $models; do "$LAGC" emit "$m" --method gauss -o "$TMP/c/$(name_of "$m").c" || return 1; done; }
check "lagc emit, all models" emit_all

build() { # OUTPUT LIBRARY MODELS OPTIONS...
  output=$1 library=$2 of=$3
  shift 3
  {
    echo '#include "lag_model.h"'
    for m in $of; do sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP/c/$(name_of "$m").c"; done
    echo 'extern const lag_scene *const all_scenes[];'
    echo 'const lag_scene *const all_scenes[] = {'
    for m in $of; do sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP/c/$(name_of "$m").c"; done
    echo '  0};'
  } >"$TMP/c/scenes.c"
  files=$TMP/c/scenes.c
  for m in $of; do files="$files $TMP/c/$(name_of "$m").c"; done
  # shellcheck disable=SC2086 # a list of words
  "$CC" -std=gnu11 -ffp-contract=off -D_XOPEN_SOURCE=700 -Isrc -I"$BUILD/gen" -I"$INC" '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L' \
    "$@" tests/exec/emit_agree.c $files "$library" -lm -o "$output"
}
sanitized() {
  build "$TMP/sanitized" "${LAGC_SAN%/*}/liblagc.a" "$models" -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all &&
    "$TMP/sanitized" $models
}
check "emitted C computes what its program says, under both sanitizers" sanitized
if command -v valgrind >/dev/null; then
  # Valgrind computes long doubles with 53 bits on both sides, but the compiler reads constants in full, so inputs differ in the last
  # bit. The tolerance 1e-15 is 2e4 units of 64 bits; as many units of 53 bits are 2e-12.
  under_valgrind() { build "$TMP/plain" "$BUILD/liblagc.a" "$third" -O1 -g -DLOOSE=2e-12L && valgrind -q --error-exitcode=9 "$TMP/plain" $third; }
  check "the same under valgrind" under_valgrind
  # Sanitizers see all models, but not values that were never set.
  check "programs against graphs under valgrind: no error of memory in the compiler" \
    sh -c "for m in $(echo $third); do valgrind -q --error-exitcode=9 $LAGC emit \$m -o $TMP/again.c || exit 1; done"
else
  skip "the same under valgrind" "there is no valgrind"
fi
tap_end
