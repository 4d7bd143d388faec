/* Small dense linear systems in long double: ranks, kernels and bases that the compiler decides numerically. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"

/* Solves a x = b for a[n*n], row-major, as sparse_solve does. */
uint32_t dense_solve(Arena *arena, uint32_t n, const long double *a, long double *b, long double tolerance,
                     long double *null);

/* Largest absolute value of x[n]; 0 for none. */
long double dense_largest(const long double *x, size_t n);

/* Solves m x = b for each row b of rows[count*n], in place, for m[n*n]. 0: m is singular. */
int dense_solve_rows(Arena *a, uint32_t n, const long double *m, uint32_t count, long double *rows);

/* Inverts a[n*n] into inverse[n*n] by Gauss-Jordan elimination with partial pivoting. Returns 0 where a is singular. */
int dense_invert(Arena *arena, uint32_t n, const long double *a, long double *inverse);

/* Gram-Schmidt step: subtracts from row[n] its projection onto the `rank` orthonormal rows of `before`, twice
 * because of rounding, and normalises the remainder. Returns the remainder's length relative to the row, from 0 to
 * 1. Kahan's "twice is enough", in B. Parlett, The Symmetric Eigenvalue Problem (1980), 6.9, DOI
 * 10.1137/1.9781611971163. */
long double dense_gram_schmidt(uint32_t n, long double *row, const long double *before, uint32_t rank);

/* A basis, one vector a row, such as of the kernel of a matrix. */
typedef struct {
  uint32_t n, width;
  long double *at; /* [n*width] */
  long double gap; /* smallest pivot taken over largest pivot rejected: how certain the dimension is */
} DenseRows;

/* The kernel of m[rows*columns], row-major and destroyed, by Householder's QR with column pivoting (Golub & Van
 * Loan, 5.4.2). Columns are scaled to length 1; a remaining column whose length is not above `tolerance` counts as
 * zero. */
DenseRows dense_kernel(Arena *a, uint32_t rows, uint32_t columns, long double *m, long double tolerance);

/* Orthonormal basis of the rows of `from`, cut to their first `columns` columns; dependent rows are left out. */
DenseRows dense_orthonormal(Arena *a, const DenseRows *from, uint32_t columns);

/* Brings m[rows*columns] to reduced row echelon form and returns the rank; elements not above `tolerance`, and rows
 * past the rank, become 0. pivot[rows] gets the columns of the pivots. */
uint32_t dense_echelon(uint32_t rows, uint32_t columns, long double *m, long double tolerance, uint32_t *pivot);
