/* Gaussian elimination. Enters: a matrix, right-hand sides; leaves: the solution, in their place. */
#include "numeric/dense.h"

#include <math.h>

void lag_swap_rows(size_t n, double *A, size_t i, size_t k) {
  for (size_t j = 0; j < n && i != k; j++) lag_swap(&A[i * n + j], &A[k * n + j]);
}

void lag_swap_columns(size_t rows, size_t n, double *A, size_t i, size_t k) {
  for (size_t r = 0; r < rows && i != k; r++) lag_swap(&A[r * n + i], &A[r * n + k]);
}

double lag_complete_pivot(int n, int k, double *A, int *row, int *col) {
  *row = *col = k;
  for (int i = k; i < n; i++)
    for (int j = k; j < n; j++)
      if (fabs(A[i * n + j]) > fabs(A[*row * n + *col])) {
        *row = i;
        *col = j;
      }
  lag_swap_rows((size_t)n, A, (size_t)k, (size_t)*row);
  lag_swap_columns((size_t)n, (size_t)n, A, (size_t)k, (size_t)*col);
  return fabs(A[k * n + k]);
}

double lag_eliminate_row(int n, double *A, int k, int i) {
  double factor = A[i * n + k] / A[k * n + k];
  for (int j = k; j < n && factor != 0.0; j++) A[i * n + j] -= factor * A[k * n + j];
  return factor;
}

/* a[n] -= factor b[n]. */
static void subtract(size_t n, double *a, double factor, const double *b) {
  for (size_t j = 0; j < n && factor != 0.0; j++) a[j] -= factor * b[j];
}

int lag_eliminate(size_t n, size_t m, double *A, double *B) {
  for (size_t c = 0; c < n; c++) {
    size_t best = c;
    for (size_t i = c + 1; i < n; i++) best = fabs(A[i * n + c]) > fabs(A[best * n + c]) ? i : best;
    if (!(fabs(A[best * n + c]) > 0)) return -1;
    lag_swap_rows(n, A, best, c);
    lag_swap_rows(m, B, best, c);
    for (size_t i = c + 1; i < n; i++) {
      double factor = A[i * n + c] / A[c * n + c];
      subtract(n - c - 1, A + i * n + c + 1, factor, A + c * n + c + 1);
      subtract(m, B + i * m, factor, B + c * m);
    }
  }
  return 0;
}

int lag_solve_dense(size_t n, size_t m, double *A, double *B) {
  if (lag_eliminate(n, m, A, B)) return -1;
  for (size_t c = n; c-- > 0;) {
    for (size_t i = c + 1; i < n; i++) subtract(m, B + c * m, A[c * n + i], B + i * m);
    for (size_t j = 0; j < m; j++) B[c * m + j] /= A[c * n + c];
  }
  return 0;
}

/* The largest element of rows without pivot, above `least`; 0: none. */
static int largest_element(int n, const double *A, const double *pivot, double least, int *row, int *col) {
  *row = -1;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n && pivot[i] < 0; j++)
      if (fabs(A[i * n + j]) > least) {
        least = fabs(A[i * n + j]);
        *row = i;
        *col = j;
      }
  return *row >= 0;
}

void lag_gauss_jordan(int n, double *A, double *x, double *pivot, double least) {
  int row, col;
  for (int i = 0; i < n; i++) pivot[i] = -1;
  for (int turn = 0; turn < n && largest_element(n, A, pivot, least, &row, &col); turn++) {
    pivot[row] = col;
    for (int i = 0; i < n; i++) {
      double factor = i == row ? 0 : A[i * n + col] / A[row * n + col];
      for (int j = 0; j < n && factor != 0.0; j++) A[i * n + j] = j == col ? 0 : A[i * n + j] - factor * A[row * n + j];
      x[i] -= factor * x[row];
    }
  }
  for (int i = 0; i < n; i++) { /* each row has its pivot left, and columns without pivot, whose unknowns are 0 */
    x[i] = pivot[i] < 0 ? x[i] : x[i] / A[i * n + (int)pivot[i]];
  }
}

/* C[n m] := A B, whose elements of A in row i are `right` apart, and rows `down`. */
static void multiply(int n, int k, int m, const double *A, int down, int right, const double *B, double *C) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++) {
      double sum = 0;
      for (int l = 0; l < k; l++) sum += A[i * down + l * right] * B[l * m + j];
      C[i * m + j] = sum;
    }
}

void lag_multiply(int n, int k, int m, const double *A, const double *B, double *C) {
  multiply(n, k, m, A, k, 1, B, C);
}

void lag_multiply_transposed(int n, int k, int m, const double *A, const double *B, double *C) {
  multiply(n, k, m, A, 1, n, B, C);
}
