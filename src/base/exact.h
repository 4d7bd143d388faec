/* Linear systems of rationals, solved exactly: numbers on the way have as many digits as they need. */
#ifndef LAGC_EXACT_H
#define LAGC_EXACT_H

#include "base/arena.h"
#include "base/num.h"

/* X[n*columns] with A X = B for A[n*n], B[n*columns], all row by row; X may be B. What 64 bits do not hold becomes a double with its residue. Memory on
 * the way comes from `a`. Returns 0, with X untouched, where A is singular, a number is not exact, or one on the way has more than 3000 bits.
 * E. H. Bareiss, Math. Comp. 22 (1968) 565, DOI 10.1090/S0025-5718-1968-0226829-0. */
int exact_solve(Arena *a, uint32_t n, const Num *A, uint32_t columns, const Num *B, Num *X);

#endif
