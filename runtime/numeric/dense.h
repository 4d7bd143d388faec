/* Small dense vectors; Gaussian elimination of small dense matrices, row-major. */
#pragma once

#include <math.h>
#include <stddef.h>

/* Products of vectors [n]; the largest |x[i]|, 0 for none. */
static inline double lag_dot(int n, const double *x, const double *y) {
  double sum = 0;
  for (int i = 0; i < n; i++) sum += x[i] * y[i];
  return sum;
}
static inline double lag_largest(int n, const double *x) {
  double most = 0;
  for (int i = 0; i < n; i++) most = fmax(most, fabs(x[i]));
  return most;
}
/* Product of columns i and j of A[rows * cols]. */
static inline double lag_columns_dot(int rows, int cols, const double *A, int i, int j) {
  double sum = 0;
  for (int r = 0; r < rows; r++) sum += A[r * cols + i] * A[r * cols + j];
  return sum;
}
/* C[n m] := A B with A[n k] and B[k m], or A' B with A[k n]. */
void lag_multiply(int n, int k, int m, const double *A, const double *B, double *C);
void lag_multiply_transposed(int n, int k, int m, const double *A, const double *B, double *C);
/* -1, 0 or 1 */
static inline double lag_sign(double x) { return (x > 0) - (x < 0); }

static inline void lag_swap(double *a, double *b) {
  double x = *a;
  *a = *b;
  *b = x;
}

/* Swaps rows i and k of A[. * n], or columns i and k of A[rows * n]. */
void lag_swap_rows(size_t n, double *A, size_t i, size_t k);
void lag_swap_columns(size_t rows, size_t n, double *A, size_t i, size_t k);

/* Complete pivoting: brings the largest element of rows and columns >= k of A[n * n] to (k, k), by swaps with row
 * *row and column *col. Returns its size. */
double lag_complete_pivot(int n, int k, double *A, int *row, int *col);

/* Subtracts the multiple of row k of A[n * n] that makes element (i, k) zero from row i; returns the multiple. */
double lag_eliminate_row(int n, double *A, int k, int i);

/* Elimination with partial pivoting (Golub & Van Loan, Matrix Computations, 4th ed., section 3.4): A[n * n] becomes
 * upper triangular, and its steps are applied to B[n * m], too. -1: no pivot. */
int lag_eliminate(size_t n, size_t m, double *A, double *B);

/* B[n * m] := A^-1 B; A[n * n] is destroyed. -1: A is singular. */
int lag_solve_dense(size_t n, size_t m, double *A, double *B);

/* x[n] := A^-1 x by Gauss-Jordan elimination of A[n * n] with complete pivoting, for pivots above `least`; x of the
 * remaining equations holds their residuals. pivot[n] := column of the pivot of each row, -1: none. */
void lag_gauss_jordan(int n, double *A, double *x, double *pivot, double least);
