/* Symplectic steps in q and p for any L. Enters: t, y = [q|v]; leaves: t + h, y one step later. Holds: p is kept from step to
 * step and v is found from it, dL/dv(q, v) = p; q, p and t are sums of many small terms, and are summed with compensation
 * (steps.h). Between steps y is a path through both ends (path.h): accurate to the order of the method, and not symplectic. */
#include "methods/implicit.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "methods/discrete.h"
#include "methods/history.h"
#include "methods/path.h"
#include "methods/steps.h"
#include "methods/tangent.h"

/* One block of doubles; the arrays of x are in Arrays. */
typedef struct Implicit {
  double h;         /* the step, > 0 */
  double ready;     /* p belongs to the present q and v */
  double have_path; /* 1 made, -1 cannot be made, 0 not asked for yet */
  double t0, dt;    /* the last step began at t0 and was dt long */
  double tc;        /* what t has lost to rounding */
  double order, links;
  double part[2 * LAG_MAX_DRIFTS];
  lag_rule rule[2], momentum;
  double x[];
} Implicit;

/* A model with constraints: where a block begins, [q|v], its increments of q and p there, the impulse that leads to the constraints at
 * its end, and what is solved for it. Blocks are links that end on the constraints together. */
typedef struct Block {
  double *from, *to;                   /* [n] */
  double *dq, *dp, *impulse, *d, *force; /* [nq] */
  double *c, *r, *g, *sum;             /* [constraints]; the sum of all g, from which the impulse follows */
  double *history;                     /* of the sum in each block */
} Block;

/* q and p have lost qc and pc to rounding; dq, dp are the increments of this step, ql and pl both together. */
typedef struct Arrays {
  double *p, *qc, *pc, *dq, *dp, *ql, *pl, *v; /* [nq] */
  double *y0, *y1, *f0, *f1;                   /* [n] both ends of the last step, f when it is asked for */
  double *u, *force;                           /* [2 free nq] of the links of a block, [points nq] */
  double *history;                             /* of u in each link, then of v */
  double *path, *discrete;
  Block block;
} Arrays;

static size_t history_size(const lag_problem *pb, const Implicit *w)
{
  return lag_history_size(pb->nq * (int)w->rule[0].free);
}

static Block block(double *x, const lag_problem *pb)
{
  Block b;
  int n = pb->n, nq = pb->nq, nc = pb->model->constraints->n;
  double **const parts[] = {&b.from, &b.to, &b.dq, &b.dp, &b.impulse, &b.d, &b.force, &b.c, &b.r, &b.g, &b.sum, &b.history};
  const int sizes[] = {n, n, nq, nq, nq, nq, nq, nc, nc, nc, nc, 0};

  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    *parts[i] = x;
    x += sizes[i];
  }
  return b;
}

static size_t block_size(const lag_problem *pb, int links)
{
  const lag_constraints *of = pb->model->constraints;

  return of ? (size_t)(2 * pb->n + 5 * pb->nq + 4 * of->n) + (size_t)links * lag_history_size(of->n) : 0;
}

static Arrays arrays(Implicit *w, const lag_problem *pb)
{
  Arrays a;
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
  a.path = a.history + (size_t)w->links * history_size(pb, w) + lag_history_size(nq);
  a.discrete = a.path + lag_path_size(nq);
  a.block = pb->model->constraints ? block(a.discrete + lag_discrete_size(pb, free), pb) : (Block){0};
  return a;
}

static size_t size_of(const lag_problem *pb, int free, int links)
{
  size_t nq = (size_t)pb->nq, m = nq * (size_t)free;

  return sizeof(Implicit) / sizeof(double) + 8 * nq + 4 * (size_t)pb->n + 3 * m + nq + block_size(pb, links) +
         (size_t)links * lag_history_size((int)m) + lag_history_size((int)nq) + lag_path_size((int)nq) +
         lag_discrete_size(pb, free);
}

size_t lag_implicit_size(const lag_problem *pb, int free)
{
  return size_of(pb, free, 1);
}

size_t lag_implicit_composed_size(const lag_problem *pb, const lag_composition *c)
{
  return size_of(pb, 1, 2 * c->stages);
}

void lag_implicit_reset(void *work, lag_problem *pb)
{
  Implicit *w = work;

  (void)pb;
  w->ready = w->have_path = 0;
  w->tc = 0;
}

void lag_implicit_init(void *work, lag_problem *pb, double h, int order, const lag_rule *rule)
{
  Implicit *w = work;

  w->h = h;
  w->order = order;
  w->links = w->part[0] = 1;
  w->rule[0] = *rule;
  lag_rule_euler(&w->momentum, 0);
  lag_implicit_reset(work, pb);
}

void lag_implicit_compose(void *work, lag_problem *pb, double h, const lag_composition *c)
{
  Implicit *w = work;
  lag_rule rule;

  lag_rule_euler(&rule, 0);
  lag_implicit_init(work, pb, h, c->order, &rule);
  lag_rule_euler(&w->rule[1], 1);
  w->links = lag_compose_links(c, w->part);
}

/* p of the state y, with nothing known of the past. */
static int begin(Implicit *w, const Arrays *a, lag_problem *pb, double t, const double *y)
{
  int nq = pb->nq;
  size_t bytes = (size_t)nq * sizeof(double);
  int rc = lag_variation(pb, t, y, y + nq, a->dq, a->p, a->dp);

  if (rc) {
    return lag_step_refused(pb, rc, t);
  }
  if ((pb->bad_index = lag_not_finite(nq, a->p)) >= 0) {
    pb->bad_index += nq;
    return lag_step_failed(pb, LAG_ENAN, t);
  }
  memset(a->qc, 0, bytes);
  memset(a->pc, 0, bytes);
  memset(a->history, 0, (size_t)(a->path - a->history) * sizeof(double));
  if (pb->model->constraints) {
    memset(a->block.history, 0, (size_t)w->links * lag_history_size(pb->model->constraints->n) * sizeof(double));
  }
  w->ready = 1;
  return LAG_OK;
}

/* u := velocities on a straight line through the present one, at the nodes of link k, which begins at `at` of the step. */
static int straight(const Implicit *w, const Arrays *a, lag_problem *pb, double t, const double *y, double dt, int k, double at, double *u)
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

/* ql, pl: what is to be added to q and p where the step is now. */
static void gather(const Arrays *a, int nq)
{
  for (int i = 0; i < nq; i++) {
    a->ql[i] = a->qc[i] + a->dq[i];
    a->pl[i] = a->pc[i] + a->dp[i];
  }
}

/* Link k, which begins at `at` of the step: its velocities u and forces, and what they add to q and p. known: u is a guess. */
static int link(const Implicit *w, const Arrays *a, lag_problem *pb, double t, const double *y, double dt, int k, double at, double *u,
                int known)
{
  const lag_rule *r = &w->rule[k % 2];
  int nq = pb->nq, m = nq * (int)r->free, rc = LAG_EMETHOD;
  double *history = a->history + (size_t)k * history_size(pb, w), h = w->part[k] * dt;
  lag_discrete d = {.rule = r, .pb = pb, .t = t + at * dt, .h = h, .size = w->h, .q = y, .dq = a->ql, .p = a->p,
                    .dp = a->pl, .u = u, .force = a->force, .work = a->discrete, .counted = 1};

  gather(a, nq);
  if (known || lag_history_guess(history, m, u)) {
    rc = lag_discrete_solve(&d);
  }
  if (rc != 0 && (rc = straight(w, a, pb, t, y, dt, k, at, u)) == 0) {
    rc = lag_discrete_solve(&d);
  }
  if (rc) {
    return rc;
  }
  pb->detail = NULL;
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

/* Link k is done with the velocities u. */
static void note(const Implicit *w, const Arrays *a, const lag_problem *pb, int k, const double *u)
{
  lag_history_add(a->history + (size_t)k * history_size(pb, w), pb->nq * (int)w->rule[k % 2].free, u);
}

/* v where the step is now, dL/dv(q, v) = p. known: v is a guess. */
static int velocity(const Implicit *w, const Arrays *a, lag_problem *pb, double tb, const double *y, int known)
{
  int nq = pb->nq;
  const double *history = a->history + (size_t)w->links * history_size(pb, w);
  lag_discrete d = {.rule = &w->momentum, .pb = pb, .t = tb, .h = 0, .size = w->h, .q = y, .dq = a->ql, .p = a->p,
                    .dp = a->pl, .u = a->v, .force = a->force, .work = a->discrete};

  gather(a, nq);
  if (!known && !lag_history_guess(history, nq, a->v)) {
    memcpy(a->v, a->u, (size_t)nq * sizeof(double));
  }
  return lag_discrete_solve(&d);
}

/* All links, without constraints. */
static int chain(const Implicit *w, const Arrays *a, lag_problem *pb, double t, double tb, const double *y, double dt)
{
  double at = 0;
  int rc = 0;

  for (int k = 0; k < (int)w->links && rc == 0; k++) {
    if ((rc = link(w, a, pb, t, y, dt, k, at, a->u, 0)) == 0) {
      note(w, a, pb, k, a->u);
    }
    at += w->part[k];
  }
  return rc ? rc : velocity(w, a, pb, tb, y, 0);
}

/* ---- Constraints: the discrete Lagrange-d'Alembert principle. An impulse at the beginning of a block, of the kind that the constraints
 * there can exert, leads it to c = 0 at its end, and the momentum at the end is projected to r = 0: RATTLE where L is separable. H.C.
 * Andersen, J. Comput. Phys. 52 (1983) 24, DOI 10.1016/0021-9991(83)90014-1; J.E. Marsden, M. West (variational.c), section 3.5; Hairer,
 * Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), VII.1. A constraint of velocities alone holds for the chord of the
 * block, in the mean of its two ends, a rule that is its own reverse: J. Cortes, S. Martinez, Nonlinearity 14 (2001) 1365, DOI
 * 10.1088/0951-7715/14/5/322; R. McLachlan, M. Perlmutter, J. Nonlinear Sci. 16 (2006) 283, DOI 10.1007/s00332-005-0698-1. */

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

  gather(a, nq);
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

/* The largest correction against what the block does to q. */
static double part_of(const Block *b, int nq, double h)
{
  double most = 0;

  for (int i = 0; i < nq; i++) {
    double d = fabs(b->d[i]);
    most = fmax(most, d == 0.0 ? 0 : fmin(d / (fabs(h * b->to[nq + i]) + 0x1p-10 * fabs(b->to[i])), 1));
  }
  return most;
}

static int is_lost(const Block *b, int nq)
{
  for (int i = 0; i < nq; i++) {
    if (!(fabs(b->d[i]) <= DBL_EPSILON / 4 * fabs(b->to[i]))) {
      return 0;
    }
  }
  return 1;
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
      if ((rc = link(w, a, pb, t, y, dt, k + j, from, a->u + j * m, turn > 0)) != 0) {
        return rc;
      }
      from += w->part[k + j];
    }
    rc = off(a, pb, t + at * dt, t1, h, y);
    rc = rc ? rc : lag_least_change(pb, t + at * dt, b->from, holonomic, b->g, b->d, b->force);
    if (rc || lag_not_finite(nq, b->d) >= 0) {
      return lag_step_refused(pb, rc ? rc : LAG_ERETRY, t + at * dt);
    }
    double part = part_of(b, nq, h);
    if (is_lost(b, nq) || (part <= 1e-8 && part >= before / 2)) {
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
    if ((rc = velocity(w, a, pb, tb, y, turn > 0 || !last)) != 0) {
      return rc;
    }
    memcpy(b->to + nq, a->v, (size_t)nq * sizeof(double));
    rc = lag_residuals(pb, tb, b->to, b->c, b->r);
    for (int k = 0; k < pb->model->constraints->n; k++) {
      b->g[k] = -b->r[k];
    }
    rc = rc ? rc : lag_least_change(pb, tb, b->to, 0, b->g, b->d, b->force);
    if (rc || lag_not_finite(nq, b->d) >= 0) {
      return lag_step_refused(pb, rc ? rc : LAG_ERETRY, tb);
    }
    done = 1;
    for (int i = 0; i < nq; i++) {
      a->dp[i] += b->force[i];
      a->v[i] += b->d[i];
      done &= fabs(b->d[i]) <= 1e-8 * fabs(a->v[i]) || turn + 1 == MOST_PROJECTIONS;
    }
  }
  return LAG_OK;
}

/* All links, of a model with constraints. */
static int chain_on_constraints(const Implicit *w, const Arrays *a, lag_problem *pb, double t, double tb, const double *y, double dt)
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
      note(w, a, pb, k + j, a->u + j * m);
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

/* Takes the step that the increments make. */
static void accept(Implicit *w, const Arrays *a, lag_problem *pb, double *y)
{
  int nq = pb->nq;

  memcpy(a->y0, y, (size_t)pb->n * sizeof(double));
  for (int i = 0; i < nq; i++) {
    y[i] = lag_sum(y[i], a->dq[i], &a->qc[i]);
    a->p[i] = lag_sum(a->p[i], a->dp[i], &a->pc[i]);
    y[nq + i] = a->v[i];
  }
  memcpy(a->y1, y, (size_t)pb->n * sizeof(double));
  w->have_path = 0;
}

int lag_implicit_step(void *work, lag_problem *pb, double *t, double *y)
{
  Implicit *w = work;
  Arrays a = arrays(w, pb);
  int rc;
  double dt = w->h * pb->dir, tc = w->tc, tb = lag_sum(*t, dt, &tc);

  pb->bad_index = -1;
  if (tb == *t) {
    return lag_step_failed(pb, LAG_ESTEP, *t);
  }
  if (w->ready == 0.0 && (rc = begin(w, &a, pb, *t, y)) != 0) {
    return rc;
  }
  memset(a.dq, 0, (size_t)pb->nq * sizeof(double));
  memset(a.dp, 0, (size_t)pb->nq * sizeof(double));
  if ((rc = (pb->model->constraints ? chain_on_constraints : chain)(w, &a, pb, *t, tb, y, dt)) != 0) {
    return rc;
  }
  lag_history_add(a.history + (size_t)w->links * history_size(pb, w), pb->nq, a.v);
  accept(w, &a, pb, y);
  w->t0 = *t;
  w->dt = tb - *t;
  w->tc = tc;
  *t = tb;
  return LAG_OK;
}

/* The path through the last step: its accelerations are those of the model, which depend on velocities here, so that each
 * level takes two passes. */
static int make_path(const Implicit *w, const Arrays *a, lag_problem *pb, const StepEnds *e, int level)
{
  if (lag_rhs(pb, w->t0, a->y0, a->f0) || lag_rhs(pb, w->t0 + w->dt, a->y1, a->f1) || lag_not_finite(pb->n, a->f0) >= 0 ||
      lag_not_finite(pb->n, a->f1) >= 0) {
    return -2;
  }
  return level == 0 || lag_path_make(a->path, pb, e, level, 2) == 0 ? 1 : -1;
}

void lag_implicit_dense(void *work, lag_problem *pb, double t, double *y)
{
  Implicit *w = work;
  Arrays a = arrays(w, pb);
  StepEnds ends = {w->t0, w->dt, a.y0, a.f0, a.y1, a.f1};
  int level = w->order > 6 ? 2 : w->order > 4 ? 1 : 0;
  double s = (t - w->t0) / w->dt;

  if (w->have_path == 0.0 && w->order > 1) {
    w->have_path = make_path(w, &a, pb, &ends, level);
  }
  if (w->order < 2 || w->have_path < -1) {
    lag_path_cubic(pb->nq, &ends, s, y);
  } else {
    lag_path_at(a.path, pb, &ends, w->have_path > 0 ? level : 0, s, y);
  }
}

/* ---- The derivative of a step */

/* q and p so far are sums as in lag_discrete; u, force, h: of one link; du, rest: scratch of its derivative. */
typedef struct Changes {
  double *p, *ql, *pl, *v;    /* [nq] */
  double *u, *force, *second; /* [free nq], [points nq], [nsecond] */
  double *dv, *du, *rest;     /* [nq k], [free nq k] */
} Changes;

size_t lag_implicit_tangent_size(const lag_problem *pb, int k)
{
  size_t nq = (size_t)pb->nq, m = nq * (size_t)k;

  return 4 * nq + (LAG_RULE_FREE + LAG_RULE_POINTS) * nq + (size_t)pb->model->nsecond + (1 + LAG_RULE_FREE) * m +
         lag_discrete_tangent_size(pb, LAG_RULE_FREE, k);
}

static Changes changes(const lag_problem *pb, int k, double *x)
{
  Changes c;
  int nq = pb->nq;

  c.p = x;
  c.ql = c.p + nq;
  c.pl = c.ql + nq;
  c.v = c.pl + nq;
  c.u = c.v + nq;
  c.force = c.u + LAG_RULE_FREE * nq;
  c.second = c.force + LAG_RULE_POINTS * nq;
  c.dv = c.second + pb->model->nsecond;
  c.du = c.dv + nq * k;
  c.rest = c.du + LAG_RULE_FREE * nq * k;
  memset(c.ql, 0, (size_t)(2 * nq) * sizeof *x);
  return c;
}

/* Y = (dq, dv) becomes (dq, dp) at the beginning of the last step, and p is known there. */
static int to_momenta(const Implicit *w, const Arrays *a, lag_problem *pb, const Changes *c, int k, double *Y)
{
  int nq = pb->nq, m = nq * k, rc = lag_variation(pb, w->t0, a->y0, a->y0 + nq, c->v, c->p, c->force);

  rc = rc ? rc : lag_second_derivatives(pb, w->t0, a->y0, a->y0 + nq, c->second);
  if (rc) {
    return lag_step_refused(pb, rc, w->t0);
  }
  memcpy(c->dv, Y + m, (size_t)m * sizeof *Y);
  memset(Y + m, 0, (size_t)m * sizeof *Y);
  lag_second_times(pb, c->second, k, Y, c->dv, Y + m, NULL);
  return LAG_OK;
}

/* Over link j, which begins at `at` of the step of length dt; whole: this is the step that was taken, whose velocities are known. */
static int over_link(const Implicit *w, const Arrays *a, lag_problem *pb, const Changes *c, int j, double at, double dt, int whole, int k,
                     double *Y)
{
  const lag_rule *r = &w->rule[j % 2];
  int nq = pb->nq, rc = 0;
  double h = w->part[j] * dt;
  lag_discrete d = {.rule = r, .pb = pb, .t = w->t0 + at * dt, .h = h, .size = w->h, .q = a->y0, .dq = c->ql, .p = c->p,
                    .dp = c->pl, .u = c->u, .force = c->force, .work = a->discrete};

  lag_history_last(a->history + (size_t)j * history_size(pb, w), nq * (int)r->free, c->u);
  rc = whole ? 0 : lag_discrete_solve(&d);
  rc = rc ? rc : lag_discrete_tangent(&d, k, Y, Y + nq * k, c->du, c->rest);
  for (int i = 0; i < (int)r->free && rc == 0; i++) {
    lag_tangent_add(nq, h * r->whole[i], c->u + i * nq, c->ql);
  }
  for (int i = 0; i < (int)r->points && rc == 0 && !whole; i++) {
    lag_tangent_add(nq, h * r->b[i], c->force + i * nq, c->pl);
  }
  return rc;
}

/* Y = (dq, dp) becomes (dq, dv) at the end, t. */
static int to_velocities(const Implicit *w, const Arrays *a, lag_problem *pb, const Changes *c, double t, int whole, int k, double *Y)
{
  int nq = pb->nq, m = nq * k, rc = 0;
  lag_discrete d = {.rule = &w->momentum, .pb = pb, .t = t, .h = 0, .size = w->h, .q = a->y0, .dq = c->ql, .p = c->p, .dp = c->pl,
                    .u = c->v, .force = c->force, .work = a->discrete};

  memcpy(c->v, a->y1 + nq, (size_t)nq * sizeof *Y);
  rc = whole ? 0 : lag_discrete_solve(&d);
  rc = rc ? rc : lag_discrete_tangent(&d, k, Y, Y + m, c->du, c->rest);
  memcpy(Y + m, c->du, (size_t)m * sizeof *Y);
  return rc;
}

int lag_implicit_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch)
{
  Implicit *w = work;
  Arrays a = arrays(w, pb);
  Changes c = changes(pb, k, scratch);
  double step = w->h * pb->dir, dt = lag_tangent_span(w->t0, t, step), at = 0;
  int whole = dt == step, rc = to_momenta(w, &a, pb, &c, k, Y);

  for (int j = 0; j < (int)w->links && rc == 0; j++) {
    rc = over_link(w, &a, pb, &c, j, at, dt, whole, k, Y);
    at += w->part[j];
  }
  return rc ? rc : to_velocities(w, &a, pb, &c, t, whole, k, Y);
}
