/* Symplectic steps in q and p for any L. Enters: t, y = [q|v]; leaves: t + h, y one step later. Holds: p is carried
 * from step to step, and v is solved from dL/dv(q, v) = p; within a step q and p are values at its start plus
 * increments, and sums over steps of q, p and t are compensated (steps.h). Dense output is a polynomial through both
 * ends (step_interpolant.h): accurate to the order of the method, not symplectic. */
#include "methods/implicit_symplectic.h"

#include <math.h>
#include <string.h>

#include "methods/discrete_lagrangian.h"
#include "kernels/predictor.h"
#include "methods/step_interpolant.h"
#include "methods/steps.h"
#include "methods/method_tangent.h"
#include "numeric/workspace.h"

/* Doubles of the history of one substep. */
static size_t substep_history(const lag_problem *pb, const Implicit *w) {
  return (size_t)LAG_PREDICTOR_SIZE(pb->nq * (int)w->rule[0].free);
}

/* Sets the pointers of a block, unless x is NULL; returns its length. */
static size_t block_layout(ConstraintBlock *b, const lag_problem *pb, int substeps, double *x) {
  const lag_constraints *of = pb->model->constraints;
  size_t n = (size_t)pb->n, nq = (size_t)pb->nq, nc = (size_t)of->n;
  const lag_part parts[] = {{&b->from, n}, {&b->to, n}, {&b->dq, nq}, {&b->dp, nq}, {&b->impulse, nq}, {&b->d, nq},
      {&b->force, nq}, {&b->c, nc}, {&b->r, nc}, {&b->g, nc}, {&b->sum, nc}, {&b->A, (size_t)of->njacobian},
      {&b->M, (size_t)of->nmass}, {&b->change, nc * nq}, {&b->end_jacobian, nc * nc},
      {&b->history, (size_t)substeps * (size_t)LAG_PREDICTOR_SIZE(of->n)}};
  return lag_workspace_slice(x, sizeof parts / sizeof *parts, parts);
}

/* Sets the pointers, unless x is NULL; returns the length of Implicit.x. */
static size_t state_layout(ImplicitArrays *a, const lag_problem *pb, int free, int substeps, double *x) {
  const int constrained = pb->model->constraints != NULL;
  size_t n = (size_t)pb->n, nq = (size_t)pb->nq, m = nq * (size_t)free;
  const lag_part parts[] = {{&a->p, nq}, {&a->qc, nq}, {&a->pc, nq}, {&a->dq, nq}, {&a->dp, nq}, {&a->ql, nq},
      {&a->pl, nq}, {&a->v, nq}, {&a->y0, n}, {&a->y1, n}, {&a->f0, n}, {&a->f1, n}, {&a->u, 2 * m}, {&a->force, m},
      {&a->history, (size_t)substeps * (size_t)LAG_PREDICTOR_SIZE((int)m) + (size_t)LAG_PREDICTOR_SIZE(pb->nq)},
      {&a->path, lag_interpolant_size(pb->nq)},
      /* the search for its band takes time in each step */
      {&a->discrete, x && !constrained ? 0 : lag_discrete_size(pb, free)}};
  size_t length = lag_workspace_slice(x, sizeof parts / sizeof *parts, parts);
  return length + (constrained ? block_layout(&a->block, pb, substeps, x ? x + length : NULL) : 0);
}

static ImplicitArrays arrays(Implicit *w, const lag_problem *pb) {
  ImplicitArrays a;
  state_layout(&a, pb, (int)w->rule[0].free, (int)w->substeps, w->x);
  return a;
}

static size_t state_size(const lag_problem *pb, int free, int substeps) {
  ImplicitArrays a;
  return sizeof(Implicit) / sizeof(double) + state_layout(&a, pb, free, substeps, NULL);
}

/* Initial guess: u := velocities at the nodes of the substep, extrapolated linearly from y at t. */
static int linear_guess(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const Substep *s, double *u) {
  const lag_rule *r = &w->rule[s->k % 2];
  int nq = pb->nq, rc = lag_step_rhs(pb, s->t, s->y, a->f1);
  for (int j = 0; j < (int)r->free && rc == 0; j++)
    for (int i = 0; i < nq; i++)
      u[j * nq + i] = s->y[nq + i] + s->dt * (s->at + w->part[s->k] * r->node[j]) * a->f1[nq + i];
  return rc;
}

void lag_substeps_gather(const ImplicitArrays *a, int nq) {
  for (int i = 0; i < nq; i++) {
    a->ql[i] = a->qc[i] + a->dq[i];
    a->pl[i] = a->pc[i] + a->dp[i];
  }
}

int lag_substep(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const Substep *s, double *u, int known) {
  const lag_rule *r = &w->rule[s->k % 2];
  int nq = pb->nq, m = nq * (int)r->free, rc = LAG_EMETHOD;
  double *history = a->history + (size_t)s->k * substep_history(pb, w), h = w->part[s->k] * s->dt;
  lag_discrete d = {.rule = r, .t = s->t + s->at * s->dt, .h = h, .size = w->step.h, .q = s->y, .dq = a->ql, .p = a->p,
                    .dp = a->pl, .u = u, .force = a->force, .work = a->discrete, .counted = 1};

  lag_substeps_gather(a, nq);
  if (known || lag_predictor_guess(history, m, u)) rc = lag_discrete_solve(pb, &d);
  pb->detail = NULL; /* forget the message of the first attempt */
  if (rc != 0 && (rc = linear_guess(w, a, pb, s, u)) == 0) rc = lag_discrete_solve(pb, &d);
  if (rc) return rc;
  lag_discrete_move(&d, nq, a->dq, a->dp);
  return LAG_OK;
}

void lag_substep_record(const Implicit *w, const ImplicitArrays *a, const lag_problem *pb, int k, const double *u) {
  lag_predictor_add(a->history + (size_t)k * substep_history(pb, w), pb->nq * (int)w->rule[k % 2].free, u);
}

int lag_substeps_velocity(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double tb, const double *y,
                          int known) {
  int nq = pb->nq;
  const double *history = a->history + (size_t)w->substeps * substep_history(pb, w);
  lag_discrete d = {.rule = &w->momentum, .t = tb, .h = 0, .size = w->step.h, .q = y, .dq = a->ql, .p = a->p,
                    .dp = a->pl, .u = a->v, .force = a->force, .work = a->discrete};
  lag_substeps_gather(a, nq);
  if (!known && !lag_predictor_guess(history, nq, a->v)) memcpy(a->v, a->u, (size_t)nq * sizeof(double));
  return lag_discrete_solve(pb, &d);
}

/* ---- A step */

size_t lag_implicit_size(const lag_problem *pb, int free) { return state_size(pb, free, 1); }

size_t lag_implicit_composed_size(const lag_problem *pb, const lag_composition *c) {
  return state_size(pb, 1, 2 * c->stages);
}

void lag_implicit_reset(void *work, lag_problem *pb) {
  Implicit *w = work;
  (void)pb;
  w->ready = w->have_path = 0;
  w->step.tc = 0;
}

void lag_implicit_init(void *work, lag_problem *pb, double h, int order, const lag_rule *rule) {
  Implicit *w = work;
  w->step.h = h;
  w->order = order;
  w->substeps = w->part[0] = 1;
  w->rule[0] = *rule;
  memset(&w->momentum, 0, sizeof w->momentum);
  lag_rule_euler(&w->momentum, 0);
  lag_implicit_reset(work, pb);
}

/* part[2 LAG_MAX_DRIFTS] := lengths of the substeps a_0, b_0, a_1, ...; a last one of length 0 is
 * left out. Returns their number. */
static int substeps_of(const lag_composition *c, double *part) {
  double before = 0;
  int n = 2 * c->stages;
  for (int i = 0; i < c->stages; i++) {
    part[2 * i] = c->kick[i] - before;
    part[2 * i + 1] = before = c->drift[i] - part[2 * i];
  }
  for (int i = 0; i < n / 2 && c->order > 1; i++) part[n - 1 - i] = part[i]; /* symmetric to the last bit */
  return n - (part[n - 1] == 0.0);
}

void lag_implicit_compose(void *work, lag_problem *pb, double h, const lag_composition *c) {
  Implicit *w = work;
  lag_rule rule = {0};
  lag_rule_euler(&rule, 0);
  lag_implicit_init(work, pb, h, c->order, &rule);
  w->rule[1] = rule;
  lag_rule_euler(&w->rule[1], 1);
  w->substeps = substeps_of(c, w->part);
}

/* First step from y: p := dL/dv, compensations and histories := 0. */
static int begin(Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, const double *y) {
  int nq = pb->nq;
  size_t bytes = (size_t)nq * sizeof(double);
  int rc = lag_variation(pb, t, y, y + nq, a->dq, a->p, a->dp);
  if (rc) return lag_step_refused(pb, rc, t);
  if ((pb->bad_index = lag_not_finite(nq, a->p)) >= 0) {
    pb->bad_index += nq;
    return lag_step_failed(pb, LAG_ENAN, t);
  }
  memset(a->qc, 0, bytes);
  memset(a->pc, 0, bytes);
  memset(a->history, 0, (size_t)(a->path - a->history) * sizeof(double));
  if (pb->model->constraints)
    memset(a->block.history, 0,
           (size_t)w->substeps * (size_t)LAG_PREDICTOR_SIZE(pb->model->constraints->n) * sizeof(double));
  w->ready = 1;
  return LAG_OK;
}

/* All substeps of a step, without constraints; then v at its end. */
static int chain(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, double tb, const double *y,
                 double dt) {
  Substep s = {0, t, dt, 0, y};
  int rc = 0;
  for (; s.k < (int)w->substeps && rc == 0; s.k++) {
    if ((rc = lag_substep(w, a, pb, &s, a->u, 0)) == 0) lag_substep_record(w, a, pb, s.k, a->u);
    s.at += w->part[s.k];
  }
  return rc ? rc : lag_substeps_velocity(w, a, pb, tb, y, 0);
}

/* Adds the increments to q and p: the step is accepted. */
static void accept(Implicit *w, const ImplicitArrays *a, lag_problem *pb, double *y) {
  int nq = pb->nq;
  memcpy(a->y0, y, (size_t)pb->n * sizeof(double));
  for (int i = 0; i < nq; i++) {
    y[i] = lag_compensated_sum(y[i], a->dq[i], &a->qc[i]);
    a->p[i] = lag_compensated_sum(a->p[i], a->dp[i], &a->pc[i]);
    y[nq + i] = a->v[i];
  }
  memcpy(a->y1, y, (size_t)pb->n * sizeof(double));
  w->have_path = 0;
}

int lag_implicit_step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Implicit *w = work;
  ImplicitArrays a = arrays(w, pb);
  lag_next_step next;
  int rc = lag_fixed_step_begin(&w->step, pb, *t, &next);
  (void)t_stop;
  if (rc) return rc;
  if (w->ready == 0.0 && (rc = begin(w, &a, pb, *t, y)) != 0) return rc;
  memset(a.dq, 0, (size_t)pb->nq * sizeof(double));
  memset(a.dp, 0, (size_t)pb->nq * sizeof(double));
  if ((rc = (pb->model->constraints ? lag_rattle : chain)(w, &a, pb, *t, next.tb, y, next.dt)) != 0) return rc;
  lag_predictor_add(a.history + (size_t)w->substeps * substep_history(pb, w), pb->nq, a.v);
  accept(w, &a, pb, y);
  lag_fixed_step_end(&w->step, &next, t);
  return LAG_OK;
}

/* Builds dense output of the last step: 1 done, -1 only the Hermite form, -2 not even that. Each level takes two
 * passes, because the accelerations depend on velocities. */
static int make_path(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const StepEnds *e, int level) {
  if (lag_rhs(pb, w->step.t0, a->y0, a->f0) || lag_rhs(pb, w->step.t0 + w->step.dt, a->y1, a->f1) ||
      lag_not_finite(pb->n, a->f0) >= 0 || lag_not_finite(pb->n, a->f1) >= 0) {
    return -2;
  }
  return level == 0 || lag_interpolant_make(a->path, pb, e, level, 2) == 0 ? 1 : -1;
}

void lag_implicit_dense(void *work, lag_problem *pb, double t, double *y) {
  Implicit *w = work;
  ImplicitArrays a = arrays(w, pb);
  StepEnds ends = {w->step.t0, w->step.dt, a.y0, a.f0, a.y1, a.f1};
  int level = lag_interpolant_level(w->order);
  double s = (t - w->step.t0) / w->step.dt;
  if (w->have_path == 0.0 && w->order > 1) w->have_path = make_path(w, &a, pb, &ends, level);
  if (w->order < 2 || w->have_path < -1) lag_interpolant_cubic(pb->nq, &ends, s, y);
  else lag_interpolant_at(a.path, pb, &ends, w->have_path > 0 ? level : 0, s, y);
}

/* ---- Derivative of a step */

/* Scratch of the derivative. q, p at a substep: y0 + ql, p + pl, as in lag_discrete; u, force: of one substep; du,
 * rest: of its derivative. */
typedef struct Changes {
  int k, whole;               /* changes; 1: the step that was taken, whose velocities are known */
  double *p, *ql, *pl, *v;    /* [nq] */
  double *u, *force, *second; /* [free nq], [points nq], [nsecond] */
  double *dv, *du, *rest;     /* [nq k], [free nq k] */
} Changes;

/* Sets the pointers, unless x is NULL; returns the length of the scratch. */
static size_t layout(Changes *c, const lag_problem *pb, int k, double *x) {
  size_t nq = (size_t)pb->nq, m = nq * (size_t)k;
  const lag_part parts[] = {{&c->p, nq}, {&c->ql, nq}, {&c->pl, nq}, {&c->v, nq}, {&c->u, LAG_RULE_FREE * nq},
      {&c->force, LAG_RULE_FREE * nq}, {&c->second, (size_t)pb->model->nsecond}, {&c->dv, m},
      {&c->du, LAG_RULE_FREE * m}, {&c->rest, lag_discrete_tangent_size(pb, LAG_RULE_FREE, k)}};
  return lag_workspace_slice(x, sizeof parts / sizeof *parts, parts);
}

size_t lag_implicit_tangent_size(const lag_problem *pb, int k) {
  Changes c;
  return layout(&c, pb, k, NULL);
}

/* Start of the last step: Y = (dq, dv) becomes (dq, dp), and c->p := p. */
static int to_momenta(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const Changes *c, double *Y) {
  int nq = pb->nq, k = c->k, m = nq * k, rc = lag_variation(pb, w->step.t0, a->y0, a->y0 + nq, c->v, c->p, c->force);
  rc = rc ? rc : lag_second_derivatives(pb, w->step.t0, a->y0, a->y0 + nq, c->second);
  if (rc) return lag_step_refused(pb, rc, w->step.t0);
  memcpy(c->dv, Y + m, (size_t)m * sizeof *Y);
  memset(Y + m, 0, (size_t)m * sizeof *Y);
  lag_hessian_times(pb, c->second, k, Y, c->dv, Y + m, NULL);
  return LAG_OK;
}

/* Y over a substep. */
static int over_substep(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const Changes *c, const Substep *s,
                        double *Y) {
  const lag_rule *r = &w->rule[s->k % 2];
  int nq = pb->nq, rc = 0;
  double h = w->part[s->k] * s->dt;
  lag_discrete d = {.rule = r, .t = s->t + s->at * s->dt, .h = h, .size = w->step.h, .q = s->y, .dq = c->ql, .p = c->p,
                    .dp = c->pl, .u = c->u, .force = c->force, .work = a->discrete};

  lag_predictor_last(a->history + (size_t)s->k * substep_history(pb, w), nq * (int)r->free, c->u);
  rc = c->whole ? 0 : lag_discrete_solve(pb, &d);
  rc = rc ? rc : lag_discrete_tangent(pb, &d, c->k, Y, Y + nq * c->k, c->du, c->rest);
  for (int i = 0; i < (int)r->free && rc == 0; i++) lag_tangent_add(nq, h * r->whole[i], c->u + i * nq, c->ql);
  for (int i = 0; i < (int)r->points && rc == 0 && !c->whole; i++)
    lag_tangent_add(nq, h * r->b[i], c->force + i * nq, c->pl);
  return rc;
}

/* End of the step, t: Y = (dq, dp) becomes (dq, dv). */
static int to_velocities(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const Changes *c, double t,
                         double *Y) {
  int nq = pb->nq, m = nq * c->k, rc = 0;
  lag_discrete d = {.rule = &w->momentum, .t = t, .h = 0, .size = w->step.h, .q = a->y0, .dq = c->ql, .p = c->p,
                    .dp = c->pl, .u = c->v, .force = c->force, .work = a->discrete};
  memcpy(c->v, a->y1 + nq, (size_t)nq * sizeof *Y);
  rc = c->whole ? 0 : lag_discrete_solve(pb, &d);
  rc = rc ? rc : lag_discrete_tangent(pb, &d, c->k, Y, Y + m, c->du, c->rest);
  memcpy(Y + m, c->du, (size_t)m * sizeof *Y);
  return rc;
}

int lag_implicit_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  Implicit *w = work;
  ImplicitArrays a = arrays(w, pb);
  double step = w->step.h * pb->dir, dt = lag_tangent_span(w->step.t0, t, step);
  Substep s = {0, w->step.t0, dt, 0, a.y0};
  Changes c;
  layout(&c, pb, k, scratch);
  c.k = k;
  c.whole = dt == step;
  memset(c.ql, 0, (size_t)(2 * pb->nq) * sizeof *scratch);
  int rc = to_momenta(w, &a, pb, &c, Y);

  for (; s.k < (int)w->substeps && rc == 0; s.k++) {
    rc = over_substep(w, &a, pb, &c, &s, Y);
    s.at += w->part[s.k];
  }
  return rc ? rc : to_velocities(w, &a, pb, &c, t, Y);
}
