/* Periodic motions by multiple shooting (periodic_orbit.h). Multiple shooting: J. Stoer, R. Bulirsch, Introduction
 * to Numerical Analysis, 3rd ed. (2002), section 7.3. */
#include "analysis/periodic_orbit.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/finite_difference.h"
#include "numeric/singular_values.h"
#include "numeric/dense.h"

enum { MOST_STEPS = 60 };

static const double rounding = 1e-11; /* a residual, in units, that is a solution's; of rough tolerances more */

/* ---- Shooting */

/* Time at the begin of segment k. */
static double begins(const PeriodicOrbit *o, int k) { return o->flow.t0 + o->T * k / o->m; }

/* Residual row i of segment k, in units. */
static double gap(const PeriodicOrbit *o, int k, int i) {
  const double *next = k < o->m - 1 ? o->y + (k + 1) * o->n : o->target;
  return (o->end[k * o->n + i] - next[i]) / o->unit[i];
}

/* Size of what a condition is about; of a charge at the present start, whatever the probe saw last. */
static double size_of(PeriodicOrbit *o, const OrbitHold *h) {
  if (h->kind == ORBIT_CHARGE) lag_flow_charge(&o->flow, h->of, o->flow.t0, o->y);
  double size = h->kind == ORBIT_STATE    ? o->unit[h->of]
                : h->kind == ORBIT_PERIOD ? o->time
                                          : o->flow.probe->charge_now[2 * h->of + 1];
  return size > 0 ? size : 1;
}

/* Value of a condition less what it shall be, relative to its size. */
static double off(PeriodicOrbit *o, const OrbitHold *h) {
  double size = size_of(o, h), now = h->kind == ORBIT_STATE    ? o->y[h->of]
                                     : h->kind == ORBIT_PERIOD ? o->T
                                                               : o->flow.probe->charge_now[2 * h->of];
  return (now - h->value) / size;
}

/* Value of condition k, of which the present parameter may be the one that it keeps. */
static double off_by(PeriodicOrbit *o, int k) {
  OrbitHold h = o->held[k];
  if (o->continues && k == o->led) h.value = o->parameter;
  return off(o, &h);
}

/* C[n c] := C - R C, with the map R of a motion that is the same backwards. */
static void less_image(PeriodicOrbit *o, int c, double *C) {
  double *column = o->x, *image = column + o->n;
  for (int j = 0; j < c; j++) {
    for (int i = 0; i < o->n; i++) column[i] = C[i * c + j];
    lag_map_apply(o->reverse, column, image);
    for (int i = 0; i < o->n; i++) C[i * c + j] -= image[i];
  }
}

/* Residual of component i of the begin of a motion that is the same backwards, in units. */
static double begin_gap(const PeriodicOrbit *o, int i) {
  const StateMap *R = o->reverse;
  return (o->y[i] - R->sign[i] * o->y[R->from[i]] - o->offset[i]) / o->unit[i];
}

/* Row of component i of the begin of a motion that is the same backwards. */
static void begin_row(PeriodicOrbit *o, int row, int i) {
  const StateMap *R = o->reverse;
  int from = R->from[i];
  o->A[row * o->cols + i] += 1;
  o->A[row * o->cols + from] -= R->sign[i] * o->unit[from] / o->unit[i];
  o->b[row] = -begin_gap(o, i);
}

/* Runs all segments; residual := what is left. */
int lag_orbit_shoot(PeriodicOrbit *o, int tangents) {
  int n = o->n, rc = LAG_OK;
  double sum = 0;
  for (int k = 0; k < o->m && rc == LAG_OK; k++) {
    rc = lag_flow_run(&o->flow, begins(o, k), o->T / o->m, o->y + k * n, o->end + k * n,
                      tangents ? o->Phi + k * n * n : NULL);
    if (tangents) memcpy(o->rates + k * n, o->flow.rates, (size_t)n * sizeof *o->rates);
  }
  lag_orbit_set_target(o);
  if (o->half && tangents) less_image(o, n, o->Phi + (o->m - 1) * n * n);
  for (int k = 0; k < o->m; k++)
    for (int i = 0; i < n; i++) sum += gap(o, k, i) * gap(o, k, i);
  for (int k = 0; k < o->nheld; k++) sum += off_by(o, k) * off_by(o, k);
  for (int i = 0; i < n && o->half; i++) sum += begin_gap(o, i) * begin_gap(o, i);
  o->residual = rc ? HUGE_VAL : sqrt(sum / (o->m * n));
  return rc;
}

/* ---- The linear system */

static int period_is_free(const PeriodicOrbit *o) { return !o->flow.forced; }
static int column_of_period(const PeriodicOrbit *o) { return o->m * o->n; }
static int column_of_shift(const PeriodicOrbit *o, int j) { return o->m * o->n + period_is_free(o) + j; }

static void gaps(PeriodicOrbit *o) {
  for (int r = 0; r < o->m * o->n; r++) o->b[r] = -gap(o, r / o->n, r % o->n);
}

static void shooting_rows(PeriodicOrbit *o) {
  int n = o->n, cols = o->cols;
  for (int k = 0; k < o->m; k++)
    for (int i = 0; i < n; i++) {
      double *row = o->A + (k * n + i) * cols;
      for (int j = 0; j < n; j++) {
        row[k * n + j] += o->Phi[(k * n + i) * n + j] * o->unit[j] / o->unit[i];
        if (k == o->m - 1) row[j] -= o->G[i * n + j] * o->unit[j] / o->unit[i];
        else if (i == j) row[(k + 1) * n + j] -= 1;
      }
    }
  gaps(o);
}

/* out[m n + nheld] := residuals and conditions with another value of the parameter. */
static int residuals_at(void *of, double parameter, double *out) {
  PeriodicOrbit *o = of;
  int all = o->m * o->n, rc = lag_orbit_set_parameter(o, parameter);
  rc = rc ? rc : lag_orbit_shoot(o, 0);
  for (int r = 0; r < all && rc == LAG_OK; r++) out[r] = gap(o, r / o->n, r % o->n);
  for (int k = 0; k < o->nheld && rc == LAG_OK; k++) out[all + k] = off_by(o, k);
  return rc;
}

/* Column of the parameter: of one of the model by differences of order 2 of all rows, in any program: Newton's
 * steps and tangents need no more than some eight digits, and the period of a drive may change, too. */
static int continuation_column(PeriodicOrbit *o) {
  const double part = 1e-5;
  int all = o->m * o->n, col = o->cols - 1;
  if (o->led >= 0) {
    o->A[(all + o->led) * o->cols + col] = -o->parameter_unit / size_of(o, &o->held[o->led]);
    return LAG_OK;
  }
  double was = o->parameter, *ends = o->ends;
  memcpy(ends, o->end, (size_t)all * sizeof *ends);
  FiniteDifference d = {.order = 2, .n = all + o->nheld, .stride = o->cols, .h = part * o->parameter_unit,
                        .part = part, .out = o->saved};
  int rc = lag_finite_difference(&d, residuals_at, o, was, o->A + col);
  rc = rc ? rc : lag_orbit_set_parameter(o, was);
  memcpy(o->end, ends, (size_t)all * sizeof *ends);
  lag_orbit_set_target(o);
  return rc;
}

/* Whether a component that keeps its value chooses the phase: the motion crosses that value, or, of a family over one
 * of its own quantities, has no other freedom left. */
static int holds_phase(const PeriodicOrbit *o, const double *rates) {
  const double least = 0.1;
  for (int k = 0; k < o->nheld; k++) {
    int i = o->held[k].of;
    if (o->held[k].kind != ORBIT_STATE || k == o->led) continue;
    if (o->led >= 0 || fabs(rates[i]) * o->time > least * o->unit[i]) return 1;
  }
  return 0;
}

/* X[n], the rates, := a direction across which the phase is chosen while component i is led: of a velocity its
 * coordinate, of others the rates without that component, or where nothing else moves its velocity. */
static void leave_led(const PeriodicOrbit *o, int i, double *X) {
  const double least = 1e-6;
  int nq = o->flow.nq, velocity = i >= nq && i < 2 * nq,
      partner = velocity ? i - nq : i < nq ? i + nq : i > 0 ? i - 1 : 1;
  double other = 0, led = X[i] * o->time / o->unit[i];
  X[i] = 0;
  for (int j = 0; j < o->n; j++) other = fmax(other, fabs(X[j]) * o->time / o->unit[j]);
  if (!velocity && other >= least * fabs(led)) return;
  memset(X, 0, (size_t)o->n * sizeof *X);
  X[partner] = o->unit[partner];
}

/* Component of such a begin that the motion changes most against its image; of others -1. */
static int pinned_component(const PeriodicOrbit *o, const double *rates) {
  int pinned = -1;
  double most = 0;
  for (int i = 0; i < o->n && o->reverse; i++) {
    double off = fabs(rates[i] - o->reverse->sign[i] * rates[o->reverse->from[i]]) / o->unit[i];
    if (off > most) pinned = i, most = off;
  }
  return pinned;
}

/* Where the largest component of X[n] is the rate of one that is 0, X := that alone: a begin at a turning point, or
 * where a path is crossed, stays there, while steps across X would lead away from it ever faster. Another value need
 * not be reached by all motions of a branch. */
static void keep_zero(const PeriodicOrbit *o, double *X) {
  const double none = 1e-9;
  int most = 0;
  for (int i = 1; i < o->n; i++)
    if (fabs(X[i]) / o->unit[i] > fabs(X[most]) / o->unit[most]) most = i;
  if (fabs(o->y[most]) > none * o->unit[most]) return;
  for (int i = 0; i < o->n; i++) X[i] = i == most ? X[i] : 0;
}

/* Rows across the motion, or of a begin that is its own image, and across the symmetries of conserved charges. */
static int phase_rows(PeriodicOrbit *o) {
  const OrbitHold *lead = o->led >= 0 ? &o->held[o->led] : NULL;
  int n = o->n, row = o->m * n + o->nheld, rc = LAG_OK;
  double *X = o->x;
  o->pinned = -1;
  for (int k = -1; k < o->ncharges && rc == LAG_OK; k++) {
    if (k < 0 ? o->flow.forced : o->charge[k] == 0) continue;
    if (lag_flow_field(&o->flow, k < 0 ? 0 : o->charge[k], o->flow.t0, o->y, X)) continue;
    double size = 0;
    if (k < 0 && holds_phase(o, X)) continue;
    if (k < 0 && (o->pinned = pinned_component(o, X)) >= 0) {
      begin_row(o, row++, o->pinned);
      continue;
    }
    if (k < 0 && lead && lead->kind == ORBIT_STATE) leave_led(o, lead->of, X);
    if (k < 0) keep_zero(o, X);
    for (int i = 0; i < n; i++) size += X[i] * X[i] / (o->unit[i] * o->unit[i]);
    for (int i = 0; i < n && size > 0; i++) o->A[row * o->cols + i] = X[i] / o->unit[i] / sqrt(size);
    row++;
  }
  for (int j = 0; j < o->ngroup; j++) {
    for (int i = 0; i < o->group[j].n; i++) o->A[row * o->cols + o->group[j].shifted[i]] = 1;
    row += o->group[j].n > 0;
  }
  return rc;
}

/* Columns of the period and of shifts. */
static int parameter_columns(PeriodicOrbit *o) {
  int n = o->n, cols = o->cols, rc = LAG_OK;
  double *rates = o->w + 4 * (o->flow.nq + 1) * (o->flow.nq + 1), *y = rates + n;
  for (int k = 0; k < o->m && rc == LAG_OK && period_is_free(o); k++) {
    rc = lag_flow_rates(&o->flow, begins(o, k + 1), o->end + k * n, rates);
    if (o->half && k == o->m - 1) less_image(o, 1, rates);
    for (int i = 0; i < n && rc == LAG_OK; i++)
      o->A[(k * n + i) * cols + column_of_period(o)] = rates[i] / o->m * o->time / o->unit[i];
  }
  for (int j = 0; j < o->ngroup && rc == LAG_OK; j++) {
    memcpy(y, o->y, (size_t)n * sizeof *y);
    lag_orbit_close_motion(o, y, 0, j, rates);
    for (int i = 0; i < n; i++) o->A[((o->m - 1) * n + i) * cols + column_of_shift(o, j)] = -rates[i] / o->unit[i];
  }
  return rc;
}

static int held_rows(PeriodicOrbit *o) {
  int n = o->n, rc = LAG_OK;
  double *d = o->x;
  for (int k = 0; k < o->nheld && rc == LAG_OK; k++) {
    const OrbitHold *h = &o->held[k];
    double *row = o->A + (o->m * n + k) * o->cols;
    o->b[o->m * n + k] = -off_by(o, k);
    double size = size_of(o, h);
    if (h->kind == ORBIT_STATE) row[h->of] = 1;
    if (h->kind == ORBIT_PERIOD && period_is_free(o)) row[column_of_period(o)] = 1;
    if (h->kind != ORBIT_CHARGE) continue;
    rc = lag_flow_gradient(&o->flow, h->of, o->flow.t0, o->y, d);
    for (int i = 0; i < n && rc == LAG_OK; i++) row[i] = d[i] * o->unit[i] / size;
  }
  return rc;
}

/* Rows of the begin of a motion that is the same backwards, behind those of conditions. */
static void begin_rows(PeriodicOrbit *o) {
  for (int i = 0; i < o->n; i++) begin_row(o, o->m * o->n + o->nheld + i, i);
}

/* Removes the part of the shooting rows along w[m n], of unit length. */
static void remove_part(PeriodicOrbit *o, const double *w) {
  int all = o->m * o->n;
  double part = lag_dot(all, w, o->b);
  for (int r = 0; r < all; r++) o->b[r] -= part * w[r];
  for (int c = 0; c < o->cols; c++) {
    part = 0;
    for (int r = 0; r < all; r++) part += w[r] * o->A[r * o->cols + c];
    for (int r = 0; r < all; r++) o->A[r * o->cols + c] -= part * w[r];
  }
}

/* w := the gradients of conserved charge k at the ends of all segments, in units. */
static int charge_row(PeriodicOrbit *o, int k, double *w) {
  int n = o->n, rc = LAG_OK;
  for (int s = 0; s < o->m && rc == LAG_OK; s++) {
    rc = lag_flow_gradient(&o->flow, k, begins(o, s + 1), o->end + s * n, w + s * n);
    for (int i = 0; i < n; i++) w[s * n + i] *= o->unit[i];
  }
  return rc;
}

/* Makes w[all] orthogonal to the `before` rows at W, and of unit length; 0: nothing is left. */
static int orthogonal_unit(int all, int before, const double *W, double *w) {
  double size = lag_dot(all, w, w);
  for (int k = 0; k < before; k++) {
    double part = lag_dot(all, W + k * all, w);
    for (int i = 0; i < all; i++) w[i] -= part * W[k * all + i];
  }
  double left = lag_dot(all, w, w);
  if (!(left > 1e-16 * size)) return 0;
  for (int i = 0; i < all; i++) w[i] /= sqrt(left);
  return 1;
}

static int remove_charges(PeriodicOrbit *o) {
  int all = o->m * o->n, found = 0, rc = LAG_OK;
  double *W = o->across;
  for (int k = 0; k < o->ncharges && rc == LAG_OK; k++) {
    rc = charge_row(o, o->charge[k], W + found * all);
    if (rc == LAG_OK && orthogonal_unit(all, found, W, W + found * all)) remove_part(o, W + found++ * all);
  }
  o->nacross = found;
  return rc;
}

/* Whether nodes lie on constraints that always hold; those of contacts come and go. */
static int is_constrained(const PeriodicOrbit *o) {
  return o->flow.like->scene->model->constraints && !lag_flow_contacts(&o->flow);
}

/* A := its part in the tangent space of the constraints at each node, to which a step's end returns; o->normal := the
 * number of other directions. */
static int within_constraints(PeriodicOrbit *o) {
  int n = o->n, rc = LAG_OK;
  lag_problem *pb = &o->flow.probe->pb;
  Pool pool = {0};
  double *P = lag_pool_doubles(&pool, (size_t)(n * n + n)), *row = P + n * n,
         *scratch = lag_pool_doubles(&pool, lag_tangent_projection_size(pb) + 1), trace = 0;
  if (pool.failed) rc = LAG_ENOMEM;
  for (int k = 0; k < o->m && rc == LAG_OK; k++) {
    for (int e = 0; e < n * n; e++) P[e] = e % (n + 1) == 0;
    rc = lag_tangent_project(pb, begins(o, k), o->y + k * n, n, P, scratch);
    for (int i = 0; i < n; i++) trace += P[i * n + i];
    for (int r = 0; r < o->rows && rc == LAG_OK; r++) {
      double *a = o->A + r * o->cols + k * n;
      for (int j = 0; j < n; j++) {
        row[j] = 0;
        for (int i = 0; i < n; i++) row[j] += a[i] * P[i * n + j] * o->unit[j] / o->unit[i];
      }
      memcpy(a, row, (size_t)n * sizeof *a);
    }
  }
  o->normal = o->m * n - (int)rint(trace);
  lag_pool_free(&pool);
  return rc;
}

int lag_orbit_assemble(PeriodicOrbit *o) {
  memset(o->A, 0, (size_t)o->rows * (size_t)o->cols * sizeof *o->A);
  memset(o->b, 0, (size_t)o->rows * sizeof *o->b);
  shooting_rows(o);
  int rc = o->continues ? continuation_column(o) : LAG_OK;
  rc = rc ? rc : parameter_columns(o);
  rc = rc || o->half ? rc : remove_charges(o);
  rc = rc ? rc : held_rows(o);
  if (rc == LAG_OK && o->half) begin_rows(o);
  if (rc == LAG_OK && !o->continues && is_constrained(o)) rc = within_constraints(o);
  return rc || !o->continues ? rc : phase_rows(o);
}

void lag_orbit_residual(PeriodicOrbit *o) {
  int all = o->m * o->n;
  gaps(o);
  for (int k = 0; k < o->nacross && !o->half; k++) {
    double part = lag_dot(all, o->across + k * all, o->b);
    for (int r = 0; r < all; r++) o->b[r] -= part * o->across[k * all + r];
  }
  for (int k = 0; k < o->nheld; k++) o->b[all + k] = -off_by(o, k);
  for (int i = 0; i < o->n && o->half; i++) o->b[all + o->nheld + i] = -begin_gap(o, i);
  if (o->continues && o->reverse && o->pinned >= 0) o->b[all + o->nheld] = -begin_gap(o, o->pinned);
}

/* ---- Newton's steps */

/* Nodes that a step has led off the constraints return to them: what is left there would hide the residual. */
static void onto_constraints(PeriodicOrbit *o) {
  for (int k = 0; k < o->m && is_constrained(o); k++) {
    lag_sim *sim = lag_flow_sim(&o->flow, begins(o, k), o->y + k * o->n);
    if (sim && lag_sim_advance(sim, begins(o, k)) == LAG_OK)
      memcpy(o->y + k * o->n, sim->now, (size_t)o->n * sizeof *o->y);
    lag_sim_free(sim);
  }
}

/* Adds `part` of the step x to the unknowns. */
static void move(PeriodicOrbit *o, const double *x, double part) {
  int n = o->n;
  for (int i = 0; i < o->m * n; i++) o->y[i] += part * x[i] * o->unit[i % n];
  if (period_is_free(o)) o->T += part * x[column_of_period(o)] * o->time;
  for (int j = 0; j < o->ngroup; j++) o->shift[j] += part * x[column_of_shift(o, j)];
  if (o->continues) lag_orbit_set_parameter(o, o->parameter + part * x[o->cols - 1] * o->parameter_unit);
  onto_constraints(o);
}

/* A step, halved until the residual falls; *size: of the step made. 0: none does, and the unknowns stay. */
static int falling_step(PeriodicOrbit *o, double *size) {
  double before = o->residual, step = lag_largest(o->cols, o->x), T = o->T, parameter = o->parameter,
         shift[ORBIT_MOST_GROUP];
  double part = step > 0.25 ? 0.25 / step : 1, *x = o->saved + o->m * o->n, *y = o->saved;
  memcpy(y, o->y, (size_t)(o->m * o->n) * sizeof *y);
  memcpy(shift, o->shift, sizeof shift);
  memcpy(x, o->x, (size_t)o->cols * sizeof *x);
  for (int tries = 0; tries < 10; tries++, part /= 2) {
    move(o, x, part);
    int rc = o->T > 0 ? lag_orbit_shoot(o, 1) : LAG_EDOMAIN;
    *size = part * step;
    if (rc == LAG_ENOMEM) return rc;
    if (rc == LAG_OK && (o->residual < before || (o->residual < rounding && step < 1e-9))) return 1;
    memcpy(o->y, y, (size_t)(o->m * o->n) * sizeof *y);
    memcpy(o->shift, shift, sizeof shift);
    o->T = T;
    if (o->continues) lag_orbit_set_parameter(o, parameter);
    if (o->residual < 1e3 * rounding && step < 1e-9) break; /* rounding: no step helps */
  }
  int rc = lag_orbit_shoot(o, 1);
  *size = 0;
  return rc < 0 ? rc : 0;
}

/* The residual that is a solution's; at impacts, where runs differ by more than rounding, a hundred times it. */
static double accepted(const PeriodicOrbit *o) {
  return fmax((lag_flow_contacts(&o->flow) ? 100 : 1) * rounding, 1e3 * o->flow.like->tol);
}

static int newton(PeriodicOrbit *o) {
  double size = HUGE_VAL;
  int rc = lag_orbit_shoot(o, 1), rank = 0, moved = 1;
  for (int k = 0; k < MOST_STEPS && rc == LAG_OK && moved == 1; k++) {
    if (k < ORBIT_TRACE) o->trace[k] = o->residual;
    if ((rc = lag_orbit_assemble(o)) != LAG_OK) break;
    lag_singular_values(o->rows, o->cols, o->A, o->V, o->sigma);
    rank = lag_least_norm((lag_decomposed){o->rows, o->cols, o->A, o->V, o->sigma}, 1e-8, o->residual * o->residual,
                          o->b, o->x);
    if (o->residual <= accepted(o) && size < 1e-11) break;
    moved = falling_step(o, &size);
    o->steps += moved == 1;
  }
  o->nfree = o->cols - rank - o->normal;
  return rc < 0 ? rc : moved < 0 ? moved : rc == LAG_OK && o->residual <= accepted(o);
}

/* ---- Motions that are the same backwards */

/* half: T, segments and conditions become those of the first half; 0: of all again. */
static void take_half(PeriodicOrbit *o, int half) {
  double factor = half ? 0.5 : 2;
  o->half = half;
  o->m = half ? o->m / 2 : 2 * o->m;
  o->T *= factor;
  o->time *= factor;
  for (int k = 0; k < o->nheld; k++)
    if (o->held[k].kind == ORBIT_PERIOD) o->held[k].value *= factor;
  lag_orbit_count(o);
}

/* Nodes of the second half: those of the first, backwards. */
static void mirror_nodes(PeriodicOrbit *o) {
  int n = o->n, middle = o->m / 2;
  memcpy(o->y + middle * n, o->end + (middle - 1) * n, (size_t)n * sizeof *o->y);
  for (int k = 1; k < middle; k++) {
    double *y = o->y + (o->m - k) * n;
    lag_map_apply(o->reverse, o->y + k * n, y);
    for (int i = 0; i < n; i++) y[i] += o->offset[i] + o->turns[i];
  }
}

int lag_orbit_solve(PeriodicOrbit *o) {
  const double whole = 100; /* residual over that of the half, whose rounding has grown */
  if (!o->reverse) return newton(o);
  take_half(o, 1);
  int found = newton(o);
  take_half(o, 0);
  if (found != 1) return found;
  mirror_nodes(o);
  o->nfree += period_is_free(o); /* the phase */
  int rc = lag_orbit_shoot(o, 1);
  return rc ? rc : o->residual <= whole * accepted(o);
}

/* ---- Error of the period, and what kind of a motion it is */

/* Whether the motion is back already after T / k. */
static int is_back(PeriodicOrbit *o, int k) {
  double *y = o->x, T = o->T / k;
  if (o->flow.forced && (lag_flow_drive(&o->flow, &T) > 1e-9 || fabs(T * k - o->T) > 1e-6 * o->T)) return 0;
  if (lag_flow_run(&o->flow, o->flow.t0, o->T / k, o->y, y, NULL)) return 0;
  for (int i = 0; i < o->n; i++)
    if (fabs(lag_flow_change(o->flow.like->scene->model, i, y, o->y)) > 1e-6 * o->unit[i]) return 0;
  return 1;
}

/* Whether the motion goes on as the image of what it was, over events, too. */
static int goes_on(PeriodicOrbit *o) {
  const double same = 1e-6; /* small changes grow a hundredfold in a segment */
  int n = o->n;
  double *begin = o->x, *end = begin + n, *image = o->w;
  for (int k = 0; k < o->m && o->flow.like->scene->model->nev; k++) {
    lag_map_apply(o->closing, o->y + k * n, begin);
    lag_map_apply(o->closing, o->end + k * n, image);
    double t = begins(o, k) + (o->flow.forced ? o->T : 0);
    if (lag_flow_run(&o->flow, t, o->T / o->m, begin, end, NULL)) return 0;
    for (int i = 0; i < n; i++)
      if (fabs(lag_flow_change(o->flow.like->scene->model, i, end, image)) > same * o->unit[i]) return 0;
  }
  return 1;
}

/* d[n] := the direction of a symmetry by which the motion may close, at its begin, in units. */
static int group_field(PeriodicOrbit *o, const OrbitClosing *g, double *d) {
  memset(d, 0, (size_t)o->n * sizeof *d);
  if (!g->n && lag_flow_field(&o->flow, g->charge, o->flow.t0, o->y, d)) return 0;
  for (int i = 0; i < g->n; i++) d[g->shifted[i]] = 1;
  for (int i = 0; i < o->n; i++) d[i] /= o->unit[i];
  return 1;
}

/* Rates that are left over a period, in units, without the parts along directions of symmetries. */
static double own_motion(PeriodicOrbit *o, int symmetries) {
  int n = o->n;
  double *rates = o->x, *W = o->saved;
  if (lag_flow_rates(&o->flow, o->flow.t0, o->y, rates)) return HUGE_VAL;
  for (int i = 0; i < n; i++) rates[i] *= o->T / o->unit[i];
  for (int j = 0, found = 0; j < symmetries; j++) {
    double *w = W + found * n;
    if (!group_field(o, &o->group[j], w) || !orthogonal_unit(n, found, W, w)) continue;
    double part = lag_dot(n, w, rates);
    for (int i = 0; i < n; i++) rates[i] -= part * w[i];
    found++;
  }
  return lag_largest(n, rates);
}

int lag_orbit_refine(PeriodicOrbit *o) {
  lag_sim *like = o->flow.like;
  double tol = like->tol, T = o->T, *step = o->x;
  o->at_rest = !o->flow.forced && own_motion(o, 0) < 1e-6;
  o->steady = !o->flow.forced && !o->at_rest && o->ngroup && own_motion(o, o->ngroup) < 1e-6;
  o->asymmetric = o->closing && !goes_on(o);
  for (int k = 2; k <= 7 && !o->ngroup && !o->closing && !o->at_rest; k++)
    if (is_back(o, k)) o->repeats = k;
  like->tol = like->pb.tol = fmax(tol / 100, 1e-15);
  if (like->tol == tol || lag_flow_contacts(&o->flow)) like->tol = like->pb.tol = 100 * tol;
  int rc = lag_orbit_shoot(o, 1);
  if (rc && like->tol < tol) { /* rounding, as of steps between two events that are near */
    like->tol = like->pb.tol = 100 * tol;
    rc = lag_orbit_shoot(o, 1);
  }
  rc = rc ? rc : lag_orbit_assemble(o);
  if (rc == LAG_OK) {
    lag_singular_values(o->rows, o->cols, o->A, o->V, o->sigma);
    lag_least_norm((lag_decomposed){o->rows, o->cols, o->A, o->V, o->sigma}, 1e-8, 0, o->b, step);
    o->period_error = period_is_free(o) ? fmax(fabs(step[column_of_period(o)]) * o->time, 4 * DBL_EPSILON * T) : 0;
    if (like->tol < tol) move(o, step, 1);
  }
  if (like->tol > tol) like->tol = like->pb.tol = tol;
  rc = rc ? rc : lag_orbit_shoot(o, 1);
  like->tol = like->pb.tol = tol;
  return rc;
}
