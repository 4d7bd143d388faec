/* Antiderivatives for Noether charges: sums of terms c * x^k * exp(a x + ..) * products of sines and cosines of b x
 * + .., with c, a, b free of x. Each term becomes, by addition theorems, a sum of terms x^k exp(u) sin(w) and x^k
 * exp(u) cos(w); these are integrated by parts (I. S. Gradshteyn, I. M. Ryzhik, Table of Integrals, Series, and
 * Products, 7th ed. (2007), 2.66). */
#pragma once

#include "sym/expr.h"

/* Antiderivative by x of the terms of e that have this form and are free of symbols of the kinds in `without`
 * (bits 1 << SymKind; x itself is allowed); 0 if there are none. A frequency or growth rate that is a sum of parameters
 * is assumed nonzero. Callers verify the result by differentiating it. Definitions are expanded. */
Expr expr_integrate(ExprGraph *g, Expr e, SymId x, unsigned without);

/* Potential F with dF/dq_i = a_i for all i, integrated coordinate by coordinate with expr_integrate. F may cover
 * some of the terms only: the caller judges the remainder a_i - dF/dq_i. by_substitution: functions f(u) du/dq_i of
 * a table, powers of sums, denominators, and the sides of switches, too; takes longer. */
Expr expr_potential(ExprGraph *g, const Expr *a, const SymId *q, uint32_t n, int by_substitution);
