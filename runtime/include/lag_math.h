/* lag_math.h: sincos, sin, cos, exp, log and the reciprocal square root, inline, of a double or of each lane of a
 * vector of 4 or 8 doubles; lag_sincos2 and lag_sincos4 take two or four angles at once, and give the same bits as
 * lag_sincos. Includes lag_lanes.h and its own section lag_sincos.h; for C99 and C++ with GCC, Clang or any compiler
 * that has IEEE doubles.
 *
 * Eight lanes need AVX-512 to be fast, four AVX2 with FMA. Largest errors seen at a million points, in units in the
 * last place (tests/math measures them against libquadmath, and fails where one is more than 1):
 *
 *   sin, cos   0.86    all finite x; Payne and Hanek's reduction where x is large
 *   exp        0.77
 *   log        0.83
 *   rsqrt      0.51
 *
 * All lanes, of 4 or of 8, get the same bits. Fused multiply-add is used by name where the processor has it: results
 * then differ in the last place from those of a processor without, but not from one compiler to another; LAG_NO_FMA
 * does without it everywhere. A compiler may contract further products and sums (-ffp-contract=fast): the bounds
 * hold. */
#ifndef LAG_MATH_H
#define LAG_MATH_H

#include "lag_lanes.h"

/* ---- a file of its own ---- */
/* With LAG_LINKED_SINES a program has liblag's, which compile to the same bits: without FMA, and not in lanes. */
#if defined(LAG_LINKED_SINES) && LAG_OWN && !LAG_FMA && !defined(LAG_LANES) && !defined(LAG_AS_LANES)
void lag_sincos(double x, double *s, double *c);
double lag_sin(double x);
double lag_cos(double x);
void lag_sincos2(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b);
#define lag_sincos4(a, sin_a, cos_a, b, sin_b, cos_b, c, sin_c, cos_c, d, sin_d, cos_d) \
  (lag_sincos2(a, sin_a, cos_a, b, sin_b, cos_b), lag_sincos2(c, sin_c, cos_c, d, sin_d, cos_d))
#define lag_lanes_sin lag_sin
#define lag_lanes_cos lag_cos
#else
#include "lag_sincos.h"
#endif

/* ---- exp: front ---- */
#if LAG_OWN
LAG_INLINE LAG_REAL lag_exp(LAG_REAL x);
#define lag_lanes_exp lag_exp
#else
#define lag_exp(x) LAG_FN(exp)(x)
#endif

/* ---- exp ---- */
#if LAG_OWN
/* exp x = 2^k e^y, x = k log 2 + y - tail: Cody and Waite's reduction with log 2 in two parts, and a minimax
 * polynomial (tests/math/remez.py). 2^k is multiplied in two halves, so that results below the normal range are
 * rounded once. */
LAG_INLINE LAG_REAL lag_exp(LAG_REAL x) {
#ifdef LAG_LANES
  const LAG_REAL within = lag_lanes_select(x > 710, LAG_K(710.0), lag_lanes_select(x < -746, LAG_K(-746.0), x));
#else
  const LAG_REAL within = x > 710 ? 710 : x < -746 ? -746 : x; /* beyond, infinity and 0 in any case */
#endif
  const LAG_REAL round = LAG_K(6755399441055744.0);
  const LAG_REAL sum = lag_mad(within, LAG_K(1.4426950408889634), round), k = sum - round;
  const LAG_REAL first = lag_mad(k, LAG_K(-0.69314718055989033), within), second = k*LAG_K(5.4979230187083712e-14);
  const LAG_REAL y = first - second, tail = (first - y) - second;
  LAG_REAL p = lag_mad(y, LAG_K(2.0979087550486148e-09), LAG_K(2.5113988969522447e-08));
  p = lag_mad(y, p, LAG_K(2.7557066896256338e-07));
  p = lag_mad(y, p, LAG_K(2.7557228652142197e-06));
  p = lag_mad(y, p, LAG_K(2.4801587559641676e-05));
  p = lag_mad(y, p, LAG_K(0.00019841269903376812));
  p = lag_mad(y, p, LAG_K(0.001388888888877783));
  p = lag_mad(y, p, LAG_K(0.0083333333333138922));
  p = lag_mad(y, p, LAG_K(0.041666666666666824));
  p = lag_mad(y, p, LAG_K(0.16666666666666688));
  p = lag_mad(y, p, LAG_K(0.5));
  const LAG_REAL h = LAG_K(1.0) + y, l = y - (h - LAG_K(1.0));
  const lag_word n = (lag_to_word(sum) + 2048) & 4095, half = n >> 1; /* k + 2048 */
  return (h + (l + lag_mad(y*y, p, tail)))*lag_to_real((half - 1) << 52)*lag_to_real((n - half - 1) << 52);
}
#endif

/* ---- log: front ---- */
#if LAG_OWN
LAG_INLINE LAG_REAL lag_log(LAG_REAL x);
#define lag_lanes_log lag_log
#else
#define lag_log(x) LAG_FN(log)(x)
#endif

/* ---- log ---- */
#if LAG_OWN
/* log x = k log 2 + log m, x = 2^k m, m between sqrt(1/2) and sqrt(2); log m = 2 artanh s with s = (m - 1)/(m + 1).
 * m - 1 - (m - 1)^2/2 is split off, as in P. Tang's and the FDLIBM's logarithms, so that the polynomial
 * (tests/math/remez.py) adds little. */
LAG_INLINE LAG_REAL lag_log(LAG_REAL x) {
  LAG_REAL from = x, less = LAG_K(4503599627370496.0 + 1023);
#ifdef LAG_LANES
  const LAG_MASK tiny = x < 2.2250738585072014e-308;
  if (LAG_ANY(tiny)) {
    from = lag_lanes_select(tiny, x*18014398509481984.0, x);
    less = lag_lanes_select(tiny, less + 54, less);
  }
#else
  if (x < 2.2250738585072014e-308) {
    from = x*18014398509481984.0; /* 2^54 */
    less += 54;
  }
#endif
  const lag_word w = lag_to_word(from) + (LAG_BITS(0x3ff00000, 0) - LAG_BITS(0x3fe6a09e, 0x667f3bcd));
  const LAG_REAL k = lag_to_real((w >> 52) + LAG_BITS(0x43300000, 0)) - less;
  const LAG_REAL f =
      lag_to_real((w & LAG_BITS(0x000fffff, 0xffffffff)) + LAG_BITS(0x3fe6a09e, 0x667f3bcd)) - LAG_K(1.0);
  const LAG_REAL s = f/(LAG_K(2.0) + f), z = s*s, h = LAG_K(0.5)*f*f;
  LAG_REAL p = lag_mad(z, LAG_K(0.14795355825919806), LAG_K(0.15314111561652657));
  p = lag_mad(z, p, LAG_K(0.18183561866538225));
  p = lag_mad(z, p, LAG_K(0.22222198622240125));
  p = lag_mad(z, p, LAG_K(0.28571428741888222));
  p = lag_mad(z, p, LAG_K(0.39999999999417057));
  p = lag_mad(z, p, LAG_K(0.6666666666666734));
  const LAG_REAL low = lag_mad(s, lag_mad(z, p, h), k*LAG_K(5.4979230187083712e-14));
  LAG_REAL y = k*LAG_K(0.69314718055989033) - ((h - low) - f);
#ifdef LAG_LANES
  if (LAG_ANY(~((x > 0) & (x <= 1.7976931348623157e308)))) {
    y = lag_lanes_select(x > 1.7976931348623157e308, x, y);
    y = lag_lanes_select(x == 0, LAG_K(-(double)INFINITY), y);
    y = lag_lanes_select(x >= 0, y, LAG_K((double)NAN));
  }
#else
  if (!(x > 0 && x <= 1.7976931348623157e308)) y = x == 0 ? -(double)INFINITY : x > 0 ? x : (double)NAN;
#endif
  return y;
}
#endif

/* ---- rsqrt ---- */
#if LAG_OWN
/* The rounding error a*b - p of the product p = a*b, exactly (T. Dekker, Numer. Math. 18 (1971) 224, where there is
 * no fused multiply-add). */
LAG_INLINE LAG_REAL lag_lost(LAG_REAL a, LAG_REAL b, LAG_REAL p) {
#if LAG_FMA
  return lag_mad(a, b, -p);
#else
  const LAG_REAL u = a*LAG_K(134217729.0), v = b*LAG_K(134217729.0); /* 2^27 + 1 */
  const LAG_REAL a1 = u - (u - a), a2 = a - a1, b1 = v - (v - b), b2 = b - b1;
  return ((a1*b1 - p) + a1*b2 + a2*b1) + a2*b2;
#endif
}

/* 1/sqrt(x): a quotient, and one step of Newton's method with an exact residual. lagc does not use it: the
 * processor's 1/sqrt(x) is as fast, and 1.5 units off at most. */
LAG_INLINE LAG_REAL lag_rsqrt(LAG_REAL x) {
#ifdef LAG_LANES
  const LAG_MASK tiny = x < 1e-200, huge = x > 1e200;
  const LAG_REAL unit = lag_lanes_select(tiny, LAG_K(1.157920892373162e+77),
                                         lag_lanes_select(huge, LAG_K(8.6361685550944446e-78), LAG_K(1.0)));
  const LAG_REAL v = x*unit*unit, y = LAG_K(1.0)/lag_lanes_sqrt(v); /* 2^256, 2^-256 */
#else
  const double unit = x < 1e-200 ? 1.157920892373162e+77 : x > 1e200 ? 8.6361685550944446e-78 : 1; /* 2^256, 2^-256 */
  const double v = x*unit*unit, y = 1/sqrt(v);
#endif
  const LAG_REAL a = v*y, b = a*y; /* 1 - v y^2 = (1 - b) - (a y - b) - y (v y - a) */
  const LAG_REAL step = LAG_K(0.5)*y*(((LAG_K(1.0) - b) - lag_lost(a, y, b)) - y*lag_lost(v, y, a));
#ifdef LAG_LANES
  return unit*(y + lag_lanes_select((v > 0) & (v <= 1.7976931348623157e308), step, LAG_K(0.0)));
#else
  return unit*(v > 0 && v <= 1.7976931348623157e308 ? y + step : y);
#endif
}
#else
#define lag_rsqrt(x) (LAG_C(1.0)/LAG_FN(sqrt)(x))
#endif

/* ---- power ---- */
#if LAG_OWN
/* x^p for a normal x > 0, with relative error 2e-4 for |p| <= 1/8 and 6e-4 for |p| <= 1, enough for a step size; pow
 * would take a tenth of a short step's time. log2(x) and 2^y are the exponent and a cubic in the fraction, fitted at
 * Chebyshev points: errors 7e-4 binary orders and 8e-5. */
LAG_INLINE LAG_REAL lag_rough_power(LAG_REAL x, LAG_REAL p) {
  /* 1.5 2^52: adding and subtracting this number rounds to an integer, which is then in the last bits */
  const LAG_REAL whole = LAG_K(6755399441055744.0);
  const lag_word bits = lag_to_word(x);
  /* of sqrt(1/2) <= 1 + u < sqrt(2) */
  const lag_word e = ((bits - LAG_BITS(0x3fe6a09e, 0x667f3bcd) + LAG_BITS(0x80000000, 0)) >> 52) - 2048;
  const LAG_REAL u = lag_to_real(bits - (e << 52)) - LAG_K(1.0), binary = lag_to_real(lag_to_word(whole) + e) - whole;
  const LAG_REAL y = p*(binary + ((LAG_K(0.0005394920249608554) + LAG_K(1.4462983444747144)*u)
                                  + u*u*(LAG_K(-0.7595145055376984) + LAG_K(0.43966727293612035)*u)));
  const LAG_REAL k = (y + whole) - whole, f = y - k, two = lag_to_real(lag_to_word(k + (whole + LAG_K(1023.0))) << 52);
  return two * ((LAG_K(0.9999244814556045) + LAG_K(0.6931210339915355) * f) +
                f * f * (LAG_K(0.24264008283279262) + LAG_K(0.05592203564734233) * f));
}
#else
#define lag_rough_power(x, p) LAG_FN(pow)(x, p)
#endif

/* ---- end ---- */
#endif
