/* Steps with constraints, by the discrete Lagrange-d'Alembert principle. Enters: the start of a step, on the
 * constraints; leaves: its end, on the constraints. Algorithm: a constraint impulse at the start of a block brings
 * its end to c = 0, and the momentum at the end is projected to r = 0: RATTLE where L is separable.
 *
 * Sources: H.C. Andersen, J. Comput. Phys. 52 (1983) 24, DOI 10.1016/0021-9991(83)90014-1; J.E. Marsden, M. West
 * (galerkin_rule.h), section 3.5; Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), VII.1. A
 * constraint on velocities holds for the chord of the block, in the mean of its two ends, a symmetric rule: J.
 * Cortes, S. Martinez, Nonlinearity 14 (2001) 1365, DOI 10.1088/0951-7715/14/5/322; R. McLachlan, M. Perlmutter, J.
 * Nonlinear Sci. 16 (2006) 283, DOI 10.1007/s00332-005-0698-1. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "methods/implicit_symplectic.h"
#include "kernels/predictor.h"
#include "methods/steps.h"
#include "numeric/dense.h"

enum { MOST_IMPULSES = 60, MOST_PROJECTIONS = 8 };
#define LEAST 1e-6

/* Substeps in a block: 2, the halves of a Verlet step, where the composition is one of Verlet steps; else 1. */
static int block_length(const Implicit *w) {
  int whole = (int)w->substeps % 2 == 0;
  for (int k = 0; k + 1 < (int)w->substeps; k += 2) whole &= w->part[k] == w->part[k + 1];
  return whole ? 2 : 1;
}

/* b->to := [q|v], the present q and the velocity of the chord, at t1 = t0 + h, where t0 is the start of the block.
 * b->g := minus the constraint defect there. Returns the model's status. */
static int constraint_defect(const ImplicitArrays *a, lag_problem *pb, double t0, double t1, double h,
                             const double *y) {
  const ConstraintBlock *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, rc;
  lag_substeps_gather(a, nq);
  for (int i = 0; i < nq; i++) {
    b->to[i] = y[i] + a->ql[i];
    b->to[nq + i] = (a->dq[i] - b->dq[i]) / h;
  }
  if ((rc = lag_residuals(pb, t1, b->to, b->c, b->r)) != 0) return rc;
  for (int k = 0; k < of->n; k++) b->g[k] = k < of->nholonomic ? -b->c[k] : -h / 2 * b->r[k];
  if (of->n > of->nholonomic) {
    memcpy(b->d, b->from + nq, (size_t)nq * sizeof(double));
    memcpy(b->from + nq, b->to + nq, (size_t)nq * sizeof(double));
    rc = lag_residuals(pb, t0, b->from, b->c, b->r);
    memcpy(b->from + nq, b->d, (size_t)nq * sizeof(double));
    for (int k = of->nholonomic; k < of->n; k++) b->g[k] -= h / 2 * b->r[k];
  }
  return rc;
}

/* The largest |d_i| of d[nq] relative to the largest |x| or |y| of the same unit. */
static double relative_size(const lag_problem *pb, const double *d, const double *x, const double *y) {
  double most = 0;
  for (int i = 0; i < pb->nq; i++)
    most = fmax(most, d[i] == 0.0 ? 0 : fabs(d[i]) / fmax(lag_unit_magnitude(pb, x, i), lag_unit_magnitude(pb, y, i)));
  return most;
}

/* Relative size of the correction b->d of the end of a block of length h; or of its impulse relative to the whole
 * impulse, if smaller: coordinates held at 0 have no size, but the force that holds them has one. */
static double relative_size_of_block(const lag_problem *pb, const ConstraintBlock *b, double h) {
  double most = 0;
  for (int i = 0; i < pb->nq; i++) {
    double far = fmax(lag_unit_magnitude(pb, b->from, i), lag_unit_magnitude(pb, b->to, i)),
           whole = fabs(h) * lag_unit_magnitude(pb, b->impulse, i);
    double part = b->d[i] == 0.0 ? 0 : fabs(b->d[i]) / (far > 0 ? far : lag_typical_magnitude(pb, b->from, 1, i));
    if (part > 0 && whole > 0)
      part = far > 0 ? fmin(part, lag_unit_magnitude(pb, b->force, i) / whole)
                     : lag_unit_magnitude(pb, b->force, i) / whole;
    most = fmax(most, part);
  }
  return most;
}

/* b->change := for each constraint, the least change at the start of the block that changes it by 1. */
static int find_changes(const ImplicitArrays *a, lag_problem *pb, double t0) {
  const ConstraintBlock *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int rc = 0;
  for (int k = 0; k < of->n && rc == 0; k++) {
    memset(b->c, 0, (size_t)of->n * sizeof(double));
    b->c[k] = 1;
    rc = lag_least_change(pb, t0, b->from, of->nholonomic == of->n, b->c, b->change + k * pb->nq, b->force);
  }
  return rc;
}

/* b->g: from the change of constraints wanted at the end of a block, t1, to the change at its start that causes it;
 * pivots below `least` are left out. The two differ near a singular position, even in sign, as of a stretched
 * linkage. Needs b->change. */
static int end_to_start_change(const ImplicitArrays *a, lag_problem *pb, double t1, double least) {
  const ConstraintBlock *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, n = of->n, rc = lag_inputs(pb, t1);
  rc = rc ? rc : of->matrices(of, t1, b->to, b->to + nq, b->to + 2 * nq, pb->p, pb->u, b->A, b->M, pb->work);
  memset(b->end_jacobian, 0, (size_t)(n * n) * sizeof(double));
  for (int e = 0; e < of->njacobian && rc == 0; e++) {
    int row = of->jacobian[e].row;
    double part = row < of->nholonomic ? 1 : 0.5;
    for (int k = 0; k < n; k++)
      b->end_jacobian[row * n + k] += part * b->A[e] * b->change[k * nq + of->jacobian[e].col];
  }
  for (int k = of->nholonomic; k < n; k++) b->end_jacobian[k * n + k] += 0.5;
  if (rc == 0) {
    memcpy(b->c, b->g, (size_t)n * sizeof(double));
    lag_gauss_jordan(n, b->end_jacobian, b->c, b->r, least);
    memset(b->g, 0, (size_t)n * sizeof(double));
    for (int i = 0; i < n; i++)
      if (b->r[i] >= 0) b->g[(int)b->r[i]] = b->c[i];
  }
  return rc;
}

/* LAG_EMETHOD: no small change meets all constraints; pb->detail names the worst. */
static int contradiction(lag_problem *pb, double t, const double *y, int holonomic) {
  int k = lag_worst_constraint(pb, t, y, holonomic, NULL);
  if (k >= 0)
    lag_report_residual(pb, k, holonomic, NAN,
                        ", and no small change meets it: it contradicts others, or depends on them here");
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

/* Adds the impulse at the start of a block of length h for the change b->d of its end, and g to its sum. */
static void add_impulse(const ConstraintBlock *b, int nq, int nc, double h) {
  for (int i = 0; i < nq; i++) b->impulse[i] += b->force[i] / h;
  for (int k = 0; k < nc; k++) b->sum[k] += b->g[k];
}

/* A block of substeps k to k + length - 1 in a step dt from t, y: it begins at the part `at`, lasts h and ends at
 * t1. */
typedef struct Span {
  double t, t1, dt, at, h;
  const double *y;
  int k, length;
} Span;

/* Begins with the impulse that earlier blocks lead to. */
static void begin_impulse(const ImplicitArrays *a, lag_problem *pb, const Span *s, double *history) {
  const ConstraintBlock *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq;
  size_t bytes = (size_t)nq * sizeof(double);
  memcpy(b->dq, a->dq, bytes);
  memcpy(b->dp, a->dp, bytes);
  memset(b->impulse, 0, bytes);
  memset(b->sum, 0, (size_t)of->n * sizeof(double));
  if (lag_predictor_guess(history, of->n, b->g) &&
      lag_least_change(pb, s->t + s->at * s->dt, b->from, of->nholonomic == of->n, b->g, b->d, b->force) == 0 &&
      /* no guess where a singular position magnifies its error */
      relative_size(pb, b->d, b->from + nq, b->from + nq) <= fabs(s->h))
    add_impulse(b, nq, of->n, s->h);
}

/* The substeps with the present impulse. known: their velocities are about known. */
static int make_substeps(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const Span *s, int known) {
  int nq = pb->nq, m = nq * (int)w->rule[0].free, rc = 0;
  double from = s->at;
  memcpy(a->dq, a->block.dq, (size_t)nq * sizeof(double));
  for (int i = 0; i < nq; i++) a->dp[i] = a->block.dp[i] + a->block.impulse[i];
  for (int j = 0; j < s->length && rc == 0; j++) {
    rc = lag_substep(w, a, pb, &(Substep){s->k + j, s->t, s->dt, from, s->y}, a->u + j * m, known);
    from += w->part[s->k + j];
  }
  return rc;
}

/* The impulse leads to the constraints. */
static int accept_impulse(const ConstraintBlock *b, lag_problem *pb, double t1, double *history) {
  lag_predictor_add(history, pb->model->constraints->n, b->sum);
  int rc = lag_residuals(pb, t1, b->to, b->c, b->r);
  return rc                                              ? lag_step_refused(pb, rc, t1)
         : lag_constraint_is_met(pb, t1, b->to, 1, b->c) ? LAG_OK
                                                         : contradiction(pb, t1, b->to, 1);
}

/* Solves a block for its impulse. The defects of constraints on positions must end as rounding. Those on velocities
 * need not: of two equivalent ones with different factors the chord meets one, and misses the other by O(h^2);
 * project() finds contradictions at the end of the block. */
static int find_impulse(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const Span *s) {
  const ConstraintBlock *b = &a->block;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, steered = 0, rc;
  double ta = s->t + s->at * s->dt, t1 = s->t1, before = HUGE_VAL, least = 0.1;
  double *history = b->history + (size_t)s->k * (size_t)LAG_PREDICTOR_SIZE(of->n);

  begin_impulse(a, pb, s, history);
  for (int turn = 0, known = 0; turn < MOST_IMPULSES; turn++) {
    if ((rc = make_substeps(w, a, pb, s, known)) != 0) return rc;
    known = 1;
    rc = constraint_defect(a, pb, ta, t1, s->h, s->y);
    if (rc == 0 && steered) rc = end_to_start_change(a, pb, t1, least);
    rc = rc ? rc : lag_least_change(pb, ta, b->from, of->nholonomic == of->n, b->g, b->d, b->force);
    if (rc) return lag_step_refused(pb, rc, ta);
    if (lag_not_finite(nq, b->d) >= 0) break;
    double part = relative_size_of_block(pb, b, s->h);
    double rounding = DBL_EPSILON * (steered ? 0x1p12 : 4); /* rounding is magnified near a singular position */
    int settled = part <= DBL_EPSILON / 4 || (part <= rounding && part >= before / 2);
    if (!settled && steered && part >= before / 2 && lag_residuals(pb, t1, b->to, b->c, b->r) == 0)
      /* rounding of terms that no coordinate has the size of, as at 0 */
      settled = lag_constraint_is_met(pb, t1, b->to, 1, b->c);
    if (settled && !(steered && least > LEAST)) return accept_impulse(b, pb, t1, history);
    if (settled) {
      least = LEAST;
      before = HUGE_VAL;
      continue;
    }
    if (!steered && turn > 0 && part > before / 16) { /* converges too slowly: use the changes at the end */
      steered = 1;
      known = 0;
      memset(b->impulse, 0, (size_t)nq * sizeof(double));
      memset(b->sum, 0, (size_t)of->n * sizeof(double));
      if ((rc = find_changes(a, pb, ta)) != 0) return lag_step_refused(pb, rc, ta);
    } else {
      add_impulse(b, nq, of->n, s->h);
    }
    before = part;
  }
  pb->detail = "no impulse was found that leads to the constraints; take smaller steps, or dop853";
  return lag_step_failed(pb, LAG_EMETHOD, s->t);
}

/* Projects the momentum at the end of a block, tb, to r = 0; a->v := its velocity. */
static int project(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double tb, const double *y, int last) {
  const ConstraintBlock *b = &a->block;
  int nq = pb->nq, rc = 0, done = 0;
  for (int turn = 0; turn < MOST_PROJECTIONS && !done; turn++) {
    if ((rc = lag_substeps_velocity(w, a, pb, tb, y, turn > 0 || !last)) != 0) return rc;
    memcpy(b->to + nq, a->v, (size_t)nq * sizeof(double));
    rc = lag_residuals(pb, tb, b->to, b->c, b->r);
    for (int k = 0; k < pb->model->constraints->n; k++) b->g[k] = -b->r[k];
    rc = rc ? rc : lag_least_change(pb, tb, b->to, 0, b->g, b->d, b->force);
    if (rc || lag_not_finite(nq, b->d) >= 0)
      return rc ? lag_step_refused(pb, rc, tb) : lag_step_failed(pb, LAG_ENAN, tb);
    for (int i = 0; i < nq; i++) {
      a->dp[i] += b->force[i];
      a->v[i] += b->d[i];
    }
    done = relative_size(pb, b->d, b->to + nq, a->v) <= 1e-8;
  }
  memcpy(b->to + nq, a->v, (size_t)nq * sizeof(double));
  rc = lag_residuals(pb, tb, b->to, b->c, b->r);
  return rc                                              ? lag_step_refused(pb, rc, tb)
         : lag_constraint_is_met(pb, tb, b->to, 0, b->r) ? LAG_OK
                                                         : contradiction(pb, tb, b->to, 0);
}

/* A failure where a block of length h moved a coordinate farther than the velocities at its ends explain: a
 * constraint jumps there. */
static int check_leap(const ImplicitArrays *a, lag_problem *pb, double t1, double h) {
  const ConstraintBlock *b = &a->block;
  int nq = pb->nq;
  for (int i = 0; i < nq; i++) {
    b->d[i] = b->to[i] - b->from[i];
    b->force[i] = 2 * h * fmax(fabs(b->from[nq + i]), fabs(a->v[i])); /* factor 2: it may be faster in between */
  }
  int i = lag_projection_leap(pb, b->from, b->to, b->d, b->force);
  return i < 0 ? LAG_OK : lag_step_not_projected(pb, lag_report_leap(pb, t1, b->from, i, b->d[i]), t1);
}

int lag_rattle(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, double tb, const double *y,
               double dt) {
  const ConstraintBlock *b = &a->block;
  int nq = pb->nq, m = nq * (int)w->rule[0].free, length = block_length(w), substeps = (int)w->substeps, rc = 0;
  double at = 0;
  memcpy(b->from, y, (size_t)pb->n * sizeof(double));
  for (int k = 0; k < substeps && rc == 0; k += length) {
    int last = k + length == substeps;
    Span s = {.t = t, .dt = dt, .at = at, .y = y, .k = k, .length = length};
    for (int j = 0; j < length; j++) {
      at += w->part[k + j];
      s.h += w->part[k + j] * dt;
    }
    s.t1 = last ? tb : t + at * dt;
    if ((rc = find_impulse(w, a, pb, &s)) != 0) return rc;
    for (int j = 0; j < length; j++) lag_substep_record(w, a, pb, k + j, a->u + j * m);
    if (!last) memcpy(a->v, b->to + nq, (size_t)nq * sizeof(double));
    rc = project(w, a, pb, s.t1, y, last);
    rc = rc ? rc : check_leap(a, pb, s.t1, (at - s.at) * dt);
    memcpy(b->from, b->to, (size_t)nq * sizeof(double));
    memcpy(b->from + nq, a->v, (size_t)nq * sizeof(double));
  }
  return rc;
}
