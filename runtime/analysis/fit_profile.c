/* Profiles of likelihood: intervals of values that need not be symmetric. Enters: a fit; leaves: for each target the
 * values between which the sum of squares, least over all other targets, stays below its least plus a quantile. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/fit.h"
#include "analysis/fit_residuals.h"

/* The quantile t with P(|T| > t) = 5 % of Student's distribution; of the normal one where errors are known. */
static double quantile(const Fit *f) {
  double low = 1.9, high = 20;
  if (f->known_errors || !(f->freedom > 0)) return 1.959963984540054;
  for (int i = 0; i < 60; i++) {
    double middle = (low + high) / 2;
    *(f->by->chance_of_f(middle * middle, 1, f->freedom) > 0.05 ? &low : &high) = middle;
  }
  return low;
}

/* sqrt of the growth of the sum of squares, in units of the variance, with target j at coordinate `at`; x: the
 * others, which are carried along. NaN: no search ends there. */
static double growth(Fit *f, int j, double at, double variance, double best, double *x) {
  double chi_squared;
  f->held = j + 1;
  f->held_at = x[j] = at;
  int rc = lag_fit_search(f, x);
  f->held = 0;
  rc = rc ? rc : lag_fit_squares(f, x, &chi_squared);
  return rc ? NAN : sqrt(fmax(chi_squared - best, 0) / variance);
}

/* The value on one side of target j at which the growth is q: by rule of three from 0, which is exact
 * for a parabola; infinite where it stays below. */
static double end_of(Fit *f, int j, double step, double q, double variance, const double *fitted, double *x) {
  const double farthest = 5, close = 1e-3;
  enum { TRIES = 12 };
  double best, d = step, root = 0, slope;
  memcpy(x, fitted, (size_t)f->n * sizeof *x);
  if (lag_fit_squares(f, fitted, &best)) return NAN;
  for (int i = 0; i < TRIES && fabs(d) < farthest; i++) {
    root = growth(f, j, fitted[j] + d, variance, best, x);
    if (isnan(root)) return NAN;
    if (fabs(root / q - 1) < close) return lag_fit_value_at(&f->target[j], fitted[j] + d, &slope);
    d *= root > 0 ? fmin(fmax(q / root, 0.2), 3) : 3;
  }
  return root < q ? copysign(HUGE_VAL, step) : NAN;
}

/* Coordinates fall with values that are declared negative. */
static void profile_target(Fit *f, int j, double q, double variance, const double *fitted, double *x) {
  FitTarget *t = &f->target[j];
  double step = q * (abs(t->sign) == 1 ? t->error / fabs(t->value) : t->error / t->scale);
  int falls = t->sign < 0;
  double below = end_of(f, j, -step, q, variance, fitted, x), above = end_of(f, j, step, q, variance, fitted, x);
  t->low = falls ? (isinf(above) ? -HUGE_VAL : above) : isinf(below) && abs(t->sign) ? 0 : below;
  t->high = falls ? (isinf(below) ? 0 : below) : above;
}

int lag_fit_profile(Fit *f) {
  size_t n = (size_t)f->n;
  double *fitted = calloc(2 * n, sizeof *fitted), *value = calloc(n, sizeof *value), q = quantile(f);
  int converged = f->converged, steps = f->steps;
  double variance = f->known_errors || !(f->freedom > 0) ? 1 : f->chi_squared / f->freedom;
  if (!fitted || !value) return free(fitted), free(value), LAG_ENOMEM;
  for (int j = 0; j < f->n; j++) value[j] = f->target[j].value;
  for (int j = 0; j < f->n; j++) fitted[j] = lag_fit_coordinate(&f->target[j], value[j]);
  for (int j = 0; j < f->n; j++) {
    if (f->target[j].flat || !(f->target[j].error > 0)) continue;
    profile_target(f, j, q, variance, fitted, fitted + n);
    for (int k = 0; k < f->n; k++) f->target[k].value = value[k];
  }
  double same;
  f->held = 0;
  int rc = lag_fit_squares(f, fitted, &same); /* the fitted motion again */
  for (int k = 0; k < f->n; k++) f->target[k].value = value[k];
  f->converged = converged, f->steps = steps;
  free(fitted);
  free(value);
  return rc;
}
