"""Equations that `lagc derive` prints, with an index for a family's members, against the potential as Python has it: rows of stdin, evaluated at a state drawn at random, are compared with
-dV/du by complex steps (W. Squire, G. Trapp, SIAM Rev. 40 (1998) 110, DOI 10.1137/S003614459631241X).

  lagc derive FILE.lag | python3 tests/exec/listing.py KIND N

Prints the number of members and the largest difference for twelve of them, in units of the largest force. A member without an equation, or with two, is an error, and so is an energy that is not the kinetic and the potential one.
"""
import cmath
import random
import re
import sys


def pairs(f):
    return lambda u, n: sum(f(u[i], u[j]) for i in range(1, n + 1) for j in range(1, i))


k, c = 2, 3
w = {i: 0.1*i for i in range(1, 11)}
POTENTIAL = {
    "springs": lambda u, n: pairs(lambda x, y: k/2*(x - y)**2)(u, n) - sum(c*x**4/4 for x in u.values()),
    "sines": pairs(lambda x, y: k*cmath.sin(x - y)),
    "skew": pairs(lambda x, y: k*(x**2*y - 2*y**3*x)),
    "string": lambda u, n: sum(k/2*r**2 + c/4*r**4 for r in [u[1]] + [u[i + 1] - u[i] for i in range(1, n)] + [-u[n]]),
    "tied": lambda u, n: sum(k/2*(u[i] - w[min(i, 5)])**2 for i in range(1, n + 1)),
    "dimer": lambda u, n: sum((k if i % 2 else c)/2*(u[i + 1] - u[i])**2 for i in range(1, n)),
    "grid": lambda u, n: sum(k/2*(u[i + 1, j] - u[i, j])**2 + c/2*(u[j, i + 1] - u[j, i])**2 for i in range(1, n) for j in range(1, n + 1)),
    "stiff": lambda u, n: sum((c if i == 500 else k)/2*x*x for i, x in u.items()),
    "odd": lambda u, n: sum(k*x*x/2 for x in u.values()) + sum(c*(u[i + 1] - u[i])**2/2 for i in range(1, n)) + u[500]**4,
    "net": lambda u, n: sum(k/2*(u[i + 1, j] - u[i, j])**2 + c/3*(u[j, i + 1] - u[j, i])**3 for i in range(1, n) for j in range(1, n + 1)),
}


def python(text):
    """The text of an expression as Python's."""
    while (begin := re.search(r"sum\((\w+) in ", text)):
        depth, at, parts = 0, begin.end(), [begin.end()]
        while depth >= 0:
            depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(text[at], 0)
            if text[at] == "," and depth == 0 and len(parts) == 1:
                parts.append(at)
            at += 1
        low, high = text[parts[0]:parts[1]].split("..")
        text = f"{text[:begin.start()]}total(({text[parts[1] + 1:at - 1]}) for {begin[1]} in range({low}, {high} + 1)){text[at:]}"
    return re.sub(r"u\[([^]]*)\]'", r"v[\1]", text).replace("^", "**")


def main():
    kind, n = sys.argv[1], int(sys.argv[2])
    place = random.Random(1)
    members = [(i, j) for i in range(1, n + 1) for j in range(1, n + 1)] if kind in ("net", "grid") else range(1, n + 1)
    u = {i: place.uniform(-1, 1) for i in members}
    names = {"u": u, "k": k, "c": c, "w": w, "total": sum, "sin": lambda x: cmath.sin(x).real, "cos": lambda x: cmath.cos(x).real}
    v = {i: place.uniform(-1, 1) for i in members}
    names["v"] = v
    found, definitions, energy = {}, [], None
    for line in sys.stdin:
        if line.startswith("  E = "):
            energy = python(line[6:])
        row = re.match(r"  (\w+)\[([^]]*)\]('*) = (.*?)((?:  for \w+ in [^.]*\.\.[^.]*)*)$", line)
        if not row or row[1].startswith("p_"):
            continue
        name, at, primes, right, ranges = row.groups()
        cases = [{}]
        for letter, low, high in reversed(re.findall(r"  for (\w+) in (.*?)\.\.(.*?)(?=  |$)", ranges)):  # later ones are outside
            cases = [{**x, letter: value} for x in cases for value in range(eval(low, {}, x), eval(high, {}, x) + 1)]
        for case in cases:
            here = {**names, **case}
            if primes == "''":
                member = eval(at, here)
                assert member not in found, member
                found[member] = (python(right), here)
            elif not primes:
                definitions.append((name, eval(at, here), python(right), here))
    waiting = definitions
    while waiting:  # each once its parts are known
        left = []
        for name, at, right, here in waiting:
            table = names.setdefault(name, {})
            try:
                table[at] = eval(right, {**here, **{x: v for x, v in names.items() if x not in here}})
            except (KeyError, NameError):
                left.append((name, at, right, here))
        assert len(left) < len(waiting), left[0]
        waiting = left
    forces, members = {}, list(members)
    assert sorted(found) == members, len(found)
    for i in members[:3] + members[-3:] + place.sample(members, 6):  # the ends of families, and some between
        there = {j: complex(x, 1e-30*(i == j)) for j, x in u.items()}
        forces[i] = -POTENTIAL[kind](there, n).imag*1e30
    size = max(map(abs, forces.values()))
    total = sum(x*x/2 for x in v.values()) + POTENTIAL[kind]({i: complex(x) for i, x in u.items()}, n).real
    assert abs(eval(energy, names) - total) < 1e-12*(1 + abs(total)), (eval(energy, names), total)
    print(len(found), max(abs(eval(text, {**here, **{x: v for x, v in names.items() if x not in here}}) - forces[i]) for i, (text, here) in ((i, found[i]) for i in forces))/size)


main()
