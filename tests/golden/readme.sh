#!/bin/sh
# README.md, models/README.md and models/TUTORIAL.md show output of commands: a block after `<!-- printed by: COMMAND -->` is that
# command's output, to the byte. README and the tutorial are followed in folders of their own: a block after `<!-- file: NAME -->` is such a
# file, one after `<!-- added to: NAME -->` goes to its end, and one after `<!-- session -->` has commands after `$ ` and their
# output, where numbers may differ in the last digits, and times at will. BLESS=1 rewrites blocks. Their links, and those of
# src/README.md, CONTRIBUTING.md and grammar/, lead to files.
. tests/tap.sh

# kept_block K PAGE: the block below the K-th `printed by`
kept_block() { awk -v k="$1" '/^<!-- printed by: / { i++ } /^```/ { if (i == k) n++; next } i == k && n == 1' "$2"; }
shows() { # shows PAGE
  page=$1
  fresh=$TMP/fresh.md
  rm -rf "$TMP/blocks"
  mkdir -p "$TMP/blocks"
  sed -n 's/^<!-- printed by: \(.*\) -->$/\1/p' "$page" >"$TMP/commands"
  n=0
  while read -r command; do
    n=$((n + 1))
    case ${GSL:-}$command in
    build/lagc\ modes*) # without GSL the block stays as it is
      skip "$command" "GSL is not installed"
      kept_block "$n" "$page" >"$TMP/blocks/$n"
      continue ;;
    esac
    case ${SLOW:-}${BLESS:-}$command in
    build/lagc\ effects*--accuracy* | build/lagc\ modes*bicycle*) # 2 s and 6 s, in `make test-long`
      kept_block "$n" "$page" >"$TMP/blocks/$n"
      continue ;;
    esac
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
shows models/TUTORIAL.md

# ---- sessions ----
case $LAGC in /*) tools=$(dirname "$LAGC") ;; *) tools=$(pwd)/$(dirname "$LAGC") ;; esac
session() { # a session's block on standard input -> the block with the present output
  while IFS= read -r line; do
    case $line in
      '$ '*)
        printf '%s\n' "$line"
        (cd "$TMP/lesson" && PATH=$tools:$PATH sh -c "${line#??}") 2>&1 </dev/null
        ;;
    esac
  done
}
# Line by line, word by word; numbers within 1e-6, text behind "right-hand sides N," at will.
same_session() {
  sed 's/\(right-hand sides [0-9]*\), .*/\1/' "$1" >"$TMP/a"
  sed 's/\(right-hand sides [0-9]*\), .*/\1/' "$2" >"$TMP/b"
  awk -v other="$TMP/b" '
    function number(s) { return s ~ /^-?[0-9][0-9.]*(e[-+]?[0-9]+)?,?$/ }
    function same(a, b) { return a == b || (number(a) && number(b) && (a - b) <= 1e-6*(1 + a*a)^0.5 && (b - a) <= 1e-6*(1 + a*a)^0.5) }
    {
      if ((getline line <other) <= 0) { print "missing: " $0; exit 1 }
      n = split($0, a, " "); m = split(line, b, " ")
      for (i = 1; i <= n || i <= m; i++) if (!same(a[i], b[i])) { print "page:   " $0; print "now:    " line; exit 1 }
    }
    END { if ((getline line <other) > 0) { print "now, too: " line; exit 1 } }' "$TMP/a"
}
follows() { # follows PAGE
  page=$1
  rm -rf "$TMP/lesson" "$TMP/steps"
  mkdir -p "$TMP/lesson" "$TMP/steps"
  ln -s "$(pwd)/models" "$TMP/lesson/models"
  ln -s "$tools" "$TMP/lesson/build"
  # steps/NN.KIND, and for a file its name in steps/NN.name
  awk -v dir="$TMP/steps/" '
    /^<!-- (file|added to): .* -->$/ { kind = $2 == "file:" ? "file" : "added"; name = $0; sub(/^[^:]*: /, "", name); sub(/ -->$/, "", name); next }
    /^<!-- session -->$/ { kind = "session"; next }
    kind && /^```/ {
      if (out) { close(out); out = kind = ""; next }
      n++
      out = sprintf("%s%02d.%s", dir, n, kind)
      if (kind != "session") { print name >sprintf("%s%02d.name", dir, n); close(sprintf("%s%02d.name", dir, n)) }
      next
    }
    out { print >out }' "$page"
  for step in "$TMP"/steps/*; do
    base=${step%.*}
    case $step in
      *.file) cp "$step" "$TMP/lesson/$(cat "$base.name")" ;;
      *.added) cat "$step" >>"$TMP/lesson/$(cat "$base.name")" ;;
      *.session)
        session <"$step" >"$base.now"
        [ -n "$BLESS" ] || check "$page: $(sed -n 's/^\$ //p' "$step" | paste -s -d ';' -)" same_session "$step" "$base.now"
        if same_session "$step" "$base.now" >/dev/null; then cp "$step" "$base.now"; fi
        ;;
    esac
  done
  if [ -n "$BLESS" ]; then
    awk -v dir="$TMP/steps/" '
      /^<!-- (file|added to): .* -->$/ || /^<!-- session -->$/ { print; kind = $2; next }
      kind && /^```/ && !inside {
        print
        n++
        inside = 1
        while (kind == "session" && (getline line <sprintf("%s%02d.now", dir, n)) > 0) print line
        next
      }
      inside && /^```/ { inside = 0; kind = "" }
      inside && kind == "session" { next }
      { print }' "$page" >"$TMP/blessed.md"
    cmp -s "$TMP/blessed.md" "$page" || cp "$TMP/blessed.md" "$page"
  fi
}
follows README.md
[ -n "$BLESS" ] || check "README leaves a picture" [ -s "$TMP/lesson/motion.svg" ]
follows models/TUTORIAL.md
made() { [ -s "$TMP/lesson/orbit.svg" ] && tail -n 1 "$TMP/lesson/double.html" | grep -q '</html>'; }
check "the tutorial leaves a picture and an animation" made

links() {
  for page in README.md src/README.md models/README.md models/TUTORIAL.md .github/CONTRIBUTING.md grammar/*.md; do
    sed 's/`[^`]*`//g' "$page" | grep -o ']([^)#]*)' | sed 's/^](//; s/)$//' | while read -r link; do
      case $link in *://*) continue ;; esac
      [ -e "$(dirname "$page")/$link" ] || echo "$page: no $link"
    done
  done
}
empty "links lead to files" "$(links)"
tap_end
