/* The substeps of a step in q and p. Enters: the present q and p; leaves: the increments of a substep. Holds: within a step q and p are kept as
 * values at its start plus increments, so that sums lose nothing to rounding. */
#include "methods/substeps.h"

#include <string.h>

#include "methods/discrete_lagrangian.h"
#include "methods/predictor.h"
#include "methods/step_interpolant.h"
#include "methods/steps.h"

size_t lag_substep_history(const lag_problem *pb, const Implicit *w)
{
  return lag_predictor_size(pb->nq * (int)w->rule[0].free);
}

static ConstraintBlock block(double *x, const lag_problem *pb)
{
  ConstraintBlock b;
  const lag_constraints *of = pb->model->constraints;
  int n = pb->n, nq = pb->nq, nc = of->n;
  double **const parts[] = {&b.from, &b.to, &b.dq, &b.dp, &b.impulse, &b.d, &b.force, &b.c, &b.r, &b.g, &b.sum,
                            &b.A, &b.M, &b.change, &b.end_jacobian, &b.history};
  const int sizes[] = {n, n, nq, nq, nq, nq, nq, nc, nc, nc, nc, of->njacobian, of->nmass, nc * nq, nc * nc, 0};

  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    *parts[i] = x;
    x += sizes[i];
  }
  return b;
}

static size_t block_size(const lag_problem *pb, int substeps)
{
  const lag_constraints *of = pb->model->constraints;

  return of ? (size_t)(2 * pb->n + 5 * pb->nq + 4 * of->n + of->njacobian + of->nmass + of->n * (pb->nq + of->n)) + (size_t)substeps * lag_predictor_size(of->n) : 0;
}

ImplicitArrays lag_substeps_arrays(Implicit *w, const lag_problem *pb)
{
  ImplicitArrays a;
  double *x = w->x;
  int nq = pb->nq, free = (int)w->rule[0].free;
  double **const of_nq[] = {&a.p, &a.qc, &a.pc, &a.dq, &a.dp, &a.ql, &a.pl, &a.v};
  double **const of_n[] = {&a.y0, &a.y1, &a.f0, &a.f1};

  for (size_t i = 0; i < sizeof of_nq / sizeof *of_nq; i++, x += nq) {
    *of_nq[i] = x;
  }
  for (size_t i = 0; i < sizeof of_n / sizeof *of_n; i++, x += pb->n) {
    *of_n[i] = x;
  }
  a.u = x;
  a.force = a.u + 2 * free * nq;
  a.history = a.force + (free + 1) * nq;
  a.path = a.history + (size_t)w->substeps * lag_substep_history(pb, w) + lag_predictor_size(nq);
  a.discrete = a.path + lag_interpolant_size(nq);
  a.block = pb->model->constraints ? block(a.discrete + lag_discrete_size(pb, free), pb) : (ConstraintBlock){0};
  return a;
}

size_t lag_substeps_size(const lag_problem *pb, int free, int substeps)
{
  size_t nq = (size_t)pb->nq, m = nq * (size_t)free;

  return sizeof(Implicit) / sizeof(double) + 8 * nq + 4 * (size_t)pb->n + 3 * m + nq + block_size(pb, substeps) +
         (size_t)substeps * lag_predictor_size((int)m) + lag_predictor_size((int)nq) + lag_interpolant_size((int)nq) +
         lag_discrete_size(pb, free);
}

/* Initial guess: u := velocities at the nodes of substep k, extrapolated linearly from y at t. */
static int linear_guess(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, const double *y, double dt, int k, double at, double *u)
{
  const lag_rule *r = &w->rule[k % 2];
  int nq = pb->nq, rc = lag_step_rhs(pb, t, y, a->f1);

  for (int j = 0; j < (int)r->free && rc == 0; j++) {
    for (int i = 0; i < nq; i++) {
      u[j * nq + i] = y[nq + i] + dt * (at + w->part[k] * r->node[j]) * a->f1[nq + i];
    }
  }
  return rc;
}

void lag_substeps_gather(const ImplicitArrays *a, int nq)
{
  for (int i = 0; i < nq; i++) {
    a->ql[i] = a->qc[i] + a->dq[i];
    a->pl[i] = a->pc[i] + a->dp[i];
  }
}

int lag_substep(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, const double *y, double dt, int k, double at, double *u,
             int known)
{
  const lag_rule *r = &w->rule[k % 2];
  int nq = pb->nq, m = nq * (int)r->free, rc = LAG_EMETHOD;
  double *history = a->history + (size_t)k * lag_substep_history(pb, w), h = w->part[k] * dt;
  lag_discrete d = {.rule = r, .pb = pb, .t = t + at * dt, .h = h, .size = w->step.h, .q = y, .dq = a->ql, .p = a->p,
                    .dp = a->pl, .u = u, .force = a->force, .work = a->discrete, .counted = 1};

  lag_substeps_gather(a, nq);
  if (known || lag_predictor_guess(history, m, u)) {
    rc = lag_discrete_solve(&d);
  }
  pb->detail = NULL; /* forget the message of the first attempt */
  if (rc != 0 && (rc = linear_guess(w, a, pb, t, y, dt, k, at, u)) == 0) {
    rc = lag_discrete_solve(&d);
  }
  if (rc) {
    return rc;
  }
  for (int i = 0; i < nq; i++) {
    for (int j = 0; j < (int)r->free; j++) {
      a->dq[i] += h * (r->whole[j] * u[j * nq + i]);
    }
    for (int j = 0; j < (int)r->points; j++) {
      a->dp[i] += h * (r->b[j] * a->force[j * nq + i]);
    }
  }
  return LAG_OK;
}

void lag_substep_record(const Implicit *w, const ImplicitArrays *a, const lag_problem *pb, int k, const double *u)
{
  lag_predictor_add(a->history + (size_t)k * lag_substep_history(pb, w), pb->nq * (int)w->rule[k % 2].free, u);
}

int lag_substeps_velocity(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double tb, const double *y, int known)
{
  int nq = pb->nq;
  const double *history = a->history + (size_t)w->substeps * lag_substep_history(pb, w);
  lag_discrete d = {.rule = &w->momentum, .pb = pb, .t = tb, .h = 0, .size = w->step.h, .q = y, .dq = a->ql, .p = a->p,
                    .dp = a->pl, .u = a->v, .force = a->force, .work = a->discrete};

  lag_substeps_gather(a, nq);
  if (!known && !lag_predictor_guess(history, nq, a->v)) {
    memcpy(a->v, a->u, (size_t)nq * sizeof(double));
  }
  return lag_discrete_solve(&d);
}
