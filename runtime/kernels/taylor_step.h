/* taylor_step.h: a step by a Taylor series. Enters: order 0 of the series at its begin; leaves: the series, and a try
 * of a step with its end and error. Sources, and why: runtime/methods/taylor.c.
 *
 * An instance defines before it includes this text:
 *   LAG_SERIES_MODEL          the first parameters of functions: the model, the method's memory
 *   LAG_SERIES_FLOOR(i)       of component i, the absolute error allowed by the relative one
 *   LAG_SERIES_BEGIN(t, y, x) a status; x[columns] := order 0 at t, y, whose rates are finite
 *   LAG_SERIES_REST(order, unit, x)             the orders above
 *   LAG_SERIES_AT(order, s, x, sum, slope)      sum := the series at s units less its order 0, slope its derivative */
#ifndef LAG_TAYLOR_STEP_H
#define LAG_TAYLOR_STEP_H

#include "kernels/compensated_sum.h"
#include "kernels/taylor_size.h"

#ifndef LAG_SERIES_MODEL /* no instance: the text by itself */
#define LAG_SERIES_MODEL const void *model
#define LAG_SERIES_FLOOR(i) ((void)model, LAG_C(0.0))
#define LAG_SERIES_BEGIN(t, y, x) ((void)model, (void)(t), (void)(y), (void)(x), 0)
#define LAG_SERIES_REST(order, unit, x) ((void)model, (void)(unit), (void)(x))
#define LAG_SERIES_AT(order, s, x, sum, slope) ((void)model, (void)(s), (void)(x), (void)(sum), (void)(slope))
#endif

/* ---- taylor_step ---- */

/* A series along the motion, its order 0 at the end of a step, and room. unit: of time in its coefficients. */
typedef struct lag_taylor_frame {
  int order, columns, nq, nz;
  LAG_REAL *x, *end, *sum, *slope, *scale;
  const LAG_REAL *lost; /* rounding that y has lost; at the end of the step y1 and lost1 */
  LAG_REAL *y1, *lost1;
} lag_taylor_frame;

/* The largest power of 2 that is not above |x| > 0. */
static inline LAG_REAL lag_power_below(LAG_REAL x) {
#ifdef LAG_LANES
  return (LAG_REAL)((LAG_MASK)x & 0x7ff0000000000000LL);
#else
  LAG_REAL r = LAG_C(1.0);
  x = LAG_FN(fabs)(x);
  while (r > x) r *= LAG_C(0.5);
  while (r*LAG_C(2.0) <= x) r *= LAG_C(2.0);
  return r;
#endif
}

/* Unit of a first series, by the time scale of the state. */
static inline LAG_REAL lag_taylor_unit(LAG_SERIES_MODEL, const lag_taylor_frame *f, const LAG_REAL *y) {
  const int nq = f->nq, n = 2*nq + f->nz;
  const LAG_REAL *const rates = f->x + n, zero = LAG_C(0.0), one = LAG_C(1.0);
  LAG_REAL fastest = zero;
  for (int i = 0; i < n; i++) {
    const LAG_REAL rate = LAG_FN(fabs)(i < nq ? y[nq + i] : rates[i - nq])/(LAG_FN(fabs)(y[i]) + LAG_SERIES_FLOOR(i));
    fastest = LAG_SELECT(rate > fastest, rate, fastest);
  }
  return LAG_SELECT(LAG_AND(fastest > zero, fastest - fastest == zero), one/lag_power_below(fastest), one);
}

/* Expands the series of `live`, in a smaller unit where coefficients are not finite in this one. Returns those
 * without one. */
static inline LAG_MASK lag_taylor_expand(LAG_SERIES_MODEL, const lag_taylor_frame *f, LAG_REAL dir, LAG_MASK live,
                                         LAG_REAL *unit) {
  const int n = 2*f->nq + f->nz;
  LAG_REAL next = *unit;
  LAG_MASK none = live;
  for (int attempt = 0; attempt < 8 && LAG_ANY(none); attempt++) {
    *unit = LAG_SELECT(live, next, *unit);
    LAG_SERIES_REST(f->order, dir*next, f->x);
    none = LAG_AND(live, LAG_NOT(lag_finite(f->x + f->order*f->columns, n)));
    next = LAG_SELECT(none, next*LAG_C(9.094947017729282379150390625e-13), next);
  }
  return none;
}

/* Step by the root test of the last coefficients, at most `longest` (0: no limit); 1 where neither says anything. */
static inline LAG_REAL lag_taylor_size(LAG_SERIES_MODEL, const lag_taylor_frame *f, const LAG_REAL *y, LAG_REAL unit,
                                       LAG_REAL reach, LAG_REAL longest) {
  const int n = 2*f->nq + f->nz;
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  for (int i = 0; i < n; i++)
    f->scale[i] = one/(LAG_FN(fabs)(y[i]) + LAG_FN(fabs)(f->x[f->columns + i]) + LAG_SERIES_FLOOR(i));
  const LAG_REAL root = lag_taylor_root(f->x, f->order, f->columns, n, f->scale, LAG_C(2.2250738585072014e-308));
  LAG_REAL h = LAG_SELECT(root > zero, unit*reach/root, zero);
  h = LAG_SELECT(LAG_AND(longest > zero, LAG_NOT(LAG_AND(h > zero, h < longest))), longest, h);
  return LAG_SELECT(LAG_AND(h > zero, h - h == zero), h, one);
}

/* A try of a step dt, to the time t1: its end, and its error times the tolerance. unit: with the sign of dt. Returns
 * the status of the model there. */
static inline int lag_taylor_try(LAG_SERIES_MODEL, const lag_taylor_frame *f, const LAG_REAL *y, LAG_REAL unit,
                                 LAG_REAL t1, LAG_REAL dt, LAG_REAL *error) {
  const int n = 2*f->nq + f->nz;
  LAG_SERIES_AT(f->order, dt/unit, f->x, f->sum, f->slope);
  for (int i = 0; i < n; i++) {
    f->lost1[i] = f->lost[i];
    f->y1[i] = lag_compensated_sum(y[i], f->sum[i], &f->lost1[i]);
  }
  const int status = LAG_SERIES_BEGIN(t1, f->y1, f->end);
  *error = lag_taylor_error(f->order, f->nq, f->nz, unit, LAG_FN(fabs)(dt), f->slope, f->end + n, f->scale);
  return status;
}

/* ---- end ---- */
#endif
