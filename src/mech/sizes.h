/* How large the terms are that make up an expression: what its rounding is compared with. */
#ifndef LAGC_SIZES_H
#define LAGC_SIZES_H

#include "sym/expr.h"

/* The sum of the sizes of the terms of x, as if products of sums were multiplied out: of a*(x - z) it is |a|*(|x| + |z|). What stands in a
 * denominator, in a root or in a function counts as one; definitions are looked into. */
Expr sizes_of_terms(ExprGraph *g, Expr x);

#endif
