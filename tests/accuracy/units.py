"""Verdicts of runs in other units, and beside parts at rest: the error, its growth and horizon, drifts and their trends, --accuracy, effects that are needed.

  python3 tests/accuracy/units.py [--few] [--of N] [--verbose]

Each of 40 models, 28 of them random, runs in units of mass, length and time that are 2^-30, 1 or 2^30 times (1e-9 to 1e9) the first ones, alone and beside parts at rest: a pendulum that hangs at an angle of
180 degrees, a mass whose spring carries its weight, a crate on a floor. Powers of 2 scale each operation, so that a run has the same digits, also where steps are
chosen from the tolerance, and verdicts are the same text; parts at rest may change the last digits of a sum. --few: three models, for `make test`. --of N: one model in N, another each DAY (a variable of the environment). Exit status 1: a verdict differs.
"""
import argparse
import json
import os
import random
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from starts import run

# text, {name: (value, powers of mass, length and time)}, method, span; a coordinate's unit is that of its start
MODELS = {
    "spring": ("coord x [m]\nparam m = 1 [kg] > 0, k = 4 [N/m] > 0\nkinetic = m/2*x'^2\npotential = k/2*x^2", {"m": (1, 1, 0, 0), "k": (4, 1, 0, -2), "x": (0.1, 0, 1, 0)}, "rk4(step={})", 20),
    "pendulum": ("coord th\nparam m = 1 [kg] > 0, l = 0.5 [m] > 0, a = 9.81 [m/s^2] > 0\nkinetic = m*l^2/2*th'^2\npotential = -m*a*l*cos(th)",
                 {"m": (1, 1, 0, 0), "l": (0.5, 0, 1, 0), "a": (9.81, 0, 1, -2), "th": (2, 0, 0, 0)}, "rk4(step={})", 20),
    "drop": ("coord x [m], y [m]\nparam m = 2 [kg] > 0, a = 9.81 [m/s^2] > 0\nkinetic = m/2*(x'^2 + y'^2)\npotential = m*a*y", {"m": (2, 1, 0, 0), "a": (9.81, 0, 1, -2), "x": (1, 0, 1, 0), "y": (3, 0, 1, 0), "x'": (2, 0, 1, -1)}, "rk4(step={})", 4),
    "kepler": ("coord x [m], y [m]\nparam m = 1 [kg] > 0, mu = 1 [m^3/s^2] > 0\nkinetic = m/2*(x'^2 + y'^2)\npotential = -m*mu/sqrt(x^2 + y^2)",
               {"m": (1, 1, 0, 0), "mu": (1, 0, 3, -2), "x": (1, 0, 1, 0), "y": (0, 0, 1, 0), "y'": (1.25, 0, 1, -1)}, "verlet4(step={})", 60),
    "quartic": ("coord x [m]\nparam m = 1 [kg] > 0, k = 4 [N/m^3] > 0\nkinetic = m/2*x'^2\npotential = k/4*x^4", {"m": (1, 1, 0, 0), "k": (4, 1, -2, -2), "x": (0.75, 0, 1, 0)}, "gauss(step={})", 30),
    "double": ("coord a, b\nparam m = 1 [kg] > 0, l = 1 [m] > 0, ac = 9.81 [m/s^2] > 0\nlet x1 = l*sin(a)\nlet y1 = -l*cos(a)\nlet x2 = x1 + l*sin(b)\nlet y2 = y1 - l*cos(b)\n"
               "kinetic = m*(x1'^2 + y1'^2)/2 + m*(x2'^2 + y2'^2)/2\npotential = m*ac*(y1 + y2)", {"m": (1, 1, 0, 0), "l": (1, 0, 1, 0), "ac": (9.81, 0, 1, -2), "a": (2, 0, 0, 0), "b": (2.5, 0, 0, 0)}, "rk4(step={})", 40),
    "damped": ("coord x [m]\nparam m = 1 [kg] > 0, k = 4 [N/m] > 0, c = 0.1 [N*s/m] >= 0\nkinetic = m/2*x'^2\npotential = k/2*x^2\ndissipation = c/2*x'^2",
               {"m": (1, 1, 0, 0), "k": (4, 1, 0, -2), "c": (0.1, 1, 0, -1), "x": (0.5, 0, 1, 0)}, "rk4(step={})", 20),
    "ball": ("coord y [m]\nparam m = 1 [kg] > 0, a = 9.81 [m/s^2] > 0\nkinetic = m/2*y'^2\npotential = m*a*y\ncontact floor: y >= 0, restitution = 1", {"m": (1, 1, 0, 0), "a": (9.81, 0, 1, -2), "y": (1, 0, 1, 0)}, "rk4(step={})", 5),
    "rod": ("coord x [m], y [m]\nparam m = 1 [kg] > 0, l = 1 [m] > 0, a = 9.81 [m/s^2] > 0\nkinetic = m/2*(x'^2 + y'^2)\npotential = m*a*y\nconstraint rod: x^2 + y^2 = l^2",
            {"m": (1, 1, 0, 0), "l": (1, 0, 1, 0), "a": (9.81, 0, 1, -2), "x": (1, 0, 1, 0), "y": (0, 0, 1, 0)}, "rk4(step={})", 5),
    "duffing": ("coord x [m]\nparam m = 1 [kg] > 0, a = 1 [N/m] > 0, b = 1 [N/m^3] > 0\nkinetic = m/2*x'^2\npotential = -a/2*x^2 + b/4*x^4", {"m": (1, 1, 0, 0), "a": (1, 1, 0, -2), "b": (1, 1, -2, -2), "x": (1.5, 0, 1, 0)}, "dop853", 40),
    "stiff": ("coord x [m]\nparam m = 1 [kg] > 0, a = 1 [N/m] > 0, b = 1 [N/m^3] > 0, c = 0.2 [N*s/m] >= 0\nkinetic = m/2*x'^2\npotential = -a/2*x^2 + b/4*x^4\ndissipation = c/2*x'^2",
              {"m": (1, 1, 0, 0), "a": (1, 1, 0, -2), "b": (1, 1, -2, -2), "c": (0.2, 1, 0, -1), "x": (0, 0, 1, 0), "x'": (1.5, 0, 1, -1)}, "radau", 40),
    "magnet": ("coord x [m], y [m]\nparam m = 1 [kg] > 0, B = 1 [kg/s] > 0\nkinetic = m/2*(x'^2 + y'^2)\nlagrangian = B*(x*y' - y*x')/2", {"m": (1, 1, 0, 0), "B": (1, 1, 0, -1), "x": (0.5, 0, 1, 0), "y": (0, 0, 1, 0), "x'": (0.75, 0, 1, -1)}, "rk4(step={})", 40),
}


def made(k):
    """A random model: masses on springs, linear and cubic, some with weight, some coupled, some in a field that turns them."""
    rng, names = random.Random(k), ["x", "y", "z"][:1 + k % 3]
    params, kinetic, potential, named = [], [], [], {}

    def parameter(name, unit, powers):
        named[name] = (rng.randint(4, 40) / 16, *powers)
        params.append(f"{name} = {named[name][0]} [{unit}] > 0")
        return name

    for i, x in enumerate(names):
        kinetic.append(f"{parameter('m' + x, 'kg', (1, 0, 0))}/2*{x}'^2")
        potential.append(f"{parameter('k' + x, 'N/m', (1, 0, -2))}/2*{x}^2")
        if rng.random() < 0.5:
            potential.append(f"{parameter('b' + x, 'N/m^3', (1, -2, -2))}/4*{x}^4")
        if rng.random() < 0.3:
            potential.append(f"m{x}*{parameter('g' + x, 'm/s^2', (0, 1, -2))}*{x}")
        if i:
            potential.append(f"{parameter('c' + x, 'N/m', (1, 0, -2))}/2*({x} - {names[i - 1]})^2")
        named[x], named[x + "'"] = (rng.randint(-16, 16) / 16, 0, 1, 0), (rng.randint(-16, 16) / 16, 0, 1, -1)
    L = [f"lagrangian = {parameter('B', 'kg/s', (1, 0, -1))}*(x*y' - y*x')"] if len(names) > 1 and rng.random() < 0.5 else []
    text = ["coord " + ", ".join(f"{x} [m]" for x in names), "param " + ", ".join(params), "kinetic = " + " + ".join(kinetic), "potential = " + " + ".join(potential), *L]
    return "\n".join(text), named, rng.choice(["rk4(step={})", "gauss(step={})", "dop853", "taylor"]), rng.choice([5, 20, 60])


MODELS |= {f"made_{k}": made(k) for k in range(28)}
REST = {
    "": ("", {}),
    "hanging": ("coord ph\nparam I = 0.25 [kg*m^2] > 0, tq = 4.9 [N*m] > 0\nkinetic = I/2*ph'^2\npotential = tq*cos(ph)", {"I": (0.25, 1, 2, 0), "tq": (4.9, 1, 2, -2), "ph": (3.141592653589793, 0, 0, 0)}),
    "carried": ("coord u [m]\nparam mu2 = 3 [kg] > 0, ku = 7 [N/m] > 0, w = 9.81 [m/s^2] > 0\nkinetic = mu2/2*u'^2\npotential = ku/2*u^2 + mu2*w*u",
                {"mu2": (3, 1, 0, 0), "ku": (7, 1, 0, -2), "w": (9.81, 0, 1, -2), "u": (-3 * 9.81 / 7, 0, 1, 0)}),
    "turned": ("coord ps\nparam J = 0.125 [kg*m^2] > 0, tr = 2 [N*m] > 0\nkinetic = J/2*ps'^2\npotential = tr*(1 - cos(ps))", {"J": (0.125, 1, 2, 0), "tr": (2, 1, 2, -2), "ps": (6.283185307179586, 0, 0, 0)}),
}
UNITS = [(0, 0, 0), (30, 0, 0), (-30, 0, 0), (0, 30, 0), (0, -30, 0), (0, 0, 30), (0, 0, -30), (30, -30, 30), (-30, 30, -30)]


def values_of(named, units):
    """name=value for each parameter and start in these units, powers of 2."""
    return [f"{name}={value * 2.0**sum(p * u for p, u in zip(powers, units))!r}" for name, (value, *powers) in named.items()]


def parts(text):
    """kinetic and potential of two texts cannot both stand: they are numbered lets, and one Lagrangian."""
    out, L = [], []
    for line in text.split("\n"):
        head, _, rest = line.partition(" = ")
        if head in ("kinetic", "lagrangian"):
            L.append("+ " + rest)
        elif head == "potential":
            L.append("- (" + rest + ")")
        elif line:
            out.append(line)
    return out, L


def write(folder, name, rest):
    (text, named, _, _), (more, still) = MODELS[name], REST[rest]
    lines, L = parts(text)
    others, M = parts(more)
    starts = ", ".join(f"{k} = {v[0]!r}" for k, v in {**named, **still}.items() if any(line.startswith("coord ") and k.rstrip("'") in line.replace(",", " ").split() for line in lines + others))
    path = f"{folder}/{name}_{rest}.lag"
    with open(path, "w", encoding="utf-8") as f:
        f.write(f"model {name}\n" + "\n".join(lines + others) + "\nlagrangian = " + " ".join(L + M).lstrip("+ ") + f"\nscene s {{ start {starts} }}\n")
    return path


def verdict(path, name, rest, units):
    _, named, method, span = MODELS[name]
    time = 2.0 ** units[2]
    values = values_of({**named, **REST[rest][1]}, units)
    status, out, err = run(["run", path, *values, "--until", repr(span * time), "--method", method.format(repr(span * time / 4096)), "--json", "-o", os.devnull])
    if status != 0:
        return {"status": status, "message": err.strip()[:200]}
    r = json.loads(out)
    charge = r["charges"]["energy"]
    horizon = r["horizon"] and r["horizon"] / time
    return {"error": r["error"], "growth": r["error_growth"], "horizon": horizon, "formula": (r.get("formula_noise") or 0) > 1e-6, "drift": charge["drift"], "trend": charge["trend"], "is": charge["is"]}


def alike(a, b, exact, times=3):
    """Whether two verdicts agree: numbers to a factor of 1.5, or of `times` where their last digits may differ; below 1e-12 all is rounding. Beside parts at rest the energy's drift is
    relative to more, and a law may not be seen."""
    for k in a.keys() | b.keys():
        x, y = a.get(k), b.get(k)
        if not exact and (k in ("drift", "trend") or (k == "growth" and None in (x, y))):
            continue
        if isinstance(x, float) and isinstance(y, float):
            small = max(abs(x), abs(y)) < 1e-12
            if not small and not abs(x - y) <= (0.5 if exact else times - 1) * min(abs(x), abs(y)):
                return False
        elif x != y:
            return False
    return True


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--few", action="store_true")
    p.add_argument("--of", type=int, default=1)
    p.add_argument("--verbose", action="store_true")
    a = p.parse_args()
    bad = done = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in ("spring", "double", "duffing") if a.few else list(MODELS)[int(os.environ.get("DAY", 0)) % a.of::a.of]:
            alone = None
            for rest in ("", "hanging") if a.few else REST:
                path, first = write(folder, name, rest), None
                for units in UNITS[::4] if a.few else UNITS:
                    v = verdict(path, name, rest, units)
                    first, alone = first or v, alone or v
                    good = alike(v, first, True) and alike(v, alone, False, 50 if MODELS[name][2] == "taylor" else 3)  # taylor chooses other steps beside a large value
                    done += 1
                    bad += not good
                    if a.verbose or not good:
                        print("ok " if good else "BAD", name, rest or "alone", units, v, "" if good else f"\n   for {first}, alone {alone}", flush=True)
    print(f"{done} runs, {bad} verdicts differ")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
