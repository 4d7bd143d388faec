#!/bin/sh
# The recipes for functions in .github/CONTRIBUTING.md, applied to csch and asinh in a copy of the sources: they touch the files that the page lists,
# no others; a model that uses asinh has its closed form, by two methods.
. tests/tap.sh

copy=$TMP/copy
mkdir -p "$copy"
cp -R .ci Makefile README.md grammar models runtime src tests "$copy" && rm -rf "$copy/tests/hard"

# edit FILE SED-SCRIPT: edits the file in the copy.
edit() { sed "$2" "$copy/$1" >"$TMP/edited" && cp "$TMP/edited" "$copy/$1"; }
# behind FILE LINE-PATTERN TEXT: a line after each line with the pattern.
behind() { TEXT=$3 awk -v at="$2" '{ print } index($0, at) { print ENVIRON["TEXT"] }' "$copy/$1" >"$TMP/edited" && cp "$TMP/edited" "$copy/$1"; }
# before FILE LINE-PATTERN: standard input, before the line.
before() {
  cat >"$TMP/inserted"
  awk -v text="$TMP/inserted" -v at="$2" 'index($0, at) == 1 { while ((getline line <text) > 0) print line } { print }' "$copy/$1" >"$TMP/edited"
  cp "$TMP/edited" "$copy/$1"
}

touched() { diff -rq . "$copy" 2>/dev/null | sed -n 's|^Files \./\(.*\) and .* differ$|\1|p' | LC_ALL=C sort; }
# listed HEADING: the files of the numbered list under it
listed() { sed -n "/^## $1/,/^## /p" .github/CONTRIBUTING.md | sed -n 's|^[0-9]*\. \[.*\](\.\./\([^)]*\)): .*|\1|p' | LC_ALL=C sort; }

# --- csch, by its text
edit runtime/numeric/functions.def 's|^  F(sech, "x", "1/cosh(x)")|& \\\
  F(csch, "x", "1/sinh(x)")|'
edit grammar/LANGUAGE.md 's/^| `sech(x)` .*/&\
| `csch(x)` | 1\/sinh(x) |/'
edit tests/exec/self_check/functions.lag 's/sech(x - 2\*y)/& + csch(2 + x^2)/'
is "a function by its text touches the three files that the page lists" "$(listed 'A function of others')" "$(touched)"

# --- asinh, of the C library
behind runtime/numeric/functions.def 'F(ATAN, atan' \
  '  F(ASINH, asinh, "\\operatorname{arsinh}", ODD, ZERO, OF_ARGUMENT, OPAQUE, 1, POWER(ONE_PLUS(SQUARE(x)), -1, 2)) \'
before src/series/series_recurrences.c '/* u u + v v. */' <<'END'
/* asinh: d = sqrt(1 + u u). */
static Val area_sine(SeriesBuilder *m, Slot at_zero, Val u) {
  Val uu = square(m, u);
  Slot inside = first_op(m, IR_ADD, first_number(m, 1), zero(m, uu));
  Val w = series_value(m, inside, coef(m, uu));
  return inverse(m, at_zero, u, square_root(m, first_op(m, IR_SQRT, inside, 0), w), 0);
}

END
behind src/series/series_recurrences.c 'if (strcmp(name, "atan") == 0)' '  if (strcmp(name, "asinh") == 0) return area_sine(m, at_zero, u);'
before src/self_check/jet.c 'static void logarithm(' <<'END'
static void area_sine(JetReal d[DERIVATIVES], JetReal x) {
  JetReal r = 1 / sqrtl(1 + x * x), r3 = r * r * r, r5 = r3 * r * r;
  JetReal cycle[DERIVATIVES] = {asinhl(x), r, -x * r3, (2 * x * x - 1) * r5, (9 * x - 6 * x * x * x) * r5 * r * r};
  memcpy(d, cycle, sizeof cycle);
}

END
behind src/self_check/jet.c 'strcmp(name, "atan") == 0' '  else if (strcmp(name, "asinh") == 0) area_sine(d, x);'
behind src/self_check/tape_partial.c 'strcmp(name, "atan") == 0' \
  '  if (strcmp(name, "asinh") == 0) return quotient(t, da, tape_power(t, tape_op(t, TAPE_ADD, one, square(t, a), 0), num_ratio(1, 2)));'
edit runtime/include/lag_lanes.h 's/one(atan)/one(atan) one(asinh)/'
edit grammar/LANGUAGE.md 's/^| `sinh(x)`, `cosh(x)`, `tanh(x)` | hyperbolic functions |/&\
| `asinh(x)` | the number whose sinh is x |/'
edit tests/exec/self_check/functions.lag 's/atan(x\*y)/& + asinh(x - 2*y)/'
edit tests/exec/lanes/branches.lag 's/ + atan(r)/& + asinh(x*y)/'
edit tests/unit/test_jets.c 's/{"atan", catanl, 0, 0.6L, 1.1L},/& {"asinh", casinhl, 0, 0.6L, 0.9L},/'
edit tests/unit/test_ir.c 's/"tan(x) + asin(x\/2)/"tan(x) + asinh(x) + asin(x\/2)/'

is "one of the C library touches the files that the page lists" "$(listed 'A function of the C')" "$(touched)"

check "it builds" "${MAKE:-make}" -s -C "$copy" BUILD=build PRECISIONS= WERROR=-Werror all
lagc=$copy/build/lagc
XDG_CACHE_HOME=$TMP/cache
export XDG_CACHE_HOME

# In u = asinh(x) a harmonic oscillator: x = sinh(cos(t)).
cat >"$TMP/oscillator.lag" <<'END'
model oscillator "Harmonic in asinh(x)"
coord x
let u = asinh(x)
kinetic = u'^2/2
potential = u^2/2
expect x'' = x*x'^2/(1 + x^2) - sqrt(1 + x^2)*asinh(x)
scene swing { start x = 1.1752011936438014; span 2; tolerance 1e-12 }
END
check "the model agrees with its text, and its equation is proved" says 0 "1 of 1 expectation proved" "$lagc" check "$TMP/oscillator.lag"
exact=$(awk 'BEGIN { u = cos(2); printf "%.15g", (exp(u) - exp(-u))/2 }')
for method in dop853 taylor; do
  at_end=$("$lagc" run "$TMP/oscillator.lag" --method "$method" | awk '$1 == "x" { print $2 }')
  near "x = sinh(cos(2)) by $method" 1e-10 "$exact" "$at_end"
done
check "each function against its derivative" "$lagc" check "$copy/tests/exec/self_check/functions.lag"
tap_end
