/* Linear systems with a band matrix, or a full one: L U with partial pivoting. */
#pragma once

/* An n x n matrix that is zero where |row - column| > band; band = n - 1 is a full matrix. */
typedef struct lag_band_matrix {
  int n, band;
  double *a;     /* [lag_band_matrix_size] row-major, with room for the fill-in of pivoting */
  double *pivot; /* [n] row exchanged with row k at step k */
} lag_band_matrix;

/* Stored columns of a row: with exchanged rows U reaches 2 band to the right of the diagonal. */
static inline int lag_band_matrix_width(int n, int band) { return 3 * band + 1 < n ? 3 * band + 1 : n; }

/* Doubles of lag_band_matrix.a. */
static inline int lag_band_matrix_size(int n, int band) { return n * lag_band_matrix_width(n, band); }

/* Address of entry (i, j); entries of a row within the band are contiguous. */
static inline double *lag_band_matrix_at(const lag_band_matrix *m, int i, int j) {
  int w = lag_band_matrix_width(m->n, m->band), first = i - m->band;
  first = first > m->n - w ? m->n - w : first;
  return m->a + i * w + j - (first > 0 ? first : 0);
}

/* Factors m in place, m = L U with partial pivoting; rows are compared relative to their largest entries, so that units of the
 * equations do not matter. scale[n] is scratch. 0, or -1: the matrix is singular or not finite. */
int lag_band_matrix_factor(lag_band_matrix *m, double *scale);

/* b[n] := m^-1 b. m is factored by lag_band_matrix_factor. */
void lag_band_matrix_solve(const lag_band_matrix *m, double *b);
