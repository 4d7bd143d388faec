/* Gaussian elimination with complete pivoting, with an error estimate of each right-hand side. */
#include "analysis/complete_pivoting.h"

#include <float.h>
#include <math.h>

#include "numeric/dense.h"

/* Reciprocal of the largest size in row i. */
static double factor_of(int n, const double *size, int i) {
  double most = 0;
  for (int j = 0; j < n; j++) most = fmax(most, size[i * n + j]);
  return most > 0 && isfinite(most) ? 1 / most : 1;
}

/* Eliminates column k below row k. Errors add as if independent. */
static void eliminate_column(int n, int k, double *A, double *b, double *noise) {
  for (int i = k + 1; i < n; i++) {
    double factor = lag_eliminate_row(n, A, k, i);
    if (factor != 0.0) {
      b[i] -= factor * b[k];
      noise[i] = hypot(hypot(noise[i], factor * noise[k]), DBL_EPSILON * factor * b[k]);
    }
  }
}

int lag_complete_pivot_solve(int n, double *A, const double *size, double *b, double *noise, double *x, double *column) {
  int rank = 0;
  for (int i = 0; i < n; i++) {
    double factor = factor_of(n, size, i);
    for (int j = 0; j < n; j++) A[i * n + j] *= factor;
    b[i] *= factor;
    noise[i] *= factor;
    column[i] = i;
    x[i] = 0;
  }
  for (int row, col; rank < n; rank++) {
    double pivot = lag_complete_pivot(n, rank, A, &row, &col);
    lag_swap(&b[rank], &b[row]);
    lag_swap(&noise[rank], &noise[row]);
    lag_swap(&column[rank], &column[col]);
    if (!(pivot > 8 * n * DBL_EPSILON)) break;
    eliminate_column(n, rank, A, b, noise);
  }
  for (int k = rank; k-- > 0;) {
    double sum = b[k];
    for (int j = k + 1; j < rank; j++) sum -= A[k * n + j] * x[(int)column[j]];
    x[(int)column[k]] = sum / A[k * n + k];
  }
  return rank;
}
