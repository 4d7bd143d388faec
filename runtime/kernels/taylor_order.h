/* taylor_order.h: the order of a Taylor series, from the tolerance and what an order costs.
 * Includes <math.h> only. */
#ifndef LAG_TAYLOR_ORDER_H
#define LAG_TAYLOR_ORDER_H

#include "kernels/scalar.h"

/* ---- taylor_order ---- */

/* The relative error aimed at in a step, as -log2: a fraction of the tolerance, and far below
 * rounding where the tolerance is near rounding: 10 bits at 1e-15, 0 at 1e-13. Errors of one sign
 * add up as the number of steps, rounding as its root. */
static inline LAG_REAL lag_taylor_bits(LAG_REAL tolerance, LAG_REAL epsilon) {
  const LAG_REAL left = LAG_C(1.5)*(LAG_C(9.0) - LAG_FN(log2)(tolerance/epsilon));
  const LAG_REAL most = LAG_C(10.0), zero = LAG_C(0.0);
  const LAG_REAL more = LAG_SELECT(left < zero, zero, LAG_SELECT(left > most, most, left));
  return LAG_C(2.0) - LAG_FN(log2)(tolerance) + more;
}

/* Costs in operations: of a step besides its series, of an operation of order 0, of a term in the
 * sums over lower orders, of each product in such a term; numbers of operations of order 0, of
 * orders above, and of sums. Measured for doubles, of which two or four are summed at a time. */
typedef struct lag_taylor_costs {
  LAG_LANE step, first, term, product, of_first, of_next, sums;
} lag_taylor_costs;

/* The order with the most time covered per operation, of 6, 6 + stride, ..., at most `most`; 0:
 * there is none. The rounding of an increment is proportional to the step: where only rounding is
 * left, products count fully, which gives lower orders and shorter steps. */
static inline LAG_REAL lag_taylor_best_order(const lag_taylor_costs *c, LAG_REAL tolerance, LAG_REAL epsilon,
                                             int stride, int most) {
  const LAG_REAL one = LAG_C(1.0), zero = LAG_C(0.0), bits = lag_taylor_bits(tolerance, epsilon);
  const LAG_MASK full = LAG_AND(tolerance < LAG_C(16.0)*epsilon, zero + c->product < one);
  const LAG_REAL term = c->term + LAG_SELECT(full, one, zero + c->product)*c->sums;
  LAG_REAL least = zero, best = zero;
  for (int k = 6; k <= most; k += stride) {
    const LAG_REAL of = zero + (LAG_LANE)k, orders = of*(c->of_next + LAG_C(5.0)) + of*(of - one)/LAG_C(2.0)*term;
    const LAG_REAL cost = (c->step + c->first*c->of_first + orders)*LAG_FN(exp2)(bits/(of + one));
    const LAG_MASK better = LAG_OR(LAG_NOT(best > zero), cost < least);
    best = LAG_SELECT(better, of, best);
    least = LAG_SELECT(better, cost, least);
  }
  return best;
}

/* ---- end ---- */
#endif
