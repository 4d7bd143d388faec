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
#define LEAST 1e-6

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

/* The largest correction d[nq] against what x or y is, of the same unit. */
static double part_of(const lag_problem *pb, const double *d, const double *x, const double *y)
{
  double most = 0;

  for (int i = 0; i < pb->nq; i++) {
    most = fmax(most, d[i] == 0.0 ? 0 : fabs(d[i]) / fmax(lag_size_like(pb, x, i), lag_size_like(pb, y, i)));
  }
  return most;
}

/* The same of the correction b->d of a block's end, h long; or its impulse against the whole one, if that is less: what is held at 0 has no
 * size, but the force that holds it there has one. */
static double part_of_block(const lag_problem *pb, const Block *b, double h)
{
  double most = 0;

  for (int i = 0; i < pb->nq; i++) {
    double far = fmax(lag_size_like(pb, b->from, i), lag_size_like(pb, b->to, i)), whole = fabs(h) * lag_size_like(pb, b->impulse, i);
    double part = b->d[i] == 0.0 ? 0 : fabs(b->d[i]) / (far > 0 ? far : lag_reach(pb, b->from, 1, i));
    if (part > 0 && whole > 0) {
      part = far > 0 ? fmin(part, lag_size_like(pb, b->force, i) / whole) : lag_size_like(pb, b->force, i) / whole;
    }
    most = fmax(most, part);
  }
  return most;
}

/* b->change := the least changes where the block begins that each change one constraint by 1. */
static int find_changes(const Arrays *a, lag_problem *pb, double t0)
{
  const Block *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int rc = 0;

  for (int k = 0; k < of->n && rc == 0; k++) {
    memset(b->c, 0, (size_t)of->n * sizeof(double));
    b->c[k] = 1;
    rc = lag_least_change(pb, t0, b->from, of->nholonomic == of->n, b->c, b->change + k * pb->nq, b->force);
  }
  return rc;
}

/* x[n] := B^-1 x by Gauss-Jordan elimination of B[n * n], of which no pivot is smaller than `least`: what such an equation asks for is left
 * alone. r[n] is scratch. */
static void solve(double *B, double *x, double *r, int n, double least)
{
  for (int i = 0; i < n; i++) {
    r[i] = -1; /* which unknown equation i has given */
  }
  for (int turn = 0; turn < n; turn++) {
    int row = -1, col = -1;
    double most = least;
    for (int i = 0; i < n; i++) {
      for (int j = 0; j < n && r[i] < 0; j++) {
        if (fabs(B[i * n + j]) > most) {
          most = fabs(B[i * n + j]);
          row = i;
          col = j;
        }
      }
    }
    if (row < 0) {
      break;
    }
    r[row] = col;
    for (int i = 0; i < n; i++) {
      double factor = i == row ? 0 : B[i * n + col] / B[row * n + col];
      for (int j = 0; j < n && factor != 0.0; j++) {
        B[i * n + j] = j == col ? 0 : B[i * n + j] - factor * B[row * n + j];
      }
      x[i] -= factor * x[row];
    }
  }
  for (int i = 0; i < n; i++) { /* each equation is left with its unknown, and with those that are 0 */
    x[i] = r[i] < 0 ? x[i] : x[i] / B[i * n + (int)r[i]];
  }
}

/* b->turned also has what a change of the block's end does to the coefficients of velocities there: these vanish at the origin for x*y' = y*x', and a
 * block over that place, where they change their sign, is found by nothing less than Newton's method. */
static int turn_rates(const Arrays *a, lag_problem *pb, double t1, double h)
{
  const Block *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  const double small = 1e-3; /* of the way of the block; what is quadratic in it cancels */
  int nq = pb->nq, n = of->n, rc = 0;

  memcpy(b->d, b->to, (size_t)nq * sizeof(double));
  for (int k = 0; k < n; k++) {
    const double *change = b->change + k * nq;
    double part = HUGE_VAL;
    for (int i = 0; i < nq; i++) {
      double way = fabs(h) * lag_size_like(pb, b->to + nq, i);
      part = change[i] != 0.0 && way > 0 ? fmin(part, small * way / fabs(change[i])) : part;
    }
    for (int side = 1; side >= -1 && part < HUGE_VAL && rc == 0; side -= 2) {
      for (int i = 0; i < nq; i++) {
        b->to[i] = b->d[i] + side * part * change[i];
      }
      rc = lag_residuals(pb, t1, b->to, b->c, b->r);
      for (int j = of->nholonomic; j < n && rc == 0; j++) {
        b->turned[j * n + k] += h / 2 * side * b->r[j] / (2 * part);
      }
    }
  }
  memcpy(b->to, b->d, (size_t)nq * sizeof(double));
  return rc;
}

/* A change g of the constraints where the block begins is another one where it ends, and near a singular position, as of a linkage
 * that is stretched, even of the other sign. g := what has to be changed at the beginning for g at the end, at t1, where it is not more than
 * 1/least times that; b->change is known. */
static int steer(const Arrays *a, lag_problem *pb, double t1, double h, double least)
{
  const Block *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, n = of->n, rc = lag_inputs(pb, t1);

  rc = rc ? rc : of->matrices(t1, b->to, b->to + nq, b->to + 2 * nq, pb->p, pb->u, b->A, b->M, pb->work);
  memset(b->turned, 0, (size_t)(n * n) * sizeof(double));
  for (int e = 0; e < of->njacobian && rc == 0; e++) {
    int row = of->jacobian[e].row;
    double part = row < of->nholonomic ? 1 : 0.5;
    for (int k = 0; k < n; k++) {
      b->turned[row * n + k] += part * b->A[e] * b->change[k * nq + of->jacobian[e].col];
    }
  }
  for (int k = of->nholonomic; k < n; k++) {
    b->turned[k * n + k] += 0.5;
  }
  rc = rc == 0 && of->nholonomic < n ? turn_rates(a, pb, t1, h) : rc;
  if (rc == 0) {
    memcpy(b->c, b->g, (size_t)n * sizeof(double));
    solve(b->turned, b->c, b->r, n, least);
    memset(b->g, 0, (size_t)n * sizeof(double));
    for (int i = 0; i < n; i++) {
      if (b->r[i] >= 0) {
        b->g[(int)b->r[i]] = b->c[i];
      }
    }
  }
  return rc;
}

/* No change meets all constraints: some contradict each other. */
static int unmet(lag_problem *pb, double t, const double *y, int holonomic)
{
  int k = lag_worst_constraint(pb, t, y, holonomic, NULL);

  if (k >= 0) {
    lag_say_constraint(pb, k, holonomic, NAN, ", and no small change meets it: it contradicts others, or depends on them here");
  }
  return lag_step_failed(pb, LAG_EMETHOD, t);
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

/* The impulse of a block of links k to k + length - 1, and the block with it. What is left of constraints on positions must be rounding. Of those on
 * velocities it need not be: of two that say the same with other factors a chord obeys one, and is off the other by a part h^2; whether they
 * contradict each other is seen at the block's end, by project(). */
static int push(const Implicit *w, const Arrays *a, lag_problem *pb, double t, double t1, const double *y, double dt, int k, int length,
                double at)
{
  const Block *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, m = nq * (int)w->rule[0].free, steered = 0, known = 0, rc, holonomic = of->nholonomic == of->n;
  size_t bytes = (size_t)nq * sizeof(double);
  double h = 0, before = HUGE_VAL, least = 0.1, *history = b->history + (size_t)k * lag_history_size(of->n);

  for (int j = 0; j < length; j++) {
    h += w->part[k + j] * dt;
  }
  memcpy(b->dq, a->dq, bytes);
  memcpy(b->dp, a->dp, bytes);
  memset(b->impulse, 0, bytes);
  memset(b->sum, 0, (size_t)of->n * sizeof(double));
  if (lag_history_guess(history, of->n, b->g) && lag_least_change(pb, t + at * dt, b->from, holonomic, b->g, b->d, b->force) == 0 &&
      part_of(pb, b->d, b->from + nq, b->from + nq) <= fabs(h)) { /* not where a singular position magnifies what the guess misses */
    add_impulse(b, nq, of->n, h);
  }
  for (int turn = 0; turn < MOST_IMPULSES; turn++) {
    double from = at;
    memcpy(a->dq, b->dq, bytes);
    for (int i = 0; i < nq; i++) {
      a->dp[i] = b->dp[i] + b->impulse[i];
    }
    for (int j = 0; j < length; j++) {
      if ((rc = lag_link(w, a, pb, t, y, dt, k + j, from, a->u + j * m, known)) != 0) {
        return rc;
      }
      from += w->part[k + j];
    }
    known = 1;
    rc = off(a, pb, t + at * dt, t1, h, y);
    if (rc == 0 && steered) {
      rc = steer(a, pb, t1, h, least);
    }
    rc = rc ? rc : lag_least_change(pb, t + at * dt, b->from, holonomic, b->g, b->d, b->force);
    if (rc) {
      return lag_step_refused(pb, rc, t + at * dt);
    }
    if (lag_not_finite(nq, b->d) >= 0) {
      break;
    }
    double part = part_of_block(pb, b, h);
    double rounding = DBL_EPSILON * (steered ? 0x1p12 : 4); /* near a singular position it is magnified */
    int settled = part <= DBL_EPSILON / 4 || (part <= rounding && part >= before / 2);
    if (!settled && steered && part >= before / 2 && lag_residuals(pb, t1, b->to, b->c, b->r) == 0) {
      settled = lag_is_met(pb, t1, b->to, 1, b->c); /* rounding of terms that no coordinate shows, as of one at 0 */
    }
    if (settled) {
      if (steered && least > LEAST) {
        least = LEAST;
        before = HUGE_VAL;
        continue;
      }
      lag_history_add(history, of->n, b->sum);
      rc = lag_residuals(pb, t1, b->to, b->c, b->r);
      return rc ? lag_step_refused(pb, rc, t1) : lag_is_met(pb, t1, b->to, 1, b->c) ? LAG_OK : unmet(pb, t1, b->to, 1);
    }
    if (!steered && turn > 0 && part > before / 16) { /* too slow */
      steered = 1;
      known = 0;
      memset(b->impulse, 0, bytes);
      memset(b->sum, 0, (size_t)of->n * sizeof(double));
      if ((rc = find_changes(a, pb, t + at * dt)) != 0) {
        return lag_step_refused(pb, rc, t + at * dt);
      }
    } else {
      add_impulse(b, nq, of->n, h);
    }
    before = part;
  }
  pb->detail = "no impulse was found that leads to the constraints; take smaller steps, or dop853";
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

/* The momentum at the end of a block, tb: r = 0. v is that of it. */
static int project(const Implicit *w, const Arrays *a, lag_problem *pb, double tb, const double *y, int last)
{
  const Block *b = &a->block;
  int nq = pb->nq, rc = 0, done = 0;

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
    done = part_of(pb, b->d, b->to + nq, a->v) <= 1e-8;
  }
  memcpy(b->to + nq, a->v, (size_t)nq * sizeof(double));
  rc = lag_residuals(pb, tb, b->to, b->c, b->r);
  return rc ? lag_step_refused(pb, rc, tb) : lag_is_met(pb, tb, b->to, 0, b->r) ? LAG_OK : unmet(pb, tb, b->to, 0);
}

/* Whether a block, h long, has moved coordinates no farther than the velocities at its ends account for: elsewhere a constraint jumps. */
static int check_leap(const Arrays *a, lag_problem *pb, double t1, double h)
{
  const Block *b = &a->block;
  int nq = pb->nq;

  for (int i = 0; i < nq; i++) {
    b->d[i] = b->to[i] - b->from[i];
    b->force[i] = 2 * h * fmax(fabs(b->from[nq + i]), fabs(a->v[i])); /* in between it may be faster */
  }
  int i = lag_leaps(pb, b->from, b->to, b->d, b->force);
  return i < 0 ? LAG_OK : lag_step_unmet(pb, lag_say_leap(pb, t1, b->from, i, b->d[i]), t1);
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
    rc = rc ? rc : check_leap(a, pb, t1, (at - begin) * dt);
    memcpy(b->from, b->to, (size_t)nq * sizeof(double));
    memcpy(b->from + nq, a->v, (size_t)nq * sizeof(double));
  }
  return rc;
}
