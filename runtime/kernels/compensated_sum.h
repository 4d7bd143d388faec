/* compensated_sum.h: sums over many steps. Needs no library. */
#ifndef LAG_COMPENSATED_SUM_H
#define LAG_COMPENSATED_SUM_H

#include "kernels/scalar.h"

/* ---- sum ---- */

/* s + d; *lost: rounding lost so far, which this sum takes in (two-sum, for operands of any size).
 * A. Neumaier, ZAMM 54 (1974) 39, DOI 10.1002/zamm.19740540106. Rounding then grows at most with
 * the root of the number of steps. */
static inline LAG_REAL lag_compensated_sum(LAG_REAL s, LAG_REAL d, LAG_REAL *lost) {
  const LAG_REAL x = d + *lost, r = s + x, b = r - s;
  *lost = (s - (r - b)) + (x - b);
  return r;
}

/* ---- end ---- */
#endif
