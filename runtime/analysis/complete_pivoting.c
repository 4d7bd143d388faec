/* Gaussian elimination with complete pivoting, with an error estimate of each right-hand side. */
#include "analysis/complete_pivoting.h"

#include <float.h>
#include <math.h>

/* Reciprocal of the largest size in row i. */
static double factor_of(int n, const double *size, int i)
{
  double most = 0;

  for (int j = 0; j < n; j++) {
    most = fmax(most, size[i * n + j]);
  }
  return most > 0 && isfinite(most) ? 1 / most : 1;
}

static void swap(double *a, double *b)
{
  double x = *a;
  *a = *b;
  *b = x;
}

/* Brings the largest element of the remaining A to (k, k), by swaps. Returns its size. */
static double complete_pivot(int n, int k, double *A, double *b, double *noise, double *column)
{
  int row = k, col = k;

  for (int i = k; i < n; i++) {
    for (int j = k; j < n; j++) {
      if (fabs(A[i * n + j]) > fabs(A[row * n + col])) {
        row = i;
        col = j;
      }
    }
  }
  for (int j = 0; j < n && row != k; j++) {
    swap(&A[k * n + j], &A[row * n + j]);
  }
  swap(&b[k], &b[row]);
  swap(&noise[k], &noise[row]);
  for (int i = 0; i < n && col != k; i++) {
    swap(&A[i * n + k], &A[i * n + col]);
  }
  swap(&column[k], &column[col]);
  return fabs(A[k * n + k]);
}

/* Eliminates column k below row k. Errors add as if independent. */
static void eliminate(int n, int k, double *A, double *b, double *noise)
{
  for (int i = k + 1; i < n; i++) {
    double factor = A[i * n + k] / A[k * n + k];
    if (factor == 0.0) {
      continue;
    }
    for (int j = k; j < n; j++) {
      A[i * n + j] -= factor * A[k * n + j];
    }
    b[i] -= factor * b[k];
    noise[i] = hypot(hypot(noise[i], factor * noise[k]), DBL_EPSILON * factor * b[k]);
  }
}

int lag_complete_pivot_solve(int n, double *A, const double *size, double *b, double *noise, double *x, double *column)
{
  int rank = 0;

  for (int i = 0; i < n; i++) {
    double factor = factor_of(n, size, i);
    for (int j = 0; j < n; j++) {
      A[i * n + j] *= factor;
    }
    b[i] *= factor;
    noise[i] *= factor;
    column[i] = i;
    x[i] = 0;
  }
  while (rank < n && complete_pivot(n, rank, A, b, noise, column) > 8 * n * DBL_EPSILON) {
    eliminate(n, rank, A, b, noise);
    rank++;
  }
  for (int k = rank; k-- > 0;) {
    double sum = b[k];
    for (int j = k + 1; j < rank; j++) {
      sum -= A[k * n + j] * x[(int)column[j]];
    }
    x[(int)column[k]] = sum / A[k * n + k];
  }
  return rank;
}
