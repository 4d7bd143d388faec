#!/bin/sh
# Emitted C compiles without warnings everywhere, computes the same in every precision, and is the same byte for byte from every
# compiler; headers can be embedded. For models/ and the unusual models of tests/exec/models/.
: "${LAGC:=build/lagc}" "${BUILD:=build}" "${INC:=runtime/include}" "${CC:=cc}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
export TMP
. tests/tap.sh

models=$(ls models/*.lag tests/exec/models/*.lag)
strict='-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror'
here=tests/exec
mkdir -p "$TMP/c" "$TMP/h"

name_of() { sed -n 's/^model \([^ ]*\).*/\1/p' "$1" | tr '[:upper:]' '[:lower:]'; }
# The first compiler of each kind.
gcc=
for c in "$CC" gcc; do "$c" --version 2>/dev/null | grep -q 'Free Software' && gcc=$c && break; done
clang=${CLANG:-$(command -v clang)}
cxx() { case $1 in *clang*) echo "${1}++" ;; *gcc*) echo "$1" | sed 's/gcc/g++/' ;; *) echo g++ ;; esac; }
compilers="$CC"
[ "$CC" = "$clang" ] || compilers="$compilers $clang"

# ---- emit everything once
emit_all() { # emit_all LAGC FOLDER
  mkdir -p "$2"
  for m in $models; do
    n=$(name_of "$m")
    "$1" emit "$m" -o "$2/$n.c" || return 1
    "$1" header "$m" -o "$2/$n.h" || return 1
  done
}
check "lagc emit and lagc header, all models" emit_all "$LAGC" "$TMP/c"
mv "$TMP"/c/*.h "$TMP/h"
# With derivatives that only some methods need.
emit_more() {
  mkdir -p "$TMP/more"
  for m in $models; do "$LAGC" emit "$m" --method gauss -o "$TMP/more/$(name_of "$m").c" || return 1; done
  for f in "$TMP"/more/*.c; do grep -q 'nq = 0' "$f" || grep -q 'static int second' "$f" || return 1; done
  ! grep -q 'static int second' "$TMP/c/double_pendulum.c"
}
check "lagc emit --method, all models" emit_more

# ---- clean
for c in $compilers; do
  check "emitted C is clean with $(basename "$c")" $c -std=c11 $strict -O1 -I"$INC" -c "$TMP"/c/names.c -o "$TMP/names.o"
  check "all of it, C11 and gnu17" sh -c "for s in c11 gnu17; do $c -std=\$s $strict -fsyntax-only -I$INC $TMP/c/*.c || exit 1; done; $c -std=c11 $strict -fsyntax-only -I$INC $TMP/more/*.c"
done
[ -n "$clang" ] || skip "emitted C is clean with clang" "there is no clang"

# All headers in one file: they must not clash either.
all_headers() {
  for h in "$TMP"/h/*.h; do
    p=$(basename "$h" .h | tr '[:lower:]' '[:upper:]')
    echo "#define ${p}_REAL REAL"
    echo "#define ${p}_$1"
    echo '#ifdef C99_LONG_DOUBLE'
    echo "#define ${p}_FN(f) f##l"
    echo '#endif'
    echo "#include \"$(basename "$h")\""
  done
}
all_headers IMPLEMENTATION >"$TMP/h/all.c"
all_headers STATIC >"$TMP/h/all_static.c"
cp "$TMP/h/all.c" "$TMP/h/all.cpp"
cp "$TMP/h/all_static.c" "$TMP/h/all_static.cpp"
headers_clean() { # COMPILER STANDARD SUFFIX
  for real in float double 'long double'; do
    more=
    [ "$2 $real" = 'c99 long double' ] && more=-DC99_LONG_DOUBLE
    "$1" -std="$2" $strict $more "-DREAL=$real" -fsyntax-only "$TMP/h/all.$3" || return 1
  done
  "$1" -std="$2" $strict -DREAL=double -fsyntax-only "$TMP/h/all_static.$3"
}
for c in $compilers; do
  for s in c99 c11; do check "headers are clean: $(basename "$c") $s" headers_clean "$c" $s c; done
  if command -v "$(cxx "$c")" >/dev/null; then
    for s in c++11 c++17; do check "headers are clean: $(cxx "$(basename "$c")") $s" headers_clean "$(cxx "$c")" $s cpp; done
  else
    skip "headers are clean as C++ with $(cxx "$c")" "there is no C++ compiler"
  fi
done
empty "a header includes <math.h> only" "$(grep -h '^ *# *include' "$TMP"/h/*.h | grep -v '<math.h>')"
empty "a header allocates nothing and has no variables" "$(grep -nE 'malloc|^static [^(]*=|^extern' "$TMP"/h/*.h | grep -v 'extern "C"')"

two_names() {
  "$LAGC" header $here/models/effects.lag -o "$TMP/h2/bare.h" && "$LAGC" header $here/models/effects.lag windy -o "$TMP/h2/Windy-2.h" &&
    printf "#define BARE_IMPLEMENTATION\n#define WINDY_2_IMPLEMENTATION\n#include \"bare.h\"\n#include \"Windy-2.h\"\nint main(void) { return BARE_NU + WINDY_2_NU - 1; }\n" >"$TMP/h2/use.c" &&
    "$CC" -std=c99 $strict "$TMP/h2/use.c" -lm -o "$TMP/h2/use" && "$TMP/h2/use"
}
mkdir -p "$TMP/h2"
check "a header's names are its file's: two scenes of a model in one program" two_names

# ---- headers run
runs() { # COMPILER STANDARD REAL OPTIONS...: the body in one file, its use in another
  c=$1 s=$2 real=$3
  shift 3
  x=c
  case $s in c++*) x=c++ ;; esac
  "$c" -x $x -std="$s" $strict -O1 -I"$TMP/h" "-DREAL=$real" "$@" -DWITH_BODY -c $here/emit_header_run.c -o "$TMP/body.o" &&
    "$c" -x $x -std="$s" $strict -O1 -I"$TMP/h" "-DREAL=$real" "$@" -DMAIN -c $here/emit_header_run.c -o "$TMP/use.o" &&
    "$c" "$TMP/body.o" "$TMP/use.o" -lm -o "$TMP/run" && "$TMP/run"
}
for c in $compilers; do
  for real in double float 'long double'; do check "headers run: $(basename "$c") c11 $real" runs "$c" c11 "$real"; done
done
check "headers run: c99 long double" runs "$CC" c99 'long double' -DC99_LONG_DOUBLE
check "headers run: c99 float" runs "$CC" c99 float
if command -v "$(cxx "$CC")" >/dev/null; then
  for real in double float 'long double'; do check "headers run: c++11 $real" runs "$(cxx "$CC")" c++11 "$real"; done
else
  skip "headers run as C++" "there is no C++ compiler"
fi

# ---- one text for every LAG_REAL
{
  echo '#include "lag_model.h"'
  for m in $models; do sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP/c/$(name_of "$m").c"; done
  echo 'extern const lag_scene *const all_scenes[];'
  echo 'const lag_scene *const all_scenes[] = {'
  for m in $models; do sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP/c/$(name_of "$m").c"; done
  echo '  0};'
} >"$TMP/c/scenes.c"
evaluate() { # NAME COMPILER OPTIONS...: values of the models' functions, to NAME.txt
  n=$1 c=$2
  shift 2
  "$c" -std=gnu11 -O0 -ffp-contract=off -Wno-psabi -I"$INC" "$@" "$TMP"/c/*.c $here/emit_eval.c -lquadmath -lm -o "$TMP/eval" 2>"$TMP/eval.err" ||
    "$c" -std=gnu11 -O0 -ffp-contract=off -Wno-psabi -I"$INC" "$@" "$TMP"/c/*.c $here/emit_eval.c -lm -o "$TMP/eval" || return 1
  "$TMP/eval" >"$TMP/$n.txt"
}
# Numbers of a line agree to `tolerance` times the largest of them, or 1.
agree() { # TOLERANCE NAME
  paste -d ' ' "$TMP/double.txt" "$TMP/$2.txt" | awk -v tolerance="$1" -v name="$2" '
    { n = NF / 2; size = 1; if ($1 in huge) next
      for (i = 4; i <= n; i++) { x = $i < 0 ? -$i : $i; if (x > size) size = x }
      if (name == "float" && size > 1e15) { huge[$1] = 1; next } # its squares are too large for a float
      for (i = 1; i <= n; i++) {
        d = i > 2 ? $i - $(i + n) : ($i != $(i + n))
        if (!(d <= tolerance * size && -d <= tolerance * size)) { print $1, $2, i - 3 ":", $i, $(i + n); bad = 1 }
      } }
    END { exit bad || NR < 100 }'
}
check "double: evaluated" evaluate double "$CC"
evaluate float "$CC" -DLAG_REAL=float '-DLAG_FN(x)=x##f'
check "float agrees to 1e-4" agree 1e-4 float
evaluate long "$CC" '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L'
check "long double agrees to 1e-12" agree 1e-12 long
echo '#include <quadmath.h>' >"$TMP/quad.h"
if [ -n "$gcc" ] && echo 'int main(void) { return 0; }' | "$gcc" -include "$TMP/quad.h" -x c - -lquadmath -o "$TMP/quad" 2>/dev/null; then
  evaluate quad "$gcc" -include "$TMP/quad.h" -DLAG_REAL=__float128 '-DLAG_FN(x)=x##q' '-DLAG_C(x)=x##Q'
  check "quadruple precision agrees to 1e-12" agree 1e-12 quad
else
  skip "quadruple precision agrees" "there is no libquadmath"
fi
# run_lanes.sh: vectors.
for c in $compilers; do
  [ "$c" != "$CC" ] || continue
  evaluate other "$c"
  check "the same bits by $(basename "$c")" cmp "$TMP/double.txt" "$TMP/other.txt"
done

# ---- the evaluator of programs agrees
agrees() {
  first=
  for m in $models; do first="$first $TMP/more/$(name_of "$m").c"; done
  "$CC" -std=gnu11 -O0 -ffp-contract=off -D_XOPEN_SOURCE=700 -Isrc -I"$INC" '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L' \
    $here/emit_agree.c "$TMP/c/scenes.c" "$TMP"/more/*.c "$BUILD/liblagc.a" -lm -o "$TMP/agree" && "$TMP/agree" $models
}
check "emitted C computes what its program says, to the last bit" agrees

# ---- the same bytes
same_bytes() { # LAGC
  rm -rf "$TMP/again"
  emit_all "$1" "$TMP/again" || return 1
  for f in "$TMP"/again/*.c; do cmp "$f" "$TMP/c/$(basename "$f")" || return 1; done
  for f in "$TMP"/again/*.h; do cmp "$f" "$TMP/h/$(basename "$f")" || return 1; done
}
check "two runs emit the same bytes" same_bytes "$LAGC"
if [ -n "${LAGC_CLANG:-}" ] && [ -x "$LAGC_CLANG" ]; then check "lagc built by clang emits the same bytes" same_bytes "$LAGC_CLANG"
else skip "lagc built by clang emits the same bytes" "there is no clang"; fi
empty "no dates and no paths in what is emitted" "$(grep -nE "20[0-9][0-9]-|$(pwd)|\.lag" "$TMP"/c/*.c "$TMP"/h/*.h)"

# ---- effects that are off leave no trace
# Prints a model without its effects and the scenes that use one, or are like such a scene.
without_effects() {
  awk '
    FNR == 1 { pass++ }
    /^(effect|scene) / { inside = $2; kind = $1; if (kind == "scene") scene = $2 }
    pass == 1 && kind == "scene" && $1 == "use" && $2 != "none" { drop[scene] = 1 }
    pass == 1 && kind == "scene" && $1 == "like" && ($2 in drop) { drop[scene] = 1 }
    pass == 2 && !(kind == "effect" || (kind == "scene" && (inside in drop))) { print }
    /^}/ || (/}[ \t]*$/ && /^(effect|scene) /) { kind = "" }' "$1" "$1"
}
off_is_absent() { # MODEL
  without_effects "$1" >"$TMP/off.lag"
  ! grep -q '^effect' "$TMP/off.lag" && grep -q '^scene' "$TMP/off.lag" || return 1
  for s in $(sed -n 's/^scene \([^ ]*\).*/\1/p' "$TMP/off.lag"); do
    "$LAGC" emit "$1" "$s" -o "$TMP/with.c" && "$LAGC" emit "$TMP/off.lag" "$s" -o "$TMP/off.c" && cmp "$TMP/with.c" "$TMP/off.c" || return 1
    "$LAGC" check "$1" "$s" >"$TMP/out" 2>&1 || continue # the scene has no start
    "$LAGC" header "$1" "$s" >"$TMP/with.h" && "$LAGC" header "$TMP/off.lag" "$s" >"$TMP/off.h" && cmp "$TMP/with.h" "$TMP/off.h" || return 1
  done
}
cp $here/models/*.csv "$TMP"
for m in $(grep -l '^effect' $models); do check "$m: effects that are off leave no trace" off_is_absent "$m"; done

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
