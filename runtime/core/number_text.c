/* The shortest decimal text that reads as the same number, of at least DBL_DIG digits. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

/* By printing it with more and more digits. */
static const char *by_trials(double x, char text[64]) {
  for (int digits = DBL_DIG; digits <= DBL_DIG + 3; digits++) {
    snprintf(text, 64, "%.*g", digits, x);
    if (strtod(text, NULL) == x) break;
  }
  return text;
}

#if DBL_DIG == 15 && defined __SIZEOF_INT128__
enum { WHOLE = 17 }; /* digits that tell all doubles apart */
__extension__ typedef unsigned __int128 Wide;

/* x = product/(2^shift 10^(WHOLE - 1 - first)) exactly, first: the exponent of its first digit. A unit of the last bit
 * of x is `unit` of product. */
typedef struct Exact {
  Wide product, unit;
  int shift, first;
} Exact;

/* 0: the product has more bits than Wide: x < 1e-16 or x >= 1e16. */
static int exact_product(double x, Exact *e) {
  const double log10_of_2 = 0.30102999566398120;
  const uint64_t most = 100000000000000000; /* 10^WHOLE */
  int bits;
  const uint64_t mantissa = (uint64_t)ldexp(frexp(x, &bits), DBL_MANT_DIG);
  for (e->first = (int)floor((bits - 1) * log10_of_2);; e->first++) { /* or the next one */
    const int power = WHOLE - 1 - e->first, most_of_5 = 32;
    e->shift = DBL_MANT_DIG - bits - power;
    if (power < 0 || power > most_of_5 || e->shift < 0) return 0;
    e->unit = 1;
    for (int k = 0; k < power; k++) e->unit *= 5;
    e->product = mantissa * e->unit;
    if (e->product >> e->shift < most) return 1;
  }
}

/* The first digits of x, without those below ten^k, rounded; *away: their distance from x, of product. */
static uint64_t rounded(const Exact *e, int k, Wide *away) {
  const uint64_t last = k == 0 ? 1 : k == 1 ? 10 : 100;
  uint64_t digits = (uint64_t)(e->product >> e->shift) / last;
  const Wide step = (Wide)last << e->shift, rest = e->product - digits * step;
  const int up = 2 * rest > step || (2 * rest == step && digits % 2);
  *away = up ? step - rest : rest;
  return digits + (uint64_t)up;
}

/* digits[n] with the exponent of the first, as by %.*g. */
static void write_general(const char *digits, int n, int exponent, int precision, char *to) {
  while (n > 1 && digits[n - 1] == '0') n--;
  if (exponent < -4 || exponent >= precision) {
    *to++ = digits[0];
    if (n > 1) *to++ = '.';
    memcpy(to, digits + 1, (size_t)n - 1);
    sprintf(to + n - 1, "e%c%02d", exponent < 0 ? '-' : '+', abs(exponent));
    return;
  }
  for (int i = exponent < 0 ? exponent : 0; i < n || i <= exponent; i++) {
    if (i == exponent + 1 && i > 0) *to++ = '.';
    *to++ = i < 0 || i >= n ? '0' : digits[i];
    if (i == exponent && i < 0) *to++ = '.';
  }
  *to = '\0';
}

/* The decimal digits of a number; returns how many. */
static int write_digits(uint64_t number, char *digits) {
  char reversed[24];
  int n = 0;
  for (; number; number /= 10) reversed[n++] = (char)('0' + number % 10);
  for (int i = 0; i < n; i++) digits[i] = reversed[n - 1 - i];
  return n;
}

/* By the WHOLE digits of one print, rounded, where the next digits tell them apart from half a unit of the last bit. */
static const char *by_one_print(double x, char text[64]) {
  char all[40], digits[24], *to = text;
  int bits;
  uint64_t whole = 0;
  const double power = frexp(fabs(x), &bits);
  snprintf(all, sizeof all, "%.*e", WHOLE - 1, fabs(x)); /* d.dddde+xx */
  all[1] = all[0];
  for (int i = 1; i <= WHOLE; i++) whole = 10 * whole + (uint64_t)(all[i] - '0');
  const int first = (int)strtol(all + WHOLE + 2, NULL, 10);
  const double half = (double)whole / power * (0.25 * DBL_EPSILON);
  if (x < 0) *to++ = '-';
  for (int n = DBL_DIG; n < WHOLE; n++) {
    const uint64_t last = n == WHOLE - 1 ? 10 : 100, rest = whole % last, number = whole / last + (2 * rest > last);
    const double away = (double)(2 * rest > last ? last - rest : rest);
    if (2 * rest == last) return by_trials(x, text); /* a tie, which the digits do not decide */
    if (away > half + 1) continue;
    const int exponent = first + (write_digits(number, digits) > n);
    write_general(digits, n, exponent, n, to);
    if ((away < half - 1 && power > 0.5) || strtod(text, NULL) == x) return text;
  }
  write_general(all + 1, WHOLE, first, WHOLE, to);
  return text;
}

/* Digits read as x where they are nearer to it than half a unit of its last bit; at half a unit, and at powers of two,
 * which have a nearer number below, reading decides. */
const char *lag_number_text(double x, char text[64]) {
  char digits[24], *to = text;
  Exact e;
  int bits;
  if (!(fabs(x) >= DBL_MIN && fabs(x) <= DBL_MAX)) return by_trials(x, text);
  if (!exact_product(fabs(x), &e)) return by_one_print(x, text);
  const int even = frexp(fabs(x), &bits) > 0.5;
  if (x < 0) *to++ = '-';
  for (int n = DBL_DIG; n <= WHOLE; n++) {
    Wide away;
    const uint64_t number = rounded(&e, WHOLE - n, &away);
    if (n < WHOLE && 2 * away > e.unit) continue;
    int exponent = e.first + (write_digits(number, digits) > n); /* 9.99... has become 10 */
    write_general(digits, n, exponent, n, to);
    if (n == WHOLE || (2 * away < e.unit && even) || strtod(text, NULL) == x) break;
  }
  return text;
}
#else
const char *lag_number_text(double x, char text[64]) { return by_trials(x, text); }
#endif
