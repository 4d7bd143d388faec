#!/bin/sh
# Emitted accelerations far from the origin: finite values of the text are finite in C. tests/exec/range/forms.txt has the models and closed forms.
. tests/tap.sh

# compare NUMBER: the rows of that form, against its model.
compare() {
  sed -n "/^form $1 /,/^form $(($1 + 1)) /p" tests/exec/range/forms.txt | grep -v '^form' >"$TMP/rows"
  "$LAGC" emit "$TMP/range.lag" -o "$TMP/range.c" && "$CC" -std=c11 -O1 -I"$INC" "$TMP/range.c" tests/exec/range/forms.c -o "$TMP/range" -lm &&
    "$TMP/range" <"$TMP/rows"
}
grep '^form' tests/exec/range/forms.txt >"$TMP/forms"
while read -r _ number text; do
  printf 'model range "One form"\ncoord q\nparam a = 1/8 > 0, b = 3 > 0\nlagrangian = q'"'"'^2/2 %s\nscene one { span 1 }\n' "$text" >"$TMP/range.lag"
  check "range of $text" compare "$number"
done <"$TMP/forms"
tap_end
