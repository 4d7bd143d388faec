#!/bin/sh
# The tool that plants one-token changes (tests/mutants/plant.py): the changes that it makes to a function; comments, text, declarations and
# tables stay as they are.
. tests/tap.sh
command -v python3 >/dev/null || skip_all "no python3"
cat >"$TMP/a.c" <<'END'
/* a < b */
#define LESS(a, b) ((a) < (b))
static const int table[] = {1 + 2, 0};
static int f(const char *s, int n) {
  static const double half = 1 / 2.0;
  for (int i = 0; i < n; i++) g(s, "0 < 1", -half);
  return n && !*s;
}
END
cat >"$TMP/expected" <<'END'
6 bound: for (int i = 0; i < n + 1; i++) g(s, "0 < 1", -half);
6 bound: for (int i = 0; i < n - 1; i++) g(s, "0 < 1", -half);
6 constant: for (int i = 1; i < n; i++) g(s, "0 < 1", -half);
6 dropped: for (int i = 0; i < n; i++) ;
6 operator: for (int i = 0; i <= n; i++) g(s, "0 < 1", -half);
6 sign: for (int i = 0; i < n; i++) g(s, "0 < 1",  half);
7 negation: return n &&  *s;
7 operator: return n || !*s;
7 returned: return 0;
END
made() {
  python3 -B - tests/mutants "$TMP/a.c" <<'END'
import sys
sys.path.insert(0, sys.argv[1])
import plant
text = open(sys.argv[2]).read()
for line in sorted("%d %s: %s" % (text.count("\n", 0, c.begin) + 1, c.kind, plant.apply(text, c).split("\n")[text.count("\n", 0, c.begin)].strip()) for c in plant.changes("a.c", text)):
    print(line)
END
}
is "changes of a function" "$(cat "$TMP/expected")" "$(made)"
# Rows of equivalent.txt name changes that are made, in the function that they name.
stale() {
  python3 -B - tests/mutants <<'END'
import sys
sys.path.insert(0, sys.argv[1])
import plant
for row in open(sys.argv[1] + "/equivalent.txt"):
    if row.startswith("#"):
        continue
    place, before, after, why = row.rstrip("\n").split(" | ")
    path, function = place.split(" ")
    text = open(path).read()
    if not any((plant.function_of(text, c), *plant.line_of(text, c)[1:]) == (function, before, after) for c in plant.changes(path, text)):
        print(place, "has no such change:", before)
END
}
empty "equivalent.txt names changes that are made" "$(stale)"
tap_end
