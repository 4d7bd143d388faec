#!/bin/sh
# Derived parameters: values that depend on parameters alone, also the factors of a constant mass matrix, are computed when parameters change. Prints TAP.
cd "$(dirname "$0")/../.." || exit 2
. tests/tap.sh
model=tests/exec/models/windings.lag elements=tests/exec/models/elements.lag

# --- M without declared signs: 2 coordinates by Cramer's rule, more by a loop at each call
emitted() { "$LAGC" emit "$model" -DN="$1" -o "$TMP/windings.c"; }
solves() { # N OPTIONS...: the equations hold, for parameters that change from turn to turn
  emitted "$1" || return 1
  shift
  # shellcheck disable=SC2086 # lists of words
  $CC -std=gnu11 -Wall -Wextra -Wno-psabi -Werror -O1 ${SAN:-} -DSCENE=windings_ring "$@" -I"$INC" tests/exec/derived.c "$TMP/windings.c" -lm -o "$TMP/derived" && "$TMP/derived"
}
for n in 2 3 ${SLOW:+40}; do
  check "$n windings: M a = f, and not with what was derived from other parameters" solves $n
  check "$n windings: so over 4 lanes" solves $n -DLAG_LANES=4
done
# three diagonals: factors made once by a loop, and read by loops
three() {
  n=$1
  shift
  # shellcheck disable=SC2086 # lists of words
  "$LAGC" emit $elements -DN=$n -o "$TMP/elements.c" &&
    $CC -std=gnu11 -Wall -Wextra -Wno-psabi -Werror -O1 ${SAN:-} -DELEMENTS -DSCENE=elements_pluck "$@" -I"$INC" tests/exec/derived.c "$TMP/elements.c" -lm -o "$TMP/derived" && "$TMP/derived"
}
for n in 2 20 ${SLOW:+2000}; do
  check "$n elements: M a = f" three $n
  check "$n elements: so over 4 lanes" three $n -DLAG_LANES=4
done
slow check "2000 elements: one division a call is left, and the text is short" eval 'grep "Accelerations: .* 1 division\." "$TMP/elements.c" && [ "$(wc -c <"$TMP/elements.c")" -lt 25000 ]'
# --- the user's values reach derived parameters: by name, by text and by --fix a run is the same
changed() { sed 's/k = 0\.4/k = 0.3/' "$model" >"$TMP/changed.lag" && "$LAGC" run "$TMP/changed.lag" -DN=5; }
end_of() { sed -n '/^  x/p'; }
is "k=0.3 at the command line is k = 0.3 in the text" "$(changed | end_of)" "$("$LAGC" run "$model" -DN=5 k=0.3 | end_of)"
check "and not what k = 0.4 gives" test "$(changed | end_of)" != "$("$LAGC" run "$model" -DN=5 | end_of)"

# --- so they do where an effect is left out: another program, with derived parameters of its own
{ cat "$model"; printf 'effect loss { param R = 3 [ohm]; dissipation = R/2*sum(i in 1..N, x[i]'"'"'^2) }\nscene lossy { like ring; use loss }\n'; } >"$TMP/lossy.lag"
sed 's/k = 0\.4/k = 0.3/' "$TMP/lossy.lag" >"$TMP/lossy_changed.lag"
makes() { "$LAGC" effects --json "$@" | sed -n 's/.*"weight": \([^,]*\), "difference": \([^,]*\),.*/\1 \2/p'; }
is "what an effect makes with k=0.3 at the command line is that with k = 0.3 in the text" "$(makes "$TMP/lossy_changed.lag" lossy)" "$(makes "$TMP/lossy.lag" lossy k=0.3)"
{ grep -v '^param\|^scene' "$TMP/lossy.lag" | sed '/^lagrangian/d'; grep '^param\|^lagrangian\|^scene' "$TMP/lossy.lag"; } | sed 's/use loss }/use loss; k = loss.R*0.1 [s] }/' >"$TMP/lossy_made.lag"
is "so it is where the scene makes k of a parameter of the effect" "$(makes "$TMP/lossy_changed.lag" lossy)" "$(makes "$TMP/lossy_made.lag" lossy)"
check "and not that with k = 0.4" test "$(makes "$TMP/lossy_changed.lag" lossy)" != "$(makes "$TMP/lossy.lag" lossy)"

# --- eigenvalues 1 - k/2, ...: with k = 2 the matrix of three is singular
singular() { "$LAGC" run "$model" -DN=3 k=2 >"$TMP/report"; [ $? = 3 ] && grep -qF 'the mass matrix is singular' "$TMP/report"; }
check "a singular matrix is said" singular
# --- forces that are negative sums: no unused instruction is left
cat >"$TMP/signs.lag" <<'END'
model signs "Forces that are negative sums, a mass matrix of numbers"
param m = 2, c = 1/2
coord x[3]
kinetic = m/2*(x[1]'^2 + x[2]'^2 + x[3]'^2) + c*(x[1]'*x[2]' + x[2]'*x[3]')
potential = x[1]^2*x[2] + x[2]^2*x[3] + x[3]^2*x[1]
scene s { start x = 1; span 1 }
END
clean() { "$LAGC" emit "$TMP/signs.lag" --fix all -o "$TMP/signs.c" && $CC -std=c99 -Wall -Wextra -Wpedantic -Werror -I"$INC" -c "$TMP/signs.c" -o "$TMP/signs.o"; }
check "negative forces: no warning of what is not used" clean
# --- designators in the order of lag_model.h, as C++ wants them
if command -v "${CXX:-c++}" >/dev/null; then
  in_order() { "$LAGC" emit "$1" --method variational --with linear $2 -o "$TMP/order.cpp" && "${CXX:-c++}" -std=c++20 -w -I"$INC" -c "$TMP/order.cpp" -o "$TMP/order.o"; }
  check "a model with derived parameters is C++, too" in_order "$model"
  check "so is one without, whose parameters are numbers" in_order "$TMP/signs.lag" '--fix all'
else
  skip "no C++ compiler"
fi
tap_end
