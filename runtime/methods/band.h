/* Linear equations whose matrix is zero far from the diagonal, or anywhere not. */
#ifndef LAG_METHODS_BAND_H
#define LAG_METHODS_BAND_H

/* A matrix of n rows with entries where |row - column| <= band; band = n - 1 is a full one. */
typedef struct lag_band {
  int n, band;
  double *a;     /* [lag_band_size] row by row, room for the rows that pivoting mixes */
  double *pivot; /* [n] */
} lag_band;

/* Columns that a row keeps: pivoting exchanges rows, which then reach twice the band to the right. */
static inline int lag_band_width(int n, int band)
{
  return 3 * band + 1 < n ? 3 * band + 1 : n;
}

/* Doubles of a. */
static inline int lag_band_size(int n, int band)
{
  return n * lag_band_width(n, band);
}

/* The place of entry (i, j); those of a row within the band are side by side. */
static inline double *lag_band_at(const lag_band *m, int i, int j)
{
  int w = lag_band_width(m->n, m->band), first = i - m->band;

  first = first > m->n - w ? m->n - w : first;
  return m->a + i * w + j - (first > 0 ? first : 0);
}

/* L U with partial pivoting; rows are compared after scaling by their largest entries, so that the units of the equations
 * do not matter. scale[n] is scratch. 0, or -1 when the matrix is singular or not finite. */
int lag_band_factor(lag_band *m, double *scale);

/* b := the solution. Needs lag_band_factor. */
void lag_band_solve(const lag_band *m, double *b);

#endif
