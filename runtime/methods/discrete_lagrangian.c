/* Newton's method for a step of a discrete Lagrangian. Enters: q, p and a guess; leaves: the velocities inside the
 * step, and the forces at its points. Holds: all derivatives are exact, emitted by the compiler; no finite
 * differences. */
#include "methods/discrete_lagrangian.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "kernels/band_matrix.h"
#include "methods/newton.h"
#include "methods/steps.h"
#include "methods/method_tangent.h"
#include "numeric/workspace.h"

/* Pointers into lag_discrete.work. */
typedef struct NewtonArrays {
  int n, m, free, points;
  double *Q, *V, *Lq, *Lv, *F; /* [n] at one point */
  double *R, *S, *du;          /* [m] residual, size of its terms, correction */
  double *h;                   /* [nsecond] */
  lag_band_matrix J;
} NewtonArrays;

/* Half-bandwidth of the second derivatives, in the order in which coordinates are declared. */
static int half_band(const lag_model *m) {
  int band = 0;
  for (int k = 0; k < m->nsecond; k++) {
    int d = m->second_at[k].row - m->second_at[k].col;
    band = d > band ? d : -d > band ? -d : band;
  }
  return band;
}

/* Sets the pointers, unless x is NULL; returns the length of lag_discrete.work. */
static size_t layout(NewtonArrays *w, const lag_problem *pb, int free, double *x) {
  size_t n = (size_t)pb->nq, m = n * (size_t)free;
  w->n = pb->nq;
  w->m = w->n * free;
  w->free = free;
  w->J.n = w->m;
  w->J.band = free * (half_band(pb->model) + 1) - 1;
  double **const parts[] = {&w->Q, &w->V, &w->Lq, &w->Lv, &w->F, &w->R, &w->S, &w->du, &w->J.pivot, &w->h, &w->J.a};
  const size_t sizes[] = {
      n, n, n, n, n, m, m, m, m, (size_t)pb->model->nsecond, (size_t)lag_band_matrix_size(w->m, w->J.band)};
  return lag_workspace_slice(x, sizeof sizes / sizeof *sizes, parts, sizes);
}

static NewtonArrays arrays(const lag_discrete *d) {
  NewtonArrays w;
  layout(&w, d->pb, (int)d->rule->free, d->work);
  w.points = (int)d->rule->points;
  return w;
}

size_t lag_discrete_size(const lag_problem *pb, int free) {
  NewtonArrays w;
  return layout(&w, pb, free, NULL);
}

/* Q and V at point i. */
static void set_point(const lag_discrete *d, const NewtonArrays *w, int i) {
  const lag_rule *r = d->rule;
  for (int a = 0; a < w->n; a++) {
    double x = 0, v = 0;
    for (int k = 0; k < w->free; k++) {
      x += r->integral[i][k] * d->u[k * w->n + a];
      v += r->value[i][k] * d->u[k * w->n + a];
    }
    w->Q[a] = d->q[a] + (d->dq[a] + d->h * x);
    w->V[a] = v;
  }
}

static double time_of(const lag_discrete *d, int i) { return d->t + d->rule->c[i] * d->h; }

/* R := residual, S := size of its terms by component, d->force := forces at the points. LAG_OK, or a failure. */
static int residual(const lag_discrete *d, const NewtonArrays *w) {
  const lag_rule *r = d->rule;
  for (int k = 0; k < w->free; k++)
    for (int a = 0; a < w->n; a++) {
      double p = d->p[a] + d->dp[a];
      w->R[k * w->n + a] = -r->whole[k] * p;
      w->S[k * w->n + a] = fabs(r->whole[k] * p);
    }
  for (int i = 0; i < w->points; i++) {
    double *force = d->force + i * w->n;
    set_point(d, w, i);
    int rc = lag_variation(d->pb, time_of(d, i), w->Q, w->V, w->Lq, w->Lv, w->F);
    if (rc) return lag_step_refused(d->pb, rc, time_of(d, i));
    for (int a = 0; a < w->n; a++) {
      force[a] = w->Lq[a] + w->F[a];
      for (int k = 0; k < w->free; k++) {
        double moved = r->b[i] * r->value[i][k] * w->Lv[a];
        double pushed = d->h * r->b[i] * (r->whole[k] - r->integral[i][k]) * force[a];
        w->R[k * w->n + a] += moved - pushed;
        w->S[k * w->n + a] += fabs(moved) + fabs(pushed);
      }
    }
  }
  d->pb->bad_index = lag_not_finite(w->m, w->R);
  if (d->pb->bad_index >= 0) {
    d->pb->bad_index = d->pb->nq + d->pb->bad_index % w->n;
    return lag_step_failed(d->pb, LAG_ENAN, d->t);
  }
  return LAG_OK;
}

/* Adds of[k] by[l] x to the block (row, col) of the matrix, in equation k and column of free velocity l. Unknown u_k
 * of coordinate a has index a free + k, so that the matrix of a chain is banded. */
static void add_block(const NewtonArrays *w, int row, int col, const double *of, const double *by, double x) {
  for (int k = 0; k < w->free; k++) {
    double *at = lag_band_matrix_at(&w->J, row * w->free + k, col * w->free);
    for (int l = 0; l < w->free; l++) at[l] += of[k] * by[l] * x;
  }
}

/* Adds the second derivatives at point i to the matrix. */
static void scatter(const lag_discrete *d, const NewtonArrays *w, int i) {
  const lag_model *m = d->pb->model;
  const lag_rule *r = d->rule;
  double of_f[LAG_RULE_FREE], of_p[LAG_RULE_FREE], by_q[LAG_RULE_FREE];
  for (int k = 0; k < w->free; k++) {
    of_f[k] = -d->h * r->b[i] * (r->whole[k] - r->integral[i][k]);
    of_p[k] = r->b[i] * r->value[i][k];
    by_q[k] = d->h * r->integral[i][k];
  }
  for (int e = 0; e < m->nsecond; e++) {
    int row = m->second_at[e].row, col = m->second_at[e].col, part = m->second_at[e].part;
    const double *of = part == LAG_VV || part == LAG_VQ ? of_p : of_f,
                 *by = part == LAG_VV || part == LAG_FV ? r->value[i] : by_q;
    add_block(w, row, col, of, by, w->h[e]);
    if (part == LAG_VQ) add_block(w, col, row, of_f, r->value[i], w->h[e]); /* d2L/dq dv is its transpose */
    else if (row != col && (part == LAG_QQ || part == LAG_VV)) add_block(w, col, row, of, by, w->h[e]);
  }
}

/* LAG_EMETHOD: pb->detail says that Newton's method `what`, in which step, and how large the residual R is. */
static int newton_failed(const lag_discrete *d, const NewtonArrays *w, const char *what) {
  double worst = 0;
  for (int j = 0; j < w->m; j++) worst = fmax(worst, w->R[j] == 0.0 ? 0 : fabs(w->R[j]) / w->S[j]);
  snprintf(d->pb->words, sizeof d->pb->words,
           "in a step of %.3g s Newton's method %s, the residual is %.1g of its terms; take smaller steps, or radau or "
           "dop853",
           d->size, what, worst);
  d->pb->detail = d->pb->words;
  return lag_step_failed(d->pb, LAG_EMETHOD, d->t);
}

/* Failure after a correction that led outside the model's domain: undoes it and reports the residual before it. */
static int newton_left_domain(const lag_discrete *d, const NewtonArrays *w) {
  for (int a = 0; a < w->n; a++)
    for (int k = 0; k < w->free; k++) d->u[k * w->n + a] -= w->du[a * w->free + k];
  residual(d, w);
  return newton_failed(d, w, "leaves the domain of the model");
}

/* Factors Newton's matrix at the present u. LAG_OK, or a failure. */
static int matrix(const lag_discrete *d, NewtonArrays *w) {
  memset(w->J.a, 0, (size_t)lag_band_matrix_size(w->m, w->J.band) * sizeof(double));
  for (int i = 0; i < w->points; i++) {
    set_point(d, w, i);
    int rc = lag_second_derivatives(d->pb, time_of(d, i), w->Q, w->V, w->h);
    if (rc) return lag_step_refused(d->pb, rc, time_of(d, i));
    scatter(d, w, i);
  }
  if (lag_band_matrix_factor(&w->J, w->du))
    return newton_failed(d, w,
                         d->pb->model->constraints
                             ? "has a singular matrix, as where inertia is missing that constraints replace"
                             : "has a singular matrix");
  return LAG_OK;
}

/* One Newton correction of u. Its size beside rounding is sqrt(sum |du R| / sum |u| S), which does not depend on
 * units. */
static lag_correction correct(const lag_discrete *d, const NewtonArrays *w) {
  double part = 0, work = 0, whole = 0;
  for (int a = 0; a < w->n; a++)
    for (int k = 0; k < w->free; k++) w->du[a * w->free + k] = -w->R[k * w->n + a];
  lag_band_matrix_solve(&w->J, w->du);
  for (int a = 0; a < w->n; a++)
    for (int k = 0; k < w->free; k++) {
      double *u = &d->u[k * w->n + a], du = w->du[a * w->free + k];
      *u += du;
      part = fmax(part, lag_relative_correction(d->size, du, *u, d->q[a]));
      work += fabs(du * w->R[k * w->n + a]);
      whole += fabs(*u) * w->S[k * w->n + a];
    }
  return (lag_correction){part, work > 0 ? sqrt(work / whole) : 0};
}

int lag_discrete_solve(const lag_discrete *d) {
  NewtonArrays w = arrays(d);
  lag_correction before = {1, 1};
  int settled = 0, rc;
  char what[48];
  d->pb->systems += d->counted;
  for (int turn = 0; turn <= LAG_MOST_CORRECTIONS; turn++) {
    if ((rc = residual(d, &w)) != 0 || settled)
      return rc && turn > 0 && rc != LAG_EMODEL ? newton_left_domain(d, &w) : rc;
    int fresh = lag_newton_needs_matrix(turn, before);
    if (fresh && (rc = matrix(d, &w)) != 0) return rc;
    lag_correction now = correct(d, &w);
    d->pb->iterations += d->counted;
    settled = lag_newton_has_converged(now, before, fresh, turn);
    before = now;
  }
  snprintf(what, sizeof what, "did not converge in %d corrections", LAG_MOST_CORRECTIONS);
  return newton_failed(d, &w, what);
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

/* du := -dR/d(q, p) (dq, dp) at fixed u, the right-hand side of the derivative. */
static int pushed(const lag_discrete *d, const NewtonArrays *w, int k, const double *dq, const double *dp, double *du,
                  double *dP, double *dF) {
  const lag_rule *r = d->rule;
  int m = w->n * k;
  memset(du, 0, (size_t)(w->free * m) * sizeof *du);
  for (int j = 0; j < w->free; j++) lag_tangent_add(m, r->whole[j], dp, du + j * m);
  for (int i = 0; i < w->points; i++) {
    set_point(d, w, i);
    int rc = lag_second_derivatives(d->pb, time_of(d, i), w->Q, w->V, w->h);
    if (rc) return lag_step_refused(d->pb, rc, time_of(d, i));
    memset(dP, 0, (size_t)(2 * m) * sizeof *dP); /* dF stands behind it */
    lag_hessian_times(d->pb, w->h, k, dq, NULL, dP, dF);
    for (int j = 0; j < w->free; j++) {
      lag_tangent_add(m, -r->b[i] * r->value[i][j], dP, du + j * m);
      lag_tangent_add(m, d->h * r->b[i] * (r->whole[j] - r->integral[i][j]), dF, du + j * m);
    }
  }
  return LAG_OK;
}

/* du := (dR/du)^-1 du, column by column. */
static void solve_columns(const NewtonArrays *w, int k, double *du, double *column) {
  for (int c = 0; c < k; c++) {
    for (int a = 0; a < w->n; a++)
      for (int j = 0; j < w->free; j++) column[a * w->free + j] = du[(j * w->n + a) * k + c];
    lag_band_matrix_solve(&w->J, column);
    for (int a = 0; a < w->n; a++)
      for (int j = 0; j < w->free; j++) du[(j * w->n + a) * k + c] = column[a * w->free + j];
  }
}

int lag_discrete_tangent(const lag_discrete *d, int k, double *dq, double *dp, double *du, double *scratch) {
  const lag_rule *r = d->rule;
  NewtonArrays w = arrays(d);
  int m = w.n * k, rc = matrix(d, &w);
  double *dP = scratch, *dF = dP + m, *dQ = dF + m, *dV = dQ + m, *column = dV + m;
  if (rc || (rc = pushed(d, &w, k, dq, dp, du, dP, dF)) != 0) return rc;
  solve_columns(&w, k, du, column);
  for (int i = 0; i < w.points && d->h != 0.0; i++) {
    set_point(d, &w, i);
    if ((rc = lag_second_derivatives(d->pb, time_of(d, i), w.Q, w.V, w.h)) != 0)
      return lag_step_refused(d->pb, rc, time_of(d, i));
    memcpy(dQ, dq, (size_t)m * sizeof *dQ);
    memset(dV, 0, (size_t)m * sizeof *dV);
    memset(dF, 0, (size_t)m * sizeof *dF);
    for (int j = 0; j < w.free; j++) {
      lag_tangent_add(m, d->h * r->integral[i][j], du + j * m, dQ);
      lag_tangent_add(m, r->value[i][j], du + j * m, dV);
    }
    lag_hessian_times(d->pb, w.h, k, dQ, dV, NULL, dF);
    lag_tangent_add(m, d->h * r->b[i], dF, dp);
  }
  for (int j = 0; j < w.free; j++) lag_tangent_add(m, d->h * r->whole[j], du + j * m, dq);
  return LAG_OK;
}
