/* Error of a run by a second run (error_estimate.h), as in step doubling: E. Hairer, S.P. Norsett, G. Wanner,
 * Solving Ordinary Differential Equations I (1993), DOI 10.1007/978-3-540-78862-1, II.4, but for the whole motion.
 * Neighbouring motions of chaos part exponentially, those of regular motion in proportion to time; a method adds to
 * it once or twice more: hence the laws of growth. */
#include "analysis/error_estimate.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/line_fit.h"

enum { PLACES_A_STEP = 4 };

/* The error at which no digit of a value is left. */
static const double no_digit = 0.3;

int lag_error_estimate_init(ErrorEstimate *e, const lag_sim *sim) {
  enum { FEW = 64 };                                                     /* unknowns */
  const int fewest = 64, most = LAG_ERROR_PLACES / 8, numbers = 1 << 23; /* 64 MiB */
  const lag_model *m = lag_sim_scene(sim)->model;
  *e = (ErrorEstimate){.stride = 1, .whole = 1, .largest = NAN, .horizon = NAN, .known_to = NAN};
  e->t0 = lag_sim_time(sim);
  int room = numbers / (sim->pb.n + 1);
  e->room = sim->pb.n <= FEW ? LAG_ERROR_PLACES : room > most ? most : room < fewest ? fewest : room;
  int rc = lag_samples_init(&e->motion, e->room, 2 * m->nq + m->nz);
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
    e->met[i - 1] = e->met[2 * i - 1];
    memcpy(s->y + (size_t)(i - 1) * n, s->y + (size_t)(2 * i - 1) * n, n * sizeof(double));
  }
  s->rows /= 2;
  e->stride *= 2;
}

/* Whether a switching surface or an event has cut the last step: a dense output that calls the model, or is
 * projected to its constraints, has the wrong branch, or set of constraints, by now. */
static int is_cut(const lag_sim *sim, int held, int at_event) {
  return (sim->scene->model->nmodes || held) && (at_event || sim->run->t != sim->run->step_t1);
}

/* Whether a contact is closed, or may be one that slips. */
static int some_held(const lag_sim *sim) {
  const lag_model *m = sim->scene->model;
  int held = 0;
  for (int i = 0; i < m->ncontacts; i++)
    held |= m->contacts[i].is_tangent || lag_contact_is_closed(sim, &m->contacts[i]);
  return held;
}

/* *t, y[n] := place k within the last step; few: there are several in a step, else one; held: a contact is closed at
 * an end of it. Returns whether it lies before the end, and so before events there; the end where the method steps
 * to each row, or the step is cut. */
static int take_place(lag_sim *sim, int k, int few, int held, double *t, double *y) {
  const double golden = 0.6180339887498949; /* any part of all steps has places everywhere in a step */
  const Run *r = sim->run;
  size_t bytes = (size_t)sim->pb.n * sizeof(double);
  double calls = sim->pb.rhs_calls; /* of the run: interpolation may take more */
  double part = few ? (k + fmod(golden * r->steps, 1)) / PLACES_A_STEP : fmod(golden * r->steps, 1);
  *t = r->step_t0 + part * (r->t - r->step_t0);
  int between = !(sim->method->flags & LAG_METHOD_STEPS_TO) && !is_cut(sim, held, 0);
  between = between && lag_dense_state(sim, *t, sim->yc) == LAG_OK;
  sim->pb.rhs_calls = calls;
  if (!between) *t = r->t;
  memcpy(y, between ? sim->yc : sim->now, bytes);
  return between;
}

void lag_error_estimate_note(ErrorEstimate *e, lag_sim *sim) {
  Samples *s = &e->motion;
  const Run *r = sim->run;
  double before = e->events;
  int at_event = r->events != before, between = 1, now = some_held(sim), held = e->held || now;
  e->held = now;
  e->events = r->events;
  if (at_event && (sim->method->flags & LAG_METHOD_STEPS_TO || is_cut(sim, held, 1) || r->t == r->step_t0)) return;
  for (int k = 0; k < PLACES_A_STEP && between; k++) {
    if (++e->seen % e->stride) continue;
    if (s->rows == e->room) halve(e);
    if (e->seen % e->stride) continue;
    between =
        take_place(sim, k, e->stride < PLACES_A_STEP, held, &s->t[s->rows], s->y + (size_t)s->rows * (size_t)s->n);
    e->met[s->rows++] = between ? before : e->events;
  }
}

/* Whether the energy or another charge that should stand still drifts with a trend. */
static int has_drift(lag_sim *sim) {
  enum { MOST = 8 };
  lag_charge_stats c;
  int drifts = 0;
  for (int k = 0; k < lag_sim_ncharges(sim) && k < MOST; k++) {
    lag_sim_charge(sim, k, &c);
    drifts |= (c.flags & (LAG_CONSERVED | LAG_BALANCED)) && c.trend == LAG_TREND_GROWS;
  }
  return drifts;
}

/* Error by rounding of impacts that any run shares: the times of flights change with the energy, which drifts. */
static double error_of_impacts(lag_sim *sim) {
  const double half = 0.5;
  const lag_model *m = sim->scene->model;
  lag_charge_stats c;
  int alone = m->ncontacts > 0 && lag_sim_ncharges(sim) > 0;
  for (int k = 0; k < m->nev && alone; k++) alone = lag_contact_of(m, k) != NULL;
  if (!alone) return 0;
  lag_sim_charge(sim, 0, &c);
  int drifts = c.flags & (LAG_CONSERVED | LAG_BALANCED) && c.trend == LAG_TREND_GROWS;
  return drifts ? half * c.drift * sim->run->events : 0;
}

void lag_error_estimate_note_end(ErrorEstimate *e, lag_sim *sim) {
  Samples *s = &e->motion;
  e->drifts = has_drift(sim);
  e->floor = fmax(e->floor, error_of_impacts(sim));
  if (sim->run->events != e->events || (s->rows && s->t[s->rows - 1] == lag_sim_time(sim))) return;
  if (s->rows == e->room) halve(e);
  s->t[s->rows] = lag_sim_time(sim);
  e->met[s->rows] = e->events;
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

/* The error that is exceeded half of the time of these pieces: close encounters, where velocities differ for a
 * moment, do not count. */
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

/* t[BINS], y[BINS] := time and log of the typical error in equal spans of the time compared, up to the horizon.
 * Returns the number of those with an error. */
static int take_levels(const ErrorEstimate *e, double *t, double *y) {
  static const double latest = 1 - 1e-12;
  Piece piece[LAG_ERROR_PLACES];
  double end = fabs((isnan(e->horizon) ? e->compared ? e->motion.t[e->compared - 1] : e->t0 : e->horizon) - e->t0),
         before = 0;
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

/* A line through y over x from element `from` on. Residuals that follow one another, where the error swings more
 * slowly than a bin, count as fewer: G. Bayley, J. Hammersley, J. R. Stat. Soc. Suppl. 8 (1946) 184. */
typedef struct Slope {
  double slope, uncertain, plain; /* plain: uncertainty of independent residuals */
  double left, end;               /* squares that are left; y of the line at the last x */
} Slope;

static Slope slope_of(int from, int n, const double *x, const double *y) {
  LineFit f = lag_line_fit(n - from, x + from, y + from);
  double slope = f.xy / f.xx, left = fmax(f.yy - f.xy * slope, 0), follow = 0, before = 0;
  for (int i = from; i < n; i++) {
    double rest = y[i] - f.my - slope * (x[i] - f.mx);
    follow += rest * before;
    before = rest;
  }
  double alike = left > 0 ? fmin(fmax(follow / left, 0), 0.9) : 0;
  double plain = sqrt(left / (n - from - 2) / f.xx);
  return (Slope){slope, plain * sqrt((1 + alike) / (1 - alike)), plain, left, f.my + slope * (x[n - 1] - f.mx)};
}

/* Whether the error grows exponentially: a line over t fits better than one over log t, at the same rate later on, and
 * both rise by more than any power that is claimed. */
static int is_exponential(Slope all, Slope late, Slope power_all, Slope power_late, double span) {
  const double same = 2, rise = 4, steep = 3;
  int fits = all.left < 0.5 * power_all.left && late.slope * same > all.slope && late.slope < same * all.slope;
  return fits && all.slope * span > rise && power_late.slope > steep;
}

/* The power of t, 0 to 2, that the error follows from a quarter of the time on, and alike in the second half; -1:
 * none is told apart from others. Where a charge drifts, it is bounded never, and as t only where that fits well: it
 * grows by more later. rough: of a few errors, the nearest power. */
static int power_of(Slope all, Slope late, int drifts, int rough) {
  const double near = 0.35, sure = 0.4, alike = 0.25, well = 0.13, flat = 0.1, nearest = 0.45; /* by estimates.py */
  int k = (int)lround(fmin(fmax(all.slope, 0), 9));
  double off = fabs(all.slope - k), off_late = fabs(late.slope - k);
  double most = fmax(all.slope + 1.5 * all.uncertain, late.slope + 2 * late.uncertain);
  if (rough) return all.slope < fmax(nearest, 2 * all.plain) ? 0 : k && k <= 2 && off < nearest ? k : -1;
  if (k == 0) return !drifts && most < flat ? 0 : -1; /* what decays does not grow */
  if (fabs(all.slope - late.slope) > alike) return -1;
  if (k == 1 && drifts && fmax(off, fmax(off_late, late.uncertain)) > well) return -1;
  return k <= 2 && off < near && off_late + late.uncertain < sure ? k : -1;
}

/* The law of growth: log of the typical error over t and over log t, from a quarter of the time on. *power: exponent of
 * t; *level: typical error at the end of the comparison. */
static void find_growth(ErrorEstimate *e, double *power, double *level) {
  enum { FEWEST = 6 };
  double x[BINS], lx[BINS], y[BINS];
  int n = take_levels(e, x, y), quarter = 0, half = 0;
  *power = 0;
  *level = n ? exp(y[n - 1]) : 0;
  for (int i = 0; i < n; i++) {
    lx[i] = log(x[i]);
    quarter += x[i] < 0.25 * x[n - 1];
    half += x[i] < 0.5 * x[n - 1];
  }
  if (n - half < FEWEST) return;
  if (e->rough) quarter = n / 8;
  Slope all = slope_of(quarter, n, x, y), late = slope_of(half, n, x, y);
  Slope power_all = slope_of(quarter, n, lx, y), power_late = slope_of(half, n, lx, y);
  int k = power_of(power_all, power_late, e->drifts, e->rough);
  if (is_exponential(all, late, power_all, power_late, x[n - 1] - x[quarter])) {
    e->growth = LAG_ERROR_EXPONENTIAL;
    e->rate = late.slope;
    *level = exp(late.end);
  } else if (k >= 0) {
    e->growth = k == 0 ? LAG_ERROR_BOUNDED : k == 1 ? LAG_ERROR_LINEAR : LAG_ERROR_QUADRATIC;
    *power = k;
    *level = exp(power_late.end);
  }
}

ErrorGrowth lag_error_growth(int n, double *t, const double *error) {
  ErrorEstimate e = {.rough = 1, .motion = {.rows = n, .t = t}, .t0 = n ? t[0] : 0, .horizon = NAN};
  e.compared = n < LAG_ERROR_PLACES ? n : LAG_ERROR_PLACES;
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
  if (!e->compared || (e->growth == LAG_ERROR_UNKNOWN && isnan(e->horizon))) return NAN;
  t = fabs((isnan(e->horizon) ? e->motion.t[e->compared - 1] : e->horizon) - e->t0);
  if (e->growth == LAG_ERROR_UNKNOWN) { /* motions that parted: the mean rate up to there */
    int first = 0;
    while (first < e->compared - 1 && !(e->error[first] > 0)) first++;
    return e->error[first] < no_digit ? t * (1 - log(factor) / log(no_digit / fmax(e->error[first], DBL_EPSILON)))
                                      : NAN;
  }
  rest = log(no_digit / (factor * level));
  return e->growth == LAG_ERROR_EXPONENTIAL ? t + rest / e->rate : power > 0 ? t * exp(rest / power) : HUGE_VAL;
}

/* Exponential growth goes on, for as long again at most; other laws may end where the motion changes, as chaos shows
 * late. */
static void extrapolate(ErrorEstimate *e, double until, double level) {
  double t = fabs(e->motion.t[e->compared - 1] - e->t0), left = fabs(until - e->t0) - t, dir = until < e->t0 ? -1 : 1;
  double rest = e->growth == LAG_ERROR_EXPONENTIAL ? fmin(left, t) : 0;
  e->known_to = rest < left ? e->t0 + dir * (t + rest) : until;
  if (!(rest > 0)) return;
  e->floor *= 1 + rest / t;
  double reach = fmax(log(no_digit / level) / e->rate, 0);
  e->largest = fmin(e->largest * exp(e->rate * fmin(rest, reach)), fmax(e->largest, 1));
  if (reach < rest) e->horizon = e->t0 + dir * (t + reach);
}

/* ---- The comparison */

/* A time at which no digit is left. It is the horizon if the motions stay apart: in a close encounter velocities
 * differ for a moment. */
typedef struct Parting {
  double t;           /* NaN: none */
  double since, near; /* time compared from a twentieth later on [s]; the part of it with an error of a percent */
  double last;        /* time of the last error [s] */
} Parting;

/* Whether the error at time t confirms the parting; p->t := NaN where it refutes it. */
static int is_confirmed(const ErrorEstimate *e, Parting *p, double t, double error, int last) {
  const double soon = 0.05, later = 0.25, apart = 0.01, most = 0.25;
  if (isnan(p->t) && error >= no_digit) *p = (Parting){.t = t, .last = t};
  if (isnan(p->t)) return 0;
  double since = fabs(t - p->t) / fmax(fabs(p->t - e->t0), DBL_MIN), step = fabs(t - p->last);
  if (since > soon) p->since += step, p->near += error < apart ? step : 0;
  p->last = t;
  if (since <= later && !last) return 0;
  if (p->near <= most * p->since) return 1;
  p->t = NAN;
  return 0;
}

/* Error of the present state by the rounding of the time, half a unit in its last place: all runs share it. */
static double clock_error(lag_sim *sim, const double *scale, double *rates) {
  double t = sim->run->t, most = 0, calls = sim->pb.rhs_calls;
  if (t == 0 || lag_rhs(&sim->pb, t, sim->now, rates)) return 0;
  sim->pb.rhs_calls = calls;
  for (int i = 0; i < sim->pb.n; i++) most = fmax(most, fabs(rates[i]) / scale[i]);
  return most * ldexp(DBL_EPSILON / 2, ilogb(t));
}

/* Compares rows up to the end, the horizon, or where `other` stops. Two runs meet an event at times that differ by
 * their errors: rows between, where one has met it and the other has not, say nothing, unless they go on. */
static int compare_rows(ErrorEstimate *e, lag_sim *other, const double *scale, double *rates) {
  enum { LONG = 4 };
  const double visible = 1e-8; /* beside rounding of the time, which costs an evaluation */
  Parting parting = {.t = NAN};
  double apart = 0, skipped = 0; /* of the counts of events; largest error of rows that differ */
  int n = 0;                     /* rows in turn that differ */
  for (e->compared = 0; e->compared < e->motion.rows && isnan(e->horizon); e->compared++) {
    int i = e->compared, rc = lag_sim_advance(other, e->motion.t[i]);
    if (rc < 0) snprintf(e->why, sizeof e->why, "the second run failed: %s", lag_sim_message(other));
    int parted = rc && i && !isnan(parting.t) && is_confirmed(e, &parting, e->motion.t[i - 1], e->error[i - 1], 1);
    if (parted) e->horizon = parting.t;
    if (rc) return rc;
    double now = e->met[i] - other->run->events, *y = e->motion.y + (size_t)i * (size_t)e->motion.n;
    double error = e->whole * lag_cost_row_error(e->motion.n, y, other->now, scale);
    n = now == apart ? 0 : n + 1;
    skipped = n > 0 ? fmax(skipped, error) : 0;
    if (n > 0 && n < LONG) {
      e->error[i] = i > 0 ? e->error[i - 1] : 0;
      continue;
    }
    if (n > 0) apart = now;
    e->error[i] = error;
    e->largest = fmax(e->largest, fmax(error, skipped));
    if (e->whole == 1 || error < visible) e->floor = fmax(e->floor, clock_error(other, scale, rates));
    if (is_confirmed(e, &parting, e->motion.t[i], e->error[i], i + 1 == e->motion.rows)) e->horizon = parting.t;
  }
  return LAG_OK;
}

int lag_error_least_scale(const ErrorEstimate *e, lag_sim *other, double *least) {
  double *scale = calloc((size_t)e->motion.n + 1, sizeof *scale);
  int rc = scale ? lag_cost_scales(&e->motion, other, scale) : LAG_ENOMEM;
  *least = HUGE_VAL;
  for (int i = 0; rc == LAG_OK && i < e->motion.n; i++) *least = fmin(*least, scale[i]);
  free(scale);
  return rc;
}

int lag_formula_is_lossy(const ErrorEstimate *e) {
  const double many = 1e-6; /* other rounding modes overstate by some digits */
  return e->formula.of >= 0 && e->formula.part > many;
}

int lag_error_estimate_compare(ErrorEstimate *e, lag_sim *other, double until) {
  size_t n = (size_t)e->motion.n;
  double *scale = calloc(2 * n + 1, sizeof *scale), power, level;
  int rc = scale ? lag_cost_scales(&e->motion, other, scale) : LAG_ENOMEM;
  if (rc == LAG_OK) rc = lag_formula_noise(other, &e->motion, &e->formula);
  if (rc == LAG_OK) rc = compare_rows(e, other, scale, scale + n);
  free(scale);
  if (rc == LAG_ENOMEM) return rc;
  find_growth(e, &power, &level);
  e->known_to = until;
  if (e->compared && isnan(e->horizon) && e->compared < e->motion.rows) {
    e->continued = 1;
    extrapolate(e, until, level);
  }
  if (isnan(e->largest) && !e->why[0] && !e->motion.rows)
    snprintf(e->why, sizeof e->why, "the run ended at an event in its first step");
  if (isnan(e->largest) && !e->why[0])
    snprintf(e->why, sizeof e->why,
             "a second run reached only t = %.3g s; compare with a run of half the step or a smaller tolerance",
             lag_sim_time(other));
  return LAG_OK;
}

void lag_error_estimate_reset(ErrorEstimate *e) {
  e->continued = 0;
  e->largest = e->horizon = e->known_to = NAN;
  e->growth = LAG_ERROR_UNKNOWN;
  e->why[0] = 0;
}

double lag_error_size(const ErrorEstimate *e) {
  return isnan(e->largest) ? NAN : fmax(e->largest, fmax(e->floor, DBL_EPSILON));
}

int lag_error_estimate_is_blind(ErrorEstimate *e) {
  int alike = e->compared > 0;
  for (int i = 0; i < e->compared; i++) alike = alike && e->error[i] == 0;
  if (alike) lag_error_estimate_reset(e);
  return alike;
}
