# Sensitivities against differences of order 6 between runs, for run_sensitivity_contacts.sh: LAGC MODEL SCENE TOLERANCE
# NAME=VALUE... ARGS... Runs have a tolerance of 1e-13: wrong by some 1e-12, over steps of 2e-3 by some 1e-9.
import json, subprocess, sys

lagc, model, scene, tolerance = sys.argv[1:4] + [float(sys.argv[4])]
names = dict((a.split("=")[0], float(a.split("=")[1])) for a in sys.argv[5:] if "=" in a and not a.startswith("-"))
rest = [a for a in sys.argv[5:] if "=" not in a or a.startswith("-")]


def run(args):
    return json.loads(subprocess.run([lagc, "run", model, scene, "--json", *rest, *args], capture_output=True, text=True).stdout)


def final(name, value):
    return run(["%s=%.17g" % (name, value)])["final"]


s = run(["--sensitivity", ",".join(names)])
if "sensitivity" not in s:
    sys.exit(s.get("message", str(s)))
bad = felt = 0
for name, value in names.items():
    h = 2e-3 * (abs(value) or 1)
    at = {k: final(name, value + k * h) for k in (-3, -2, -1, 1, 2, 3)}
    for out, by in s["sensitivity"].items():
        d = sum(c * (at[k][out] - at[-k][out]) for k, c in ((1, 0.75), (2, -0.15), (3, 1 / 60))) / h
        if not abs(d - by[name]) <= tolerance * max(1, abs(d)):
            print(out, "by", name, by[name], "not", d)
            bad += 1
        felt += abs(d) > 1e-3
sys.exit(bad or not felt)
