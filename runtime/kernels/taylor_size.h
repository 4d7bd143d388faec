/* taylor_size.h: the size of a step by a Taylor series, and its error. Sources:
 * runtime/methods/taylor.c. */
#ifndef LAG_TAYLOR_SIZE_H
#define LAG_TAYLOR_SIZE_H

#include "kernels/step_size.h"

/* ---- taylor_size ---- */

/* max |x_k|^(1/k) over the last five orders of the series x[order + 1][columns], |x| = max scale_i
 * |x_i| over i < n; 0: coefficients up to `tiny` count for nothing. */
static inline LAG_REAL lag_taylor_root(const LAG_REAL *x, int order, int columns, int n, const LAG_REAL *scale,
                                       LAG_REAL tiny) {
  LAG_REAL root = LAG_C(0.0);
  for (int k = order; k > order - 5 && k > 0; k--) {
    LAG_REAL most = LAG_C(0.0);
    for (int i = 0; i < n; i++) {
      const LAG_REAL size = LAG_FN(fabs)(x[k*columns + i])*scale[i];
      most = LAG_SELECT(size > most, size, most);
    }
    const LAG_REAL one = LAG_SELECT(most > tiny, lag_rough_power(most, LAG_C(1.0)/(LAG_LANE)k), LAG_C(0.0));
    root = LAG_SELECT(one > root, one, root);
  }
  return root;
}

/* Error of a step h > 0, largest of its components by scale: by the defect at its end, slope (per
 * unit of time) less the rates there. If the polynomial omits c t^(p+1) + ..., its defect is (p +
 * 1) c h^p; q's error is one order smaller. */
static inline LAG_REAL lag_taylor_error(int order, int nq, int nz, LAG_REAL unit, LAG_REAL h, const LAG_REAL *slope,
                                        const LAG_REAL *rates, const LAG_REAL *scale) {
  const LAG_REAL per_unit = LAG_C(1.0)/unit, to_v = h/(LAG_LANE)(order + 1), to_q = h/(LAG_LANE)(order + 2);
  LAG_REAL worst = LAG_C(0.0);
  for (int i = 0; i < nq + nz; i++) {
    const LAG_REAL error = LAG_FN(fabs)(slope[nq + i]*per_unit - rates[i])*to_v, size = error*scale[nq + i];
    worst = LAG_SELECT(size > worst, size, worst);
    if (i >= nq) continue;
    const LAG_REAL of_q = error*to_q*scale[i];
    worst = LAG_SELECT(of_q > worst, of_q, worst);
  }
  return worst;
}

/* Whether steps of lanes `of` are taken: their errors are within the tolerance, or rounding, of the size *noise: that
 * is seen where the defect did not shrink with the step. last: error of the try before, negative if there was none. */
static inline LAG_MASK lag_taylor_takes(LAG_MASK of, LAG_REAL error, LAG_REAL last, LAG_REAL *noise) {
  const LAG_REAL zero = LAG_C(0.0), two = LAG_C(2.0);
  const LAG_MASK same = LAG_AND(of, LAG_AND(last >= zero, error > last/two));
  const LAG_REAL level = LAG_SELECT(same, error, *noise);
  const LAG_MASK taken = LAG_AND(of, LAG_OR(error <= LAG_C(1.0), error <= two*level));
  *noise = LAG_SELECT(taken, level*LAG_C(0.9), level);
  return taken;
}

/* Factor from a rejected step to its next try, at least 1/2. error: in tolerances; a negative one
 * halves the step. */
static inline LAG_REAL lag_taylor_shrinkage(int order, LAG_REAL error) {
  const LAG_REAL half = LAG_C(0.5), less = LAG_FN(pow)(error*LAG_C(4.0), LAG_C(-1.0)/(LAG_LANE)(order + 1));
  return LAG_SELECT(LAG_AND(error >= LAG_C(0.0), less > half), less, half);
}

/* ---- end ---- */
#endif
