#!/usr/bin/python3
"""Writes functions.lag and functions.expected beside itself: every function of the language along a motion that is known
in closed form, and the Taylor coefficients of its value by mpmath, from derivatives in 80 digits.

    x = x0 exp((t - t0)/2), y = 1/(t - t0 + 1/y0), at t0 = 1/4, x0 = 3/10, y0 = 4/5

A line of functions.expected: name, order, coefficient. Needs python3-mpmath; the tests need only what it has written."""
import os
from mpmath import mp, mpf, taylor, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, exp, log, sqrt, hypot, nstr

mp.dps = 80
ORDERS = 14
T0, X0, Y0 = mpf(1) / 4, mpf(3) / 10, mpf(4) / 5
N, A = mpf(5) / 2, mpf(13) / 10


def cbrt(z):  # the real root
    return z ** (mpf(1) / 3) if z > 0 else -((-z) ** (mpf(1) / 3))


# name: (in the language, in mpmath)
functions = {
    "product": ("x*y", lambda x, y, t: x * y),
    "square": ("(x - y)^2", lambda x, y, t: (x - y) ** 2),
    "seventh": ("(x + y)^7", lambda x, y, t: (x + y) ** 7),
    "linear": ("2*x/3 - 5*y/7 + n*t - 1", lambda x, y, t: 2 * x / 3 - 5 * y / 7 + N * t - 1),
    "time": ("t*x*y - t^3", lambda x, y, t: t * x * y - t ** 3),
    "quotient": ("x*y/(1 + x)", lambda x, y, t: x * y / (1 + x)),
    "reciprocal": ("1/(x*y)", lambda x, y, t: 1 / (x * y)),
    "multiples": ("sin(2*x)*cos(-3*y) + (-x)*(n*y)", lambda x, y, t: sin(2 * x) * cos(3 * y) - x * N * y),
    "sine": ("sin(x*y)", lambda x, y, t: sin(x * y)),
    "cosine": ("cos(x - y)", lambda x, y, t: cos(x - y)),
    "both": ("sin(n*x*t)*cos(n*x*t)", lambda x, y, t: sin(N * x * t) * cos(N * x * t)),
    "tangent": ("tan(x + y)", lambda x, y, t: tan(x + y)),
    "arcsine": ("asin(x*y)", lambda x, y, t: asin(x * y)),
    "arccosine": ("acos(x*y)", lambda x, y, t: acos(x * y)),
    "arctangent": ("atan(x*y + t)", lambda x, y, t: atan(x * y + t)),
    "angle": ("atan2(y, x - 1)", lambda x, y, t: atan2(y, x - 1)),
    "angle_below": ("atan2(-x, 2)", lambda x, y, t: atan2(-x, 2)),
    "angle_fixed": ("atan2(n, y)", lambda x, y, t: atan2(N, y)),
    "hyperbolic": ("sinh(x*y) + 2*cosh(x*y)", lambda x, y, t: sinh(x * y) + 2 * cosh(x * y)),
    "hyperbolic_tangent": ("tanh(x*y)", lambda x, y, t: tanh(x * y)),
    "exponential": ("exp(-x*y)", lambda x, y, t: exp(-x * y)),
    "logarithm": ("log(x + y)", lambda x, y, t: log(x + y)),
    "root": ("sqrt(x + y^2)", lambda x, y, t: sqrt(x + y ** 2)),
    "cubic_root": ("cbrt(x*y)", lambda x, y, t: cbrt(x * y)),
    "cubic_root_below": ("cbrt(-x*y)", lambda x, y, t: cbrt(-x * y)),
    "length": ("hypot(x, y)", lambda x, y, t: hypot(x, y)),
    "length_below": ("hypot(-x, n)", lambda x, y, t: hypot(x, N)),
    "power": ("x^n", lambda x, y, t: x ** N),
    "power_of_sum": ("(x^2 + y^2)^(-3/2)", lambda x, y, t: (x ** 2 + y ** 2) ** (mpf(-3) / 2)),
    "power_of_number": ("(x + y)^(2/7)", lambda x, y, t: (x + y) ** (mpf(2) / 7)),
    "base_fixed": ("a^(x*y)", lambda x, y, t: A ** (x * y)),
    "power_of_both": ("x^(y*t)", lambda x, y, t: x ** (y * t)),
    "choice": ("if(a > 1, x*y, y)", lambda x, y, t: x * y),
    "other_choice": ("if(a > 2, x*y, y)", lambda x, y, t: y),
    "of_constants": ("abs(a - n)*x + min(a, n) + sign(a)*y", lambda x, y, t: (N - A) * x + A + y),
    "driven": ("x*drive", lambda x, y, t: x * sin(2 * t) * exp(-t)),
    "held": ("x*still", lambda x, y, t: x * 3),
    "nested": ("exp(sin(x*cos(y)))/(1 + tanh(x)^2) + sqrt(log(2 + x*y))*atan2(x, y)",
               lambda x, y, t: exp(sin(x * cos(y))) / (1 + tanh(x) ** 2) + sqrt(log(2 + x * y)) * atan2(x, y)),
}

here = os.path.dirname(os.path.abspath(__file__))
with open(os.path.join(here, "functions.lag"), "w") as f:
    f.write('model functions "Every function along a known motion: written by coefficients.py"\n')
    f.write("state x, y\nparam n = 2.5, a = 1.3\ninput drive = sin(2*t)*exp(-t), still = sqrt(-t)\n")
    f.write("flow x' = x/2\nflow y' = -y^2\n")
    for name, (text, _) in functions.items():
        f.write(f"state {name}\nflow {name}' = {text}\n")
    f.write("scene go { start x = 0.3, y = 0.8; span 1 }\n")
with open(os.path.join(here, "functions.expected"), "w") as f:
    for name, (_, value) in functions.items():
        along = lambda t: value(X0 * exp((t - T0) / 2), 1 / (t - T0 + 1 / Y0), t)
        for k, c in enumerate(taylor(along, T0, ORDERS)):
            f.write(f"{name} {k} {nstr(c, 40)}\n")
