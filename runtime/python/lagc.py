"""Models of lagc from Python: compiled as shared libraries, run by ctypes, results as NumPy arrays.

    import lagc
    m = lagc.load("pendulum.lag")
    r = m.run("small", th=1.2, until=20)      # values in the units that the model declares
    r.t, r["th"], r.energy_drift
    dydt = m.rhs(0, [1.2, 0])                 # y = coordinates, velocities, states, in SI units
    b = m.batch("small", th=numpy.linspace(0, 3, 10000), times=[10])
    b.y                                       # (10000, 1, 2), in SI units

This file needs Python 3.8, NumPy, and the program lagc: the one in $LAGC, that of the same package, source tree or installation, or that in $PATH. Libraries
are built when a model is loaded, and kept in lagc's cache; without a C compiler models are evaluated. While the library computes, other Python threads run.
"""
import ctypes
import difflib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import warnings
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np

__all__ = ["load", "Model", "Result", "Batch", "Error", "CompileError", "RunError", "Linear", "Gradient"]

_ABI = 23  # LAG_ABI of lag_model.h
_STOPPED, _INTERRUPTED = 2, 3
_RATES, _OUTPUTS, _MASS, _INVERSE = 0, 4, 8, 9  # lag_quantity; behind _RATES and _OUTPUTS derivatives by state, inputs, parameters
_CHUNK, _PATIENCE = 4096, 0.2  # rows and seconds of one call: between calls Ctrl-C is heard
_LANES_FROM = 2000  # motions of a batch


class Error(Exception):
    """A wrong name, value or argument; the base of the others."""


class CompileError(Error):
    """The model is wrong: the compiler's text."""


class RunError(Error):
    """A run failed: when, where and why. `result` has the rows before; `status` is the library's."""

    def __init__(self, message, status, result=None):
        super().__init__(message)
        self.status, self.result = status, result


# ---- the compiler ----

def _compiler():
    here = os.path.dirname(os.path.abspath(__file__))
    places = [os.environ.get("LAGC"), os.path.join(here, "files/bin/lagc"), os.path.join(here, "../../build/lagc"), os.path.join(here, "../../../bin/lagc"), shutil.which("lagc")]
    for place in places:
        if place and os.access(place, os.X_OK):
            return os.path.normpath(place)
    raise Error("lagc is not found: set LAGC to its path, or put its folder into PATH")


def _main():
    """The program lagc of this package, as a command."""
    program = _compiler()
    os.execv(program, [program, *sys.argv[1:]])


def _has_c_compiler():
    return shutil.which((os.environ.get("CC") or "cc").split()[0]) is not None


def _lagc(*words):
    done = subprocess.run([_compiler(), *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    said = done.stderr.strip()
    if done.returncode:
        raise (CompileError if done.returncode == 1 else Error)(said)
    if said:
        warnings.warn(said, stacklevel=4)
    return done.stdout


def _read(path):
    try:
        with open(path, "rb") as f:
            return f.read()
    except OSError:
        return None


def _texts(path):
    """The texts of a model by path: the file, and those that it names, as included files and tables. Those of lagc's own folders do not change."""
    texts, todo = {}, [os.path.abspath(path)]
    while todo:
        one = todo.pop()
        text = _read(one) if one not in texts and os.path.isfile(one) else None
        if text is None:
            continue
        texts[one] = text
        names = re.findall(rb'"([^"\n]+)"', text) if len(text) < 1 << 20 else []
        todo += [os.path.normpath(os.path.join(os.path.dirname(one), os.fsdecode(name))) for name in names]
    return texts


# ---- the library ----

_Pointer = ctypes.c_void_p
_EventHook = ctypes.CFUNCTYPE(None, _Pointer, ctypes.c_int, ctypes.c_double, ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_double))
_InputHook = ctypes.CFUNCTYPE(ctypes.c_double, _Pointer, ctypes.c_double)


class _Option(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("value", ctypes.c_double), ("text", ctypes.c_char_p)]


class _Stats(ctypes.Structure):
    _fields_ = ([("t", ctypes.c_double)] + [(k, ctypes.c_longlong) for k in ("steps", "rejected", "rhs_calls", "events", "systems", "iterations")]
                + [(k, ctypes.c_double) for k in ("energy", "energy_drift", "constraint", "constraint_rate", "unresolved")])


class _Charge(ctypes.Structure):
    _fields_ = ([("name", ctypes.c_char_p), ("unit", ctypes.c_char_p), ("flags", ctypes.c_uint)]
                + [(k, ctypes.c_double) for k in ("begin", "now", "work", "dry_friction", "at_events", "drift", "absolute", "slope", "slope_error")] + [("trend", ctypes.c_int)]
                + [(k, ctypes.c_double) for k in ("energy_jump", "energy_jump_t", "mass_condition")] + [("mass_condition_of", ctypes.c_char_p)])


def _open(path):
    lib = ctypes.CDLL(path)
    d, i, s, p = ctypes.c_double, ctypes.c_int, ctypes.c_char_p, _Pointer
    signatures = {
        "lag_library_abi": (i,), "lag_program_read": (p, p, ctypes.c_size_t, p), "lag_program_free": (None, p), "lag_library_scene": (p, p, i), "lag_scene_span": (s, p, p, p, p), "lag_scene_method": (s, p),
        "lag_item": (s, p, i, i, p, p, p), "lag_find_method": (p, s), "lag_sim_new": (p, p), "lag_sim_free": (None, p), "lag_sim_set": (i, p, s, d),
        "lag_sim_set_input": (i, p, s, _InputHook, p), "lag_sim_set_tolerance": (i, p, d), "lag_sim_set_method": (i, p, p, p, i),
        "lag_sim_requested_start": (d, p, i), "lag_sim_actual_start": (d, p, i), "lag_sim_choose_method": (i, p, d, i, p, i, s, ctypes.c_size_t), "lag_sim_message": (s, p), "lag_sim_q": (ctypes.POINTER(d), p),
        "lag_sim_p": (ctypes.POINTER(d), p), "lag_sim_time": (d, p), "lag_sim_noutputs": (i, p), "lag_sim_outputs": (i, p, p),
        "lag_sim_output_info": (d, p, i, s, ctypes.c_size_t, s, ctypes.c_size_t), "lag_sim_state_info": (d, p, i, s, ctypes.c_size_t, s, ctypes.c_size_t),
        "lag_sim_quantity": (i, p, i, i, p, p, p, p), "lag_sim_quantity_size": (None, p, i, p, p), "lag_sim_rows": (i, p, i, p, p, p, p), "lag_sim_batch": (i, p, i, p, p, i, p, p, p), "lag_sim_set_lanes": (i, p, p),
        "lag_sim_stats": (None, p, p), "lag_sim_ncharges": (i, p), "lag_sim_charge": (None, p, i, p), "lag_sim_balance": (i, p),
        "lag_sim_set_tangent": (i, p, i, p), "lag_sim_tangent": (i, p, p), "lag_sim_set_sensitivity": (i, p, i, p), "lag_sim_output_sensitivity": (i, p, p, p),
        "lag_sim_sensitivity_info": (d, p, i, s, ctypes.c_size_t, s, ctypes.c_size_t), "lag_sim_on_event": (None, p, _EventHook, p),
        "lag_sim_record": (i, p), "lag_sim_gradient": (i, p, i, p, p, p, p),
        "lag_sim_on_step": (None, p, p, p), "lag_time_is_up": (i, p, p), "lag_clock_seconds": (d,),
    }
    for name, (returns, *takes) in signatures.items():
        f = getattr(lib, name)
        f.restype, f.argtypes = returns, takes
    if lib.lag_library_abi() != _ABI:
        raise Error(f"{path} has the interface {lib.lag_library_abi()}, lagc.py knows {_ABI}: use the lagc.py of that lagc")
    return lib


class _Program:
    """The scenes of a library that `lagc build --shared` wrote; or of the bytes of `lagc build --bytes`, which liblag evaluates."""

    def __init__(self, compiled, *words):
        if compiled:
            self.lib = _open(_lagc("build", *words, "--shared").strip())
            self.lib.lag_library.restype = _Pointer
            self.handle = self.lib.lag_library()
            return
        folder = os.path.dirname(_compiler())
        places = [os.path.join(folder, where, f"liblag.so.{_ABI}") for where in (".", "../lib")]
        found = [x for x in places if os.path.exists(x)]
        if not found:
            raise Error(f"liblag.so.{_ABI}, which evaluates models where there is no C compiler, is not found beside {_compiler()}: `make install` brings it")
        self.lib, why = _open(found[0]), ctypes.c_char_p()
        with tempfile.TemporaryDirectory() as kept:
            _lagc("build", *words, "--bytes", "-o", os.path.join(kept, "program"))
            program = _read(os.path.join(kept, "program"))
        self.handle = self.lib.lag_program_read(program, len(program), ctypes.byref(why))
        if not self.handle:
            raise Error((why.value or b"no memory").decode())
        weakref.finalize(self, self.lib.lag_program_free, self.handle)

    def scenes(self):
        found = []
        while self.lib.lag_library_scene(self.handle, len(found)):
            found.append(_Scene(self, self.lib.lag_library_scene(self.handle, len(found))))
        return {s.name: s for s in found}


def _address(a):
    return None if a is None else a.ctypes.data


def _numbers(a, what):
    """`a` as doubles in C order, without a copy where it is so already."""
    try:
        return np.asarray(a, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        raise Error(f"{what} = {str(a):.60}: not an array of real numbers") from None


def _spread(a, shape, what):
    """The same, repeated to this shape."""
    x = _numbers(a, what)
    try:
        return np.broadcast_to(x, shape)
    except ValueError:
        raise Error(f"{what} has the shape {x.shape}, not {shape}") from None


def _vector(x, n):
    """x[n], or one for each state, x[k, n]."""
    x = _numbers(x, "x")
    if not x.ndim or x.shape[-1] != n:
        raise Error(f"x has the shape {x.shape}, not (any, {n})")
    return x


def _array(a, shape, what):
    """The same, of this shape; -1: any number."""
    x = np.ascontiguousarray(_numbers(a, what))
    if len(x.shape) != len(shape) or any(want not in (-1, got) for want, got in zip(shape, x.shape)):
        raise Error(f"{what} has the shape {x.shape}, not ({', '.join('any' if k < 0 else str(k) for k in shape)})")
    return x


def _number(name, value):
    try:
        return float(value)
    except (TypeError, ValueError):
        raise Error(f"{name} = {value!r}: not a number") from None


def _named(values, more):
    """Values by name, of a dictionary and of keywords."""
    if values is not None and not hasattr(values, "items"):
        raise Error(f"values = {values!r}: give a dictionary, {{\"th\": 1.2}}")
    for name in values or {}:
        if not isinstance(name, str):
            raise Error(f"values: {name!r} is not a name; write {{\"th\": 1.2}}")
    return {**(values or {}), **more}


def _near(name, names):
    near = difflib.get_close_matches(str(name), names, 1)
    return f"; did you mean {near[0]}?" if near else f"; there are {', '.join(names)}" if names else ""


def _grid(t0, end, every):
    """The rows of `lagc run`: k/n where n = 1/every is whole, so that times are 0.3, not 0.1*3."""
    if not np.isfinite(end):
        raise Error(f"until = {end}: not a finite time")
    if not every > 0:
        raise Error(f"every = {every}: the time between rows must be positive")
    whole, k = 1 / every, np.arange(np.floor(abs(end - t0) / every + 1e-9) + 1)
    n = np.round(whole)
    times = t0 + np.copysign(1, end - t0) * (k / n if n >= 1 and abs(whole - n) <= 4e-16 * n else k * every)
    return times if abs(times[-1] - end) <= 1e-9 * every else np.append(times, end)


class _Simulation:
    """A lag_sim of a scene, with the values that the caller gives."""

    def __init__(self, lib, scene, values):
        self.lib, self.scene, self.hooks, self.raised = lib, scene, [], None
        self.sim = lib.lag_sim_new(scene.handle)
        if not self.sim:
            raise MemoryError
        weakref.finalize(self, lib.lag_sim_free, self.sim)
        self.until = ctypes.c_double(float("inf"))  # time of the clock at which the library returns
        lib.lag_sim_on_step(self.sim, ctypes.cast(lib.lag_time_is_up, _Pointer), ctypes.addressof(self.until))
        for name, value in values.items():
            if callable(value):
                hook = _InputHook(lambda context, t, f=value: self._call(f, t))
                self.hooks.append(hook)
                self.check(lib.lag_sim_set_input(self.sim, name.encode(), hook, None))
            elif isinstance(value, str):
                raise Error(f"{name} = {value!r}: give a number, in the unit that the model declares, or a function of t for an input")
            else:
                self.check(lib.lag_sim_set(self.sim, name.encode(), _number(name, value)))

    def _call(self, f, t):
        """f(t); NaN, which ends the run, after an exception, which is raised then."""
        try:
            return float(f(t))
        except BaseException as e:
            self.raised = self.raised or e
            return float("nan")

    def raise_what_inputs_raised(self):
        raised, self.raised = self.raised, None
        if raised:
            raise raised

    def check(self, status):
        if status < 0:
            raise Error(self.message())

    def message(self):
        return self.lib.lag_sim_message(self.sim).decode()

    def choose(self, method, options, tol, until, tangent):
        """Method and tolerance; returns what is known of the choice."""
        if tol is not None:
            self.check(self.lib.lag_sim_set_tolerance(self.sim, float(tol)))
        table = (_Option * max(1, len(options)))(*[_Option(k.encode(), 0 if isinstance(v, str) else v, v.encode() if isinstance(v, str) else None)
                                                   for k, v in options.items()])
        if method:
            handle = self.lib.lag_find_method(method.encode())
            if not handle:
                raise Error(f"unknown method {method}" + _near(method, self.scene.items("m")))
            self.check(self.lib.lag_sim_set_method(self.sim, handle, table, len(options)))
            return method
        if self.scene.method and not options:
            return self.scene.method
        why = ctypes.create_string_buffer(400)
        self.check(self.lib.lag_sim_choose_method(self.sim, until, int(tangent), table, len(options), why, 400))
        return why.value.decode()

    def state(self):
        return np.array(self.lib.lag_sim_q(self.sim)[:self.scene.n])

    def start_moved(self):
        """Components of the start that was asked for and does not obey the constraints: (asked, begun), in declared units."""
        starts = {k: (self.lib.lag_sim_requested_start(self.sim, i), self.lib.lag_sim_actual_start(self.sim, i)) for i, k in enumerate(self.scene.q)}
        return {k: both for k, both in starts.items() if both[0] != both[1]}

    def info(self, function, count):
        name, unit, out = ctypes.create_string_buffer(256), ctypes.create_string_buffer(256), {}
        for i in range(count):
            function(self.sim, i, name, 256, unit, 256)
            out[name.value.decode()] = unit.value.decode()
        return out


class _Scene:
    def __init__(self, program, handle):
        self.program, self.lib, self.handle = program, program.lib, handle
        lib = self.lib
        t0, t1, every = (ctypes.c_double() for _ in range(3))
        self.name = lib.lag_scene_span(handle, *map(ctypes.byref, (t0, t1, every))).decode()
        self.t0, self.t1, self.every = t0.value, t1.value, every.value
        method = lib.lag_scene_method(handle)
        self.method = method and method.decode()
        # unit, factor and offset of each component of y and of each parameter
        q, z = self.items("q"), self.items("z")
        self.p = self.items("p")
        self.q = {**q, **{k + "'": (u and u + "/s", f, 0.0) for k, (u, f, _) in q.items()}}  # what constraints may move
        self.y = {**self.q, **z}
        self.n = len(self.y)

    def items(self, kind):
        found, unit, factor, offset = {}, ctypes.c_char_p(), ctypes.c_double(), ctypes.c_double()
        while True:
            name = self.lib.lag_item(self.handle, ord(kind), len(found), *map(ctypes.byref, (unit, factor, offset)))
            if name is None:
                return found
            found[name.decode()] = (unit.value.decode(), factor.value, offset.value)


# ---- models ----

def load(path, defines=None, compile="auto"):
    """Compiles a model: the path of a file, or "@pendulum" of the gallery. defines: values of its constants, {"N": 50}. compile: "always", or "never": it is
    evaluated, with the same digits, at a third of the speed; "auto": compiled where there is a C compiler. CompileError: the compiler's text."""
    return Model(path, defines, compile)


class Model:
    """A compiled model: its scenes, and what they have."""

    def __init__(self, path, defines=None, compile="auto"):
        if compile not in ("auto", "always", "never"):
            raise Error(f"compile = {compile!r}: give \"auto\", \"always\" or \"never\"")
        self._compiled = compile == "always" or compile == "auto" and _has_c_compiler()
        self.path = os.fspath(path)
        self._texts, self._kept = _texts(self.path), None
        self._defines = [word for k, v in (defines or {}).items() for word in ("-D", f"{k}={v}")]
        self._opened, self._simulation = {}, None
        scenes = self._scenes()
        self.scenes = list(scenes)
        self.name = os.path.splitext(os.path.basename(self.path))[0].lstrip("@")
        first = next(iter(scenes.values()))
        self.coordinates, self.states = list(first.items("q")), list(first.items("z"))
        self.inputs, self.events, self.charges = list(first.items("u")), list(first.items("e")), list(first.items("c"))
        self.methods = list(first.items("m"))

    def __repr__(self):
        return f"<lagc model {self.name}: y = {', '.join(self._scene(None).y)}; scenes {', '.join(self.scenes)}>"

    def _source(self):
        """The model's path; where its files were changed since it was loaded, that of a copy of the texts that the object keeps."""
        if any(_read(path) != text for path, text in self._texts.items()) and not self._kept:
            self._kept = tempfile.TemporaryDirectory()
            for path, text in self._texts.items():
                copy = self._kept.name + path
                os.makedirs(os.path.dirname(copy), exist_ok=True)
                with open(copy, "wb") as f:
                    f.write(text)
        return self._kept.name + os.path.abspath(self.path) if self._kept else self.path

    def _scenes(self, *words):
        """The scenes in a library with these options of `lagc build`: derivatives that a method or a tangent needs."""
        if words not in self._opened:
            self._opened[words] = _Program(self._compiled, self._source(), *self._defines, *words).scenes()
        return self._opened[words]

    def _scene(self, name, *words):
        scenes = self._scenes(*words)
        if name is None:
            return next(iter(scenes.values()))
        if not isinstance(name, str) or name not in scenes:
            raise Error(f"{self.name} has no scene {name}" + _near(name, list(scenes)))
        return scenes[name]

    def _simulate(self, scene, values, more, method, tol, step, until, tangent, *words):
        """A simulation with its method, and the words that describe it. method: "rk4", or "rk4(step=1e-3)"."""
        if method is not None and not isinstance(method, str):
            raise Error(f"method = {method!r}: give a text, \"rk4\" or \"rk4(step=1e-3)\"")
        name, _, inside = (method or "").partition("(")
        options = {k.strip(): v.strip() for k, _, v in (part.partition("=") for part in inside.rstrip(") ").split(",") if part.strip())}
        options = {k: float(v) if re.fullmatch(r"[-+.\deE]+", v) else v for k, v in options.items()}
        step, tol = (None if x is None else _number(k, x) for k, x in (("step", step), ("tol", tol)))
        if step is not None and not step > 0:
            raise Error(f"step={step}: a step is positive")
        if step is not None:
            options["step"] = step
        words = [*words] + (["--method", name.strip()] if method else []) + (["--with", tangent] if tangent else [])
        if tol is not None and tol < 1e-9 and not method:
            words += ["--method", "taylor"]
        s = self._scene(scene, *words)
        sim = _Simulation(s.lib, s, _named(values, more))
        return sim, sim.choose(name.strip(), options, tol, s.t1 if until is None else until, bool(tangent))

    def parameters(self, scene=None):
        """Values of the parameters in a scene, in declared units."""
        s = self._scene(scene)
        sim = _Simulation(s.lib, s, {})
        return {k: (s.lib.lag_sim_p(sim.sim)[i] - offset) / factor for i, (k, (_, factor, offset)) in enumerate(s.p.items())}

    def run(self, scene=None, values=None, *, until=None, every=None, times=None, method=None, tol=None, step=None, tangent=False, sensitivity=None, **more):
        """Runs a scene, as `lagc run` does. values, or keywords: parameters, starts ({"th'": 0.5}, th=1.2) and inputs, in declared units; an input may
        be a function of t. times: the rows, instead of `every`. tangent: also dy(end)/dy(0). sensitivity: names of
        parameters and starts, ("g", "th(0)"): also the derivatives of each row's outputs, result.sensitivity["g"]["th"], in declared units. RunError, with the rows so far, if it fails. A warning, and
        start_moved of the result, if the start does not obey the constraints."""
        until, every = (None if x is None else _number(k, x) for k, x in (("until", until), ("every", every)))
        by = [sensitivity] if isinstance(sensitivity, str) else list(sensitivity or [])
        if by and tangent:
            raise Error("tangent and sensitivity: each takes the tangent of the run for itself; make two runs")
        sim, chosen = self._simulate(scene, values, more, method, tol, step, until, "sensitivities" if by else "linear" if tangent else None)
        s, lib = sim.scene, sim.lib
        end = s.t1 if until is None else until
        times = _grid(s.t0, end, (s.every or abs(end - s.t0) / 1000) if every is None else every) if times is None else _array(times, (-1,), "times")
        if not len(times):
            raise Error("times is empty: give at least one time")
        events, names = [], list(s.items("e"))

        def on_event(context, k, t, before, after):
            events.append((names[k], t, np.array(before[:s.n]), np.array(after[:s.n])))

        hook = _EventHook(on_event)
        if names:
            lib.lag_sim_on_event(sim.sim, hook, None)
        sim.check(lib.lag_sim_balance(sim.sim))
        if tangent:
            sim.check(lib.lag_sim_set_tangent(sim.sim, s.n, None))
        if by:
            sim.check(lib.lag_sim_set_sensitivity(sim.sim, len(by), (ctypes.c_char_p * len(by))(*[k.encode() for k in by])))
        return self._rows(sim, chosen, times, events, tangent, by)

    def _rows(self, sim, chosen, times, events, tangent, by):
        s, lib = sim.scene, sim.lib
        outputs = sim.info(lib.lag_sim_output_info, lib.lag_sim_noutputs(sim.sim))
        y, out = np.empty((len(times) + 1, s.n)), np.empty((len(times) + 1, len(outputs)))
        done, rows, status, chunk = ctypes.c_int(), 0, 0, 1 if by else _CHUNK
        Y, D = np.empty((s.n, len(by))), np.empty((len(times) + 1, len(outputs), len(by)))
        while rows < len(times) and status == 0:
            part, sim.until.value = times[rows:rows + chunk], lib.lag_clock_seconds() + _PATIENCE
            status = lib.lag_sim_rows(sim.sim, len(part), _address(part), y[rows:].ctypes.data, out[rows:].ctypes.data, ctypes.byref(done))
            if by and status == 0 and done.value:
                sim.check(lib.lag_sim_tangent(sim.sim, _address(Y)))
                sim.check(lib.lag_sim_output_sensitivity(sim.sim, _address(Y), D[rows:].ctypes.data))
            rows, status = rows + done.value, 0 if status == _INTERRUPTED else status
        times = times[:rows]
        now = lib.lag_sim_time(sim.sim)
        if status and (rows == 0 or now != times[-1]) and lib.lag_sim_outputs(sim.sim, out[rows:].ctypes.data) == 0:
            y[rows] = sim.state()
            times, rows = np.append(times, now), rows + 1
        result = Result(self, sim, chosen, times, y[:rows], outputs, out[:rows], events)
        sim.raise_what_inputs_raised()
        if status < 0:
            raise RunError(sim.message(), status, result)
        if result.start_moved:
            said = [f"{k} from {asked:.15g} to {begun:.15g} {result.units[k] or ''}".rstrip() for k, (asked, begun) in result.start_moved.items()]
            warnings.warn("start moved to the constraints: " + ", ".join(said), stacklevel=3)
        if by:
            factors = [lib.lag_sim_sensitivity_info(sim.sim, j, None, 0, None, 0) for j in range(len(by))]
            result.sensitivity = {k: dict(zip(outputs, (D[:rows, :, j] * factors[j]).T)) for j, k in enumerate(by)}
        if tangent:
            result.tangent = np.empty((s.n, s.n))
            sim.check(lib.lag_sim_tangent(sim.sim, _address(result.tangent)))
        return result

    def _at(self, quantity, t, y, scene, values, more, a=None, derived=True):
        """A quantity of lag.h at one state y[n], or at many, y[k, n], as an array, with its _Scene; derived: of a library with derivatives."""
        words = ("--with", "derivatives") if derived else ()
        key = (scene, words, tuple(sorted(_named(values, more).items())))
        if not self._simulation or self._simulation[0] != key:
            s = self._scene(scene, *words)
            self._simulation = key, _Simulation(s.lib, s, dict(key[2]))
        sim = self._simulation[1]
        s = sim.scene
        y = np.ascontiguousarray(_numbers(y, "y"))
        states = _array(y if y.ndim == 2 else y[None], (-1, s.n), "y")
        if a is not None:
            a = _array(_spread(a, (len(states), len(s.items("q"))), "a"), (-1, -1), "a")
        t = np.ascontiguousarray(_spread(t, (len(states),), "t"))
        rows, columns = ctypes.c_int(), ctypes.c_int()
        s.lib.lag_sim_quantity_size(sim.sim, quantity, ctypes.byref(rows), ctypes.byref(columns))
        flat = quantity in (_RATES, _OUTPUTS, _INVERSE)
        out = np.empty((len(states), rows.value) if flat else (len(states), rows.value, columns.value))
        status = s.lib.lag_sim_quantity(sim.sim, quantity, len(states), _address(t), _address(states), _address(a), _address(out))
        sim.raise_what_inputs_raised()
        if status:
            raise RunError(sim.message(), status)
        return out if y.ndim == 2 else out[0]

    def rhs(self, t, y, scene=None, values=None, **more):
        """dy/dt at one state y[n], or at many, y[k, n]; SI units. values, or keywords: parameters and inputs."""
        return self._at(_RATES, t, y, scene, values, more, derived=False)

    def jac(self, t, y, scene=None, values=None, **more):
        """A = d(dy/dt)/dy, [n, n], or [k, n, n] at many states; SI units."""
        return self._at(_RATES + 1, t, y, scene, values, more)

    def input_jacobian(self, t, y, scene=None, values=None, **more):
        """B = d(dy/dt)/du by the inputs, in the order of `inputs`."""
        return self._at(_RATES + 2, t, y, scene, values, more)

    def parameter_jacobian(self, t, y, scene=None, values=None, **more):
        """d(dy/dt)/dp by the parameters, in the order of parameters(); those that follow from others by formulas follow."""
        return self._at(_RATES + 3, t, y, scene, values, more)

    def jvp(self, t, y, x, scene=None, values=None, **more):
        """J x with J = jac(t, y): of one state, or of each of many."""
        jac = self.jac(t, y, scene, values, **more)
        return np.einsum("...ij,...j->...i", jac, _vector(x, jac.shape[-1]))

    def vjp(self, t, y, x, scene=None, values=None, **more):
        """J^T x with J = jac(t, y)."""
        jac = self.jac(t, y, scene, values, **more)
        return np.einsum("...ij,...i->...j", jac, _vector(x, jac.shape[-2]))

    def outputs(self, t, y, scene=None, values=None, **more):
        """The scene's outputs at states, in SI units."""
        return self._at(_OUTPUTS, t, y, scene, values, more, derived=False)

    def output_jacobian(self, t, y, scene=None, values=None, **more):
        """C and D: derivatives of the scene's outputs by the state and by the inputs, in SI units."""
        return tuple(self._at(_OUTPUTS + k, t, y, scene, values, more) for k in (1, 2))

    def mass(self, t, y, scene=None, values=None, **more):
        """The mass matrix M, [nq, nq]."""
        return self._at(_MASS, t, y, scene, values, more)

    def inverse_dynamics(self, t, y, a, scene=None, values=None, **more):
        """The generalised forces M a + bias that the accelerations a need besides those of the model."""
        return self._at(_INVERSE, t, y, scene, values, more, a)

    def bias(self, t, y, scene=None, values=None, **more):
        """b of M q'' + b = 0: Coriolis and centrifugal terms, weight and the forces of the model, with their signs changed."""
        return self._at(_INVERSE, t, y, scene, values, more, 0.0)

    def linearize(self, scene=None, values=None, *, equilibrium=False, steady=False, **more):
        """The system y' = A y + B u, out = C y + D u of small changes about the scene's start, the equilibrium or the steady motion next to it, in SI units:
        arrays A, B, C, D, the names and units of states, inputs and outputs, and values, the state where it holds. values, or keywords: numbers, or texts with units."""
        words = [f"{k}={v if isinstance(v, str) else repr(_number(k, v))}" for k, v in _named(values, more).items()]
        words += ["--equilibrium"] * bool(equilibrium) + ["--steady"] * bool(steady) + ["--compile", "auto" if self._compiled else "never"]
        return Linear(json.loads(_lagc("linearize", self._source(), *([scene] if scene else []), *words, *self._defines, "--json")))

    def sensitivity(self, names, scene=None, values=None, **more):
        """Derivatives of a run's outputs by parameters and starts: run(sensitivity=names).sensitivity."""
        return self.run(scene, values, sensitivity=names, **more).sensitivity

    def gradient(self, objective, scene=None, values=None, *, until=None, times=None, y0=None, p=None, method=None, tol=None, step=None, **more):
        """The gradient of one number by all starts and parameters, by reverse mode: some four runs, however many there are. objective: an output or a
        component of the state, at the end of the run; or a function f(t, y) that gives J and dJ/dy[rows, n] of the states y[rows, n] at `times`, in SI units.
        y0[n], p[np]: starts and parameters as arrays, in SI units, as for batch."""
        method, s = method or "dop853", self._scene(scene)
        for what, array, table in (("y0", y0, s.y), ("p", p, s.p)):
            if array is not None:
                given = _array(array, (len(table),), what)
                values = {**{k: (x - offset) / factor for (k, (_, factor, offset)), x in zip(table.items(), given)}, **(values or {})}
        sim, _ = self._simulate(scene, values, more, method, tol, step, until, "derivatives")
        s, lib = sim.scene, sim.lib
        end = until if until is not None else times[-1] if times is not None and len(times) else s.t1
        times = np.array([float(end)]) if times is None else _array(times, (-1,), "times")
        y, done = np.empty((len(times), s.n)), ctypes.c_int()
        sim.check(lib.lag_sim_record(sim.sim))
        status = lib.lag_sim_rows(sim.sim, len(times), _address(times), _address(y), None, ctypes.byref(done))
        sim.raise_what_inputs_raised()
        if status:
            raise RunError(sim.message() or "the run ends before the last time", status)
        by_p = np.zeros(len(s.p))
        if callable(objective):
            value, weight = objective(times, y)
            weight = _array(weight, y.shape, "dJ/dy")
        else:
            value, weight, by_p = self._output(sim, objective, times[-1], y)
        start, parameters = np.empty(s.n), np.empty(len(s.p))
        if lib.lag_sim_gradient(sim.sim, len(times), _address(times), _address(weight), _address(start), _address(parameters)):
            raise Error(sim.message())
        return Gradient(s, float(value), start, parameters + by_p)

    @staticmethod
    def _output(sim, name, t, y):
        """Value of an output, or component of the state, in its declared unit; its derivatives by y[rows, n], of which only the last count, and by parameters."""
        s, lib = sim.scene, sim.lib
        names = list(sim.info(lib.lag_sim_output_info, lib.lag_sim_noutputs(sim.sim)))
        if name not in names and name not in s.y:
            raise Error(f"{name}: no such output" + _near(name, [*names, *s.y]))
        weight, by_p = np.zeros_like(y), np.zeros(len(s.p))
        if name not in names:
            k, (_, factor, offset) = list(s.y).index(name), s.y[name]
            weight[-1, k] = 1 / factor
            return (y[-1, k] - offset) / factor, weight, by_p
        i, when = names.index(name), np.array([t])
        factor, values = lib.lag_sim_output_info(sim.sim, i, None, 0, None, 0), np.empty(len(names))
        C, P = np.empty((len(names), s.n)), np.empty((len(names), len(s.p)))
        sim.check(lib.lag_sim_outputs(sim.sim, _address(values)))
        for of, to in ((_OUTPUTS + 1, C), (_OUTPUTS + 3, P)):
            sim.check(lib.lag_sim_quantity(sim.sim, of, 1, _address(when), y[-1:].ctypes.data, None, _address(to)))
        weight[-1] = C[i] / factor
        return values[i], weight, P[i] / factor

    def batch(self, scene=None, values=None, *, times, y0=None, p=None, out=None, method=None, tol=None, step=None, threads=1, lanes=None, **more):
        """Many motions in one call. values, or keywords: a number, or an array with one number a motion, in declared units; or y0[count, n] and
        p[count, np], in SI units, in the order of parameters(). times: when states are kept. out: an array [count, len(times), n] to fill. Arrays of doubles are not copied. lanes: 4 or 8 motions
        at once in vectors, with the digits of `lagc sweep`, which differ from those of run() by rounding; None: from 2000 motions on. A library for it is compiled once, in seconds."""
        given = _named(values, more)
        columns = {k: _array(v, (-1,), k) for k, v in given.items() if not callable(v) and np.ndim(v)}
        times = _array(times, (-1,), "times")
        for k, v in [*columns.items(), ("y0", y0), ("p", p), ("times", times)]:
            bad = [] if v is None else np.argwhere(~np.isfinite(_numbers(v, k)))
            if len(bad):
                raise Error(f"{k}: {'row' if v is times else 'motion'} {bad[0][0]} has a value that is not finite")
        if isinstance(threads, bool) or not isinstance(threads, (int, np.integer)) or threads < 1:
            raise Error(f"threads = {threads!r}: a number of threads, at least 1")
        if not any(lanes is v for v in (None, True, False)) and lanes not in (0, 1, 4, 8):
            raise Error(f"lanes = {lanes!r}: 4 or 8 motions at once, 0 or 1 for one at a time")
        until = times[-1] if len(times) else None
        simulate = scene, {k: v for k, v in given.items() if k not in columns}, {}, method, tol, step, until, False
        sim, chosen = self._simulate(*simulate)
        y0, p = self._starts(sim, columns, y0, p)
        count = len(y0) if y0 is not None else len(p) if p is not None else 1
        if self._compiled and (count >= _LANES_FROM if lanes is None else int(lanes) > 1 or lanes is True) and sim.lib.lag_sim_set_lanes(sim.sim, None) > 1:
            sim, chosen = self._simulate(*simulate, "--lanes")
            sim.lib.lag_sim_set_lanes(sim.sim, sim.scene.program.handle)
        s = sim.scene
        shape = (count, len(times), s.n)
        if out is None:
            out = np.empty(shape)
        elif not isinstance(out, np.ndarray) or out.shape != shape or out.dtype != np.float64 or not out.flags.c_contiguous or not out.flags.writeable:
            raise Error(f"out must be a writable array of doubles in C order of the shape {shape}")
        y0, p = (x if x is None or not np.may_share_memory(x, out) else x.copy() for x in (y0, p))
        times = times.copy() if np.may_share_memory(times, out) else times
        self._refuse_signs(sim, p)
        status = np.empty(count, dtype=np.intc)

        def part(a, b):
            return s.lib.lag_sim_batch(sim.sim, b - a, None if y0 is None else y0[a:].ctypes.data, None if p is None else p[a:].ctypes.data, len(times),
                                       _address(times), out[a:].ctypes.data, status[a:].ctypes.data)

        cuts = np.linspace(0, count, max(1, min(threads, count)) + 1).astype(int)
        with ThreadPoolExecutor(len(cuts) - 1) as pool:
            try:
                if any(pool.map(part, cuts[:-1], cuts[1:])):
                    raise MemoryError
            except KeyboardInterrupt:
                sim.until.value = 0  # motions end at their next step
                raise
        sim.raise_what_inputs_raised()
        return Batch(times, out, status, list(s.y), chosen)

    def sweep(self, scene=None, values=None, *, measure=None, until=None, method=None, tol=None, step=None, samples=None, sampling=None, seed=None, zip=False, threads=None, **more):
        """Many runs by `lagc sweep`: a structured array, a row a run, with the columns of its CSV. values, or keywords: a number, a sequence of numbers,
        or a text: th="-180..180[deg]:512", k="1e-3..1e3:log:7", g="~normal(9.81, 0.01)" with samples=1000. measure: expressions, ["max(x)"] or {"T": "period(th)"}."""
        words = []
        for k, v in _named(values, more).items():
            text = v.strip() if isinstance(v, str) else ",".join(repr(float(x)) for x in np.ravel(v))
            words.append(k + text if text.startswith("~") else f"{k}={text}")
        for m in measure.items() if isinstance(measure, dict) else [measure] if isinstance(measure, str) else measure or []:
            words += ["--measure", m if isinstance(m, str) else "=".join(m)]
        for option, v in (("until", until), ("method", method), ("tol", tol), ("step", step), ("samples", samples), ("sampling", sampling), ("seed", seed), ("threads", threads)):
            words += [] if v is None else [f"--{option}", str(v)]
        with tempfile.TemporaryDirectory() as folder:
            rows = os.path.join(folder, "rows.npy")
            _lagc("sweep", self._source(), *([scene] if scene else []), *words, *(["--zip"] if zip else []), *self._defines, "-o", rows, "--quiet")
            return np.load(rows)

    @staticmethod
    def _refuse_signs(sim, p):
        """Raises what the library says of a motion whose parameters break declared signs: the least or the largest of a column does."""
        trial = _Simulation(sim.lib, sim.scene, {})
        for (name, (_, factor, offset)), x in zip(sim.scene.p.items(), [] if p is None else p.T):
            for motion in {int(np.nanargmin(x)), int(np.nanargmax(x))} if not np.all(np.isnan(x)) else ():
                if sim.lib.lag_sim_set(trial.sim, name.encode(), (x[motion] - offset) / factor) < 0:
                    raise Error(f"motion {motion}: {trial.message()}")

    @staticmethod
    def _starts(sim, columns, y0, p):
        """Arrays of starts and parameters, from columns by name."""
        s = sim.scene
        sizes = {len(v) for v in columns.values()} | {len(v) for v in (y0, p) if v is not None}
        if len(sizes) > 1:
            raise Error(f"arrays of a batch differ in length: {', '.join(map(str, sorted(sizes)))}")
        for kind, table, current in (("y0", s.y, sim.state()), ("p", s.p, np.array(sim.lib.lag_sim_p(sim.sim)[:len(s.p)]))):
            mine = {k: v for k, v in columns.items() if k in table}
            whole = y0 if kind == "y0" else p
            if whole is not None and mine:
                raise Error(f"{', '.join(mine)} and {kind} set the same values: give one of them")
            if mine: # parameters that are not given stay NaN: they may follow from these by formulas
                whole = np.tile(current if kind == "y0" else np.full(len(table), np.nan), (len(next(iter(mine.values()))), 1))
                for k, v in mine.items():
                    _, factor, offset = table[k]
                    whole[:, list(table).index(k)] = v * factor + offset
            if whole is not None:
                whole = _array(whole, (-1, len(table)), kind)
            y0, p = (whole, p) if kind == "y0" else (y0, whole)
        for k in columns:
            if k in s.items("u"):
                raise Error(f"{k}: an input takes one value or one function for all motions of a batch")
            if k not in s.y and k not in s.p:
                raise Error(f"{k}: no such parameter or coordinate" + _near(k, [*s.y, *s.p]))
        return y0, p

    # ---- display ----

    @property
    def equations(self):
        """The equations of motion as text."""
        return _lagc("derive", self._source(), *self._defines)

    @property
    def latex(self):
        """The equations of motion as LaTeX."""
        return _lagc("derive", self._source(), *self._defines, "--format", "latex")

    def _repr_latex_(self):
        part = re.search(r"% equations of motion\n\\begin\{align\*\}(.*?)\\end\{align\*\}", self.latex, re.S)
        return "$$\\begin{aligned}" + part.group(1) + "\\end{aligned}$$" if part else None


# ---- results ----

class Result:
    """A run: t[rows], y[rows, n] in SI units; r["th"] is a column of the scene's outputs, or of the state, in declared units."""

    def __init__(self, model, sim, chosen, t, y, outputs, out, events):
        s, stats = sim.scene, _Stats()
        self.model, self.scene, self.method, self.t, self.y = model.name, s.name, chosen, t, y
        self.events = events  # (name, time, state before, state after)
        self.start_moved = sim.start_moved()  # onto the constraints: {name: (asked, begun)}, in declared units
        self.units = {**{k: u for k, (u, _, _) in s.y.items()}, **outputs}
        self._columns = {k: (y[:, i] - offset) / factor for i, (k, (_, factor, offset)) in enumerate(s.y.items())}
        self._columns.update({k: out[:, i] for i, k in enumerate(outputs)})
        self.names = list(outputs)
        sim.lib.lag_sim_stats(sim.sim, ctypes.byref(stats))
        self.stats = {k: getattr(stats, k) for k, _ in _Stats._fields_}
        self.energy_drift, self.charges = stats.energy_drift, {}  # drifts: less what forces and inputs explain
        for k in range(sim.lib.lag_sim_ncharges(sim.sim)):
            charge = _Charge()
            sim.lib.lag_sim_charge(sim.sim, k, ctypes.byref(charge))
            self.charges[charge.name.decode()] = {"begin": charge.begin, "now": charge.now, "drift": charge.drift, "unit": charge.unit.decode()}

    def __getitem__(self, name):
        if name == "t":
            return self.t
        if name not in self._columns:
            raise Error(f"{name}: no such output" + _near(name, list(self._columns)))
        return self._columns[name]

    def keys(self):
        return list(self._columns)

    def __len__(self):
        return len(self.t)

    def __repr__(self):
        return f"<lagc run of {self.model}, scene {self.scene}: {len(self.t)} rows to t = {self.t[-1]:g} s, energy drift {self.energy_drift:.3g}>"

    def plot(self, *names, x="t", ax=None):
        """Draws columns against another, by matplotlib; returns its axes."""
        if ax is None:
            import matplotlib.pyplot as plt
            ax = plt.gca()
        for name in names or self.names:
            ax.plot(self[x], self[name], label=name)
        ax.set_xlabel(f"{x} [{'s' if x == 't' else self.units[x]}]")
        ax.legend()
        return ax

    def _repr_svg_(self):
        """The outputs against time, each scaled to the height of the picture."""
        wide, high, parts = 640, 240, []
        rows = np.unique(np.linspace(0, len(self.t) - 1, min(len(self.t), 1500)).astype(int))
        x = (self.t[rows] - self.t[0]) / ((self.t[-1] - self.t[0]) or 1) * wide
        for i, name in enumerate(self.names):
            v, colour = self[name][rows], f"hsl({137 * i % 360},70%,40%)"
            fine = np.isfinite(v)
            if not fine.any():
                continue
            low, top = v[fine].min(), v[fine].max()
            line = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x[fine], high - (v[fine] - low) / ((top - low) or 1) * high))
            label = name.replace("&", "&amp;").replace("<", "&lt;")
            parts.append(f'<polyline fill="none" stroke="{colour}" points="{line}"/>'
                         f'<text x="{wide + 8}" y="{16 * i + 16}" fill="{colour}">{label}: {low:.4g} to {top:.4g} {self.units[name]}</text>')
        return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-4 -4 {wide + 248} {max(high, 16 * len(self.names)) + 24}" font-size="13" font-family="sans-serif">'
                f'{"".join(parts)}<text x="0" y="{high + 16}">t = {self.t[0]:g} to {self.t[-1]:g} s</text></svg>')


class Linear:
    """y' = A y + B u, out = C y + D u; states, inputs, outputs: their names; units: those declared, whose size in SI is in factors; values: the state where it holds, in declared units."""

    def __init__(self, of):
        self.states, self.inputs, self.outputs = ([x["name"] for x in of[k]] for k in ("states", "inputs", "outputs"))
        variables = [x for k in ("states", "inputs", "outputs") for x in of[k]]
        self.units, self.factors = ({x["name"]: x[k] for x in variables} for k in ("unit", "factor"))
        n, nu, nout = len(self.states), len(self.inputs), len(self.outputs)
        shapes = {"A": (n, n), "B": (n, nu), "C": (nout, n), "D": (nout, nu), "rate": (n,)}
        for name, shape in shapes.items():
            setattr(self, name, np.array(of[name], dtype=np.float64).reshape(shape))
        self.about, self.values = of["about"], {x["name"]: x["value"] for x in of["states"]}

    def __repr__(self):
        return f"<linear system about the {self.about}: y = {', '.join(self.states)}; u = {', '.join(self.inputs)}; out = {', '.join(self.outputs)}>"


class Gradient:
    """A number and its derivatives: value; start and parameters by name, in declared units; by_start[n], by_p[np] in SI."""

    def __init__(self, scene, value, by_start, by_p):
        self.value, self.by_start, self.by_p = value, by_start, by_p
        self.start, self.parameters = ({k: d * factor for (k, (_, factor, _)), d in zip(of.items(), by)} for of, by in ((scene.y, by_start), (scene.p, by_p)))

    def __repr__(self):
        return f"<gradient of {self.value:.9g}: {', '.join(f'{k} {d:.4g}' for k, d in [*self.start.items(), *self.parameters.items()])}>"


class Batch:
    """Many motions: y[count, times, n] in SI units, status[count] (0: fine; else y is NaN from the failure on)."""

    def __init__(self, t, y, status, names, method):
        self.t, self.y, self.status, self.names, self.method = t, y, status, names, method

    def __getitem__(self, name):
        if name not in self.names:
            raise Error(f"{name}: no such component of y" + _near(name, self.names))
        return self.y[:, :, self.names.index(name)]
