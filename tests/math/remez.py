#!/usr/bin/python3
"""Prints the coefficients of runtime/include/lag_math.h: minimax polynomials by Remez's exchange algorithm, in 120 digits, rounded to
double one after the other, the first one first, the rest fitted anew to what rounding left (Muller, Elementary Functions, 3rd ed., ch. 3
and 4). The error that is made small is that of the function, relative to it. Needs mpmath.

  remez.py            the coefficients and their errors
  remez.py FILE       the same, and fails when FILE does not contain each of them
"""
import sys
from mpmath import mp, mpf, sin, cos, exp, log, sqrt, pi, floor, lu_solve, matrix

mp.dps = 120


def values(c, x):
    s = mpf(0)
    for a in reversed(c):
        s = s * x + a
    return s


def remez(f, weight, n, lo, hi):
    """c[0..n-1] with sum c[k] x^k ~ f(x) on [lo, hi]; the error times weight(x) has n + 1 equal extremes."""
    k = range(n + 1)
    x = [(lo + hi) / 2 - (hi - lo) / 2 * cos(pi * (2 * i + 1) / (2 * n + 2)) for i in k]
    grid = [(lo + hi) / 2 - (hi - lo) / 2 * cos(pi * i / 600) for i in range(1, 600)]
    for _ in range(12):
        a, b = matrix(n + 1, n + 1), matrix(n + 1, 1)
        for i in k:
            for j in range(n):
                a[i, j] = x[i] ** j
            a[i, n] = (-1) ** i / weight(x[i])
            b[i] = f(x[i])
        c = lu_solve(a, b)
        level = abs(c[n])
        c = [c[j] for j in range(n)]
        e = [(weight(t) * (f(t) - values(c, t)), t) for t in grid]
        new, best = [], e[0]
        for v in e[1:]:  # the largest error between two changes of sign
            if v[0] * best[0] < 0:
                new.append(best)
                best = v
            elif abs(v[0]) > abs(best[0]):
                best = v
        new.append(best)
        while len(new) > n + 1:
            new.pop(0 if abs(new[0][0]) < abs(new[-1][0]) else -1)
        if len(new) < n + 1:
            break
        x = [t for _, t in new]
        if max(abs(v) for v, _ in new) < level * mpf('1.0005'):
            break
    return c, max(abs(v) for v, _ in e)


def rounded(f, weight, n, lo, hi):
    """The same in doubles: c[0] is rounded, then the rest is fitted to (f - c[0])/x, and so on."""
    out = []
    for k in range(n):
        rest = lambda x, k=k: (f(x) - values(out, x)) / x ** k
        heavy = lambda x, k=k: weight(x) * x ** k
        c, _ = remez(rest, heavy, n - k, lo, hi)
        out.append(mpf(float(c[0])))
    grid = [lo + (hi - lo) * i / 997 for i in range(1, 997)]
    return out, max(abs(weight(t) * (f(t) - values(out, t))) for t in grid)


tiny = mpf(10) ** -12
quarter = (pi / 4) ** 2 * (1 + mpf(10) ** -6)
half = log(mpf(2)) / 2 * (1 + mpf(10) ** -6)
s_max = ((sqrt(mpf(2)) - 1) / (sqrt(mpf(2)) + 1)) ** 2
root = lambda z: sqrt(z)
atanh2 = lambda s: log((1 + s) / (1 - s))
step = (pi / 64) ** 2 * (1 + mpf(10) ** -6)
jobs = [
    ('sin r = r - r^3 p(r^2), |r| <= pi/64', 3, tiny, step,
     lambda z: (root(z) - sin(root(z))) / root(z) ** 3, lambda z: root(z) ** 3 / sin(root(z))),
    ('cos r = 1 - r^2/2 + r^4 p(r^2), |r| <= pi/64', 3, tiny, step,
     lambda z: (cos(root(z)) - 1 + z / 2) / z ** 2, lambda z: z ** 2 / cos(root(z))),
    ('sin y = y - y^3 p(y^2), |y| <= pi/4', 6, tiny, quarter,
     lambda z: (root(z) - sin(root(z))) / root(z) ** 3, lambda z: root(z) ** 3 / sin(root(z))),
    ('cos y = 1 - y^2/2 + y^4 p(y^2), |y| <= pi/4', 6, tiny, quarter,
     lambda z: (cos(root(z)) - 1 + z / 2) / z ** 2, lambda z: z ** 2 / cos(root(z))),
    ('exp r = 1 + r + r^2 p(r), |r| <= log(2)/2', 11, -half, half * mpf('1.001'),
     lambda r: (exp(r) - 1 - r) / r ** 2, lambda r: r ** 2 / exp(r)),
    ('log((1 + s)/(1 - s)) = 2 s + s^3 p(s^2), |s| <= (sqrt 2 - 1)/(sqrt 2 + 1)', 7, tiny, s_max,
     lambda z: (atanh2(root(z)) - 2 * root(z)) / root(z) ** 3, lambda z: root(z) ** 3 / atanh2(root(z))),
]
text = "".join(open(f).read() for f in sys.argv[1:]) or None
missing = 0


def show(x):
    global missing
    print('  %.17g' % x)
    if text is not None and '%.17g' % abs(x) not in text:  # a sign may stand in the formula; run_math.sh would see it wrong
        print('  is not in', sys.argv[1])
        missing = 1


for name, n, lo, hi, f, weight in jobs:
    c, error = rounded(f, weight, n, lo, hi)
    print('%s: relative error 2^%.1f' % (name, log(error) / log(mpf(2))))
    for a in c:
        show(float(a))


def parts(name, x, bits):
    """x as a sum of doubles with so many bits, the last one rounded: products with small integers are exact."""
    print(name)
    for b in bits:
        unit = mpf(2) ** (floor(log(x) / log(mpf(2))) - b + 1)
        show(float(floor(x / unit) * unit))
        x -= floor(x / unit) * unit
    show(float(x))


parts('pi/2', pi / 2, [35, 35])
parts('pi/32', pi / 32, [35, 35])
parts('log 2', log(mpf(2)), [42])
print('sin(k pi/32), and what rounding left of it, negated')
for k in range(80):
    exact = sin(k * pi / 32) if k % 32 else mpf(0)
    near = mpf(float(exact))
    show(float(near))
    show(float(near - exact))
sys.exit(missing)
