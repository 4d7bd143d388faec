/* Approximate log2 and exp2 in a few operations, for step sizes. */
#ifndef LAG_METHODS_ROUGH_MATH_H
#define LAG_METHODS_ROUGH_MATH_H

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#if FLT_RADIX == 2 && DBL_MANT_DIG == 53 && DBL_MAX_EXP == 1024 /* IEEE 754: exponent and fraction are bit fields */

enum { LAG_FRACTION_BITS = 52, LAG_BIAS = 1023 };

/* log2 x with error 0.01, for finite x > 0; some number below -1022 where x is subnormal. */
static inline double lag_rough_log2(double x) {
  uint64_t bits;
  double m;
  memcpy(&bits, &x, sizeof bits);
  int e = (int)(bits >> LAG_FRACTION_BITS) - LAG_BIAS;
  bits = (bits & ((UINT64_C(1) << LAG_FRACTION_BITS) - 1)) | (uint64_t)LAG_BIAS << LAG_FRACTION_BITS;
  memcpy(&m, &bits, sizeof m); /* 1 <= m < 2 */
  return e + m * (2 - m / 3) - 5.0 / 3;
}

/* The largest power of 2 that is <= |x|; 0 where x is subnormal. */
static inline double lag_floor_power_of_two(double x) {
  uint64_t bits;
  double power;
  memcpy(&bits, &x, sizeof bits);
  bits &= UINT64_C(0x7ff) << LAG_FRACTION_BITS;
  memcpy(&power, &bits, sizeof power);
  return power;
}

/* 2^x with relative error 0.3 %; x is clamped to the exponents of normal numbers. */
static inline double lag_rough_exp2(double x) {
  double inside = x < -1022 ? -1022 : x > 1023 ? 1023 : x, scale;
  int whole = (int)(inside + LAG_BIAS) - LAG_BIAS; /* floor */
  double part = inside - whole;
  uint64_t bits = (uint64_t)(whole + LAG_BIAS) << LAG_FRACTION_BITS;
  memcpy(&scale, &bits, sizeof scale);
  return scale * (1 + part * (0.6565 + 0.3435 * part));
}

#else

static inline double lag_rough_log2(double x) { return log2(x); }

static inline double lag_rough_exp2(double x) { return exp2(x); }

static inline double lag_floor_power_of_two(double x) { return ldexp(1, ilogb(x)); }

#endif

#endif
