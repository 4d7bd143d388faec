/* lag_math.h: sincos, sin, cos, exp, log and the reciprocal square root, inline, of a double or of each lane of a vector of
 * 4 or 8 doubles; lag_sincos2 and lag_sincos4 take two or four angles at once, and give the bits that lag_sincos gives.
 * Includes only <math.h>; for C99 and C++ with GCC, Clang or any compiler that has IEEE doubles.
 *
 * LAG_REAL is double, or, with LAG_LANES defined as 4 or 8, the type of a vector with so many lanes (GCC and Clang; arrays of it
 * are aligned to its size: aligned_alloc; -Wno-psabi silences GCC on how it passes them). Eight lanes want AVX-512, four AVX2
 * with FMA. Largest errors seen at a million points, in units in the last place (tests/math measures them against
 * libquadmath, and fails where one is more than 1):
 *
 *   sin, cos   0.86    all finite x; Payne and Hanek's reduction where x is large
 *   exp        0.77
 *   log        0.83
 *   rsqrt      0.51
 *
 * All lanes, of 4 or of 8, get the same bits. Where the processor multiplies and adds in one instruction these functions use it,
 * by name: results differ there in the last place from those of a processor without, but not from one compiler to another.
 * A compiler may contract products and sums besides (-ffp-contract=fast): the bounds hold.
 *
 * lagc copies the sections below, from a line `---- NAME ----` to the next, into what it emits, with LAG_ and lag_ replaced by
 * the prefix of an emitted header. */
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
/* Vectors of doubles: what choices, logic and functions mean for them. */
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

/* Whether a lane is 2^bit or more. */
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

/* Functions without a form for lanes, one lane after the other. */
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
#define LAG_PIVOTS LAG_MASK singular = {0} /* a lane with a singular matrix stops no other: it has no numbers, */
#define LAG_PIVOT(c) singular |= ~(c)
#define LAG_PIVOTS_STATUS -lag_lanes_bits(singular) /* and its bit in the status, which is negative then */
#endif

/* ---- own ---- */
/* Whether LAG_REAL is what the functions below are for; for other scalars, and with LAG_LIBM defined, they are the C library's. */
#define LAG_JOIN2(a, b) a##b
#define LAG_JOIN(a, b) LAG_JOIN2(a, b)
#define LAG_IS_double 1
#define LAG_IS_long 0 && /* double */
#if defined(LAG_LIBM)
#define LAG_OWN 0
#elif defined(LAG_LANES) || LAG_JOIN(LAG_IS_, LAG_REAL)
#define LAG_OWN 1
#else
#define LAG_OWN 0
#endif

#if LAG_OWN
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
typedef unsigned long long lag_word;
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

#if defined(__FMA__) || defined(FP_FAST_FMA) || defined(__ARM_FEATURE_FMA)
#define LAG_FMA 1
#else
#define LAG_FMA 0
#endif
/* a*b + c, in one rounding where the processor has an instruction for it. */
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

/* ---- sincos ---- */
#if LAG_OWN
/* x modulo pi/2 as y - *lo with |y| <= pi/4, and *quarter, how many of them, modulo 4: for x of any size, and for those next
 * to a multiple of pi/2. The bits of 2/pi whose products with x are multiples of 4 are left out; of the others the next
 * 192 are enough, as no double is nearer than 2^-62 to a multiple (M. Payne, R. Hanek, Radian reduction for trigonometric
 * functions, SIGNUM Newsletter 18 (1983), doi:10.1145/1057600.1057602; J.-M. Muller, Elementary Functions, 3rd ed., 2016,
 * section 11.4). */
#if defined(__GNUC__)
__attribute__((cold, noinline, unused))
#endif
static double lag_reduce(double x, double *lo, unsigned long long *quarter) {
  static const unsigned two_over_pi[] = { /* 2/pi = 0.a2f9836e..., after 64 zeros */
    0, 0,
    0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab, 0xdebbc561, 0xb7246e3a, 0x424dd2e0,
    0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e, 0xe88235f5, 0x2ebb4484, 0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4,
    0x9c845f8b, 0xbdf9283b, 0x1ff897ff, 0xde05980f, 0xef2f118b, 0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7, 0x4f463f66, 0x9e5fea2d,
    0x7527bac7, 0xebe5f17b, 0x3d0739f7, 0x8a5292ea, 0x6bfb5fb1, 0x1f8d5d08, 0x56033046, 0xfc7b6bab, 0xf0cfbc20, 0x9af4361d};
  *lo = 0;
  *quarter = 0;
  if (!(fabs(x) <= 1.7976931348623157e308)) return x - x; /* not a number */
  if (fabs(x) < 0.78539816339744828) return x;
  int e, negative = x < 0;
  const unsigned long long n = (unsigned long long)ldexp(frexp(fabs(x), &e), 53); /* |x| = n 2^(e - 53) */
  const unsigned long long factor[2] = {n & 0xffffffff, n >> 32};
  const int at = e - 53 - 2 + 64, shift = at % 32;
  unsigned long long w[6], f[6] = {0, 0, 0, 0, 0, 0}, carry;
  for (int i = 0; i < 6; i++) {
    const unsigned long long two = (unsigned long long)two_over_pi[at/32 + i] << 32 | two_over_pi[at/32 + i + 1];
    w[i] = two >> (32 - shift) & 0xffffffff;
  }
  for (int k = 0; k < 2; k++) { /* f = n w modulo 2^192: two bits of quarters, and a fraction */
    carry = 0;
    for (int i = 5; i - k >= 0; i--) {
      carry += f[i - k] + factor[k]*w[i];
      f[i - k] = carry & 0xffffffff;
      carry >>= 32;
    }
  }
  *quarter = f[0] >> 30;
  for (int i = 0; i < 6; i++) f[i] = (f[i] << 2 | (i < 5 ? f[i + 1] >> 30 : 0)) & 0xffffffff;
  if (f[0] >> 31) { /* the next multiple is nearer */
    ++*quarter;
    negative = !negative;
    carry = 1;
    for (int i = 5; i >= 0; i--) {
      carry += f[i] ^ 0xffffffff;
      f[i] = carry & 0xffffffff;
      carry >>= 32;
    }
  }
  if (x < 0) *quarter = 4 - *quarter;
  double sum = 0, rest = 0, unit = 1;
  for (int i = 0; i < 6; i++) {
    unit *= 1/4294967296.0;
    const double part = (double)f[i]*unit, was = sum;
    sum += part;
    rest += (was - sum) + part;
  }
  const double pi_2 = 1.5707963267948966, product = sum*pi_2;
  const double low = fma(sum, pi_2, -product) + (sum*6.123233995736766e-17 + rest*pi_2);
  const double y = product + low, left = (y - product) - low;
  *lo = negative ? -left : left;
  return negative ? -y : y;
}

#ifdef LAG_LANES
/* Sine and cosine of x - k pi/2 - lo, |x - k pi/2| <= pi/4, in quarter `quarter`, that is k modulo 4. The polynomials are minimax, by
 * tests/math/remez.py. */
LAG_INLINE void lag_sincos_turned(LAG_REAL y, LAG_REAL lo, lag_word quarter, LAG_REAL *s, LAG_REAL *c) {
  const LAG_REAL z = y*y, w = lag_mad(z, LAG_K(-0.5), LAG_K(1.0)), rest = lag_mad(z, LAG_K(-0.5), LAG_K(1.0) - w);
  LAG_REAL p = lag_mad(z, LAG_K(-1.5895432975868974e-10), LAG_K(2.5050734385284707e-08));
  LAG_REAL q = lag_mad(z, LAG_K(-1.1358749174703273e-11), LAG_K(2.087570539521945e-09));
  p = lag_mad(z, p, LAG_K(-2.7557313538498488e-06));
  q = lag_mad(z, q, LAG_K(-2.7557314217035774e-07));
  p = lag_mad(z, p, LAG_K(0.00019841269829358509));
  q = lag_mad(z, q, LAG_K(2.4801587289002076e-05));
  p = lag_mad(z, p, LAG_K(-0.0083333333333218407));
  q = lag_mad(z, q, LAG_K(-0.0013888888888873342));
  p = lag_mad(z, p, LAG_K(0.1666666666666663));
  q = lag_mad(z, q, LAG_K(0.041666666666666595));
  const LAG_REAL sine = y - lag_mad(z*y, p, lo), cosine = w + (rest + lag_mad(z*z, q, y*lo));
  const lag_word a = lag_to_word(sine), b = lag_to_word(cosine), odd = quarter << 63, minus = quarter << 62 & lag_to_word(LAG_K(-0.0));
  const lag_word swap = (a ^ b) & (lag_word)((LAG_MASK)odd >> 63);
  *s = lag_to_real(a ^ swap ^ minus);
  *c = lag_to_real(b ^ swap ^ minus ^ odd);
}

/* x in quarters, made an integer by what is added: 1.5 2^52, and 2^17, so that the bits of all integers from -2^17 to 2^17 - 1 begin
 * alike. */
LAG_INLINE LAG_REAL lag_quarters(LAG_REAL x) { return lag_mad(x, LAG_K(0.63661977236758138), LAG_K(6755399441186816.0)); }
/* From 2^18 on in lanes with others. */
LAG_INLINE lag_word lag_quarters_far(LAG_REAL sum) { return lag_to_word(sum) ^ lag_to_word(LAG_K(6755399441055744.0)); }

/* y - *lo = x - k pi/2 for |k| <= 2^17. W. Cody, W. Waite, Software Manual for the Elementary Functions, 1980, with pi/2 in three parts:
 * the products of k with the first two are exact. What is lost is known, to 2^-129 |x|, and enters to first order; no double in this
 * range is so near to a multiple of pi/2 that it would matter. */
LAG_INLINE LAG_REAL lag_sincos_reduce(LAG_REAL x, LAG_REAL sum, LAG_REAL *lo) {
  const LAG_REAL k = sum - LAG_K(6755399441186816.0);
  const LAG_REAL first = lag_mad(k, LAG_K(-1.5707963267923333), x);
  const LAG_REAL y = lag_mad(k, LAG_K(-2.5633441515839558e-12), first);
  *lo = lag_mad(k, LAG_K(1.0562999066987428e-23), lag_mad(k, LAG_K(2.5633441515839558e-12), y - first));
  return y;
}

/* The same for any x. Apart, and by address, so that what is near keeps the registers. */
__attribute__((cold, noinline, unused)) static void lag_sincos_far(const LAG_REAL *x, LAG_REAL *s, LAG_REAL *c) {
  const LAG_REAL sum = lag_quarters(*x);
  LAG_REAL lo, y = lag_sincos_reduce(*x, sum, &lo);
  lag_word quarter = lag_to_word(sum);
  const lag_word far = lag_quarters_far(sum) >> 18;
  for (int lane = 0; lane < LAG_LANES; lane++) {
    double low = lo[lane];
    unsigned long long quarters = quarter[lane];
    if (far[lane]) y[lane] = lag_reduce((*x)[lane], &low, &quarters);
    lo[lane] = low;
    quarter[lane] = quarters;
  }
  lag_sincos_turned(y, lo, quarter, s, c);
}

LAG_INLINE void lag_sincos_near(LAG_REAL x, LAG_REAL sum, LAG_REAL *s, LAG_REAL *c) {
  LAG_REAL lo;
  const LAG_REAL y = lag_sincos_reduce(x, sum, &lo);
  lag_sincos_turned(y, lo, lag_to_word(sum), s, c);
}

LAG_INLINE void lag_sincos(LAG_REAL x, LAG_REAL *s, LAG_REAL *c) {
  const LAG_REAL sum = lag_quarters(x);
  if (__builtin_expect(lag_lanes_reach(lag_quarters_far(sum), 18), 0)) {
    LAG_REAL at = x, sine, cosine;
    lag_sincos_far(&at, &sine, &cosine);
    *s = sine;
    *c = cosine;
    return;
  }
  lag_sincos_near(x, sum, s, c);
}

/* Two angles: one question whether they are near. */
#define LAG_SINCOS_2 1
LAG_INLINE void lag_sincos2(LAG_REAL a, LAG_REAL *sin_a, LAG_REAL *cos_a, LAG_REAL b, LAG_REAL *sin_b, LAG_REAL *cos_b) {
  const LAG_REAL sum_a = lag_quarters(a), sum_b = lag_quarters(b);
  if (__builtin_expect(lag_lanes_reach(lag_quarters_far(sum_a) | lag_quarters_far(sum_b), 18), 0)) {
    LAG_REAL at_a = a, at_b = b, s, c, sine, cosine;
    lag_sincos_far(&at_a, &s, &c);
    lag_sincos_far(&at_b, &sine, &cosine);
    *sin_a = s, *cos_a = c, *sin_b = sine, *cos_b = cosine;
    return;
  }
  lag_sincos_near(a, sum_a, sin_a, cos_a);
  lag_sincos_near(b, sum_b, sin_b, cos_b);
}
#else
typedef struct lag_pair {
  double s, c;
} lag_pair;

/* The sine of k pi/32 and what rounding added to it, and so on; those of the cosine are 32 numbers further. The 0 is
 * negative for the sake of -0. */
LAG_INLINE const double *lag_sines(lag_word k) {
  static const double sines[160] = {
    -0.0, 0, 0.098017140329560604, 1.634582362244256e-18, 0.19509032201612828, 7.9910790684617313e-18,
    0.29028467725446239, 1.8927978707774251e-17, 0.38268343236508978, 1.0050772696461588e-17, 0.47139673682599764, -6.516678136069013e-18,
    0.55557023301960218, -4.7094109405616768e-17, 0.63439328416364549, -1.0420901929280035e-17, 0.70710678118654757, 4.8336466567264567e-17,
    0.77301045336273699, 3.2565907033649772e-17, 0.83146961230254524, -1.4073856984728024e-18, 0.88192126434835505, 1.9843248405890562e-17,
    0.92387953251128674, -1.7645047084336677e-17, 0.95694033573220882, -4.0553869861875701e-17, 0.98078528040323043, -1.8546939997825006e-17,
    0.99518472667219693, 4.248691367830441e-17, 1, 0, 0.99518472667219693, 4.248691367830441e-17,
    0.98078528040323043, -1.8546939997825006e-17, 0.95694033573220882, -4.0553869861875701e-17, 0.92387953251128674, -1.7645047084336677e-17,
    0.88192126434835505, 1.9843248405890562e-17, 0.83146961230254524, -1.4073856984728024e-18, 0.77301045336273699, 3.2565907033649772e-17,
    0.70710678118654757, 4.8336466567264567e-17, 0.63439328416364549, -1.0420901929280035e-17, 0.55557023301960218, -4.7094109405616768e-17,
    0.47139673682599764, -6.516678136069013e-18, 0.38268343236508978, 1.0050772696461588e-17, 0.29028467725446239, 1.8927978707774251e-17,
    0.19509032201612828, 7.9910790684617313e-18, 0.098017140329560604, 1.634582362244256e-18, 0, 0,
    -0.098017140329560604, -1.634582362244256e-18, -0.19509032201612828, -7.9910790684617313e-18, -0.29028467725446239, -1.8927978707774251e-17,
    -0.38268343236508978, -1.0050772696461588e-17, -0.47139673682599764, 6.516678136069013e-18, -0.55557023301960218, 4.7094109405616768e-17,
    -0.63439328416364549, 1.0420901929280035e-17, -0.70710678118654757, -4.8336466567264567e-17, -0.77301045336273699, -3.2565907033649772e-17,
    -0.83146961230254524, 1.4073856984728024e-18, -0.88192126434835505, -1.9843248405890562e-17, -0.92387953251128674, 1.7645047084336677e-17,
    -0.95694033573220882, 4.0553869861875701e-17, -0.98078528040323043, 1.8546939997825006e-17, -0.99518472667219693, -4.248691367830441e-17,
    -1, 0, -0.99518472667219693, -4.248691367830441e-17, -0.98078528040323043, 1.8546939997825006e-17,
    -0.95694033573220882, 4.0553869861875701e-17, -0.92387953251128674, 1.7645047084336677e-17, -0.88192126434835505, -1.9843248405890562e-17,
    -0.83146961230254524, 1.4073856984728024e-18, -0.77301045336273699, -3.2565907033649772e-17, -0.70710678118654757, -4.8336466567264567e-17,
    -0.63439328416364549, 1.0420901929280035e-17, -0.55557023301960218, 4.7094109405616768e-17, -0.47139673682599764, 6.516678136069013e-18,
    -0.38268343236508978, -1.0050772696461588e-17, -0.29028467725446239, -1.8927978707774251e-17, -0.19509032201612828, -7.9910790684617313e-18,
    -0.098017140329560604, -1.634582362244256e-18, 0, 0, 0.098017140329560604, 1.634582362244256e-18,
    0.19509032201612828, 7.9910790684617313e-18, 0.29028467725446239, 1.8927978707774251e-17, 0.38268343236508978, 1.0050772696461588e-17,
    0.47139673682599764, -6.516678136069013e-18, 0.55557023301960218, -4.7094109405616768e-17, 0.63439328416364549, -1.0420901929280035e-17,
    0.70710678118654757, 4.8336466567264567e-17, 0.77301045336273699, 3.2565907033649772e-17, 0.83146961230254524, -1.4073856984728024e-18,
    0.88192126434835505, 1.9843248405890562e-17, 0.92387953251128674, -1.7645047084336677e-17, 0.95694033573220882, -4.0553869861875701e-17,
    0.98078528040323043, -1.8546939997825006e-17, 0.99518472667219693, 4.248691367830441e-17};
  return sines + (2*k & 126);
}

#if LAG_FMA
#define LAG_SINCOS_SUM(real, mad, K) const real sine = S + mad(C, r, -t), cosine = C - mad(S, r, u)
#else
#define LAG_SINCOS_SUM(real, mad, K) /* near: 0 or 1; so much of C r is not rounded */ \
  const real near_S = (S + K(6755399441055744.0)) - K(6755399441055744.0), near_C = (C + K(6755399441055744.0)) - K(6755399441055744.0); \
  const real sine = S + (near_C*r + ((C - near_C)*r - t)), cosine = C - (near_S*r + ((S - near_S)*r + u))
#endif
/* Sine and cosine of x, of a double or of some side by side, by the same operations: of a multiple of pi/32 from the table (S, C and
 * what to add to them: S_add, C_add), and of what is left, after W. Cody and W. Waite (Software Manual for the Elementary
 * Functions, 1980) with pi/32 in three parts, from minimax polynomials (tests/math/remez.py); P. Tang, ACM Trans. Math. Softw. 15
 * (1989) 144, doi:10.1145/63522.214389, has the idea. sum: x in units of pi/32, made an integer by what LAG_SINCOS_INTEGER adds; its
 * products with the first two parts are exact; lost is 2^-130 |x|, and no double with |x| <= 2^18 pi/32 is so near to a multiple of
 * pi/2 that it would matter. */
#define LAG_SINCOS_INTEGER(x, mad, K) mad(x, K(10.185916357881302), K(6755399441055744.0)) /* 1.5 2^52 */
#define LAG_SINCOS_NEAR(real, mad, K, rest) \
  const real k = sum - K(6755399441055744.0); \
  const real first = mad(k, K(-0.09817477042452083), x), r = mad(k, K(-1.6020900947399724e-13), first); \
  const real third = mad(k, K(6.6018744168671423e-25), mad(k, K(1.6020900947399724e-13), r - first)), low = rest; \
  const real z = r*r; \
  const real p = mad(z, mad(z, K(0.00019839993603852713), K(-0.0083333333154962386)), K(0.16666666666665958)); \
  const real q = mad(z, mad(z, mad(z, K(-2.4800157698025678e-05), K(0.0013888888865417341)), K(-0.041666666666665471)), K(0.5)); \
  const real less_s = mad(r*z, p, low), less_c = z*q; /* r - sin, 1 - cos of what is left */ \
  const real t = mad(C, less_s, mad(S, less_c, S_add)), u = mad(C, less_c, mad(-S, less_s, C_add)); \
  LAG_SINCOS_SUM(real, mad, K)

/* Whether sum is not 1.5 2^52 + k with |k| <= 2^18, that is |x| < 25735: asked of its bits, which the table wants anyway, of one or of
 * several put together by `|`. */
#define LAG_SINCOS_OFF(word) ((word) - 0x4337fffffffc0000ULL)
#define LAG_SINCOS_FAR(off) (((off) & ~0x7ffffULL) != 0)

/* Of x - *lo (lo may be 0) and so many quarters. */
LAG_INLINE lag_pair lag_sincos_near(double x, double sum, const double *lo, lag_word quarters) {
  const double *at = lag_sines(lag_to_word(sum) + 16*quarters), S = at[0], C = at[32], S_add = at[1], C_add = at[33];
  LAG_SINCOS_NEAR(double, lag_mad, LAG_K, lo ? third + *lo : third);
  lag_pair y;
  y.s = sine;
  y.c = cosine;
  return y;
}

#if defined(__GNUC__)
__attribute__((cold, noinline, unused))
#endif
static lag_pair lag_sincos_far(double x) {
  double lo;
  unsigned long long quarters;
  x = lag_reduce(x, &lo, &quarters);
  return lag_sincos_near(x, LAG_SINCOS_INTEGER(x, lag_mad, LAG_K), &lo, quarters);
}

LAG_INLINE void lag_sincos(double x, double *s, double *c) {
  const double sum = LAG_SINCOS_INTEGER(x, lag_mad, LAG_K);
#if defined(__GNUC__)
  const lag_pair y = __builtin_expect(LAG_SINCOS_FAR(LAG_SINCOS_OFF(lag_to_word(sum))), 0) ? lag_sincos_far(x) : lag_sincos_near(x, sum, 0, 0);
#else
  const lag_pair y = LAG_SINCOS_FAR(LAG_SINCOS_OFF(lag_to_word(sum))) ? lag_sincos_far(x) : lag_sincos_near(x, sum, 0, 0);
#endif
  *s = y.s;
  *c = y.c;
}

/* Two angles, or four, side by side in a register: the same bits as one after the other, in little more time than one takes. */
#if defined(__GNUC__) && defined(__SSE2__) && (defined(__FMA__) || !LAG_FMA)
#define LAG_SINCOS_2 1
#if LAG_FMA && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define LAG_SINCOS_4 1
#endif
#endif

__attribute__((cold, noinline, unused)) static lag_pair lag_sincos_any(double x) {
  lag_pair y;
  lag_sincos(x, &y.s, &y.c);
  return y;
}

typedef double lag_two __attribute__((vector_size(16)));
typedef unsigned long long lag_two_words __attribute__((vector_size(16)));
LAG_INLINE lag_two lag_two_mad(lag_two a, lag_two b, lag_two c) {
#if LAG_FMA
  return __builtin_ia32_vfmaddpd(a, b, c);
#else
  return a*b + c;
#endif
}
LAG_INLINE lag_two lag_two_of(double x) {
  const lag_two v = {x, x};
  return v;
}

LAG_INLINE void lag_sincos2(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b) {
  const lag_two x = {a, b}, sum = LAG_SINCOS_INTEGER(x, lag_two_mad, lag_two_of);
  const lag_two_words word = (lag_two_words)sum;
  const lag_word i = word[0], j = word[1];
  if (__builtin_expect(LAG_SINCOS_FAR(LAG_SINCOS_OFF(i) | LAG_SINCOS_OFF(j)), 0)) {
    const lag_pair y = lag_sincos_any(a), z = lag_sincos_any(b);
    *sin_a = y.s, *cos_a = y.c, *sin_b = z.s, *cos_b = z.c;
    return;
  }
  const double *const A = lag_sines(i), *const B = lag_sines(j);
  const lag_two S = {A[0], B[0]}, S_add = {A[1], B[1]}, C = {A[32], B[32]}, C_add = {A[33], B[33]};
  LAG_SINCOS_NEAR(lag_two, lag_two_mad, lag_two_of, third);
  *sin_a = sine[0], *cos_a = cosine[0], *sin_b = sine[1], *cos_b = cosine[1];
}
#endif

#ifdef LAG_SINCOS_4
typedef double lag_four __attribute__((vector_size(32)));
typedef unsigned long long lag_four_words __attribute__((vector_size(32)));
LAG_INLINE lag_four lag_four_mad(lag_four a, lag_four b, lag_four c) { return __builtin_ia32_vfmaddpd256(a, b, c); }
LAG_INLINE lag_four lag_four_of(double x) {
  const lag_four v = {x, x, x, x};
  return v;
}
/* Two rows of the table, one in each half of a register. */
LAG_INLINE lag_four lag_sines_two(const double *low, const double *high) {
  const lag_two a = {low[0], low[1]}, b = {high[0], high[1]};
  return __builtin_shufflevector(a, b, 0, 1, 2, 3);
}

LAG_INLINE void lag_sincos4(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b,
                            double c, double *sin_c, double *cos_c, double d, double *sin_d, double *cos_d) {
  const lag_four x = {a, b, c, d}, sum = LAG_SINCOS_INTEGER(x, lag_four_mad, lag_four_of);
  const lag_four_words word = (lag_four_words)sum;
  const lag_word i = word[0], j = word[1], m = word[2], n = word[3];
  if (__builtin_expect(LAG_SINCOS_FAR(LAG_SINCOS_OFF(i) | LAG_SINCOS_OFF(j) | LAG_SINCOS_OFF(m) | LAG_SINCOS_OFF(n)), 0)) {
    const lag_pair y = lag_sincos_any(a), z = lag_sincos_any(b), v = lag_sincos_any(c), w = lag_sincos_any(d);
    *sin_a = y.s, *cos_a = y.c, *sin_b = z.s, *cos_b = z.c, *sin_c = v.s, *cos_c = v.c, *sin_d = w.s, *cos_d = w.c;
    return;
  }
  const double *const A = lag_sines(i), *const B = lag_sines(j), *const G = lag_sines(m), *const D = lag_sines(n);
  const lag_four sin_ac = lag_sines_two(A, G), sin_bd = lag_sines_two(B, D);
  const lag_four cos_ac = lag_sines_two(A + 32, G + 32), cos_bd = lag_sines_two(B + 32, D + 32);
  const lag_four S = __builtin_shufflevector(sin_ac, sin_bd, 0, 4, 2, 6), S_add = __builtin_shufflevector(sin_ac, sin_bd, 1, 5, 3, 7);
  const lag_four C = __builtin_shufflevector(cos_ac, cos_bd, 0, 4, 2, 6), C_add = __builtin_shufflevector(cos_ac, cos_bd, 1, 5, 3, 7);
  LAG_SINCOS_NEAR(lag_four, lag_four_mad, lag_four_of, third);
  *sin_a = sine[0], *cos_a = cosine[0], *sin_b = sine[1], *cos_b = cosine[1];
  *sin_c = sine[2], *cos_c = cosine[2], *sin_d = sine[3], *cos_d = cosine[3];
}
#endif
#endif

LAG_INLINE LAG_REAL lag_sin(LAG_REAL x) {
  LAG_REAL s, c;
  lag_sincos(x, &s, &c);
  return s;
}

LAG_INLINE LAG_REAL lag_cos(LAG_REAL x) {
  LAG_REAL s, c;
  lag_sincos(x, &s, &c);
  return c;
}
#define lag_lanes_sin lag_sin
#define lag_lanes_cos lag_cos
#else
#define lag_sincos(x, s, c) (void)(*(s) = LAG_FN(sin)(x), *(c) = LAG_FN(cos)(x))
#define lag_sin(x) LAG_FN(sin)(x)
#define lag_cos(x) LAG_FN(cos)(x)
#endif
#ifndef LAG_SINCOS_2
#define lag_sincos2(a, sin_a, cos_a, b, sin_b, cos_b) (lag_sincos(a, sin_a, cos_a), lag_sincos(b, sin_b, cos_b))
#endif
#ifndef LAG_SINCOS_4
#define lag_sincos4(a, sin_a, cos_a, b, sin_b, cos_b, c, sin_c, cos_c, d, sin_d, cos_d) \
  (lag_sincos2(a, sin_a, cos_a, b, sin_b, cos_b), lag_sincos2(c, sin_c, cos_c, d, sin_d, cos_d))
#endif

/* ---- exp ---- */
#if LAG_OWN
/* 2^k e^y, x = k log 2 + y - tail: Cody and Waite's reduction, log 2 in two parts, and a minimax polynomial (tests/math/remez.py).
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
/* x = 2^k m, m between sqrt(1/2) and sqrt(2); log m = 2 artanh s with s = (m - 1)/(m + 1), of which m - 1 - (m - 1)^2/2 is taken
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
  const lag_word w = lag_to_word(from) + (0x3ff0000000000000 - 0x3fe6a09e667f3bcd);
  const LAG_REAL k = lag_to_real((w >> 52) + 0x4330000000000000) - less;
  const LAG_REAL f = lag_to_real((w & 0x000fffffffffffff) + 0x3fe6a09e667f3bcd) - LAG_K(1.0);
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
/* a*b - p, where p is a*b rounded (T. Dekker, Numer. Math. 18 (1971) 224, where there is no instruction). */
LAG_INLINE LAG_REAL lag_lost(LAG_REAL a, LAG_REAL b, LAG_REAL p) {
#if LAG_FMA
  return lag_mad(a, b, -p);
#else
  const LAG_REAL u = a*LAG_K(134217729.0), v = b*LAG_K(134217729.0); /* 2^27 + 1 */
  const LAG_REAL a1 = u - (u - a), a2 = a - a1, b1 = v - (v - b), b2 = b - b1;
  return ((a1*b1 - p) + a1*b2 + a2*b1) + a2*b2;
#endif
}

/* 1/sqrt(x): a quotient, and one step of Newton's method with a residual that is exact. lagc does not use it: a double's
 * 1/sqrt(x) by the processor is as fast, and 1.5 units off at most. */
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

/* ---- end ---- */
#ifndef LAG_FN
#define LAG_FN(f) f
#endif
#ifndef LAG_C
#define LAG_C(x) ((LAG_REAL)x)
#endif
#endif
