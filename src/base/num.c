/* Arithmetic on Num: exact in 128-bit intermediates; on overflow doubles with error bounds, and residues modulo a
 * prime below 2^62. */
#include "base/num.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

__extension__ typedef __int128 Wide;

static Wide wide_abs(Wide a) { return a < 0 ? -a : a; }

static Wide wide_gcd(Wide a, Wide b) {
  a = wide_abs(a);
  b = wide_abs(b);
  while (b) {
    Wide r = a % b;
    a = b;
    b = r;
  }
  return a;
}

/* --- residues --- */

static const uint64_t PRIME = 4611686018427387847u; /* the largest below 2^62 */

__extension__ typedef unsigned __int128 Product;

static uint64_t mod_mul(uint64_t a, uint64_t b) { return (uint64_t)((Product)a * b % PRIME); }
static uint64_t mod_add(uint64_t a, uint64_t b) { return (a + b) % PRIME; }
static uint64_t mod_neg(uint64_t a) { return a ? PRIME - a : 0; }

static uint64_t mod_pow(uint64_t a, uint64_t n) {
  uint64_t r = 1;
  for (; n; n >>= 1, a = mod_mul(a, a))
    if (n & 1) r = mod_mul(r, a);
  return r;
}

/* SplitMix64's finaliser (Steele, Lea, Flood 2014, DOI 10.1145/2714064.2660195). */
static uint64_t scramble(uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9u;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

/* A hash in place of the residue, for values that have none, such as irrational powers. */
static uint64_t mod_drawn(uint64_t a, uint64_t b) { return scramble(scramble(a + 0x9e3779b97f4a7c15u) ^ b) % PRIME; }

static uint64_t mod_div(uint64_t a, uint64_t b) {
  return b == 1 ? a : b ? mod_mul(a, mod_pow(b, PRIME - 2)) : mod_drawn(a, b);
}

static uint64_t mod_ratio(Wide n, Wide d) {
  uint64_t top = (uint64_t)((Product)wide_abs(n) % PRIME), bottom = (uint64_t)((Product)d % PRIME);
  return mod_div(n < 0 ? mod_neg(top) : top, bottom);
}

static uint64_t residue(Num a) { return a.den ? mod_ratio(a.num, a.den) : a.residue; }

/* --- numbers that are not exact --- */

static uint64_t bits_of(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

/* Makes an inexact number; adds the rounding of x and of the bound itself to the error. If value and residue agree
 * on an integer, the result is that integer. */
static Num inexact(double x, double error, uint64_t residue) {
  error = error * (1 + 1e-9) + fabs(x) * DBL_EPSILON + DBL_MIN * DBL_EPSILON;
  int64_t whole = residue > PRIME / 2 ? -(int64_t)(PRIME - residue) : (int64_t)residue;
  if (fabs(x - (double)whole) <= error && (whole == 0 || error < 0.5)) return num_int(whole);
  return (Num){.error = isnan(error) ? INFINITY : error, .den = 0, .approx = x, .residue = residue};
}

/* Bound of the error of num_value(a), also for an exact a whose quotient is rounded. */
static double value_error(Num a) {
  if (!a.den) return a.error;
  return a.den == 1 && llabs(a.num) <= 1ll << 53 ? 0 : 4 * DBL_EPSILON * fabs(num_value(a));
}

static int is_negative(Num a) { return a.den ? a.num < 0 : signbit(a.approx) != 0; }

/* n/d in lowest terms; a double where 64 bits do not hold it. */
static Num reduce(Wide n, Wide d) {
  if (d < 0) {
    n = -n;
    d = -d;
  }
  Wide g = wide_gcd(n, d);
  if (g > 1) {
    n /= g;
    d /= g;
  }
  if (wide_abs(n) > INT64_MAX || d > INT64_MAX) {
    double x = (double)n / (double)d;
    return inexact(x, 2 * DBL_EPSILON * fabs(x), mod_ratio(n, d));
  }
  return (Num){.num = (int64_t)n, .den = (int64_t)d};
}

Num num_int(int64_t n) { return n == INT64_MIN ? reduce(n, 1) : (Num){.num = n, .den = 1}; }
Num num_ratio(int64_t n, int64_t d) { return reduce(n, d); }

Num num_double(double x) {
  if (x == floor(x) && fabs(x) < 9e15) return num_int((int64_t)x);
  for (int64_t d = 2; d <= 1024; d *= 2)
    if (x * (double)d == floor(x * (double)d) && fabs(x) < 1e12) return num_ratio((int64_t)(x * (double)d), d);
  uint64_t drawn = mod_drawn(bits_of(fabs(x)), 1);
  return inexact(x, 0, x < 0 ? mod_neg(drawn) : drawn);
}

int num_is_exact(Num a) { return a.den != 0; }
int num_is_int(Num a) { return a.den == 1; }
int num_is_zero(Num a) { return a.den ? a.num == 0 : a.approx == 0 && a.error == 0; } /* (Num){0} too */
int num_is_one(Num a) { return a.num == 1 && a.den == 1; }
double num_value(Num a) { return a.den ? (double)a.num / (double)a.den : a.approx; }
double num_error(Num a) { return a.den ? 0 : a.error; }
int num_is_imprecise(Num a) { return !a.den && !(a.error <= 1e-6 * fabs(a.approx)); }
Num num_drop_error(Num a) { return a.den ? a : (Num){.error = 0, .den = 0, .approx = a.approx}; }

int num_sign(Num a) {
  if (a.den) return (a.num > 0) - (a.num < 0);
  if (num_is_zero(a)) return 0;
  return is_negative(a) && !isnan(a.approx) ? -1 : 1; /* -NaN has the sign of NaN */
}

int num_sign_is_sure(Num a) { return a.den || fabs(a.approx) > a.error; }

int num_cmp(Num a, Num b) {
  if (a.den && b.den) {
    Wide l = (Wide)a.num * b.den, r = (Wide)b.num * a.den;
    return (l > r) - (l < r);
  }
  double x = num_value(a), y = num_value(b);
  return (x > y) - (x < y);
}

int num_equal(Num a, Num b) {
  if (a.den || b.den) return a.den == b.den && a.num == b.num;
  return a.residue == b.residue && bits_of(a.approx) == bits_of(b.approx);
}

Num num_neg(Num a) {
  if (a.den) {
    a.num = -a.num;
    return a;
  }
  a.approx = -a.approx;
  a.residue = mod_neg(a.residue);
  return a;
}

static Num add_inexact(Num a, Num b) {
  if (num_is_zero(a)) return b;
  if (num_is_zero(b)) return a;
  return inexact(num_value(a) + num_value(b), value_error(a) + value_error(b), mod_add(residue(a), residue(b)));
}

Num num_add(Num a, Num b) {
  if (!a.den || !b.den) return add_inexact(a, b);
  Wide n1 = (Wide)a.num * b.den, n2 = (Wide)b.num * a.den, n;
  if (__builtin_add_overflow(n1, n2, &n)) return add_inexact(a, b);
  return reduce(n, (Wide)a.den * b.den);
}

Num num_abs(Num a) { return num_sign(a) < 0 ? num_neg(a) : a; }
Num num_sub(Num a, Num b) { return num_add(a, num_neg(b)); }

Num num_mul(Num a, Num b) {
  if (num_is_zero(a) || num_is_zero(b)) return num_int(0);
  if (num_is_one(a)) return b;
  if (num_is_one(b)) return a;
  if (a.den && b.den) return reduce((Wide)a.num * b.num, (Wide)a.den * b.den);
  double p = num_value(a), q = num_value(b), ea = value_error(a), eb = value_error(b);
  return inexact(p * q, fabs(p) * eb + fabs(q) * ea + ea * eb, mod_mul(residue(a), residue(b)));
}

Num num_div(Num a, Num b) {
  if (num_is_zero(a) || num_is_one(b)) return a;
  if (a.den && b.den) return reduce((Wide)a.num * b.den, (Wide)a.den * b.num);
  double r = num_value(a) / num_value(b), least = fabs(num_value(b)) - value_error(b);
  double error = least > 0 ? (value_error(a) + fabs(r) * value_error(b)) / least : INFINITY;
  return inexact(r, error, mod_div(residue(a), residue(b)));
}

static uint64_t residue_of_power(Num a, Num b) {
  if (!num_is_int(b)) return mod_drawn(residue(a), residue(b));
  uint64_t r = mod_pow(residue(a), (uint64_t)llabs(b.num));
  return b.num < 0 ? mod_div(1, r) : r;
}

/* x^y; a small whole power as a product of long doubles, whose double does not depend on the C library. */
static double power(double x, double y) {
  enum { MOST = 64 };
  long double r = 1;
  if (y != nearbyint(y) || fabs(y) > MOST) return pow(x, y);
  for (int n = abs((int)y); n; n--) r *= x;
  return (double)(y < 0 ? 1 / r : r);
}

/* a^b, inexact. The error of ln |r| is |b| times that of ln |a|, plus |ln |a|| times that of b. */
static Num pow_inexact(Num a, Num b) {
  double x = num_value(a), y = num_value(b), r = power(x, y), ea = value_error(a), eb = value_error(b),
         least = fabs(x) - ea;
  double relative = least > 0 ? fabs(y) * ea / least + fabs(log(fabs(x))) * eb + 4 * DBL_EPSILON : INFINITY;
  return inexact(r, relative < 0.1 ? 2 * relative * fabs(r) : INFINITY, residue_of_power(a, b));
}

/* a^n for n >= 0 by squaring; sets *exact to 0 on overflow. */
static Num pow_int(Num a, int64_t n, int *exact) {
  Num r = num_int(1);
  while (n > 0 && *exact) {
    if (n & 1) r = num_mul(r, a);
    n >>= 1;
    if (n) a = num_mul(a, a);
    if (!r.den || !a.den) *exact = 0;
  }
  return r;
}

/* The exact root of a non-negative integer, or -1. */
static int64_t int_root(int64_t x, int64_t root) {
  int64_t r = (int64_t)llround(pow((double)x, 1.0 / (double)root));
  for (int64_t c = r > 0 ? r - 1 : 0; c <= r + 1; c++) {
    int exact = 1;
    Num p = pow_int(num_int(c), root, &exact);
    if (exact && p.den == 1 && p.num == x) return c;
  }
  return -1;
}

Num num_pow(Num a, Num b, int *exact) {
  *exact = 1;
  if (!num_is_exact(a) || !num_is_exact(b)) {
    *exact = num_is_int(b);
    return pow_inexact(a, b);
  }
  int64_t n = b.num;
  if (num_is_zero(a)) {
    if (n > 0) return num_int(0);
    if (n == 0) return num_int(1);
    *exact = 0;
    return inexact(INFINITY, INFINITY, 1);
  }
  if (b.den != 1) {
    int64_t top = a.num >= 0 && b.den <= 64 ? int_root(a.num, b.den) : -1;
    int64_t bottom = b.den <= 64 ? int_root(a.den, b.den) : -1;
    if (top < 0 || bottom < 0) {
      *exact = 0;
      return pow_inexact(a, b);
    }
    a = (Num){.num = top, .den = bottom};
  }
  Num base = n < 0 ? num_div(num_int(1), a) : a;
  Num r = pow_int(base, n < 0 ? -n : n, exact);
  return *exact ? r : pow_inexact(a, num_int(n));
}

Num num_gcd(Num a, Num b) {
  if (!a.den || !b.den) return num_int(1);
  if (num_is_zero(a)) return num_abs(b);
  if (num_is_zero(b)) return num_abs(a);
  Wide n = wide_gcd((Wide)a.num * b.den, (Wide)b.num * a.den);
  return num_abs(reduce(n, (Wide)a.den * b.den));
}

/* Residue of a decimal literal whose last digit has the weight 10^exponent. */
static uint64_t literal_residue(const char *s, size_t n, int64_t exponent) {
  uint64_t r = 0;
  for (size_t i = 0; i < n && s[i] != 'e' && s[i] != 'E'; i++)
    if (s[i] != '.') r = mod_add(mod_mul(r, 10), (uint64_t)(s[i] - '0'));
  uint64_t power = mod_pow(10, (uint64_t)llabs(exponent));
  return exponent < 0 ? mod_div(r, power) : mod_mul(r, power);
}

Num num_parse(const char *s, size_t n) {
  Wide digits = 0;
  int scale = 0, seen_point = 0, wide_ok = 1;
  size_t i = 0;
  for (; i < n && s[i] != 'e' && s[i] != 'E'; i++) {
    if (s[i] == '.') {
      seen_point = 1;
      continue;
    }
    if (digits > ((Wide)1 << 100)) wide_ok = 0;
    else digits = digits * 10 + (s[i] - '0');
    scale += seen_point;
  }
  int64_t exponent = 0;
  if (i < n) {
    int negative = ++i < n && s[i] == '-';
    if (i < n && (s[i] == '-' || s[i] == '+')) i++;
    for (; i < n && exponent < 100000; i++) exponent = exponent * 10 + (s[i] - '0');
    if (negative) exponent = -exponent;
  }
  exponent -= scale;
  int64_t whole = exponent;
  Wide num = digits, den = 1;
  /* "1.5000e-30": trailing zeros must not cost exactness. */
  while (exponent < 0 && num && num % 10 == 0) {
    num /= 10;
    exponent++;
  }
  for (; wide_ok && exponent > 0 && num; exponent--)
    if ((num *= 10) > INT64_MAX) wide_ok = 0;
  for (; wide_ok && exponent < 0 && num; exponent++)
    if ((den *= 10) > ((Wide)1 << 100)) wide_ok = 0;
  if (wide_ok) {
    Num exact = reduce(num, den);
    if (exact.den) return exact;
  }
  char text[512];
  size_t len = n < sizeof text - 1 ? n : sizeof text - 1;
  memcpy(text, s, len);
  text[len] = '\0';
  double x = strtod(text, NULL);
  return inexact(x, isinf(x) ? INFINITY : 0, literal_residue(s, n, whole));
}

void num_format_double(char *out, double x) {
  for (int digits = 1; digits <= 17; digits++) {
    snprintf(out, 32, "%.*g", digits, x);
    if (strtod(out, NULL) == x) return;
  }
}

int num_parse_double(const char *text, double *x) {
  char *end;
  *x = strtod(text, &end);
  return *text && strspn(text, "+-.0123456789eE") == strlen(text) && !*end && isfinite(*x);
}

void num_print(StrBuf *out, Num a) {
  if (!a.den) {
    char text[32];
    num_format_double(text, a.approx);
    sb_puts(out, text);
  } else if (a.den == 1) {
    sb_printf(out, "%lld", (long long)a.num);
  } else {
    sb_printf(out, "%lld/%lld", (long long)a.num, (long long)a.den);
  }
}
