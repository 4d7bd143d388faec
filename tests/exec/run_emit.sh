#!/bin/sh
# Emitted C compiles without warnings, computes what its program says, and is the same byte for byte from every compiler; headers can be
# embedded. For one model in ten of models/ and of the unusual ones of tests/exec/models/. long_emit.sh: other
# compilers, standards and precisions.
plain=
[ -n "${SLOW:-}" ] || plain=no
part=10
. tests/exec/lib_emit.sh

check "emitted C is clean with $(basename "$CC")" sources_clean "$CC" c11
check "with derivatives that only some methods need" "$CC" -std=c11 $strict -fsyntax-only -I"$INC" "$TMP"/more/*.c
check "headers are clean: c99 double" headers_clean "$CC" c99 c double
check "headers run: c99 double" runs "$CC" c99 double
if command -v "$(cxx "$CC")" >/dev/null; then
  check "headers are clean: c++11 double" headers_clean "$(cxx "$CC")" c++11 cpp double
  check "headers run: c++11 double" runs "$(cxx "$CC")" c++11 double
else
  skip "headers as C++" "there is no C++ compiler"
fi
empty "a header includes <math.h> only" "$(grep -h '^ *# *include' "$TMP"/h/*.h | grep -v '<math.h>')"
empty "a header allocates nothing and has no variables but constants" "$(grep -nE 'malloc|^static [^(]*=|^extern' "$TMP"/h/*.h | grep -v -e 'extern "C"' -e ":static const ")"

two_names() {
  "$LAGC" header $here/models/effects.lag -o "$TMP/h2/bare.h" && "$LAGC" header $here/models/effects.lag windy -o "$TMP/h2/Windy-2.h" &&
    printf "#define BARE_IMPLEMENTATION\n#define WINDY_2_IMPLEMENTATION\n#include \"bare.h\"\n#include \"Windy-2.h\"\nint main(void) { return BARE_NU + WINDY_2_NU - 1; }\n" >"$TMP/h2/use.c" &&
    "$CC" -std=c99 $strict "$TMP/h2/use.c" -lm -o "$TMP/h2/use" && "$TMP/h2/use"
}
mkdir -p "$TMP/h2"
check "a header's names are its file's: two scenes of a model in one program" two_names

# ---- the evaluator of programs agrees
agrees() {
  first=
  for m in $models; do first="$first $TMP/more/$(name_of "$m").c"; done
  "$CC" -std=gnu11 -O0 -ffp-contract=off -D_XOPEN_SOURCE=700 -Isrc -I"$BUILD/gen" -I"$INC" '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L' \
    $here/emit_agree.c "$TMP/c/scenes.c" "$TMP"/more/*.c "$BUILD/liblagc.a" -lm -o "$TMP/agree" && "$TMP/agree" $models
}
check "emitted C computes what its program says, to the last bit" agrees

# ---- alone, with sines, a linear system under constraints, and curves: lag_model.h suffices, and the bits are the same
alone='models/double_pendulum.lag models/cartesian_pendulum.lag tests/exec/models/tables.lag'
bits_of() { # FOLDER OPTIONS...: of all functions at the same states
  to=$1
  shift
  mkdir -p "$TMP/$to" && for m in $alone; do "$LAGC" emit "$@" "$m" -o "$TMP/$to/$(name_of "$m").c" || return 1; done
  { echo '#include "lag_model.h"'
    sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP/$to"/*.c
    echo 'extern const lag_scene *const all_scenes[]; const lag_scene *const all_scenes[] = {'
    sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP/$to"/*.c
    echo '  0};'; } >"$TMP/$to/scenes.c"
  "$CC" -std=c11 -O1 -ffp-contract=off -Wall -Wextra -Werror -I"$headers" "$TMP/$to"/*.c $here/emit_eval.c -lm -o "$TMP/$to/eval" && "$TMP/$to/eval" >"$TMP/$to/bits"
}
emits_alone() {
  mkdir -p "$TMP/one" && cp "$INC/lag_model.h" "$TMP/one" || return 1
  headers=$INC bits_of with && headers=$TMP/one bits_of without --standalone && [ "$(wc -l <"$TMP/with/bits")" -gt 50 ] && diff "$TMP/with/bits" "$TMP/without/bits"
}
check "lagc emit --standalone: lag_model.h suffices, and the bits are the same" emits_alone
for f in "$TMP"/with/double_pendulum.c "$TMP"/without/double_pendulum.c; do # by whose position a reader finds it
  is "the model's functions come first: ${f#"$TMP"/}" derive "$(sed -n 's/^static [a-z]* \([a-z_]*\)(.*{$/\1/p' "$f" | head -n 1)"
done

empty "no dates and no paths in what is emitted" "$(grep -nE "20[0-9][0-9]-|$(pwd)|\.lag" "$TMP"/c/*.c "$TMP"/more/*.c "$TMP"/h/*.h)"

# ---- errors leave nothing behind
mkdir -p "$TMP/none"
printf 'model bad\ncoord x\nlagrangian = x^2 + y\n' >"$TMP/bad.lag"
fails() { # STATUS WORDS COMMAND...: and no file appears
  want=$1 words=$2
  shift 2
  "$@" >"$TMP/out" 2>"$TMP/err"
  got=$?
  [ $got = "$want" ] || { echo "status $got, not $want"; return 1; }
  grep -q -e "$words" "$TMP/err" || { cat "$TMP/err"; return 1; }
  [ -z "$(ls "$TMP/none")" ] && ! [ -s "$TMP/out" ]
}
for command in emit header; do
  check "$command: a bad model leaves no file" fails 1 'unknown name' "$LAGC" $command "$TMP/bad.lag" -o "$TMP/none/x"
  check "$command: an unknown scene leaves no file" fails 1 'unknown scene' "$LAGC" $command $here/models/oscillator.lag nowhere -o "$TMP/none/x"
  check "$command: a missing folder is said" fails 2 'cannot write' "$LAGC" $command $here/models/oscillator.lag -o "$TMP/none/such/x"
done
tap_end
