/* Stages and error of one trial step by kernels/runge_kutta.h: files of methods include this one behind their tables,
 * EMBEDDED_STAGES with the result and EMBEDDED_ERRORS, of method `id` where they have several. Holds: each component
 * is summed in the same order for every n, so its value does not depend on the other components. */
#pragma once

#include <math.h>

#include "core/rhs.h"
#include "methods/adaptive_rk.h"

/* Dimensions of a problem; row: length of an array in Embedded.x; alike: rates of coordinates are the velocities at
 * their stage, bit by bit. */
typedef struct EmbeddedShape {
  int nq, n, row, alike;
} EmbeddedShape;

LAG_ALWAYS_INLINE EmbeddedShape embedded_shape(const lag_problem *pb) {
  EmbeddedShape as = {pb->nq, pb->n, lag_adaptive_rk_row(pb), 0};
  return as;
}

/* A vector of two doubles where the compiler has such types, else one double. Not four: a vector of four would mix
 * rates with coordinates, and the coordinates of a stage, whose sines take most of its time, would wait for the
 * newest rates. */
#if defined(__GNUC__) && defined(LAG_REAL_IS_DOUBLE)
#define EMBEDDED_VECTORS 1
typedef double embedded_part __attribute__((vector_size(16), aligned(8), may_alias));
#else
#define EMBEDDED_VECTORS 0
typedef double embedded_part;
#endif
enum { EMBEDDED_WIDTH = sizeof(embedded_part) / sizeof(double) };

LAG_ALWAYS_INLINE embedded_part embedded_at(const double *x) { return *(const embedded_part *)(const void *)x; }

LAG_ALWAYS_INLINE void embedded_set(double *x, embedded_part s) { *(embedded_part *)(void *)x = s; }

/* Loads the newest rates k of component i, of the state x. The model has just stored them one by one, so they are
 * loaded one by one, too: processors forward a store only to a load of the same size. Velocities come from x, which
 * saves the way by k: a stage waits for the one before. */
LAG_ALWAYS_INLINE double embedded_rate(EmbeddedShape as, const volatile double *k, const double *x, int i) {
  return as.alike && i < as.nq ? x[as.nq + i] : k[i];
}

LAG_ALWAYS_INLINE embedded_part embedded_newest(EmbeddedShape as, const double *k, const double *x, int i) {
#if EMBEDDED_VECTORS
  if (as.alike && as.nq % EMBEDDED_WIDTH == 0 && i < as.nq) return embedded_at(x + as.nq + i);
  return (embedded_part){embedded_rate(as, k, x, i), embedded_rate(as, k, x, i + 1)};
#else
  return embedded_rate(as, k, x, i);
#endif
}

/* k := f(t, y). > 0: a smaller step may help. */
LAG_ALWAYS_INLINE int embedded_call(lag_problem *pb, int nq, double t, const double *y, double *k) {
  int rc = lag_rhs_inline(pb, nq, t, y, k);
  if (rc) pb->bad_t = t;
  return rc < -1 ? LAG_EMODEL : rc;
}

/* The result's components i, with compensation: as lag_compensated_sum. */
LAG_ALWAYS_INLINE void embedded_add(Embedded *w, EmbeddedShape as, int i, embedded_part d) {
  double *at = w->x + i;
  const embedded_part y = embedded_at(at + EMBEDDED_Y0 * as.row), x = d + embedded_at(at + EMBEDDED_COMP * as.row);
  const embedded_part r = y + x, b = r - y;
  embedded_set(at + EMBEDDED_Y1 * as.row, r);
  embedded_set(at + EMBEDDED_COMP1 * as.row, (y - (r - b)) + (x - b));
}

/* Scale of the error of component i: tol (floor + max(|y0|, |y1|)). */
LAG_ALWAYS_INLINE double embedded_scale(const Embedded *w, const lag_problem *pb, int i, double y0, double y1) {
  double a = fabs(y0), b = fabs(y1);
  return pb->tol * lag_tolerance_floor(&w->limits, pb, i) + pb->tol * (a > b ? a : b);
}

/* Sum of the squares of the components. */
LAG_ALWAYS_INLINE double embedded_square(embedded_part x) {
#if EMBEDDED_VECTORS
  return x[0] * x[0] + x[1] * x[1];
#else
  return x * x;
#endif
}

/* 1/(allowed errors) of components i, of y before a step and x after. */
LAG_ALWAYS_INLINE embedded_part embedded_weight(const Embedded *w, const lag_problem *pb, int i, const double *y,
                                                const double *x) {
#if EMBEDDED_VECTORS /* not by way of memory: a pair is not forwarded from two stores */
  return 1 / (embedded_part){embedded_scale(w, pb, i, y[i], x[i]), embedded_scale(w, pb, i + 1, y[i + 1], x[i + 1])};
#else
  return 1 / embedded_scale(w, pb, i, y[i], x[i]);
#endif
}

#define LAG_EACH(i) for (int i = 0; i < as.n; i += EMBEDDED_WIDTH)
#define LAG_RATE(s) (k + (s) * as.row)
#define LAG_AT(x, i) embedded_at((x) + (i))
#define LAG_NEWEST(rate, i) embedded_newest((rate) == k ? (EmbeddedShape){0} : as, rate, x, i) /* k: of y, not of x */
#define LAG_SET(x, i, value) embedded_set((x) + (i), value)
#define LAG_RATES(t, x, s) embedded_call(pb, as.nq, t, x, LAG_RATE(s))
#define LAG_ADD(i, d) embedded_add(w, as, i, d)
#define LAG_WEIGH(per, i) const embedded_part per = embedded_weight(w, pb, i, y, x)
#define LAG_SQUARE(e, value) square[e] += embedded_square(value)
#define LAG_HIGH(j) (high + (j) * as.row)
#include "kernels/runge_kutta.h"

/* All stages but the last, and the result. > 0: a smaller step may help. */
LAG_ALWAYS_INLINE int embedded_stages(int id, Embedded *w, lag_problem *pb, EmbeddedShape as, double t,
                                      double h) {
  double *k = w->x + EMBEDDED_K1 * as.row, *x = w->x + EMBEDDED_YS * as.row;
  const double *y = w->x + EMBEDDED_Y0 * as.row;
  int status = 0;
  (void)id, (void)pb, (void)t, (void)x, (void)y; /* euler has no stages */
  EMBEDDED_STAGES
  return status;
}

/* Squared norm of the error of the step just computed; NaN where it is not finite. */
LAG_ALWAYS_INLINE double embedded_error(const EmbeddedPair *of, int id, Embedded *w, const lag_problem *pb,
                                        EmbeddedShape as, double h) {
  const double *y = w->x + EMBEDDED_Y0 * as.row, *x = w->x + EMBEDDED_Y1 * as.row, *k = w->x + EMBEDDED_K1 * as.row;
  double square[2] = {0, 0};
  (void)id, (void)k;
  LAG_SQUARES(EMBEDDED_ERRORS)
  return lag_squared_error(square[0], square[1], of->late, h, w->per);
}

/* The last stage: projects the end of the step to the constraints, then k := f there. > 0: a smaller step may help. */
LAG_ALWAYS_INLINE int embedded_end(lag_problem *pb, Embedded *w, EmbeddedShape as, double tb, double *k) {
  double *y1 = w->x + EMBEDDED_Y1 * as.row;
  int rc = pb->model->constraints
               ? lag_project_step(pb, tb, w->x + EMBEDDED_Y0 * as.row, y1, w->x + EMBEDDED_COMP1 * as.row)
               : 0;
  if (pb->model->constraints && rc == 0 && w->limits.fixed == 0.0) rc = lag_adaptive_rk_reversal(w, pb, tb);
  return rc ? rc : embedded_call(pb, as.nq, tb, y1, k);
}

/* Whether a component of x is not finite. */
LAG_ALWAYS_INLINE int embedded_not_finite(EmbeddedShape as, const double *x) {
  double zero = 0;
  for (int i = 0; i < as.n; i++) zero += x[i] * 0;
  return isnan(zero);
}

/* A trial step from t to tb = t + dt. */
typedef struct EmbeddedStep {
  double t, tb, dt;
} EmbeddedStep;

LAG_ALWAYS_INLINE double embedded_trial(const EmbeddedPair *of, int id, Embedded *w, lag_problem *pb,
                                        EmbeddedShape as, EmbeddedStep s, int *rc) {
  int row = as.row, last = of->tab->stages - 1, adapts = of->control.order > 0;
  double *end = w->x + EMBEDDED_K1 * row + last * row, err = 0;
  if ((*rc = embedded_stages(id, w, pb, as, s.t, s.dt)) != 0) return NAN;
  if (!adapts && embedded_not_finite(as, w->x + EMBEDDED_Y1 * row)) return NAN;
  if (adapts) {
    if (!of->late && (*rc = embedded_end(pb, w, as, s.tb, end)) != 0) return NAN;
    err = embedded_error(of, id, w, pb, as, s.dt);
    if (err > 1 && pb->model->constraints)
      err = lag_adaptive_rk_error_along(of->tab, of->late, w, pb, s.tb, s.dt, err);
    if (!of->late || !(err <= 1 || (w->limits.fixed != 0.0 && !isnan(err)))) return err;
  }
  *rc = embedded_end(pb, w, as, s.tb, end);
  return *rc || embedded_not_finite(as, end) ? NAN : err;
}

/* EmbeddedPair.trial, specialised for one, two and three coordinates. */
LAG_ALWAYS_INLINE double embedded_try(const EmbeddedPair *of, int id, Embedded *w, lag_problem *pb, EmbeddedStep s,
                                      int *rc) {
  switch (pb->nz == 0 && !pb->redundant ? pb->nq : 0) {
  case 1: return embedded_trial(of, id, w, pb, (EmbeddedShape){1, 2, EMBEDDED_SMALL, 1}, s, rc);
  case 2: return embedded_trial(of, id, w, pb, (EmbeddedShape){2, 4, EMBEDDED_SMALL, 1}, s, rc);
  case 3: return embedded_trial(of, id, w, pb, (EmbeddedShape){3, 6, EMBEDDED_SMALL, 1}, s, rc);
  default: return embedded_trial(of, id, w, pb, embedded_shape(pb), s, rc);
  }
}

/* The trial step of a pair, and the pair. */
#define EMBEDDED_TRIAL(trial, pair, id)                                                               \
  static double trial(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc) {        \
    return embedded_try(&pair, id, w, pb, (EmbeddedStep){t, tb, dt}, rc);                             \
  }
