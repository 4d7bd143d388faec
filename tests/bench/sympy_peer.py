#!/usr/bin/env python3
"""What SymPy makes of the same systems: LagrangesMethod, cse, C.

    sympy_peer.py chain N | spherical N | gyroscope  OUT.c [inverse]

OUT.c has ACCEL(sympy): M and f after common subexpressions, then a hand-written L D L^T; with `inverse` also
ACCEL(sympy_inverse): the accelerations solved symbolically. Prints `ops` of M and f, and the seconds that it took.
"""
import sys
import time

import sympy as sp
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

t = dynamicsymbols._t


def chain(n):
    q = [dynamicsymbols("q%d" % i) for i in range(n)]
    m, l, g = sp.symbols("m:%d" % n), sp.symbols("l:%d" % n), sp.Symbol("g")
    x = y = L = sp.Integer(0)
    for i in range(n):
        x, y = x + l[i]*sp.sin(q[i]), y - l[i]*sp.cos(q[i])
        L += m[i]/2*(x.diff(t)**2 + y.diff(t)**2) - m[i]*g*y
    return L, q, list(m) + list(l) + [g]


def spherical(n):
    th, ph = [dynamicsymbols("a%d" % i) for i in range(n)], [dynamicsymbols("b%d" % i) for i in range(n)]
    m, l, g = sp.symbols("m:%d" % n), sp.symbols("l:%d" % n), sp.Symbol("g")
    x = y = z = L = sp.Integer(0)
    for i in range(n):
        x, y = x + l[i]*sp.sin(th[i])*sp.cos(ph[i]), y + l[i]*sp.sin(th[i])*sp.sin(ph[i])
        z = z - l[i]*sp.cos(th[i])
        L += m[i]/2*(x.diff(t)**2 + y.diff(t)**2 + z.diff(t)**2) - m[i]*g*z
    return L, th + ph, list(m) + list(l) + [g]


def gyroscope(_):
    ph, th, ps = dynamicsymbols("ph th ps")
    I1, I3, mgl = sp.symbols("I1 I3 mgl")
    T = I1/2*(th.diff(t)**2 + sp.sin(th)**2*ph.diff(t)**2) + I3/2*(ps.diff(t) + sp.cos(th)*ph.diff(t))**2
    return T - mgl*sp.cos(th), [ph, th, ps], [I1, I3, mgl]


LDLT = """  for (int k = 0; k < %(n)d; k++) {
    if (!(M[k][k] > 0)) return -1;
    double inv = M[k][k] = 1/M[k][k];
    for (int i = k + 1; i < %(n)d; i++) {
      double x = M[i][k]*inv;
      for (int j = k + 1; j <= i; j++) M[i][j] -= x*M[j][k];
      f[i] -= x*f[k];
    }
  }
  for (int k = %(n)d - 1; k >= 0; k--) {
    double x = f[k];
    for (int i = k + 1; i < %(n)d; i++) x -= M[i][k]*a[i];
    a[k] = x*M[k][k];
  }
"""


def function(name, q, params, exprs, targets, rest, size):
    n = len(q)
    state = {s: sp.Symbol("q[%d]" % i) for i, s in enumerate(q)}
    rates = {s.diff(t): sp.Symbol("v[%d]" % i) for i, s in enumerate(q)}
    names = {s: sp.Symbol("p[%d]" % i) for i, s in enumerate(params)}
    exprs = [e.subs(rates).subs(state).subs(names) for e in exprs]
    common, reduced = sp.cse(exprs, symbols=sp.numbered_symbols("x"))
    ops = sum(sp.count_ops(e) for _, e in common) + sum(sp.count_ops(e) for e in reduced)
    text = ["ACCEL(%s) {" % name] + (["  double M[%d][%d], f[%d];" % (n, n, n)] if size else [])
    text += ["  const double %s = %s;" % (s, sp.ccode(e)) for s, e in common]
    text += ["  %s = %s;" % (target, sp.ccode(e)) for target, e in zip(targets, reduced)]
    return "\n".join(text) + "\n" + rest + "  ONLY_QVP;\n  return 0;\n}\n", ops


def main():
    what, n, out = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    begin = time.time()
    L, q, params = {"chain": chain, "spherical": spherical, "gyroscope": gyroscope}[what](n)
    method = LagrangesMethod(L, q)
    method.form_lagranges_equations()
    M, f = method.mass_matrix, method.forcing
    n = len(q)
    lower = [(i, j) for i in range(n) for j in range(i + 1)]
    targets = ["M[%d][%d]" % ij for ij in lower] + ["f[%d]" % i for i in range(n)]
    code, ops = function("sympy", q, params, [M[i, j] for i, j in lower] + list(f), targets, LDLT % {"n": n}, 1)
    took = time.time() - begin
    if "inverse" in sys.argv:
        code += function("sympy_inverse", q, params, list(M.inv()*f), ["a[%d]" % i for i in range(n)], "", 0)[0]
    with open(out, "w") as file:
        file.write('#include <math.h>\n\n#include "hand/accel.h"\n\n' + code)
    print("ops", ops)
    print("seconds %.2f" % took)


main()
