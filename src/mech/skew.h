/* Linear systems with an antisymmetric matrix, solved on the graph: what a two-form makes of a gradient. */
#ifndef LAGC_SKEW_H
#define LAGC_SKEW_H

#include "sym/expr.h"

enum { SKEW_MOST = 10 }; /* unknowns that are left when no pivot is known to be other than zero */

/* A x = b, A[n*n] antisymmetric, row-major, b[n]; both are destroyed. Pairs of unknowns whose entry cannot vanish (a number, a product of
 * parameters with a sign) are eliminated; the rest is solved by Pfaffians, which divide by nothing but their own, *divisor (0: a number, or
 * nothing is left): it is 0 exactly where A is singular; it is called `name` where it is long. Returns 1; 0 when more than SKEW_MOST are left, whose numbers are then
 * left[*nleft], or none of them has an entry.
 * Elimination: J. R. Bunch, Math. Comp. 38 (1982) 475, DOI 10.1090/S0025-5718-1982-0645664-6; inverse by Pfaffians: D. E. Knuth,
 * Electron. J. Combin. 3 (1996) R5, DOI 10.37236/1263. */
int skew_solve(ExprGraph *g, uint32_t n, Expr *A, Expr *b, Name name, Expr *x, Expr *divisor, uint32_t *left, uint32_t *nleft);

#endif
