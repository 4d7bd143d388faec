/* Predictor by backward differences. The difference of order j + 1 is the error of a polynomial of degree j: E.
 * Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), III.1; as start values
 * for implicit methods: Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), VIII.6.1. */
#include "methods/predictor.h"

#include <math.h>
#include <string.h>

#include "lag.h"

enum { DEGREE = 7 }; /* the guess has up to 2^DEGREE times the rounding of the values */

/* Number of known differences, degree to use, x[m] differences of each order 0 .. DEGREE + 1. */
typedef struct Predictor {
  double known, degree;
  double x[];
} Predictor;

size_t lag_predictor_size(int m) { return sizeof(Predictor) / sizeof(double) + (size_t)(DEGREE + 2) * (size_t)m; }

int lag_predictor_guess(const double *history, int m, double *x) {
  const Predictor *h = (const void *)history;
  if (h->known == 0.0) return 0;
  memcpy(x, h->x, (size_t)m * sizeof *x);
  for (int j = 1; j <= (int)h->degree; j++)
    for (int i = 0; i < m; i++) x[i] += h->x[j * m + i];
  return 1;
}

void lag_predictor_last(const double *history, int m, double *x) {
  memcpy(x, ((const Predictor *)(const void *)history)->x, (size_t)m * sizeof *x);
}

/* The largest difference of order j, relative to the size of each component. */
static double largest_difference(const Predictor *h, int m, int j) {
  double size = 0;
  for (int i = 0; i < m; i++) {
    double d = fabs(h->x[j * m + i]), scale = fabs(h->x[i]) + fabs(h->x[m + i]);
    size = fmax(size, d > 0 ? d / scale : 0);
  }
  return size;
}

void lag_predictor_add(double *history, int m, const double *x) {
  Predictor *h = (void *)history;
  int known = (int)h->known;
  double best = HUGE_VAL;
  for (int i = 0; i < m; i++) {
    double fresh = x[i];
    for (int j = 0; j < known; j++) {
      double old = h->x[j * m + i];
      h->x[j * m + i] = fresh;
      fresh -= old;
    }
    if (known < DEGREE + 2) h->x[known * m + i] = fresh;
  }
  h->known = known < DEGREE + 2 ? known + 1 : known;
  h->degree = 0;
  for (int j = 1; j < (int)h->known; j++) {
    double size = largest_difference(h, m, j);
    if (size < best) {
      best = size;
      h->degree = j - 1;
    }
  }
}
