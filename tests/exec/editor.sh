#!/bin/sh
# grammar/lag.tmLanguage.json, which colours .lag files in editors: valid JSON whose regular expressions compile, and
# knows every statement, word, function and unit of the compiler's own tables (dump_words). textmate.js reads it as
# editors do.
. tests/tap.sh
command -v node >/dev/null || skip_all "no node"
grammar=grammar/lag.tmLanguage.json
judge() { node tests/exec/textmate.js "$grammar"; }

check "it is a grammar" judge </dev/null

named_there() {
  sed -n '/^```json$/,/^```$/{/^```/d;p;}' grammar/LANGUAGE.md >"$TMP/package.json"
  node -e 'const p = JSON.parse(require("fs").readFileSync(process.argv[1])), g = JSON.parse(require("fs").readFileSync(process.argv[2]));
    const c = p.contributes.grammars[0];
    process.exit(c.scopeName === g.scopeName && c.language === p.contributes.languages[0].id && p.contributes.languages[0].extensions[0] === "." + g.fileTypes[0] ? 0 : 1)' \
    "$TMP/package.json" "$grammar"
}
check "the reference's package.json fits" named_there

# ---- samples: scope|text of each part ----
# sample NAME LINE PARTS: parts as `scope text`, with / between them; - has no scope
sample() { is "$1" "$3" "$(printf '%s\n' "$2" | judge | sed '/^$/d; s/|/ /' | paste -s -d '/' - | sed 's|/| / |g')"; }
sample "a declaration" 'coord th[3] [rad] periodic # [m]' \
  'storage.type coord / variable.other th / - [ / constant.numeric 3 / - ] / punctuation.definition.unit [ / support.constant.unit rad / punctuation.definition.unit ] / keyword.other periodic / comment.line.number-sign # [m]'
sample "a unit may touch a number, not a name" 'let a = 90[deg] + x1[2]' \
  'storage.type let / variable.other a / keyword.operator = / constant.numeric 90 / punctuation.definition.unit [ / support.constant.unit deg / punctuation.definition.unit ] / keyword.operator + / variable.other x1 / - [ / constant.numeric 2 / - ]'
sample "primes, functions, constants" "lagrangian = m*x'^2 - sin(pi*t)" \
  "keyword.control lagrangian / keyword.operator = / variable.other m / keyword.operator * / variable.other x / keyword.operator.prime ' / keyword.operator ^ / constant.numeric 2 / keyword.operator - / support.function sin / - ( / constant.language pi / keyword.operator * / constant.language t / - )"
sample "a statement in a block, and a name that is a word" 'scene s "a # b" { span 20; span = 3 }' \
  'storage.type scene / entity.name.section s / string.quoted.double "a # b" / - { / keyword.control span / constant.numeric 20 / punctuation.separator ; / variable.other span / keyword.operator = / constant.numeric 3 / - }'
sample "ranges are no decimal points" 'let r[i in 1..N] = .5' \
  'storage.type let / variable.other r / - [ / variable.other i / keyword.operator.word in / constant.numeric 1 / keyword.operator .. / variable.other N / - ] / keyword.operator = / constant.numeric .5'
sample "letters of other scripts" 'let θ₁ = 2 [µm]' \
  'storage.type let / variable.other θ₁ / keyword.operator = / constant.numeric 2 / punctuation.definition.unit [ / support.constant.unit µm / punctuation.definition.unit ]'
sample "a text without its end ends with its line" 'include "a' 'keyword.control include / string.quoted.double "a'

# ---- the compiler's tables ----
"$BIN/dump_words" >"$TMP/words"
words() { sed -n "s/^$1 //p" "$TMP/words"; }

# unknown SCOPES LINE: the words on standard input that do not get one of the scopes when they stand for WORD in LINE
unknown() {
  cat >"$TMP/list"
  awk -v line="$2" '{ text = line; gsub(/WORD/, $0, text); print text }' "$TMP/list" | judge >"$TMP/judged"
  awk -v scopes="$1" '
    FNR == NR { word[FNR] = $0; next }
    {
      w = word[FNR]
      n = split($0, part, "\n")
      for (i = 1; i <= n; i++) {
        cut = index(part[i], "|")
        if (substr(part[i], cut + 1) == w && substr(part[i], 1, cut - 1) ~ "^(" scopes ")$") next
      }
      print w
    }' "$TMP/list" RS= "$TMP/judged"
}
equals='hamiltonian\|lagrangian\|kinetic\|potential\|dissipation'
empty "statements" "$(words statement | grep -v -x "$equals" | unknown 'storage.type|keyword.control' '  WORD name')"
empty "statements with =" "$(words statement | grep -x "$equals" | unknown 'keyword.control' 'WORD = x')"
empty "statements are words only where they begin one" "$(words statement | grep -v -x lagrangian | unknown 'variable.other' 'let a = 2*WORD')"
empty "functions" "$(words function | unknown 'support.function' 'let a = 2*WORD(x)')"
empty "functions are words only before (" "$(words function | unknown 'variable.other' 'let a = WORD + 1')"
empty "units" "$({ words unit; words prefixed; } | unknown 'support.constant.unit' 'param a = 1 [WORD]')"
empty "units with a prefix" "$(words prefixed | sed 's/^/k/' | unknown 'support.constant.unit' 'param a = 1 [WORD]')"
empty "what is no unit is none" "$(words unit | sed 's/^/k/' | unknown 'meta.unit' 'param a = 1 [WORD]')"
slots() {
  words slot | while read -r w; do
    case $w in
      periodic) line='coord th [rad] periodic' ;;
      rising | falling | crossing) line="event e: x $w { stop }" ;;
      restitution) line='contact floor: y >= 0, restitution = 1' ;;
      slip) line="contact floor: y >= 0, restitution = 1, friction = 1, slip = x'" ;;
      tangential) line="contact floor: y >= 0, restitution = 1, friction = 1, slip = x', tangential = 1" ;;
      law) line="contact floor: y >= 0, restitution = 1, friction = 1, slip = x', law = newton" ;;
      on) line='friction rub on x: mu*N' ;;
      static) line='friction rub on x: mu*N, static = mu_s*N' ;;
      of) line='momentum p of x [kg*m/s]' ;;
      exactly) line='start exactly q = 1' ;;
      guess) line='start guess b = 1' ;;
      every) line='output x every 0.1 [s]' ;;
      *) line="no sample for $w" ;;
    esac
    printf '%s\t%s\n' "$w" "$line"
  done >"$TMP/slots"
  cut -f 2 "$TMP/slots" | judge >"$TMP/judged"
  awk -F '\t' '
    FNR == NR { word[FNR] = $1; next }
    index("\n" $0 "\n", "\nkeyword.other|" word[FNR] "\n") == 0 { print word[FNR] }' "$TMP/slots" RS= "$TMP/judged"
}
empty "words in their places" "$(slots)"

# ---- whole models: units are known, lines that begin with a statement's word say so ----
cat models/*.lag tests/golden/ok/*.lag tests/golden/ast/every_statement.lag | judge >"$TMP/models"
empty "no unit of a model is unknown" "$(grep '^meta.unit|' "$TMP/models")"
scoped() { cat models/*.lag | grep -c -E "^ *($(words statement | paste -s -d '|' -))( |\$)"; }
[ -z "${SLOW:-}" ] || is "every statement of the models" "$(scoped)" \
  "$(cat models/*.lag | judge | awk -v RS= '/^(storage.type|keyword.control)\|/ { n++ } END { print n }')"
tap_end
