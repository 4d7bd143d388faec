#!/bin/sh
# README.md and models/README.md show what commands print: a block after `<!-- printed by: COMMAND -->` is that command's
# output, to the byte. BLESS=1 writes it. Their links, and those of
# src/README.md and grammar/LANGUAGE.md, lead to files.
. tests/tap.sh

shows() { # shows PAGE
  page=$1
  fresh=$TMP/fresh.md
  rm -rf "$TMP/blocks"
  mkdir -p "$TMP/blocks"
  sed -n 's/^<!-- printed by: \(.*\) -->$/\1/p' "$page" >"$TMP/commands"
  n=0
  while read -r command; do
    n=$((n + 1))
    command=$(printf '%s\n' "$command" | sed "s|build/lagc|$LAGC|g")
    check "$command" sh -c "$command"
    cp "$TMP/tap_output" "$TMP/blocks/$n"
  done <"$TMP/commands"

  awk -v blocks="$TMP/blocks/" '
    /^<!-- printed by: / { print; n++; due = 1; next }
    due && /^```/ {
      print
      while ((getline line < (blocks n)) > 0) print line
      due = 0; inside = 1; next
    }
    inside && !/^```/ { next }
    { inside = 0; due = 0; print }' "$page" >"$fresh"

  if [ -n "$BLESS" ] && [ "$tap_bad" = 0 ]; then cp "$fresh" "$page"; fi
  check "$page shows what the commands print" diff -u "$page" "$fresh"
}
shows README.md
shows models/README.md

links() {
  for page in README.md src/README.md models/README.md grammar/LANGUAGE.md; do
    grep -o ']([^)#]*)' "$page" | sed 's/^](//; s/)$//' | while read -r link; do
      case $link in *://*) continue ;; esac
      [ -e "$(dirname "$page")/$link" ] || echo "$page: no $link"
    done
  done
}
empty "links lead to files" "$(links)"
tap_end
