/* Predictor by backward differences. The difference of order j + 1 is the error of a polynomial of degree j: E. Hairer, S.P. Norsett, G. Wanner,
 * Solving Ordinary Differential Equations I, 2nd ed. (1993), III.1; as start values for implicit methods: Hairer, Lubich, Wanner, Geometric
 * Numerical Integration, 2nd ed. (2006), VIII.6.1. */
#include "methods/history.h"

#include <math.h>
#include <string.h>

#include "lag.h"

enum { DEGREE = 7 }; /* the guess has up to 2^DEGREE times the rounding of the values */

/* Number of known differences, degree to use, x[m] differences of each order 0 .. DEGREE + 1. */
typedef struct History {
  double known, degree;
  double x[];
} History;

size_t lag_history_size(int m)
{
  return sizeof(History) / sizeof(double) + (size_t)(DEGREE + 2) * (size_t)m;
}

int lag_history_guess(const double *history, int m, double *x)
{
  const History *h = (const void *)history;

  if (h->known == 0.0) {
    return 0;
  }
  memcpy(x, h->x, (size_t)m * sizeof *x);
  for (int j = 1; j <= (int)h->degree; j++) {
    for (int i = 0; i < m; i++) {
      x[i] += h->x[j * m + i];
    }
  }
  return 1;
}

void lag_history_last(const double *history, int m, double *x)
{
  memcpy(x, ((const History *)(const void *)history)->x, (size_t)m * sizeof *x);
}

int lag_history_is_sound(const double *history)
{
  const History *h = (const void *)history;

  return lag_is_count(h->known, DEGREE + 2) && lag_is_count(h->degree, DEGREE);
}

/* The largest difference of order j, relative to the size of each component. */
static double missed(const History *h, int m, int j)
{
  double size = 0;

  for (int i = 0; i < m; i++) {
    double d = fabs(h->x[j * m + i]), scale = fabs(h->x[i]) + fabs(h->x[m + i]);
    size = fmax(size, d > 0 ? d / scale : 0);
  }
  return size;
}

void lag_history_add(double *history, int m, const double *x)
{
  History *h = (void *)history;
  int known = (int)h->known;
  double best = HUGE_VAL;

  for (int i = 0; i < m; i++) {
    double fresh = x[i];
    for (int j = 0; j < known; j++) {
      double old = h->x[j * m + i];
      h->x[j * m + i] = fresh;
      fresh -= old;
    }
    if (known < DEGREE + 2) {
      h->x[known * m + i] = fresh;
    }
  }
  h->known = known < DEGREE + 2 ? known + 1 : known;
  h->degree = 0;
  for (int j = 1; j < (int)h->known; j++) {
    double size = missed(h, m, j);
    if (size < best) {
      best = size;
      h->degree = j - 1;
    }
  }
}
