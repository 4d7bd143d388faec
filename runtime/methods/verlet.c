/* symplectic_euler, verlet, verlet4, verlet6, verlet8: kicks and drifts (kernels/splitting.h). Explicit, in this
 * file, for models whose accelerations depend on t and q only, y = [q|v], and for Hamiltonians T(p) + V(q, t), whose
 * states are [q|p]. For other models a composition of symplectic Euler and its adjoint in q and p, by Newton's
 * method (implicit_symplectic.c); two halves make the generalised Stoermer-Verlet method, the Lobatto IIIA-IIIB
 * pair: Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), VI.3 and II.2.2. Enters: t, y;
 * leaves: t + h, y one step later. Holds: sums over steps of q, v (or p) and t are compensated (steps.h); the
 * acceleration at the end of a step is the first of the next.
 *
 * A drift advances t with q, so a force with explicit time is evaluated at the right time and keeps the order. The
 * map is symplectic only where the forces have a potential. Dense output has the order of the descriptor, and is not
 * symplectic. */
#include "lag.h"

#include <math.h>
#include <string.h>

#include "kernels/steppers.def"
#include "methods/implicit_symplectic.h"
#include "methods/step_interpolant.h"
#include "methods/steps.h"
#include "methods/method_tangent.h"
#include "methods/verlet.h"

/* Number of coordinates, the first half of [q|v] or [q|p]. */
static int half_of(const lag_problem *pb) { return pb->nq ? pb->nq : pb->n / 2; }

/* A step's instance of kernels/splitting.h: q begins a whole state, a is the second half of its rates. */
static int forces(lag_problem *pb, double t, const double *q, double *a) {
  return lag_step_rhs(pb, t, q, a - half_of(pb));
}
#define LAG_MODEL lag_problem *pb
#define LAG_FORCES(t, q, v, a) forces(pb, t, q, a)
#include "kernels/splitting.h"

static const lag_method_option options[] = {LAG_STEP_OPTION};

static int is_explicit(const lag_problem *pb) { return (pb->model->flags & LAG_SEPARABLE) && !pb->model->constraints; }

/* Kicks and drifts: those for q'' = f(q) where T is quadratic, those for any two flows of T(p) + V(q). */
static const lag_composition *table_of(const lag_problem *pb) {
  const VerletMember *m = pb->variant;
  return pb->nq ? m->separable : m->any;
}

static size_t work_size(const lag_problem *pb) {
  const VerletMember *m = pb->variant;
  if (!is_explicit(pb)) return lag_implicit_composed_size(pb, m->any);
  return sizeof(Verlet) / sizeof(double) + VERLET_NARRAYS * (size_t)pb->n +
         (pb->nq ? lag_interpolant_size(pb->nq) : 2 * (size_t)pb->n);
}

static void reset(void *work, lag_problem *pb) {
  Verlet *w = work;
  if (!is_explicit(pb)) {
    lag_implicit_reset(work, pb);
    return;
  }
  w->ready = w->have_path = 0;
  w->step.tc = 0;
  memset(w->x + VERLET_COMP * pb->n, 0, (size_t)pb->n * sizeof(double));
}

static int init(void *work, lag_problem *pb, const double *opt) {
  const VerletMember *m = pb->variant;
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

/* All kicks and drifts of a step, from F0 = f(t, y) to Y1 and F1 = f(tb, Y1). */
static int compose(const lag_composition *c, Verlet *w, lag_problem *pb, double t, double tb, const double *y,
                   double dt) {
  int n = pb->n, nq = half_of(pb), rc;
  double *y1 = w->x + VERLET_Y1 * n, *f1 = w->x + VERLET_F1 * n;
  const lag_splitting s = {.n = nq,
                           .q = y, .v = y + nq, .a = w->x + VERLET_F0 * n + nq, .lost = w->x + VERLET_COMP * n,
                           .q1 = y1, .v1 = y1 + nq, .a1 = f1 + nq, .lost1 = w->x + VERLET_COMP1 * n,
                           .rate = pb->nq ? y1 + nq : f1, .dq = w->x + VERLET_DY * n,
                           .dv = w->x + VERLET_DY * n + nq};
  if ((rc = lag_split(pb, &s, c, t, tb, dt)) != 0) return rc;
  if (pb->nq) lag_copy(nq, y1 + nq, f1);
  else if ((rc = lag_step_rhs(pb, tb, y1, f1)) != 0) return rc;
  pb->bad_index = lag_not_finite(n, y1);
  return pb->bad_index >= 0 ? lag_step_failed(pb, LAG_ENAN, tb) : LAG_OK;
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Verlet *w = work;
  int n = pb->n, rc;
  size_t bytes = (size_t)n * sizeof(double);
  lag_next_step next;
  if (!is_explicit(pb)) return lag_implicit_step(work, pb, t, y, t_stop);
  if ((rc = lag_fixed_step_begin(&w->step, pb, *t, &next)) != 0) return rc;
  if (w->ready == 0.0 && (rc = lag_step_rhs(pb, *t, y, w->x + VERLET_F1 * n)) != 0) return rc;
  memcpy(w->x + VERLET_F0 * n, w->x + VERLET_F1 * n, bytes);
  w->ready = w->have_path = 0; /* until this step succeeds */
  if ((rc = compose(table_of(pb), w, pb, *t, next.tb, y, next.dt)) != 0) return rc;
  memcpy(w->x + VERLET_Y0 * n, y, bytes);
  memcpy(y, w->x + VERLET_Y1 * n, bytes);
  memcpy(w->x + VERLET_COMP * n, w->x + VERLET_COMP1 * n, bytes);
  w->ready = 1;
  lag_fixed_step_end(&w->step, &next, t);
  return LAG_OK;
}

/* State inside the last step of T(p) + V(q): the cubic through both ends, of order 3, or a shorter step where the
 * method's order is above 2. */
static void dense_in_phase_space(Verlet *w, lag_problem *pb, double t, const StepEnds *ends, double *y) {
  const lag_composition *c = table_of(pb);
  size_t n = (size_t)pb->n, bytes = n * sizeof(double);
  double *y1 = w->x + VERLET_Y1 * n, *f1 = w->x + VERLET_F1 * n, *kept = w->x + VERLET_NARRAYS * n;
  lag_hermite(0, pb->n, ends->h, (t - ends->t0) / ends->h, ends->y0, ends->f0, ends->y1, ends->f1, y);
  if (c->order <= 2) return;
  memcpy(kept, y1, bytes);
  memcpy(kept + n, f1, bytes);
  if (compose(c, w, pb, ends->t0, t, ends->y0, t - ends->t0) == LAG_OK) memcpy(y, y1, bytes);
  memcpy(y1, kept, bytes);
  memcpy(f1, kept + n, bytes);
}

static void dense(void *work, lag_problem *pb, double t, double *y) {
  const lag_composition *c = table_of(pb);
  Verlet *w = work;
  int n = pb->n;
  StepEnds ends = {w->step.t0,           w->step.dt,           w->x + VERLET_Y0 * n,
                   w->x + VERLET_F0 * n, w->x + VERLET_Y1 * n, w->x + VERLET_F1 * n};
  double *path = w->x + VERLET_NARRAYS * n;
  if (!is_explicit(pb)) {
    lag_implicit_dense(work, pb, t, y);
    return;
  }
  if (!pb->nq) {
    dense_in_phase_space(w, pb, t, &ends, y);
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

static size_t tangent_size(const lag_problem *pb, int k) {
  return is_explicit(pb) ? lag_tangent_size(pb, 0, k) : lag_implicit_tangent_size(pb, k);
}

/* One kick of y by f, and of Y by the derivative F of f. */
static void kick_both(int nq, int k, double h, const double *f, const double *F, double *y, double *Y) {
  lag_tangent_add(nq, h, f + nq, y + nq);
  lag_tangent_add(nq * k, h, F + nq * k, Y + nq * k);
}

/* Repeats the kicks and drifts of compose with their derivatives: a kick adds the derivative of the force to dv, a
 * drift adds dv to dq. */
static int tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  if (!is_explicit(pb)) return lag_implicit_tangent(work, pb, t, k, Y, scratch);
  const lag_composition *c = table_of(pb);
  Verlet *w = work;
  int n = pb->n, nq = half_of(pb), rc = 0;
  double dt = lag_tangent_span(w->step.t0, t, w->step.h * pb->dir), at = 0, *rest;
  lag_tangent all = lag_tangent_layout(pb, k, 1, scratch, &rest);
  double *y = rest, *f = y + n, *F = f + n;

  memcpy(y, w->x + VERLET_Y0 * n, (size_t)n * sizeof *y);
  for (int s = 0; s <= c->stages; s++) {
    if ((rc = lag_tangent_at(&all, w->step.t0 + at * dt, y, f)) != 0) return rc;
    lag_tangent_times(&all, Y, F);
    kick_both(nq, k, c->kick[s] * dt, f, F, y, Y);
    if (s < c->stages) {
      if (!pb->nq && (rc = lag_tangent_at(&all, w->step.t0 + at * dt, y, f)) != 0) return rc;
      if (!pb->nq) lag_tangent_times(&all, Y, F);
      lag_tangent_add(nq, c->drift[s] * dt, pb->nq ? y + nq : f, y);
      lag_tangent_add(nq * k, c->drift[s] * dt, pb->nq ? Y + nq * k : F, Y);
      at += c->drift[s];
    }
  }
  return LAG_OK;
}

static double span(const void *work, const lag_problem *pb, double t) {
  const Verlet *w = work;
  return lag_tangent_span(w->step.t0, t, w->step.h * pb->dir);
}

/* Kicks and drifts, each with its state and rates. */
static int places_of(const lag_problem *pb) { return 2 * table_of(pb)->stages + 1; }

static size_t adjoint_size(const lag_problem *pb) { return is_explicit(pb) ? lag_reverse_size(pb, places_of(pb)) : 0; }

/* x[n] := transposed kick (of the second half by `part` of the rates f at y) or drift (of the first half). */
static int reverse_part(const lag_reverse *w, int is_kick, double t, double part, const double *y, const double *f,
                        double *x) {
  int n = w->pb->n, nq = half_of(w->pb), from = is_kick ? nq : 0;
  memset(w->k, 0, (size_t)n * sizeof *w->k);
  lag_tangent_add(nq, part, x + from, w->k + from);
  if (!is_kick && w->pb->nq) return lag_tangent_add(nq, 1, w->k, x + nq), LAG_OK;
  int rc = lag_reverse_at(w, t, y, f, w->k, w->out);
  if (rc == LAG_OK) lag_tangent_add(n, 1, w->out, x);
  return rc;
}

/* Repeats the kicks and drifts of a step, then goes back over their transposes. */
static int adjoint(lag_problem *pb, double t0, double dt, const double *y0, double *x, double *g, double *scratch) {
  const lag_composition *c = table_of(pb);
  int n = pb->n, nq = half_of(pb), places = places_of(pb), rc = is_explicit(pb) ? LAG_OK : LAG_EMETHOD;
  double *ys = scratch, *f = ys + places * n, at = 0, times[2 * LAG_MAX_DRIFTS + 1];
  const lag_reverse w = lag_reverse_layout(pb, g, f + places * n);
  memcpy(ys, y0, (size_t)n * sizeof *ys);
  for (int i = 0; i < places && rc == LAG_OK; i++) {
    double *y = ys + i * n, *rate = f + i * n;
    times[i] = t0 + at * dt;
    rc = i % 2 && pb->nq ? LAG_OK : lag_step_rhs(pb, times[i], y, rate);
    if (i % 2) at += c->drift[i / 2];
    if (i + 1 == places) break;
    memcpy(y + n, y, (size_t)n * sizeof *y);
    if (i % 2) lag_tangent_add(nq, c->drift[i / 2] * dt, pb->nq ? y + nq : rate, y + n);
    else lag_tangent_add(nq, c->kick[i / 2] * dt, rate + nq, y + n + nq);
  }
  for (int i = places - 1; i >= 0 && rc == LAG_OK; i--)
    rc = reverse_part(&w, i % 2 == 0, times[i], dt * (i % 2 ? c->drift : c->kick)[i / 2], ys + i * n, f + i * n, x);
  return rc;
}

#define DEFINE(id, general, p, properties, line, words)                                                  \
  static const VerletMember member_##id = {&lag_compose_##id, &lag_compose_##general};                   \
  const lag_method lag_##id = {                                                                          \
      .name = #id,                                                                                       \
      .order = p,                                                                                        \
      .dense_order = p,                                                                                  \
      .doc = line,                                                                                       \
      .flags = LAG_METHOD_SYMPLECTIC | LAG_METHOD_NO_STATES | LAG_METHOD_VARIATION | LAG_METHOD_SPLITS | \
               LAG_METHOD_NEWTON | LAG_METHOD_CONSTRAINTS | (properties),                                \
      .noptions = 1,                                                                                     \
      .options = options,                                                                                \
      LAG_METHOD_FUNCTIONS,                                                                              \
      LAG_METHOD_TANGENT,                                                                                \
      .span = span,                                                                                      \
      .adjoint_size = adjoint_size,                                                                      \
      .adjoint = adjoint,                                                                                \
      .variant = &member_##id,                                                                           \
  };
LAG_SPLITTING_METHODS(DEFINE)
