#!/bin/sh
# Who may include whom. Data flows one way, from text to C, and each folder of src/ sees only what lies before it;
# the compiler and the runtime never meet; GSL is met in one folder. src/README.md has the reasons.
. tests/tap.sh

# FOLDER: the folders whose headers it may include. `mech/eqns.h` etc.: these files only.
allowed='
src/base      base/
src/sym       sym/ base/
src/syntax    syntax/ base/
src/model     model/ syntax/ sym/ base/
src/mech      mech/ model/ sym/ base/
src/ir        ir/ sym/ base/
src/emit      emit/ ir/ base/
src/jets      jets/ mech/ model/ syntax/ ir/ base/
src/cli       cli/ base/
src           base/ syntax/ sym/ model/ mech/ ir/ jets/ emit/ cli/
grammar       syntax/scan.h syntax/parse_state.h
runtime           lag.h
runtime/core      core/ lag.h lag_model.h lag_kkt.h
runtime/methods   methods/ core/rhs.h core/gauss.h lag.h lag_model.h
runtime/analysis  analysis/ core/ lag.h lag_model.h
runtime/io        io/ lag.h lag_model.h
runtime/app       app/ core/ io/ analysis/ lag.h lag_model.h
runtime/gsl       gsl/ lag.h lag_model.h
'
# FILE: further headers that it may include. The equations enter the IR at one place.
besides='
src/ir/lower.c    mech/eqns.h
src/ir/lower.h    mech/eqns.h mech/switching_surfaces.h mech/variation.h
src/ir/lower_unit.c mech/charges.h
src/jets/text.h model/builder.h
src/ir/lower_charges.c mech/charges.h
runtime/include/lag.h  lag_model.h
runtime/include/lag_math.h  lag_sincos.h
src/main.c        picture.h help.h complete.h check.h conserved.h settings.h wants.h effects.h rounded.h
src/check.h       deriver.h
src/check.c       check.h
src/conserved.h   deriver.h
src/conserved.c   conserved.h
src/effects.c     effects.h
src/effects_text.c effects.h
src/rounded.c     rounded.h
src/wants.c       wants.h
src/picture.c     picture.h
src/help.c        help.h
src/complete.c    complete.h help.h settings.h
src/settings.c    settings.h
'
# Private headers of a folder, shared by its own files only.
private='syntax/ast_build.h syntax/parse_state.h syntax/filter.h syntax/scan.h syntax/token.h syntax/slips.h model/builder.h
  model/scope.h sym/expr_impl.h sym/ops.def ir/lower_impl.h ir/nest_impl.h emit/header_impl.h emit/emit_impl.h methods/tableau.h methods/embedded.h methods/embedded_trial.h
  methods/steps.h methods/composition.h methods/path.h methods/rule.h methods/discrete.h methods/implicit.h
  methods/history.h methods/band.h methods/control.h methods/links.h'

# Every #include as `FILE HEADER`; <stdio.h> keeps its brackets.
list=$TMP/list
find src grammar runtime -name '*.[chly]' | LC_ALL=C sort | while read -r f; do
  sed -n 's/^[ \t]*#[ \t]*include[ \t]*\(<[^>]*>\).*/\1/p; s/^[ \t]*#[ \t]*include[ \t]*"\([^"]*\)".*/\1/p' "$f" |
    sed "s|^|$f |"
done >"$list"

# The parser and scanner generated from lag.y and lag.l are included by src/syntax only.
empty "generated parser headers: src/syntax only" \
  "$(awk '$2 ~ /lag\.(tab|lex)\.[ch]>?$/ && $1 !~ /^src\/syntax\// { print $1 " includes " $2 }' "$list")"

empty "folders include only what lies before them" "$(awk -v allowed="$allowed" -v besides="$besides" '
  BEGIN {
    n = split(allowed, lines, "\n")
    for (i = 1; i <= n; i++) {
      k = split(lines[i], w, " ")
      for (j = 2; j <= k; j++) ok[w[1], w[j]] = 1
      if (k) known[w[1]] = 1
    }
    n = split(besides, lines, "\n")
    for (i = 1; i <= n; i++) {
      k = split(lines[i], w, " ")
      for (j = 2; j <= k; j++) ok[w[1], w[j]] = 1
    }
  }
  $2 ~ /^</ || $2 ~ /^lag\.(tab|lex)\.[ch]$/ { next }
  {
    folder = $1; sub(/\/[^\/]*$/, "", folder)
    where = $2; if (!sub(/\/.*/, "/", where)) where = $2
    if (ok[folder, where] || ok[folder, $2] || ok[$1, $2]) next
    print $1 " includes " $2 (known[folder] || folder ~ /include$/ ? "" : " (a folder without a rule)")
  }' "$list")"

# jets/ reads meanings of names from the scopes of the model that it compares.
empty "the inside of a folder stays inside" "$(awk -v private="$private" '
  BEGIN { n = split(private, w); for (i = 1; i <= n; i++) inside[w[i]] = 1 }
  inside[$2] && $1 !~ /^grammar\// {
    home = $2; sub(/\/.*/, "", home)
    folder = $1; sub(/\/[^\/]*$/, "", folder); sub(/.*\//, "", folder)
    if (folder != home && !(folder == "jets" && home == "model")) print $1 " includes " $2
  }' "$list")"

# ir/lower.h includes mech: only lowering, main and the self-check may include it.
empty "equations: ir/lower, jets and main only" "$(awk '
  $2 == "ir/lower.h" && $1 !~ /^src\/(main\.c|jets\/check_state\.c|ir\/lower[^\/]*\.[ch])$/ { print $1 " includes " $2 ", and so mech/eqns.h" }' "$list")"

empty "GSL: runtime/gsl only" "$(awk '$2 ~ /gsl/ && $1 !~ /^runtime\/gsl\// { print $1 " includes " $2 }' "$list")"

empty "lag_model.h includes only <stddef.h>" \
  "$(awk '$1 == "runtime/include/lag_model.h" && $2 != "<stddef.h>" { print $1 " includes " $2 }' "$list")"

# ISO C11 everywhere; POSIX only where a program meets its system.
c11='assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic
  stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype'
posix='src/main\.c src/base/source\.c src/cli/.*\.c runtime/app/.*\.c runtime/io/.*\.c'
empty "system headers: ISO C11; POSIX in main, base/source, cli, runtime/app and runtime/io" "$(awk -v c11="$c11" -v posix="$posix" '
  BEGIN {
    n = split(c11, w); for (i = 1; i <= n; i++) standard["<" w[i] ".h>"] = 1
    m = split(posix, where)
  }
  $2 ~ /^</ && $2 !~ /gsl/ && !standard[$2] {
    for (i = 1; i <= m; i++) if ($1 ~ "^" where[i] "$") next
    print $1 " includes " $2
  }' "$list")"

empty "no folder above: \"../\" in no #include" "$(awk '$2 ~ /\.\./ { print $1 " includes " $2 }' "$list")"

# ---- headers compile alone ----
alone() {
  for h in $(find "$1" -name '*.h' | LC_ALL=C sort); do
    shift_flags=$2
    # shellcheck disable=SC2086 # flags
    $3 $shift_flags -fsyntax-only -Wall -Wextra -Werror -include "$h" -x "$4" /dev/null || echo "$h"
  done 2>&1
}
empty "headers of the compiler compile alone" \
  "$(alone src "-std=c11 -D_POSIX_C_SOURCE=200809L -Isrc -I$BUILD/gen" "$CC" c)"
empty "headers of the runtime compile alone" \
  "$(alone runtime "-std=c11 -D_POSIX_C_SOURCE=200809L -Iruntime/include -Iruntime" "$CC" c)"
if [ -n "$CXX" ]; then
  empty "the public headers are C++ too" "$(alone runtime/include "-std=c++11 -Iruntime/include" "$CXX" c++)"
else
  skip "the public headers are C++ too" "no C++ compiler"
fi

# ---- emitted code: a model needs lag_model.h and <math.h>; a header only <math.h> ----
includes_of() {
  for m in models/*.lag; do
    "$LAGC" "$1" "$m" -o "$TMP/emitted" || echo "lagc $1 $m: exit status $?"
    sed -n 's/^[ \t]*#[ \t]*include[ \t]*//p' "$TMP/emitted" | grep -v -x -e "$2" | sed "s|^|lagc $1 $m includes |"
  done 2>&1
}
if [ -x "$LAGC" ] && ls models/*.lag >/dev/null 2>&1; then
  empty "lagc emit: lag_model.h and <math.h>" "$(includes_of emit '"lag_model.h"\|<math.h>')"
  empty "lagc header: <math.h>" "$(includes_of header '<math.h>')"
fi
tap_end
