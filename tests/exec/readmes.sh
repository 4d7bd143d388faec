#!/bin/sh
# The signposts are true: each folder of sources has a README, whose links lead somewhere and whose files exist; each .c and .h begins with a comment.
. tests/tap.sh

folders=$(find src runtime tests models -type f -name '*.[ch]' -o -type f -name '*.lag' | sed 's|/[^/]*$||' | LC_ALL=C sort -u | grep -v -e '^tests/' -e '^runtime/include$')
empty "each folder has a README" "$(for d in src runtime tests $folders; do [ -f "$d/README.md" ] || echo "$d"; done)"

pages=$(find . -name '*.md' -not -path './build/*' -not -path './.git/*' | LC_ALL=C sort)
empty "links of pages lead to files" "$(for f in $pages; do
  grep -o ']([^)#]*[)#]' "$f" | sed 's/^](//; s/[)#]$//' | grep -v -e '^http' -e '^$' -e '^[0-9]' | while read -r l; do
    [ -e "$(dirname "$f")/$l" ] || echo "$f: $l"
  done
done)"

# Sentences begin with their noun; only beginnings that never have one are looked for.
empty "no sentence of a page begins with That of, Those that, Of what, What no, What an" \
  "$(grep -nE '(^|[.] |[|] |- )(That of|Those that|Of what|What no|What an)( |$)' $pages)"

find src runtime tests grammar -type f | sed 's|.*/||' | LC_ALL=C sort -u >"$TMP/names"
printf '%s\n' math.h stddef.h stdio.h >>"$TMP/names"
empty "files that READMEs of sources name exist" "$(for f in src/README.md src/*/README.md runtime/README.md runtime/*/README.md tests/README.md; do
  grep -oE '(^|[^a-zA-Z0-9_{}-])[a-z_0-9]+\.[ch]\b' "$f" | grep -oE '[a-z_0-9]+\.[ch]$' | LC_ALL=C sort -u | grep -vxFf "$TMP/names" | sed "s|^|$f: |"
done)"

empty "the README of a folder names each of its .c files" "$(for f in $(find src runtime -mindepth 2 -name '*.c' | LC_ALL=C sort); do
  grep -qE "(^|[^a-z0-9_])$(basename "$f" .c)([^a-z0-9_]|\$)" "$(dirname "$f")/README.md" || echo "$f"
done)"

empty "each file of sources begins with a comment" "$(for f in $(find src runtime -name '*.[ch]' | LC_ALL=C sort); do
  head -n 1 "$f" | grep -q '^/\*' || echo "$f"
done)"
tap_end
