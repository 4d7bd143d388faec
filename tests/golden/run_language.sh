#!/bin/sh
# The examples of grammar/LANGUAGE.md and PHASE_SPACE.md: a block that begins with `model` passes `lagc check`, every other one parses. A block of
# data, ```csv NAME or ```json NAME, is a file beside them. The list of commands and options in LANGUAGE.md is `lagc manpage markdown`; BLESS=1 writes it.
. tests/tap.sh
pages="grammar/LANGUAGE.md grammar/PHASE_SPACE.md"
# shellcheck disable=SC2086 # two pages
awk -v dir="$TMP" '
  /^```lag$/ { file = sprintf("%s/%02d.lag", dir, ++n); next }
  /^```(csv|json) / { file = dir "/" $2; next }
  /^```$/ { file = ""; next }
  file { print > file }' $pages
for f in "$TMP"/*.lag; do
  first=$(head -n 1 "$f")
  case $first in
    model*) check "checks: $first" "$LAGC" check "$f" ;;
    *) check "parses: $first" "$BIN/dump_syntax" "$f" ;;
  esac
done
for page in $pages; do check "$page has models" [ "$(grep -c '^model ' "$page")" -gt 4 ]; done

"$LAGC" manpage markdown >"$TMP/commands"
awk -v commands="$TMP/commands" '
  /^<!-- end of what is generated/ { while ((getline line <commands) > 0) print line; print ""; inside = 0 }
  !inside
  /^<!-- generated: `lagc manpage/ { print ""; inside = 1 }' grammar/LANGUAGE.md >"$TMP/language.md"
if [ -n "${BLESS:-}" ]; then cp "$TMP/language.md" grammar/LANGUAGE.md; fi
check "commands and options are those of the tables" diff -u grammar/LANGUAGE.md "$TMP/language.md"
said() { grep -o -e '^- `--[a-z-]*' -e '^- `-.`, `--[a-z-]*' "$TMP/language.md" | sed 's/.*`//' | sort -u; }
"$BIN/dump_words" | sed -n 's/^\(option\|passed\) [a-z]* \(--.*\)/\2/p' | grep -v -x -e --help | sort -u >"$TMP/options"
is "each option of the parser stands there" "$(cat "$TMP/options")" "$(said)"
tap_end
