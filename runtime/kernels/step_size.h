/* step_size.h: sizes of adaptive steps by their errors. E. Hairer, S.P. Norsett, G. Wanner,
 * Solving Ordinary Differential Equations I, 2nd ed. (1993), DOI 10.1007/978-3-540-78862-1, II.4:
 * PI controller, first step. */
#ifndef LAG_STEP_SIZE_H
#define LAG_STEP_SIZE_H

#include "kernels/compensated_sum.h"

/* x^p within a few percent; headers have that of lag_math.h, too. */
#if defined(LAG_REAL_IS_DOUBLE) || defined(LAG_LANES)
#include "lag_math.h"
#else
static inline LAG_REAL lag_rough_power(LAG_REAL x, LAG_REAL p) { return LAG_FN(pow)(x, p); }
#endif

/* ---- step_size ---- */

/* h grows by the factor safety err_old^beta/err^(ratio beta), between least and most. */
typedef struct lag_controller {
  int order, ratio;
  LAG_LANE beta, safety, least, most;
} lag_controller;

/* Factor from an accepted step to the next. error: its square; *memory: err_old^-beta, 0 where none
 * is known, negative after a rejected try. One power serves the error and its memory. */
static inline LAG_REAL lag_growth(const lag_controller *c, LAG_REAL error, LAG_REAL *memory) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), tiny = LAG_C(1e-24), floor_of_error = LAG_C(1e-8);
  const LAG_REAL exponent = -c->beta/LAG_C(2.0);
  const LAG_REAL power = lag_rough_power(LAG_SELECT(error > tiny, error, tiny), exponent);
  const LAG_REAL least = zero + c->least, most = LAG_SELECT(*memory < zero, one, zero + c->most);
  LAG_REAL f = zero + c->safety;
  f /= LAG_SELECT(*memory > zero, *memory, lag_rough_power(floor_of_error, exponent));
  for (int i = 0; i < c->ratio; i++) f *= power;
  *memory = LAG_SELECT(error > floor_of_error, power, lag_rough_power(floor_of_error, exponent));
  f = LAG_SELECT(most < f, most, f);
  return LAG_SELECT(least > f, least, f);
}

/* Factor from a rejected step to its next try; an error that is not finite, or negative, halves
 * it. */
static inline LAG_REAL lag_shrinkage(const lag_controller *c, LAG_REAL error) {
  const LAG_REAL zero = LAG_C(0.0), half = LAG_C(0.5), least = zero + c->least;
  const LAG_REAL less = c->safety*lag_rough_power(error, -half*(LAG_LANE)c->ratio*c->beta);
  return LAG_SELECT(error >= zero, LAG_SELECT(least > less, least, less), half);
}

/* A step h to the time t; lost: rounding of sums of times. clipped: `wanted` would have gone on. */
typedef struct lag_aimed {
  LAG_REAL wanted, h, t, lost;
  LAG_MASK clipped;
} lag_aimed;

/* A step of the wanted size from t, or by `gap` to the time `end` where less than 1e-4 of it would be left. */
static inline lag_aimed lag_aim(LAG_REAL t, LAG_REAL lost, LAG_REAL dir, LAG_REAL wanted, LAG_REAL gap, LAG_REAL end) {
  lag_aimed a;
  a.wanted = wanted;
  a.clipped = LAG_NOT(wanted*(LAG_C(1.0) + LAG_C(1e-4)) < gap); /* of NaN, too */
  a.h = LAG_SELECT(a.clipped, gap, wanted);
  a.lost = lost;
  a.t = lag_compensated_sum(t, dir*a.h, &a.lost);
  a.t = LAG_SELECT(a.clipped, end, a.t);
  a.lost = LAG_SELECT(a.clipped, LAG_C(0.0), a.lost);
  return a;
}

/* *step := the size after a step taken, or tried in vain; *memory: of lag_growth; other lanes keep both. */
static inline void lag_next_size(const lag_controller *c, const lag_aimed *a, LAG_REAL error, LAG_MASK taken,
                                 LAG_MASK tried, LAG_REAL *step, LAG_REAL *memory) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  LAG_REAL known = *memory, next = LAG_SELECT(taken, a->h*lag_growth(c, error, &known), zero);
  next = LAG_SELECT(LAG_AND(a->clipped, LAG_NOT(next > a->wanted)), a->wanted, next);
  *step = LAG_SELECT(taken, next, LAG_SELECT(tried, a->h*lag_shrinkage(c, error), *step));
  *memory = LAG_SELECT(taken, known, LAG_SELECT(tried, -one, *memory));
}

/* First step: an Euler step h0 from d0 and d1, norms of y and its rates f in allowed errors;
 * longest 0: no limit. */
static inline LAG_REAL lag_first_euler_step(LAG_REAL d0, LAG_REAL d1, LAG_REAL longest) {
  const LAG_REAL zero = LAG_C(0.0), tiny = LAG_C(1e-5);
  const LAG_REAL h0 = LAG_SELECT(LAG_OR(d0 < tiny, d1 < tiny), LAG_C(1e-6), LAG_C(0.01)*d0/d1);
  return LAG_SELECT(LAG_AND(longest > zero, h0 > longest), longest, h0);
}

/* Then the step of a method of this order; d2: norm of the change of f in h0, by h0. */
static inline LAG_REAL lag_first_size(int order, LAG_REAL h0, LAG_REAL d1, LAG_REAL d2) {
  const LAG_REAL zero = LAG_C(0.0), d = LAG_SELECT(d1 > d2, d1, d2), most = LAG_C(100.0)*h0, little = LAG_C(1e-3)*h0;
  LAG_REAL h = LAG_SELECT(little > LAG_C(1e-6), little, LAG_C(1e-6));
  h = LAG_SELECT(d <= LAG_C(1e-15), h, LAG_FN(pow)(LAG_C(0.01)/d, LAG_C(1.0)/(LAG_LANE)order));
  h = LAG_SELECT(h < most, h, most);
  return LAG_SELECT(LAG_AND(h > zero, h - h == zero), h, little);
}

/* State y and rates f at the time t; the longest step, 0: no limit; the unit of time of steps as numbers; y1[n] and
 * f1[n]: scratch. */
typedef struct lag_first_try {
  int n, order;
  LAG_REAL dir, t, longest, unit;
  const LAG_REAL *y, *f;
  LAG_REAL *y1, *f1;
} lag_first_try;

/* ---- end ---- */
#endif
