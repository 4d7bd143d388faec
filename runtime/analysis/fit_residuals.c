/* Residuals of a fit (fit_residuals.h): one run with sensitivities for each part of a record. */
#include "analysis/fit_residuals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

static const double huber_bound = 1.345; /* errors; 95 % efficient for normal ones */

/* ---- Coordinates of the search: logarithms of values with a sign, others in units of their scale */

double lag_fit_softened(const FitTarget *t) { return 1e-3 * t->scale; }

/* A value "> 0" is exp(x); one ">= 0" is about scale x where that is
 * positive, and above 0 everywhere. */
double lag_fit_value_at(const FitTarget *t, double x, double *slope) {
  double side = t->sign < 0 ? -1 : 1;
  if (abs(t->sign) == 1) {
    double value = side * exp(x);
    *slope = value;
    return value;
  }
  if (abs(t->sign) == 2) {
    double u = t->scale * x, s = lag_fit_softened(t), root = sqrt(u * u + 4 * s * s);
    *slope = side * t->scale * (1 + u / root) / 2;
    return side * (u > 0 ? (u + root) / 2 : 2 * s * s / (root - u));
  }
  *slope = t->scale;
  return t->scale * x;
}

double lag_fit_coordinate(const FitTarget *t, double value) {
  double s = lag_fit_softened(t), size = fmax(fabs(value), s);
  if (abs(t->sign) == 1) return log(fabs(value));
  return abs(t->sign) == 2 ? (size - s * s / size) / t->scale : value / t->scale;
}

void lag_fit_take_values(Fit *f, const double *x, double *slope) {
  for (int j = 0; j < f->n; j++) f->target[j].value = lag_fit_value_at(&f->target[j], x[j], &slope[j]);
}

/* ---- Residuals of one run */

int lag_fit_fail(Fit *f, int status, const char *why) {
  snprintf(f->why, sizeof f->why, "%s", why);
  return status;
}

/* Ends a run that takes far more steps than the first: values far from those at the begin. */
static int count_step(void *fit, const lag_sim *sim) {
  Fit *f = fit;
  (void)sim;
  f->steps_of_run++;
  return f->steps_of_first > 0 && f->steps_of_run > 50 * f->steps_of_first + 1000;
}

/* Names of the columns of a run of record k: targets, to f->mine; of a part that begins at a node, the parameters
 * among them, and behind them all components of its state. Returns their number. */
static int name_columns(Fit *f, const lag_sim *sim, int k, int node, const char **name, char (*state)[96]) {
  int n = f->nmine = 0, ns = node < 0 ? 0 : f->nodes->ns;
  for (int j = 0; j < f->n; j++) {
    const FitTarget *t = &f->target[j];
    if ((t->record && t->record != k + 1) || (node >= 0 && t->is_start)) continue;
    name[n++] = t->name;
    f->mine[f->nmine++] = j;
  }
  for (int i = 0; i < ns; i++) {
    lag_sim_state_info(sim, i, state[i], sizeof state[i], NULL, 0);
    name[n++] = state[i];
  }
  return n;
}

/* The part begins with the state and at the time of a node. */
static void start_at_node(Fit *f, lag_sim *sim, int node) {
  FitNodes *w = f->nodes;
  w->scene = *sim->scene;
  w->scene.t0 = f->t[w->row[node]];
  sim->scene = &w->scene;
  memcpy(sim->start, w->y + node * w->ns, (size_t)w->ns * sizeof *w->y);
}

lag_sim *lag_fit_simulation(Fit *f, int k, int node, int sensitive) {
  lag_sim *sim = f->fresh(f->context);
  size_t ns = node < 0 ? 0 : (size_t)f->nodes->ns;
  const char **name = calloc((size_t)f->n + ns + 1, sizeof *name);
  char(*state)[96] = calloc(ns + 1, sizeof *state);
  int rc = sim && name && state ? LAG_OK : LAG_ENOMEM, n = rc ? 0 : name_columns(f, sim, k, node, name, state);
  for (int q = 0; q < f->nmine && rc == LAG_OK; q++)
    rc = lag_sim_set(sim, f->target[f->mine[q]].name, f->target[f->mine[q]].value);
  if (rc == LAG_OK && node >= 0) start_at_node(f, sim, node);
  if (rc == LAG_OK && sensitive && n) rc = lag_sim_set_sensitivity(sim, n, name);
  free(name);
  free(state);
  if (rc == LAG_OK) {
    f->steps_of_run = 0;
    lag_sim_on_step(sim, count_step, f);
    return sim;
  }
  lag_fit_fail(f, rc, sim ? lag_sim_message(sim) : "out of memory");
  lag_sim_free(sim);
  return NULL;
}

int lag_fit_end_row(const Fit *f, int k) {
  const FitNodes *w = f->nodes;
  int first = f->first[k], end = f->first[k + 1], parts = 0;
  if (!w) return first + (end - first) / f->part;
  for (int i = first; i < end; i++)
    if (w->at[i] >= 0 && ++parts == w->active) return i;
  return end;
}

int lag_fit_part_end(const Fit *f, int i, int end) {
  for (i++; i < end && !(f->nodes && f->nodes->at[i] >= 0); i++) continue;
  return i;
}

int lag_fit_width(const Fit *f) { return f->n + (f->nodes ? f->nodes->ns : 0); }

static double error_of(const Fit *f, int i, int c) {
  return f->column[c].per_row ? f->errors[i * f->ncolumns + c] : f->column[c].sigma;
}

/* Weight of a residual r in units of its error: sqrt(2 rho(r))/r, and the derivative of sqrt(2 rho). */
static double loss(const Fit *f, double r, double *slope) {
  double size = fabs(r);
  *slope = 1;
  if (!f->huber || size <= huber_bound) return r;
  double bent = sqrt(huber_bound * (2 * size - huber_bound));
  *slope = huber_bound / bent;
  return copysign(bent, r);
}

/* to[targets, state of a node] := times the derivatives d of a run's columns, by coordinates and units of nodes. */
static void put_columns(const Fit *f, const double *d, int columns, const double *slope, double times, double *to) {
  memset(to, 0, (size_t)lag_fit_width(f) * sizeof *to);
  for (int q = 0; q < f->nmine; q++) {
    int j = f->mine[q];
    to[j] = times * d[q] * f->target[j].factor * slope[j];
  }
  for (int i = f->nmine; i < columns; i++) to[f->n + i - f->nmine] = times * d[i] * f->nodes->unit[i - f->nmine];
}

double lag_fit_residual(const Fit *f, int i, int c, double got, double *slope) {
  double error = error_of(f, i, c), want = f->data[i * f->ncolumns + c], r = loss(f, (got - want) / error, slope);
  f->model[i * f->ncolumns + c] = got;
  *slope /= error;
  return r;
}

/* Where residuals go: r and their derivatives J, NULL where they are not wanted; `at` of them are there. */
typedef struct {
  const double *slope; /* of values by coordinates */
  double *r, *J;
  int at;
} Residuals;

/* Residuals of row i from the outputs f->row, and their derivatives from f->D by the declared units of targets. */
static void put_row(Fit *f, int i, int columns, Residuals *to) {
  for (int c = 0; c < f->ncolumns; c++) {
    double by, bent = lag_fit_residual(f, i, c, f->row[f->column[c].output], &by);
    if (isnan(f->data[i * f->ncolumns + c])) continue;
    if (to->r) to->r[to->at] = bent;
    if (to->J)
      put_columns(f, f->D + f->column[c].output * columns, columns, to->slope, by, to->J + to->at * lag_fit_width(f));
    to->at++;
  }
}

/* Residuals of priors behind the others. */
static void put_priors(const Fit *f, Residuals *to) {
  int width = lag_fit_width(f);
  for (int k = 0; k < f->n; k++) {
    const FitTarget *t = &f->target[k];
    if (!(t->prior_error > 0)) continue;
    if (to->r) to->r[to->at] = (t->value - t->prior) / t->prior_error;
    for (int j = 0; j < width && to->J; j++)
      to->J[to->at * width + j] = j == k ? to->slope[j] / t->prior_error : 0;
    to->at++;
  }
}

int lag_fit_advance(Fit *f, lag_sim *sim, double t) {
  int rc = t > lag_sim_time(sim) ? lag_sim_advance(sim, t) : LAG_OK;
  if (rc <= 0) return rc ? lag_fit_fail(f, rc, lag_sim_message(sim)) : LAG_OK;
  snprintf(f->why, sizeof f->why, "the motion ends at t = %g s, before the data do", lag_sim_time(sim));
  return LAG_EDOMAIN;
}

/* Runs a part of record k over rows i to end. */
static int run_part(Fit *f, lag_sim *sim, int i, int end, Residuals *to) {
  int columns = sim->tangent_columns, rc = LAG_OK;
  for (; i < end && rc == LAG_OK; i++) {
    rc = lag_fit_advance(f, sim, f->t[i]);
    if (rc) return rc;
    rc = lag_sim_outputs(sim, f->row);
    if (rc == LAG_OK && columns) rc = lag_sim_tangent(sim, f->y);
    if (rc == LAG_OK && columns) rc = lag_sim_output_sensitivity(sim, f->y, f->D);
    if (rc == LAG_OK) put_row(f, i, columns, to);
  }
  return rc ? lag_fit_fail(f, rc, lag_sim_message(sim)) : LAG_OK;
}

/* The gap before a node, and its derivatives. A node that does not count yet is set to the end of the run. */
static int meet_node(Fit *f, lag_sim *sim, int node, int counts, const double *slope, int derives) {
  FitNodes *w = f->nodes;
  int ns = w->ns, columns = sim->tangent_columns, rc = lag_fit_advance(f, sim, f->t[w->row[node]]);
  double *y = w->y + node * ns, *gap = w->gap + node * ns;
  if (rc == LAG_OK && derives && columns && (rc = lag_sim_tangent(sim, f->y)) != 0)
    return lag_fit_fail(f, rc, lag_sim_message(sim));
  for (int i = 0; i < ns && rc == LAG_OK; i++) {
    double end = lag_sim_state_value(sim, i);
    if (!counts) y[i] = end;
    gap[i] = (end - y[i]) / w->unit[i];
    if (derives)
      put_columns(f, f->y + i * columns, columns, slope, 1 / w->unit[i], w->by + (node * ns + i) * lag_fit_width(f));
  }
  return rc;
}

/* The motion of record k over its rows that count, part by part. */
static int run_record(Fit *f, int k, Residuals *to, double *steps) {
  int rc = LAG_OK, end = lag_fit_end_row(f, k);
  for (int i = f->first[k], next = i; i < end && rc == LAG_OK; i = next) {
    lag_sim *sim = lag_fit_simulation(f, k, f->nodes ? f->nodes->at[i] : -1, to->J != NULL);
    next = lag_fit_part_end(f, i, end);
    rc = sim ? run_part(f, sim, i, next, to) : LAG_EINVAL;
    if (rc == LAG_OK && f->nodes && next < f->first[k + 1])
      rc = meet_node(f, sim, f->nodes->at[next], next < end, to->slope, to->J != NULL);
    lag_sim_free(sim);
    *steps = fmax(*steps, f->steps_of_run);
  }
  return rc;
}

int lag_fit_run_rows(Fit *f, const double *slope, double *r, double *J) {
  Residuals to = {slope, r, J, 0};
  int rc = LAG_OK;
  double most = 0;
  for (int k = 0; k < f->nrecords && rc == LAG_OK; k++) rc = run_record(f, k, &to, &most);
  f->steps_of_run = most;
  if (rc == LAG_OK) put_priors(f, &to);
  return rc;
}

/* Springs to f->centre in the last n residuals, without which rounding would move the search far along directions that
 * data do not feel; -1: x is so far away that no motion is tried. */
static int put_springs(const Fit *f, const double *x, double *r, double *J) {
  const double farthest = 8, stiff = 1e10; /* logarithms, or scales; of a spring that holds, beside weak ones */
  int at = f->nvalues, width = lag_fit_width(f);
  for (int k = 0; k < f->n; k++) {
    int held = k + 1 == f->held;
    double pull = held ? stiff * f->pull : f->pull, centre = held ? f->held_at : f->centre[k];
    if (!(fabs(x[k] - f->centre[k]) < farthest)) return -1;
    if (r) r[at + k] = pull * (x[k] - centre);
    for (int j = 0; j < width && J; j++) J[(at + k) * width + j] = j == k ? pull : 0;
  }
  return 0;
}

int lag_fit_residuals(void *fit, const double *x, double *r, double *J) {
  Fit *f = fit;
  double *slope = malloc((size_t)(f->n + 1) * sizeof *slope);
  if (!slope) return lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  if (put_springs(f, x, r, J)) return free(slope), LAG_EDOMAIN;
  lag_fit_take_values(f, x, slope);
  int rc = lag_fit_run_rows(f, slope, r, J), m = f->nvalues;
  for (int i = 0; i < m && rc == LAG_OK && r; i++)
    if (!isfinite(r[i])) rc = lag_fit_fail(f, LAG_ENAN, "an output has no value on the way");
  f->evaluations++;
  free(slope);
  return rc;
}

int lag_fit_count_values(Fit *f, int part) {
  int m = 0;
  f->part = part;
  for (int k = 0; k < f->nrecords; k++) {
    int first = f->first[k] * f->ncolumns, end = lag_fit_end_row(f, k) * f->ncolumns;
    for (int i = first; i < end; i++) m += !isnan(f->data[i]);
  }
  for (int j = 0; j < f->n; j++) m += f->target[j].prior_error > 0;
  return f->nvalues = m;
}

