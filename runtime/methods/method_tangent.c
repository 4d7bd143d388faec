/* The variational equations Y' = Df Y, solved by the method that integrates y: E. Hairer, S.P. Norsett, G. Wanner,
 * Solving Ordinary Differential Equations I, 2nd ed. (1993), I.14. Applied to (y, Y) an explicit Runge-Kutta method
 * yields exactly the derivative of its own step. */
#include "methods/method_tangent.h"

#include <string.h>

#include "core/rhs.h"
#include "methods/steps.h"

lag_tangent lag_tangent_layout(lag_problem *pb, int k, int products, double *scratch, double **rest) {
  int width = pb->n + (pb->by ? pb->by->n : 0);
  lag_tangent w = {pb, k, scratch, scratch + (pb->nq + pb->nz) * width, pb->by,
                   products && lag_has_listed_jacobian(pb)};
  *rest = w.linear + lag_linear_work(pb->model);
  return w;
}

/* Scratch: Jacobian, scratch of the linearisation, y and f of a stage, Y of a stage and of the result; f and its
 * derivative for each stage. */
size_t lag_tangent_size(const lag_problem *pb, int stages, int k) {
  size_t n = (size_t)pb->n, block = n * (size_t)k, width = n + (size_t)(pb->by ? pb->by->n : 0);
  return (size_t)(pb->nq + pb->nz) * width + lag_linear_work(pb->model) + 2 * n + 2 * block +
         (size_t)stages * (n + block);
}

/* Whether an element of the Jacobian is not finite. */
static int has_not_finite(const lag_tangent *w) {
  const lag_linear *l = w->pb->model->linear;
  int n = w->pb->n, width = lag_tangent_width(w), rows = w->pb->nq + w->pb->nz;
  if (!w->listed) return lag_not_finite(rows * width, w->jacobian) >= 0;
  for (int k = 0; k < l->ndr; k++)
    if (!isfinite(w->jacobian[l->dr[k].row * width + l->dr[k].col])) return 1;
  for (int i = 0; i < rows; i++)
    if (lag_not_finite(width - n, w->jacobian + i * width + n) >= 0) return 1;
  return 0;
}

int lag_tangent_at(const lag_tangent *w, double t, const double *y, double *f) {
  int n = w->pb->n, rc = (w->listed ? lag_listed_jacobian : lag_fine_jacobian)(w->pb, w->by, t, y, w->jacobian,
                                                                               w->linear);
  if (rc == LAG_EMETHOD) return lag_step_failed(w->pb, rc, t);
  if (rc) return lag_step_refused(w->pb, rc, t);
  if (f) memcpy(f, w->linear, (size_t)n * sizeof *f);
  return has_not_finite(w) ? lag_step_failed(w->pb, LAG_ENAN, t) : LAG_OK;
}

enum { AT_ONCE = 16 }; /* terms of a sum; no table has more stages */

/* The coefficients from[first ... first + n - 1] that are not 0, times dt, and their numbers; returns how many. */
static int gather(int n, int first, const double *from, double dt, double *c, int *at) {
  int some = 0;
  for (int j = first; j < first + n; j++) {
    if (from[j] == 0.0) continue;
    c[some] = dt * from[j];
    at[some++] = j;
  }
  return some;
}

/* out[m] += sum_j c_j x_j[m], in this order; the row x_j begins at x + at[j] m. Four terms in one pass over out. */
static void add_rows(int m, int count, const double *c, const int *at, const double *x, double *restrict out) {
  int j = 0;
  for (; j + 4 <= count; j += 4) {
    const double *x0 = x + at[j] * m, *x1 = x + at[j + 1] * m, *x2 = x + at[j + 2] * m, *x3 = x + at[j + 3] * m;
    const double c0 = c[j], c1 = c[j + 1], c2 = c[j + 2], c3 = c[j + 3];
    for (int i = 0; i < m; i++) out[i] = out[i] + c0 * x0[i] + c1 * x1[i] + c2 * x2[i] + c3 * x3[i];
  }
  for (; j < count; j++) lag_tangent_add(m, c[j], x + at[j] * m, out);
}

/* out[(n - nq) k] += J Y by the listed elements of J, row by row. */
static void listed_times(const lag_tangent *w, const double *Y, double *out) {
  const lag_linear *l = w->pb->model->linear;
  int k = w->k, width = lag_tangent_width(w);
  for (int e = 0, i; e < l->ndr;) {
    double c[AT_ONCE];
    int at[AT_ONCE], some = 0;
    for (i = l->dr[e].row; e < l->ndr && l->dr[e].row == i && some < AT_ONCE; e++, some++)
      c[some] = w->jacobian[i * width + l->dr[e].col], at[some] = l->dr[e].col;
    add_rows(k, some, c, at, Y, out + i * k);
  }
}

void lag_tangent_times(const lag_tangent *w, const double *Y, double *out) {
  int n = w->pb->n, nq = w->pb->nq, k = w->k, width = lag_tangent_width(w);
  memcpy(out, Y + nq * k, (size_t)(nq * k) * sizeof *out);
  memset(out + nq * k, 0, (size_t)((n - nq) * k) * sizeof *out);
  if (w->listed) listed_times(w, Y, out + nq * k);
  for (int i = 0; i < n - nq; i++) {
    const double *J = w->jacobian + i * width;
    for (int j = 0, some; j < n && !w->listed; j += AT_ONCE) {
      double c[AT_ONCE];
      int at[AT_ONCE];
      some = gather(n - j < AT_ONCE ? n - j : AT_ONCE, j, J, 1, c, at);
      add_rows(k, some, c, at, Y, out + (nq + i) * k);
    }
    for (int j = n; j < width; j++) out[(nq + i) * k + w->by->column[j - n]] += J[j];
  }
}

/* v[m] := from + dt sum_j coef_j k_j over j < count; from NULL: 0. */
static void combine(int m, int count, const double *coef, double dt, const double *from, const double *k, double *v) {
  double c[AT_ONCE];
  int at[AT_ONCE];
  if (from) memcpy(v, from, (size_t)m * sizeof *v);
  else memset(v, 0, (size_t)m * sizeof *v);
  add_rows(m, gather(count, 0, coef, dt, c, at), c, at, k, v);
}

int lag_tangent_explicit(const lag_tableau *tab, lag_step_taken step, int k, double *Y, double *scratch) {
  int n = step.pb->n, m = n * k, last = tab->stages - 1;
  double *rest;
  lag_tangent w = lag_tangent_layout(step.pb, k, 1, scratch, &rest);
  double *ys = rest, *Ys = ys + n, *f = Ys + m, *F = f + last * n; /* f[n], F[n k] of each stage */

  for (int s = 0; s <= last; s++) {
    combine(n, s, tab->a[s], step.dt, step.y, f, ys);
    combine(m, s, tab->a[s], step.dt, Y, F, Ys);
    if (s == last) break;
    int rc = lag_tangent_at(&w, step.t0 + tab->c[s] * step.dt, ys, f + s * n);
    if (rc) return rc;
    lag_tangent_times(&w, Ys, F + s * m);
  }
  memcpy(Y, Ys, (size_t)m * sizeof *Y);
  return LAG_OK;
}

/* Scratch: Jacobian of a stage; right-hand sides, a column, pivots, row scales and the matrix of all stages
 * together. */
size_t lag_tangent_implicit_size(const lag_problem *pb, int stages, int k) {
  size_t big = (size_t)(stages * pb->n);
  return lag_tangent_size(pb, 0, k) + big * ((size_t)k + 3 + big);
}

void lag_tangent_put_stage(const lag_tangent *w, const lag_band_matrix *m, int stages, int s, double dt,
                           const double *a) {
  int n = w->pb->n, nq = w->pb->nq;
  for (int i = 0; i < n; i++) {
    const double *J = i < nq ? NULL : w->jacobian + (i - nq) * lag_tangent_width(w);
    for (int q = 0; q < stages; q++) {
      double *row = lag_band_matrix_at(m, s * n + i, q * n);
      for (int j = 0; j < n; j++) row[j] = (q == s && i == j ? 1 : 0) - dt * a[q] * (J ? J[j] : j == nq + i);
    }
  }
}

/* The derivatives K_s of the stages solve K_s = J_s (Y + dt sum_q a_sq K_q). */
int lag_tangent_implicit(lag_implicit_rk of, lag_step_taken step, int k, double *Y, double *scratch) {
  int n = step.pb->n, stages = of.stages, big = stages * n, rc;
  double dt = step.dt, *rest;
  lag_tangent w = lag_tangent_layout(step.pb, k, 0, scratch, &rest);
  double *K = rest, *column = K + big * k, *scale = column + big;
  lag_band_matrix m = {big, big - 1, scale + 2 * big, scale + big};

  for (int s = 0; s < stages; s++) {
    if ((rc = lag_tangent_at(&w, step.t0 + of.c[s] * dt, step.y + s * n, NULL)) != 0) return rc;
    lag_tangent_put_stage(&w, &m, stages, s, dt, of.A + s * stages);
    lag_tangent_times(&w, Y, K + s * n * k);
  }
  if (lag_band_matrix_factor(&m, scale)) {
    step.pb->detail = "the equations of the tangent are singular; take smaller steps";
    return lag_step_failed(step.pb, LAG_EMETHOD, step.t0);
  }
  for (int j = 0; j < k; j++) {
    for (int i = 0; i < big; i++) column[i] = K[i * k + j];
    lag_band_matrix_solve(&m, column);
    for (int i = 0; i < big; i++) Y[i % n * k + j] += dt * of.A[(stages - 1) * stages + i / n] * column[i];
  }
  return LAG_OK;
}

/* Scratch, with one column more, the probe: y of a stage, two matrices, one matrix per stage, and Y. */
size_t lag_tangent_along_size(const lag_problem *pb, int k) {
  return lag_tangent_size(pb, lag_dop853_tableau.stages, k + 1);
}

/* Size below which entry i of Y is rounding: in a column by a parameter a part of the component's size over the
 * parameter's. */
static double rounding_size(const lag_tangent *w, int i, double tol) {
  const double negligible = 1e-4, difference_part = 0x1p-9;
  for (int j = 0; w->by && j < w->by->n; j++)
    if (w->by->column[j] == i % w->k)
      return fmax(negligible, 8 * DBL_EPSILON / tol) * w->pb->size[i / w->k] * difference_part / w->by->h[j];
  return 0;
}

/* Sum of (e_i / s_i)^2 over an error estimate of the probe, or of the other columns; s_i = |Y_i| + |dt| mean |F_i| over
 * the stages, and at least rounding. */
static double square(const lag_tangent *w, int of_probe, const double *e, const double *Y, const double *F, double dt,
                     double tol) {
  double sum = 0;
  int k = w->k, m = w->pb->n * k, stages = lag_dop853_tableau.stages - 1;
  for (int i = 0; i < m; i++) {
    double gain = 0;
    if ((i % k == k - 1) != of_probe || e[i] == 0.0) continue;
    for (int j = 0; j < stages; j++) gain += fabs(F[j * m + i]) / stages;
    double x = e[i] / fmax(fabs(Y[i]) + fabs(dt) * gain, rounding_size(w, i, tol));
    sum += x * x;
  }
  return sum;
}

/* Error of a part h over what is allowed: the larger of the probe's, held 512 times smaller, down to rounding, and the
 * other columns'. So the probe alone decides, as a rule: parts do not depend on Y, and the derivative is linear in Y.
 * NaN: not finite. */
static double part_error(const lag_tangent *w, double h, double dt, double tol, const double *Y, const double *F,
                         double *error) {
  const double held = tol / fmax(tol / 512, 1e-15);
  const int stages = lag_dop853_tableau.stages - 1;
  double squares[2][2], err = 0;
  int m = w->pb->n * w->k;
  for (int r = 0; r < 2; r++) {
    combine(m, stages, lag_dop853_tableau.errors[r], 1, NULL, F, error);
    for (int of = 0; of < 2; of++) squares[of][r] = square(w, of, error, Y, F, dt, tol);
  }
  for (int of = 0; of < 2; of++) {
    double both = squares[of][0] + 0.01 * squares[of][1], count = w->pb->n * (of ? 1 : w->k - 1);
    double e = both > 0 || isnan(both) ? fabs(h) * squares[of][0] / sqrt(count * both) / tol : 0;
    if (!isfinite(e)) return NAN;
    err = fmax(err, of ? held * e : e);
  }
  return err;
}

/* Block of the columns Y[n * k] with the probe behind them, a fixed vector. */
static void with_probe(int n, int k, const double *Y, double *block) {
  for (int i = 0; i < n; i++) {
    lag_copy(k, Y + i * k, block + i * (k + 1));
    block[i * (k + 1) + k] = (i % 2 ? -1.0 : 1.0) / (1 + i % 5);
  }
}

int lag_tangent_along(lag_tangent_path *path, void *work, lag_step_taken step, int k, double *Y, double *scratch) {
  const lag_tableau *tab = &lag_dop853_tableau;
  lag_problem *pb = step.pb;
  const double tol = fmax(pb->tol, 1e-14), safety = 0.9, shrink_most = 0.2, grow_most = 6, least = 1e-6;
  int n = pb->n, m = n * (k + 1), stages = tab->stages - 1, rc;
  double *rest;
  lag_tangent w = lag_tangent_layout(pb, k + 1, 1, scratch, &rest);
  double *y = rest, *Ys = y + n, *error = Ys + m, *F = error + m, *X = F + stages * m;
  with_probe(n, k, Y, X);
  for (double done = 0, part = 1; done < 1;) {
    part = fmin(part, 1 - done);
    double h = part * step.dt, t = step.t0 + done * step.dt;
    for (int s = 0; s < stages; s++) {
      combine(m, s, tab->a[s], h, X, F, Ys);
      path(work, pb, t + tab->c[s] * h, y);
      if ((rc = lag_tangent_at(&w, t + tab->c[s] * h, y, NULL)) != 0) return rc;
      lag_tangent_times(&w, Ys, F + s * m);
    }
    double err = part_error(&w, h, step.dt, tol, X, F, error);
    if (!isfinite(err)) return lag_step_failed(pb, LAG_ENAN, t);
    if (err <= 1 || part < least) {
      combine(m, stages, tab->a[stages], h, X, F, Ys);
      memcpy(X, Ys, (size_t)m * sizeof *X);
      done = part >= 1 - done ? 1 : done + part;
    }
    part *= fmin(grow_most, fmax(shrink_most, err > 0 ? safety * pow(err, -1.0 / 8) : grow_most));
  }
  for (int i = 0; i < n; i++) lag_copy(k, X + i * (k + 1), Y + i * k);
  return LAG_OK;
}
