/* Elimination within a band: G.H. Golub, C.F. Van Loan, Matrix Computations, 4th ed. (2013), algorithms 3.4.1 and 4.3.1.
 * Multipliers are not exchanged with later rows: lag_band_matrix_solve repeats the exchanges one by one. */
#include "methods/band_matrix.h"

#include <math.h>

#include "numeric/dense.h"

static int least(int a, int b) { return a < b ? a : b; }

/* scale[n] := largest entry of each row. -1: a row is zero or not finite. */
static int row_scales(const lag_band_matrix *m, double *scale) {
  for (int i = 0; i < m->n; i++) {
    double largest = 0;
    for (int j = i > m->band ? i - m->band : 0; j <= least(i + m->band, m->n - 1); j++) {
      double x = fabs(*lag_band_matrix_at(m, i, j));
      largest = x > largest || isnan(x) ? x : largest;
    }
    if (!(largest > 0 && isfinite(largest))) return -1;
    scale[i] = largest;
  }
  return 0;
}

int lag_band_matrix_factor(lag_band_matrix *m, double *scale) {
  int n = m->n;
  if (row_scales(m, scale)) return -1;
  for (int k = 0; k < n; k++) {
    int below = least(k + m->band, n - 1), right = least(k + 2 * m->band, n - 1), p = k;
    double best = fabs(*lag_band_matrix_at(m, k, k)) / scale[k];
    for (int i = k + 1; i <= below; i++) {
      double x = fabs(*lag_band_matrix_at(m, i, k)) / scale[i];
      if (x > best) {
        best = x;
        p = i;
      }
    }
    if (!(best > 0)) return -1;
    m->pivot[k] = (double)p;
    if (p != k) {
      lag_swap(&scale[k], &scale[p]);
      for (int j = k; j <= right; j++) lag_swap(lag_band_matrix_at(m, k, j), lag_band_matrix_at(m, p, j));
    }
    const double *u = lag_band_matrix_at(m, k, k);
    for (int i = k + 1; i <= below; i++) {
      double *r = lag_band_matrix_at(m, i, k), f = r[0] / u[0];
      r[0] = f;
      for (int j = 1; f != 0.0 && j <= right - k; j++) r[j] -= f * u[j];
    }
  }
  return 0;
}

void lag_band_matrix_solve(const lag_band_matrix *m, double *b) {
  int n = m->n;
  for (int k = 0; k < n; k++) {
    lag_swap(&b[k], &b[(int)m->pivot[k]]);
    for (int i = k + 1; i <= least(k + m->band, n - 1); i++) b[i] -= *lag_band_matrix_at(m, i, k) * b[k];
  }
  for (int k = n - 1; k >= 0; k--) {
    const double *u = lag_band_matrix_at(m, k, k);
    for (int j = 1; j <= least(2 * m->band, n - 1 - k); j++) b[k] -= u[j] * b[k + j];
    b[k] /= u[0];
  }
}
