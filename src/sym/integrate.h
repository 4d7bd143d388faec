/* Antiderivatives of what generators of symmetries make of Lagrangians: sums of terms
 * c * x^k * exp(a x + ..) * products of sines and cosines of b x + .., with c, a, b free of x.
 * Each term becomes, by addition theorems, a sum of terms x^k exp(u) sin(w) and x^k exp(u) cos(w); these are integrated by parts
 * (I. S. Gradshteyn, I. M. Ryzhik, Table of Integrals, Series, and Products, 7th ed. (2007), 2.66). */
#ifndef LAGC_INTEGRATE_H
#define LAGC_INTEGRATE_H

#include "sym/expr.h"

/* An antiderivative by x of those terms of e that are of this form, and free of the symbols of kinds in `without`
 * (bits 1 << SymKind; x itself does not count); 0 where there is none. Where a frequency or a rate of growth is a sum of parameters, it
 * is taken not to be 0. The result is no proof: callers differentiate it. Definitions are looked through. */
Expr expr_integrate(ExprGraph *g, Expr e, SymId x, unsigned without);

/* F with dF/dq_i = a_i for all i, where it finds one: coordinate by coordinate with expr_integrate, and terms f(u) du/dq_i by substitution, or, where q.a is a sum of terms
 * homogeneous in all q together, none of degree 0, by the homotopy formula F = int_0^1 q.a(s q) ds. Otherwise an F that
 * takes off some of the terms, to be judged by what it leaves. */
Expr expr_potential(ExprGraph *g, const Expr *a, const SymId *q, uint32_t n);

#endif
