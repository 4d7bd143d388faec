#!/usr/bin/env python3
"""Random planar mechanisms with friction at pins and guides: cranks, four-bars, beads on ellipses; from seed 1000 on
telescopes, Scotch yokes, cranks that run into a stop.

Counts runs that hang (20 s of the processor), end with an error, gain energy by friction, or whose energy is off by more than 1e-5 of its
size at a tolerance of 1e-9; and those from which moreau does not come to the same end as its step falls.
python3 tests/accuracy/mechanisms.py [FIRST LAST]    LAGC=build/lagc
"""
import os
import random
import re
import resource
import subprocess
import sys
import tempfile

LAGC = os.environ.get("LAGC", "build/lagc")

CRANK = """coord a [rad], b [rad], x [m], y [m]
kinetic = {i} [kg*m^2]/2*a'^2 + {j} [kg*m^2]/2*b'^2 + {m} [kg]/2*(x'^2 + y'^2)
potential = {m} [kg]*9.81 [m/s^2]*({g}*y + {h}*x)
guide pin: (x, y) = ({r} [m]*cos(a) + {l} [m]*cos(b), {r} [m]*sin(a) - {l} [m]*sin(b)), friction = {mu}, slip = {d} [m]*(a' + b')
guide rail: y = {off} [m], friction = {mu}, static = {hold}, slip = x'
scene go {{ start a = {a}, a' = {w} [rad/s]; start guess b = 0, x = {l} [m], y = {off} [m]; span 3 [s]; output a }}
"""
FOURBAR = """coord a [rad], b [rad], c [rad]
kinetic = {i} [kg*m^2]*a'^2 + {j} [kg*m^2]*b'^2 + {m} [kg*m^2]/50*c'^2
potential = {g}*2 [N*m]*sin(a)
constraint px: {r} [m]*cos(a) + {l} [m]*cos(b) = {l} [m] + {s} [m]*cos(c)
constraint py: {r} [m]*sin(a) + {l} [m]*sin(b) = {s} [m]*sin(c)
let ab = a - b, bc = b - c
friction one on ab: {mu}*{d} [m]*hypot(lambda(px), lambda(py))
friction two on bc: {mu}*{d} [m]*hypot(lambda(px), lambda(py)), static = {hold}*{d} [m]*hypot(lambda(px), lambda(py))
friction three on c: {mu}*{d} [m]*hypot(lambda(px), lambda(py))
scene go {{ start a = {a}, a' = {w} [rad/s]; start guess b = 0.2, c = 1.5; span 3 [s]; output a }}
"""
BEAD = """coord x [m], y [m]
kinetic = {m} [kg]/2*(x'^2 + y'^2)
potential = {m} [kg]*9.81 [m/s^2]*y
guide wire: x^2/(1 + {l}) + 2*y^2 = 1 [m^2], friction = {mu}, static = {hold}
scene go {{ start guess x = 0, y = -0.7; start x' = {w}/4 [m/s]; span 5 [s]; output x }}
"""
TELESCOPE = """coord a [rad], s [m], p [rad]
kinetic = {i} [kg*m^2]/2*a'^2 + ({j} [kg*m^2] + {m} [kg]*s^2/9)/2*p'^2 + {m} [kg]/2*s'^2
potential = {g}*3 [N*m]*sin(a) + {h}*40 [N/m]*(s - 0.5 [m])^2
constraint eye: (0.3 [m] + {l} [m] + s*cos(p), s*sin(p)) = (2*{r} [m]*cos(a), 2*{r} [m]*sin(a))
friction seal on s: {mu}*10 [N], static = {hold}*10 [N]
friction pin on p: {mu}*{d} [m]*hypot(lambda(eye).x, lambda(eye).y)
scene go {{ start a = {a}, a' = {w}/2 [rad/s]; start guess s = 0.5, p = 3.1; span 3 [s]; output a }}
"""
YOKE = """coord a [rad], x [m], y [m]
kinetic = {i} [kg*m^2]/2*a'^2 + {m} [kg]/2*(x'^2 + y'^2)
potential = {m} [kg]*9.81 [m/s^2]*({g}*y + {h}*x)
guide slot: x = {r} [m]*cos(a), friction = {mu}, static = {hold}, slip = {r} [m]*cos(a)*a' - y'
guide rail: y = {off} [m], friction = {mu}, slip = x'
scene go {{ start a = {a}, a' = {w} [rad/s]; start guess x = 0, y = {off}; span 3 [s]; output a }}
"""
STOPPED = """coord a [rad], b [rad], x [m], y [m]
kinetic = {i} [kg*m^2]/2*a'^2 + {j} [kg*m^2]/2*b'^2 + {m} [kg]/2*(x'^2 + y'^2)
potential = {m} [kg]*9.81 [m/s^2]*({g}*y + {h}*x)
guide pin: (x, y) = ({r} [m]*cos(a) + {l} [m]*cos(b), {r} [m]*sin(a) - {l} [m]*sin(b)), friction = {mu}, slip = {d} [m]*(a' + b')
guide rail: y = {off} [m], friction = {mu}, slip = x'
contact stop: x <= {l} [m] + 0.8*{r} [m], restitution = 2*{mu}
scene go {{ start a = {a}/3 + 2, a' = {w}/2 [rad/s]; start guess b = 0, x = {l} [m], y = {off} [m]; span 3 [s]; output a }}
"""


def model(seed):
    pick = random.Random(seed)
    r, mu = pick.uniform(0.05, 0.15), pick.uniform(0.02, 0.4)
    text = pick.choice([CRANK, FOURBAR, BEAD] if seed < 1000 else [TELESCOPE, YOKE, STOPPED])
    return f"model m{seed}\n" + text.format(
        r=r, s=1.3 * r + 0.02, l=pick.uniform(0.25, 0.5), mu=mu, hold=mu * pick.uniform(1, 1.6), d=pick.uniform(0.005, 0.03),
        w=pick.uniform(-20, 20), off=pick.uniform(-0.05, 0.05), a=pick.uniform(-3, 3), m=pick.uniform(0.2, 2),
        i=pick.uniform(0.002, 0.05), j=pick.uniform(0.001, 0.02), g=pick.choice([0, 1]), h=pick.choice([0, 1]))


def run(path, *options):
    """What a run says, or None where it takes more than 20 s of the processor."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
    of = subprocess.run([LAGC, "run", path, *options], capture_output=True, text=True, preexec_fn=limit)
    return None if of.returncode < 0 else of.stdout + of.stderr


def fault(said, energy=1e-5):
    if said is None:
        return "hangs"
    if "reached" not in said:
        return (re.findall(r"(?:FAILED|error): (.*)", said) or ["?"])[0]
    work = re.search(r"work of dry friction: (\S+)", said)
    drift = re.search(r"energy balance: (\S+)", said)
    if work and float(work[1]) > 1e-9:
        return "gains energy by friction"
    return "its energy is off" if drift and float(drift[1]) > energy else ""


def end(said):
    return float(re.search(r"^  [ax] +(\S+)", said, re.M)[1])


def judge(path):
    """One line for a mechanism that is wrong. The errors of moreau are of the order of its step, where a joint stops."""
    said = run(path, "--tol", "1e-9")
    why = fault(said)
    off = []
    for step in ("4e-4", "1e-4", "2.5e-5") if not why else ():
        if len(off) == 2 and off[1] <= max(1e-4, off[0] / 2):
            break
        steps = run(path, "--method", f"moreau(step={step})")
        if fault(steps, 1e-2):
            return "moreau: " + fault(steps, 1e-2)
        off.append(abs(end(steps) - end(said)))
    return why or (f"moreau ends {off[0]:.1g} and {off[-1]:.1g} away" if off[-1] > max(1e-4, off[0] / 2) else "")


first, last = (int(x) for x in sys.argv[1:3]) if len(sys.argv) > 2 else (0, 200)
with tempfile.TemporaryDirectory() as folder:
    wrong = 0
    for seed in range(first, last):
        path = os.path.join(folder, "m.lag")
        with open(path, "w", encoding="utf-8") as file:
            file.write(model(seed))
        why = judge(path)
        wrong += why != ""
        if why:
            print(f"seed {seed}: {why}", flush=True)
print(f"{last - first} mechanisms, {wrong} of them wrong")
sys.exit(wrong > 0)
