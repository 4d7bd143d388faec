"""lagc run --accuracy, judged by runs in long double: is the error below what was asked, and is the estimate within a factor of 10 of it?

  python3 tests/accuracy/starts.py [--n 100] [--seed 1] [--ask 1e-8] [MODEL.lag ...]

Each model's first scene runs from N starts, whose coordinates, velocities and parameters are those of the scene times 1 +- 0.05 (parameters alone where
there are constraints). Errors are the largest at 400 times, relative to the largest value of the same kind and unit. A refusal counts as kept where
the reference, too, has lost its digits to the error of a double by then. A row a model; the last lines sum up. Exit status 1: fewer than 95 of 100 of
a model are kept, or estimates are off by more.
"""
import argparse
import csv
import decimal
import glob
import json
import math
import os
import random
import subprocess
import sys
import tempfile

LAGC = os.environ.get("LAGC", "build/lagc")


def exact(x):
    """A number near x with few bits, in all of its decimals: both precisions read the same."""
    k = 2 ** (24 - math.frexp(x)[1]) if x else 1
    return format(decimal.Decimal(round(x * k) / k), "f")


def run(args, timeout=120):
    try:
        p = subprocess.run([LAGC, *args], capture_output=True, text=True, timeout=timeout, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return 124, "", "timeout"
    return p.returncode, p.stdout, p.stderr


def first_scene(path):
    for line in open(path, encoding="utf-8"):
        words = line.split()
        if words[:1] == ["scene"]:
            return words[1]
    return None


def rows(path):
    """Columns of a CSV file by name, with [unit] apart."""
    with open(path, newline="", encoding="utf-8") as f:
        table = list(csv.reader(f))
    names = [(c.split(" [")[0], c.split(" [")[1].rstrip("]") if " [" in c else "") for c in table[0]]
    return names, [[float(x) for x in r] for r in table[1:]]


def error(names, motion, reference, state):
    """Largest difference of the state at common times, relative to the largest value of the same kind and unit."""
    if len(motion) < len(reference):
        return float("inf")
    scale = {}
    names = [(name if name in state else "", unit) for name, unit in names]
    for k, (name, unit) in enumerate(names[1:], 1):
        if not name:
            continue
        kind = (name.endswith("'"), unit)
        scale[kind] = max([scale.get(kind, 0)] + [abs(r[k]) for r in reference])
    worst = 0
    for a, b in zip(motion, reference):
        if abs(a[0] - b[0]) > 1e-9 * max(1, abs(b[0])):
            continue
        for k, (name, unit) in enumerate(names[1:], 1):
            if not name:
                continue
            s = scale[(name.endswith("'"), unit)] or 1
            d = abs(a[k] - b[k]) / s
            worst = d if not d <= worst else worst
    return worst


def judge(path, n, rng, ask, folder):
    scene = first_scene(path)
    base = [path] + ([scene] if scene else [])
    status, out, err = run(["run", *base, "--json"])
    if status not in (0, 3) or not out:
        return None, f"the run fails: {err.strip()[:90]}"
    whole = json.loads(out)
    status, text, _ = run(["build", *base[:1], "-o", f"{folder}/sim"])
    listed = subprocess.run([f"{folder}/sim", "--help"], capture_output=True, text=True).stdout.splitlines()
    params = [w for line in listed if line.startswith("parameters: ") for w in line[len("parameters: "):].split(", ")]
    named = {kind: [w.split(" = ")[0].split(" [")[0] for line in listed if line.startswith(kind + ": ") for w in line.split(": ")[1].split(", ")] for kind in ("coordinates", "states")}
    until = whole["t_end"]
    constrained = "constraints" in whole
    names = [k for k in whole["final"] if not k.startswith("lambda") and k != "energy"]
    state = [k for k in names if k.rstrip("'") in named["coordinates"] or k in named["states"]]
    if len(state) > 40:
        return None, f"{len(state)} unknowns"
    watch = [w for k in state for w in ("--observe", k)]
    every = ["--every", repr(until / 400), "--until", repr(until)]
    first = f"{folder}/first.csv"
    status, out, err = run(["run", *base, *watch, *every, "-o", first, "--quiet"])
    if status != 0:
        return None, f"no rows: {err.strip()[:90]}"
    head, data = rows(first)
    start = {name: data[0][k] for k, (name, _) in enumerate(head)}
    kept = near = done = refused = 0
    notes = []
    for i in range(n):
        values = []
        for p in params:
            name, _, value = p.partition(" = ")
            try:
                x = float(value.split(" ")[0])
            except ValueError:
                continue
            if x != 0 and not float(x).is_integer() or x == 1:
                values.append(f"{name.split(' [')[0]}={exact(x * rng.uniform(0.95, 1.05))}")
        if not constrained:
            values += [f"{k}={exact(start[k] * rng.uniform(0.95, 1.05))}" for k in state if start.get(k)]
        a, b = f"{folder}/a.csv", f"{folder}/b.csv"
        status, out, err = run(["run", *base, *values, *watch, *every, "--accuracy", repr(ask), "--json", "-o", a])
        precise = None
        for method, tol in (("taylor", "2e-18"), ("dop853", "1e-17")):
            code, _, why = run(["run", *base, *values, *watch, *every, "--precision", "long", "--method", method, "--tol", tol, "-o", b, "--quiet"])
            if code == 0:
                precise = rows(b)
                break
        if not precise:
            notes.append("no reference: " + why.strip()[:80])
            continue
        done += 1
        if status == 2:
            refused += 1
            # kept where a double cannot do it: the median of its errors at the smallest tolerances, one of which may be luck,
            # and at more times, as velocities in close encounters are wrong for a moment only
            often = ["--every", repr(until / 40000), "--until", repr(until)]
            run(["run", *base, *values, *watch, *often, "--precision", "long", "--method", method, "--tol", tol, "-o", b, "--quiet"], 120)
            least = []
            for smallest in ("1e-15", "3e-15", "1e-14"):
                run(["run", *base, *values, *watch, *often, "--method", method, "--tol", smallest, "-o", a, "--quiet"], 120)
                least.append(error(*rows(a), rows(b)[1], state))
            least = sorted(least)[1]
            kept += least > ask / 10
            near += least > ask / 10
            if least <= ask / 10:
                notes.append("refused, but a double reaches %.1e: %s" % (least, err.strip()[-110:]))
            continue
        if status != 0:
            notes.append(err.strip()[:100])
            continue
        estimate = json.loads(out)["error"]
        true = error(*rows(a), precise[1], state)
        kept += true <= ask
        close = estimate is not None and (0.1 <= (estimate + 1e-15) / (true + 1e-15) <= 10)
        if estimate is not None and not close and estimate > true:
            # the estimate is of all steps: at more times close encounters and impacts show, where velocities are wrong for a moment
            often = ["--every", repr(until / 40000), "--until", repr(until)]
            run(["run", *base, *values, *watch, *often, "--precision", "long", "--method", method, "--tol", tol, "-o", b, "--quiet"], 120)
            run(["run", *base, *values, *watch, *often, "--accuracy", repr(ask), "-o", a, "--quiet"], 120)
            true = max(true, error(*rows(a), rows(b)[1], state))
            close = 0.1 <= (estimate + 1e-15) / (true + 1e-15) <= 10
        near += close
        if true > ask or not close:
            notes.append("error %.1e, estimate %s: %s" % (true, estimate, " ".join(values)[:60]))
    return (done, kept, near, refused), "; ".join(notes[:2])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("models", nargs="*")
    parser.add_argument("--n", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ask", type=float, default=1e-8)
    o = parser.parse_args()
    bad = []
    print(f"{'model':<28} {'starts':>6} {'kept':>5} {'within 10':>9} {'refused':>8}")
    with tempfile.TemporaryDirectory() as folder:
        for path in o.models or sorted(glob.glob("models/*.lag")):
            result, note = judge(path, o.n, random.Random(o.seed), o.ask, folder)
            name = os.path.basename(path)[:-4]
            if not result:
                print(f"{name:<28} {'-':>6} {'':>5} {'':>9} {'':>8}  {note}", flush=True)
                continue
            done, kept, near, refused = result
            print(f"{name:<28} {done:6d} {kept:5d} {near:9d} {refused:8d}  {note}", flush=True)
            if done == 0 or kept < 0.95 * done or near < 0.95 * done:
                bad.append(name)
    print("fewer than 95 of 100:", ", ".join(bad) or "none")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
