#!/bin/sh
# The examples of grammar/LANGUAGE.md: a block that begins with `model` passes `lagc check`, every
# other one parses. A block of data, ```csv NAME, is a file beside them.
. tests/tap.sh
awk -v dir="$TMP" '
  /^```lag$/ { file = sprintf("%s/%02d.lag", dir, ++n); next }
  /^```csv / { file = dir "/" $2; next }
  /^```$/ { file = ""; next }
  file { print > file }' grammar/LANGUAGE.md
for f in "$TMP"/*.lag; do
  first=$(head -n 1 "$f")
  case $first in
    model*) check "checks: $first" "$LAGC" check "$f" ;;
    *) check "parses: $first" "$BIN/dump_syntax" "$f" ;;
  esac
done
check "the page has its examples" [ "$tap_n" -gt 10 ]
tap_end
