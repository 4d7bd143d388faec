#!/bin/sh
# The pictures of models/README.md agree with the commands above them (`make gallery` draws them anew). Numbers may differ by
# half a pixel, since C libraries and processors round differently; curves may have other points, if none is farther than that
# from the other curve. Text may not differ. The commands on the page work.
. tests/tap.sh

# A picture without its curves as a list: each number, and each text between numbers, on a line of its own.
parts() { grep -v '^<path fill="none"' "$1" | sed 's/-\{0,1\}[0-9][0-9.]*/\
&\
/g'; }
# The points of each curve, a line each: curve X Y; curve "gap" where a piece begins
points() { grep '^<path fill="none"' "$1" | sed 's/.* d="//; s/".*//; s/M/ gap /g; s/[Lh]/ /g' |
  awk '{ for (i = 1; i <= NF; i++) if ($i == "gap") print NR, "gap"; else { print NR, $i, $(i + 1); i++ } }'; }
same_picture() {
  parts "$1" >"$TMP/kept"
  parts "$2" >"$TMP/fresh"
  [ "$(wc -l <"$TMP/kept")" = "$(wc -l <"$TMP/fresh")" ] || { echo "$1 has other texts: make gallery"; return 1; }
  paste "$TMP/kept" "$TMP/fresh" | awk -F '\t' '
    $1 == $2 { next }
    $1 ~ /^-?[0-9.]+$/ && $2 ~ /^-?[0-9.]+$/ && $1 - $2 <= 0.5 && $2 - $1 <= 0.5 { next }
    { print "line " NR ": " $1 " became " $2 ": make gallery"; exit 1 }' || return 1
  points "$1" >"$TMP/kept"
  points "$2" >"$TMP/fresh"
  cmp -s "$TMP/kept" "$TMP/fresh" || { strays "$TMP/kept" "$TMP/fresh" && strays "$TMP/fresh" "$TMP/kept"; }
}
# strays FROM TO: whether no point of FROM is farther than half a pixel from the same curve of TO. The search for the nearest piece
# begins where it ended for the point before.
strays() {
  awk '
    FNR == NR { at[$1, n[$1]++] = $2 == "gap" ? "gap" : $2 " " $3; next }
    $2 != "gap" {
      for (k = 0; k < n[$1]; k++) if (near($1, (start[$1] + k) % n[$1], $2, $3)) { start[$1] = (start[$1] + k) % n[$1]; next }
      print "curve " $1 ": " $2 " " $3 " is off: make gallery"
      exit 1
    }
    function near(c, k, x, y,   p, q, dx, dy, f, t) {
      if (at[c, k] == "gap") return 0
      split(at[c, k], p, " ")
      if (k + 1 < n[c] && at[c, k + 1] != "gap") split(at[c, k + 1], q, " "); else { q[1] = p[1]; q[2] = p[2] }
      dx = q[1] - p[1]; dy = q[2] - p[2]; t = dx*dx + dy*dy
      f = t > 0 ? ((x - p[1])*dx + (y - p[2])*dy)/t : 0
      f = f < 0 ? 0 : f > 1 ? 1 : f
      dx = x - p[1] - f*dx; dy = y - p[2] - f*dy
      return dx*dx + dy*dy <= 0.25
    }' "$2" "$1"
}
# Level curves and sections of many points are the largest.
small() { [ "$(wc -c <"$1")" -lt 150000 ] && tail -n 1 "$1" | grep -qx '</svg>'; }

sed -n -e 's/^Drawn by `build\/lagc \(.*\) \(-o\) \(.*\)`:$/\3 \2 \1/p' -e 's/^Drawn by `build\/lagc \(.*\) \(--svg\) \(.*\)`:$/\3 \2 \1/p' models/README.md >"$TMP/list"
check "there is a gallery" [ -s "$TMP/list" ]
while read -r picture to words; do
  one_of 20 && light "$picture" || continue
  check "$picture is drawn" sh -c "$LAGC $words $to $TMP/new.svg --quiet"
  check "$picture is up to date" same_picture "$picture" "$TMP/new.svg"
  check "$picture is small and whole" small "$picture"
  check "$picture is shown" grep -q -F "](${picture#models/})" models/README.md
done <"$TMP/list"

case $LAGC in /*) lagc=$LAGC ;; *) lagc=$(pwd)/$LAGC ;; esac
ln -s "$(pwd)/models" "$TMP/models"
sed -n 's/^lagc //p' models/README.md | grep -v NAME >"$TMP/commands"
while read -r words; do
  one_of 30 && light "$words" || continue
  case $words in action* | check* | derive* | fit* | modes*) quiet= ;; *) quiet=--quiet ;; esac
  status=0
  case $words in *painleve_rod.lag*mu=1.34) status=3 ;; esac # it shows the message
  check "lagc $words" sh -c "cd $TMP && $lagc $words $quiet; [ \$? = $status ]"
done <"$TMP/commands"
tap_end
