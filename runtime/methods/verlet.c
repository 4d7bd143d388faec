/* symplectic_euler, verlet, verlet4, verlet6, verlet8: kicks and drifts (composition.c). Explicit, in this file, for models whose
 * accelerations depend on t and q only. For other models a composition of symplectic Euler and its adjoint in q and p, by Newton's
 * method (implicit_symplectic.c); two halves make the generalised Stoermer-Verlet method, the Lobatto IIIA-IIIB pair: Hairer, Lubich, Wanner,
 * Geometric Numerical Integration, 2nd ed. (2006), VI.3 and II.2.2. Enters: t, y; leaves: t + h, y one step later. Holds: sums over
 * steps of q, v and t are compensated (steps.h); the acceleration at the end of a step is the first of the next.
 *
 * A drift advances t with q, so a force with explicit time is evaluated at the right time and keeps the order. The map is
 * symplectic only where the forces have a potential. Dense output has the order of the descriptor, and is not symplectic. */
#include "lag.h"

#include <math.h>
#include <string.h>

#include "methods/composition.h"
#include "methods/implicit_symplectic.h"
#include "methods/step_interpolant.h"
#include "methods/steps.h"
#include "methods/tangent.h"

/* Saved state of the explicit methods, doubles only; x holds the arrays of n named below, then the path of step_interpolant.h. */
typedef struct Verlet {
  lag_fixed_step step;
  double ready;     /* 1: F1 = f(t, y) is known */
  double have_path; /* dense output: 1 built, -1 failed, 0 not built */
  double x[];
} Verlet;

/* f = [v|a] at both ends and at a stage; y at both ends and at a stage; increments of y; compensation of y before and after. */
enum { F0, F1, FS, Y0, Y1, YS, DY, COMP, COMP1, NARRAYS };

static const lag_method_option options[] = {LAG_STEP_OPTION};

/* A method of the family: its table for separable models, and the one for others. */
typedef struct Member {
  const lag_composition *separable, *any;
} Member;

static int is_explicit(const lag_problem *pb) { return (pb->model->flags & LAG_SEPARABLE) && !pb->model->constraints; }

static size_t work_size(const lag_problem *pb) {
  const Member *m = pb->variant;
  if (!is_explicit(pb)) return lag_implicit_composed_size(pb, m->any);
  return sizeof(Verlet) / sizeof(double) + NARRAYS * (size_t)pb->n + lag_interpolant_size(pb->nq);
}

static void reset(void *work, lag_problem *pb) {
  Verlet *w = work;
  if (!is_explicit(pb)) {
    lag_implicit_reset(work, pb);
    return;
  }
  w->ready = w->have_path = 0;
  w->step.tc = 0;
  memset(w->x + COMP * pb->n, 0, (size_t)pb->n * sizeof(double));
}

static int init(void *work, lag_problem *pb, const double *opt) {
  const Member *m = pb->variant;
  Verlet *w = work;
  double h = lag_step_size(pb, opt[0]);
  if (!is_explicit(pb)) {
    lag_implicit_compose(work, pb, h, m->any);
    return LAG_OK;
  }
  w->step.h = h;
  reset(work, pb);
  return LAG_OK;
}

/* Adds one kick to the increment of v. */
static void kick(Verlet *w, const lag_problem *pb, double h, const double *f) {
  double *dv = w->x + DY * pb->n + pb->nq;
  for (int i = 0; i < pb->nq; i++) dv[i] += h * f[pb->nq + i];
}

/* Adds one drift to the increment of q; YS := the state after it. */
static void drift(Verlet *w, const lag_problem *pb, double h, const double *y) {
  int nq = pb->nq, n = pb->n;
  const double *comp = w->x + COMP * n;
  double *dy = w->x + DY * n, *ys = w->x + YS * n;
  for (int i = 0; i < nq; i++) {
    ys[nq + i] = y[nq + i] + (comp[nq + i] + dy[nq + i]);
    dy[i] += h * ys[nq + i];
    ys[i] = y[i] + (comp[i] + dy[i]);
  }
}

/* Y1, COMP1 := y + increments with compensation, for nq components from i0 on. */
static void add(Verlet *w, const lag_problem *pb, const double *y, int i0) {
  int n = pb->n;
  const double *comp = w->x + COMP * n, *dy = w->x + DY * n;
  double *y1 = w->x + Y1 * n, *comp1 = w->x + COMP1 * n;
  for (int i = i0; i < i0 + pb->nq; i++) {
    comp1[i] = comp[i];
    y1[i] = lag_compensated_sum(y[i], dy[i], &comp1[i]);
  }
}

/* All kicks and drifts of a step, from F0 = f(t, y) to Y1 and F1 = f(tb, Y1). */
static int compose(const lag_composition *c, Verlet *w, lag_problem *pb, double t, double tb, const double *y, double dt) {
  int n = pb->n, nq = pb->nq, last = c->stages - 1, rc;
  double at = 0, *y1 = w->x + Y1 * n, *f = w->x + F0 * n;
  memset(w->x + DY * n, 0, (size_t)n * sizeof(double));
  for (int s = 0; s < c->stages; s++) {
    kick(w, pb, lag_composition_kick(c, s) * dt, f);
    drift(w, pb, lag_composition_drift(c, s) * dt, y);
    at += lag_composition_drift(c, s);
    if (s < last) {
      f = w->x + FS * n;
      if ((rc = lag_step_rhs(pb, t + at * dt, w->x + YS * n, f)) != 0) return rc;
    }
  }
  /* Accelerations do not depend on velocities: those of the last stage serve until the last kick. */
  memcpy(y1 + nq, w->x + YS * n + nq, (size_t)nq * sizeof(double));
  add(w, pb, y, 0);
  if ((rc = lag_step_rhs(pb, tb, y1, w->x + F1 * n)) != 0) return rc;
  kick(w, pb, lag_composition_kick(c, c->stages) * dt, w->x + F1 * n);
  add(w, pb, y, nq);
  memcpy(w->x + F1 * n, y1 + nq, (size_t)nq * sizeof(double));
  pb->bad_index = lag_not_finite(n, y1);
  return pb->bad_index >= 0 ? lag_step_failed(pb, LAG_ENAN, tb) : LAG_OK;
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  const Member *m = pb->variant;
  Verlet *w = work;
  int n = pb->n, rc;
  size_t bytes = (size_t)n * sizeof(double);
  lag_next_step next;
  if (!is_explicit(pb)) return lag_implicit_step(work, pb, t, y, t_stop);
  if ((rc = lag_fixed_step_begin(&w->step, pb, *t, &next)) != 0) return rc;
  if (w->ready == 0.0 && (rc = lag_step_rhs(pb, *t, y, w->x + F1 * n)) != 0) return rc;
  memcpy(w->x + F0 * n, w->x + F1 * n, bytes);
  w->ready = w->have_path = 0; /* until this step succeeds */
  if ((rc = compose(m->separable, w, pb, *t, next.tb, y, next.dt)) != 0) return rc;
  memcpy(w->x + Y0 * n, y, bytes);
  memcpy(y, w->x + Y1 * n, bytes);
  memcpy(w->x + COMP * n, w->x + COMP1 * n, bytes);
  w->ready = 1;
  lag_fixed_step_end(&w->step, &next, t);
  return LAG_OK;
}

static void dense(void *work, lag_problem *pb, double t, double *y) {
  const lag_composition *c = ((const Member *)pb->variant)->separable;
  Verlet *w = work;
  int n = pb->n;
  StepEnds ends = {w->step.t0, w->step.dt, w->x + Y0 * n, w->x + F0 * n, w->x + Y1 * n, w->x + F1 * n};
  double *path = w->x + NARRAYS * n;
  if (!is_explicit(pb)) {
    lag_implicit_dense(work, pb, t, y);
    return;
  }
  if (c->order == 1) {
    lag_interpolant_cubic(pb->nq, &ends, (t - w->step.t0) / w->step.dt, y);
    return;
  }
  int level = lag_interpolant_level(c->order);
  if (level > 0 && w->have_path == 0.0) w->have_path = lag_interpolant_make(path, pb, &ends, level, 1) == 0 ? 1 : -1;
  lag_interpolant_at(path, pb, &ends, w->have_path > 0 ? level : 0, (t - w->step.t0) / w->step.dt, y);
}

static size_t tangent_size(const lag_problem *pb, int k) { return is_explicit(pb) ? lag_tangent_size(pb, 0, k) : lag_implicit_tangent_size(pb, k); }

/* One kick of y by f, and of Y by the derivative F of f. */
static void kick_both(int nq, int k, double h, const double *f, const double *F, double *y, double *Y) {
  lag_tangent_add(nq, h, f + nq, y + nq);
  lag_tangent_add(nq * k, h, F + nq * k, Y + nq * k);
}

/* Repeats the kicks and drifts of compose with their derivatives: a kick adds the derivative of the force to dv, a drift adds dv to dq. */
static int tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  if (!is_explicit(pb)) return lag_implicit_tangent(work, pb, t, k, Y, scratch);
  const lag_composition *c = ((const Member *)pb->variant)->separable;
  Verlet *w = work;
  int n = pb->n, nq = pb->nq, rc = 0;
  double dt = lag_tangent_span(w->step.t0, t, w->step.h * pb->dir), at = 0, *rest;
  lag_tangent all = lag_tangent_layout(pb, k, scratch, &rest);
  double *y = rest, *f = y + n, *F = f + n;

  memcpy(y, w->x + Y0 * n, (size_t)n * sizeof *y);
  for (int s = 0; s <= c->stages; s++) {
    if ((rc = lag_tangent_at(&all, w->step.t0 + at * dt, y, f)) != 0) return rc;
    lag_tangent_times(&all, Y, F);
    kick_both(nq, k, lag_composition_kick(c, s) * dt, f, F, y, Y);
    if (s < c->stages) {
      lag_tangent_add(nq, lag_composition_drift(c, s) * dt, y + nq, y);
      lag_tangent_add(nq * k, lag_composition_drift(c, s) * dt, Y + nq * k, Y);
      at += lag_composition_drift(c, s);
    }
  }
  return LAG_OK;
}

/* name, table for separable models, table for others, order, flags, line for help */
#define METHODS(X)                                                                                                       \
  X(symplectic_euler, euler, euler, 1, 0, "kick, drift; one force a step. DOI 10.1017/S0962492902000144")                \
  X(verlet, verlet, verlet, 2, LAG_METHOD_SYMMETRIC,                                                                     \
    "Stoermer-Verlet as kick, drift, kick; one force a step. DOI 10.1103/PhysRev.159.98")                                \
  X(verlet4, verlet4, any4, 4, LAG_METHOD_SYMMETRIC,                                                                     \
    "Blanes-Moan SRKN 6b, or S 6; 6 forces a step. DOI 10.1016/S0377-0427(01)00492-7")                                   \
  X(verlet6, verlet6, any6, 6, LAG_METHOD_SYMMETRIC,                                                                     \
    "Blanes-Moan SRKN 11b, or S 10; 11 forces a step. DOI 10.1016/S0377-0427(01)00492-7")                                \
  X(verlet8, verlet8, any8, 8, LAG_METHOD_SYMMETRIC,                                                                     \
    "Blanes-Casas-Escorihuela B19, or Kahan-Li; 19 forces a step. DOI 10.1016/j.apnum.2022.07.010")

#define DEFINE(id, table, general, p, properties, words)                                                                  \
  static const Member member_##id = {&lag_compose_##table, &lag_compose_##general};                                       \
  const lag_method lag_##id = {                                                                                           \
      .name = #id,                                                                                                        \
      .order = p,                                                                                                         \
      .dense_order = p,                                                                                                   \
      .doc = words,                                                                                                       \
      .flags = LAG_METHOD_SYMPLECTIC | LAG_METHOD_NO_STATES | LAG_METHOD_VARIATION | LAG_METHOD_SPLITS | LAG_METHOD_NEWTON |\
               LAG_METHOD_CONSTRAINTS | (properties),                                              \
      .noptions = 1,                                                                                                      \
      .options = options,                                                                                                 \
      .work_size = work_size,                                                                                             \
      .init = init,                                                                                                       \
      .step = step,                                                                                                       \
      .dense = dense,                                                                                                     \
      .reset = reset,                                                                                                     \
      .tangent_size = tangent_size,                                                                                       \
      .tangent = tangent,                                                                                                 \
      .variant = &member_##id,                                                                                            \
  };
METHODS(DEFINE)
