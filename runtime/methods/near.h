/* Logarithms and powers that are near enough for the size of a step, and cost a few operations. */
#ifndef LAG_METHODS_NEAR_H
#define LAG_METHODS_NEAR_H

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#if FLT_RADIX == 2 && DBL_MANT_DIG == 53 && DBL_MAX_EXP == 1024 /* IEEE 754: exponent and fraction are read off the bits */

enum { LAG_FRACTION_BITS = 52, LAG_BIAS = 1023 };

/* log2 x to 0.01, x > 0 and finite; of a subnormal x some number below -1022. */
static inline double lag_log2_near(double x)
{
  uint64_t bits;
  double m;

  memcpy(&bits, &x, sizeof bits);
  int e = (int)(bits >> LAG_FRACTION_BITS) - LAG_BIAS;
  bits = (bits & ((UINT64_C(1) << LAG_FRACTION_BITS) - 1)) | (uint64_t)LAG_BIAS << LAG_FRACTION_BITS;
  memcpy(&m, &bits, sizeof m); /* 1 <= m < 2 */
  return e + m * (2 - m / 3) - 5.0 / 3;
}

/* The power of 2 next to |x| towards 0; of subnormal numbers 0. */
static inline double lag_binade(double x)
{
  uint64_t bits;
  double power;

  memcpy(&bits, &x, sizeof bits);
  bits &= UINT64_C(0x7ff) << LAG_FRACTION_BITS;
  memcpy(&power, &bits, sizeof power);
  return power;
}

/* 2^x to 0.3 %, within the range of normal numbers. */
static inline double lag_exp2_near(double x)
{
  double inside = x < -1022 ? -1022 : x > 1023 ? 1023 : x, scale;
  int whole = (int)(inside + LAG_BIAS) - LAG_BIAS; /* floor */
  double part = inside - whole;
  uint64_t bits = (uint64_t)(whole + LAG_BIAS) << LAG_FRACTION_BITS;

  memcpy(&scale, &bits, sizeof scale);
  return scale * (1 + part * (0.6565 + 0.3435 * part));
}

#else

static inline double lag_log2_near(double x)
{
  return log2(x);
}

static inline double lag_exp2_near(double x)
{
  return exp2(x);
}

static inline double lag_binade(double x)
{
  return ldexp(1, ilogb(x));
}

#endif

#endif
