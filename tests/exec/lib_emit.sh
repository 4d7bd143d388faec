# shellcheck shell=sh
# What run_emit.sh and long_emit.sh share: models emitted, to $TMP/c, $TMP/h and $TMP/more, and ways to compile and to evaluate it.
# plain=no: only headers and $TMP/more, whose files hold the functions of those of $TMP/c and others.
. tests/tap.sh

# Two that programs of these suites use by name, and one model in `part`.
models='models/double_pendulum.lag tests/exec/models/oscillator.lag'
for m in models/*.lag tests/exec/models/*.lag; do
  case " $models " in *" $m "*) ;; *) one_of "$part" && light "$m" && self_contained "$m" && models="$models $m" ;; esac
done
strict='-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror'
here=tests/exec
mkdir -p "$TMP/c" "$TMP/h"

name_of() { sed -n 's/^model \([^ ]*\).*/\1/p' "$1" | tr '[:upper:]' '[:lower:]'; }
cxx() { case $1 in *clang*) echo "${1}++" ;; *gcc*) echo "$1" | sed 's/gcc/g++/' ;; *) echo g++ ;; esac; }

# ---- emit everything once
emit_all() { # emit_all LAGC FOLDER
  mkdir -p "$2"
  for m in $models; do
    n=$(name_of "$m")
    [ "${plain:-}" = no ] || "$1" emit "$m" -o "$2/$n.c" || return 1
    ! has_header "$m" || "$1" header "$m" -o "$2/$n.h" || return 1
  done
}
check "lagc emit and lagc header, all models" emit_all "$LAGC" "$TMP/c"
mv "$TMP"/c/*.h "$TMP/h"
# With derivatives that only some methods need.
emit_more() {
  mkdir -p "$TMP/more"
  for m in $models; do "$LAGC" emit "$m" --method gauss -o "$TMP/more/$(name_of "$m").c" || return 1; done
  for f in "$TMP"/more/*.c; do grep -q 'nq = 0' "$f" || grep -q 'static int second' "$f" || return 1; done
  "$LAGC" emit models/double_pendulum.lag -o "$TMP/without.c" && ! grep -q 'static int second' "$TMP/without.c"
}
check "lagc emit --method, all models" emit_more

# ---- compile
sources_clean() { # COMPILER STANDARD
  "$1" -std="$2" $strict -fsyntax-only -I"$INC" "$TMP"/c/*.c
}
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
headers_clean() { # COMPILER STANDARD SUFFIX REAL...: each REAL a type, with _ for a blank
  with=$1 std=$2 suffix=$3
  shift 3
  for real; do
    more=
    [ "$std $real" = 'c99 long_double' ] && more=-DC99_LONG_DOUBLE
    "$with" -std="$std" $strict $more "-DREAL=$(echo "$real" | tr _ ' ')" -fsyntax-only "$TMP/h/all.$suffix" || return 1
  done
  "$with" -std="$std" $strict -DREAL=double -fsyntax-only "$TMP/h/all_static.$suffix"
}

runs() { # COMPILER STANDARD REAL OPTIONS...: the body in one file, its use in another
  with=$1 std=$2 real=$3
  shift 3
  x=c
  case $std in c++*) x=c++ ;; esac
  "$with" -x $x -std="$std" $strict -O1 -I"$TMP/h" "-DREAL=$real" "$@" -DWITH_BODY -c $here/emit_header_run.c -o "$TMP/body.o" &&
    "$with" -x $x -std="$std" $strict -O1 -I"$TMP/h" "-DREAL=$real" "$@" -DMAIN -c $here/emit_header_run.c -o "$TMP/use.o" &&
    "$with" "$TMP/body.o" "$TMP/use.o" -lm -o "$TMP/run" && "$TMP/run"
}
# ---- evaluate: one text for every LAG_REAL
{
  echo '#include "lag_model.h"'
  for m in $models; do sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP/more/$(name_of "$m").c"; done
  echo 'extern const lag_scene *const all_scenes[];'
  echo 'const lag_scene *const all_scenes[] = {'
  for m in $models; do sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP/more/$(name_of "$m").c"; done
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
      if ($1 == "compass_walker") next # its feet have a millionth of the mass, by which rounding grows
      if (name == "float" && $1 == "woodpecker") next # floats find its matrix singular: the sleeve has a hundredth of the inertia that it carries
      for (i = 4; i <= n; i++) { x = $i < 0 ? -$i : $i; if (x > size) size = x }
      if (name == "float" && size > 1e15) { huge[$1] = 1; next } # its squares are too large for a float
      for (i = 1; i <= n; i++) {
        d = i > 2 ? $i - $(i + n) : ($i != $(i + n))
        if (!(d <= tolerance * size && -d <= tolerance * size)) { print $1, $2, i - 3 ":", $i, $(i + n); bad = 1 }
      } }
    END { exit bad || NR < 100 }'
}
