/* Steps under constraints, by the discrete Lagrange-d'Alembert principle. Enters: where a step begins, on the constraints; leaves: its
 * end, on the constraints. Holds: an impulse at the beginning of a block, of the kind that the constraints
 * there can exert, leads it to c = 0 at its end, and the momentum at the end is projected to r = 0: RATTLE where L is separable.
 *
 * Sources: H.C.
 * Andersen, J. Comput. Phys. 52 (1983) 24, DOI 10.1016/0021-9991(83)90014-1; J.E. Marsden, M. West (rule.h), section 3.5; Hairer,
 * Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), VII.1. A constraint of velocities alone holds for the chord of the
 * block, in the mean of its two ends, a rule that is its own reverse: J. Cortes, S. Martinez, Nonlinearity 14 (2001) 1365, DOI
 * 10.1088/0951-7715/14/5/322; R. McLachlan, M. Perlmutter, J. Nonlinear Sci. 16 (2006) 283, DOI 10.1007/s00332-005-0698-1. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "methods/history.h"
#include "methods/links.h"
#include "methods/steps.h"

enum { MOST_IMPULSES = 60, MOST_PROJECTIONS = 8 };

/* Links that end on the constraints together: both halves of a Verlet step, where the composition is one of Verlet steps. */
static int block_length(const Implicit *w)
{
  int whole = (int)w->links % 2 == 0;

  for (int k = 0; k + 1 < (int)w->links; k += 2) {
    whole &= w->part[k] == w->part[k + 1];
  }
  return whole ? 2 : 1;
}

/* b->to := [q|v of the chord] where the step is now, at t1, h after the block began at t0; g := how far that is off the constraints. */
static int off(const Arrays *a, lag_problem *pb, double t0, double t1, double h, const double *y)
{
  const Block *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, rc;

  lag_links_gather(a, nq);
  for (int i = 0; i < nq; i++) {
    b->to[i] = y[i] + a->ql[i];
    b->to[nq + i] = (a->dq[i] - b->dq[i]) / h;
  }
  if ((rc = lag_residuals(pb, t1, b->to, b->c, b->r)) != 0) {
    return rc;
  }
  for (int k = 0; k < of->n; k++) {
    b->g[k] = k < of->nholonomic ? -b->c[k] : -h / 2 * b->r[k];
  }
  if (of->n > of->nholonomic) {
    memcpy(b->d, b->from + nq, (size_t)nq * sizeof(double));
    memcpy(b->from + nq, b->to + nq, (size_t)nq * sizeof(double));
    rc = lag_residuals(pb, t0, b->from, b->c, b->r);
    memcpy(b->from + nq, b->d, (size_t)nq * sizeof(double));
    for (int k = of->nholonomic; k < of->n; k++) {
      b->g[k] -= h / 2 * b->r[k];
    }
  }
  return rc;
}

/* The largest correction d[nq] of x against what x is, of the same unit. */
static double part_of(const lag_problem *pb, const double *d, const double *x)
{
  double most = 0;

  for (int i = 0; i < pb->nq; i++) {
    most = fmax(most, d[i] == 0.0 ? 0 : fabs(d[i]) / lag_size_like(pb, x, i));
  }
  return most;
}

/* A change of the end of a block, h long, takes this impulse at its beginning. */
static void add_impulse(const Block *b, int nq, int nc, double h)
{
  for (int i = 0; i < nq; i++) {
    b->impulse[i] += b->force[i] / h;
  }
  for (int k = 0; k < nc; k++) {
    b->sum[k] += b->g[k];
  }
}

/* The impulse of a block of links k to k + length - 1, and the block with it. */
static int push(const Implicit *w, const Arrays *a, lag_problem *pb, double t, double t1, const double *y, double dt, int k, int length,
                double at)
{
  const Block *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, m = nq * (int)w->rule[0].free, rc, holonomic = of->nholonomic == of->n;
  size_t bytes = (size_t)nq * sizeof(double);
  double h = 0, before = HUGE_VAL, *history = b->history + (size_t)k * lag_history_size(of->n);

  for (int j = 0; j < length; j++) {
    h += w->part[k + j] * dt;
  }
  memcpy(b->dq, a->dq, bytes);
  memcpy(b->dp, a->dp, bytes);
  memset(b->impulse, 0, bytes);
  memset(b->sum, 0, (size_t)of->n * sizeof(double));
  if (lag_history_guess(history, of->n, b->g) && lag_least_change(pb, t + at * dt, b->from, holonomic, b->g, b->d, b->force) == 0 &&
      lag_not_finite(nq, b->force) < 0) {
    add_impulse(b, nq, of->n, h);
  }
  for (int turn = 0; turn < MOST_IMPULSES; turn++) {
    double from = at;
    memcpy(a->dq, b->dq, bytes);
    for (int i = 0; i < nq; i++) {
      a->dp[i] = b->dp[i] + b->impulse[i];
    }
    for (int j = 0; j < length; j++) {
      if ((rc = lag_link(w, a, pb, t, y, dt, k + j, from, a->u + j * m, turn > 0)) != 0) {
        return rc;
      }
      from += w->part[k + j];
    }
    rc = off(a, pb, t + at * dt, t1, h, y);
    rc = rc ? rc : lag_least_change(pb, t + at * dt, b->from, holonomic, b->g, b->d, b->force);
    if (rc) {
      return lag_step_refused(pb, rc, t + at * dt);
    }
    if (lag_not_finite(nq, b->d) >= 0) {
      break;
    }
    double part = part_of(pb, b->d, b->to);
    if (part <= DBL_EPSILON / 4 || (part <= 1e-8 && part >= before / 2)) {
      lag_history_add(history, of->n, b->sum);
      return LAG_OK;
    }
    add_impulse(b, nq, of->n, h);
    before = part;
  }
  pb->detail = "no impulse was found that leads to the constraints; take smaller steps, or dop853";
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

/* The momentum at the end of a block, tb: r = 0. v is that of it. */
static int project(const Implicit *w, const Arrays *a, lag_problem *pb, double tb, const double *y, int last)
{
  const Block *b = &a->block;
  int nq = pb->nq, rc, done = 0;

  for (int turn = 0; turn < MOST_PROJECTIONS && !done; turn++) {
    if ((rc = lag_links_velocity(w, a, pb, tb, y, turn > 0 || !last)) != 0) {
      return rc;
    }
    memcpy(b->to + nq, a->v, (size_t)nq * sizeof(double));
    rc = lag_residuals(pb, tb, b->to, b->c, b->r);
    for (int k = 0; k < pb->model->constraints->n; k++) {
      b->g[k] = -b->r[k];
    }
    rc = rc ? rc : lag_least_change(pb, tb, b->to, 0, b->g, b->d, b->force);
    if (rc || lag_not_finite(nq, b->d) >= 0) {
      return rc ? lag_step_refused(pb, rc, tb) : lag_step_failed(pb, LAG_ENAN, tb);
    }
    for (int i = 0; i < nq; i++) {
      a->dp[i] += b->force[i];
      a->v[i] += b->d[i];
    }
    done = part_of(pb, b->d, a->v) <= 1e-8;
  }
  return LAG_OK;
}

int lag_rattle(const Implicit *w, const Arrays *a, lag_problem *pb, double t, double tb, const double *y, double dt)
{
  const Block *b = &a->block;
  int nq = pb->nq, m = nq * (int)w->rule[0].free, length = block_length(w), links = (int)w->links, rc = 0;
  double at = 0;

  memcpy(b->from, y, (size_t)pb->n * sizeof(double));
  for (int k = 0; k < links && rc == 0; k += length) {
    int last = k + length == links;
    double begin = at;
    for (int j = 0; j < length; j++) {
      at += w->part[k + j];
    }
    double t1 = last ? tb : t + at * dt;
    if ((rc = push(w, a, pb, t, t1, y, dt, k, length, begin)) != 0) {
      return rc;
    }
    for (int j = 0; j < length; j++) {
      lag_link_note(w, a, pb, k + j, a->u + j * m);
    }
    if (!last) {
      memcpy(a->v, b->to + nq, (size_t)nq * sizeof(double));
    }
    rc = project(w, a, pb, t1, y, last);
    memcpy(b->from, b->to, (size_t)nq * sizeof(double));
    memcpy(b->from + nq, a->v, (size_t)nq * sizeof(double));
  }
  return rc;
}
