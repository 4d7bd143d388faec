"""make mutants N=100 SEED=1 JOBS=2: plants one-token changes in src and runtime, one at a time, and says which ones no suite sees.

    python3 tests/mutants/mutants.py [--n N] [--seed S] [--only PATH[:TEXT]] [--change NEW] [--again LOG] [--suites PREFIX,PREFIX] [--longest S] [--skip K] [--jobs J]

Which changes are drawn depends on the lines that they are made in, not on the rest of the sources. All of it happens in copies of the tree,
build/mutants/tree, and one more for each job more. A change that does not compile is replaced by another; one that leaves the machine code as it was,
or stands in equivalent.txt, is equivalent. Else the suites that reach its line run, up to the first red one. A suite that hangs is red. Which suites
reach a line is measured once, with gcov, and kept in build/mutants/cov; remove it to measure anew.
"""
import argparse
import collections
import hashlib
import json
import multiprocessing
import multiprocessing.pool
import os
import re
import shutil
import subprocess
import sys
import time

import plant

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.dirname(os.path.dirname(HERE))
WORK = os.path.join(TOP, "build", "mutants")
MEASURED = os.path.join(WORK, "tree")  # where the lines that suites reach are measured
TREE = MEASURED  # of this process
SAN = os.environ.get("SAN_FLAGS") or "-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer"
# Suites that would need more builds, or that judge the text of the sources.
LEFT_OUT = {"exec/includes", "exec/install", "exec/run_precision", "exec/editor", "golden/gallery"}

def sh(command, **kw):
    return subprocess.run(command, shell=True, cwd=TREE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **kw)


def copy_tree():
    """The tracked files and the new ones, those that differ; what is gone here goes there."""
    os.makedirs(TREE, exist_ok=True)
    names = subprocess.run("git ls-files -co --exclude-standard", shell=True, cwd=TOP, stdout=subprocess.PIPE, check=True).stdout.decode().split("\n")
    for name in filter(None, names):
        a, b = os.path.join(TOP, name), os.path.join(TREE, name)
        if not os.path.isfile(a):
            continue
        os.makedirs(os.path.dirname(b), exist_ok=True)
        if not os.path.exists(b) or open(a, "rb").read() != open(b, "rb").read():
            shutil.copyfile(a, b)
            shutil.copymode(a, b)


def programs():
    """All built test programs."""
    return [f[:-2] for d in ("unit", "fuzz") for f in sorted(os.listdir(os.path.join(TREE, "tests", d))) if f.endswith(".c") and f != "driver.c"]


def suites():
    """All suites of `make test`, by kind in the order of their cost."""
    found = []
    for folder, head, end in (("unit", "test_", ".c"), ("fuzz", "fuzz_", ".c"), ("golden", "", ".sh"), ("hard", "", ".sh"), ("math", "", ".sh"), ("exec", "", ".sh")):
        for f in sorted(os.listdir(os.path.join(TREE, "tests", folder))):
            name = folder + "/" + f[: -len(end)]
            if f.startswith(head) and f.endswith(end) and not f.startswith(("lib_", "long_")) and name not in LEFT_OUT:
                found.append(name)
    return found


def environment(build, cc="cc", more=None):
    gsl = os.path.exists(os.path.join(TREE, build, "liblag_gsl.a"))
    e = dict(os.environ, LAGC=build + "/lagc", LAGC_SAN=build + "/san/lagc" if build == "build" else build + "/lagc", SAN_FLAGS=SAN, LAGC_CLANG="", BIN=build + "/test/bin", BUILD=build, CC=cc, CLANG="",
             LIBLAG=" ".join(build + "/" + f for f in ["liblag.a"] + ["liblag_gsl.a"] * gsl), LIBS="-lgsl -lgslcblas -lm" if gsl else "-lm", INC="runtime/include",
             PRECISIONS="", CXX="c++", GSL="yes" if gsl else "", MAKE="make", CMOCKA_MESSAGE_OUTPUT="TAP")
    for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "LAG_HOME"):
        e.pop(name, None)
    e.update(more or {})
    return e


def make_home(build):
    """The folder that stands for LAG_HOME, as the Makefile makes it."""
    home = os.path.join(TREE, build, "test", "home")
    os.makedirs(home, exist_ok=True)
    for name, to in (("lib", build), ("include", "runtime/include")):
        if not os.path.islink(os.path.join(home, name)):
            os.symlink(os.path.join(TREE, to), os.path.join(home, name))


def run_suite(suite, build, env, limit):
    """Status of a suite, 0: green; and its seconds."""
    logs = os.path.join(TREE, build, "test", "log")
    begin = time.time()
    said = sh("sh tests/run.sh --run-one %s %d %s" % (suite, limit, logs), env=env).stdout.decode(errors="replace")
    if not os.path.exists(os.path.join(logs, suite + ".done")):
        sys.exit("mutants: tests/run.sh does not run %s:\n%s" % (suite, said[-2000:]))
    log = open(os.path.join(logs, suite + ".log"), errors="replace").read()
    status = int(open(os.path.join(logs, suite + ".done")).read().split()[0])
    return status or (1 if re.search("^not ok", log, re.M) else 0), time.time() - begin


class Map:
    """Which suites reach a line, and how long they take."""

    def __init__(self):
        self.folder = os.path.join(WORK, "cov")
        self.seconds = {}
        self.lines = {}
        kept = os.path.join(self.folder, "seconds.json")
        if os.path.exists(kept):
            self.seconds = json.load(open(kept))

    def measure(self, all_suites, jobs):
        missing = [s for s in all_suites if s not in self.seconds]
        if not missing:
            return
        scripts = any(not s.startswith(("unit/", "fuzz/")) for s in missing)  # their helpers are built with all others
        bins = " ".join("cov/test/bin/" + n for n in (programs() if scripts else [s.split("/")[1] for s in missing]))
        os.makedirs(self.folder, exist_ok=True)
        counted = os.path.join(TREE, "tests", "coverage", "counted.h")
        flags = "BUILD=cov SAN_BUILD=cov PRECISIONS= CLANG= CFLAGS='-O0 -include %s' SAN=--coverage SAN_FLAGS=--coverage" % counted
        made = sh("make -s -j2 %s %s %s" % (flags, "all" if scripts else "", bins))
        make_home("cov")
        if not os.path.islink(os.path.join(TREE, "cov", "san")):
            os.symlink(".", os.path.join(TREE, "cov", "san"))
        if made.returncode:
            sys.exit("mutants: the build for gcov fails:\n" + made.stdout.decode()[-2000:])
        wrapper = os.path.join(self.folder, "cc")
        with open(wrapper, "w") as f:
            f.write('#!/bin/sh\nexec cc "$@" -O0 --coverage\n')
        os.chmod(wrapper, 0o755)

        def one(s):
            prefix = os.path.join(self.folder, s)
            env = environment("cov", wrapper, {"GCOV_PREFIX": prefix, "XDG_CACHE_HOME": os.path.join(self.folder, "cache", s)})
            return s, run_suite(s, "cov", env, 600)[1]

        with multiprocessing.pool.ThreadPool(jobs) as threads:
            for s, took in threads.imap_unordered(one, missing):
                self.seconds[s] = took
                print("reached by %s, %.0f s" % (s, took), flush=True)
                json.dump(self.seconds, open(os.path.join(self.folder, "seconds.json"), "w"))

    def keep(self, asked):
        """Forgets the suites of another run."""
        self.seconds = {s: t for s, t in self.seconds.items() if s in asked}

    def of(self, suite, path):
        """The lines of a file that a suite executes."""
        key = suite, path
        if key not in self.lines:
            name = os.path.join(MEASURED, "cov/obj", path[:-2])
            data = os.path.join(self.folder, suite) + name + ".gcda"
            self.lines[key] = set()
            if os.path.exists(data):
                shutil.copyfile(name + ".gcno", data[:-2] + "no")
                out = subprocess.run(["gcov", "--json-format", "--stdout", data], cwd=MEASURED, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout.decode()
                for f in (f for text in out.splitlines() if text for f in json.loads(text)["files"]):
                    if f["file"].endswith(path):
                        self.lines[key] = {k["line_number"] for k in f["lines"] if k["count"]}
        return self.lines[key]

    def reach(self, path, first, last):
        """Those that reach some of these lines, each with what it costs to ask it: quick ones, and such as reach much of the file, cost little."""
        found = [s for s in self.seconds if any(n in self.of(s, path) for n in range(first, last + 1))]
        most = max((len(self.of(s, path)) for s in found), default=0)

        def cost(s):
            link = 4 if s.startswith(("unit/", "fuzz/")) else 0
            return (self.seconds[s] + link) * (most / len(self.of(s, path))) ** 2

        return {s: cost(s) for s in found}


def needs_sanitized(suite):
    """Whether a script runs helpers of unit tests, or the compiler under sanitizers."""
    name = os.path.join(TREE, "tests", suite + ".sh")
    return os.path.exists(name) and re.search(r"\bBIN\b|LAGC_SAN|_sanitized\.sh", open(name).read()) is not None


class Builds:
    def __init__(self):
        # Found out once, not by each make.
        found = sh("make -s --eval='found:;@echo GSL=$(GSL) SAFE=$(SAFE)' found").stdout.decode().split()
        make_home("build")
        self.settings = " ".join(w for w in found if "=" in w) + " PRECISIONS= CLANG="
        self.green = os.path.join(TREE, "build", "green.json")  # of suites without a change
        self.known = json.load(open(self.green)) if os.path.exists(self.green) else {}

    def san(self, names):
        """Builds unit tests and fuzz targets."""
        bins = " ".join("build/test/bin/" + n.split("/")[1] for n in names)
        gsl = "build/san/liblag_gsl.a" if "GSL=yes" in self.settings else ""
        return sh("make -s -j2 %s BUILD=build/san CFLAGS='-Og -g1' SAN='%s' build/san/lagc build/san/liblag.a %s && make -s -j2 %s %s" % (self.settings, SAN, gsl, self.settings, bins))

    def plain(self):
        return sh("make -s -j2 " + self.settings + " all build/test/bin/mutate build/test/bin/dump_words build/test/bin/dump_syntax build/test/bin/cut_effects")

    def first(self, asked):
        """The libraries, and the compiler where scripts are asked."""
        self.san([])
        if any(not s.startswith(("unit/", "fuzz/")) for s in asked):
            self.plain()

    def is_red(self, suite, limit):
        return run_suite(suite, "build", environment("build"), limit)[0] != 0

    def was_green(self, suite, restore, plant_again, limit):
        """A suite that turns red is run without the change, once: what is red at all is left out."""
        if suite not in self.known:
            restore()
            self.make_for(suite)
            self.known[suite] = not self.is_red(suite, limit)
            json.dump(self.known, open(self.green, "w"))
            plant_again()
            self.make_for(suite)
        return self.known[suite]

    def make_for(self, suite):
        if suite.startswith(("unit/", "fuzz/")):
            return self.san([suite])
        sanitized = self.san([]) if needs_sanitized(suite) else None
        return sanitized if sanitized and sanitized.returncode else self.plain()


def code_of(path, flags):
    """The machine code of a file, without debugging data; None where it does not compile."""
    out = os.path.join(TREE, "build", "code.o")
    made = sh("cc -std=c11 -w -D_XOPEN_SOURCE=700 %s -O2 -g0 -c -o %s %s" % (flags, out, path))
    return None if made.returncode else hashlib.sha1(open(out, "rb").read()).hexdigest()


def flags_of(path):
    return "-Isrc -Iruntime -Ibuild/gen" if path.startswith("src") else "-Iruntime/include -Iruntime -Ibuild/gen -ffp-contract=off"


def equivalents():
    """equivalent.txt: FILE FUNCTION | the line | the line with the change | why it changes nothing."""
    rows = {}
    for n, line in enumerate(open(os.path.join(HERE, "equivalent.txt")), 1):
        if line.strip() and not line.startswith("#"):
            cells = [c.strip() for c in line.split(" | ")]
            if len(cells) != 4 or not cells[3] or len(cells[0].split()) != 2:
                sys.exit("equivalent.txt:%d: FILE FUNCTION | line | changed line | reason" % n)
            rows[tuple(cells[:3])] = cells[3]
    return rows


class Trial:
    def __init__(self, reach, builds, longest):
        self.map, self.builds, self.longest = reach, builds, longest
        self.asked, self.red = collections.Counter(), collections.Counter()  # how often a suite was, and turned red

    def judge(self, text, c):
        """'invalid', 'equivalent', 'killed by SUITE' or 'survived'."""
        place = os.path.join(TREE, c.path)

        def write(t):
            with open(place, "w") as f:
                f.write(t)

        before = code_of(c.path, flags_of(c.path))
        write(plant.apply(text, c))
        try:
            after = code_of(c.path, flags_of(c.path))
            if after is None:
                return "invalid"
            if after == before:
                return "equivalent: the same machine code"
            return self.run(text, c, write)
        finally:
            write(text)

    def run(self, text, c, write):
        first = text.count("\n", 0, c.begin) + 1
        last = text.count("\n", 0, c.end) + 1
        costs = self.map.reach(c.path, first, last)
        there = sorted(costs, key=lambda s: costs[s] * (self.asked[s] + 2) / (self.red[s] + 1))
        begin, ran, built = time.time(), 0, ""
        for suite in there:
            if self.longest and time.time() - begin > self.longest:
                return "survived %d of %d suites that reach it, in %.0f s" % (ran, len(there), time.time() - begin)
            kind = suite if suite.startswith(("unit/", "fuzz/")) else "sanitized" if needs_sanitized(suite) else "plain"
            made = self.builds.make_for(suite) if kind != built else None
            built = kind
            if made is not None and made.returncode:
                return "killed by the build" if b"error:" not in made.stdout else "invalid"
            limit = max(60, 10 * self.map.seconds[suite])
            self.asked[suite] += 1
            if self.builds.is_red(suite, limit) and self.builds.was_green(suite, lambda: write(text), lambda: write(plant.apply(text, c)), limit):
                self.red[suite] += 1
                return "killed by " + suite
            ran += 1
        return "survived all of %d suites that reach it" % len(there)


def sort_key(seed, text, c, seen):
    """Changes stand in an order of their own, which those of other lines do not disturb. seen counts lines that read the same."""
    same = (c.path,) + plant.line_of(text, c)[1:]
    seen[same] = seen.get(same, 0) + 1
    return hashlib.sha1(repr((seed, same, seen[same])).encode()).digest()


def survivors_of(log):
    """(path, line, line with the change) of what a run said to have survived."""
    return set(re.findall(r"^(\S+):\d+: survived.*\n    - (.*)\n    \+ (.*)$", open(log).read(), re.M))


def draw(seed, only):
    path, _, piece = (only or "").partition(":")
    pool, seen = [], {}
    for folder in ("src", "runtime"):
        for where, _, files in sorted(os.walk(os.path.join(TREE, folder))):
            for f in sorted(files):
                name = os.path.relpath(os.path.join(where, f), TREE)
                if f.endswith(".c") and name.startswith(path):
                    text = open(os.path.join(TREE, name)).read()
                    pool += [(sort_key(seed, text, c, seen), c, text) for c in plant.changes(name, text) if piece in plant.line_of(text, c)[1]]
    return [x[1:] for x in sorted(pool, key=lambda x: x[0])]


class Judge:
    """Verdicts on changes of a drawn pool, in a tree of its own."""

    def __init__(self, pool, reach, longest):
        self.pool, self.reach, self.longest, self.trial = pool, reach, longest, None

    def settle(self):
        """This process takes the next tree."""
        global TREE
        n = (multiprocessing.current_process()._identity or (1,))[-1] - 1
        TREE = MEASURED + (str(n + 1) if n else "")
        builds = Builds()
        builds.first(self.reach.seconds)
        self.trial, self.rows = Trial(self.reach, builds, self.longest), equivalents()

    def verdict(self, i):
        if not self.trial:
            self.settle()
        c, text = self.pool[i]
        line, before, after = plant.line_of(text, c)
        why = self.rows.get((c.path + " " + plant.function_of(text, c), before, after))
        return c.path, line, before, after, "equivalent: " + why if why else self.trial.judge(text, c)


judge = None


def verdict_of(i):
    return judge.verdict(i)


def main():
    global judge
    p = argparse.ArgumentParser()
    p.add_argument("--n", type=int, default=100)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--only", help="changes in files that begin so, in lines that have this text")
    p.add_argument("--change", help="only this new text")
    p.add_argument("--again", metavar="LOG", help="only changes of which LOG, the output of another run, says that they survived")
    p.add_argument("--suites", default="unit,fuzz,golden,math,hard,exec", help="suites whose names begin so")
    p.add_argument("--skip", type=int, default=0, help="of the changes drawn, the first that another run has judged")
    p.add_argument("--longest", type=float, default=0, help="seconds for one change; 0: no limit")
    p.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="changes that are tried at the same time, each in a tree of its own")
    a = p.parse_args()
    copy_tree()
    reach, builds = Map(), Builds()
    asked = [s for s in suites() if s.startswith(tuple(a.suites.split(",")))]
    if not asked:
        sys.exit("mutants: no suite's name begins with " + a.suites)
    builds.first(asked)
    reach.measure(asked, a.jobs)
    reach.keep(asked)
    pool = draw(a.seed, a.only)
    if a.change:
        pool = [x for x in pool if x[0].new.strip() == a.change.strip()]
    if a.again:
        again = survivors_of(a.again)
        pool = [x for x in pool if (x[0].path,) + plant.line_of(x[1], x[0])[1:] in again]
    for n in range(2, a.jobs + 1):
        shutil.rmtree(MEASURED + str(n), ignore_errors=True)
        shutil.copytree(MEASURED, MEASURED + str(n), symlinks=True, ignore=lambda folder, names: {"cov", "home"} & set(names))
    judge = Judge(pool, reach, a.longest)
    killed, same, tried, survivors = 0, 0, 0, []
    with multiprocessing.Pool(a.jobs) as workers:
        for path, line, before, after, verdict in workers.imap(verdict_of, range(a.skip, len(pool))):
            if tried == a.n:
                break
            if verdict == "invalid":
                continue
            tried += 1
            killed += verdict.startswith("killed")
            same += verdict.startswith("equivalent")
            print("%s:%d: %s\n    - %s\n    + %s" % (path, line, verdict, before, after), flush=True)
            if verdict.startswith("survived"):
                survivors.append((path, line, before, after))
    print("\nsurvivors:" if survivors else "\nno survivors")
    for path, line, before, after in survivors:
        print("%s:%d\n    - %s\n    + %s" % (path, line, before, after))
    print("killed %d of %d (%.0f %%), %d equivalent" % (killed, tried - same, 100 * killed / max(1, tried - same), same))


if __name__ == "__main__":
    main()
