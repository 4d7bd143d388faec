/* Error of a run by a second run (error_estimate.h), as in step doubling: E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I
 * (1993), DOI 10.1007/978-3-540-78862-1, II.4, but for the whole motion. Neighbouring motions of chaos part exponentially, those of regular
 * motion in proportion to time; a method adds to it once or twice more: hence the laws of growth. */
#include "analysis/error_estimate.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

/* The error at which no digit of a value is left. */
static const double no_digit = 0.3;

int lag_error_estimate_init(ErrorEstimate *e, const lag_sim *sim) {
  const lag_model *m = lag_sim_scene(sim)->model;
  *e = (ErrorEstimate){.stride = 1, .largest = NAN, .horizon = NAN, .t0 = lag_sim_time(sim)};
  int rc = lag_samples_init(&e->motion, LAG_ERROR_PLACES, 2 * m->nq + m->nz);
  e->motion.rows = 0;
  return rc;
}

void lag_error_estimate_free(ErrorEstimate *e) { lag_samples_free(&e->motion); }

/* Keeps every second row. */
static void halve(ErrorEstimate *e) {
  Samples *s = &e->motion;
  size_t n = (size_t)s->n;
  for (int i = 1; 2 * i - 1 < s->rows; i++) {
    s->t[i - 1] = s->t[2 * i - 1];
    memcpy(s->y + (size_t)(i - 1) * n, s->y + (size_t)(2 * i - 1) * n, n * sizeof(double));
  }
  s->rows /= 2;
  e->stride *= 2;
}

void lag_error_estimate_note(ErrorEstimate *e, const lag_sim *sim) {
  Samples *s = &e->motion;
  int at_event = sim->run->events != e->events;
  e->events = sim->run->events;
  if (at_event || ++e->seen % e->stride) return;
  if (s->rows == LAG_ERROR_PLACES) halve(e);
  if (e->seen % e->stride) return;
  s->t[s->rows] = lag_sim_time(sim);
  memcpy(s->y + (size_t)s->rows++ * (size_t)s->n, sim->now, (size_t)s->n * sizeof(double));
}

/* ---- The law of growth */

/* Least squares of y = a + b x over n points: *b, and the root of the mean square of the rest. */
static double fit(int n, const double *x, const double *y, double *b) {
  double mx = 0, my = 0, xx = 0, xy = 0, rest = 0;
  for (int i = 0; i < n; i++) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  for (int i = 0; i < n; i++) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
  }
  *b = xx > 0 ? xy / xx : 0;
  for (int i = 0; i < n; i++) {
    double d = y[i] - my - *b * (x[i] - mx);
    rest += d * d / n;
  }
  return sqrt(rest);
}

/* The law from the envelope of errors below the horizon: log E against t, or against log t. *power: exponent of t. */
static void find_growth(ErrorEstimate *e, double *power) {
  enum { FEWEST = 8 };
  double x[LAG_ERROR_PLACES], lx[LAG_ERROR_PLACES], y[LAG_ERROR_PLACES], peak = 0, rate;
  int n = 0;
  *power = 0;
  for (int i = 0; i < e->compared && !(e->error[i] >= no_digit); i++) {
    peak = fmax(peak, e->error[i]);
    if (i < e->compared / 8 || !(peak > 0)) continue; /* the first steps show rounding, not growth */
    x[n] = fabs(e->motion.t[i] - e->t0);
    lx[n] = log(x[n]);
    y[n++] = log(peak);
  }
  if (n < FEWEST || e->largest < 500 * DBL_EPSILON) return; /* rounding has no law */
  double by_power = fit(n, lx, y, power), by_rate = fit(n, x, y, &rate);
  double grown = y[n - 1] - y[0];
  if (by_rate < 0.7 * by_power && rate * (x[n - 1] - x[0]) > 6 && grown > 6) {
    e->growth = LAG_ERROR_EXPONENTIAL;
    e->rate = rate;
  } else {
    e->growth = *power < 0.4 ? LAG_ERROR_BOUNDED : *power < 1.5 ? LAG_ERROR_LINEAR : LAG_ERROR_QUADRATIC;
  }
}

/* Extends the errors from the last compared time to the end of the run by their law. */
static void extrapolate(ErrorEstimate *e, double until, double power) {
  double t = fabs(e->motion.t[e->compared - 1] - e->t0), rest = fabs(until - e->t0) - t, dir = until < e->t0 ? -1 : 1;
  if (e->growth == LAG_ERROR_EXPONENTIAL) {
    double reach = log(no_digit / e->largest) / e->rate;
    if (reach < rest) e->horizon = e->t0 + dir * (t + reach);
    e->largest *= exp(e->rate * fmin(rest, reach));
  } else if (e->growth != LAG_ERROR_UNKNOWN && power > 0.4) {
    double reach = t * (pow(no_digit / e->largest, 1 / power) - 1);
    if (reach < rest) e->horizon = e->t0 + dir * (t + reach);
    e->largest *= pow((t + fmin(rest, reach)) / t, power);
  }
}

/* ---- The comparison */

/* The largest relative difference of row i. */
static double row_error(const ErrorEstimate *e, int i, const double *other, const double *scale) {
  const double *y = e->motion.y + (size_t)i * (size_t)e->motion.n;
  double most = 0;
  for (int k = 0; k < e->motion.n; k++) {
    double d = fabs(y[k] - other[k]) / scale[k];
    most = d <= HUGE_VAL ? fmax(most, d) : HUGE_VAL;
  }
  return most;
}

/* Compares rows until a limit: the end, the horizon, `most` steps, or a failure. */
static int compare_rows(ErrorEstimate *e, lag_sim *other, const double *scale, long long most) {
  lag_stats st = {0};
  for (e->compared = 0; e->compared < e->motion.rows && (most == 0 || st.steps < most);) {
    int i = e->compared, rc = lag_sim_advance(other, e->motion.t[i]);
    if (rc) {
      if (rc < 0) snprintf(e->why, sizeof e->why, "%s", lag_sim_message(other));
      return rc;
    }
    e->error[i] = row_error(e, i, other->now, scale);
    e->compared++;
    e->largest = fmax(e->largest, e->error[i]);
    if (e->error[i] >= no_digit) {
      e->horizon = e->motion.t[i];
      return LAG_OK;
    }
    lag_sim_stats(other, &st);
  }
  return LAG_OK;
}

int lag_error_estimate_compare(ErrorEstimate *e, lag_sim *other, long long most, double until) {
  double *scale = calloc((size_t)e->motion.n + 1, sizeof *scale), power;
  if (!scale) return LAG_ENOMEM;
  lag_cost_scales(&e->motion, other, scale);
  int rc = compare_rows(e, other, scale, most);
  free(scale);
  if (rc == LAG_ENOMEM || e->compared == 0) return rc == LAG_ENOMEM ? rc : LAG_OK;
  find_growth(e, &power);
  if (isnan(e->horizon) && e->compared < e->motion.rows) extrapolate(e, until, power);
  return LAG_OK;
}
