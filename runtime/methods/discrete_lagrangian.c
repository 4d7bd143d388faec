/* Calls of the model for steps of discrete Lagrangians, their failures and derivatives: discrete_lagrangian.h. */
#include "methods/discrete_lagrangian.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "methods/method_tangent.h"
#include "methods/steps.h"

/* ---- memory */

static int half_band(const lag_model *m) {
  int band = 0;
  for (int k = 0; k < m->nsecond; k++) {
    int d = m->second_at[k].row - m->second_at[k].col;
    band = d > band ? d : -d > band ? -d : band;
  }
  return band;
}

size_t lag_discrete_size(const lag_problem *pb, int free) {
  int n = pb->nq, m = n * free, matrix = lag_band_matrix_size(m, free * (half_band(pb->model) + 1) - 1);
  return (size_t)LAG_DISCRETE_ROOM(n, m, pb->model->nsecond, matrix);
}

static lag_discrete_room room_of(const lag_problem *pb, const lag_discrete *d) {
  const lag_model *m = pb->model;
  lag_discrete_room w = {
      .n = pb->nq, .half = half_band(m), .nsecond = m->nsecond, .at = m->second_at, .epsilon = DBL_EPSILON};
  lag_discrete_place(d, &w);
  return w;
}

/* ---- the model */

int lag_discrete_variation(lag_problem *pb, double t, const lag_discrete_room *w) {
  return lag_step_checked(pb, lag_variation(pb, t, w->Q, w->V, w->Lq, w->Lv, w->F), t);
}

int lag_discrete_second(lag_problem *pb, double t, const lag_discrete_room *w) {
  return lag_step_checked(pb, lag_second_derivatives(pb, t, w->Q, w->V, w->second), t);
}

/* ---- failures */

int lag_discrete_infinite(lag_problem *pb, const lag_discrete *d, const lag_discrete_room *w) {
  pb->bad_index = pb->nq + lag_not_finite(w->J.n, w->R) % w->n;
  return lag_step_failed(pb, LAG_ENAN, d->t);
}

/* LAG_EMETHOD: pb->detail says that Newton's method `what`, in which step, and how large the residual R is. what NULL:
 * its matrix is singular. */
int lag_discrete_fails(lag_problem *pb, const lag_discrete *d, const lag_discrete_room *w, const char *what) {
  double worst = 0;
  if (!what && pb->model->constraints)
    what = "has a singular matrix, as where inertia is missing that constraints replace";
  for (int j = 0; j < w->J.n; j++) worst = fmax(worst, w->R[j] == 0.0 ? 0 : fabs(w->R[j]) / w->S[j]);
  snprintf(pb->words, sizeof pb->words,
           "in a step of %.3g s Newton's method %s, the residual is %.1g of its terms; take smaller steps, or radau or "
           "dop853",
           d->size, what ? what : "has a singular matrix", worst);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, d->t);
}

/* Undoes the correction that led outside the model's domain, and reports the residual before it. */
int lag_discrete_leaves(lag_problem *pb, const lag_discrete *d, const lag_discrete_room *w, int status) {
  int free = (int)d->rule->free;
  if (status == LAG_EMODEL) return status;
  for (int a = 0; a < w->n; a++)
    for (int k = 0; k < free; k++) d->u[k * w->n + a] -= w->du[a * free + k];
  lag_discrete_residual(pb, d, w);
  return lag_discrete_fails(pb, d, w, "leaves the domain of the model");
}

int lag_discrete_solve(lag_problem *pb, const lag_discrete *d) {
  lag_discrete_room w = room_of(pb, d);
  return lag_discrete_newton(pb, d, &w);
}

/* ---- Derivative of the step */

void lag_hessian_times(const lag_problem *pb, const double *h, int k, const double *dQ, const double *dV, double *dP,
                       double *dF) {
  const lag_model *m = pb->model;
  for (int e = 0; e < m->nsecond; e++) {
    int row = m->second_at[e].row * k, col = m->second_at[e].col * k, part = m->second_at[e].part;
    int of_p = part == LAG_VV || part == LAG_VQ, by_v = part == LAG_VV || part == LAG_FV;
    const double *by = by_v ? dV : dQ;
    double *of = of_p ? dP : dF;
    if (by && of) lag_tangent_add(k, h[e], by + col, of + row);
    if (part == LAG_VQ && dV && dF) {
      lag_tangent_add(k, h[e], dV + row, dF + col); /* d2L/dq dv */
    } else if (row != col && (part == LAG_QQ || part == LAG_VV) && by && of) {
      lag_tangent_add(k, h[e], by + row, of + col);
    }
  }
}

/* Scratch: dP, dF, dQ, dV at one point [nq k] each, and one column of du [nq free]. */
size_t lag_discrete_tangent_size(const lag_problem *pb, int free, int k) { return (size_t)(pb->nq * (4 * k + free)); }

/* du += -dR/dq dq at fixed u. */
static int push(lag_problem *pb, const lag_discrete *d, const lag_discrete_room *w, int k, const double *dq, double *du,
                double *dP) {
  const lag_rule *r = d->rule;
  int m = w->n * k, free = (int)r->free;
  double *dF = dP + m;
  for (int i = 0; i < (int)r->points; i++) {
    int rc = lag_discrete_second(pb, lag_discrete_at(d, w, i), w);
    if (rc) return rc;
    memset(dP, 0, (size_t)(2 * m) * sizeof *dP); /* dF stands behind it */
    lag_hessian_times(pb, w->second, k, dq, NULL, dP, dF);
    for (int j = 0; j < free; j++) {
      lag_tangent_add(m, -r->b[i] * r->value[i][j], dP, du + j * m);
      lag_tangent_add(m, d->h * r->b[i] * (r->whole[j] - r->integral[i][j]), dF, du + j * m);
    }
  }
  return LAG_OK;
}

/* du := (dR/du)^-1 du, column by column. */
static void solve_columns(const lag_discrete_room *w, int free, int k, double *du, double *column) {
  for (int c = 0; c < k; c++) {
    for (int a = 0; a < w->n; a++)
      for (int j = 0; j < free; j++) column[a * free + j] = du[(j * w->n + a) * k + c];
    lag_band_matrix_solve(&w->J, column);
    for (int a = 0; a < w->n; a++)
      for (int j = 0; j < free; j++) du[(j * w->n + a) * k + c] = column[a * free + j];
  }
}

int lag_discrete_tangent(lag_problem *pb, const lag_discrete *d, int k, double *dq, double *dp, double *du,
                         double *scratch) {
  const lag_rule *r = d->rule;
  lag_discrete_room w = room_of(pb, d);
  int m = w.n * k, free = (int)r->free, rc = lag_discrete_matrix(pb, d, &w);
  double *dP = scratch, *dF = dP + m, *dQ = dF + m, *dV = dQ + m, *column = dV + m;
  memset(du, 0, (size_t)(free * m) * sizeof *du);
  for (int j = 0; j < free; j++) lag_tangent_add(m, r->whole[j], dp, du + j * m);
  if (rc || (rc = push(pb, d, &w, k, dq, du, dP)) != 0) return rc;
  solve_columns(&w, free, k, du, column);
  for (int i = 0; i < (int)r->points && d->h != 0.0; i++) {
    if ((rc = lag_discrete_second(pb, lag_discrete_at(d, &w, i), &w)) != 0) return rc;
    memcpy(dQ, dq, (size_t)m * sizeof *dQ);
    memset(dV, 0, (size_t)m * sizeof *dV);
    memset(dF, 0, (size_t)m * sizeof *dF);
    for (int j = 0; j < free; j++) {
      lag_tangent_add(m, d->h * r->integral[i][j], du + j * m, dQ);
      lag_tangent_add(m, r->value[i][j], du + j * m, dV);
    }
    lag_hessian_times(pb, w.second, k, dQ, dV, NULL, dF);
    lag_tangent_add(m, d->h * r->b[i], dF, dp);
  }
  for (int j = 0; j < free; j++) lag_tangent_add(m, d->h * r->whole[j], du + j * m, dq);
  return LAG_OK;
}
