/* Section `sincos` of lag_math.h, its only includer: sine and cosine by a table of multiples of pi/32; of lanes, and
 * with LAG_AS_LANES, by longer polynomials. */
/* ---- sincos: front ---- */
#if LAG_OWN
#if defined(LAG_LANES) || defined(LAG_AS_LANES)
#define LAG_SINCOS_2 1
#elif defined(__GNUC__) && defined(__SSE2__) && (defined(__FMA__) || !LAG_FMA)
#define LAG_SINCOS_2 1
#if LAG_FMA && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define LAG_SINCOS_4 1
#endif
#endif
#endif
LAG_INLINE void lag_sincos(LAG_REAL x, LAG_REAL *s, LAG_REAL *c);
LAG_INLINE LAG_REAL lag_sin(LAG_REAL x);
LAG_INLINE LAG_REAL lag_cos(LAG_REAL x);
#define lag_lanes_sin lag_sin
#define lag_lanes_cos lag_cos
#else
#define lag_sincos(x, s, c) (void)(*(s) = LAG_FN(sin)(x), *(c) = LAG_FN(cos)(x))
#define lag_sin(x) LAG_FN(sin)(x)
#define lag_cos(x) LAG_FN(cos)(x)
#endif
#ifdef LAG_SINCOS_2
LAG_INLINE void lag_sincos2(LAG_REAL a, LAG_REAL *sin_a, LAG_REAL *cos_a, LAG_REAL b, LAG_REAL *sin_b, LAG_REAL *cos_b);
#else
#define lag_sincos2(a, sin_a, cos_a, b, sin_b, cos_b) (lag_sincos(a, sin_a, cos_a), lag_sincos(b, sin_b, cos_b))
#endif
#ifdef LAG_SINCOS_4
LAG_INLINE void lag_sincos4(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b,
                            double c, double *sin_c, double *cos_c, double d, double *sin_d, double *cos_d);
#else
#define lag_sincos4(a, sin_a, cos_a, b, sin_b, cos_b, c, sin_c, cos_c, d, sin_d, cos_d) \
  (lag_sincos2(a, sin_a, cos_a, b, sin_b, cos_b), lag_sincos2(c, sin_c, cos_c, d, sin_d, cos_d))
#endif

/* ---- sincos ---- */
#if LAG_OWN
/* The fraction f[6], in 32 bits each, of pi/2 is y - *lo; returns y. */
#if defined(__GNUC__)
__attribute__((cold, noinline, unused))
#endif
static double lag_quarter_part(const lag_bits *f, double *lo) {
  double sum = 0, rest = 0, unit = 1;
  for (int i = 0; i < 6; i++) {
    unit *= 1/4294967296.0;
    const double part = (double)f[i]*unit, was = sum;
    sum += part;
    rest += (was - sum) + part;
  }
  const double pi_2 = 1.5707963267948966, product = sum*pi_2;
  const double low = fma(sum, pi_2, -product) + (sum*6.123233995736766e-17 + rest*pi_2);
  const double y = product + low;
  *lo = (y - product) - low;
  return y;
}

/* Payne and Hanek's reduction: returns y, with x modulo pi/2 = y - *lo, |y| <= pi/4, and *quarter, the number of
 * quarter turns modulo 4, for x of any size and next to a multiple of pi/2. Bits of 2/pi whose products with x are
 * multiples of 4 are left out; the next 192 suffice, as no double is nearer than 2^-62 to a multiple (M. Payne, R.
 * Hanek, Radian reduction for trigonometric functions, SIGNUM Newsletter 18 (1983), doi:10.1145/1057600.1057602;
 * J.-M. Muller, Elementary Functions, 3rd ed., 2016, section 11.4). */
#if defined(__GNUC__)
__attribute__((cold, noinline, unused))
#endif
static double lag_reduce(double x, double *lo, lag_bits *quarter) {
  static const unsigned two_over_pi[] = {
      /* 2/pi = 0.a2f9836e..., after 64 zeros */
      0,          0,          0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab,
      0xdebbc561, 0xb7246e3a, 0x424dd2e0, 0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e, 0xe88235f5, 0x2ebb4484,
      0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4, 0x9c845f8b, 0xbdf9283b, 0x1ff897ff, 0xde05980f, 0xef2f118b,
      0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7, 0x4f463f66, 0x9e5fea2d, 0x7527bac7, 0xebe5f17b, 0x3d0739f7, 0x8a5292ea,
      0x6bfb5fb1, 0x1f8d5d08, 0x56033046, 0xfc7b6bab, 0xf0cfbc20, 0x9af4361d};
  *lo = 0;
  *quarter = 0;
  if (!(fabs(x) <= 1.7976931348623157e308)) return x - x; /* not a number */
  if (fabs(x) < 0.78539816339744828) return x;
  int e, negative = x < 0;
  const lag_bits n = (lag_bits)ldexp(frexp(fabs(x), &e), 53); /* |x| = n 2^(e - 53) */
  const lag_bits factor[2] = {n & 0xffffffff, n >> 32};
  const int at = e - 53 - 2 + 64, shift = at % 32;
  lag_bits w[6], f[6] = {0, 0, 0, 0, 0, 0}, carry;
  for (int i = 0; i < 6; i++)
    w[i] = ((lag_bits)two_over_pi[at/32 + i] << 32 | two_over_pi[at/32 + i + 1]) >> (32 - shift) & 0xffffffff;
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
  const double y = lag_quarter_part(f, lo);
  if (negative) *lo = -*lo;
  return negative ? -y : y;
}

#if defined(LAG_LANES) || defined(LAG_AS_LANES)
#ifdef LAG_LANES
#define LAG_ALL_BITS(w) ((lag_word)((LAG_MASK)(w) >> 63))
#define LAG_SINCOS_IS_FAR(w) __builtin_expect(lag_lanes_reach(w, 18), 0)
#else
#define LAG_ALL_BITS(w) ((lag_word)0 - ((w) >> 63))
#define LAG_SINCOS_IS_FAR(w) ((w) >> 18 != 0)
#endif
/* Sine and cosine of x = k pi/2 + y - lo, |y| <= pi/4, where quarter is k modulo 4. Minimax polynomials by
 * tests/math/remez.py, bracketed for a short critical path. */
LAG_INLINE void lag_sincos_turned(LAG_REAL y, LAG_REAL lo, lag_word quarter, LAG_REAL *s, LAG_REAL *c) {
  const LAG_REAL z = y * y, zz = z * z, w = lag_mad(z, LAG_K(-0.5), LAG_K(1.0)),
                 rest = lag_mad(z, LAG_K(-0.5), LAG_K(1.0) - w);
  const LAG_REAL p = lag_mad(zz, lag_mad(zz, lag_mad(z, LAG_K(-1.5895432975868974e-10), LAG_K(2.5050734385284707e-08)),
                                         lag_mad(z, LAG_K(-2.7557313538498488e-06), LAG_K(0.00019841269829358509))),
                             lag_mad(z, LAG_K(-0.0083333333333218407), LAG_K(0.1666666666666663)));
  const LAG_REAL q = lag_mad(zz, lag_mad(zz, lag_mad(z, LAG_K(-1.1358749174703273e-11), LAG_K(2.087570539521945e-09)),
                                         lag_mad(z, LAG_K(-2.7557314217035774e-07), LAG_K(2.4801587289002076e-05))),
                             lag_mad(z, LAG_K(-0.0013888888888873342), LAG_K(0.041666666666666595)));
  const LAG_REAL sine = y - lag_mad(z*y, p, lo), cosine = w + lag_mad(zz, q, lag_mad(y, lo, rest));
  const lag_word a = lag_to_word(sine), b = lag_to_word(cosine), odd = quarter << 63,
                 minus = quarter << 62 & lag_to_word(LAG_K(-0.0));
  const lag_word swap = (a ^ b) & LAG_ALL_BITS(odd);
  *s = lag_to_real(a ^ swap ^ minus);
  *c = lag_to_real(b ^ swap ^ minus ^ odd);
}

/* x in quarter turns, rounded to an integer by adding 1.5 2^52; and 2^17, so that all integers from -2^17 to 2^17 -
 * 1 have the same leading bits. */
LAG_INLINE LAG_REAL lag_quarters(LAG_REAL x) {
  return lag_mad(x, LAG_K(0.63661977236758138), LAG_K(6755399441186816.0));
}
/* 2^18 or more in lanes where x is outside that range. */
LAG_INLINE lag_word lag_quarters_far(LAG_REAL sum) { return lag_to_word(sum) ^ lag_to_word(LAG_K(6755399441055744.0)); }

/* y - *lo = x - k pi/2 for |k| <= 2^17. W. Cody, W. Waite, Software Manual for the Elementary Functions, 1980, with
 * pi/2 in three parts: the products of k with the first two are exact. The error of the reduction is known to 2^-129
 * |x| and enters to first order; no double in this range is so near to a multiple of pi/2 that more would matter. */
LAG_INLINE LAG_REAL lag_sincos_reduce(LAG_REAL x, LAG_REAL sum, LAG_REAL *lo) {
  const LAG_REAL k = sum - LAG_K(6755399441186816.0);
  const LAG_REAL first = lag_mad(k, LAG_K(-1.5707963267923333), x);
  const LAG_REAL y = lag_mad(k, LAG_K(-2.5633441515839558e-12), first);
  *lo = lag_mad(k, LAG_K(1.0562999066987428e-23), lag_mad(k, LAG_K(2.5633441515839558e-12), y - first));
  return y;
}

/* Sine and cosine for any x. A function of its own, with arguments by address, so that the common case keeps its
 * registers. */
#if defined(__GNUC__)
__attribute__((cold, noinline, unused))
#endif
static void lag_sincos_far(const LAG_REAL *x, LAG_REAL *s, LAG_REAL *c) {
  const LAG_REAL sum = lag_quarters(*x);
  LAG_REAL lo, y = lag_sincos_reduce(*x, sum, &lo);
  lag_word quarter = lag_to_word(sum);
  const lag_word far = lag_quarters_far(sum) >> 18;
#ifndef LAG_LANES
  if (far) y = lag_reduce(*x, &lo, &quarter);
#else
  for (int lane = 0; lane < LAG_LANES; lane++) {
    double low = lo[lane];
    lag_bits quarters = quarter[lane];
    if (far[lane]) y[lane] = lag_reduce((*x)[lane], &low, &quarters);
    lo[lane] = low;
    quarter[lane] = quarters;
  }
#endif
  lag_sincos_turned(y, lo, quarter, s, c);
}

LAG_INLINE void lag_sincos_near(LAG_REAL x, LAG_REAL sum, LAG_REAL *s, LAG_REAL *c) {
  LAG_REAL lo;
  const LAG_REAL y = lag_sincos_reduce(x, sum, &lo);
  lag_sincos_turned(y, lo, lag_to_word(sum), s, c);
}

LAG_INLINE void lag_sincos(LAG_REAL x, LAG_REAL *s, LAG_REAL *c) {
  const LAG_REAL sum = lag_quarters(x);
  if (LAG_SINCOS_IS_FAR(lag_quarters_far(sum))) {
    LAG_REAL at = x, sine, cosine;
    lag_sincos_far(&at, &sine, &cosine);
    *s = sine;
    *c = cosine;
    return;
  }
  lag_sincos_near(x, sum, s, c);
}

/* Two angles: one branch decides for both whether they are in the short range. */
LAG_INLINE void lag_sincos2(LAG_REAL a, LAG_REAL *sin_a, LAG_REAL *cos_a, LAG_REAL b, LAG_REAL *sin_b,
                            LAG_REAL *cos_b) {
  const LAG_REAL sum_a = lag_quarters(a), sum_b = lag_quarters(b);
  if (LAG_SINCOS_IS_FAR(lag_quarters_far(sum_a) | lag_quarters_far(sum_b))) {
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

/* sines: pairs of sin(k pi/32) and its rounding error; cosines stand 32 numbers further. The first 0 is negative for
 * sin(-0) = -0. The other constants stand here twice, as LAG_SINCOS_NEAR takes them for two angles at a time. */
#define LAG_TWICE(x) {x, x}
static const struct lag_sincos_table {
  double sines[160], per_unit[2], whole[2], part1[2], part2[2], part3[2], s3[2], s5[2], s7[2], c2[2], c4[2], c6[2],
      c8[2];
  lag_word off[2], high[2], row[2];
} lag_sincos_table = {{-0.0,
                       0, 0.098017140329560604, 1.634582362244256e-18, 0.19509032201612828, 7.9910790684617313e-18,
                       0.29028467725446239, 1.8927978707774251e-17, 0.38268343236508978, 1.0050772696461588e-17,
                       0.47139673682599764, -6.516678136069013e-18, 0.55557023301960218, -4.7094109405616768e-17,
                       0.63439328416364549, -1.0420901929280035e-17, 0.70710678118654757, 4.8336466567264567e-17,
                       0.77301045336273699, 3.2565907033649772e-17, 0.83146961230254524, -1.4073856984728024e-18,
                       0.88192126434835505, 1.9843248405890562e-17, 0.92387953251128674, -1.7645047084336677e-17,
                       0.95694033573220882, -4.0553869861875701e-17, 0.98078528040323043, -1.8546939997825006e-17,
                       0.99518472667219693, 4.248691367830441e-17, 1, 0, 0.99518472667219693, 4.248691367830441e-17,
                       0.98078528040323043, -1.8546939997825006e-17, 0.95694033573220882, -4.0553869861875701e-17,
                       0.92387953251128674, -1.7645047084336677e-17, 0.88192126434835505, 1.9843248405890562e-17,
                       0.83146961230254524, -1.4073856984728024e-18, 0.77301045336273699, 3.2565907033649772e-17,
                       0.70710678118654757, 4.8336466567264567e-17, 0.63439328416364549, -1.0420901929280035e-17,
                       0.55557023301960218, -4.7094109405616768e-17, 0.47139673682599764, -6.516678136069013e-18,
                       0.38268343236508978, 1.0050772696461588e-17, 0.29028467725446239, 1.8927978707774251e-17,
                       0.19509032201612828, 7.9910790684617313e-18, 0.098017140329560604, 1.634582362244256e-18, 0, 0,
                       -0.098017140329560604, -1.634582362244256e-18, -0.19509032201612828, -7.9910790684617313e-18,
                       -0.29028467725446239, -1.8927978707774251e-17, -0.38268343236508978, -1.0050772696461588e-17,
                       -0.47139673682599764, 6.516678136069013e-18, -0.55557023301960218, 4.7094109405616768e-17,
                       -0.63439328416364549, 1.0420901929280035e-17, -0.70710678118654757, -4.8336466567264567e-17,
                       -0.77301045336273699, -3.2565907033649772e-17, -0.83146961230254524, 1.4073856984728024e-18,
                       -0.88192126434835505, -1.9843248405890562e-17, -0.92387953251128674, 1.7645047084336677e-17,
                       -0.95694033573220882, 4.0553869861875701e-17, -0.98078528040323043, 1.8546939997825006e-17,
                       -0.99518472667219693, -4.248691367830441e-17, -1, 0, -0.99518472667219693,
                       -4.248691367830441e-17, -0.98078528040323043, 1.8546939997825006e-17, -0.95694033573220882,
                       4.0553869861875701e-17, -0.92387953251128674, 1.7645047084336677e-17, -0.88192126434835505,
                       -1.9843248405890562e-17, -0.83146961230254524, 1.4073856984728024e-18, -0.77301045336273699,
                       -3.2565907033649772e-17, -0.70710678118654757, -4.8336466567264567e-17, -0.63439328416364549,
                       1.0420901929280035e-17, -0.55557023301960218, 4.7094109405616768e-17, -0.47139673682599764,
                       6.516678136069013e-18, -0.38268343236508978, -1.0050772696461588e-17, -0.29028467725446239,
                       -1.8927978707774251e-17, -0.19509032201612828, -7.9910790684617313e-18, -0.098017140329560604,
                       -1.634582362244256e-18, 0, 0, 0.098017140329560604, 1.634582362244256e-18, 0.19509032201612828,
                       7.9910790684617313e-18, 0.29028467725446239, 1.8927978707774251e-17, 0.38268343236508978,
                       1.0050772696461588e-17, 0.47139673682599764, -6.516678136069013e-18, 0.55557023301960218,
                       -4.7094109405616768e-17, 0.63439328416364549, -1.0420901929280035e-17, 0.70710678118654757,
                       4.8336466567264567e-17, 0.77301045336273699, 3.2565907033649772e-17, 0.83146961230254524,
                       -1.4073856984728024e-18, 0.88192126434835505, 1.9843248405890562e-17, 0.92387953251128674,
                       -1.7645047084336677e-17, 0.95694033573220882, -4.0553869861875701e-17, 0.98078528040323043,
                       -1.8546939997825006e-17, 0.99518472667219693,
                       4.248691367830441e-17},
                      LAG_TWICE(10.185916357881302),
                      LAG_TWICE(6755399441055744.0), /* 1.5 2^52 */
                      LAG_TWICE(-0.09817477042452083), LAG_TWICE(-1.6020900947399724e-13),
                      LAG_TWICE(6.6018744168671423e-25), LAG_TWICE(0.16666666666665958),
                      LAG_TWICE(-0.0083333333154962386), LAG_TWICE(0.00019839993603852713), LAG_TWICE(0.5),
                      LAG_TWICE(-0.041666666666665471), LAG_TWICE(0.0013888888865417341),
                      LAG_TWICE(-2.4800157698025678e-05), LAG_TWICE(LAG_BITS(0x4337ffff, 0xfffc0000)),
                      LAG_TWICE(~(lag_bits)0x7ffff),
                      LAG_TWICE(1008)};
#define LAG_SINCOS_K(name) LAG_K(lag_sincos_table.name[0])

LAG_INLINE const double *lag_sines(lag_word k) { return lag_sincos_table.sines + (2*k & 126); }

#if LAG_FMA
#define LAG_SINCOS_SUM(real, mad, K) const real sine = S + mad(C, r, -t), cosine = C - mad(S, r, u)
#else
#define LAG_SINCOS_SUM(real, mad, K) /* near_S, near_C: S and C rounded to integers, so that near_C*r is exact */ \
  const real near_S = (S + K(whole)) - K(whole), near_C = (C + K(whole)) - K(whole); \
  const real sine = S + (near_C*r + ((C - near_C)*r - t)), cosine = C - (near_S*r + ((S - near_S)*r + u))
#endif
/* Sine and cosine of x, of a double or of several side by side, by the same operations: sine and cosine of a
 * multiple of pi/32 from the table (S, C and their errors S_add, C_add), and of the rest by minimax polynomials
 * (tests/math/remez.py), after W. Cody and W. Waite (Software Manual for the Elementary Functions, 1980) with pi/32
 * in three parts; the idea is P. Tang's, ACM Trans. Math. Softw. 15 (1989) 144, doi:10.1145/63522.214389. sum: x in
 * units of pi/32, rounded to an integer by LAG_SINCOS_INTEGER; its products with the first two parts are exact, the
 * error is 2^-130 |x|, and no double with |x| <= 2^18 pi/32 is so near to a multiple of pi/2 that it would matter.
 * Sums are bracketed for a short critical path from x: a stage of an integrator waits for it. */
#define LAG_SINCOS_INTEGER(x, mad, K) mad(x, K(per_unit), K(whole))
#define LAG_SINCOS_NEAR(real, mad, K, rest) \
  const real k = sum - K(whole); \
  const real first = mad(k, K(part1), x), r = mad(k, K(part2), first); \
  const real third = mad(k, K(part3), mad(-k, K(part2), r - first)), low = rest; \
  const real z = r*r, zz = z*z; \
  const real p = mad(zz, K(s7), mad(z, K(s5), K(s3))); \
  const real q = mad(zz, mad(z, K(c8), K(c6)), mad(z, K(c4), K(c2))); \
  const real less_s = mad(r*z, p, low); /* r - sin r, with the low part; z q is 1 - cos r */ \
  const real t = mad(C, less_s, mad(S*z, q, S_add)), u = mad(-S, less_s, mad(C*z, q, C_add)); \
  LAG_SINCOS_SUM(real, mad, K)

/* Whether sum is not 1.5 2^52 + k with |k| <= 2^18, that is |x| < 25735: tested on its bits, which the table index
 * needs anyway, for one angle or several joined by `|`. */
#define LAG_SINCOS_OFF(word) ((word) - LAG_BITS(0x4337ffff, 0xfffc0000))
#define LAG_SINCOS_FAR(off) (((off) & ~(lag_bits)0x7ffff) != 0)

/* Sine and cosine of x - *lo (lo may be NULL) plus `quarters` quarter turns. */
LAG_INLINE lag_pair lag_sincos_near(double x, double sum, const double *lo, lag_word quarters) {
  const double *at = lag_sines(lag_to_word(sum) + 16*quarters), S = at[0], C = at[32], S_add = at[1], C_add = at[33];
  LAG_SINCOS_NEAR(double, lag_mad, LAG_SINCOS_K, lo ? third + *lo : third);
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
  lag_bits quarters;
  x = lag_reduce(x, &lo, &quarters);
  return lag_sincos_near(x, LAG_SINCOS_INTEGER(x, lag_mad, LAG_SINCOS_K), &lo, quarters);
}

LAG_INLINE void lag_sincos(double x, double *s, double *c) {
  const double sum = LAG_SINCOS_INTEGER(x, lag_mad, LAG_SINCOS_K);
#if defined(__GNUC__)
  const lag_pair y = __builtin_expect(LAG_SINCOS_FAR(LAG_SINCOS_OFF(lag_to_word(sum))), 0)
                         ? lag_sincos_far(x)
                         : lag_sincos_near(x, sum, 0, 0);
#else
  const lag_pair y =
      LAG_SINCOS_FAR(LAG_SINCOS_OFF(lag_to_word(sum))) ? lag_sincos_far(x) : lag_sincos_near(x, sum, 0, 0);
#endif
  *s = y.s;
  *c = y.c;
}

/* Two or four angles side by side in a register: the same bits as one after the other, in little more time than one
 * angle takes. */
#ifdef LAG_SINCOS_2
__attribute__((cold, noinline, unused)) static lag_pair lag_sincos_any(double x) {
  lag_pair y;
  lag_sincos(x, &y.s, &y.c);
  return y;
}

typedef double lag_two __attribute__((vector_size(16)));
typedef lag_bits lag_two_words __attribute__((vector_size(16)));
typedef lag_signed lag_two_integers __attribute__((vector_size(16)));
LAG_INLINE lag_two lag_two_mad(lag_two a, lag_two b, lag_two c) {
#if LAG_FMA
  return __builtin_ia32_vfmaddpd(a, b, c);
#else
  return a*b + c;
#endif
}
typedef double lag_two_there __attribute__((vector_size(16), aligned(8), may_alias)); /* two numbers in memory */
typedef lag_bits lag_two_words_there __attribute__((vector_size(16), aligned(8), may_alias));
#define LAG_TWO_K(name) (*(const lag_two_there *)table->name)
#define LAG_TWO_WORDS(name) (*(const lag_two_words_there *)table->name)

/* The upper element. Without SSE4.1 compilers would take it by movhlps, which waits for the old value of its target:
 * calls in a row would wait for each other. */
LAG_INLINE lag_word lag_two_upper(lag_two_words x) {
#if defined(__SSE4_1__)
  return x[1];
#else
  lag_two_words upper;
  __asm__("pshufd $0xee, %1, %0" : "=x"(upper) : "x"(x));
  return upper[0];
#endif
}

/* LAG_SINCOS_FAR of either angle. */
LAG_INLINE int lag_two_far(const struct lag_sincos_table *table, lag_two_words sum) {
  const lag_two_words off = sum - LAG_TWO_WORDS(off);
#if defined(__SSE4_1__)
  return !__builtin_ia32_ptestz128((lag_two_integers)off, (lag_two_integers)LAG_TWO_WORDS(high));
#else
  return LAG_SINCOS_FAR(off[0] | lag_two_upper(off));
#endif
}

LAG_INLINE void lag_sincos2(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b) {
  const struct lag_sincos_table *table = &lag_sincos_table;
  /* hides the address: compilers would build the constants anew, where the processor can load them while it computes */
  __asm__("" : "+r"(table));
  const lag_two x = {a, b}, sum = LAG_SINCOS_INTEGER(x, lag_two_mad, LAG_TWO_K);
  if (__builtin_expect(lag_two_far(table, (lag_two_words)sum), 0)) {
    const lag_pair y = lag_sincos_any(a), z = lag_sincos_any(b);
    *sin_a = y.s, *cos_a = y.c, *sin_b = z.s, *cos_b = z.c;
    return;
  }
  /* row offset in bytes; lag_sines has it in numbers */
  const lag_two_words row = (lag_two_words)sum << 4 & LAG_TWO_WORDS(row);
  const lag_two_there *const A = (const lag_two_there *)((const char *)table + row[0]);
  const lag_two_there *const B = (const lag_two_there *)((const char *)table + lag_two_upper(row));
  const lag_two sin_a_row = A[0], sin_b_row = B[0], cos_a_row = A[16], cos_b_row = B[16];
  const lag_two S = {sin_a_row[0], sin_b_row[0]}, S_add = {sin_a_row[1], sin_b_row[1]};
  const lag_two C = {cos_a_row[0], cos_b_row[0]}, C_add = {cos_a_row[1], cos_b_row[1]};
  LAG_SINCOS_NEAR(lag_two, lag_two_mad, LAG_TWO_K, third);
  *sin_a = sine[0], *cos_a = cosine[0], *sin_b = sine[1], *cos_b = cosine[1];
}
#endif

#ifdef LAG_SINCOS_4
typedef double lag_four __attribute__((vector_size(32)));
typedef lag_bits lag_four_words __attribute__((vector_size(32)));
LAG_INLINE lag_four lag_four_mad(lag_four a, lag_four b, lag_four c) { return __builtin_ia32_vfmaddpd256(a, b, c); }
LAG_INLINE lag_four lag_four_of(double x) {
  const lag_four v = {x, x, x, x};
  return v;
}
#define LAG_FOUR_K(name) lag_four_of(lag_sincos_table.name[0])
/* Two rows of the table, one in each half of a register. */
LAG_INLINE lag_four lag_sines_two(const double *low, const double *high) {
  const lag_two a = {low[0], low[1]}, b = {high[0], high[1]};
  return __builtin_shufflevector(a, b, 0, 1, 2, 3);
}

LAG_INLINE void lag_sincos4(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b,
                            double c, double *sin_c, double *cos_c, double d, double *sin_d, double *cos_d) {
  const lag_four x = {a, b, c, d}, sum = LAG_SINCOS_INTEGER(x, lag_four_mad, LAG_FOUR_K);
  const lag_four_words word = (lag_four_words)sum;
  const lag_word i = word[0], j = word[1], m = word[2], n = word[3];
  if (__builtin_expect(LAG_SINCOS_FAR(LAG_SINCOS_OFF(i) | LAG_SINCOS_OFF(j) | LAG_SINCOS_OFF(m) | LAG_SINCOS_OFF(n)),
                       0)) {
    const lag_pair y = lag_sincos_any(a), z = lag_sincos_any(b), v = lag_sincos_any(c), w = lag_sincos_any(d);
    *sin_a = y.s, *cos_a = y.c, *sin_b = z.s, *cos_b = z.c, *sin_c = v.s, *cos_c = v.c, *sin_d = w.s, *cos_d = w.c;
    return;
  }
  const double *const A = lag_sines(i), *const B = lag_sines(j), *const G = lag_sines(m), *const D = lag_sines(n);
  const lag_four sin_ac = lag_sines_two(A, G), sin_bd = lag_sines_two(B, D);
  const lag_four cos_ac = lag_sines_two(A + 32, G + 32), cos_bd = lag_sines_two(B + 32, D + 32);
  const lag_four S = __builtin_shufflevector(sin_ac, sin_bd, 0, 4, 2, 6),
                 S_add = __builtin_shufflevector(sin_ac, sin_bd, 1, 5, 3, 7);
  const lag_four C = __builtin_shufflevector(cos_ac, cos_bd, 0, 4, 2, 6),
                 C_add = __builtin_shufflevector(cos_ac, cos_bd, 1, 5, 3, 7);
  LAG_SINCOS_NEAR(lag_four, lag_four_mad, LAG_FOUR_K, third);
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
#endif

/* ---- end ---- */
