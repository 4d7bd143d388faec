#!/bin/sh
# The pictures of models/README.md are what the commands above them draw (`make gallery` draws them anew). Numbers may differ by
# half a pixel: another C library, or another processor, rounds other digits. Text and the number of points may not.
# The commands that the page tells its readers to type work.
. tests/tap.sh

# A picture as a list: each number, and each text between numbers, on a line of its own.
parts() { sed 's/-\{0,1\}[0-9][0-9.]*/\
&\
/g' "$1"; }
same_picture() {
  parts "$1" >"$TMP/kept"
  parts "$2" >"$TMP/fresh"
  [ "$(wc -l <"$TMP/kept")" = "$(wc -l <"$TMP/fresh")" ] || { echo "$1 has other points or texts: make gallery"; return 1; }
  paste "$TMP/kept" "$TMP/fresh" | awk -F '\t' '
    $1 == $2 { next }
    $1 ~ /^-?[0-9.]+$/ && $2 ~ /^-?[0-9.]+$/ && $1 - $2 <= 0.5 && $2 - $1 <= 0.5 { next }
    { print "line " NR ": " $1 " became " $2 ": make gallery"; exit 1 }'
}
small() { [ "$(wc -c <"$1")" -lt 30000 ] && tail -n 1 "$1" | grep -qx '</svg>'; }

sed -n 's/^<!-- drawn by: build\/lagc \(.*\) -o \(.*\) -->$/\2 \1/p' models/README.md >"$TMP/list"
check "there is a gallery" [ -s "$TMP/list" ]
while read -r picture words; do
  check "$picture is drawn" sh -c "$LAGC $words -o $TMP/new.svg --quiet"
  check "$picture is up to date" same_picture "$picture" "$TMP/new.svg"
  check "$picture is small and whole" small "$picture"
  check "$picture is shown" grep -q -F "](${picture#models/})" models/README.md
done <"$TMP/list"

case $LAGC in /*) lagc=$LAGC ;; *) lagc=$(pwd)/$LAGC ;; esac
ln -s "$(pwd)/models" "$TMP/models"
sed -n 's/^lagc //p' models/README.md | grep -v NAME >"$TMP/commands"
while read -r words; do
  case $words in check* | derive* | modes*) quiet= ;; *) quiet=--quiet ;; esac
  check "lagc $words" sh -c "cd $TMP && $lagc $words $quiet"
done <"$TMP/commands"
tap_end
