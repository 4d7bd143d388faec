"""Circles of calls between files: nm's symbols of the objects in a folder. Prints `CIRCLE N FILE...` for each with more files than LIMIT.

  python3 tests/exec/calls.py BUILD/obj/src 8

Tables of descriptors are data that their users are handed: an edge into them is no call.
"""
import collections
import os
import subprocess
import sys

DATA = {"methods/method_list"}


def graph(root, sources):
    """{file: files whose functions it calls}, of objects whose source is there."""
    defined, used = {}, collections.defaultdict(set)
    objects = [f"{folder}/{name}" for folder, _, names in os.walk(root) for name in names if name.endswith(".o")]
    modules = {path: os.path.relpath(path, root)[:-2] for path in objects}
    objects = [path for path in objects if os.path.exists(f"{sources}/{modules[path]}.c")]
    lines = subprocess.run(["nm", "-P", "-A", *objects], capture_output=True, text=True, check=True).stdout.splitlines()
    for line in lines:
        path, symbol, kind = line.split()[:3]
        module = modules[path.rstrip(":")]
        if kind in "TDBRC":
            defined[symbol] = module
        elif kind == "U":
            used[module].add(symbol)
    calls = {module: {defined[s] for s in symbols if s in defined} - {module} - DATA for module, symbols in used.items()}
    return {**{module: set() for module in defined.values()}, **calls}


def circles(calls):
    """Strongly connected components: R. Tarjan, SIAM J. Comput. 1 (1972) 146, DOI 10.1137/0201010."""
    index, low, stack, found = {}, {}, [], []

    def visit(v):
        index[v] = low[v] = len(index)
        stack.append(v)
        for w in sorted(calls[v]):
            if w not in index:
                visit(w)
            if w in stack:
                low[v] = min(low[v], low[w])
        if low[v] == index[v]:
            circle = [stack.pop()]
            while circle[-1] != v:
                circle.append(stack.pop())
            found.append(sorted(circle))

    for v in sorted(calls):
        if v not in index:
            visit(v)
    return [c for c in found if len(c) > 1]


if __name__ == "__main__":
    root, limit = sys.argv[1], int(sys.argv[2])
    sys.setrecursionlimit(10000)
    calls = graph(root, os.path.basename(root))
    if len(calls) < 50:
        sys.exit(f"{root}: only {len(calls)} objects")
    for c in sorted(circles(calls), key=len, reverse=True):
        if len(c) > limit:
            print("CIRCLE", len(c), *c)
