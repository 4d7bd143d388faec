#!/bin/sh
# Emitted files of each model of the gallery have not changed: emitted.txt has a line each,
#   CODE TEXT MODEL COMMAND      checksums of the C without comments, and of the whole file; of other files the second only
# To see whether a change was meant:
#   KEEP=FOLDER sh tests/golden/run_emitted.sh      keeps the files, to compare two versions (diff -r)
#   BLESS=1 sh tests/golden/run_emitted.sh          writes emitted.txt anew, on purpose
. tests/tap.sh
KEEP=${KEEP:-$TMP/kept}
mkdir -p "$KEEP"

sum() { cksum | cut -d ' ' -f 1; }
code() { "$CC" -fpreprocessed -dD -E -P -x c - 2>/dev/null; } # without comments
write() { # MODEL KIND COMMAND...: a line of emitted.txt
  model=$1 kind=$2
  shift 2
  text=$KEEP/$(basename "$model" .lag).$(echo "$*" | tr -d ' -')
  "$LAGC" "$@" "$model" >"$text" 2>&1
  case $kind in
  c) code=$(code <"$text" | sum) ;;
  text) code=- ;;
  esac
  echo "$code $(sum <"$text") $model $*"
}
# `make test` has one model of three, and of these one of three with Taylor coefficients.
# `make test-long` has half of them, with all texts.
all=${BLESS:-}$(depth "" "" yes)
more=${BLESS:-}$(depth "" yes yes)
models=
for m in models/*.lag; do
  { [ -n "$all" ] || one_of 3; } && models="$models $m"
done
for m in $models; do
  taylor=$more
  [ -n "$more" ] || { one_of 3 && taylor=yes; }
  for words in ${taylor:+"emit --method taylor"} header ${more:+emit "emit --method variational --with linear" "emit --method radau" "emit --fix all" "derive --format c"}; do
    # shellcheck disable=SC2086 # some words
    write "$m" c $words
  done
  for words in derive ${more:+"derive --format latex" "derive --hamiltonian"}; do
    # shellcheck disable=SC2086
    write "$m" text $words
  done
done >"$TMP/emitted"
if [ -n "${BLESS:-}" ]; then cp "$TMP/emitted" tests/golden/emitted.txt; fi
for m in $models; do
  grep -F " $m " "$TMP/emitted" | LC_ALL=C sort -k 3 >"$TMP/got"
  grep -F " $m " tests/golden/emitted.txt | awk 'NR == FNR { made[substr($0, index($0, "models/"))] = 1; next } made[substr($0, index($0, "models/"))]' "$TMP/got" - | LC_ALL=C sort -k 3 >"$TMP/want"
  empty "$m" "$(diff "$TMP/want" "$TMP/got" | grep '^[<>]')"
done
tap_end
