/* Exact solution of linear systems of rationals. */
#ifndef LAGC_BASE_RATIONAL_SOLVE_H
#define LAGC_BASE_RATIONAL_SOLVE_H

#include "base/arena.h"
#include "base/num.h"

/* Solves A X = B for A[n*n], B[n*columns], X[n*columns], all row-major; X may be B. Scratch memory comes from `a`. Numbers of X with a numerator or
 * denominator above 2^61 are doubles with error bounds and residues. Returns 0, with X untouched, where A is singular or an input is not exact. A
 * wrong result passes with probability 1 in 4e18, as in num.h. */
int rational_solve(Arena *a, uint32_t n, const Num *A, uint32_t columns, const Num *B, Num *X);

#endif
