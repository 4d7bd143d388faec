/* scalar.h: the scalar of all kernels, selections and logic over it, and what failures do within a
 * step: of one state, or of the lanes of vectors, by lag_math.h with LAG_LANES. Includes <math.h>
 * only. */
#ifndef LAG_SCALAR_H
#define LAG_SCALAR_H

#include <math.h>

#ifndef LAG_REAL
#define LAG_REAL double
#define LAG_REAL_IS_DOUBLE 1
#endif
#ifndef LAG_FN
#define LAG_FN(f) f
#endif
#ifndef LAG_C
#define LAG_C(x) x
#endif

/* ---- logic of kernels: in headers that of lag_lanes.h ---- */
#ifndef LAG_SELECT
#define LAG_SELECT(c, a, b) ((c) ? (LAG_REAL)(a) : (LAG_REAL)(b))
#define LAG_NOT(c) (!(c))
#define LAG_AND(a, b) ((a) && (b))
#define LAG_OR(a, b) ((a) || (b))
#define LAG_ANY(c) (c)
#define LAG_MASK int
#define LAG_PIVOTS (void)0
#define LAG_PIVOT(c) do { if (!(c)) return LAG_ESINGULAR; } while (0)
#define LAG_PIVOTS_STATUS LAG_OK
#endif
#ifndef LAG_LANE
#define LAG_LANE LAG_REAL
#endif
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
