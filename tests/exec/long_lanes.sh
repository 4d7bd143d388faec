#!/bin/sh
# Emitted C over lanes: every function of every model, compiled for vectors of 4 and of 8 doubles, gives in each lane the
# value for a double, to a few units in the last place; also where lanes part in an `if`, or are singular.
# By gcc and clang.
. tests/tap.sh

echo 'typedef double v __attribute__((vector_size(64))); v f(v a, v b); v f(v a, v b) { return (v)((a < b) & 1); }' >"$TMP/probe.c"
if ! $CC -w -c "$TMP/probe.c" -o "$TMP/probe.o" 2>/dev/null; then skip_all "the compiler has no vectors"; fi
clang=${CLANG:-$(command -v clang)}

# Models with thousands of coordinates test nothing that smaller ones do not.
models=$(echo tests/exec/lanes/*.lag)
for m in models/*.lag tests/exec/models/*.lag; do
  case $m in models/string.lag) continue ;; esac
  one_of 16 && self_contained "$m" && models="$models $m"
done
name_of() { sed -n 's/^model \([^ ]*\).*/\1/p' "$1" | tr '[:upper:]' '[:lower:]'; }
mkdir -p "$TMP/gauss" "$TMP/taylor"
emit_all() {
  for m in $models; do
    n=$(name_of "$m")
    "$LAGC" emit "$m" --method gauss --with linear -o "$TMP/gauss/$n.c" || return 1
    "$LAGC" emit "$m" --method taylor -o "$TMP/taylor/$n.c" || return 1
  done
}
check "lagc emit with all that methods need" emit_all
for set in gauss taylor; do
  {
    echo '#include "lag_model.h"'
    sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP/$set"/[!_]*.c
    echo 'extern const lag_scene *const all_scenes[];'
    echo 'const lag_scene *const all_scenes[] = {'
    sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP/$set"/[!_]*.c
    echo '  0};'
  } >"$TMP/$set/_scenes.c"
done

evaluate() { # SET FILE COMPILER OPTIONS...
  set=$1 file=$2 c=$3
  shift 3
  $c -std=gnu11 "${LAGC_OPTIMISE:--O1}" -ffp-contract=off -Wall -Wextra -Werror -Wno-psabi -I"$INC" "$@" "$TMP/$set"/*.c tests/exec/lanes/eval.c -lm -o "$TMP/eval" &&
    "$TMP/eval" >"$TMP/$file.txt"
}
# Numbers agree to 1e-14 of the largest of their line, 45 roundings (conditioning makes 18 of the two of a sine, and 400 in the accelerations of the bicycle, whose wheels may be anywhere); status and text exactly. A singular lane has its status alone. Where some
# lane overflows, both overflow.
agree() { # FILE FILE
  [ "$(wc -l <"$TMP/$1.txt")" -gt 1000 ] || return 1
  sort_states "$1" && sort_states "$2" || return 1
  paste -d ' ' "$TMP/$1.sorted" "$TMP/$2.sorted" | awk '
    { n = NF / 2; size = 0; most = $1 == "bicycle" ? 1e-12 : 1e-14; singular += $3 == -1; regular += $3 == 0
      for (i = 4; i <= n; i++) { x = $i < 0 ? -$i : $i; if ($i !~ /n/ && x > size) size = x }
      for (i = 1; i <= n; i++) {
        if ($i == $(i + n)) continue
        d = $i - $(i + n)
        if (i > 3 && $i !~ /n/ && $(i + n) !~ /n/ && d <= most*size && -d <= most*size) continue
        if (bad++ < 20) print $1, $2, $3, i - 3 ":", $i, $(i + n)
      } }
    END { print singular " singular, " regular " regular"; exit bad || singular < 5 || NR < 1000 }'
}
# Lanes print function by function, doubles state by state: each model and function keeps its order.
sort_states() { LC_ALL=C sort -s -k 1,2 "$TMP/$1.txt" >"$TMP/$1.sorted"; }

# For the processor's own vectors: otherwise the compiler splits vectors, which takes long.
four= eight=
grep -q ' fma .* avx2 ' /proc/cpuinfo 2>/dev/null && four=-march=x86-64-v3
eight=$four
grep -q ' avx512dq ' /proc/cpuinfo 2>/dev/null && eight=-march=x86-64-v4

compare() { # SET LANES COMPILER OPTIONS...
  set=$1 lanes=$2 c=$3
  shift 3
  check "$set: $lanes lanes, $(basename "$c")" evaluate "$set" "$set.$lanes" "$c" -DLAG_LANES="$lanes" "$@"
  check "$set: $lanes lanes, $(basename "$c"): what doubles give" agree "$set" "$set.$lanes"
}
for set in gauss taylor; do check "$set: doubles" evaluate $set $set "$CC"; done
compare gauss 4 "$CC" $four
compare taylor 8 "$CC" $eight
if [ -n "$clang" ]; then compare gauss 8 "$clang" $eight
else compare gauss 8 "$CC" $eight; fi
# ---- an emitted header
check "lagc header" sh -c "'$LAGC' header models/double_pendulum.lag -o '$TMP/swing.h' && '$LAGC' header models/double_pendulum.lag -o '$TMP/one.h'"
embedded() { # COMPILER LANES OPTIONS...
  c=$1 n=$2
  shift 2
  $c -std=gnu11 "${LAGC_OPTIMISE:--O2}" -Wall -Wextra -Werror -Wno-psabi -I"$TMP" -DLANES="$n" "$@" tests/exec/embed_lanes.c -lm -o "$TMP/embedded" && "$TMP/embedded"
}
for c in "$CC" $clang; do
  check "an embedded header, 4 lanes, $(basename "$c")" embedded "$c" 4 $four
  check "an embedded header, 8 lanes, $(basename "$c")" embedded "$c" 8 $eight
done
check "4 lanes without AVX" embedded "$CC" 4
check "2 lanes" embedded "$CC" 2 $four
check "8 lanes with the C library's functions" embedded "$CC" 8 -DSWING_LIBM -DONE_LIBM
if [ -n "${CXX:-}" ]; then
  printf '#define SWING_LANES 4\n#define SWING_IMPLEMENTATION\n#include "swing.h"\n' >"$TMP/swing.cpp"
  check "an embedded header over lanes is C++" $CXX -std=gnu++17 "${LAGC_OPTIMISE:--O1}" -Wall -Wextra -Wno-psabi -c "$TMP/swing.cpp" -o "$TMP/swing.o"
else
  skip "an embedded header over lanes is C++" "there is no C++ compiler"
fi
tap_end
