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

static const double huber_bound = 1.345; /* errors; 95 % efficient for normal ones */

/* ---- Coordinates of the search: logarithms of values with a sign, others in units of their scale */

static double softened(const FitTarget *t) { return 1e-3 * t->scale; }

/* The value at coordinate x, and its derivative. A value "> 0" is exp(x); one ">= 0" is about scale x where that is
 * positive, and above 0 everywhere. */
static double value_at(const FitTarget *t, double x, double *slope) {
  double side = t->sign < 0 ? -1 : 1;
  if (abs(t->sign) == 1) {
    double value = side * exp(x);
    *slope = value;
    return value;
  }
  if (abs(t->sign) == 2) {
    double u = t->scale * x, s = softened(t), root = sqrt(u * u + 4 * s * s);
    *slope = side * t->scale * (1 + u / root) / 2;
    return side * (u > 0 ? (u + root) / 2 : 2 * s * s / (root - u));
  }
  *slope = t->scale;
  return t->scale * x;
}

static double coordinate_of(const FitTarget *t, double value) {
  double s = softened(t), size = fmax(fabs(value), s);
  if (abs(t->sign) == 1) return log(fabs(value));
  return abs(t->sign) == 2 ? (size - s * s / size) / t->scale : value / t->scale;
}

static void take_values(Fit *f, const double *x, double *slope) {
  for (int j = 0; j < f->n; j++) f->target[j].value = value_at(&f->target[j], x[j], &slope[j]);
}

/* ---- Residuals of one run */

static int fail(Fit *f, int status, const char *why) {
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

/* A simulation of record k with the present values; sensitive: with a column for each of its targets. */
static lag_sim *simulation(Fit *f, int k, int sensitive) {
  lag_sim *sim = f->fresh(f->context);
  const char **names = malloc(((size_t)f->n + 1) * sizeof *names);
  int rc = sim && names ? LAG_OK : LAG_ENOMEM;
  f->nmine = 0;
  for (int j = 0; j < f->n && rc == LAG_OK; j++) {
    if (f->target[j].record && f->target[j].record != k + 1) continue;
    names[f->nmine] = f->target[j].name;
    f->mine[f->nmine++] = j;
    rc = lag_sim_set(sim, f->target[j].name, f->target[j].value);
  }
  if (rc == LAG_OK && sensitive && f->nmine) rc = lag_sim_set_sensitivity(sim, f->nmine, names);
  free(names);
  if (rc == LAG_OK) {
    f->steps_of_run = 0;
    lag_sim_on_step(sim, count_step, f);
    return sim;
  }
  fail(f, rc, sim ? lag_sim_message(sim) : "out of memory");
  lag_sim_free(sim);
  return NULL;
}

/* Number of rows of record k that count. */
static int rows_of(const Fit *f, int k) { return (f->first[k + 1] - f->first[k]) / f->part; }

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

/* Residuals of row i from the outputs f->row, and their derivatives from f->D by the declared units of targets. */
static void put_row(Fit *f, int i, const double *slope, double *r, double *J, int *at) {
  for (int c = 0; c < f->ncolumns; c++) {
    double got = f->row[f->column[c].output], want = f->data[i * f->ncolumns + c], by;
    f->model[i * f->ncolumns + c] = got;
    if (isnan(want)) continue;
    double error = error_of(f, i, c), bent = loss(f, (got - want) / error, &by);
    if (r) r[*at] = bent;
    for (int j = 0; j < f->n && J; j++) J[*at * f->n + j] = 0;
    for (int q = 0; q < f->nmine && J; q++) {
      int j = f->mine[q];
      J[*at * f->n + j] = by * f->D[f->column[c].output * f->nmine + q] * f->target[j].factor * slope[j] / error;
    }
    ++*at;
  }
}

/* Residuals of priors behind the others. */
static void put_priors(const Fit *f, const double *slope, double *r, double *J, int at) {
  for (int k = 0; k < f->n; k++) {
    const FitTarget *t = &f->target[k];
    if (!(t->prior_error > 0)) continue;
    if (r) r[at] = (t->value - t->prior) / t->prior_error;
    for (int j = 0; j < f->n && J; j++) J[at * f->n + j] = j == k ? slope[j] / t->prior_error : 0;
    at++;
  }
}

/* Runs the motion of record k over its rows that count. */
static int run_record(Fit *f, int k, lag_sim *sim, const double *slope, double *r, double *J, int *at) {
  int rc = LAG_OK, first = f->first[k], derives = J && f->nmine;
  for (int i = first; i < first + rows_of(f, k) && rc == LAG_OK; i++) {
    rc = f->t[i] > lag_sim_time(sim) || i > first ? lag_sim_advance(sim, f->t[i]) : LAG_OK;
    if (rc > 0) {
      snprintf(f->why, sizeof f->why, "the motion ends at t = %g s, before the data do", lag_sim_time(sim));
      return LAG_EDOMAIN;
    }
    rc = rc ? rc : lag_sim_outputs(sim, f->row);
    if (rc == LAG_OK && derives) rc = lag_sim_tangent(sim, f->y);
    if (rc == LAG_OK && derives) rc = lag_sim_output_sensitivity(sim, f->y, f->D);
    if (rc == LAG_OK) put_row(f, i, slope, r, J, at);
  }
  return rc ? fail(f, rc, lag_sim_message(sim)) : LAG_OK;
}

/* The same of all records, and priors. */
static int run_rows(Fit *f, const double *slope, double *r, double *J) {
  int at = 0, rc = LAG_OK;
  double most = 0;
  for (int k = 0; k < f->nrecords && rc == LAG_OK; k++) {
    lag_sim *sim = simulation(f, k, J != NULL);
    rc = sim ? run_record(f, k, sim, slope, r, J, &at) : LAG_EINVAL;
    lag_sim_free(sim);
    most = fmax(most, f->steps_of_run);
  }
  f->steps_of_run = most;
  if (rc == LAG_OK) put_priors(f, slope, r, J, at);
  return rc;
}

/* Springs to f->centre in the last n residuals, without which rounding would move the search far along directions that
 * data do not feel; -1: x is so far away that no motion is tried. */
static int put_springs(const Fit *f, const double *x, double *r, double *J) {
  const double farthest = 8, stiff = 1e10; /* logarithms, or scales; of a spring that holds, beside weak ones */
  int at = f->nvalues;
  for (int k = 0; k < f->n; k++) {
    int held = k + 1 == f->held;
    double pull = held ? stiff * f->pull : f->pull, centre = held ? f->held_at : f->centre[k];
    if (!(fabs(x[k] - f->centre[k]) < farthest)) return -1;
    if (r) r[at + k] = pull * (x[k] - centre);
    for (int j = 0; j < f->n && J; j++) J[(at + k) * f->n + j] = j == k ? pull : 0;
  }
  return 0;
}

/* lag_residuals_at. */
static int residuals(void *fit, const double *x, double *r, double *J) {
  Fit *f = fit;
  double *slope = malloc((size_t)(f->n + 1) * sizeof *slope);
  if (!slope) return fail(f, LAG_ENOMEM, "out of memory");
  if (put_springs(f, x, r, J)) return free(slope), LAG_EDOMAIN;
  take_values(f, x, slope);
  int rc = run_rows(f, slope, r, J), m = f->nvalues;
  for (int i = 0; i < m && rc == LAG_OK && r; i++)
    if (!isfinite(r[i])) rc = fail(f, LAG_ENAN, "an output has no value on the way");
  f->evaluations++;
  free(slope);
  return rc;
}

/* ---- The search */

/* Values in the first 1/part of each record, and priors. */
static int count_values(Fit *f, int part) {
  int m = 0;
  f->part = part;
  for (int k = 0; k < f->nrecords; k++) {
    int first = f->first[k] * f->ncolumns, n = rows_of(f, k) * f->ncolumns;
    for (int i = first; i < first + n; i++) m += !isnan(f->data[i]);
  }
  for (int j = 0; j < f->n; j++) m += f->target[j].prior_error > 0;
  return f->nvalues = m;
}

/* The largest column of J at x. */
static int stiffness(Fit *f, const double *x, double *largest) {
  int m = f->nvalues, n = f->n;
  double *J = malloc((size_t)((m + n) * n) * sizeof *J);
  f->pull = 0;
  int rc = J ? residuals(f, x, NULL, J) : fail(f, LAG_ENOMEM, "out of memory");
  *largest = 0;
  for (int j = 0; j < n && rc == LAG_OK; j++) {
    double sum = 0;
    for (int i = 0; i < m; i++) sum += J[i * n + j] * J[i * n + j];
    *largest = fmax(*largest, sqrt(sum));
  }
  free(J);
  return rc;
}

/* Values ">= 0" that a shorter record has driven to 0, where they hardly move any more, begin again just above. */
static void leave_bounds(const Fit *f, double *x) {
  for (int j = 0; j < f->n; j++)
    if (abs(f->target[j].sign) == 2 && x[j] < 0) x[j] = 0;
}

/* A search with springs a millionth as stiff as the best determined direction, repeated from where it ends (the
 * proximal point method), so that they leave no trace in what data determine. */
static int search(Fit *f, int part_of_rows, int most, double *x) {
  const double part = 1e-6, settled = 1e-7;
  enum { ROUNDS = 6 };
  double moved = HUGE_VAL, stiff;
  int rc = LAG_OK, m = count_values(f, part_of_rows);
  leave_bounds(f, x);
  for (int k = 0; k < ROUNDS && moved > settled && rc == LAG_OK; k++) {
    int steps = 0;
    memcpy(f->centre, x, (size_t)f->n * sizeof *x);
    if ((rc = stiffness(f, x, &stiff)) != 0) return rc;
    f->pull = part * stiff;
    rc = f->by->minimise(m + f->n, f->n, x, residuals, f, most, &steps);
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
    if (count_values(f, part) >= 3 * f->n + f->ncolumns) rc = search(f, part, shorter_steps, x);
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
  double mean = n ? sum / n : 0, variance = n ? squares / n - mean * mean : 0;
  return variance > 1e-12 * mean * mean ? sqrt(variance) : mean != 0.0 ? fabs(mean) : 1;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
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
    qsort(size, (size_t)n, sizeof *size, by_size);
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
  k->runs_deviation = n > 1 ? sqrt(product * (product - n) / (n * n * (n - 1))) : 0;
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
  int rc = run_rows(f, kept, NULL, NULL);
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
  if (!f->flat || !f->directions || !model) return free(model), fail(f, LAG_ENOMEM, "out of memory");
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

/* Scales for the directions: values, so that directions are relative changes; of a value near 0 its first scale. */
static void take_scales(Fit *f, double *J, const double *slope) {
  for (int j = 0; j < f->n; j++) {
    FitTarget *t = &f->target[j];
    double size = fabs(t->value);
    t->scale = size > 1e-6 * t->scale ? size : t->scale;
    for (int i = 0; i < f->nvalues; i++) J[i * f->n + j] *= t->scale / slope[j];
  }
}

static int take_statistics(Fit *f, const double *x) {
  int m = count_values(f, 1), n = f->n;
  double *r = calloc((size_t)((m + n) * (n + 1) + 2 * n * n + 2 * n), sizeof *r);
  f->correlation = calloc((size_t)(n * n), sizeof *f->correlation);
  f->singular = calloc((size_t)n, sizeof *f->singular);
  if (!r || !f->correlation || !f->singular) return free(r), fail(f, LAG_ENOMEM, "out of memory");
  double *J = r + m + n, *V = J + (m + n) * n, *covariance = V + n * n, *s = covariance + n * n, *slope = s + n;
  memcpy(f->centre, x, (size_t)n * sizeof *x);
  f->pull = 0;
  int rc = residuals(f, x, r, J);
  take_values(f, x, slope);
  if (rc == LAG_OK) {
    f->chi_squared = 0;
    for (int i = 0; i < m; i++) f->chi_squared += r[i] * r[i];
    for (int c = 0; c < f->ncolumns; c++) test_runs(f, c);
    take_scales(f, J, slope);
    rc = f->by->singular_values(m, n, J, s, V);
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
  int rc = run_rows(f, NULL, NULL, NULL);
  f->steps_of_first = f->steps_of_run + 1;
  return rc;
}

static int make_room(Fit *f) {
  f->mine = calloc((size_t)f->n + 1, sizeof *f->mine);
  lag_sim *sim = f->mine ? simulation(f, 0, 1) : NULL;
  if (!sim) return f->mine ? LAG_EINVAL : fail(f, LAG_ENOMEM, "out of memory");
  size_t state = (size_t)(2 * lag_sim_scene(sim)->model->nq + lag_sim_scene(sim)->model->nz),
         nout = (size_t)lag_sim_noutputs(sim), n = (size_t)f->n;
  f->y = calloc(state * n + 1, sizeof *f->y);
  f->row = calloc(nout + 1, sizeof *f->row);
  f->D = calloc(nout * n + 1, sizeof *f->D);
  f->centre = calloc(n + 1, sizeof *f->centre);
  f->model = calloc((size_t)(f->nrows * f->ncolumns) + 1, sizeof *f->model);
  lag_sim_free(sim);
  return f->y && f->row && f->D && f->model && f->centre ? LAG_OK : fail(f, LAG_ENOMEM, "out of memory");
}

/* Searches, and repeats with errors adapted to the residuals until these agree. */
static int search_with_errors(Fit *f, double *x, const int *given) {
  const double settled = 0.01;
  enum { ROUNDS = 12 };
  int rc = search_from_short(f, x), all = 1;
  for (int c = 0; c < f->ncolumns; c++) all &= given[c];
  f->freedom = f->nvalues - f->n;
  int adapts = !all && (f->ncolumns > 1 || f->huber || f->nvalues > f->n);
  for (int k = 0; k < ROUNDS && adapts && rc == LAG_OK; k++) {
    if ((rc = residuals(f, x, NULL, NULL)) != 0) break; /* the motion at x */
    double change = adapt_errors(f, given);
    if (change < settled || (f->ncolumns == 1 && !f->huber)) break;
    rc = search(f, 1, f->most, x);
  }
  return rc;
}

int lag_fit(Fit *f) {
  double *x = malloc((size_t)f->n * sizeof *x);
  int *given = calloc((size_t)f->ncolumns, sizeof *given), rc = x && given ? LAG_OK : LAG_ENOMEM, n = f->n;
  f->known_errors = 1;
  for (int c = 0; c < f->ncolumns && rc == LAG_OK; c++) {
    given[c] = f->column[c].per_row || f->column[c].sigma > 0;
    f->known_errors &= given[c];
    if (!given[c]) f->column[c].sigma = spread_of(f, c);
  }
  for (int j = 0; j < n && rc == LAG_OK; j++) {
    f->target[j].value = f->target[j].begin;
    x[j] = coordinate_of(&f->target[j], f->target[j].begin);
  }
  if (rc == LAG_OK && count_values(f, 1) < n) {
    snprintf(f->why, sizeof f->why, "%d values cannot determine %d quantities; fit fewer, or give more data",
             f->nvalues, n);
    rc = LAG_EINVAL;
  }
  rc = rc ? rc : make_room(f);
  rc = rc ? rc : run_first(f);
  rc = rc ? rc : search_with_errors(f, x, given);
  rc = rc ? rc : take_statistics(f, x);
  free(x);
  free(given);
  return rc;
}

void lag_fit_free(Fit *f) {
  free(f->mine);
  free(f->directions);
  free(f->flat);
  free(f->correlation);
  free(f->singular);
  free(f->model);
  free(f->y);
  free(f->row);
  free(f->D);
  free(f->centre);
}

/* ---- For profiles */

double lag_fit_coordinate(const FitTarget *t, double value) { return coordinate_of(t, value); }

double lag_fit_value(const FitTarget *t, double x) {
  double slope;
  return value_at(t, x, &slope);
}

int lag_fit_search(Fit *f, double *x) { return search(f, 1, f->most, x); }

int lag_fit_squares(Fit *f, const double *x, double *chi_squared) {
  int m = count_values(f, 1);
  double *r = calloc((size_t)(m + f->n), sizeof *r);
  memcpy(f->centre, x, (size_t)f->n * sizeof *x);
  int rc = r ? residuals(f, x, r, NULL) : fail(f, LAG_ENOMEM, "out of memory");
  *chi_squared = 0;
  for (int i = 0; i < m && rc == LAG_OK; i++) *chi_squared += r[i] * r[i];
  free(r);
  return rc;
}
