#!/bin/sh
# The signposts are true: each folder of sources has a README, whose links lead somewhere and whose files exist; each .c and .h begins with a comment.
. tests/tap.sh

folders=$(find src runtime tests models -type f -name '*.[ch]' -o -type f -name '*.lag' | sed 's|/[^/]*$||' | LC_ALL=C sort -u | grep -v -e '^tests/' -e '^runtime/include$')
empty "each folder has a README" "$(for d in src runtime tests $folders; do [ -f "$d/README.md" ] || echo "$d"; done)"

pages=$(find . -name '*.md' -not -path './build/*' -not -path './.git/*' | LC_ALL=C sort)
# shellcheck disable=SC2086 # a list of files
empty "links of pages lead to files" "$(grep -Ho ']([^)#]*[)#]' $pages | sed 's/:](/ /; s/[)#]$//' | while read -r f l; do
  case $l in http* | '' | [0-9]*) ;; *) [ -e "${f%/*}/$l" ] || echo "$f: $l" ;; esac
done)"

# Sentences begin with their noun; only beginnings that never have one are looked for.
empty "no sentence of a page begins with That of, Those that, Of what, What no, What an" \
  "$(grep -nE '(^|[.] |[|] |- )(That of|Those that|Of what|What no|What an)( |$)' $pages)"

find src runtime tests grammar -type f | sed 's|.*/||' | LC_ALL=C sort -u >"$TMP/names"
printf '%s\n' math.h stddef.h stdio.h >>"$TMP/names"
empty "files that READMEs of sources name exist" "$(for f in src/README.md src/*/README.md runtime/README.md runtime/*/README.md tests/README.md; do
  grep -oE '(^|[^a-zA-Z0-9_{}-])[a-z_0-9]+\.[ch]\b' "$f" | grep -oE '[a-z_0-9]+\.[ch]$' | LC_ALL=C sort -u | grep -vxFf "$TMP/names" | sed "s|^|$f: |"
done)"

empty "the README of a folder names each of its .c files" "$(find src runtime -mindepth 2 -name '*.c' | LC_ALL=C sort | awk '
  {
    folder = name = $0; sub(/\/[^\/]*$/, "", folder); sub(/.*\//, "", name); sub(/\.c$/, "", name)
    if (!(folder in text)) while ((getline line <(folder "/README.md")) > 0) text[folder] = text[folder] " " line " "
    if (text[folder] !~ "[^a-z0-9_]" name "[^a-z0-9_]") print
  }')"

# ---- a course of mechanics, from energy to chaos: each of its topics and systems has models, which the table of models/README.md names; .ci/site, too
sed -n '/^## By topic/,/^## Three/p' models/README.md >"$TMP/topics"
without_model() {
  while IFS='|' read -r topic models; do
    for m in $models; do
      { [ -f "models/$m.lag" ] && [ -f "models/$m.facts" ]; } || echo "$topic: there is no model $m"
      grep -qF "[$m]($m.lag)" "$TMP/topics" || echo "$topic: the table does not name $m"
    done
  done
}
empty "each topic of the course has its models" "$(without_model <models/course.txt)"

names_of() { grep -hoE '^[a-z_]+[(][)]' "$@" | LC_ALL=C sort; }
names_of tests/tap.sh >"$TMP/tap"
empty "functions of tap.sh have one meaning in all files that suites include" "$(for f in tests/*/lib_*.sh; do names_of "$f" | LC_ALL=C comm -12 - "$TMP/tap" | sed "s|^|$f: |"; done)"

empty "no line of C above 120 columns" "$(find src runtime tests grammar -name '*.[chl]' -exec awk 'length($0) > 120 { print FILENAME ":" FNR }' {} +)"
empty "no function of sources above 45 lines" "$(find src runtime -name '*.[ch]' -exec awk '
  FNR == 1 || /^}/ { if (first && FNR - first > 44) print FILENAME ":" first; first = 0 }
  /^[a-zA-Z_].*\(/ && !/;$/ && !/^(typedef|struct|enum|union)/ { first = FNR }
  /^[^ }].*;$/ { first = 0 }' {} +)"
empty "no file of sources above 600 lines" "$(find src runtime -name '*.[ch]' -exec awk 'FNR == 601 { print FILENAME }' {} +)"
empty "each file of sources begins with a comment" "$(find src runtime -name '*.[ch]' -exec awk 'FNR == 1 && !/^\/\*/ { print FILENAME }' {} +)"
tap_end
