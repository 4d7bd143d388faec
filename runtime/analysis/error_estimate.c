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

/* Whether a switching surface or an event has cut the last step: a dense output that calls the model, or is projected to its constraints, has the
 * wrong branch, or set of constraints, by now. */
static int is_cut(const lag_sim *sim) {
  const lag_model *m = sim->scene->model;
  return (m->nmodes || m->ncontacts) && sim->run->t != sim->run->step_t1;
}

/* *t, y[n] := a place within the last step, whose error is that of rows between steps; its end where the method steps to each row, or the step is cut. In the
 * middle of a flight between two walls, as in that of a symmetric swing, a coordinate would be 0, and have no size. */
static void take_place(lag_sim *sim, double *t, double *y) {
  const Run *r = sim->run;
  size_t bytes = (size_t)sim->pb.n * sizeof(double);
  double calls = sim->pb.rhs_calls; /* of the run: interpolation may take more */
  *t = r->step_t0 + 0.4 * (r->t - r->step_t0);
  int between = !(sim->method->flags & LAG_METHOD_STEPS_TO) && !is_cut(sim) && lag_dense_state(sim, *t, sim->yc) == LAG_OK;
  sim->pb.rhs_calls = calls;
  if (!between) *t = r->t;
  memcpy(y, between ? sim->yc : sim->now, bytes);
}

void lag_error_estimate_note(ErrorEstimate *e, lag_sim *sim) {
  Samples *s = &e->motion;
  int at_event = sim->run->events != e->events;
  e->events = sim->run->events;
  if ((at_event && (sim->method->flags & LAG_METHOD_STEPS_TO || is_cut(sim))) || ++e->seen % e->stride) return;
  if (s->rows == LAG_ERROR_PLACES) halve(e);
  if (e->seen % e->stride) return;
  take_place(sim, &s->t[s->rows], s->y + (size_t)s->rows * (size_t)s->n);
  s->rows++;
}

void lag_error_estimate_note_end(ErrorEstimate *e, const lag_sim *sim) {
  Samples *s = &e->motion;
  if (sim->run->events != e->events || (s->rows && s->t[s->rows - 1] == lag_sim_time(sim))) return;
  if (s->rows == LAG_ERROR_PLACES) halve(e);
  s->t[s->rows] = lag_sim_time(sim);
  memcpy(s->y + (size_t)s->rows++ * (size_t)s->n, sim->now, (size_t)s->n * sizeof(double));
}

/* ---- The law of growth */

enum { BINS = 24 };

typedef struct Piece {
  double error, weight; /* weight: its time [s] */
} Piece;

static int by_error(const void *a, const void *b) {
  double x = ((const Piece *)a)->error, y = ((const Piece *)b)->error;
  return (x > y) - (x < y);
}

/* The error that is exceeded half of the time of these pieces: close encounters, where velocities differ for a moment, do not count. */
static double typical_error(int n, Piece *all) {
  double whole = 0, part = 0;
  int i = 0;
  qsort(all, (size_t)n, sizeof *all, by_error);
  for (int k = 0; k < n; k++) whole += all[k].weight;
  for (; i < n - 1 && (part += all[i].weight) < 0.5 * whole; i++) continue;
  return all[i].error;
}

/* *t, *y := time and log of the typical error of the pieces, if it has one. Returns whether it has. */
static int put_level(int n, Piece *all, double at, double *t, double *y) {
  double typical = n ? typical_error(n, all) : 0;
  if (!(typical > 0)) return 0;
  *t = at;
  *y = log(typical);
  return 1;
}

/* t[BINS], y[BINS] := time and log of the typical error in equal spans of the time compared, up to the horizon. Returns the number of those with an
 * error. */
static int take_levels(const ErrorEstimate *e, double *t, double *y) {
  static const double latest = 1 - 1e-12;
  Piece piece[LAG_ERROR_PLACES];
  double end = fabs((isnan(e->horizon) ? e->compared ? e->motion.t[e->compared - 1] : e->t0 : e->horizon) - e->t0), before = 0;
  int n = 0, pieces = 0, bin = 0;
  for (int i = 0; i < e->compared; i++) {
    double at = fabs(e->motion.t[i] - e->t0);
    if (at > end) break;
    int into = (int)(fmin(at / end, latest) * BINS);
    if (into > bin) n += put_level(pieces, piece, (bin + 0.5) / BINS * end, t + n, y + n), pieces = 0;
    bin = into;
    piece[pieces++] = (Piece){e->error[i], at - before};
    before = at;
  }
  return n + put_level(pieces, piece, (bin + 0.5) / BINS * end, t + n, y + n);
}

/* The law of growth: log of the typical error against t, or against log t. *power: exponent of t; *level: typical error at the end of the comparison. */
static void find_growth(ErrorEstimate *e, double *power, double *level) {
  enum { FEWEST = 8 };
  double x[BINS], lx[BINS], y[BINS], rate;
  int n = take_levels(e, x, y), first = n / 8; /* the first ones show rounding, not growth */
  *power = 0;
  *level = n ? exp(y[n - 1]) : 0;
  if (n - first < FEWEST) return;
  for (int i = 0; i < n; i++) lx[i] = log(x[i]);
  LineFit by_power = lag_line_fit(n - first, lx + first, y + first), by_rate = lag_line_fit(n - first, x + first, y + first);
  double rest_of_power = by_power.yy - by_power.xy * by_power.xy / by_power.xx, rest_of_rate = by_rate.yy - by_rate.xy * by_rate.xy / by_rate.xx;
  *power = by_power.xy / by_power.xx;
  rate = by_rate.xy / by_rate.xx;
  if (rest_of_rate < 0.5 * rest_of_power && rate * (x[n - 1] - x[first]) > 6 && y[n - 1] - y[first] > 6) {
    e->growth = LAG_ERROR_EXPONENTIAL;
    e->rate = rate;
  } else {
    double uncertain = 2 * sqrt(rest_of_power / (n - first - 2) / by_power.xx); /* errors that oscillate show a slope by chance */
    e->growth = *power < fmax(0.4, uncertain) ? LAG_ERROR_BOUNDED : *power < 1.5 ? LAG_ERROR_LINEAR : LAG_ERROR_QUADRATIC;
  }
}

ErrorGrowth lag_error_growth(int n, double *t, const double *error) {
  ErrorEstimate e = {.motion = {.rows = n, .t = t}, .t0 = n ? t[0] : 0, .horizon = NAN, .compared = n < LAG_ERROR_PLACES ? n : LAG_ERROR_PLACES};
  double power, level;
  for (int i = 0; i < e.compared; i++) {
    e.error[i] = error[i];
    if (error[i] >= no_digit) return LAG_ERROR_UNKNOWN;
  }
  find_growth(&e, &power, &level);
  return e.growth;
}

double lag_error_reach(ErrorEstimate *e, double factor) {
  double power, level, t, rest;
  find_growth(e, &power, &level);
  for (int i = 1; i < e->compared; i++) {
    double before = factor * e->error[i - 1], error = factor * e->error[i];
    if (error < no_digit || !(before > 0)) continue;
    double part = before < no_digit ? log(no_digit / before) / log(error / before) : 0;
    return fabs(e->motion.t[i - 1] - e->t0) + part * fabs(e->motion.t[i] - e->motion.t[i - 1]);
  }
  if (!e->compared || e->growth == LAG_ERROR_UNKNOWN) return NAN;
  t = fabs((isnan(e->horizon) ? e->motion.t[e->compared - 1] : e->horizon) - e->t0);
  rest = log(no_digit / (factor * level));
  return e->growth == LAG_ERROR_EXPONENTIAL ? t + rest / e->rate : power > 0.4 ? t * exp(rest / power) : HUGE_VAL;
}

/* Extends the errors from the last compared time to the end of the run by their law; without one they are not known. */
static void extrapolate(ErrorEstimate *e, double until, double power, double level) {
  double t = fabs(e->motion.t[e->compared - 1] - e->t0), rest = fabs(until - e->t0) - t, dir = until < e->t0 ? -1 : 1, reach = HUGE_VAL;
  e->continued = 1;
  if (e->growth == LAG_ERROR_UNKNOWN) {
    e->largest = NAN;
  } else if (e->growth == LAG_ERROR_EXPONENTIAL) {
    reach = fmax(log(no_digit / level) / e->rate, 0);
    e->largest = fmin(e->largest * exp(e->rate * fmin(rest, reach)), fmax(e->largest, 1));
  } else if (power > 0.4) {
    reach = fmax(t * (pow(no_digit / level, 1 / power) - 1), 0);
    e->largest = fmin(e->largest * pow((t + fmin(rest, reach)) / t, power), fmax(e->largest, 1));
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
  double *scale = calloc((size_t)e->motion.n + 1, sizeof *scale), power, level;
  if (!scale) return LAG_ENOMEM;
  lag_cost_scales(&e->motion, other, scale);
  int rc = compare_rows(e, other, scale);
  free(scale);
  if (rc == LAG_ENOMEM) return rc;
  find_growth(e, &power, &level);
  if (e->compared && isnan(e->horizon) && e->compared < e->motion.rows) extrapolate(e, until, power, level);
  if (isnan(e->largest) && !e->why[0] && !e->motion.rows) snprintf(e->why, sizeof e->why, "the run ended at an event in its first step");
  if (isnan(e->largest) && !e->why[0]) snprintf(e->why, sizeof e->why, "a second run reached only t = %.3g s", lag_sim_time(other));
  return LAG_OK;
}

int lag_error_estimate_is_blind(ErrorEstimate *e) {
  int alike = e->compared > 0;
  for (int i = 0; i < e->compared; i++) alike = alike && e->error[i] == 0;
  if (!alike) return 0;
  e->continued = 0;
  e->largest = e->horizon = NAN;
  e->growth = LAG_ERROR_UNKNOWN;
  e->why[0] = 0;
  return 1;
}
