/* The tangent space of the constraints: small changes of a state between motions that obey them. Enters: a state on
 * the constraints; leaves: the dimension of that space, or changes projected onto it, as a start beside the
 * constraints is. Holds: of a constraint on velocities that is the rate of a function of positions, that function
 * may be another in a neighbouring motion. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"
#include "numeric/dense.h"

/* Rank of the constraints; holonomic: of those stated on positions alone. A[n nq] and unit[nq] at the state; A is
 * destroyed. */
static int rank_of(const lag_constraints *of, int nq, double *A, const double *unit, int holonomic) {
  const double follows = 1e-9;
  int r = 0;
  for (int k = 0; k < of->n; k++)
    if (!holonomic || of->of[k].holonomic) r += lag_independent_part(nq, r, follows, unit, A, A + k * nq) > follows;
  return r;
}

int lag_tangent_dimension(lag_sim *s) {
  lag_problem *pb = &s->pb;
  const lag_constraints *of = pb->model->constraints;
  int d = pb->n, rc = of && s->run->begun == 0.0 ? lag_setup_start(s) : LAG_OK;
  for (int holonomic = 0; of && holonomic < 2 && rc == LAG_OK; holonomic++) {
    double *A = lag_independence_scratch(pb), *unit = A + of->n * pb->nq;
    rc = lag_constraint_jacobian(pb, s->run->t, s->now, A, unit, NULL);
    if (rc) return lag_fail(s, rc < 0 ? rc : LAG_EDOMAIN, "the constraints have no derivatives at the start");
    d -= rank_of(of, pb->nq, A, unit, holonomic);
  }
  return rc ? rc : d;
}

/* 1 over the largest step along e[n] by which differences see no curvature; each unit counts at least `least` of its
 * declared size. */
static double steepness(lag_problem *pb, const double *y, const double *e, double least) {
  double far = 0;
  for (int i = 0; i < 2 * pb->nq; i++) {
    double unit = least * pb->model->q[i % pb->nq].factor;
    far = fmax(far, fabs(e[i]) / fmax(lag_difference_scale(pb, y, i), unit));
  }
  return far;
}

/* rate[constraints] := change of the residuals of velocities along e[n], by differences of order 6 with the step h.
 * *error := about what those of order 4 omit, and rounding. c[3 constraints] is scratch. */
static int differences(lag_problem *pb, double t, const double *y, const double *e, double h, double *there, double *c,
                       double *rate, double *error) {
  int m = pb->model->constraints->n, rc = LAG_OK;
  double *r = c + m, *bend = r + m, terms = lag_largest(2 * pb->nq, y), most = lag_largest(2 * pb->nq, e), bent = 0;
  memset(rate, 0, (size_t)m * sizeof *rate);
  memset(bend, 0, (size_t)m * sizeof *bend);
  LAG_EACH_DIFFERENCE(j) {
    double third = (abs(j) == 1 ? 2 : abs(j) == 2 ? -1 : 0) * (j < 0 ? -1 : 1) / (4 * h);
    for (int i = 0; i < pb->n; i++) there[i] = y[i] + j * h * e[i];
    rc = rc ? rc : lag_residuals(pb, t, there, c, r);
    for (int k = 0; k < m; k++) rate[k] += lag_difference_weight(j) * r[k] / h, bend[k] += third * r[k];
  }
  for (int k = 0; k < m; k++) bent = fmax(bent, fabs(bend[k]));
  *error = bent * bent / most + DBL_EPSILON * terms / h;
  return rc;
}

/* The same where no step is known: of coordinates that pass 0 together the state shows no size, which their declared
 * units may do. c[4 constraints] is scratch. */
static int residual_change(lag_problem *pb, double t, const double *y, const double *e, double *there, double *c,
                           double *rate) {
  int m = pb->model->constraints->n;
  double far = steepness(pb, y, e, 0), wide = steepness(pb, y, e, 1), error, other, *second = c + 3 * m;
  memset(rate, 0, (size_t)m * sizeof *rate);
  if (!(far > 0)) return LAG_OK;
  int rc = differences(pb, t, y, e, LAG_DIFFERENCE_PART / far, there, c, rate, &error);
  if (rc || wide > far / 2 || differences(pb, t, y, e, LAG_DIFFERENCE_PART / wide, there, c, second, &other)) return rc;
  if (other < error) memcpy(rate, second, (size_t)m * sizeof *rate);
  return LAG_OK;
}

size_t lag_tangent_projection_size(const lag_problem *pb) {
  const lag_constraints *of = pb->model->constraints;
  return of ? (size_t)(2 * pb->n + 2 * pb->nq + 7 * of->n + of->njacobian + of->nmass) : 0;
}

/* c_by, r_by[constraints] := change of the residuals by parameter j; c[2 constraints] is scratch. */
static int residuals_by_parameter(lag_problem *pb, double t, const double *y, int j, double *c, double *c_by,
                                  double *r_by) {
  const lag_constraints *of = pb->model->constraints;
  const double *p = pb->p;
  double *r = c + of->n;
  int rc = LAG_OK;
  memset(c_by, 0, (size_t)(2 * of->n) * sizeof *c_by);
  LAG_EACH_DIFFERENCE(k) {
    pb->p = lag_shifted_parameters(pb, pb->by, j, k);
    rc = rc ? rc : lag_residuals(pb, t, y, c, r);
    for (int i = 0; i < of->n; i++) {
      c_by[i] += i < of->nholonomic ? lag_difference_weight(k) * c[i] / pb->by->h[j] : 0;
      r_by[i] += lag_difference_weight(k) * r[i] / pb->by->h[j];
    }
    pb->p = p;
  }
  return rc;
}

/* The parameter of column c; -1: none. */
static int parameter_of(const lag_problem *pb, int c) {
  for (int j = 0; pb->by && j < pb->by->n; j++)
    if (pb->by->column[j] == c) return j;
  return -1;
}

/* Adds to e, which goes with a change of parameter j (-1: none), the least change by which positions, then velocities,
 * obey the constraints. */
static int project(lag_problem *pb, double t, const double *y, const double *A, int j, double *e, double *scratch) {
  const lag_constraints *of = pb->model->constraints;
  int n = pb->n, nq = pb->nq, rc;
  double *there = scratch, *d = there + n, *force = d + nq, *c = force + nq, *g = c + 4 * of->n, *c_by = g + of->n,
         *r_by = c_by + of->n;
  memset(g, 0, (size_t)of->n * sizeof *g);
  memset(c_by, 0, (size_t)(2 * of->n) * sizeof *c_by);
  if (j >= 0 && (rc = residuals_by_parameter(pb, t, y, j, c, c_by, r_by)) != 0) return rc;
  for (int k = 0; k < of->n; k++) g[k] = of->of[k].holonomic ? -c_by[k] : 0;
  for (int k = 0; k < of->njacobian; k++) {
    const lag_entry *at = &of->jacobian[k];
    if (of->of[at->row].holonomic) g[at->row] -= A[k] * e[at->col];
  }
  rc = of->nholonomic ? lag_least_change(pb, t, y, 1, g, d, force) : LAG_OK;
  for (int i = 0; i < nq && of->nholonomic && rc == LAG_OK; i++) e[i] += d[i];
  rc = rc ? rc : residual_change(pb, t, y, e, there, c, g);
  for (int k = 0; k < of->n; k++) g[k] = -g[k] - r_by[k];
  rc = rc ? rc : lag_least_change(pb, t, y, 0, g, d, force);
  for (int i = 0; i < nq && rc == LAG_OK; i++) e[nq + i] += d[i];
  return rc;
}

int lag_tangent_project(lag_problem *pb, double t, const double *y, int k, double *Y, double *scratch) {
  const lag_constraints *of = pb->model->constraints;
  int n = pb->n, rc = of ? lag_inputs_at(pb, t, y) : LAG_OK;
  double *e = scratch, *A = e + n, *M = of ? A + of->njacobian : NULL, *rest = of ? M + of->nmass : NULL;
  rc = of && rc == LAG_OK ? of->matrices(of, t, y, y + pb->nq, y + 2 * pb->nq, pb->p, pb->u, A, M, pb->work) : rc;
  for (int j = 0; of && j < k && rc == LAG_OK; j++) {
    for (int i = 0; i < n; i++) e[i] = Y[i * k + j];
    rc = project(pb, t, y, A, parameter_of(pb, j), e, rest);
    for (int i = 0; i < n; i++) Y[i * k + j] = e[i];
  }
  return rc;
}

size_t lag_project_back_size(const lag_problem *pb) {
  const lag_adjoint *of = pb->model->constraints ? pb->model->constraints->adjoint : NULL;
  return of ? (size_t)(pb->n + pb->model->nu + pb->model->np + of->n) : 0;
}

int lag_project_back(lag_problem *pb, double t, const double *y, double *x, double *g, double *scratch) {
  const lag_adjoint *of = pb->model->constraints->adjoint;
  double *out = scratch, *by_up = out + pb->n, *d = by_up + pb->model->nu + pb->model->np;
  int nq = pb->nq, rc = lag_inputs_at(pb, t, y);
  rc = rc ? rc : of->project(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, x, out, by_up, d, pb->work);
  if (rc || lag_not_finite(pb->n, out) >= 0) return rc ? rc : LAG_ENAN;
  memcpy(x, out, (size_t)pb->n * sizeof *x);
  lag_add_by_parameters(pb, by_up, d, g);
  return LAG_OK;
}
