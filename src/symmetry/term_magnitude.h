/* Magnitude of an expression's terms, the scale of its rounding. */
#ifndef LAGC_SYMMETRY_TERM_MAGNITUDE_H
#define LAGC_SYMMETRY_TERM_MAGNITUDE_H

#include "sym/expr.h"

/* Sum of the absolute values of the terms of x, as if products of sums were multiplied out: |a|*(|x| + |z|) for a*(x - z). Denominators,
 * roots and functions count as single terms; definitions are expanded. */
Expr term_magnitude(ExprGraph *g, Expr x);

#endif
