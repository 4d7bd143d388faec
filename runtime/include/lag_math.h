/* lag_math.h: sincos, sin, cos, exp, log and the reciprocal square root, inline, of a double or of each lane of a vector of 4 or 8 doubles;
 * lag_sincos2 and lag_sincos4 take two or four angles at once, and give the same bits as lag_sincos. Includes only <math.h> and its own section
 * lag_sincos.h; for C99 and C++ with GCC, Clang or any compiler that has IEEE doubles.
 *
 * LAG_REAL is double, or, with LAG_LANES defined as 4 or 8, the type of a vector with so many lanes (GCC and Clang; arrays of it are aligned to
 * its size: aligned_alloc; -Wno-psabi silences GCC on how it passes them). Eight lanes need AVX-512 to be fast, four AVX2 with FMA. Largest
 * errors seen at a million points, in units in the last place (tests/math measures them against libquadmath, and fails where one is more than
 * 1):
 *
 *   sin, cos   0.86    all finite x; Payne and Hanek's reduction where x is large
 *   exp        0.77
 *   log        0.83
 *   rsqrt      0.51
 *
 * All lanes, of 4 or of 8, get the same bits. Fused multiply-add is used by name where the processor has it: results then differ in the last
 * place from those of a processor without, but not from one compiler to another; LAG_NO_FMA does without it everywhere. A compiler may contract
 * further products and sums (-ffp-contract=fast): the bounds hold.
 *
 * lagc copies the sections below, from a line `---- NAME ----` to the next, into what it emits, with LAG_ and lag_ replaced by the prefix of an
 * emitted header. */
#ifndef LAG_MATH_H
#define LAG_MATH_H

#include <math.h>

#ifndef LAG_REAL
#ifdef LAG_LANES
typedef double lag_lanes __attribute__((vector_size(8 * LAG_LANES)));
#define LAG_REAL lag_lanes
#else
#define LAG_REAL double
#endif
#endif

/* ---- lanes ---- */
#ifdef LAG_LANES
/* Selection, logic and functions of vectors of doubles. */
#if !defined(__GNUC__) || (LAG_LANES != 4 && LAG_LANES != 8)
#error "LAG_LANES must be 4 or 8, and the compiler GCC or Clang"
#endif
#define LAG_INLINE static __inline__ __attribute__((always_inline, unused))
typedef long long lag_lanes_mask __attribute__((vector_size(8 * LAG_LANES)));
typedef unsigned long long lag_lanes_word __attribute__((vector_size(8 * LAG_LANES)));

LAG_INLINE LAG_REAL lag_lanes_all(double x) {
  const LAG_REAL zero = {0};
  return x - zero;
}

LAG_INLINE LAG_REAL lag_lanes_select(lag_lanes_mask c, LAG_REAL a, LAG_REAL b) {
  return (LAG_REAL)((c & (lag_lanes_mask)a) | (~c & (lag_lanes_mask)b));
}

/* Bit k: whether the condition holds in lane k. */
LAG_INLINE int lag_lanes_bits(lag_lanes_mask c) {
#if defined(__AVX512DQ__) && LAG_LANES == 8 && !defined(__clang__)
  return (unsigned char)__builtin_ia32_cvtq2mask512(c);
#elif defined(__AVX__) && LAG_LANES == 4
  return __builtin_ia32_movmskpd256((LAG_REAL)c);
#else
  int bits = 0;
  for (int k = 0; k < LAG_LANES; k++) bits |= (int)(c[k] & 1) << k;
  return bits;
#endif
}

LAG_INLINE int lag_lanes_any(lag_lanes_mask c) {
#if defined(__AVX512DQ__) && LAG_LANES == 8 && !defined(__clang__)
  return __builtin_ia32_cvtq2mask512(c) != 0;
#else
  typedef long long half __attribute__((vector_size(4 * LAG_LANES)));
  union { lag_lanes_mask all; half part[2]; } u = {c};
  const half h = u.part[0] | u.part[1];
  long long some = h[0] | h[1];
  for (int k = 2; k < LAG_LANES/2; k++) some |= h[k];
  return some != 0;
#endif
}

/* Whether any lane is 2^bit or more. */
LAG_INLINE int lag_lanes_reach(lag_lanes_word w, int bit) {
#if defined(__AVX512F__) && LAG_LANES == 8 && !defined(__clang__)
  const lag_lanes_mask no = {0}, all = no + (long long)(~0ULL << bit);
  return __builtin_ia32_ptestmq512((lag_lanes_mask)w, all, (unsigned char)-1) != 0;
#elif defined(__AVX__) && LAG_LANES == 4
  const lag_lanes_mask no = {0}, all = no + (long long)(~0ULL << bit);
  return !__builtin_ia32_ptestz256((lag_lanes_mask)w, all);
#else
  return lag_lanes_any((lag_lanes_mask)(w >> bit));
#endif
}

LAG_INLINE LAG_REAL lag_lanes_fabs(LAG_REAL x) {
  return (LAG_REAL)((lag_lanes_word)x & ~0ULL >> 1);
}

LAG_INLINE LAG_REAL lag_lanes_sqrt(LAG_REAL x) {
#if defined(__AVX512F__) && LAG_LANES == 8 && !defined(__clang__)
  return __builtin_ia32_sqrtpd512_mask(x, x, (char)-1, 4);
#elif defined(__AVX512F__) && LAG_LANES == 8
  return __builtin_ia32_sqrtpd512(x, 4);
#elif defined(__AVX__) && LAG_LANES == 4
  return __builtin_ia32_sqrtpd256(x);
#else
  for (int k = 0; k < LAG_LANES; k++) x[k] = sqrt(x[k]);
  return x;
#endif
}

/* Functions without a vector form: one lane after the other. */
#define LAG_LANES_1(f) \
  LAG_INLINE LAG_REAL lag_lanes_##f(LAG_REAL x) { \
    for (int k = 0; k < LAG_LANES; k++) x[k] = f(x[k]); \
    return x; \
  }
#define LAG_LANES_2(f) \
  LAG_INLINE LAG_REAL lag_lanes_##f(LAG_REAL x, LAG_REAL y) { \
    for (int k = 0; k < LAG_LANES; k++) x[k] = f(x[k], y[k]); \
    return x; \
  }
LAG_LANES_1(tan) LAG_LANES_1(asin) LAG_LANES_1(acos) LAG_LANES_1(atan) LAG_LANES_1(sinh) LAG_LANES_1(cosh)
LAG_LANES_1(tanh) LAG_LANES_1(cbrt)
LAG_LANES_2(pow) LAG_LANES_2(atan2) LAG_LANES_2(hypot)

#define LAG_MASK lag_lanes_mask
#define LAG_LANE double
#define LAG_FN(f) lag_lanes_##f
#define LAG_C(x) lag_lanes_all(x)
#define LAG_SELECT(c, a, b) lag_lanes_select(c, a, b)
#define LAG_NOT(c) (~(c))
#define LAG_AND(a, b) ((a) & (b))
#define LAG_OR(a, b) ((a) | (b))
#define LAG_ANY(c) lag_lanes_any(c)
/* Checks of pivots. A lane with a singular matrix does not stop the others: its results are not finite, and its bit is set in the negative of
 * the status; so for a lane whose matrix is not finite. */
#if defined(__AVX512DQ__) && LAG_LANES == 8 && !defined(__clang__)
#define LAG_PIVOTS int singular __attribute__((unused)) = 0
#define LAG_PIVOT(c) singular |= lag_lanes_bits(~(c))
#define LAG_POSITIVE(d) singular |= (unsigned char)__builtin_ia32_cmppd512_mask(d, LAG_C(0.0), 26 /* not greater, or unordered */, (unsigned char)-1, 4)
#define LAG_PIVOTS_STATUS -singular
#else
#define LAG_PIVOTS LAG_MASK singular __attribute__((unused)) = {0}
#define LAG_PIVOT(c) singular |= ~(c)
#define LAG_POSITIVE(d) LAG_PIVOT((d) > LAG_C(0.0))
#define LAG_PIVOTS_STATUS -lag_lanes_bits(singular)
#endif
#endif

/* ---- own ---- */
/* LAG_OWN: 1 where the functions below are used; for scalars other than double, and with LAG_LIBM or LAG_COMPLEX defined, those of the library
 * are. */
#define LAG_JOIN2(a, b) a##b
#define LAG_JOIN(a, b) LAG_JOIN2(a, b)
#define LAG_IS_float 0
#define LAG_IS_double 1
#define LAG_IS_long 0 && /* double */
#if defined(LAG_LIBM) || defined(LAG_COMPLEX)
#define LAG_OWN 0
#elif defined(LAG_LANES) || LAG_JOIN(LAG_IS_, LAG_REAL)
#define LAG_OWN 1
#else
#define LAG_OWN 0
#endif

#if LAG_OWN
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wlong-long" /* C++98 has none */
#endif
typedef long long lag_signed;
typedef unsigned long long lag_bits;
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#define LAG_BITS(high, low) ((lag_bits)(high) << 32 | (low))
#ifdef LAG_LANES
typedef lag_lanes_word lag_word;
LAG_INLINE lag_word lag_to_word(LAG_REAL x) { return (lag_word)x; }
LAG_INLINE LAG_REAL lag_to_real(lag_word w) { return (LAG_REAL)w; }
#define LAG_K(x) lag_lanes_all(x)
#else
#if defined(__GNUC__)
#define LAG_INLINE static __inline__ __attribute__((always_inline, unused))
#else
#define LAG_INLINE static inline
#endif
typedef lag_bits lag_word;
LAG_INLINE lag_word lag_to_word(double x) {
  union { double x; lag_word w; } u;
  u.x = x;
  return u.w;
}
LAG_INLINE double lag_to_real(lag_word w) {
  union { lag_word w; double x; } u;
  u.w = w;
  return u.x;
}
#define LAG_K(x) (x)
#endif

#if (defined(__FMA__) || defined(FP_FAST_FMA) || defined(__ARM_FEATURE_FMA)) && !defined(LAG_NO_FMA)
#define LAG_FMA 1
#else
#define LAG_FMA 0
#endif
/* a*b + c, fused where the processor has an instruction for it. */
LAG_INLINE LAG_REAL lag_mad(LAG_REAL a, LAG_REAL b, LAG_REAL c) {
#if !LAG_FMA
  return a*b + c;
#elif !defined(LAG_LANES)
  return fma(a, b, c);
#elif LAG_LANES == 8 && defined(__AVX512F__)
  return __builtin_ia32_vfmaddpd512_mask(a, b, c, (unsigned char)-1, 4);
#elif LAG_LANES == 4 && defined(__FMA__)
  return __builtin_ia32_vfmaddpd256(a, b, c);
#elif defined(__FMA__)
  typedef double half __attribute__((vector_size(32)));
  union { LAG_REAL all; half part[2]; } x = {a}, y = {b}, z = {c};
  for (int k = 0; k < 2; k++) z.part[k] = __builtin_ia32_vfmaddpd256(x.part[k], y.part[k], z.part[k]);
  return z.all;
#else
  for (int k = 0; k < LAG_LANES; k++) a[k] = fma(a[k], b[k], c[k]);
  return a;
#endif
}
#endif

/* ---- libm ---- */
#if defined(LAG_LANES) && !LAG_OWN
LAG_LANES_1(sin) LAG_LANES_1(cos) LAG_LANES_1(exp) LAG_LANES_1(log)
#endif

/* ---- a file of its own ---- */
#include "lag_sincos.h"

/* ---- exp ---- */
#if LAG_OWN
/* exp x = 2^k e^y, x = k log 2 + y - tail: Cody and Waite's reduction with log 2 in two parts, and a minimax polynomial (tests/math/remez.py).
 * 2^k is multiplied in two halves, so that results below the normal range are rounded once. */
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
#define lag_lanes_exp lag_exp
#else
#define lag_exp(x) LAG_FN(exp)(x)
#endif

/* ---- log ---- */
#if LAG_OWN
/* log x = k log 2 + log m, x = 2^k m, m between sqrt(1/2) and sqrt(2); log m = 2 artanh s with s = (m - 1)/(m + 1). m - 1 - (m - 1)^2/2 is split
 * off, as in P. Tang's and the FDLIBM's logarithms, so that the polynomial (tests/math/remez.py) adds little. */
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
  const LAG_REAL f = lag_to_real((w & LAG_BITS(0x000fffff, 0xffffffff)) + LAG_BITS(0x3fe6a09e, 0x667f3bcd)) - LAG_K(1.0);
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
#define lag_lanes_log lag_log
#else
#define lag_log(x) LAG_FN(log)(x)
#endif

/* ---- rsqrt ---- */
#if LAG_OWN
/* The rounding error a*b - p of the product p = a*b, exactly (T. Dekker, Numer. Math. 18 (1971) 224, where there is no fused multiply-add). */
LAG_INLINE LAG_REAL lag_lost(LAG_REAL a, LAG_REAL b, LAG_REAL p) {
#if LAG_FMA
  return lag_mad(a, b, -p);
#else
  const LAG_REAL u = a*LAG_K(134217729.0), v = b*LAG_K(134217729.0); /* 2^27 + 1 */
  const LAG_REAL a1 = u - (u - a), a2 = a - a1, b1 = v - (v - b), b2 = b - b1;
  return ((a1*b1 - p) + a1*b2 + a2*b1) + a2*b2;
#endif
}

/* 1/sqrt(x): a quotient, and one step of Newton's method with an exact residual. lagc does not use it: the processor's 1/sqrt(x) is as fast, and
 * 1.5 units off at most. */
LAG_INLINE LAG_REAL lag_rsqrt(LAG_REAL x) {
#ifdef LAG_LANES
  const LAG_MASK tiny = x < 1e-200, huge = x > 1e200;
  const LAG_REAL unit = lag_lanes_select(tiny, LAG_K(1.157920892373162e+77), lag_lanes_select(huge, LAG_K(8.6361685550944446e-78), LAG_K(1.0)));
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

/* ---- floor ---- */
#ifdef LAG_LANES
LAG_LANES_1(floor)
#endif

/* ---- power ---- */
#if LAG_OWN
/* x^p for a normal x > 0, with relative error 2e-4 for |p| <= 1/8 and 6e-4 for |p| <= 1, enough for a step size; pow would take a tenth of a short
 * step's time. log2(x) and 2^y are the exponent and a cubic in the fraction, fitted at Chebyshev points: errors 7e-4 binary orders and 8e-5. */
LAG_INLINE LAG_REAL lag_rough_power(LAG_REAL x, LAG_REAL p) {
  const LAG_REAL whole = LAG_K(6755399441055744.0); /* 1.5 2^52: adding and subtracting this number rounds to an integer, which is then in the last bits */
  const lag_word bits = lag_to_word(x);
  const lag_word e = ((bits - LAG_BITS(0x3fe6a09e, 0x667f3bcd) + LAG_BITS(0x80000000, 0)) >> 52) - 2048; /* of sqrt(1/2) <= 1 + u < sqrt(2) */
  const LAG_REAL u = lag_to_real(bits - (e << 52)) - LAG_K(1.0), binary = lag_to_real(lag_to_word(whole) + e) - whole;
  const LAG_REAL y = p*(binary + ((LAG_K(0.0005394920249608554) + LAG_K(1.4462983444747144)*u)
                                  + u*u*(LAG_K(-0.7595145055376984) + LAG_K(0.43966727293612035)*u)));
  const LAG_REAL k = (y + whole) - whole, f = y - k, two = lag_to_real(lag_to_word(k + (whole + LAG_K(1023.0))) << 52);
  return two*((LAG_K(0.9999244814556045) + LAG_K(0.6931210339915355)*f) + f*f*(LAG_K(0.24264008283279262) + LAG_K(0.05592203564734233)*f));
}
#else
#define lag_rough_power(x, p) LAG_FN(pow)(x, p)
#endif

/* ---- end ---- */
#ifndef LAG_FN
#define LAG_FN(f) f
#endif
#ifndef LAG_C
#define LAG_C(x) ((LAG_REAL)x)
#endif
#endif
