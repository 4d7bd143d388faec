"""SciPy's DOP853 on two problems of methods.c: the time that it takes to the errors that are asked for there.
Right-hand sides are Python, as one writes them. Prints milliseconds; the rest of the table is C."""
import math
import time

try:
    from scipy.integrate import solve_ivp
except ImportError:
    print("SciPy DOP853: there is no SciPy")
    raise SystemExit


def double_pendulum(t, y):
    a, b, u, v = y
    s, c = math.sin(a - b), math.cos(a - b)
    f, g = -s*v*v - 2*9.81*math.sin(a), s*u*u - 9.81*math.sin(b)
    d = 1/(2 - c*c)
    return u, v, (f - c*g)*d, (2*g - c*f)*d



def kepler(t, y):
    a, b, u, v = y
    k = -1/math.hypot(a, b)**3
    return u, v, k*a, k*b


problems = [
    ("double pendulum", double_pendulum, (math.pi/2, math.pi/2, 0, 0), 10, (-0.5684746640159468775, -0.5263937279324087944), (1e-6, 1e-9, 1e-12)),
    ("Kepler, e = 0.9", kepler, (0.1, 0, 0, math.sqrt(19)), 34.557519189487725623, (-1.9, 0), (1e-8,)),
]
for name, f, y0, t, exact, errors in problems:
    best = {}
    for k in range(8, 29):
        tol = 10**(-k/2)
        t0 = time.process_time()
        y = solve_ivp(f, (0, t), y0, method="DOP853", rtol=max(tol, 3e-14), atol=tol).y[:, -1]
        took = time.process_time() - t0
        error = max(abs(y[0] - exact[0]), abs(y[1] - exact[1]))
        for e in errors:
            if error <= e:
                best[e] = min(took, best.get(e, math.inf))
    print("SciPy DOP853, %s:" % name, ", ".join("%.0e %s" % (e, "%.3g ms" % (1e3*best[e]) if e in best else "-") for e in errors))
