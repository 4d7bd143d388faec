/* Reverse mode of steps: products of vectors with their derivatives, transposed, from the emitted reverse sweep of the
 * equations. A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed. (2008), 3.2; of a Runge-Kutta method: W.W. Hager,
 * Numer. Math. 87 (2000) 247, DOI 10.1007/s002110000178. */
#include <string.h>

#include "methods/method_tangent.h"
#include "methods/steps.h"

int lag_reverse_width(const lag_problem *pb) {
  const lag_constraints *held = pb->model->constraints;
  return pb->n + (held ? held->n : 0);
}

size_t lag_reverse_size(const lag_problem *pb, int stages) {
  const lag_model *m = pb->model;
  const lag_adjoint *of = lag_adjoint_of(m);
  size_t n = (size_t)pb->n, wide = (size_t)lag_reverse_width(pb), some = (size_t)stages;
  return 2 * some * n + some * wide + 2 * n + wide + (size_t)(m->nu + m->np + (of ? of->n : 0));
}

lag_reverse lag_reverse_layout(lag_problem *pb, double *g, double *scratch) {
  return (lag_reverse){pb, g, scratch, scratch + pb->n, scratch + 2 * pb->n};
}

int lag_reverse_rates(lag_problem *pb, double t, const double *y, double *f) {
  const lag_adjoint *of = lag_adjoint_of(pb->model);
  int nq = pb->nq, rc;
  if (!of || !of->rates) return lag_step_rhs(pb, t, y, f);
  pb->rhs_calls++;
  lag_copy(nq, y + nq, f);
  rc = lag_inputs_at(pb, t, y);
  rc = rc ? rc : of->rates(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, f + nq, f + 2 * nq, f + pb->n, pb->work);
  return rc ? lag_step_refused(pb, rc, t) : LAG_OK;
}

int lag_reverse_at(const lag_reverse *w, double t, const double *y, const double *f, const double *x, double *out) {
  lag_problem *pb = w->pb;
  const lag_model *m = pb->model;
  const lag_adjoint *of = lag_adjoint_of(m);
  int n = pb->n, nq = pb->nq, nu = m->nu;
  const double *weight = x + nq;
  double *by_up = w->room, *d = by_up + nu + m->np, *g = w->g;
  if (!of) return lag_step_failed(pb, LAG_EMETHOD, t);
  if (of->rates) {
    double *held = d + of->n;
    lag_copy(n - nq, weight, held);
    lag_copy(m->constraints->n, f + n, held + n - nq);
    weight = held;
  }
  int rc = lag_inputs_at(pb, t, y);
  rc = rc ? rc : of->eval(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, f + nq, weight, out, by_up, d, pb->work);
  if (rc) return lag_step_refused(pb, rc, t);
  for (int i = 0; i < nq; i++) out[nq + i] += x[i];
  lag_add_by_parameters(pb, by_up, d, g);
  return lag_not_finite(n, out) >= 0 ? lag_step_failed(pb, LAG_ENAN, t) : LAG_OK;
}

/* With stages Y_s = y0 + dt sum_j a_sj k_j and y1 = y0 + dt sum_s b_s k_s, backwards: X_s = (df/dy)^T dt (b_s x + sum_r
 * a_rs X_r), and x + sum_s X_s. */
int lag_reverse_explicit(const lag_tableau *tab, lag_step_taken step, double *x, double *g, double *scratch) {
  int n = step.pb->n, wide = lag_reverse_width(step.pb), last = tab->stages - 1, rc = LAG_OK;
  double dt = step.dt, *ys = scratch, *f = ys + last * n, *X = f + last * wide;
  const lag_reverse w = lag_reverse_layout(step.pb, g, X + last * n);
  for (int s = 0; s < last && rc == LAG_OK; s++) {
    double *y = ys + s * n;
    memcpy(y, step.y, (size_t)n * sizeof *y);
    for (int j = 0; j < s; j++)
      if (tab->a[s][j] != 0.0) lag_tangent_add(n, dt * tab->a[s][j], f + j * wide, y);
    rc = lag_reverse_rates(step.pb, step.t0 + tab->c[s] * dt, y, f + s * wide);
  }
  for (int s = last - 1; s >= 0 && rc == LAG_OK; s--) {
    memset(w.k, 0, (size_t)n * sizeof *w.k);
    lag_tangent_add(n, dt * tab->a[last][s], x, w.k);
    for (int r = s + 1; r < last; r++)
      if (tab->a[r][s] != 0.0) lag_tangent_add(n, dt * tab->a[r][s], X + r * n, w.k);
    rc = lag_reverse_at(&w, step.t0 + tab->c[s] * dt, ys + s * n, f + s * wide, w.k, X + s * n);
  }
  for (int s = 0; s < last && rc == LAG_OK; s++) lag_tangent_add(n, 1, X + s * n, x);
  return rc;
}

/* Behind the Jacobian: f and the weights of all stages, scales, pivots, the matrix; products. */
size_t lag_reverse_implicit_size(const lag_problem *pb, int stages) {
  size_t big = (size_t)(stages * pb->n);
  return lag_tangent_size(pb, 0, 1) + big * (big + 4) + lag_reverse_size(pb, 1);
}

/* Columns of stage s of the transposed matrix 1 - dt A (x) df/dy. */
static void put_transposed(const lag_tangent *at, const lag_band_matrix *m, int stages, int s, double dt,
                           const double *a) {
  int n = at->pb->n, nq = at->pb->nq;
  for (int i = 0; i < n; i++)
    for (int q = 0; q < stages; q++)
      for (int j = 0; j < n; j++) {
        double J = i < nq ? j == nq + i : at->jacobian[(i - nq) * n + j];
        *lag_band_matrix_at(m, q * n + j, s * n + i) = (q == s && i == j) - dt * a[q] * J;
      }
}

/* With K = J (Y + dt A K) and Y1 = Y + dt b K, b the last row of A: (1 - dt A J)^T X = dt b x, and x + J^T X. */
int lag_reverse_implicit(lag_implicit_rk of, lag_step_taken step, double *x, double *g, double *scratch) {
  int n = step.pb->n, stages = of.stages, big = stages * n, rc = LAG_OK;
  double dt = step.dt, *f;
  lag_tangent at = lag_tangent_layout(step.pb, 1, 0, scratch, &f);
  double *X = f + big, *scale = X + big, *pivot = scale + big;
  lag_band_matrix m = {big, big - 1, pivot + big, pivot};
  double *rates = m.a + big * big;
  const lag_reverse w = lag_reverse_layout(step.pb, g, rates + lag_reverse_width(step.pb));
  at.by = NULL;
  for (int s = 0; s < stages && rc == LAG_OK; s++) {
    rc = lag_tangent_at(&at, step.t0 + of.c[s] * dt, step.y + s * n, f + s * n);
    put_transposed(&at, &m, stages, s, dt, of.A + s * stages);
    for (int i = 0; i < n; i++) X[s * n + i] = dt * of.A[(stages - 1) * stages + s] * x[i];
  }
  if (rc) return rc;
  if (lag_band_matrix_factor(&m, scale)) {
    step.pb->detail = "the equations of the reverse sweep are singular; take smaller steps";
    return lag_step_failed(step.pb, LAG_EMETHOD, step.t0);
  }
  lag_band_matrix_solve(&m, X);
  for (int s = 0; s < stages && rc == LAG_OK; s++) {
    double t = step.t0 + of.c[s] * dt;
    if (step.pb->model->constraints) rc = lag_reverse_rates(step.pb, t, step.y + s * n, rates);
    else lag_copy(n, f + s * n, rates);
    rc = rc ? rc : lag_reverse_at(&w, t, step.y + s * n, rates, X + s * n, w.k);
    lag_tangent_add(n, 1, w.k, x);
  }
  return rc;
}
