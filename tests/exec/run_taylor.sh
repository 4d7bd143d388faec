#!/bin/sh
# Taylor coefficients in emitted code: every function against digits of mpmath, every model against its own accelerations, in
# several precisions; and the method `taylor` that lives on them.
. tests/tap.sh

here=tests/exec/taylor
models=$(ls models/*.lag tests/exec/models/*.lag | grep -v mutants) # those have the names of others
name_of() { sed -n 's/^model \([^ ]*\).*/\1/p' "$1"; }
gcc=
for c in "$CC" gcc; do "$c" --version 2>/dev/null | grep -q 'Free Software' && gcc=$c && break; done
echo '#include <quadmath.h>' >"$TMP/quad.h"
quad=
[ -n "$gcc" ] && echo 'int main(void) { return 0; }' | "$gcc" -include "$TMP/quad.h" -x c - -lquadmath -o "$TMP/quad" 2>/dev/null && quad=yes

# build PRECISION FILES... -o PROGRAM
build() {
  precision=$1
  shift
  case $precision in
    double) "$CC" -std=c11 -O1 -ffp-contract=off -I"$INC" "$@" -lm ;;
    long) "$CC" -std=c11 -O1 -ffp-contract=off -I"$INC" -DREAL_LONG '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L' "$@" -lm ;;
    quad) "$gcc" -std=gnu11 -O1 -ffp-contract=off -I"$INC" -include "$TMP/quad.h" -DREAL_QUAD -DLAG_REAL=__float128 '-DLAG_FN(x)=x##q' \
      '-DLAG_C(x)=x##Q' "$@" -lquadmath -lm ;;
  esac
}
precisions="double long${quad:+ quad}"

# ---- every function
digits() { # PRECISION FILE.c
  build "$1" "$2" $here/coefficients.c -o "$TMP/digits" && "$TMP/digits" $here/functions.expected
}
"$LAGC" emit $here/functions.lag --method taylor -o "$TMP/functions.c"
for p in $precisions; do check "every function, its coefficients: $p" digits "$p" "$TMP/functions.c"; done
[ -n "$quad" ] || skip "every function, its coefficients: quad" "there is no libquadmath"
sed 's/\*per_order//' "$TMP/functions.c" >"$TMP/wrong.c"
wrong_digits() { ! cmp "$TMP/functions.c" "$TMP/wrong.c" && build double "$TMP/wrong.c" $here/coefficients.c -o "$TMP/digits" && ! "$TMP/digits" $here/functions.expected; }
check "this test sees a recurrence that lacks a factor" wrong_digits

# ---- every model
mkdir -p "$TMP/c"
{
  echo '#include "lag_model.h"'
  for m in $models; do
    n=$(name_of "$m")
    "$LAGC" emit "$m" --method taylor -o "$TMP/c/$n.c"
    sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP/c/$n.c"
  done
  echo 'extern const lag_scene *const all_scenes[];'
  echo 'const lag_scene *const all_scenes[] = {'
  for m in $models; do sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP/c/$(name_of "$m").c"; done
  echo '  0};'
} >"$TMP/c/scenes.c"
defects() { # PRECISION
  build "$1" "$TMP"/c/*.c $here/defect.c -o "$TMP/defect" && "$TMP/defect" >"$TMP/defect.txt" || { cat "$TMP/defect.txt"; return 1; }
}
p=${quad:+quad}
check "every model: its polynomials solve its equations, to their order" defects "${p:-long}"
mkdir -p "$TMP/wrong"
wrong_defect() { # a sign in one of the recurrences of the double pendulum
  sed '/^static void taylor_next/,/^}/s/ - c\[/ + c[/' "$TMP/c/double_pendulum.c" >"$TMP/wrong/model.c" && ! cmp "$TMP/c/double_pendulum.c" "$TMP/wrong/model.c" &&
    echo '#include "lag_model.h"
      extern const lag_scene double_pendulum_swing, *const all_scenes[];
      const lag_scene *const all_scenes[] = {&double_pendulum_swing, 0};' >"$TMP/wrong/scenes.c" &&
    build "${p:-long}" "$TMP/wrong/model.c" "$TMP/wrong/scenes.c" $here/defect.c -o "$TMP/defect_wrong" && ! "$TMP/defect_wrong"
}
check "this test sees a wrong sign" wrong_defect
is "models that are not analytic have none" "without: motor" "$(grep without "$TMP/defect.txt" | sort -u)"
tap_end
