/* Small dense systems in extended precision, for what is decided by value. */
#ifndef LAGC_DENSE_H
#define LAGC_DENSE_H

#include <stdint.h>

/* Elimination with full pivoting of a[n*n] x = b[n], a row-major and destroyed; b becomes x (NULL: only the rank is wanted). What is
 * left at the end and not above `rest` times the largest element counts as zero; unknowns that nothing determines are 0 then.
 * column[n] is scratch. Returns the rank. Below n, null[n] (or NULL) spans a direction of the kernel.
 * Golub & Van Loan, Matrix Computations, 4th ed. (2013), 3.4.8. */
uint32_t dense_solve(uint32_t n, long double *a, long double *b, long double rest, uint32_t *column, long double *null);

/* row[n] less its parts along the `rank` orthonormal rows of `before`, taken off twice so that rounding does not count, and scaled to 1
 * where something is left. Returns how much of it was left, from 0 to 1. Kahan's "twice is enough", in B. Parlett, The Symmetric
 * Eigenvalue Problem (1980), 6.9, DOI 10.1137/1.9781611971163. */
long double dense_reduce(uint32_t n, long double *row, const long double *before, uint32_t rank);

#endif
