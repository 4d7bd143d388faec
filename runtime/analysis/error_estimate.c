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
#include "numeric/line_fit.h"

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

/* *t, y[n] := the middle of the last step, whose error is that of rows between steps; its end where the method steps to each row. */
static void take_place(lag_sim *sim, double *t, double *y) {
  const Run *r = sim->run;
  size_t bytes = (size_t)sim->pb.n * sizeof(double);
  double calls = sim->pb.rhs_calls; /* of the run: interpolation may take more */
  *t = 0.5 * (r->step_t0 + r->t);
  int between = !(sim->method->flags & LAG_METHOD_STEPS_TO) && lag_dense_state(sim, *t, sim->yc) == LAG_OK;
  sim->pb.rhs_calls = calls;
  if (!between) *t = r->t;
  memcpy(y, between ? sim->yc : sim->now, bytes);
}

void lag_error_estimate_note(ErrorEstimate *e, lag_sim *sim) {
  Samples *s = &e->motion;
  int at_event = sim->run->events != e->events;
  e->events = sim->run->events;
  if (at_event || ++e->seen % e->stride) return;
  if (s->rows == LAG_ERROR_PLACES) halve(e);
  if (e->seen % e->stride) return;
  take_place(sim, &s->t[s->rows], s->y + (size_t)s->rows * (size_t)s->n);
  s->rows++;
}

/* ---- The law of growth */

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
  if (n < FEWEST) return;
  LineFit by_power = lag_line_fit(n, lx, y), by_rate = lag_line_fit(n, x, y);
  double rest_of_power = by_power.yy - by_power.xy * by_power.xy / by_power.xx, rest_of_rate = by_rate.yy - by_rate.xy * by_rate.xy / by_rate.xx;
  *power = by_power.xy / by_power.xx;
  rate = by_rate.xy / by_rate.xx;
  if (rest_of_rate < 0.5 * rest_of_power && rate * (x[n - 1] - x[0]) > 6 && y[n - 1] - y[0] > 6) {
    e->growth = LAG_ERROR_EXPONENTIAL;
    e->rate = rate;
  } else {
    e->growth = *power < 0.4 ? LAG_ERROR_BOUNDED : *power < 1.5 ? LAG_ERROR_LINEAR : LAG_ERROR_QUADRATIC;
  }
}

/* Extends the errors from the last compared time to the end of the run by their law; without one they are not known. */
static void extrapolate(ErrorEstimate *e, double until, double power) {
  double t = fabs(e->motion.t[e->compared - 1] - e->t0), rest = fabs(until - e->t0) - t, dir = until < e->t0 ? -1 : 1, reach = HUGE_VAL;
  e->continued = 1;
  if (e->growth == LAG_ERROR_UNKNOWN) {
    e->largest = NAN;
  } else if (e->growth == LAG_ERROR_EXPONENTIAL) {
    reach = log(no_digit / e->largest) / e->rate;
    e->largest *= exp(e->rate * fmin(rest, reach));
  } else if (power > 0.4) {
    reach = t * (pow(no_digit / e->largest, 1 / power) - 1);
    e->largest *= pow((t + fmin(rest, reach)) / t, power);
  }
  if (reach < rest) e->horizon = e->t0 + dir * (t + reach);
}

/* ---- The comparison */

/* A time at which no digit is left. It is the horizon if the motions stay apart: in a close encounter velocities differ for a moment. */
typedef struct Parting {
  double t, least; /* NaN: none; smallest error from a twentieth of the time so far later on */
} Parting;

/* Whether the error at time t confirms the parting; p->t := NaN where it refutes it. */
static int is_confirmed(const ErrorEstimate *e, Parting *p, double t, double error, int last) {
  const double soon = 0.05, later = 0.1, apart = 0.01;
  if (isnan(p->t) && error >= no_digit) *p = (Parting){t, HUGE_VAL};
  if (isnan(p->t)) return 0;
  double since = fabs(t - p->t) / fmax(fabs(p->t - e->t0), DBL_MIN);
  if (since > soon || last) p->least = fmin(p->least, error);
  if (since <= later && !last) return 0;
  if (p->least >= apart) return 1;
  p->t = NAN;
  return 0;
}

/* Compares rows up to the end, the horizon, or where `other` stops. */
static int compare_rows(ErrorEstimate *e, lag_sim *other, const double *scale) {
  Parting parting = {NAN, HUGE_VAL};
  for (e->compared = 0; e->compared < e->motion.rows && isnan(e->horizon); e->compared++) {
    int i = e->compared, rc = lag_sim_advance(other, e->motion.t[i]);
    if (rc < 0) snprintf(e->why, sizeof e->why, "the second run failed: %s", lag_sim_message(other));
    if (rc) return rc;
    e->error[i] = lag_cost_row_error(e->motion.n, e->motion.y + (size_t)i * (size_t)e->motion.n, other->now, scale);
    e->largest = fmax(e->largest, e->error[i]);
    if (is_confirmed(e, &parting, e->motion.t[i], e->error[i], i + 1 == e->motion.rows)) e->horizon = parting.t;
  }
  return LAG_OK;
}

int lag_error_estimate_compare(ErrorEstimate *e, lag_sim *other, double until) {
  double *scale = calloc((size_t)e->motion.n + 1, sizeof *scale), power;
  if (!scale) return LAG_ENOMEM;
  lag_cost_scales(&e->motion, other, scale);
  int rc = compare_rows(e, other, scale);
  free(scale);
  if (rc == LAG_ENOMEM) return rc;
  find_growth(e, &power);
  if (e->compared && isnan(e->horizon) && e->compared < e->motion.rows) extrapolate(e, until, power);
  if (isnan(e->largest) && !e->why[0]) snprintf(e->why, sizeof e->why, "a second run reached only t = %.3g s", lag_sim_time(other));
  return LAG_OK;
}
