#!/bin/sh
# Headers of all models, with all parts, in every compiler that is there, in each standard of its language and each precision, with strict warnings. `make test`:
# a sixteenth of the models, one combination in 30. A compiler that is not installed is skipped.
. tests/tap.sh
models=
for m in models/*.lag tests/exec/models/*.lag; do
  case $m in */pendulum.lag | */double_pendulum.lag | */tables.lag | */slider_crank.lag) ;; *) one_of 16 && light "$m" || continue ;; esac
  models="$models $m"
done
# No freedom, and rates that depend on nothing: systems of one entry, parameters that functions do not use. FP_NAN is a name of <math.h>.
printf "model driven\ncoord x\nlagrangian = x'^2/2\nconstraint c: x = sin(t)\n" >"$TMP/driven.lag"
printf "model constant\nstate x\nparam k = 2\nflow x' = k\n" >"$TMP/constant.lag"
printf "model fp\ncoord nan\nlagrangian = nan'^2/2\n" >"$TMP/fp.lag"
models="$models $TMP/driven.lag $TMP/constant.lag $TMP/fp.lag"
strict='-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wundef -Werror'
# Clang's -Weverything without what forbids C99 (declarations after statements, and C++'s own casts and null), its older standards, any comma,
# and comparisons that are meant to be exact; what doubts casts that are right (aligned by construction, of results, `unused` that is used); and
# the analysis of threads, which headers have not, and which takes 24 GB for the bicycle's 2 MB.
everything='-Weverything -Wno-declaration-after-statement -Wno-old-style-cast -Wno-zero-as-null-pointer-constant -Wno-c++98-compat
  -Wno-c++98-compat-pedantic -Wno-comma -Wno-float-equal -Wno-cast-align -Wno-bad-function-cast -Wno-used-but-marked-unused -Wno-padded -Wno-thread-safety -Werror'
arm='-mcpu=cortex-m4 -mthumb -mfloat-abi=soft'

emit_headers() {
  mkdir -p "$TMP/h"
  for m in $models; do
    n=$(basename "$m" .lag)
    has_header "$m" || continue
    "$LAGC" header "$m" --with all -o "$TMP/h/$n.h" || return 1
    p=$(echo "$n" | tr '[:lower:]-' '[:upper:]_')
    printf '#define %s_REAL REAL\n#define %s_WITH_NAMES\n#define %s_IMPLEMENTATION\n#include "%s.h"\n' "$p" "$p" "$p" "$n" >"$TMP/h/one.c"
    cat "$TMP/h/one.c" >>"$TMP/h/all.c"
    case ${SLOW:+all}$n in all* | pendulum | slider_crank | tables) cat "$TMP/h/one.c" >>"$TMP/h/objects.c" ;; esac
  done
  cp "$TMP/h/all.c" "$TMP/h/all.cpp"
}
check "lagc header, $(echo "$models" | wc -w) models" emit_headers

# row COMPILER STANDARDS FILE WARNINGS...: a check for each standard and precision
row() {
  with=$1 standards=$2 file=$3
  shift 3
  command -v "$with" >/dev/null || { skip "$with" "it is not installed"; return; }
  for s in $standards; do
    for real in float double 'long double'; do
      [ "$with $s $real" = 'g++ c++98 double' ] || one_of 30 || continue # C++98 has no long long, which the header takes nevertheless
      check "$with $s, $real" "$with" -std="$s" "$@" "-DREAL=$real" -fsyntax-only "$TMP/h/$file"
    done
  done
}
c='c99 c11 c17' cpp='c++98 c++11 c++17 c++20'
# shellcheck disable=SC2086 # lists of words
{
  row gcc "$c" all.c $strict
  row g++ "$cpp" all.cpp $strict
  row clang "$c" all.c $strict $everything
  row clang++ "$cpp" all.cpp $strict $everything
  row musl-gcc "$c" all.c $strict
  row x86_64-w64-mingw32-gcc "$c" all.c $strict
  row x86_64-w64-mingw32-g++ "$cpp" all.cpp $strict
  row arm-none-eabi-gcc "$c" all.c $strict $arm
  row arm-none-eabi-g++ "$cpp" all.cpp $strict $arm
}

# ---- what is in an object
no_data() { # COMPILER SIZE NM OPTIONS...: no variables; in floats no function of doubles
  with=$1 size=$2 nm=$3
  shift 3
  "$with" -std=c99 -O0 -fno-pie -ffreestanding -DREAL=float "$@" -c "$TMP/h/objects.c" -o "$TMP/all.o" || return 1
  "$size" "$TMP/all.o" | awk 'NR == 2 { print "data", $2, "bss", $3; exit !($2 == 0 && $3 == 0) }' || return 1
  "$nm" "$TMP/all.o" >"$TMP/all.nm" || return 1
  ! grep -E ' U (__aeabi_(d|[a-z]+2d)|(sin|cos|tan|sqrt|fabs|exp|log|pow|cbrt|hypot|floor|frexp|ldexp|fma)$)|__extendsf|__truncdf' "$TMP/all.nm"
}
check "an object has no variables, and floats call no function of doubles" no_data "$CC" size nm
small() {
  echo '#include "pendulum.h"' >"$TMP/h/small.c"
  arm-none-eabi-gcc -std=c99 -O2 -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -DPENDULUM_REAL=float -DPENDULUM_IMPLEMENTATION -c "$TMP/h/small.c" \
    -o "$TMP/small.o" || return 1
  arm-none-eabi-nm -S "$TMP/small.o" | awk '/pendulum_(accel|energy)$/ { for (i = 1; i <= length($2); i++) d = d * 16 + index("0123456789abcdef", substr($2, i, 1)) - 1;
    sum += d; d = 0; n++ } END { print sum, "bytes"; exit !(n == 2 && sum <= 300) }'
}
on_arm() {
  env -u COMPILER_PATH arm-none-eabi-gcc -std=gnu99 -O2 -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -nostartfiles -Wl,-Ttext=0x10000 -iquote "$TMP/h" tests/exec/embed_arm.c \
    -lm -o "$TMP/arm" && qemu-arm "$TMP/arm"
}
if command -v arm-none-eabi-gcc >/dev/null; then
  # shellcheck disable=SC2086
  check "a processor without doubles: the same" no_data arm-none-eabi-gcc arm-none-eabi-size arm-none-eabi-nm $arm
  check "the pendulum in floats: accelerations and energy in 300 bytes of a Cortex-M4" small
  if command -v qemu-arm >/dev/null; then check "and it swings there" on_arm; else skip "and it swings there" "there is no qemu-arm"; fi
else
  skip "code of a Cortex-M4" "there is no arm-none-eabi-gcc"
fi

# ---- scalars that are classes
cxx=$(command -v g++ || command -v clang++)
mkdir -p "$TMP/s"
for n in pendulum double_pendulum slider_crank tables; do
  m=models/$n.lag
  [ -e "$m" ] || m=tests/exec/$m
  "$LAGC" header "$m" -o "$TMP/s/$n.h"
done
"$LAGC" header models/pendulum.lag --with jac -o "$TMP/s/jac.h"
scalar() { # NUMBER OPTIONS...
  n=$1
  shift
  "$cxx" -O1 "-DSCALAR=$n" "$@" -iquote "$TMP/s" tests/exec/embed_scalars.cpp -o "$TMP/scalar" && "$TMP/scalar"
}
if [ -n "$cxx" ]; then
  check "dual numbers" scalar 1 -std=c++98
  check "complex steps by std::complex" scalar 2 -std=c++11
  if [ -e /usr/include/eigen3/unsupported/Eigen/AutoDiff ]; then
    slow check "Eigen's AutoDiffScalar" scalar 3 -std=c++14 -I/usr/include/eigen3
  else
    skip "Eigen's AutoDiffScalar" "there is no Eigen"
  fi
else
  skip "scalars that are classes" "there is no C++ compiler"
fi
in_c() { "$@" -std=gnu11 -iquote "$TMP/s" tests/exec/embed_quad.c -o "$TMP/in_c" -lquadmath -lm && "$TMP/in_c"; }
check "C's complex numbers" "$CC" -std=gnu11 -iquote "$TMP/s" tests/exec/embed_quad.c -o "$TMP/in_c" -lm
check "complex steps in C" "$TMP/in_c"
if echo 'int main(void) { return 0; }' | gcc -x c - -lquadmath -o "$TMP/quad" 2>/dev/null; then check "__float128: 32 digits" in_c gcc -DQUAD
else skip "__float128" "there is no libquadmath"; fi
refused() { # MODEL WORDS
  p=$(echo "$1" | tr '[:lower:]' '[:upper:]')
  ! echo "#include \"$1.h\"" | "$CC" -DREAL=double "-D${p}_COMPLEX" "-D${p}_IMPLEMENTATION" -iquote "$TMP/s" -x c -fsyntax-only - 2>"$TMP/err" && grep -qF "$2" "$TMP/err"
}
check "complex numbers are refused by models with constraints" refused slider_crank 'cannot be complex: the model has constraints'
check "and by Jacobians" refused jac 'cannot be complex: the model has linear systems'
check "and by models with choices" refused tables 'cannot be complex: the model has comparisons'
printf 'model fed\ncoord x [m]\ninput wind [N] = "%s/tests/exec/models/tables.csv"\nlagrangian = 1 [kg]/2*x%s^2\nforce x = wind\n' "$(pwd)" "'" >"$TMP/s/fed.lag"
"$LAGC" header "$TMP/s/fed.lag" -o "$TMP/s/fed.h"
check "and by models with tables" refused fed 'cannot be complex: the model has tables'
tap_end
