/* runge_kutta.h: a step of an explicit Runge-Kutta method, and its error: the code to which tables
 * of runge_kutta_tables.h expand, unrolled, without coefficients that are 0. Needs no library.
 *
 * A step's function has variables n (components), t, h, y (the state at t), x (the state at a
 * stage, then the result), k (rates of stages) and status; for errors also square[2] = {0}, even[2].
 * An instance defines:
 *   LAG_RATES(t, x, s)    a status; rates of stage s := f(t, x)
 *   LAG_ADD(i, d)         the result's component i := y + d, with compensation of rounding
 *   LAG_ALLOWED(i, size)  allowed error of component i, whose magnitude is `size`
 * and, where it computes several components at once, LAG_EACH and others below. */
#ifndef LAG_RUNGE_KUTTA_H
#define LAG_RUNGE_KUTTA_H

#include "kernels/compensated_sum.h"
#include "kernels/runge_kutta_tables.h"

/* ---- runge_kutta ---- */

#ifndef LAG_EACH
#define LAG_EACH(i) for (int i = 0; i < n; i++)
#define LAG_RATE(s) k[s] /* rates of stage s */
#define LAG_AT(x, i) (x)[i]
#define LAG_NEWEST(x, i) (x)[i] /* the same, of values just stored */
#define LAG_SET(x, i, value) (x)[i] = value
#endif
/* The newest stage is added last, so that other terms need not wait for it. */
#define LAG_LEAD_OF(j, a) (a)*LAG_AT(LAG_RATE(j), i)
#define LAG_TERM_OF(j, a) + (a)*LAG_AT(LAG_RATE(j), i)
#define LAG_LEAD(j, number) LAG_C(number)*LAG_AT(LAG_RATE(j), i)
#define LAG_TERM(j, number) + LAG_C(number)*LAG_AT(LAG_RATE(j), i)
#define LAG_STAGE_1(s, c, newest) \
  LAG_EACH(i) LAG_SET(x, i, LAG_AT(y, i) + (h*(newest))*LAG_NEWEST(LAG_RATE((s) - 1), i)); \
  LAG_TRY(LAG_RATES(t + (c)*h, x, s));
#define LAG_STAGE(s, c, older, newest) \
  LAG_EACH(i) LAG_SET(x, i, LAG_AT(y, i) + h*(older) + (h*(newest))*LAG_NEWEST(LAG_RATE((s) - 1), i)); \
  LAG_TRY(LAG_RATES(t + (c)*h, x, s));
#define LAG_RESULT_1(s, newest) LAG_EACH(i) LAG_ADD(i, h*((newest)*LAG_NEWEST(LAG_RATE((s) - 1), i)));
#define LAG_RESULT(s, older, newest) LAG_EACH(i) LAG_ADD(i, h*(older + (newest)*LAG_NEWEST(LAG_RATE((s) - 1), i)));

/* ---- dense ---- */
/* The highest terms of dense output, rows `high`. */
#define LAG_DENSE(j, terms) LAG_EACH(i) LAG_SET(LAG_HIGH(j), i, terms);

/* ---- errors ---- */

/* Squares are added in pairs of components. */
#ifndef LAG_WEIGH
#define LAG_WEIGH(per, i) \
  const LAG_REAL before = LAG_FN(fabs)(y[i]), after = LAG_FN(fabs)(x[i]); \
  const LAG_REAL per = LAG_C(1.0)/LAG_ALLOWED(i, LAG_SELECT(before > after, before, after))
#define LAG_SQUARE(e, value) \
  const LAG_REAL term##e = value; \
  even[e] = i % 2 ? even[e] + term##e*term##e : term##e*term##e; \
  if (i % 2 || i == n - 1) square[e] += even[e]
#endif
#define LAG_ERROR(e, terms) LAG_SQUARE(e, per*(terms));
/* Sums over components of their errors' squares, by a table's ERRORS. */
#define LAG_SQUARES(errors) \
  LAG_EACH(i) { \
    LAG_WEIGH(per, i); \
    errors \
  }

/* The squared error of a step h, from sums of squares: |e|^2, or of two estimates
 * |e|^4/(|e|^2 + 0.01 |e3|^2), |x|^2 = 1/n sum (x_i/s_i)^2 with allowed errors s_i; not a number
 * where one is not finite. per: 1/n. HNW II.4, II.10. */
static inline LAG_REAL lag_squared_error(LAG_REAL first, LAG_REAL second, int two, LAG_REAL h, LAG_LANE per) {
  const LAG_REAL zero = LAG_C(0.0), fine = first*(h*h*per), coarse = two ? second*(LAG_C(0.01)*h*h*per) : zero;
  const LAG_REAL both = fine + coarse;
  if (!two) return fine + both*zero;
  return LAG_SELECT(both > zero, fine*(fine/both), zero) + both*zero;
}

/* ---- end ---- */
#endif
