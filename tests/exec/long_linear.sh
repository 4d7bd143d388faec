#!/bin/sh
# The exact linearisation that `--with linear` adds to a model: C without warnings, correct derivatives for every model, and no
# trace of it without the option.
. tests/tap.sh

strict='-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror'
mkdir -p "$TMP/c"
# A file for each variant of each model; its functions are known by their digest. Scenes of two models may have one name.
n=0
: >"$TMP/seen"
emit_scene() { # MODEL SCENE OPTIONS...
  "$LAGC" emit "$@" --with linear -o "$TMP/emitted.c" || echo "$*" >>"$TMP/failed"
  digest=$(sed -n 's/.*\.digest = "\(.*\)".*/\1/p' "$TMP/emitted.c")
  grep -qx "$digest" "$TMP/seen" && return
  echo "$digest" >>"$TMP/seen"
  n=$((n + 1))
  sed "s/^const lag_model /static &/; s/^const lag_scene .* = {/const lag_scene scene_$n = {/" "$TMP/emitted.c" >"$TMP/c/m$n.c"
}
models='models/double_pendulum.lag models/slider_crank.lag models/free_body.lag'
for m in models/*.lag tests/exec/models/*.lag; do
  case " $models " in *" $m "*) ;; *) one_of 16 && self_contained "$m" && models="$models $m" ;; esac
done
for m in $models; do
  for scene in $(sed -n 's/^scene \([^ ]*\).*/\1/p' "$m"); do emit_scene "$m" "$scene"; done
done
emit_scene models/chain.lag swing -D N=30 # so long that its accelerations do without M
check "every model has a linearisation" test ! -e "$TMP/failed"
check "its C is clean" sh -c "$CC -std=c11 $strict -fsyntax-only -I$INC $TMP/c/m*.c"
[ -z "${CLANG:-}" ] || slow check "its C is clean with clang" sh -c "$CLANG -std=c11 $strict -fsyntax-only -I$INC $TMP/c/m*.c"

not_asked() {
  for m in models/[a-d]*.lag; do
    "$LAGC" emit "$m" -o "$TMP/plain.c" && ! grep -q 'linearise' "$TMP/plain.c" || { echo "$m"; return 1; }
  done
}
check "a model that was not asked for it has none" not_asked
is "a part that does not exist" "lagc: --with takes linear, sensitivities, derivatives, not \`nothing\`" \
  "$("$LAGC" emit models/spring.lag --with nothing 2>&1)"

{
  echo '#include "lag_model.h"'
  seq -f 'extern const lag_scene scene_%g;' "$n"
  echo 'extern const lag_scene *const all_scenes[];'
  echo 'const lag_scene *const all_scenes[] = {'
  seq -f '  &scene_%g,' "$n"
  echo '  0};'
} >"$TMP/c/scenes.c"
echo '#include <quadmath.h>' >"$TMP/quad.h"
quad="-std=gnu11 -O0 -w -I$INC -include $TMP/quad.h -DLAG_REAL=__float128 -DLAG_FN(x)=x##q -DLAG_C(x)=x##Q"
right() {
  # shellcheck disable=SC2086 # flags
  "$CC" $quad "$TMP"/c/*.c tests/exec/linear_quad.c -lquadmath -lm -o "$TMP/linear" && "$TMP/linear"
}
if echo 'int main(void) { return 0; }' | "$CC" -include "$TMP/quad.h" -x c - -lquadmath -o "$TMP/quad" 2>/dev/null; then
  check "the Jacobian of every model, against differences in quadruple precision" right
else
  skip "the Jacobian of every model" "there is no libquadmath"
fi
tap_end
