/* predictor.h: extrapolates a vector from its values at equally spaced times, stored as backward differences. The
 * difference of order j + 1 is the error of a polynomial of degree j: E. Hairer, S.P. Norsett, G. Wanner, Solving
 * Ordinary Differential Equations I, 2nd ed. (1993), III.1; as start values for implicit methods: Hairer, Lubich,
 * Wanner, Geometric Numerical Integration, 2nd ed. (2006), VIII.6.1. Includes scalar.h. */
#ifndef LAG_PREDICTOR_H
#define LAG_PREDICTOR_H

#include "kernels/scalar.h"

/* ---- predictor ---- */

enum { LAG_PREDICTOR_DEGREE = 7 }; /* a guess has up to 2^7 times the rounding of the values */

/* Scalars of the history of a vector of m elements: number of known differences, degree to use, differences of each
 * order. All zeros: an empty history. */
#define LAG_PREDICTOR_SIZE(m) (2 + (LAG_PREDICTOR_DEGREE + 2)*(m))

/* x := the extrapolated next value, by the degree that would have been best last time. 0: the history is empty. */
static inline int lag_predictor_guess(const LAG_REAL *history, int m, LAG_REAL *x) {
  const LAG_REAL *const d = history + 2;
  if (!(history[0] > LAG_C(0.0))) return 0;
  for (int i = 0; i < m; i++) x[i] = d[i];
  for (int j = 1; j <= (int)history[1]; j++)
    for (int i = 0; i < m; i++) x[i] += d[j*m + i];
  return 1;
}

/* x := the last value. */
static inline void lag_predictor_last(const LAG_REAL *history, int m, LAG_REAL *x) {
  for (int i = 0; i < m; i++) x[i] = history[2 + i];
}

/* The largest element of a difference d, relative to the size of each component. */
static inline LAG_REAL lag_largest_difference(const LAG_REAL *history, int m, const LAG_REAL *d) {
  const LAG_REAL *const last = history + 2, *const before = last + m;
  LAG_REAL most = LAG_C(0.0);
  for (int i = 0; i < m; i++) {
    const LAG_REAL size = LAG_FN(fabs)(d[i]), scale = LAG_FN(fabs)(last[i]) + LAG_FN(fabs)(before[i]);
    const LAG_REAL part = size > LAG_C(0.0) ? size/scale : LAG_C(0.0);
    most = part > most ? part : most;
  }
  return most;
}

/* Appends the value x. */
static inline void lag_predictor_add(LAG_REAL *history, int m, const LAG_REAL *x) {
  LAG_REAL *const d = history + 2, best = -LAG_C(1.0);
  int known = (int)history[0];
  for (int i = 0; i < m; i++) {
    LAG_REAL fresh = x[i];
    for (int j = 0; j < known; j++) {
      const LAG_REAL old = d[j*m + i];
      d[j*m + i] = fresh;
      fresh -= old;
    }
    if (known < LAG_PREDICTOR_DEGREE + 2) d[known*m + i] = fresh;
  }
  if (known < LAG_PREDICTOR_DEGREE + 2) known++;
  history[0] = (LAG_REAL)known;
  history[1] = LAG_C(0.0);
  for (int j = 1; j < known; j++) {
    const LAG_REAL size = lag_largest_difference(history, m, d + j*m);
    if (best >= LAG_C(0.0) && !(size < best)) continue;
    best = size;
    history[1] = (LAG_REAL)(j - 1);
  }
}

/* ---- end ---- */
#endif
