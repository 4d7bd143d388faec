#!/bin/sh
# Every single-edit mutant of hand-written accelerations (tests/unit/mutate.c makes and judges them): each is refuted, or
# proved where it happens to be equivalent, and the caret of the message lies on the edit in at least nine of ten.
. tests/tap.sh

# mutants MODEL TOTAL EQUIVALENT: counts, which change only with the model or the kinds of edits.
mutants() {
  model=tests/exec/models/mutants_$1.lag
  "$BIN/mutate" "$model" >"$TMP/$1" 2>&1
  status=$?
  sed 's/^[^#]/# &/' "$TMP/$1"
  # N mutants: N refuted by proof, N by units, N equivalent and proved, N not decided, N broken; caret on the edit in N of N, ...
  set -- "$1" "$2" "$3" $(tail -n 1 "$TMP/$1" | tr -c '0-9\n' ' ')
  check "$1: the expectations themselves are proved" "$LAGC" check "$model"
  is "$1: mutants made" "$2" "$4"
  is "$1: exit status" 0 "$status"
  is "$1: equivalent, and proved" "$3" "$7"
  is "$1: neither refuted nor proved" "0 0" "$8 $9"
  is "$1: refuted by proof" $(($2 - $3)) "$5"
  shift 9
  check "caret on the edit in $1 of $2: nine of ten" [ "$(($1 * 10))" -ge "$(($2 * 9))" ]
}

slow mutants double_pendulum 299 1
mutants cart_pendulum 68 4
# A term of an argument, as one of the double pendulum's mutants has it.
sed '18s/cos(2\*th1-2\*th2)/cos(2*th1-2*l2)/' tests/exec/models/mutants_double_pendulum.lag >"$TMP/term.lag"
check "a wrong term of an argument" says 1 '`2*l2` should be `2*th2`' "$LAGC" check "$TMP/term.lag"
tap_end
