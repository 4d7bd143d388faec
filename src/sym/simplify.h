/* Short and numerically stable forms of expressions, for reading and for emitted code. Only exact identities are
 * applied: the result equals the input wherever the input is defined. */
#pragma once

#include "sym/expr.h"

/* Textbook form: angles combined, terms collected by the functions of the state, parameters factored: (m1 +
 * m2)*g*l1*sin(th1) + m2*l1*l2*sin(th1 - th2)*th2'^2. Definitions are expanded. Returns e itself if the polynomial
 * form has more than 2000 terms, if the short form would overflow where e does not or loses the digits of a product
 * beside its zeros, or unless it takes fewer operations (expr_ops); with equal counts the short form wins only where
 * e has definitions. */
Expr simplify(ExprGraph *g, Expr e);

/* simplify that keeps definitions opaque; returns e unless the operation count falls. */
Expr simplify_shallow(ExprGraph *g, Expr e);

/* Rewrites against cancellation:
 *   R - R*cos u -> 2*R*sin(u/2)^2, R + R*cos u -> 2*R*cos(u/2)^2, R*cosh u - R -> 2*R*sinh(u/2)^2;
 *   a^2 - b^2 -> (a - b)*(a + b) where each of a, b is a symbol or 1.
 * Definitions keep their names. */
Expr simplify_stable(ExprGraph *g, Expr e);
/* Its half angles alone, where e, or the text before simplification, divides by what a cosine in e depends on, as
 * (1 - cos x)/x or sin(x)^2/(1 + cos x): near 0 such a quotient has no digits left otherwise. */
Expr simplify_stable_quotients(ExprGraph *g, Expr e, Expr text);
