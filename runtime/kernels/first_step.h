/* first_step.h: the first step to try of an adaptive method. One Euler step measures the second derivative: HNW II.4,
 * "starting step size" (step_size.h).
 *
 * An instance defines before it includes this text:
 *   LAG_START_MODEL           the first parameters of functions: the model and tolerances
 *   LAG_THE_START             the same as arguments
 *   LAG_START_ALLOWED(i, size) the error of component i that is allowed
 *   LAG_START_RATES(t, y, f)  a status; f[n] := rates at t, y */
#ifndef LAG_FIRST_STEP_H
#define LAG_FIRST_STEP_H

#include "kernels/step_size.h"

#ifndef LAG_START_MODEL /* no instance: the text by itself */
#define LAG_START_MODEL const void *model
#define LAG_THE_START model
#define LAG_START_ALLOWED(i, size) ((void)model, (size))
#define LAG_START_RATES(t, y, f) ((void)model, (void)(t), (void)(y), (void)(f), 0)
#endif

/* ---- first_step ---- */

/* Root mean square of x[n] in allowed errors. */
static inline LAG_REAL lag_start_norm(LAG_START_MODEL, int n, const LAG_REAL *x, const LAG_REAL *y) {
  LAG_REAL sum = LAG_C(0.0);
  for (int i = 0; i < n; i++) {
    const LAG_REAL r = x[i]/LAG_START_ALLOWED(i, LAG_FN(fabs)(y[i]));
    sum += r*r;
  }
  return LAG_FN(sqrt)(sum/(LAG_LANE)(n > 0 ? n : 1));
}

static inline LAG_REAL lag_start_step(LAG_START_MODEL, const lag_first_try *s) {
  const LAG_REAL d1 = s->unit*lag_start_norm(LAG_THE_START, s->n, s->f, s->y);
  const LAG_REAL h0 =
    lag_first_euler_step(lag_start_norm(LAG_THE_START, s->n, s->y, s->y), d1, s->longest/s->unit);
  const LAG_REAL euler = h0*s->unit, t1 = s->t + s->dir*euler;
  for (int i = 0; i < s->n; i++) s->y1[i] = s->y[i] + s->dir*euler*s->f[i];
  const LAG_MASK failed = LAG_FAILED(LAG_START_RATES(t1, s->y1, s->f1));
  if (!LAG_ANY(LAG_NOT(failed))) return euler*LAG_C(1e-3);
  for (int i = 0; i < s->n; i++) s->f1[i] -= s->f[i];
  const LAG_REAL d2 = s->unit*lag_start_norm(LAG_THE_START, s->n, s->f1, s->y)/h0;
  return LAG_SELECT(failed, euler*LAG_C(1e-3), s->unit*lag_first_size(s->order, h0, d1, d2));
}

/* ---- end ---- */
#endif
