/* Stages and error of one trial step, inlined for a constant tableau: euler.c, rk4.c, rk45.c and dop853.c include this file and expand
 * EMBEDDED_TRIAL. Sums over stages are then unrolled, without zero coefficients.
 * Holds: each component is summed in the same order for every n, so its value does not depend on the other components. */
#pragma once

#include <math.h>

#include "core/rhs.h"
#include "methods/adaptive_rk.h"

/* Dimensions of a problem; row: length of an array in Embedded.x. */
typedef struct EmbeddedShape {
  int nq, n, row;
} EmbeddedShape;

LAG_ALWAYS_INLINE EmbeddedShape embedded_shape(const lag_problem *pb) {
  EmbeddedShape as = {pb->nq, pb->n, lag_adaptive_rk_row(pb)};
  return as;
}

/* A vector of two doubles where the compiler has such types, else one double. Not four: a vector of four would mix rates with coordinates,
 * and the coordinates of a stage, whose sines take most of its time, would wait for the newest rates. */
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

/* Loads two numbers that the model has just stored one by one. They are loaded one by one, too: processors forward a store only to a load
 * of the same size. */
LAG_ALWAYS_INLINE embedded_part embedded_newest(const volatile double *k) {
#if EMBEDDED_VECTORS
  return (embedded_part){k[0], k[1]};
#else
  return k[0];
#endif
}

#define EMBEDDED_TERM(j)                          \
  if (j < count && coef[j] != 0.0) {              \
    s += coef[j] * embedded_at(k + (j) * row);    \
  }

/* sum_j coef[j] k_j over j < count, for the components of one part. */
LAG_ALWAYS_INLINE embedded_part embedded_sum(const double *coef, int count, const double *k, int row) {
  embedded_part s = coef[0] * embedded_at(k);
  EMBEDDED_TERM(1) EMBEDDED_TERM(2) EMBEDDED_TERM(3) EMBEDDED_TERM(4) EMBEDDED_TERM(5) EMBEDDED_TERM(6) EMBEDDED_TERM(7)
  EMBEDDED_TERM(8) EMBEDDED_TERM(9) EMBEDDED_TERM(10) EMBEDDED_TERM(11) EMBEDDED_TERM(12) EMBEDDED_TERM(13)
  EMBEDDED_TERM(14) EMBEDDED_TERM(15)
  return s;
}

/* out[row] := sum_j coef[j] k_j over j < count. */
LAG_ALWAYS_INLINE void embedded_combine(const double *coef, int count, EmbeddedShape as, const double *k, double *out) {
  for (int i = 0; i < as.n; i += EMBEDDED_WIDTH) embedded_set(out + i, embedded_sum(coef, count, k + i, as.row));
}

/* k := f(t, y). > 0: a smaller step may help. */
LAG_ALWAYS_INLINE int embedded_call(lag_problem *pb, int nq, double t, const double *y, double *k) {
  int rc = lag_rhs_inline(pb, nq, t, y, k);
  if (rc) pb->bad_t = t;
  return rc < -1 ? LAG_EMODEL : rc;
}

/* K_s := f(t0 + c_s dt, y0 + dt sum a_sj K_j). The newest stage is added last, so that other terms need not wait for it. */
LAG_ALWAYS_INLINE int embedded_stage(const lag_tableau *tab, lag_problem *pb, EmbeddedShape as, int s, double t0, double dt, const double *y0, double *k,
                                   double *ys) {
  int row = as.row;
  double newest = dt * tab->a[s][s - 1];

  for (int i = 0; i < as.n; i += EMBEDDED_WIDTH) {
    embedded_part y = embedded_at(y0 + i);
    if (s > 1) y += dt * embedded_sum(tab->a[s], s - 1, k + i, row);
    embedded_set(ys + i, y + newest * embedded_newest(k + i + (s - 1) * row));
  }
  return embedded_call(pb, as.nq, t0 + tab->c[s] * dt, ys, k + s * row);
}

/* Y1 := the result of the step, COMP1 := its compensation. */
LAG_ALWAYS_INLINE void embedded_result(const lag_tableau *tab, Embedded *w, EmbeddedShape as, double dt) {
  int row = as.row, last = tab->stages - 1;
  double newest = tab->a[last][last - 1];
  const double *comp = w->x + EMBEDDED_COMP * row, *y0 = w->x + EMBEDDED_Y0 * row, *k = w->x + EMBEDDED_K1 * row;
  double *comp1 = w->x + EMBEDDED_COMP1 * row, *y1 = w->x + EMBEDDED_Y1 * row;
  for (int i = 0; i < as.n; i += EMBEDDED_WIDTH) {
    embedded_part sum = newest * embedded_newest(k + i + (last - 1) * row);
    if (last > 1) sum += embedded_sum(tab->a[last], last - 1, k + i, row);
    embedded_part y = embedded_at(y0 + i), x = dt * sum + embedded_at(comp + i), r = y + x, b = r - y; /* as lag_compensated_sum */
    embedded_set(y1 + i, r);
    embedded_set(comp1 + i, (y - (r - b)) + (x - b));
  }
}

/* Scale of the error of a component: atol + tol max(|y0|, |y1|). */
LAG_ALWAYS_INLINE double embedded_scale(const Embedded *w, const lag_problem *pb, double y0, double y1) {
  double a = fabs(y0), b = fabs(y1);
  return w->limits.atol + pb->tol * (a > b ? a : b);
}

/* Sum of the squares of the components. */
LAG_ALWAYS_INLINE double embedded_square(embedded_part x) {
#if EMBEDDED_VECTORS
  return x[0] * x[0] + x[1] * x[1];
#else
  return x * x;
#endif
}

/* Squared norm of the error of the step just computed; NaN where it is not finite. */
LAG_ALWAYS_INLINE double embedded_error(const lag_tableau *tab, int late, Embedded *w, const lag_problem *pb, EmbeddedShape as, double dt) {
  int row = as.row;
  const double *y0 = w->x + EMBEDDED_Y0 * row, *y1 = w->x + EMBEDDED_Y1 * row, *k = w->x + EMBEDDED_K1 * row;
  double fine = 0, coarse = 0;
  for (int i = 0; i < as.n; i += EMBEDDED_WIDTH) {
    double scale[EMBEDDED_WIDTH];
    for (int j = 0; j < EMBEDDED_WIDTH; j++) scale[j] = embedded_scale(w, pb, y0[i + j], y1[i + j]);
    embedded_part per = 1 / embedded_at(scale);
    fine += embedded_square(per * embedded_sum(tab->e, tab->stages - late, k + i, row));
    coarse += late ? embedded_square(per * embedded_sum(tab->e3, tab->stages - 1, k + i, row)) : 0;
  }
  fine *= dt * dt * w->per;
  coarse *= 0.01 * dt * dt * w->per;
  double both = fine + coarse;
  return !isfinite(both) ? NAN : late ? (both > 0 ? fine * (fine / both) : 0) : fine;
}

/* The last stage: projects the end of the step to the constraints, then k := f there. > 0: a smaller step may help. */
LAG_ALWAYS_INLINE int embedded_end(lag_problem *pb, Embedded *w, EmbeddedShape as, double tb, double *k) {
  double *y1 = w->x + EMBEDDED_Y1 * as.row;
  int rc = pb->model->constraints ? lag_project_step(pb, tb, w->x + EMBEDDED_Y0 * as.row, y1, w->x + EMBEDDED_COMP1 * as.row) : 0;
  if (pb->model->constraints && rc == 0 && w->limits.fixed == 0.0) rc = lag_adaptive_rk_reversal(w, pb, tb);
  return rc ? rc : embedded_call(pb, as.nq, tb, y1, k);
}

#define EMBEDDED_STAGE(s)                                                 \
  if (s < last && (*rc = embedded_stage(tab, pb, as, s, t, dt, y0, k, ys)) != 0) { \
    return NAN;                                                           \
  }

LAG_ALWAYS_INLINE double embedded_trial(const lag_tableau *tab, int late, Embedded *w, lag_problem *pb, EmbeddedShape as, double t, double tb,
                                      double dt, int *rc) {
  int row = as.row, last = tab->stages - 1;
  double *k = w->x + EMBEDDED_K1 * row, *ys = w->x + EMBEDDED_YS * row;
  const double *y0 = w->x + EMBEDDED_Y0 * row;

  EMBEDDED_STAGE(1) EMBEDDED_STAGE(2) EMBEDDED_STAGE(3) EMBEDDED_STAGE(4) EMBEDDED_STAGE(5) EMBEDDED_STAGE(6)
  EMBEDDED_STAGE(7) EMBEDDED_STAGE(8) EMBEDDED_STAGE(9) EMBEDDED_STAGE(10) EMBEDDED_STAGE(11)
  embedded_result(tab, w, as, dt);
  if (!tab->order_embedded && lag_not_finite(pb->n, w->x + EMBEDDED_Y1 * row) >= 0) return NAN;
  if (!late && (*rc = embedded_end(pb, w, as, tb, k + last * row)) != 0) return NAN;
  if (!tab->order_embedded) return lag_not_finite(pb->n, k + last * row) < 0 ? 0 : NAN;
  double err = embedded_error(tab, late, w, pb, as, dt);
  if (err > 1 && pb->model->constraints) err = lag_adaptive_rk_error_along(tab, late, w, pb, tb, dt, err);
  if (late && (err <= 1 || (w->limits.fixed != 0.0 && !isnan(err)))) {
    *rc = embedded_end(pb, w, as, tb, k + last * row);
    if (*rc || lag_not_finite(pb->n, k + last * row) >= 0) return NAN;
  }
  return err;
}

/* Defines EmbeddedPair.trial for a tableau of at most 13 stages, specialised for one, two and three coordinates. */
#define EMBEDDED_TRIAL(tableau, late)                                                                     \
  static double trial(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc)              \
  {                                                                                                       \
    switch (pb->nz == 0 ? pb->nq : 0) {                                                                   \
    case 1: return embedded_trial(&tableau, late, w, pb, (EmbeddedShape){1, 2, EMBEDDED_SMALL}, t, tb, dt, rc); \
    case 2: return embedded_trial(&tableau, late, w, pb, (EmbeddedShape){2, 4, EMBEDDED_SMALL}, t, tb, dt, rc); \
    case 3: return embedded_trial(&tableau, late, w, pb, (EmbeddedShape){3, 6, EMBEDDED_SMALL}, t, tb, dt, rc); \
    default: return embedded_trial(&tableau, late, w, pb, embedded_shape(pb), t, tb, dt, rc);             \
    }                                                                                                     \
  }
