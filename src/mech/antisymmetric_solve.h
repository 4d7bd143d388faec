/* Linear systems with an antisymmetric matrix (a two-form), solved on the graph. */
#pragma once

#include "sym/expr.h"

enum { ANTISYMMETRIC_MOST = 10 }; /* most unknowns left for Pfaffians when no further pivot is known to be nonzero */

typedef struct {
  Expr *x; /* [n] */
  Expr divisor;
  uint32_t *left, nleft;
} SkewSolution;

/* Solves A x = b for x[n], A[n*n] antisymmetric, row-major, b[n]; A and b are destroyed. Pairs of
 * unknowns whose entry cannot vanish (a number, a product of parameters with a sign) are
 * eliminated; the rest is solved by Pfaffians, with one divisor. The divisor is 0 exactly where A
 * is singular, a definition called `name` where it is long, and the null Expr where it cannot
 * vanish or nothing is left. Returns 1; 0 when more than ANTISYMMETRIC_MOST unknowns, or an odd
 * number, are left: left[nleft]. Elimination: J. R. Bunch, Math. Comp. 38 (1982) 475, DOI
 * 10.1090/S0025-5718-1982-0645664-6; inverse by Pfaffians: D. E. Knuth, Electron. J. Combin. 3
 * (1996) R5, DOI 10.37236/1263. */
int antisymmetric_solve(ExprGraph *g, uint32_t n, Expr *A, Expr *b, Name name, SkewSolution *to);
