#!/bin/sh
# Every error and warning that the compiler has about a model stands in a golden expectation, so that somebody has
# read it. For a missing one add a model that draws it to tests/golden/err (see run_errors.sh).
. tests/tap.sh

# Messages that other suites show, by a part of their text.
elsewhere='internal error
families of contacts in
single contacts, `for i in 1..N { contact hit
whose programs allocate no lists of neighbours
`lagc build --shared` makes a library with a C interface
 --bytes
of a family of contacts as a number
leave it out of --fix
near a zero of a divisor
-D %s
--fix
--precision
no Hamiltonian
no symmetries to look for
the model has no canonical transformation
the inverse of
lagc effects
effects to compare
this does not belong in a scene
a run cannot set
a section is a surface in the space of states
is left out: liblag computes action variables
this is not a finite number
this is nested too deep
deep here, and at most
name an inner part
the mass matrix is singular at the start of the scene
begin elsewhere, as with'

# The texts in the calls that report, one a line, as FILE:LINE<tab>TEXT; texts that are not sentences are left out.
texts() {
  awk -v calls='(diag_error|diag_warning|unit_bad|report_count|refuse_point)[(]' '
    # Literals side by side are one text.
    function literals(call,   text, in_text, c, i) {
      for (i = 1; i <= length(call); i++) {
        c = substr(call, i, 1)
        if (in_text && c == "\\") { text = text substr(call, ++i, 1); continue }
        if (c == "\"") in_text = !in_text
        else if (in_text) text = text c
        else if (c != " ") {
          if (length(text) >= 8 && text ~ / /) print FILENAME ":" line "\t" text
          text = ""
        }
      }
    }
    function flush() {
      if (pending != "") literals(pending)
      pending = ""
    }
    pending == "" && $0 ~ calls { line = FNR; match($0, calls); $0 = substr($0, RSTART) }
    pending != "" || $0 ~ "^" calls { pending = pending " " $0; if ($0 ~ /;[ }]*$/) flush() }' src/*/*.c
}

# The longest piece of a format between its conversions.
longest() {
  awk -F '\t' '{ n = split($2, piece, /%[-.*0-9]*(l*[dufsgcX]|%)/); best = ""
    for (i = 1; i <= n; i++) if (length(piece[i]) > length(best)) best = piece[i]
    print $1 "\t" best }'
}

cat tests/golden/err/*.expected >"$TMP/expected"
printf '%s\n' "$elsewhere" >"$TMP/elsewhere"
texts | grep -vF -f "$TMP/elsewhere" | longest >"$TMP/texts"
check "the messages are found" [ "$(wc -l <"$TMP/texts")" -gt 150 ]
unseen() {
  while IFS="$(printf '\t')" read -r where text; do
    grep -qF -e "$text" "$TMP/expected" || echo "$where: $text"
  done <"$TMP/texts"
}
empty "each message stands in tests/golden/err" "$(unseen)"
tap_end
