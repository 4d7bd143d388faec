/* Makes the substeps of a step of the implicit symplectic methods, in q and p. Enters: the present q and p; leaves: the increments of a
 * substep. Holds: within a step q and p are kept as values at its start plus increments, so that sums lose nothing to rounding. */
#include "methods/substeps.h"

#include <string.h>

#include "methods/discrete_lagrangian.h"
#include "methods/predictor.h"
#include "methods/step_interpolant.h"
#include "methods/steps.h"
#include "numeric/workspace.h"

size_t lag_substep_history(const lag_problem *pb, const Implicit *w) { return lag_predictor_size(pb->nq * (int)w->rule[0].free); }

/* Sets the pointers of a block, unless x is NULL; returns its length. */
static size_t block_layout(ConstraintBlock *b, const lag_problem *pb, int substeps, double *x) {
  const lag_constraints *of = pb->model->constraints;
  size_t n = (size_t)pb->n, nq = (size_t)pb->nq, nc = (size_t)of->n;
  double **const parts[] = {&b->from, &b->to, &b->dq, &b->dp, &b->impulse, &b->d, &b->force, &b->c, &b->r, &b->g, &b->sum,
                            &b->A, &b->M, &b->change, &b->end_jacobian, &b->history};
  const size_t sizes[] = {n, n, nq, nq, nq, nq, nq, nc, nc, nc, nc, (size_t)of->njacobian, (size_t)of->nmass, nc * nq, nc * nc,
                          (size_t)substeps * lag_predictor_size(of->n)};
  return lag_cut(x, sizeof sizes / sizeof *sizes, parts, sizes);
}

/* Sets the pointers, unless x is NULL; returns the length of Implicit.x. */
static size_t layout(ImplicitArrays *a, const lag_problem *pb, int free, int substeps, double *x) {
  const int constrained = pb->model->constraints != NULL;
  size_t n = (size_t)pb->n, nq = (size_t)pb->nq, m = nq * (size_t)free;
  double **const parts[] = {&a->p, &a->qc, &a->pc, &a->dq, &a->dp, &a->ql, &a->pl, &a->v, &a->y0, &a->y1, &a->f0, &a->f1, &a->u, &a->force,
                            &a->history, &a->path, &a->discrete};
  const size_t sizes[] = {nq, nq, nq, nq, nq, nq, nq, nq, n, n, n, n, 2 * m, m,
                          (size_t)substeps * lag_predictor_size((int)m) + lag_predictor_size(pb->nq), lag_interpolant_size(pb->nq),
                          x && !constrained ? 0 : lag_discrete_size(pb, free)}; /* the search for its band takes time in each step */
  size_t length = lag_cut(x, sizeof sizes / sizeof *sizes, parts, sizes);
  return length + (constrained ? block_layout(&a->block, pb, substeps, x ? x + length : NULL) : 0);
}

ImplicitArrays lag_substeps_arrays(Implicit *w, const lag_problem *pb) {
  ImplicitArrays a;
  layout(&a, pb, (int)w->rule[0].free, (int)w->substeps, w->x);
  return a;
}

size_t lag_substeps_size(const lag_problem *pb, int free, int substeps) {
  ImplicitArrays a;
  return sizeof(Implicit) / sizeof(double) + layout(&a, pb, free, substeps, NULL);
}

/* Initial guess: u := velocities at the nodes of substep k, extrapolated linearly from y at t. */
static int linear_guess(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, const double *y, double dt, int k, double at, double *u) {
  const lag_rule *r = &w->rule[k % 2];
  int nq = pb->nq, rc = lag_step_rhs(pb, t, y, a->f1);
  for (int j = 0; j < (int)r->free && rc == 0; j++)
    for (int i = 0; i < nq; i++) u[j * nq + i] = y[nq + i] + dt * (at + w->part[k] * r->node[j]) * a->f1[nq + i];
  return rc;
}

void lag_substeps_gather(const ImplicitArrays *a, int nq) {
  for (int i = 0; i < nq; i++) {
    a->ql[i] = a->qc[i] + a->dq[i];
    a->pl[i] = a->pc[i] + a->dp[i];
  }
}

int lag_substep(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, const double *y, double dt, int k, double at, double *u,
             int known) {
  const lag_rule *r = &w->rule[k % 2];
  int nq = pb->nq, m = nq * (int)r->free, rc = LAG_EMETHOD;
  double *history = a->history + (size_t)k * lag_substep_history(pb, w), h = w->part[k] * dt;
  lag_discrete d = {.rule = r, .pb = pb, .t = t + at * dt, .h = h, .size = w->step.h, .q = y, .dq = a->ql, .p = a->p,
                    .dp = a->pl, .u = u, .force = a->force, .work = a->discrete, .counted = 1};

  lag_substeps_gather(a, nq);
  if (known || lag_predictor_guess(history, m, u)) rc = lag_discrete_solve(&d);
  pb->detail = NULL; /* forget the message of the first attempt */
  if (rc != 0 && (rc = linear_guess(w, a, pb, t, y, dt, k, at, u)) == 0) rc = lag_discrete_solve(&d);
  if (rc) return rc;
  for (int i = 0; i < nq; i++) {
    for (int j = 0; j < (int)r->free; j++) a->dq[i] += h * (r->whole[j] * u[j * nq + i]);
    for (int j = 0; j < (int)r->points; j++) a->dp[i] += h * (r->b[j] * a->force[j * nq + i]);
  }
  return LAG_OK;
}

void lag_substep_record(const Implicit *w, const ImplicitArrays *a, const lag_problem *pb, int k, const double *u) {
  lag_predictor_add(a->history + (size_t)k * lag_substep_history(pb, w), pb->nq * (int)w->rule[k % 2].free, u);
}

int lag_substeps_velocity(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double tb, const double *y, int known) {
  int nq = pb->nq;
  const double *history = a->history + (size_t)w->substeps * lag_substep_history(pb, w);
  lag_discrete d = {.rule = &w->momentum, .pb = pb, .t = tb, .h = 0, .size = w->step.h, .q = y, .dq = a->ql, .p = a->p,
                    .dp = a->pl, .u = a->v, .force = a->force, .work = a->discrete};
  lag_substeps_gather(a, nq);
  if (!known && !lag_predictor_guess(history, nq, a->v)) memcpy(a->v, a->u, (size_t)nq * sizeof(double));
  return lag_discrete_solve(&d);
}
