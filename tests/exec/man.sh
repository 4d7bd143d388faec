#!/bin/sh
# The man page, which `lagc manpage` makes of src/lagc.1 and the tables of commands and options: every command and every option that the parser knows
# (dump_words), every variable of the environment that is read, every exit status; and warnings of groff and mandoc.
. tests/tap.sh
page=$TMP/lagc.1
check "it is printed" sh -c '"$LAGC" manpage >"$1"' sh "$page"
check "it has no other form than the list of the reference" sh -c '"$0" manpage html 2>"$1"; [ $? = 2 ] && grep -q "one word too many" "$1"' "$LAGC" "$TMP/err"
"$BIN/dump_words" >"$TMP/words"

has() { grep -q -e "$1" "$page" || echo "lagc.1 lacks $2"; } # has PATTERN WHAT
undocumented() {
  sed -n 's/^command //p' "$TMP/words" | while read -r c; do
    has "^\.Ss lagc $c\$" "the command $c"
    has "^\.Cm $c\$" "$c in its synopsis"
  done
  sed -n 's/^option [a-z]* -//p; s/^passed [a-z]* -//p' "$TMP/words" | sort -u | while read -r o; do
    has "Fl $o\( \|\$\)" "the option -$o"
  done
}
empty "every command and option" "$(undocumented)"

read_here() { grep -oh 'getenv("[A-Z_]*")' src/*.c src/*/*.c runtime/*/*.c | sed 's/getenv("//; s/")//' | sort -u; }
check "variables are read" [ -n "$(read_here)" ]
empty "the environment" "$(read_here | while read -r v; do grep -q "Ev $v\( \|\$\)" "$page" || echo "$v"; done)"
statuses() { sed -n '/^| status /,/^$/s/^| `\([0-9]*\)`.*/\1/p' grammar/LANGUAGE.md; }
is "exit statuses, as the reference has them" "$(statuses)" "$(sed -n '/^\.Sh EXIT STATUS/,/^\.El/s/^\.It //p' "$page")"

# ---- lints ----
if command -v mandoc >/dev/null; then
  empty "mandoc" "$(mandoc -T lint -W warning "$page" 2>&1)"
else
  skip "mandoc" "no mandoc"
fi
if command -v groff >/dev/null && groff -mdoc -Tascii /dev/null >/dev/null 2>&1; then
  empty "groff" "$(groff -mdoc -ww -Tascii "$page" 2>&1 >/dev/null)"
else
  skip "groff" "no groff with -mdoc"
fi
if command -v man >/dev/null && man --version >/dev/null 2>&1; then
  empty "man --warnings" "$(LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=80 man --warnings -E UTF-8 -l "$page" 2>&1 >"$TMP/page")"
  check "it has its last section" grep -q CAVEATS "$TMP/page"
else
  skip "man --warnings" "no man"
fi
tap_end
