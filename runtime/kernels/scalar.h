/* scalar.h: the scalar of all kernels, which is double unless defined, with selections and logic (lag_lanes.h), and
 * what failures do within a step: of one state, or of the lanes of vectors. */
#ifndef LAG_SCALAR_H
#define LAG_SCALAR_H

#include "lag_lanes.h"

/* ---- failures ---- */

#define LAG_OVER(n, d) (LAG_C(n)/LAG_C(d))
#ifdef LAG_LANES /* a lane that fails does not stop the others */
#define LAG_COEF(x) x /* a number that all lanes share */
#define LAG_TRY(call) status = -(-status | -(call))
#define LAG_WHERE(lanes, status) -(-(status) & lag_lanes_bits(lanes))
#define LAG_STATUS(lanes, code) -lag_lanes_bits(lanes)
#define LAG_FAILED(status) lag_failed(status)
/* Lanes that a status names. */
static inline LAG_MASK lag_failed(int status) {
  LAG_MASK lanes = {0};
  for (int i = 0; i < LAG_LANES; i++) lanes[i] = -(-status >> i & 1);
  return lanes;
}
#else
#define LAG_COEF(x) LAG_C(x)
#define LAG_TRY(call) do { status = (call); if (status != 0) return status; } while (0)
#define LAG_WHERE(lanes, status) (status)
#define LAG_STATUS(fails, code) ((fails) ? (int)(code) : 0)
#define LAG_FAILED(status) ((status) != 0)
#endif

/* ---- finite ---- */

#ifdef LAG_COMPLEX
#define LAG_IS_FINITE(x) ((x) - (x) == LAG_C(0.0))
#else
#define LAG_IS_FINITE(x) (LAG_C(1.0) > (x) - (x))
#endif
/* Whether all of x[n] is finite. */
static inline LAG_MASK lag_finite(const LAG_REAL *x, int n) {
  LAG_MASK finite = LAG_IS_FINITE(LAG_C(0.0));
  for (int i = 0; i < n; i++) finite = LAG_AND(finite, LAG_IS_FINITE(x[i]));
  return finite;
}

/* ---- end ---- */
#endif
