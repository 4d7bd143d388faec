/* Short and stable forms of expressions, for reading and for emitted code. Both are exact: only
 * identities are applied, and what is returned equals what came in wherever that is defined. */
#ifndef LAGC_SIMPLIFY_H
#define LAGC_SIMPLIFY_H

#include "sym/expr.h"

/* The form that a physicist would write: angles combined, like terms collected by the functions of
 * the state, parameters factored: (m1 + m2)*g*l1*sin(th1) + m2*l1*l2*sin(th1 - th2)*th2'^2.
 * Definitions are looked through. Returns e itself unless the new form takes fewer operations
 * (expr_ops), or as many and e has definitions in it; and when the polynomial form of e has more
 * than 2000 terms. */
Expr simplify(ExprGraph *g, Expr e);

/* The same without looking through definitions. */
Expr simplify_shallow(ExprGraph *g, Expr e);

/* Rewrites that keep digits where terms would cancel:
 *   R - R*cos u -> 2*R*sin(u/2)^2, R + R*cos u -> 2*R*cos(u/2)^2, R*cosh u - R -> 2*R*sinh(u/2)^2;
 *   a^2 - b^2 -> (a - b)*(a + b) where each of a, b is a symbol or 1.
 * Definitions keep their names. */
Expr simplify_stable(ExprGraph *g, Expr e);

#endif
