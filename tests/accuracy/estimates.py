"""The error line of `lagc run`, judged by runs in long double: 200 random runs of 14 models, each with a random start, parameters, method, setting and span.

  python3 tests/accuracy/estimates.py [--n 200] [--seed 1] [--verbose]

The true error is the largest at 800 times, relative to the largest value of the same kind and unit, up to where the report says that it knows. Asked: never understated
by more than 3, overstated by more than 5 in at most 5 % (errors below 1e-14 are rounding, and alike), horizons within 1.6 times the true one. A law of growth
is right if the run, continued to twice its span, goes on by it: the median of the error's logarithm over the last fifth grows as the law says, times or over 1.6.
Exit status 1: one understated, more than 5 % overstated, or fewer than 95 % of the laws claimed right.
"""
import argparse
import bisect
import json
import math
import os
import random
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from starts import exact, rows, run

ROUNDING = 1e-14  # of some hundred operations: the estimate and the error are luck below
LOST = 0.3        # an error that leaves no digit

# text, {start or parameter: (from, to)}, spans, a time of the motion [s]
MODELS = {
    "oscillator": ("coord x\nparam k = 1\nlagrangian = x'^2/2 - k*x^2/2", {"x": (0.5, 2), "x'": (-1, 1), "k": (0.5, 4)}, (10, 200), 4),
    "pendulum": ("coord th\nparam w = 1\nlagrangian = th'^2/2 + w*cos(th)", {"th": (-2.9, 2.9), "w": (0.5, 4)}, (10, 300), 4),
    "double": ("coord a, b\nlet x1 = sin(a)\nlet y1 = -cos(a)\nlet x2 = x1 + sin(b)\nlet y2 = y1 - cos(b)\n"
               "kinetic = (x1'^2 + y1'^2)/2 + (x2'^2 + y2'^2)/2\npotential = 9.81*(y1 + y2)", {"a": (-2.5, 2.5), "b": (-2.5, 2.5)}, (3, 40), 1),
    "kepler": ("coord x, y\nlagrangian = (x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)", {"x": (0.7, 1.5), "y'": (0.6, 1.1), "x'": (-0.2, 0.2)}, (10, 600), 6),
    "comet": ("coord x, y\nlagrangian = (x'^2 + y'^2)/2 + 1/sqrt(x^2 + y^2)", {"x": (0.8, 1.2), "y'": (0.08, 0.5), "x'": (-0.1, 0.1)}, (5, 200), 1),
    "henon": ("coord x, y\nlagrangian = (x'^2 + y'^2)/2 - (x^2 + y^2)/2 - x^2*y + y^3/3", {"x": (-0.3, 0.3), "y": (-0.3, 0.3), "x'": (-0.3, 0.3), "y'": (-0.3, 0.3)}, (20, 400), 6),
    "spring": ("coord r, th\nlet x = r*sin(th)\nlet y = -r*cos(th)\nkinetic = (x'^2 + y'^2)/2\npotential = 20*(r - 1)^2 + 9.81*y", {"r": (0.9, 1.6), "th": (-1.2, 1.2)}, (5, 100), 1.5),
    "damped": ("coord x\nparam c = 0.1\nlagrangian = x'^2/2 - x^4/4\neffect drag { dissipation = c/2*x'^2 }", {"x": (0.5, 2), "c": (0.02, 0.5)}, (10, 100), 4),
    "driven": ("coord x\nparam F = 0.3, w = 1.2, c = 0.2\nlagrangian = x'^2/2 + x^2/2 - x^4/4 + F*x*cos(w*t)\neffect drag { dissipation = c/2*x'^2 }",
               {"x": (0.5, 1.5), "F": (0.1, 0.6), "w": (0.8, 1.6), "c": (0.05, 0.4)}, (20, 200), 5),
    "three": ("coord r[3]: vec2\nlagrangian = sum(i in 1..3, dot(r[i]', r[i]')/2) + sum(i in 2..3, sum(j in 1..i-1, 1/norm(r[i] - r[j])))",
              {"r[1].x": (-1.2, -0.8), "r[2].x": (0.8, 1.2), "r[3].y": (1.3, 2), "r[1].y'": (0.3, 0.7), "r[2].y'": (-0.7, -0.3), "r[3].x'": (0.2, 0.6)}, (3, 60), 3),
    "chain": ("coord x[4]\nlagrangian = sum(i in 1..4, x[i]'^2/2) - sum(i in 1..3, (x[i+1] - x[i])^2/2 + (x[i+1] - x[i])^4/4) - x[1]^2/2",
              {"x[1]": (-1, 1), "x[2]": (-1, 1), "x[3]": (-1, 1), "x[4]": (-1, 1)}, (10, 200), 4),
    "magnet": ("coord x, y, z\nlagrangian = (x'^2 + y'^2 + z'^2)/2 + (1 + 0.25*z^2)*(x*y' - y*x')/2 - 0.125*z^2", {"x'": (0.3, 1), "z'": (0.1, 0.6), "x": (0.2, 1)}, (10, 300), 6),
    "lorenz": ("state x, y, z\nflow x' = 10*(y - x)\nflow y' = x*(28 - z) - y\nflow z' = x*y - 2.5*z", {"x": (-5, 5), "y": (-5, 5), "z": (10, 30)}, (2, 40), 0.7),
    "wire": ("coord x, y\nkinetic = (x'^2 + y'^2)/2\npotential = 9.81*y\nconstraint rod: x^2 + y^2 = 1", {"x'": (0.5, 4)}, (5, 60), 2),
    "ball": ("coord x, y\nlagrangian = (x'^2 + y'^2)/2 - x^2/2 - 9.81*y\ncontact floor: y >= 0, restitution = 1", {"x": (0.5, 1.5), "y": (0.5, 2)}, (3, 60), 1),
}
EXTRA = {"comet": "y = 0, ", "kepler": "y = 0, ", "magnet": "y = 0.25, ", "wire": "y = -1, x = 0, "}
FIXED = {"r[1].x": -1, "r[2].x": 1, "r[3].y": 1.5}
METHODS = [("dop853", "tol", (1e-13, 1e-5)), ("rk45", "tol", (1e-10, 1e-4)), ("taylor", "tol", (1e-15, 1e-7)), ("rk4", "step", (2e-4, 2e-2)), ("verlet", "step", (2e-4, 1e-2)),
           ("verlet4", "step", (1e-3, 3e-2)), ("gauss", "step", (3e-3, 5e-2)), (None, "tol", (1e-13, 1e-5)),
           ("verlet6", "step", (2e-3, 1e-1)), ("verlet8", "step", (5e-3, 2e-1)), ("gauss(stages=4)", "step", (1e-2, 2e-1)), ("dop853(adapt=off)", "step", (5e-3, 1e-1)),
           ("variational(order=6)", "step", (1e-2, 1e-1)), ("radau", "tol", (1e-10, 1e-4))]
SYMPLECTIC = ("verlet", "gauss", "variational")


def log_uniform(rng, a, b):
    return math.exp(rng.uniform(math.log(a), math.log(b)))


def write(folder):
    for name, (text, ranges, _, _) in MODELS.items():
        starts = [k for k in ranges if k.split("[")[0].split(".")[0].rstrip("'") not in ("k", "w", "c", "F")]
        body = ", ".join(f"{k} = {ranges[k][0]}" for k in starts)
        with open(f"{folder}/{name}.lag", "w", encoding="utf-8") as f:
            use = "; use drag" if "effect drag" in text else ""
            f.write(f"model {name}\n{text}\nscene s {{ start {EXTRA.get(name, '')}{body}; span {MODELS[name][2][1]}{use} }}\n")


def read(path):
    """Times, and rows of the state; column names."""
    head, data = rows(path)
    return head, data


def deviations(a, b, head):
    """Error at each common time, relative to the largest value of its kind up to the end."""
    kinds = [name.endswith("'") + 2 * (unit != "") for name, unit in head]
    scale, state = {}, [k for k in range(1, len(head)) if head[k][0] != "energy" and not head[k][0].startswith("lambda")]
    for k in state:
        scale[kinds[k]] = max([scale.get(kinds[k], 0)] + [abs(r[k]) for r in b])
    out = []
    for x, y in zip(a, b):
        e = max(abs(x[k] - y[k]) / (scale[kinds[k]] or 1) for k in state)
        out.append((x[0], e))
    return out


def level(errors, a, b):
    logs = sorted(math.log(max(e, 1e-300)) for t, e in errors if a <= t <= b)
    return math.exp(logs[len(logs) // 2]) if logs else float("nan")


def parted(errors, later=lambda i, t: i + 40, quantile=0.25, large=LOST / 10):
    """The time from which on no digit is left: the error is large there, and stays so."""
    for i, (t, e) in enumerate(errors):
        if e >= LOST:
            after = sorted(x for _, x in errors[i:later(i, t)])
            if after[int(quantile * len(after))] > large:
                return t
    return None


def parted_for_good(errors):
    """The same, where most of the next quarter of that time has no digit: close encounters lose them for moments before."""
    times = [t for t, _ in errors]
    return parted(errors, lambda i, t: bisect.bisect(times, 1.25 * t), 0.5, LOST) or errors[-1][0]


class Case:
    def __init__(self, rng, folder, method_names=(), models=()):
        self.name = rng.choice(models or list(MODELS))
        _, ranges, spans, unit = MODELS[self.name]
        self.folder, self.path = folder, f"{folder}/{self.name}.lag"
        self.values = [f"{k}={exact(rng.uniform(*r))}" for k, r in ranges.items()]
        self.until = float(exact(log_uniform(rng, *spans)))
        while True:
            method, kind, r = rng.choice(METHODS)
            symplectic = method is not None and method.startswith(SYMPLECTIC)
            if method == "taylor" and self.name in ("wire",) or symplectic and self.name in ("lorenz", "damped", "driven", "ball"):
                continue
            if method_names and (method or "").split("(")[0] not in method_names:
                continue
            break
        x = log_uniform(rng, *r) * (unit / 3 if kind == "step" else 1)
        if kind == "step":
            x = max(x, self.until / 200000)
        self.rows = 800
        self.how = (["--method", method] if method else []) + [f"--{kind}", f"{x:.3g}"]

    def words(self, until):
        return ["run", self.path, *self.values, "--until", repr(until), "--every", repr(until / self.rows)]

    def double(self, until, out):
        status, text, err = run([*self.words(until), *self.how, "--json", "-o", out])
        return (json.loads(text), read(out)) if status == 0 else (None, err.strip()[:120])

    def reference(self, until, out):
        for how in (["taylor", "--tol", "2e-18"], ["dop853", "--tol", "1e-17"]):
            status, _, err = run([*self.words(until), "--precision", "long", "--method", *how, "--quiet", "-o", out])
            if status == 0:
                return read(out)
        return None

    def errors(self, until):
        a, b = f"{self.folder}/a.csv", f"{self.folder}/b.csv"
        report, motion = self.double(until, a)
        if report is None:
            return None, motion
        true = self.reference(until, b)
        if true is None:
            return None, "no reference"
        return report, deviations(motion[1], true[1], true[0])

    def text(self):
        return " ".join([self.name, *self.values, "--until", repr(self.until), *self.how])


def grows_as(case, law, errors):
    """Whether the error goes on by its law in a run twice as long; None: it cannot be told, near no digit."""
    _, longer = case.errors(2 * case.until)
    if isinstance(longer, str):
        return None
    T = case.until
    before, after = level(longer, 0.8 * T, T), level(longer, 1.6 * T, 2 * T)
    if law == "bounded":  # it may have been larger before
        before = max([before] + [level(longer, 0.2 * k * T, 0.2 * (k + 1) * T) for k in range(5)])
    if not before > 0 or (law != "exponential" and after > 0.03):
        return None
    ratio = after / before
    if law == "exponential":
        return ratio > 6 or after > 0.03
    want = {"bounded": 1, "t": 2, "t^2": 4}[law]
    return ratio < want * 1.6 and (law == "bounded" or ratio > want / 1.6)


def judge(case):
    """(verdict, claimed law or None, whether it is right, note)"""
    report, errors = case.errors(case.until)
    if report is None:
        return "left out", None, None, errors
    horizon, to = report["horizon"], report["error_known_to"]
    true_end = parted(errors)
    law = report["error_growth"]
    if horizon is not None:
        if true_end is None:
            return ("ok" if max(e for _, e in errors) > LOST / 5 else "over"), None, None, f"horizon {horizon} of none"
        early = horizon < true_end / 1.6 and max(e for t, e in errors if t <= horizon) < LOST / 5
        late = horizon > 1.6 * parted_for_good(errors)
        return ("over" if early else "under" if late else "ok"), None, None, f"horizon {horizon:.3g} for {true_end:.3g}"
    if to is None or report["error_up_to_there"] is None:
        return "unknown", None, None, "no estimate"
    estimate, true = report["error_up_to_there"], max(e for t, e in errors if t <= to * (1 + 1e-12))
    q = (estimate + ROUNDING) / (true + ROUNDING)
    if not 1 / 3 <= q <= 5 and case.rows < 400000:  # more times show close encounters: velocities are large, or wrong, for a moment
        case.rows = 400000
        again = judge(case)
        case.rows = 800
        return again
    verdict = "under" if q < 1 / 3 else "over" if q > 5 and not report["error_at_most"] else "ok"
    right = grows_as(case, law, errors) if law and (true_end is None) else None
    return verdict, law, right, f"estimate {estimate:.2g} true {true:.2g}{'' if to >= case.until else f' to {to:.3g}'}"


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--n", type=int, default=200)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--methods", default="", help="names, with commas between: these alone")
    p.add_argument("--models", default="", help="the same of models")
    p.add_argument("--verbose", action="store_true")
    a = p.parse_args()
    rng = random.Random(a.seed)
    count, laws, silent = {}, {True: 0, False: 0, None: 0}, 0
    with tempfile.TemporaryDirectory() as folder:
        write(folder)
        for i in range(a.n):
            case = Case(rng, folder, *[[m for m in names.split(",") if m] for names in (a.methods, a.models)])
            verdict, law, right, note = judge(case)
            count[verdict] = count.get(verdict, 0) + 1
            if law:
                laws[right] += 1
            elif verdict in ("ok", "over", "under"):
                silent += 1
            if a.verbose or verdict in ("under", "over") or right is False:
                print(f"{i}: {verdict}, {law or 'no law'} {'' if right is None else 'right' if right else 'WRONG'}: {note}: {case.text()}", flush=True)
    done = sum(count.get(k, 0) for k in ("ok", "under", "over", "unknown"))
    claimed = laws[True] + laws[False]
    print(f"{done} runs: {count}; laws claimed {sum(laws.values())}, right {laws[True]} of {claimed} judged; without a law {silent}")
    bad = count.get("under", 0) > 0 or count.get("over", 0) > 0.05 * done or laws[True] < 0.95 * claimed or done < 0.9 * a.n
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
