"""lagc.py against closed forms, against `lagc run`, and against wrong use: prints TAP. run_python.sh calls it."""
import json
import os
import subprocess
import sys
import threading
import time
import warnings

import numpy as np

import lagc

count = 0


def ok(name, good, said=""):
    global count
    count += 1
    print(f"{'ok' if good else 'not ok'} {count} - {name}")
    if not good:
        print(f"# {said}")


def near(name, got, want, within):
    worst = np.max(np.abs(np.asarray(got) - np.asarray(want)))
    ok(name, worst <= within, f"off by {worst}, {within} is allowed")


def raises(name, kind, words, f):
    try:
        f()
    except lagc.Error as e:
        ok(name, type(e) is kind and words in str(e), f"{type(e).__name__}: {e}")
    else:
        ok(name, False, "nothing is raised")


# ---- a spring, m = 1 kg, k = 4 N/m: x = cos 2t ----
spring = lagc.load("models/spring.lag")
r = spring.run("free", until=5)
near("a spring, cos 2t", r["x"], np.cos(2 * r.t), 1e-9)
near("its velocity", r["x'"], -2 * np.sin(2 * r.t), 1e-9)
near("rows at the scene's grid", r.t, np.arange(251) * 0.02, 1e-12)
near("the state", r.y, np.stack([r["x"], r["x'"]], 1), 0)
near("its energy", r["energy"], 2, 1e-9)
r = spring.run("free", k=9, x=0.5, until=-1, every=0.25)
near("values, backwards", r["x"], 0.5 * np.cos(3 * r.t), 1e-9)
ok("the end of a backward run", r.t[-1] == -1 and len(r) == 5)
near("times given", spring.run("free", times=[0.1, 0.7], tol=1e-12)["x"], np.cos([0.2, 1.4]), 1e-11)
near("a method with an option", spring.run("free", until=1, method="rk4(step=1e-3)")["x"][-1], np.cos(2), 1e-11)
near("a step of 0.1 is coarser", abs(spring.run("free", until=1, method="rk4", step=0.1)["x"][-1] - np.cos(2)), 3e-5, 3e-5)
ok("... and has errors", abs(spring.run("free", until=1, method="rk4", step=0.1)["x"][-1] - np.cos(2)) > 1e-7)
c, s = np.cos(10), np.sin(10)
near("the tangent of the flow", spring.run("free", until=5, tangent=True).tangent, [[c, s / 2], [-2 * s, c]], 1e-9)
r = spring.run("free", times=[0.5, 1.0], sensitivity=("k", "x(0)"))  # x = cos(wt), w^2 = k/m = 4
near("derivatives by a parameter", r.sensitivity["k"]["x"], -r.t * np.sin(2 * r.t) / 4, 1e-9)
near("... and by a start", r.sensitivity["x(0)"]["x"], np.cos(2 * r.t), 1e-9)
r = spring.run("free", {"x'": 2}, until=1)
near("a start by its primed name", r["x"], np.cos(2 * r.t) + np.sin(2 * r.t), 1e-9)
near("rates of many states", spring.rhs(0, [[1, 2], [3, 4]], k=5), [[2, -5], [4, -15]], 1e-14)
near("the rate of one state", spring.rhs(0, [1, 2]), [2, -4], 0)
near("values of a later call are its own", spring.rhs(0, [1, 2], k=5), [2, -5], 0)
ok("parameters", spring.parameters() == {"m": 1, "k": 4}, spring.parameters())
ok("names", spring.coordinates == ["x"] and "damped" in spring.scenes and spring.charges == ["energy"] and "dop853" in spring.methods)

# ---- the same numbers as lagc run ----
npy = os.path.join(os.environ["TMP"], "rows.npy")


def command(model, *words):
    done = subprocess.run([os.environ["LAGC"], "run", model, *words, "--json", "-o", npy], stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout), np.load(npy)


cases = (("models/double_pendulum.lag", "swing", {}, None), ("models/pendulum.lag", "small", {"th": 1.2}, None),
                                 ("models/bouncing_ball.lag", "drop", {}, None), ("models/lorenz.lag", "butterfly", {}, None), ("models/spring.lag", "damped", {}, 1e-7),
                                 ("models/motor_pendulum.lag", "lift", {"L": 8}, None), ("models/spring.lag", "free", {}, 1e-11), ("models/lotka_volterra.lag", "long", {}, None), ("models/cart_pendulum.lag", "workshop", {}, 1e-5))
for model, scene, words, tol in cases if os.environ.get("SLOW") else cases[::3]:
    report, rows = command(model, scene, *(f"{k}={v}" for k, v in words.items()), "--until", "2", *(["--tol", str(tol)] if tol else []))
    r = lagc.load(model).run(scene, words, until=2, tol=tol)
    table = np.stack([rows[k] for k in rows.dtype.names], 1)
    mine = np.column_stack([r.t] + [r[k] for k in r.names])
    ok(f"{model}: the rows of lagc run, bit by bit", mine.shape == table.shape and (mine == table).all(), f"{mine.shape} {table.shape}")
    ok(f"{model}: its method", r.method.split(",")[0] in report["method"], f"{r.method} {report['method']}")
    drift = report["charges"].get("energy", {}).get("drift")
    ok(f"{model}: its energy drift", drift == r.energy_drift or drift is None and np.isnan(r.energy_drift), f"{r.energy_drift} {drift}")
    ok(f"{model}: its steps", r.stats["steps"] == report["steps"], f"{r.stats['steps']} {report['steps']}")

# ---- events: a ball from 1 m bounces at sqrt(2/g) with 0.8 of its speed ----
ball = lagc.load("models/bouncing_ball.lag")
r = ball.run("drop", until=1)
name, t, before, after = r.events[0]
near("the first bounce", t, np.sqrt(2 / 9.81), 1e-9)
near("the speed after it", after[1], -0.8 * before[1], 0)
ok("its name", name == "floor" and len(r.events) == 1)

# ---- batches: 10^4 double pendulums in one call ----
double = lagc.load("models/double_pendulum.lag")
angles = np.linspace(1, 90, 10000)
calls = []
library = next(iter(double._scenes().values())).lib
batch_function = library.lag_sim_batch
library.lag_sim_batch = lambda *a: calls.append(a) or batch_function(*a)
out = np.empty((10000, 2, 4))
b = double.batch("swing", th1=angles, times=[0.5, 1], tol=1e-6, lanes=False, out=out)
library.lag_sim_batch = batch_function
ok("one call of the library", len(calls) == 1 and calls[0][1] == 10000)
ok("the caller's array, without a copy", b.y is out and calls[0][6] == out.ctypes.data)
ok("all of them run", not b.status.any() and np.isfinite(b.y).all())
single = double.run("swing", th1=angles[777], times=[0.5, 1], tol=1e-6, method="dop853")
ok("each is the run of its own start, bit by bit", (b.y[777] == single.y).all(), b.y[777] - single.y)
ok("by name", (b["th2"] == b.y[:, :, 1]).all())
y0 = np.array([[np.radians(30), 0, 0, 0], [0, 0.1, 0, 0]])
calls.clear()
library.lag_sim_batch = lambda *a: calls.append(a) or batch_function(*a)
b = double.batch("swing", y0=y0, times=[0.0], tol=1e-6)
library.lag_sim_batch = batch_function
ok("starts of the caller's array, without a copy", calls[0][2] == y0.ctypes.data and (b.y[:, 0] == y0).all())
two = double.batch("swing", th1=angles[:999], times=[1], tol=1e-6, threads=2)
one = double.batch("swing", th1=angles[:999], times=[1], tol=1e-6)
ok("two threads, the same bits", (one.y == two.y).all())
k = np.array([1.0, 4, 9])
b = spring.batch("free", x=1, k=k, times=[1, 2])
near("parameters of each", b["x"], np.cos(np.sqrt(k)[:, None] * [1, 2]), 1e-9)

b = spring.batch("free", k=9, x=[0.5, 2], times=[1, 2])
near("a parameter for all", b["x"], np.outer([0.5, 2], np.cos([3, 6])), 1e-9)
b = spring.batch("free", x=0.5, k=[1.0, 4], times=[1])
near("a start for all", b["x"], 0.5 * np.cos([[1], [2]]), 1e-9)
b = double.batch("swing", m2=3, l1=0.5, th1=[20, 40], times=[1], tol=1e-6)
ok("... and what follows from it", (b.y[1, 0] == double.run("swing", m2=3, l1=0.5, th1=40, times=[1], tol=1e-6).y[0]).all())
motor = lagc.load("models/motor_pendulum.lag")
b = motor.batch("lift", L=[5, 8], times=[1])
ok("values in declared units, [mH]", (b.y[1, 0] == motor.run("lift", L=8, times=[1]).y[0]).all())
b = spring.batch("free", x=[1, 2], times=[1], method="gauss(stages=3)", step=0.01)
ok("a method with options", (b.y[0, 0] == spring.run("free", times=[1], method="gauss(stages=3)", step=0.01).y[0]).all())

# ---- matrices, against the textbook's double pendulum, m = 1 kg, l = 1 m: M = [[2, c], [c, 1]], c = cos(th1 - th2) ----
def pendulum(y, m1=1.0, m2=1.0, g=9.81):
    """Mass matrix and bias, from dL/dq and the Christoffel terms."""
    a, b, va, vb = y
    c, s = np.cos(a - b), np.sin(a - b)
    return np.array([[m1 + m2, m2 * c], [m2 * c, m2]]), np.array([m2 * s * vb * vb + (m1 + m2) * g * np.sin(a), -m2 * s * va * va + m2 * g * np.sin(b)])


def pendulum_rates(y, **p):
    M, h = pendulum(y, **p)
    return np.concatenate([y[2:], -np.linalg.solve(M, h)])


def complex_step(f, x):
    """Derivatives of an analytic function without cancellation (Squire and Trapp 1998), to rounding."""
    x = np.asarray(x, dtype=float)
    return np.array([f(x + 1e-30j * e).imag / 1e-30 for e in np.eye(len(x))]).T


ys = np.array([[0.3, -0.4, 0.5, 0.6], [2, 1, -3, 0.2]])
near("mass matrices of two states", double.mass(0, ys), [pendulum(y)[0] for y in ys], 4e-15)
near("the bias", double.bias(0, ys), [pendulum(y)[1] for y in ys], 4e-14)
near("inverse dynamics", double.inverse_dynamics(0, ys, [[1, -2], [0.5, 3]]), [pendulum(y)[0] @ a + pendulum(y)[1] for y, a in zip(ys, [[1, -2], [0.5, 3]])], 4e-14)
J = np.array([complex_step(pendulum_rates, y) for y in ys])
near("Jacobians", double.jac(0, ys), J, 1e-13)  # some twenty roundings of numbers up to 50
near("J x", double.jvp(0, ys[0], [1, 2, 3, 4]), J[0] @ [1, 2, 3, 4], 1e-12)
near("J^T x", double.vjp(0, ys, np.ones((2, 4))), J.sum(axis=1), 1e-12)
by_p = double.parameter_jacobian(0, ys[0])
near("derivatives by parameters", by_p[:, [0, 1, 4]], complex_step(lambda p: pendulum_rates(ys[0], m1=p[0], m2=p[1], g=p[2]), [1, 1, 9.81]), 1e-12)
C, D = double.output_jacobian(0, ys[0])
c, s = np.cos(ys[0, :2]), np.sin(ys[0, :2])
near("C of the outputs th1, th2, x2, y2", C[:4], [[1, 0, 0, 0], [0, 1, 0, 0], [c[0], c[1], 0, 0], [s[0], s[1], 0, 0]], 1e-11)  # differences of order 6
ok("D has a column an input", D.shape == (5, 0))
near("outputs", double.outputs(0, ys[0])[2:4], [s.sum(), -c.sum()], 1e-15)
linear = double.linearize("swing", th1=0, th2=0)
near("a linear system", linear.A, complex_step(pendulum_rates, np.zeros(4)), 1e-14)
ok("... its names and units", linear.states == ["th1", "th2", "th1'", "th2'"] and linear.outputs[2] == "x2" and linear.units["th1'"] == "rad/s" and linear.values["th1"] == 0, linear)
near("texts with units", double.linearize("swing", th1="180[deg]", th2=0).A[2, 0], complex_step(pendulum_rates, [np.pi, 0, 0, 0])[2, 0], 1e-13)
near("sensitivities by a name of its own", spring.sensitivity("k", "free", times=[1.0])["k"]["x"], -np.sin(2) / 4, 1e-9)
raises("a wrong shape of accelerations", lagc.Error, "not (any, 4)", lambda: double.inverse_dynamics(0, [1, 2], [0, 0]))

# ---- gradients by reverse mode ----
g = spring.gradient("x", "free", x=0.7, until=1.25, tol=1e-12)  # x = 0.7 cos wt + v0/w sin wt, w = sqrt(k/m)
want = [np.cos(2.5), np.sin(2.5) / 2, 0.7 * 1.25 * np.sin(2.5), -0.7 * 1.25 * np.sin(2.5) / 4]  # by x, x', m, k
near("a spring: its closed form", [g.start["x"], g.start["x'"], g.parameters["m"], g.parameters["k"]], want, 1e-10)
near("... and the value", g.value, 0.7 * np.cos(2.5), 1e-11)
weight = np.array([[1, -2, 0.5, 3], [0.3, 1, 2, -1], [2, 1, -1, 0.25]])
times = np.array([0.31, 0.8, 1.3])
for method in ("rk45", "rk4(step=0.01)", "dop853"):  # rows within steps count as ends of shorter ones, as for tangents
    tangents = [double.run("swing", times=[t], tangent=True, method=method).tangent for t in times]
    g = double.gradient(lambda t, y: ((weight * y).sum(), weight), "swing", times=times, method=method)
    forward = sum(w @ Y for w, Y in zip(weight, tangents))
    near(f"{method}: the dot product of forward and reverse mode", g.by_start, forward, 1e-12 * np.max(np.abs(forward)))
for model, scene, out, method, until in (("bouncing_ball", "drop", "y", "dop853", 1.5), ("henon_heiles", None, "x", "verlet4(step=0.02)", 3.01), ("kepler", None, "x", "verlet8(step=0.02)", 1)):
    m = lagc.load(f"models/{model}.lag")
    g = m.gradient(out, scene, method=method, until=until)
    names = [k + "(0)" for k in g.start] + list(g.parameters)
    r = m.run(scene, times=[until], method=method, sensitivity=names)
    forward = np.array([r.sensitivity[k][out][0] for k in names])  # outputs are differentiated by differences of order 6
    near(f"{model}, {method}: starts, events and parameters", [*g.start.values(), *g.parameters.values()], forward, 1e-11 * np.max(np.abs(forward)))
path = os.path.join(os.environ["TMP"], "drive.lag")
with open(path, "w") as f:  # an input's formula, parameters that follow others, a start by a parameter: x'' = -4 x + F/2 sin wt, x(0) = 2 x0, F = 2 f
    f.write("model drive\nparam f = 1.5, F = 2*f, w = 1.5, x0 = 0.2\ncoord x\ninput u = F*sin(w*t)\nlagrangian = x'^2 - 4*x^2\nforce x = u\n"
            "scene a { start x = 2*x0; span 3 [s]; tolerance 1e-11; output x }\n")
g = lagc.load(path).gradient("x", until=2)
drive = lambda f, w, x0: 2 * x0 * np.cos(4) + f * (np.sin(2 * w) - w / 2 * np.sin(4)) / (4 - w * w)
near("inputs, formulas and starts: closed form", [g.parameters[k] for k in ("f", "w", "x0")], complex_step(lambda p: np.array([drive(*p)]), [1.5, 1.5, 0.2])[0], 1e-9)
y0, p = np.array([0.3, 0.5]), np.array([2.0, 8.0])  # of the spring, as arrays: J = x(1)^2
g = spring.gradient(lambda t, y: ((y[-1, 0] ** 2), np.array([[2 * y[-1, 0], 0]])), "free", y0=y0, p=p, times=[1.0], tol=1e-11)
square = lambda a: np.array([(a[0] * np.cos(np.sqrt(a[3] / a[2])) + a[1] / np.sqrt(a[3] / a[2]) * np.sin(np.sqrt(a[3] / a[2]))) ** 2])
near("starts and parameters as arrays", [*g.by_start, *g.by_p], complex_step(square, [*y0, *p])[0], 1e-9)
for library in ("jax", "torch"):  # where they are installed
    try:
        example = __import__(f"{library}_motion")
    except ImportError:
        continue
    if library == "jax":
        got = np.concatenate(example.jax.grad(lambda a, b: (example.of(spring, "free", [1.0])(a, b)[-1, 0]) ** 2, (0, 1))(y0, p))
    else:
        a, b = (example.torch.tensor(x, requires_grad=True) for x in (y0, p))
        (example.Motion.apply(spring, "free", [1.0], a, b)[-1, 0] ** 2).backward()
        got = np.concatenate([a.grad, b.grad])
    near(f"through {library}", got, complex_step(square, [*y0, *p])[0], 1e-7)
by = lambda method: [*double.gradient("x2", "swing", until=0.5, method=method, tol=1e-11).parameters.values()]
near("an implicit method", by("radau"), by("dop853"), 1e-8)
raises("an output that is none", lagc.Error, "did you mean x2?", lambda: double.gradient("x22", "swing"))

# ---- other threads run meanwhile ----
ticks, ended = [], threading.Event()


def tick():
    while not ended.is_set():
        ticks.append(time.perf_counter())
        time.sleep(0.001)


thread = threading.Thread(target=tick)
thread.start()
begin = time.perf_counter()
double.batch("swing", th1=angles[:1000], times=[5], tol=1e-9, method="dop853")
end = time.perf_counter()
ended.set()
thread.join()
inside = sum(begin < t < end for t in ticks)
ok("another thread runs during a batch", inside > 3, f"{inside} times in {end - begin} s")

# ---- errors ----
raises("a wrong name, with the nearest one", lagc.Error, "did you mean th1?", lambda: double.run("swing", th11=1))
raises("a wrong name in a batch", lagc.Error, "did you mean th1?", lambda: double.batch("swing", th11=[1, 2], times=[1]))
raises("a wrong output", lagc.Error, "did you mean energy?", lambda: single["enrgy"])
raises("a wrong scene", lagc.Error, "did you mean swing?", lambda: double.run("swimg"))
raises("a wrong method", lagc.Error, "did you mean rk4", lambda: double.run("swing", method="rk44"))
raises("a wrong option", lagc.Error, "no option", lambda: double.run("swing", method="rk4(stap=1)"))
raises("a wrong sign", lagc.Error, "declares m1 > 0", lambda: double.run("swing", m1=-1))
raises("a text as a value", lagc.Error, "give a number", lambda: double.run("swing", th1="90[deg]"))
raises("a wrong shape", lagc.Error, "not (any, 4)", lambda: double.rhs(0, [1, 2]))
raises("arrays of different lengths", lagc.Error, "differ in length", lambda: double.batch(th1=[1, 2], th2=[1, 2, 3], times=[1]))
raises("an array of other numbers", lagc.Error, "array of doubles", lambda: double.batch(th1=[1, 2], times=[1], out=np.empty((2, 1, 4), np.float32)))
raises("no file", lagc.Error, "none.lag", lambda: lagc.load("none.lag"))
raises("a wrong model: the compiler's text", lagc.CompileError, "error:", lambda: lagc.load("tests/golden/err/sem_unknown_names.lag"))
with open(os.path.join(os.environ["TMP"], "fall.lag"), "w") as f:
    f.write("model fall\ncoord x\nkinetic = x'^2/2\npotential = -1/x\nscene down { start x = 1; span 10 [s] }\n")
try:
    fall = lagc.load(os.path.join(os.environ["TMP"], "fall.lag"))
    fall.run()
    ok("a failed run", False, "nothing is raised")
except lagc.RunError as e:
    # from rest at 1 with x'' = -1/x^2: x = 0 at pi/(2 sqrt 2)
    ok("a failed run: its reason, and the rows before it", "t =" in str(e) and e.status < 0, str(e))
    near("... up to the collision", e.result.t[-1], np.pi / np.sqrt(8), 0.02)
ok("a tolerance brings its method", fall.run(until=0.5, tol=1e-11).method.startswith("taylor") and not fall.run(until=0.5, tol=1e-7).method.startswith("taylor"))
b = fall.batch(x=[1.0, 100], times=[1, 3])
ok("in a batch its status, and NaN from there on", b.status[0] < 0 and b.status[1] == 0 and np.isfinite(b.y[0, 0]).all() and np.isnan(b.y[0, 1]).all() and np.isfinite(b.y[1]).all(), b.status)
# In lanes: 9 motions, which are more than the lanes; the fourth collides. Their sines and sums are rounded in another way.
x = [100, 200, 300, 1.0, 500, 600, 700, 800, 900]
one, lanes = (fall.batch(x=x, times=[0, 1, 3], lanes=k) for k in (False, True))
ok("lanes: the status of each motion", (one.status == lanes.status).all() and (lanes.status < 0).sum() == 1, lanes.status)
near("lanes: the same motions", np.nan_to_num(lanes.y, nan=-1), np.nan_to_num(one.y, nan=-1), 1e-9)
ok("lanes: starts as an array", (fall.batch(y0=[[k, 0] for k in x], times=[0, 1, 3], lanes=True).y[:3] == lanes.y[:3]).all())
if os.environ.get("SLOW"):
    many = double.batch("swing", th1=angles, times=[0.5, 1], tol=1e-6)
    near("10^4 motions: in lanes by themselves", many.y[::100], double.batch("swing", th1=angles[::100], times=[0.5, 1], tol=1e-6).y, 1e-9)
    swept = double.sweep("swing", th1=list(angles[::100]), measure=["th1(1)"], until=1, tol=1e-6)
    # to the tolerance: where processors have other lanes for the two, rounding may cost one of them a step
    near("the numbers of lagc sweep", swept["th1(1)"], many.y[::100, 1, 0], 1e-4)

# A parameter by a formula follows the one that it is made of, in each motion: x'' = -2k x.
path = os.path.join(os.environ["TMP"], "twice.lag")
with open(path, "w") as f:
    f.write("model twice\nparam k = 2, kk = 2*k\ncoord x\nlagrangian = x'^2/2 - kk*x^2/2\nscene a { start x = 1; span 1 [s]; tolerance 1e-11 }\n")
twice = lagc.load(path)
near("formulas of parameters in a batch", twice.batch(k=[2, 4.5], times=[1])["x"][:, 0], [np.cos(2), np.cos(3)], 1e-9)
near("and one that is given itself", twice.batch(k=[2, 4.5], kk=[1, 4], times=[1])["x"][:, 0], [np.cos(1), np.cos(2)], 1e-9)
raises("a start that is no number", lagc.Error, "motion 1 has a value that is not finite", lambda: twice.batch(x=[1, np.nan], times=[1]))
raises("nor text", lagc.Error, "not an array of real numbers", lambda: twice.batch(x=["one", "two"], times=[1]))
raises("nor a table", lagc.Error, "x has the shape (2, 3), not (any)", lambda: twice.batch(x=np.zeros((2, 3)), times=[1]))
raises("nor one of an array", lagc.Error, "y0: motion 1 has a value that is not finite", lambda: twice.batch(y0=[[1, 0], [1, np.inf]], times=[1]))
raises("nor a parameter", lagc.Error, "p: motion 0 has a value that is not finite", lambda: twice.batch(p=[[np.nan, 1], [1, 2]], times=[1]))
raises("nor a time", lagc.Error, "times: row 1 has a value that is not finite", lambda: twice.batch(times=[1, np.nan]))
raises("a start of a run that is no number", lagc.Error, "not a finite number", lambda: twice.run(x=np.nan))
raises("an end that is no number", lagc.Error, "not a finite time", lambda: twice.run(until=np.nan))
raises("an end that is a word", lagc.Error, "until = 'soon': not a number", lambda: twice.run(until="soon"))
raises("rows without a time between them", lagc.Error, "must be positive", lambda: twice.run(every=0))
raises("no rows", lagc.Error, "times is empty", lambda: twice.run(times=[]))
b = spring.batch("free", y0=[[1.0, 0], [0, 2]], p=[[1.0, 9], [4, 4]], times=[1])
near("starts and parameters as arrays: m, k", b["x"][:, 0], [np.cos(3), 2 * np.sin(1)], 1e-9)
raises("parameters of the wrong number", lagc.Error, "p has the shape (1, 3), not (any, 2)", lambda: spring.batch("free", p=[[1, 2, 3]], times=[1]))
raises("a name and its array", lagc.Error, "k and p set the same values", lambda: spring.batch("free", k=[1.0], p=[[1.0, 2]], times=[1]))
raises("a step of nothing", lagc.Error, "a step is positive", lambda: twice.run(method="rk4", step=0))

# ---- a start is moved onto the constraint x^2 + y^2 = 1, here along the radius: (1.1, 0.3)/|(1.1, 0.3)| ----
with warnings.catch_warnings(record=True) as seen:
    warnings.simplefilter("always")
    rod = lagc.load("tests/exec/models/rod.lag")
    r = rod.run("below", x=1.1, y=0.3, times=[0])
    near("the start that was asked for", [r.start_moved["x"][0], r.start_moved["y"][0]], [1.1, 0.3], 1e-15)
    near("and where it went", [r.start_moved["x"][1], r.start_moved["y"][1]], np.array([1.1, 0.3]) / np.hypot(1.1, 0.3), 1e-14)
    ok("a warning says so", len(seen) == 1 and str(seen[0].message).startswith("start moved to the constraints: x from 1.1 to 0.9647638") and seen[0].filename == __file__, seen)
    ok("not of a start on it", not rod.run("drop", times=[0]).start_moved and len(seen) == 1, seen)

# ---- the page ----
with open("runtime/python/README.md") as f:
    exec(f.read().split("```python")[1].split("```")[0].replace("10000", "100"), page := {})
ok("the example of README.md", page["b"].y.shape == (100, 2, 4) and abs(page["m"].batch(y0=[[1, 1, 1, 1]], p=page["p"][:1], times=[1]).y[0, 0, 0]) > 0)

# ---- inputs as functions, constants, display ----
path = os.path.join(os.environ["TMP"], "pushed.lag")
with open(path, "w") as f:
    f.write("model pushed\nconst N = 2\ncoord x\ninput u = 0\nkinetic = x'^2/2*N\nforce x = u\nscene rest { start x = 0; span 1 [s] }\n")
near("a function as input: x'' = 6t/2", lagc.load(path).run(u=lambda t: 6 * t)["x"][-1], 0.5, 1e-9)
near("the same for each of a batch", lagc.load(path).batch(u=lambda t: 6 * t, x=[0, 1], times=[1])["x"], [[0.5], [1.5]], 1e-9)
try:
    lagc.load(path).run(u=lambda t: 1 / 0)
    ok("an input that raises", False, "nothing is raised")
except ZeroDivisionError:
    ok("an input that raises", True)
for name, call in (("of a batch", lambda m: m.batch(u=lambda t: 1 / 0, x=[0, 1], times=[1])), ("of a rate", lambda m: m.rhs(0, [0, 0], u=lambda t: 1 / 0))):
    try:
        call(lagc.load(path))
        ok(f"an input {name} that raises", False, "nothing is raised")
    except ZeroDivisionError:
        ok(f"an input {name} that raises", True)
raises("an input as an array", lagc.Error, "one value or one function", lambda: lagc.load(path).batch(u=[0, 1], times=[1]))
near("a constant", lagc.load(path, {"N": 3}).run(u=6)["x"][-1], 1, 1e-9)
# ---- what is no method, name, number of threads, sign ----
raises("a method that is a number", lagc.Error, "method = 7: give a text", lambda: twice.run(method=7))
raises("a name that is a number", lagc.Error, "1 is not a name", lambda: twice.run(values={1: 2}))
raises("values that are no dictionary", lagc.Error, "give a dictionary", lambda: twice.batch(values=3, times=[1]))
raises("a scene that is a number", lagc.Error, "has no scene 7", lambda: twice.run(7))
raises("threads below 1", lagc.Error, "threads = -3", lambda: twice.batch(times=[1], threads=-3))
raises("lanes that no vector has", lagc.Error, "lanes = 3", lambda: twice.batch(times=[1], lanes=3))
raises("starts that are text", lagc.Error, "not an array of real numbers", lambda: twice.batch(times=[1], y0=[["a"] * 4]))
raises("parameters in a dictionary", lagc.Error, "not an array of real numbers", lambda: double.batch("swing", times=[1], p={"m1": [1, 2]}))
raises("out that is a list", lagc.Error, "writable array", lambda: twice.batch(times=[1], out=[1]))
raises("a vector that is too short", lagc.Error, "x has the shape (1,)", lambda: double.jvp(0, [1, 1, 0, 0], [1], "swing"))
raises("times that are too many", lagc.Error, "t has the shape (3,)", lambda: double.rhs([0, 1, 2], [[1, 1, 0, 0]] * 2, "swing"))
raises("a motion with a wrong sign", lagc.Error, "motion 1: m1 = -2: the model declares m1 > 0", lambda: double.batch("swing", m1=[1, -2, 3], times=[1]))
ends, block = double.batch("swing", th1=[1, 2, 3], times=[1], method="rk4", step=0.01).y, np.zeros(13)
starts = block[:12].reshape(3, 4)
starts[:] = double.batch("swing", times=[0]).y[0, 0]
starts[:, 0] = 1, 2, 3
ok("states that overwrite their starts", np.array_equal(double.batch("swing", y0=starts, times=[1], method="rk4", step=0.01, out=block[1:].reshape(3, 1, 4)).y, ends))

# ---- the text of a model is that of its loading; Ctrl-C ends a run ----
import os, signal, threading, time  # noqa: E401
with open(path, "w") as f:
    f.write("model ball\ncoord x [m]\nparam g = 1 [m/s^2]\nkinetic = x'^2/2\nforce x = g\nscene run { span 1 [s] }\n")
ball = lagc.load(path)
with open(path, "w") as f:
    f.write("model ball\ncoord x [m]\nparam g = 2 [m/s^2]\nkinetic = x'^2/2\nforce x = g\nscene run { span 1 [s] }\n")
near("a method that is compiled after the file was edited: the text as it was loaded", ball.run(method="gauss", step=0.1)["x"][-1], 0.5, 1e-12)
near("sweeps, too", ball.sweep(x=[0, 1], measure={"X": "x"}, method="rk4", step=0.1)["X"], [0.5, 1.5], 1e-12)
ball.run(times=[1], method="rk4", step=1e-3)
threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
began = time.time()
try:
    ball.run(times=[1e9], method="rk4", step=1e-3)
except KeyboardInterrupt:
    pass
ok("Ctrl-C in a long run is heard within a second", time.time() - began < 1.1, time.time() - began)
lagc._PATIENCE = 1e-9
near("a run that looks for it at each step has the same bits", ball.run(method="rk4", step=0.001)["x"][-1] - lagc.load(path).run(g=1, method="rk4", step=0.001)["x"][-1], 0, 0)

# ---- sweeps: x(1) = x + v t of a free body ----
with open(path, "w") as f:
    f.write("model free\ncoord x\nconst N = 1\nlagrangian = N*x'^2/2\nscene run { span 1 [s] }\n")
free = lagc.load(path, {"N": 2})
s = free.sweep("run", {"x'": [0, 0.5]}, x="1..3:3", measure={"X": "x"}, method="rk4", step=0.5)
near("a sweep: all combinations", s["X"], [1, 2, 3, 1.5, 2.5, 3.5], 1e-12)
near("the values of each", [s["x'"], s["x"]], [[0, 0, 0, 0.5, 0.5, 0.5], [1, 2, 3, 1, 2, 3]], 0)
near("samples of a distribution", np.mean(free.sweep(x="~uniform(0, 1)", samples=64, sampling="lhs", measure="x", method="rk4", step=0.5)["x(end)"]), 0.5, 0.01)
raises("a measure that is not there", lagc.CompileError, "did you mean", lambda: free.sweep(x=[1, 2], measure="xx"))
ok("LaTeX of the equations", spring._repr_latex_().startswith("$$\\begin{aligned}") and "\\ddot{x}" in spring._repr_latex_())
ok("a picture", single._repr_svg_().count("<polyline") == 5 and single._repr_svg_().endswith("</svg>"))
ok("texts", "scenes" in repr(spring) and "energy drift" in repr(single) and "m*x''" in spring.equations)
with warnings.catch_warnings(record=True) as seen:
    warnings.simplefilter("always")
    with open(path, "a") as f:
        f.write("param unused = 1\n")
    lagc.load(path)
ok("a warning of the compiler", any("unused" in str(w.message) for w in seen), seen)
print(f"1..{count}")
sys.exit(0)
