/* Exact solution of linear systems of rationals; intermediate integers have as many digits as they need. */
#ifndef LAGC_BASE_RATIONAL_SOLVE_H
#define LAGC_BASE_RATIONAL_SOLVE_H

#include "base/arena.h"
#include "base/num.h"

/* Solves A X = B for A[n*n], B[n*columns], X[n*columns], all row-major; X may be B. Results beyond 64 bits become doubles with residues. Scratch
 * memory comes from `a`. Returns 0, with X untouched, where A is singular, an input is not exact, or an intermediate has more than 3000 bits.
 * Fraction-free elimination: E. H. Bareiss, Math. Comp. 22 (1968) 565, DOI 10.1090/S0025-5718-1968-0226829-0. */
int rational_solve(Arena *a, uint32_t n, const Num *A, uint32_t columns, const Num *B, Num *X);

#endif
