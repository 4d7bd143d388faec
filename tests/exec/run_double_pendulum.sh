#!/bin/sh
# models/double_pendulum.lag, three ways.
#   1. the emitted accelerations against hand-written ones (double_pendulum.c) at 100,000 states;
#   2. the same with one sign, or sin for cos, changed in the emitted C, for every place there is: nine of ten must be noticed
#      (the text may hold terms that cancel, whose signs do not matter; those not noticed are shown);
#   3. the run from 90/90 degrees by rk45 at tolerance 1e-10 against one by GSL's rk8pd: 1e-7 at t = 10 in every coordinate.
. tests/tap.sh
dir=$TMP
warn='-std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror'
# shellcheck disable=SC2086 # lists of words
compile() { $CC $warn -O1 -ffp-contract=off ${SAN:-} -I"$INC" "$@"; }

# --- 1. by hand
"$LAGC" emit models/double_pendulum.lag -o "$dir/model.c" || exit 1
if echo '#include <quadmath.h>
int main(void) { return sinq(0.0Q) != 0; }' >"$dir/try.c" && $CC "$dir/try.c" -o "$dir/try" -lquadmath 2>/dev/null; then
  compile -c tests/exec/double_pendulum.c -o "$dir/judge.o" && compile "$dir/model.c" "$dir/judge.o" -lquadmath -lm -o "$dir/check" ||
    { echo "Bail out! the check does not compile"; exit 1; }
  relay "$dir/check"

  # --- 2. one mistake at a time, in the text of derive and accel without its comments
  sed -e 's|/\*[^*]*\*/||g' "$dir/model.c" >"$dir/plain.c"
  first=$(grep -n '^static void derive(' "$dir/plain.c" | cut -d: -f1)
  last=$(sed -n "$first,\$p" "$dir/plain.c" | grep -n '^}' | sed -n 2p | cut -d: -f1)
  awk -v first="$first" -v last="$((first + last - 1))" -v dir="$dir" '
    { line[NR] = $0 }
    END {
      split(" - | + |cos|sin|(-|lag_sincos2(|, th2, ", from, "|")
      split(" + | - |sin|cos|(|lag_sincos2(-|, -th2, ", to, "|")
      for (i = first; i <= last; i++)
        for (k = 1; k <= 7; k++) {
          if (from[k] ~ /^(cos|sin)$/ && line[i] !~ /LAG_FN/) continue
          for (at = 1; (p = index(substr(line[i], at), from[k])) > 0; at += p + length(from[k]) - 1) {
            where = at + p - 1
            if (from[k] ~ /^(cos|sin)$/ && substr(line[i], where - 7, 7) != "LAG_FN(") continue
            file = sprintf("%s/mutant_%03d.c", dir, ++mutants)
            for (j = 1; j <= NR; j++)
              if (j != i) print line[j] > file
              else print substr(line[i], 1, where - 1) to[k] substr(line[i], where + length(from[k])) > file
            close(file)
          }
        }
    }' "$dir/plain.c"
  mutants=0
  unseen='' missed=0
  for m in "$dir"/mutant_*.c; do
    [ -f "$m" ] || continue
    mutants=$((mutants + 1))
    # shellcheck disable=SC2086
    $CC -std=c11 -O0 -w -I"$INC" "$m" "$dir/judge.o" -lquadmath -lm -o "$dir/mutant" || { missed=$mutants; break; }
    "$dir/mutant" 200 >/dev/null && unseen="$unseen $m" missed=$((missed + 1))
  done
  nine_of_ten() { [ "$mutants" -ge 10 ] && [ $((10*missed)) -le "$mutants" ]; }
  check "of $mutants mistakes planted in the emitted C, $((mutants - missed)) are noticed" nine_of_ten
  for m in $unseen; do diff "$dir/plain.c" "$m" | sed 's/^/# /'; done
else
  skip "the accelerations by hand" "no libquadmath"
fi

# --- 3. GSL's integrator
final() { sed -n 's/.*"final": {\([^}]*\)}.*/\1/p' "$1" | tr ',' '\n' | sed 's/^ *"\(.*\)": /\1 /'; }
swing() { "$LAGC" run models/double_pendulum.lag swing "$@" --json >"$dir/json" && final "$dir/json" >"$dir/final"; }
check "rk45 from 90/90 degrees" swing
if "$LAGC" run models/double_pendulum.lag --method help 2>/dev/null | grep -q gsl-rk8pd; then
  mv "$dir/final" "$dir/a"
  check "gsl-rk8pd from 90/90 degrees" swing --method gsl-rk8pd
  agree() {
    paste "$dir/a" "$dir/final" | awk '{ d = $2 - $4; if (d < 0) d = -d; if ($1 != $3 || !(d <= 1e-7)) bad = 1; print $1 " " $2 " " $4 " differ by " d; seen++ }
      END { exit bad || seen < 4 }'
  }
  check "they agree at t = 10 to 1e-7 in every coordinate" agree
else
  skip "agreement with GSL" "the runtime was built without GSL"
fi
tap_end
