# Data of run_fit.sh, and the values that scipy.optimize.least_squares finds in them: /usr/bin/python3 reference.py [write]
import sys
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

t = np.linspace(0.1, 12, 120)


def damped(p, t=t):  # closed form of m x'' + c x' + k x = 0, m = 2
    k, c, x0, v0 = p
    b = c / 4
    w = np.sqrt(k / 2 - b * b)
    return np.exp(-b * t) * (x0 * np.cos(w * t) + (v0 + b * x0) / w * np.sin(w * t))


def pendulum(g, l, th0, t):
    return solve_ivp(lambda t, y: [y[1], -g / l * np.sin(y[0])], (0, t[-1]), [th0, 0], method="DOP853", rtol=1e-12,
                     atol=1e-13, t_eval=t).y[0]


def show(name, f, start, **how):
    r = least_squares(f, start, x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15, **how)
    errors = np.sqrt(np.diag(np.linalg.inv(r.jac.T @ r.jac)))
    print(name, " ".join("%.10g" % x for x in r.x), "errors", " ".join("%.8g" % e for e in errors), "chi2 %.10g" % (2 * r.cost))
    return r


rng = np.random.default_rng(1)
x = damped([18, 0.5, 0.3, -0.2]) + rng.normal(0, 0.01, t.size)
ts = np.linspace(0.05, 10, 100)
th = np.degrees(pendulum(9.81, 1.02, 1.4, ts)) + rng.normal(0, 0.5, ts.size)
outliers = x.copy()
outliers[7::20] += 0.3
if sys.argv[1:] == ["write"]:
    def put(name, head, *columns):
        with open(name, "w") as f:
            f.write(head + "\n")
            f.writelines(",".join("%.8g" % v for v in row) + "\n" for row in zip(*columns))
    put("damped.csv", "t [s],x [m]", t, x)
    put("outliers.csv", "t [s],x [m]", t, outliers)
    put("pendulum.csv", "t [s],th [deg]", ts, th)
    tl = np.arange(1, 241) / 10
    motion = solve_ivp(lambda t, y: [10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2]], (0, 24.1),
                       [1, 1, 20], method="DOP853", rtol=1e-12, atol=1e-12, t_eval=tl).y
    noise = np.random.default_rng(1).normal(0, 0.3, (240, 2))
    put("lorenz.csv", "t [s],x,z", tl, motion[0] + noise[:, 0], motion[2] + noise[:, 1])
read = lambda name: np.loadtxt(name, delimiter=",", skiprows=1).T
t, x = read("damped.csv")
start = [20, 0.4, 0.25, 0]
show("damped", lambda p: (damped(p, t) - x) / 0.01, start)
show("prior", lambda p: np.append((damped(p, t) - x) / 0.01, (p[0] - 18.2) / 0.02), start)
r = show("mm", lambda p: (damped(p, t) - x) / 0.01, start)
_, y = read("outliers.csv")
show("huber", lambda p: (damped(p, t) - y) / 0.01, start, loss="huber", f_scale=1.345)
ts, th = read("pendulum.csv")
r = least_squares(lambda p: (np.degrees(pendulum(9.81, p[0], p[1], ts)) - th) / 0.5, [1, 1.3], x_scale="jac", xtol=1e-15,
                  ftol=1e-15, gtol=1e-15, diff_step=1e-5, jac="3-point")
print("pendulum", r.x, "errors", np.sqrt(np.diag(np.linalg.inv(r.jac.T @ r.jac))), 2 * r.cost)
