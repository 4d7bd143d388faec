/* band_matrix.h: linear systems with a band matrix, or a full one: L U with partial pivoting. Includes
 * scalar.h. Elimination within a band: G.H. Golub, C.F. Van Loan, Matrix Computations, 4th ed. (2013),
 * algorithms 3.4.1 and 4.3.1. Multipliers are not exchanged with later rows: lag_band_matrix_solve repeats
 * the exchanges one by one. lagc copies the section below into headers, with their prefix for LAG_ and
 * lag_. */
#ifndef LAG_BAND_MATRIX_H
#define LAG_BAND_MATRIX_H

#include "kernels/scalar.h"

/* ---- band_matrix ---- */

/* An n x n matrix that is zero where |row - column| > band; band = n - 1 is a full matrix. */
typedef struct lag_band_matrix {
  int n, band;
  LAG_REAL *a;     /* [lag_band_matrix_size] row-major, with room for the fill-in of pivoting */
  LAG_REAL *pivot; /* [n] row exchanged with row k at step k */
} lag_band_matrix;

/* Stored columns of a row: with exchanged rows U reaches 2 band to the right of the diagonal. */
static inline int lag_band_matrix_width(int n, int band) { return 3*band + 1 < n ? 3*band + 1 : n; }

/* Scalars of lag_band_matrix.a. */
static inline int lag_band_matrix_size(int n, int band) { return n*lag_band_matrix_width(n, band); }

/* Address of entry (i, j); entries of a row within the band are contiguous. */
static inline LAG_REAL *lag_band_matrix_at(const lag_band_matrix *m, int i, int j) {
  const int w = lag_band_matrix_width(m->n, m->band);
  int first = i - m->band;
  first = first > m->n - w ? m->n - w : first;
  return m->a + i*w + j - (first > 0 ? first : 0);
}

static inline int lag_band_least(int a, int b) { return a < b ? a : b; }

static inline void lag_band_exchange(LAG_REAL *a, LAG_REAL *b) {
  const LAG_REAL was = *a;
  *a = *b;
  *b = was;
}

/* scale[n] := largest entry of each row. -1: a row is zero or not finite. */
static inline int lag_band_matrix_scales(const lag_band_matrix *m, LAG_REAL *scale) {
  const LAG_REAL zero = LAG_C(0.0);
  for (int i = 0; i < m->n; i++) {
    LAG_REAL largest = zero;
    for (int j = i > m->band ? i - m->band : 0; j <= lag_band_least(i + m->band, m->n - 1); j++) {
      const LAG_REAL x = LAG_FN(fabs)(*lag_band_matrix_at(m, i, j));
      if (x > largest || !(x - x >= zero)) largest = x;
    }
    if (!(largest > zero && largest - largest >= zero)) return -1;
    scale[i] = largest;
  }
  return 0;
}

/* The row from k on whose entry in column k is largest; -1: there is none. */
static inline int lag_band_matrix_pivot(const lag_band_matrix *m, int k, const LAG_REAL *scale) {
  LAG_REAL best = LAG_FN(fabs)(*lag_band_matrix_at(m, k, k))/scale[k];
  int row = k;
  for (int i = k + 1; i <= lag_band_least(k + m->band, m->n - 1); i++) {
    const LAG_REAL x = LAG_FN(fabs)(*lag_band_matrix_at(m, i, k))/scale[i];
    if (x > best) best = x, row = i;
  }
  return best > LAG_C(0.0) ? row : -1;
}

/* Factors m in place, m = L U with partial pivoting; rows are compared relative to their largest entries, so
 * that units of the equations do not matter. scale[n] is scratch. 0, or -1: the matrix is singular or not
 * finite. */
static inline int lag_band_matrix_factor(lag_band_matrix *m, LAG_REAL *scale) {
  const LAG_REAL zero = LAG_C(0.0);
  if (lag_band_matrix_scales(m, scale)) return -1;
  for (int k = 0; k < m->n; k++) {
    const int right = lag_band_least(k + 2*m->band, m->n - 1), p = lag_band_matrix_pivot(m, k, scale);
    const LAG_REAL *const u = lag_band_matrix_at(m, k, k);
    if (p < 0) return -1;
    m->pivot[k] = (LAG_REAL)p;
    if (p != k) {
      lag_band_exchange(&scale[k], &scale[p]);
      for (int j = k; j <= right; j++) lag_band_exchange(lag_band_matrix_at(m, k, j), lag_band_matrix_at(m, p, j));
    }
    for (int i = k + 1; i <= lag_band_least(k + m->band, m->n - 1); i++) {
      LAG_REAL *const r = lag_band_matrix_at(m, i, k), f = r[0]/u[0];
      r[0] = f;
      for (int j = 1; !(f >= zero && f <= zero) && j <= right - k; j++) r[j] -= f*u[j];
    }
  }
  return 0;
}

/* b[n] := m^-1 b. m is factored by lag_band_matrix_factor. */
static inline void lag_band_matrix_solve(const lag_band_matrix *m, LAG_REAL *b) {
  const int n = m->n;
  for (int k = 0; k < n; k++) {
    lag_band_exchange(&b[k], &b[(int)m->pivot[k]]);
    for (int i = k + 1; i <= lag_band_least(k + m->band, n - 1); i++) b[i] -= *lag_band_matrix_at(m, i, k)*b[k];
  }
  for (int k = n - 1; k >= 0; k--) {
    const LAG_REAL *const u = lag_band_matrix_at(m, k, k);
    for (int j = 1; j <= lag_band_least(2*m->band, n - 1 - k); j++) b[k] -= u[j]*b[k + j];
    b[k] /= u[0];
  }
}

/* ---- end ---- */
#endif
