/* Fits (fit.h). Enters: data and first values; leaves: values, standard errors, correlations, and the combinations that
 * data do not determine. Holds: residuals and their derivatives come from one run with sensitivities; a value with a
 * declared sign keeps it; a motion that fails on the way is a step refused. Records are fitted from short to long, so
 * that the first guess of a frequency may be off by more than one turn over the whole record. */
#include "analysis/fit.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/fit_residuals.h"
#include "numeric/magnitudes.h"
#include "numeric/release.h"

/* ---- The search */

/* The largest column of J at x. */
static int stiffness(Fit *f, const double *x, double *largest) {
  int m = f->nvalues, n = f->n;
  double *J = malloc((size_t)((m + n) * n) * sizeof *J);
  f->pull = 0;
  int rc = J ? lag_fit_residuals(f, x, NULL, J) : lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  *largest = 0;
  for (int j = 0; j < n && rc == LAG_OK; j++) {
    double sum = 0;
    for (int i = 0; i < m; i++) sum += J[i * n + j] * J[i * n + j];
    *largest = fmax(*largest, sqrt(sum));
  }
  free(J);
  return rc;
}

void lag_fit_leave_bounds(const Fit *f, double *x) {
  for (int j = 0; j < f->n; j++)
    if (abs(f->target[j].sign) == 2 && x[j] < 0) x[j] = 0;
}

/* A search with springs a millionth as stiff as the best determined direction, repeated from where it ends (the
 * proximal point method), so that they leave no trace in what data determine. */
static int search(Fit *f, int part_of_rows, int most, double *x) {
  const double part = 1e-6, settled = 1e-7;
  enum { ROUNDS = 6 };
  double moved = HUGE_VAL, stiff;
  int rc = LAG_OK, m = lag_fit_count_values(f, part_of_rows);
  lag_fit_leave_bounds(f, x);
  if (f->nodes) return lag_fit_shoot(f, 0, x);
  for (int k = 0; k < ROUNDS && moved > settled && rc == LAG_OK; k++) {
    int steps = 0;
    memcpy(f->centre, x, (size_t)f->n * sizeof *x);
    if ((rc = stiffness(f, x, &stiff)) != 0) return rc;
    f->pull = part * stiff;
    rc = f->by->minimise(m + f->n, f->n, x, lag_fit_residuals, f, most, &steps);
    f->steps += steps;
    f->converged = rc == LAG_OK;
    moved = 0;
    for (int j = 0; j < f->n; j++) moved = fmax(moved, fabs(x[j] - f->centre[j]));
  }
  return rc == LAG_EMETHOD ? LAG_OK : rc;
}

/* Fits an eighth, a quarter and a half of the record first, as far as they have three values a target. */
static int search_from_short(Fit *f, double *x) {
  const int shorter_steps = 15;
  int rc = LAG_OK;
  for (int part = 8; part > 1 && rc == LAG_OK; part /= 2)
    if (lag_fit_count_values(f, part) >= 3 * f->n + f->ncolumns) rc = search(f, part, shorter_steps, x);
  return rc ? rc : search(f, 1, f->most, x);
}

/* ---- Errors of columns that were not given */

/* Deviation of a column from its mean; 1 where it is constant. */
static double spread_of(const Fit *f, int c) {
  double sum = 0, squares = 0;
  int n = 0;
  for (int i = 0; i < f->nrows; i++) {
    double x = f->data[i * f->ncolumns + c];
    if (isnan(x)) continue;
    n++;
    sum += x;
    squares += x * x;
  }
  if (!isfinite(squares)) return HUGE_VAL;
  double mean = n ? sum / n : 0, variance = n ? squares / n - mean * mean : 0;
  return variance > 1e-12 * mean * mean ? sqrt(variance) : mean != 0.0 ? fabs(mean) : 1;
}

/* Size of the residuals of column c: root of the mean square; with Huber's loss 1.48 times the median size. */
static double residual_size(const Fit *f, int c) {
  double *size = malloc((size_t)(f->nrows + 1) * sizeof *size), sum = 0;
  int n = 0;
  for (int i = 0; i < f->nrows && size; i++) {
    double r = f->model[i * f->ncolumns + c] - f->data[i * f->ncolumns + c];
    if (isnan(r)) continue;
    size[n++] = fabs(r);
    sum += r * r;
  }
  double share = f->freedom > 0 ? f->freedom / f->nvalues : 1, result = n ? sqrt(sum / (n * share)) : 1;
  if (f->huber && n) {
    qsort(size, (size_t)n, sizeof *size, lag_ascending);
    result = 1.4826 * size[n / 2];
  }
  free(size);
  return result;
}

/* Sets the errors that were not given to the sizes of their residuals; returns the largest relative change. */
static double adapt_errors(Fit *f, const int *given) {
  double change = 0;
  for (int c = 0; c < f->ncolumns; c++) {
    if (given[c]) continue;
    double now = fmax(residual_size(f, c), 1e-14 * spread_of(f, c));
    change = fmax(change, fabs(log(now / f->column[c].sigma)));
    f->column[c].sigma = now;
  }
  return change;
}

/* ---- Statistics */

/* Wald and Wolfowitz: runs of residuals with one sign. */
static void test_runs(Fit *f, int c) {
  FitColumn *k = &f->column[c];
  int above = 0, below = 0, last = 0;
  double squares = 0;
  k->runs = 0;
  for (int i = 0; i < f->nrows; i++) {
    double r = f->data[i * f->ncolumns + c] - f->model[i * f->ncolumns + c];
    if (isnan(r)) continue;
    int sign = r > 0 ? 1 : -1;
    squares += r * r;
    above += sign > 0;
    below += sign < 0;
    k->runs += sign != last;
    last = sign;
  }
  double n = above + below, product = 2.0 * above * below;
  k->n = (int)n;
  k->rms = n > 0 ? sqrt(squares / n) : 0;
  k->exact = k->rms <= 1e-10 * spread_of(f, c);
  k->runs_expected = n > 0 ? product / n + 1 : 0;
  k->runs_deviation = n > 1 && product > n ? sqrt(product * (product - n) / (n * n * (n - 1))) : 0;
  double far = k->runs_deviation > 0 ? (k->runs - k->runs_expected) / k->runs_deviation : 0;
  k->runs_chance = erfc(fabs(far) / sqrt(2));
}

/* Whether the motion stays the same where values move along direction v: all by factors, or all by shifts. */
static int is_flat_far_away(Fit *f, const double *v, int product, const double *model) {
  const double far = 0.05, same = 1e-6;
  double *kept = malloc((size_t)f->n * sizeof *kept), largest = 0, size = 0;
  int many = f->nrows * f->ncolumns;
  if (!kept) return 0;
  for (int j = 0; j < f->n; j++) {
    FitTarget *t = &f->target[j];
    kept[j] = t->value;
    t->value = product ? t->value * exp(far * v[j]) : t->value + far * v[j] * t->scale;
  }
  int rc = lag_fit_run_rows(f, kept, NULL, NULL);
  for (int i = 0; i < many && rc == LAG_OK; i++) {
    largest = fmax(largest, fabs(f->model[i] - model[i]));
    size = fmax(size, fabs(model[i]));
  }
  for (int j = 0; j < f->n; j++) f->target[j].value = kept[j];
  free(kept);
  return rc == LAG_OK && largest <= same * size;
}

/* Rows d[m n] that span flat directions := a basis with as few entries as elimination gives, each with largest entry 1.
 */
static void simplify_directions(int m, int n, double *d) {
  const double negligible = 1e-5;
  for (int k = 0; k < m; k++) {
    int pivot = 0;
    for (int j = 1; j < n; j++)
      if (fabs(d[k * n + j]) > fabs(d[k * n + pivot])) pivot = j;
    double by = d[k * n + pivot];
    for (int j = 0; j < n; j++) d[k * n + j] /= by;
    for (int i = 0; i < m; i++) {
      double times = d[i * n + pivot];
      for (int j = 0; j < n && i != k; j++) d[i * n + j] -= times * d[k * n + j];
    }
  }
  for (int k = 0; k < m; k++) {
    double largest = 0;
    for (int j = 0; j < n; j++) largest = fabs(d[k * n + j]) > fabs(largest) ? d[k * n + j] : largest;
    for (int j = 0; j < n; j++) d[k * n + j] = fabs(d[k * n + j] / largest) > negligible ? d[k * n + j] / largest : 0;
  }
}

/* Directions of V that belong to singular values of rounding. */
static int note_flat(Fit *f, const double *V) {
  const double rounding = 1e-8;
  size_t many = (size_t)(f->nrows * f->ncolumns);
  int n = f->n;
  for (int k = 0; k < n; k++) f->nflat += f->singular[k] <= rounding;
  f->flat = calloc((size_t)n, sizeof *f->flat);
  f->directions = calloc((size_t)(n * n), sizeof *f->directions);
  double *model = malloc(many * sizeof *model);
  if (!f->flat || !f->directions || !model) return free(model), lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  memcpy(model, f->model, many * sizeof *model);
  for (int k = 0; k < f->nflat; k++)
    for (int j = 0; j < n; j++) f->directions[k * n + j] = V[j * n + n - f->nflat + k];
  simplify_directions(f->nflat, n, f->directions);
  if (f->nflat < n) {
    double *weakest = f->directions + f->nflat * n;
    for (int j = 0; j < n; j++) weakest[j] = V[j * n + n - f->nflat - 1];
    simplify_directions(1, n, weakest);
    f->weakest.change = weakest;
  }
  for (int k = 0; k < f->nflat; k++) {
    FitDirection *d = &f->flat[k];
    d->change = f->directions + k * n;
    for (int j = 0; j < n; j++) f->target[j].flat |= d->change[j] != 0.0;
    d->product = is_flat_far_away(f, d->change, 1, model);
    d->shift = !d->product && is_flat_far_away(f, d->change, 0, model);
  }
  memcpy(f->model, model, many * sizeof *model);
  free(model);
  return LAG_OK;
}

/* Covariance from J = U S V^T in units of scale: sum over directions that are not flat of v v^T/s^2. */
static void take_errors(Fit *f, const double *V, const double *s, double *covariance) {
  int n = f->n;
  double times = f->known_errors || !(f->freedom > 0) ? 1 : f->chi_squared / f->freedom;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      double sum = 0;
      for (int k = 0; k < n - f->nflat; k++) sum += V[i * n + k] * V[j * n + k] / (s[k] * s[k]);
      covariance[i * n + j] = times * sum;
    }
  for (int i = 0; i < n; i++) {
    FitTarget *t = &f->target[i];
    t->error = t->flat ? NAN : t->scale * sqrt(covariance[i * n + i]);
    for (int j = 0; j < n; j++)
      f->correlation[i * n + j] = t->flat || f->target[j].flat
                                      ? NAN
                                      : covariance[i * n + j] / sqrt(covariance[i * n + i] * covariance[j * n + j]);
  }
}

/* Scales for the directions: values, so that directions are relative changes; of a value near 0, or on its bound 0, its
 * first scale. */
static void take_scales(Fit *f, int rows, double *J, const double *slope) {
  for (int j = 0; j < f->n; j++) {
    FitTarget *t = &f->target[j];
    double size = fabs(t->value), near = abs(t->sign) == 2 ? lag_fit_softened(t) : 1e-6 * t->scale;
    t->scale = size > near ? size : t->scale;
    for (int i = 0; i < rows; i++) J[i * f->n + j] *= t->scale / slope[j];
  }
}

static int take_statistics(Fit *f, const double *x) {
  int m = lag_fit_count_values(f, 1), n = f->n, rows = f->nodes ? n : m, width = lag_fit_width(f);
  double *r = calloc((size_t)((m + n) * (width + 1) + 2 * n * n + 2 * n), sizeof *r);
  f->correlation = calloc((size_t)(n * n), sizeof *f->correlation);
  f->singular = calloc((size_t)n, sizeof *f->singular);
  if (!r || !f->correlation || !f->singular) return free(r), lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  double *J = r + m + n, *V = J + (m + n) * width, *covariance = V + n * n, *s = covariance + n * n, *slope = s + n;
  memcpy(f->centre, x, (size_t)n * sizeof *x);
  f->pull = 0;
  int rc = lag_fit_residuals(f, x, r, J);
  lag_fit_take_values(f, x, slope);
  if (rc == LAG_OK) {
    f->chi_squared = 0;
    for (int i = 0; i < m; i++) f->chi_squared += r[i] * r[i];
    for (int c = 0; c < f->ncolumns; c++) test_runs(f, c);
    if (f->nodes) rc = lag_fit_eliminate(f, r, J, V), memcpy(J, V, (size_t)(n * n) * sizeof *J);
    take_scales(f, rows, J, slope);
    rc = rc ? rc : f->by->singular_values(rows, n, J, s, V);
  }
  for (int k = 0; k < n && rc == LAG_OK; k++) f->singular[k] = s[0] > 0 ? s[k] / s[0] : 0;
  rc = rc ? rc : note_flat(f, V);
  f->freedom = m - (n - f->nflat);
  if (rc == LAG_OK) take_errors(f, V, s, covariance);
  free(r);
  return rc;
}

/* ---- The fit */

/* The motions at the first values: they have to reach their last rows. */
static int run_first(Fit *f) {
  f->part = 1;
  int rc = lag_fit_run_rows(f, NULL, NULL, NULL);
  f->steps_of_first = f->steps_of_run + 1;
  return rc;
}

static int make_room(Fit *f) {
  f->mine = calloc((size_t)f->n + 1, sizeof *f->mine);
  lag_sim *sim = f->mine ? lag_fit_simulation(f, 0, -1, 1) : NULL;
  if (!sim) return f->mine ? LAG_EINVAL : lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  size_t state = (size_t)(2 * lag_sim_scene(sim)->model->nq + lag_sim_scene(sim)->model->nz),
         nout = (size_t)lag_sim_noutputs(sim), n = (size_t)f->n;
  f->y = calloc(state * (n + state) + 1, sizeof *f->y);
  f->row = calloc(nout + 1, sizeof *f->row);
  f->D = calloc(nout * (n + state) + 1, sizeof *f->D);
  f->centre = calloc(n + 1, sizeof *f->centre);
  f->model = calloc((size_t)(f->nrows * f->ncolumns) + 1, sizeof *f->model);
  lag_sim_free(sim);
  return f->y && f->row && f->D && f->model && f->centre ? LAG_OK : lag_fit_fail(f, LAG_ENOMEM, "out of memory");
}

/* Searches, and repeats with errors adapted to the residuals until these agree. */
static int search_with_errors(Fit *f, double *x, const int *given) {
  const double settled = 0.01;
  enum { ROUNDS = 12 };
  int rc = f->nodes ? lag_fit_shoot(f, 1, x) : search_from_short(f, x), all = 1;
  for (int c = 0; c < f->ncolumns; c++) all &= given[c];
  f->freedom = f->nvalues - f->n;
  int adapts = !all && (f->ncolumns > 1 || f->huber || f->nvalues > f->n);
  for (int k = 0; k < ROUNDS && adapts && rc == LAG_OK; k++) {
    if ((rc = lag_fit_residuals(f, x, NULL, NULL)) != 0) break; /* the motion at x */
    double change = adapt_errors(f, given);
    if (change < settled || (f->ncolumns == 1 && !f->huber)) break;
    rc = search(f, 1, f->most, x);
  }
  return rc;
}

/* Coordinates and errors of the begin. */
static void begin_again(Fit *f, double *x, const int *given) {
  for (int c = 0; c < f->ncolumns; c++)
    if (!given[c]) f->column[c].sigma = spread_of(f, c);
  for (int j = 0; j < f->n; j++) {
    f->target[j].value = f->target[j].begin;
    x[j] = lag_fit_coordinate(&f->target[j], f->target[j].begin);
  }
}

/* From the begin with several parts, where a search in one part has failed; if that fails, too, the result of the first
 * one stands. */
static int search_in_parts(Fit *f, double *x, const int *given) {
  double *kept = malloc((size_t)f->n * sizeof *kept);
  if (!kept) return lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  memcpy(kept, x, (size_t)f->n * sizeof *x);
  begin_again(f, x, given);
  int rc = lag_fit_place_nodes(f, 1);
  if (rc == LAG_OK && f->nodes) rc = search_with_errors(f, x, given);
  if (rc || !f->converged) {
    lag_fit_nodes_free(f);
    memcpy(x, kept, (size_t)f->n * sizeof *x);
    rc = search_with_errors(f, x, given);
  }
  free(kept);
  return rc;
}

int lag_fit(Fit *f) {
  double *x = malloc((size_t)f->n * sizeof *x);
  int *given = calloc((size_t)f->ncolumns, sizeof *given), rc = x && given ? LAG_OK : LAG_ENOMEM, n = f->n;
  f->known_errors = 1;
  for (int c = 0; c < f->ncolumns && rc == LAG_OK; c++) {
    given[c] = f->column[c].per_row || f->column[c].sigma > 0;
    f->known_errors &= given[c];
    const double spread = spread_of(f, c), error = f->column[c].sigma > 0 ? f->column[c].sigma : 1;
    const int small = isfinite(spread) && !isfinite(spread / error * (spread / error));
    const int large = 1 / error / error < DBL_MIN;
    if (isfinite(spread) && !small && !large) continue;
    snprintf(f->why, sizeof f->why, "%s of %s are too %s to be squared: check them, and their unit",
             small || large ? "the errors" : "the values", f->column[c].label, small ? "small" : "large");
    rc = LAG_EINVAL;
  }
  if (rc == LAG_OK) begin_again(f, x, given);
  if (rc == LAG_OK && lag_fit_count_values(f, 1) < n && !f->trains) {
    snprintf(f->why, sizeof f->why, "%d value%s cannot determine %d quantities; fit fewer, or give more data",
             f->nvalues, f->nvalues == 1 ? "" : "s", n);
    rc = LAG_EINVAL;
  }
  rc = rc ? rc : make_room(f);
  rc = rc ? rc : run_first(f);
  if (rc == LAG_OK && f->trains) {
    rc = lag_fit_train(f, x);
    for (int c = 0; c < f->ncolumns && rc == LAG_OK; c++) test_runs(f, c);
  } else {
    rc = rc ? rc : lag_fit_place_nodes(f, 0);
    rc = rc ? rc : search_with_errors(f, x, given);
    if (rc == LAG_OK && !f->converged && !f->nodes) rc = search_in_parts(f, x, given);
    rc = rc ? rc : take_statistics(f, x);
  }
  lag_free_all(x, given);
  return rc;
}

void lag_fit_free(Fit *f) {
  lag_fit_nodes_free(f);
  lag_free_all(f->mine, f->directions, f->flat, f->correlation, f->singular, f->model, f->y, f->row, f->D, f->centre);
}

/* ---- For profiles */

int lag_fit_search(Fit *f, double *x) { return search(f, 1, f->most, x); }

int lag_fit_squares(Fit *f, const double *x, double *chi_squared) {
  int m = lag_fit_count_values(f, 1);
  double *r = calloc((size_t)(m + f->n), sizeof *r);
  memcpy(f->centre, x, (size_t)f->n * sizeof *x);
  int rc = r ? lag_fit_residuals(f, x, r, NULL) : lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  *chi_squared = 0;
  for (int i = 0; i < m && rc == LAG_OK; i++) *chi_squared += r[i] * r[i];
  free(r);
  return rc;
}
