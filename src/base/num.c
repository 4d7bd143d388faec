#include "base/num.h"

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

static Num inexact(double x) { return (Num){.num = 0, .den = 0, .approx = x}; }

/* n/d in lowest terms; a double when it does not fit. */
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
  if (wide_abs(n) > INT64_MAX || d > INT64_MAX) return inexact((double)n / (double)d);
  return (Num){.num = (int64_t)n, .den = (int64_t)d};
}

Num num_int(int64_t n) { return n == INT64_MIN ? inexact((double)n) : (Num){.num = n, .den = 1}; }
Num num_ratio(int64_t n, int64_t d) { return reduce(n, d); }

Num num_double(double x) {
  if (x == floor(x) && fabs(x) < 9e15) return num_int((int64_t)x);
  for (int64_t d = 2; d <= 1024; d *= 2)
    if (x * (double)d == floor(x * (double)d) && fabs(x) < 1e12) return num_ratio((int64_t)(x * (double)d), d);
  return inexact(x);
}

int num_is_exact(Num a) { return a.den != 0; }
int num_is_int(Num a) { return a.den == 1; }
int num_is_zero(Num a) { return a.den ? a.num == 0 : a.approx == 0; }
int num_is_one(Num a) { return a.den ? a.num == 1 && a.den == 1 : a.approx == 1; }
double num_value(Num a) { return a.den ? (double)a.num / (double)a.den : a.approx; }

int num_sign(Num a) {
  if (a.den) return (a.num > 0) - (a.num < 0);
  return (a.approx > 0) - (a.approx < 0);
}

int num_cmp(Num a, Num b) {
  if (a.den && b.den) {
    Wide l = (Wide)a.num * b.den, r = (Wide)b.num * a.den;
    return (l > r) - (l < r);
  }
  double x = num_value(a), y = num_value(b);
  return (x > y) - (x < y);
}

int num_equal(Num a, Num b) {
  return a.den == b.den && a.num == b.num && (a.den || memcmp(&a.approx, &b.approx, sizeof a.approx) == 0);
}

Num num_add(Num a, Num b) {
  if (!a.den || !b.den) return inexact(num_value(a) + num_value(b));
  Wide n1 = (Wide)a.num * b.den, n2 = (Wide)b.num * a.den, n;
  if (__builtin_add_overflow(n1, n2, &n)) return inexact(num_value(a) + num_value(b));
  return reduce(n, (Wide)a.den * b.den);
}

Num num_neg(Num a) {
  if (!a.den) return inexact(-a.approx);
  a.num = -a.num;
  return a;
}

Num num_abs(Num a) { return num_sign(a) < 0 ? num_neg(a) : a; }
Num num_sub(Num a, Num b) { return num_add(a, num_neg(b)); }

Num num_mul(Num a, Num b) {
  if (num_is_zero(a) || num_is_zero(b)) return num_int(0);
  if (!a.den || !b.den) return inexact(num_value(a) * num_value(b));
  return reduce((Wide)a.num * b.num, (Wide)a.den * b.den);
}

Num num_div(Num a, Num b) {
  if (!a.den || !b.den) return inexact(num_value(a) / num_value(b));
  return reduce((Wide)a.num * b.den, (Wide)a.den * b.num);
}

/* a^n for n >= 0 by squaring; sets *exact 0 once it overflows. */
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
    return inexact(pow(num_value(a), num_value(b)));
  }
  int64_t n = b.num;
  if (num_is_zero(a)) {
    if (n > 0) return num_int(0);
    if (n == 0) return num_int(1);
    *exact = 0;
    return inexact(INFINITY);
  }
  if (b.den != 1) {
    int64_t top = a.num >= 0 && b.den <= 64 ? int_root(a.num, b.den) : -1;
    int64_t bottom = b.den <= 64 ? int_root(a.den, b.den) : -1;
    if (top < 0 || bottom < 0) {
      *exact = 0;
      return inexact(pow(num_value(a), num_value(b)));
    }
    a = (Num){.num = top, .den = bottom};
  }
  Num base = n < 0 ? num_div(num_int(1), a) : a;
  Num r = pow_int(base, n < 0 ? -n : n, exact);
  return *exact ? r : inexact(pow(num_value(a), num_value(num_int(n))));
}

Num num_gcd(Num a, Num b) {
  if (!a.den || !b.den) return num_int(1);
  if (num_is_zero(a)) return num_abs(b);
  if (num_is_zero(b)) return num_abs(a);
  Wide n = wide_gcd((Wide)a.num * b.den, (Wide)b.num * a.den);
  return num_abs(reduce(n, (Wide)a.den * b.den));
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
  Wide num = digits, den = 1;
  /* Trailing zeros of "1.5000e-30" should not cost exactness. */
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
  return inexact(strtod(text, NULL));
}

void num_format_double(char *out, double x) {
  for (int digits = 1; digits <= 17; digits++) {
    snprintf(out, 32, "%.*g", digits, x);
    if (strtod(out, NULL) == x) return;
  }
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
