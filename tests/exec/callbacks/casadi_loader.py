"""CasADi's external functions as its user guide describes them ("API of the generated code", "External functions"), without CasADi: reads names, sparsities and sizes of work
space from a shared library, calls the function and its Jacobian, and holds the Jacobian against central differences of the function."""
import ctypes, math, sys

Int, Real = ctypes.c_longlong, ctypes.c_double


def sparsity(at):
    """nrow, ncol, column offsets, rows of a compressed pattern; a third entry 1 is a dense one."""
    nrow, ncol = at[0], at[1]
    if at[2] == 1:
        return nrow, ncol, [j * nrow for j in range(ncol + 1)], [i for _ in range(ncol) for i in range(nrow)]
    first = [at[2 + j] for j in range(ncol + 1)]
    nnz = first[ncol]
    rows = [i for _ in range(ncol) for i in range(nrow)] if nnz == nrow * ncol else [at[3 + ncol + k] for k in range(nnz)]
    for j in range(ncol):
        column = rows[first[j]:first[j + 1]]
        assert first[j] <= first[j + 1] and column == sorted(set(column)) and all(0 <= i < nrow for i in column), "a pattern of compressed columns"
    return nrow, ncol, first, rows


class External:
    def __init__(self, name, lib):
        def get(suffix, result, *arguments):
            f = getattr(lib, name + suffix)
            f.restype, f.argtypes = result, arguments
            return f
        self.n_in, self.n_out = get("_n_in", Int)(), get("_n_out", Int)()
        name_in, name_out = get("_name_in", ctypes.c_char_p, Int), get("_name_out", ctypes.c_char_p, Int)
        self.names_in = [name_in(i).decode() for i in range(self.n_in)]
        self.names_out = [name_out(i).decode() for i in range(self.n_out)]
        shape_in, shape_out = (get(s, ctypes.POINTER(Int), Int) for s in ("_sparsity_in", "_sparsity_out"))
        self.sparsity_in = [sparsity(shape_in(i)) for i in range(self.n_in)]
        self.sparsity_out = [sparsity(shape_out(i)) for i in range(self.n_out)]
        for wrong in (name_in(self.n_in), name_in(-1), name_out(-1), name_out(self.n_out), bool(shape_in(-1)), bool(shape_out(self.n_out))):
            assert not wrong, "an index that is none gives a null pointer"
        sizes = [Int(-1) for _ in range(4)]
        assert get("_work", ctypes.c_int, *[ctypes.POINTER(Int)] * 4)(*[ctypes.byref(s) for s in sizes]) == 0
        self.work = [s.value for s in sizes]
        assert self.work[0] >= self.n_in and self.work[1] >= self.n_out, "room for the arguments and results"
        self.f = get("", ctypes.c_int, *[ctypes.c_void_p] * 4, ctypes.c_int)

    def __call__(self, args, wanted=None):
        """Nonzeros of the results; an argument None is a null pointer, as is a result that is not wanted. Guards stand behind every array."""
        guard = 1234.5
        ins = [None if a is None else (Real * (len(a) + 1))(*a, guard) for a in args]
        outs = [(Real * (len(s[3]) + 1))(*[math.nan] * len(s[3]), guard) if wanted is None or k in wanted else None for k, s in enumerate(self.sparsity_out)]
        w = (Real * (self.work[3] + 1))(*[math.nan] * self.work[3], guard)
        pointers = lambda list, n: (ctypes.c_void_p * n)(*[None if a is None else ctypes.addressof(a) for a in list])
        if self.f(pointers(ins, self.work[0]), pointers(outs, self.work[1]), (Int * (self.work[2] + 1))(), w, 0):
            raise ArithmeticError("the function has failed")
        assert all(a[-1] == guard for a in [w, *outs, *ins] if a is not None), "no array is left"
        return [None if a is None else list(a)[:-1] for a in outs]


def check(path, with_jac, x, u, p, t):
    lib = ctypes.CDLL(path)
    f = External("mm_ode", lib)
    assert f.names_in == ["x", "u", "p", "t"] and f.names_out == ["xdot"]
    assert [s[:2] for s in f.sparsity_in] == [(len(x), 1), (len(u), 1), (len(p), 1), (1, 1)] and f.sparsity_out[0][:2] == (len(x), 1)
    args = [x, u, p, [t]]
    xdot = f(args)[0]
    assert f([None, None, None, None], wanted=[]) == [None]
    if not with_jac:
        assert not hasattr(lib, "jac_mm_ode")
        return xdot
    jac = External("jac_mm_ode", lib)
    assert jac.names_in == f.names_in + ["out_xdot"] and jac.names_out == ["jac_xdot_" + n for n in f.names_in]
    assert jac.sparsity_in[:4] == f.sparsity_in and jac.sparsity_in[4][:2] == (len(x), 1)
    blocks = jac(args + [None])
    assert jac(args + [xdot], wanted=[1])[1] == blocks[1]
    for k, (block, (nrow, ncol, first, rows)) in enumerate(zip(blocks, jac.sparsity_out)):
        assert (nrow, ncol) == (len(x), len(args[k]))
        for j in range(ncol):
            column = [0.0] * nrow
            for n in range(first[j], first[j + 1]):
                column[rows[n]] = block[n]
            h = 1e-6 * (1e-2 + abs(args[k][j]))
            ends = [[list(a) for a in args] for _ in range(2)]
            ends[0][k][j] -= h
            ends[1][k][j] += h
            low, high = f(ends[0])[0], f(ends[1])[0]
            slope = [(b - a) / (2 * h) for a, b in zip(low, high)]
            scale = max(abs(s) for s in slope) + max(1e-4 * abs(y) / (1e-2 + abs(args[k][j])) for y in xdot)
            for i in range(nrow):
                assert abs(column[i] - slope[i]) <= 2e-5 * scale, f"{jac.names_out[k]}[{i},{j}]: {column[i]}, not {slope[i]}"
    return xdot


if __name__ == "__main__":
    path, with_jac, *sizes = sys.argv[1:]
    vectors = [[float(v) for v in text.split()] for text in sizes]
    x, u, p, (t, *expected) = vectors
    xdot = check(path, with_jac == "1", x, u, p, t)
    for got, want in zip(xdot, expected):
        assert abs(got - want) <= 1e-12 * (1 + abs(want)), f"xdot: {got}, not {want}"
