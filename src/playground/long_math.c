/* Functions of long double with 34 digits, in place of those of the C library (musl), which computes these as doubles:
 * compilations are compared with the text in all digits of long double. */
#include <math.h>

typedef long double Real;

static const Real ln2 = 0.693147180559945309417232121458176568L, ln10 = 2.30258509299404568401799145468436421L;
/* ln2 = ln2_high + ln2_low; products of ln2_high with an exponent are exact. */
static const Real ln2_high = 0x162e42fefa39efp-53L, ln2_low = 0x1abc9e3b39803f2f6af40f3432673p-168L;

/* exp(r) - 1 for |r| < 0.4: the series at r/256, doubled eight times by 2*e + e*e. */
static Real small_expm1(Real r) {
  const Real h = r / 256;
  Real e = 1;
  for (int n = 14; n > 1; n--) e = 1 + e * h / n;
  e *= h;
  for (int k = 0; k < 8; k++) e *= 2 + e;
  return e;
}

Real expl(Real x) {
  if (isnan(x)) return x;
  if (x > 12000) return (Real)INFINITY;
  if (x < -12000) return 0;
  const Real k = rintl(x / ln2);
  return ldexpl(1 + small_expm1(x - k * ln2_high - k * ln2_low), (int)k);
}
Real expm1l(Real x) { return fabsl(x) < 0.4L ? small_expm1(x) : expl(x) - 1; }

/* log((1 + s)/(1 - s)) for |s| < 0.06. */
static Real log_quotient(Real s) {
  const Real q = s * s;
  Real sum = 0;
  for (int n = 29; n > 0; n -= 2) sum = sum * q + 1.0L / n;
  return 2 * s * sum;
}
Real log1pl(Real x) { return fabsl(x) < 0.1L ? log_quotient(x / (2 + x)) : logl(1 + x); }
Real logl(Real x) {
  int k;
  if (!(x > 0) || isinf(x)) return x == 0 ? (Real)-INFINITY : x > 0 ? x : (Real)NAN;
  if (fabsl(x - 1) < 0.1L) return log_quotient((x - 1) / (x + 1));
  const Real m = frexpl(x, &k);
  const Real y = (Real)log((double)m); /* m*exp(-y) is 1 to 16 digits */
  return k * ln2_high + (y + (k * ln2_low + log1pl(m * expl(-y) - 1)));
}
Real log2l(Real x) {
  int k;
  const Real m = frexpl(x, &k);
  return m == 0.5L ? k - 1 : logl(x) / ln2;
}
Real log10l(Real x) { return logl(x) / ln10; }

static Real whole_power(Real x, unsigned n) {
  Real r = 1;
  for (; n; n >>= 1, x *= x)
    if (n & 1) r *= x;
  return r;
}
Real powl(Real x, Real y) {
  const Real twice = 2 * y;
  if (y == 0 || x == 1) return 1;
  if (isnan(x) || isnan(y) || isinf(x) || isinf(y) || x == 0) return (Real)pow((double)x, (double)y);
  if (twice == rintl(twice) && fabsl(twice) < 512) { /* halves: products and a root */
    const unsigned n = (unsigned)fabsl(twice);
    const Real r = n % 2 ? whole_power(sqrtl(x), n) : whole_power(x, n / 2);
    return y < 0 ? 1 / r : r;
  }
  if (x < 0 && y != rintl(y)) return (Real)NAN;
  const Real r = expl(y * logl(fabsl(x)));
  return x < 0 && fmodl(y, 2) != 0 ? -r : r;
}

Real sinhl(Real x) {
  const Real e = expm1l(fabsl(x));
  return copysignl(isinf(e) ? e : (e + e / (1 + e)) / 2, x);
}
Real coshl(Real x) {
  const Real e = expl(fabsl(x));
  return (e + 1 / e) / 2;
}
Real tanhl(Real x) {
  const Real e = fabsl(x) < 50 ? expm1l(2 * fabsl(x)) : (Real)INFINITY;
  return copysignl(isinf(e) ? 1 : e / (2 + e), x);
}
Real asinhl(Real x) {
  const Real a = fabsl(x);
  return copysignl(a > 1e30L ? logl(a) + ln2 : log1pl(a + a * a / (1 + sqrtl(1 + a * a))), x);
}
Real acoshl(Real x) { return x > 1e30L ? logl(x) + ln2 : log1pl((x - 1) + sqrtl((x - 1) * (x + 1))); }
Real atanhl(Real x) { return copysignl(log1pl(2 * fabsl(x) / (1 - fabsl(x))) / 2, x); }

/* a/b, rounded to nearest: that of Clang 14's runtime doubles some quotients, as 1/(2 - 2^-112). Long division of the
 * mantissas, bit by bit. */
__extension__ typedef unsigned __int128 Bits;
typedef union {
  Real value;
  Bits bits;
} Parts;
enum { DIGITS = 113, BIAS = 16383 };

/* x = m * 2^(result - 112) with 2^112 <= m, for finite x > 0. */
static int split(Real x, Bits *m) {
  int shift = 0;
  if (x < 0x1p-16382L) x *= 0x1p113L, shift = -DIGITS;
  const Parts p = {.value = x};
  *m = (p.bits & (((Bits)1 << 112) - 1)) | (Bits)1 << 112;
  return (int)(p.bits >> 112) - BIAS + shift;
}

static Real quotient(Real a, Real b) {
  Bits m, n, q = 0;
  int e = split(a, &m) - split(b, &n);
  if (m < n) m <<= 1, e--;
  for (int i = 0; i < DIGITS; i++, m <<= 1) {
    q <<= 1;
    if (m >= n) m -= n, q |= 1;
  }
  if (m > n || (m == n && (q & 1))) q++;
  if (q >> DIGITS) q >>= 1, e++;
  const Parts p = {.bits = (q & (((Bits)1 << 112) - 1)) | (Bits)BIAS << 112};
  return scalbnl(p.value, e);
}

Real __divtf3(Real a, Real b) {
  const int negative = !signbit(a) != !signbit(b);
  const Real size = isnan(a) || isnan(b) ? (Real)NAN
                    : isinf(a)           ? isinf(b) ? (Real)NAN : (Real)INFINITY
                    : isinf(b) || (a == 0 && b != 0) ? 0
                    : b == 0                         ? a == 0 ? (Real)NAN : (Real)INFINITY
                                                     : quotient(fabsl(a), fabsl(b));
  return negative ? -size : size;
}
