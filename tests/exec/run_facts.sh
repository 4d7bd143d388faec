#!/bin/sh
# Known results of each model (models/NAME.facts) against emitted C of its scenes and liblag.
#   sh tests/exec/run_facts.sh [NAME...]
# tests/exec/facts.c describes the format of facts. The last checks test this suite: wrong facts must fail.
. tests/tap.sh
dir=$TMP
gsl_flags= gsl_libs=
if echo '#include <gsl/gsl_sf_lambert.h>
int main(void) { return gsl_sf_lambert_W0(0.0) != 0.0; }' >"$dir/try.c" && $CC "$dir/try.c" -o "$dir/try" -lgsl -lgslcblas -lm 2>/dev/null; then
  gsl_flags=-DFACTS_GSL gsl_libs='-lgsl -lgslcblas'
fi
warn='-std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion'

# shellcheck disable=SC2086 # lists of words
$CC $warn -D_XOPEN_SOURCE=700 -O1 ${SAN:-} -Iruntime -I"$INC" $gsl_flags -c tests/exec/facts.c -o "$dir/facts.o" || { echo "Bail out! facts.c does not compile"; exit 1; }

# build MODEL FACTS: the checker of this model with the scenes that the facts name, as $dir/MODEL
build() {
  objects='' declared='' listed='' with=''
  ! grep -q '^[^#].*lyapunov' "$2" || with='--with linear'
  for s in $(sed -n 's/^\([^#| ][^| ]*\).*|.*|.*/\1/p' "$2" | sort -u); do
    # shellcheck disable=SC2086 # words
    "$LAGC" emit "models/$1.lag" "$s" $with -o "$dir/$1_$s.c" || return 1
    symbol=$(sed -n 's/^const lag_scene \([A-Za-z0-9_]*\) = {.*/\1/p' "$dir/$1_$s.c")
    model=$(sed -n 's/^const lag_model \([A-Za-z0-9_]*\) = {.*/\1/p' "$dir/$1_$s.c")
    # Scenes with different effects have different models of one name: rename them, to link all into one program.
    # shellcheck disable=SC2086
    $CC -std=c11 "${LAGC_OPTIMISE:--O1}" -ffp-contract=off ${SAN:-} -I"$INC" "-D$model=${model}__$s" -c "$dir/$1_$s.c" -o "$dir/$1_$s.o" || return 1
    objects="$objects $dir/$1_$s.o"
    declared="$declared $symbol,"
    listed="$listed &$symbol,"
  done
  echo "#include \"lag.h\"
extern const lag_scene ${declared%,};
extern const lag_scene *const facts_scenes[];
const lag_scene *const facts_scenes[] = {$listed NULL};" >"$dir/$1_scenes.c"
  # shellcheck disable=SC2086
  $CC -std=c11 ${SAN:-} -I"$INC" "$dir/$1_scenes.c" "$dir/facts.o" $objects "$BUILD/liblag.a" $gsl_libs -lm -o "$dir/$1"
}

for facts in models/*.facts; do
  name=$(basename "$facts" .facts)
  case " ${*:-$name} " in *" $name "*) ;; *) continue ;; esac
  [ $# -gt 0 ] || one_of 20 || continue
  if build "$name" "$facts" 2>"$dir/err"; then relay "$dir/$name" "$name" "$facts"; else empty "$name: its scenes compile" "$(cat "$dir/err")"; fi
done

# Every model has its facts, and its hand-written equations are proved; every fact below is wrong.
for lag in models/*.lag; do
  check "$lag has facts" test -f "${lag%.lag}.facts"
  one_of 8 && check "$lag: its expectations are proved" "$LAGC" check "$lag"
done
cat >"$dir/wrong.facts" <<'WRONG'
free      | x(0) = 2                        | 1e-3 | another start
free      | period(x) = 2*pi*sqrt(k/m)      | 1e-3 | upside down
free      | x(20) = cos(20*2) + 2e-9        | 1e-9 | more than the tolerance off
free      | drift(x) = 0                    | 1e-3 | it moves
free      | max(x') = 1.9                   | 1e-3 | 2
free      | x(0) = sqrt(-1)                 | 1e-3 | no number
free      | x(21) = y(21)                   | 1e-3 | no such name
free      | x(1) = cos(2*1) 3               | 1e-3 | not an expression
free k=-1 | x(0) = 1                        | 1e-3 | not allowed
free      | x(0) = 1                        | 1e-3 |
WRONG
all_wrong() {
  build spring "$dir/wrong.facts" || return 1
  "$dir/spring" spring "$dir/wrong.facts" >"$dir/out"
  [ $? = 1 ] && [ "$(grep -c '^not ok' "$dir/out")" = 10 ] || { sed 's/^/| /' "$dir/out"; return 1; }
}
check "wrong facts fail" all_wrong
tap_end
