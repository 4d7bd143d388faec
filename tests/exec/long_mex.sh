#!/bin/sh
# runtime/matlab/lagc_mex.c, built by Octave: models in one process, against closed forms; errors.
. tests/tap.sh
command -v mkoctfile >/dev/null && command -v octave >/dev/null || skip_all "there is no Octave with mkoctfile"
octave() { (cd "$TMP" && command octave --no-init-file --no-gui -qf "$1"); }
case $INC in /*) ;; *) INC=$(pwd)/$INC ;; esac
check "compiles" mkoctfile --mex -Wall -Wextra -Werror "-I$INC" runtime/matlab/lagc_mex.c -ldl -o "$TMP/lagc_mex.mex"
for m in spring bouncing_ball; do check "the library of $m" "$LAGC" build models/$m.lag --shared -o "$TMP/$m.so"; done
# The spring is x = cos 2 t; the ball falls from 1 m and bounces at sqrt(2/g).
cat >"$TMP/closed.m" <<'END'
t = [0.5 1 2 5];
[Y, out] = lagc_mex('run', './spring.so', t, struct('x', 1, 'tol', 1e-12));
assert(Y, [cos(2*t); -2*sin(2*t)]', 1e-9);
assert(size(out, 1) == 4 && abs(out(:, 1) - cos(2*t')) < 1e-9);
w = sqrt(4/3);
Y = lagc_mex('run', './spring.so', t, {'x''', 1; 'x', 0; 'm', 3}, 'free');
assert(Y(:, 1), sin(w*t')/w, 1e-7);
[y, p] = lagc_mex('names', './spring.so');
assert(isequal(y, {'x'; 'x'''}) && isequal(p, {'m'; 'k'}));
assert(lagc_mex('rhs', './spring.so', 0, [1 2; 5 6]), [5 6; -4 -8], 1e-14);
g = 9.81; at = sqrt(2/g);
b = lagc_mex('run', './bouncing_ball.so', [0.4 0.5]);
v = 0.8*g*at; d = 0.5 - at;
assert(b, [1 - g*0.4^2/2, -g*0.4; v*d - g*d^2/2, v - g*d], 1e-9);
assert(lagc_mex('rhs', './bouncing_ball.so', 0, [1; 2]), [2; -g], 1e-14);
END
check "closed forms" octave closed.m
# fails WORDS CALL
fails() {
  printf 'try\n  %s;\n  error("no error");\ncatch e\n  assert(! isempty(strfind(e.message, "%s")), e.message);\nend\n' "$2" "$1" >"$TMP/fails.m"
  octave fails.m
}
check "a wrong name" fails 'no such parameter' "lagc_mex('run', './spring.so', 1, struct('y', 1))"
check "a wrong scene" fails 'there are free' "lagc_mex('run', './spring.so', 1, [], 'none')"
check "a wrong sign" fails 'declares m > 0' "lagc_mex('run', './spring.so', 1, struct('m', -1))"
check "a wrong size" fails 'in each column' "lagc_mex('rhs', './spring.so', 0, [1; 2; 3])"
check "no library" fails 'none.so' "lagc_mex('run', './none.so', 1)"
check "another library" fails 'make the library by' "lagc_mex('run', 'libc.so.6', 1)"
check "no call" fails 'then values and a scene' "lagc_mex('walk', './spring.so', 1)"
check "values of another kind" fails 'values are a struct' "lagc_mex('run', './spring.so', 1, 7)"
tap_end
