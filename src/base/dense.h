/* Small dense systems in extended precision, for what is decided by value. */
#ifndef LAGC_DENSE_H
#define LAGC_DENSE_H

#include <stdint.h>

#include "base/arena.h"

/* sparse_solve of a[n*n], row-major. */
uint32_t dense_solve(Arena *arena, uint32_t n, const long double *a, long double *b, long double rest, long double *null);

/* The inverse of a[n*n] into inverse[n*n], by Gauss-Jordan elimination with row exchange; a is destroyed. 0: it is singular. */
int dense_invert(uint32_t n, long double *a, long double *inverse);

/* row[n] less its parts along the `rank` orthonormal rows of `before`, taken off twice so that rounding does not count, and scaled to 1
 * where something is left. Returns how much of it was left, from 0 to 1. Kahan's "twice is enough", in B. Parlett, The Symmetric
 * Eigenvalue Problem (1980), 6.9, DOI 10.1137/1.9781611971163. */
long double dense_reduce(uint32_t n, long double *row, const long double *before, uint32_t rank);

/* A basis of rows, of the kernel of a matrix say. */
typedef struct {
  uint32_t n, width;
  long double *at; /* [n*width] */
  long double gap; /* the smallest pivot that was taken over the largest that was left: how sure the dimension is */
} DenseRows;

/* The kernel of a[rows*columns], row-major and destroyed. Columns are scaled to length 1; what is left of one and not above `rest` counts as
 * zero. Householder's reflections with exchanged columns: Golub & Van Loan, 5.4.2. */
DenseRows dense_kernel(Arena *a, uint32_t rows, uint32_t columns, long double *m, long double rest);

/* Orthonormal rows that span the first `columns` columns of `from`; dependent ones are left out. */
DenseRows dense_orthonormal(Arena *a, const DenseRows *from, uint32_t columns);

/* Brings the rows to reduced echelon form, pivots from the left; elements not above `rest` are zero, and so are all rows past the rank.
 * pivot[rows] gets the columns of the pivots. Returns the rank. */
uint32_t dense_echelon(uint32_t rows, uint32_t columns, long double *m, long double rest, uint32_t *pivot);

#endif
