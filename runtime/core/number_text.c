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

#if DBL_DIG == 15
enum { WHOLE = 17 }; /* digits that tell all doubles apart */

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

/* The first n digits of the WHOLE ones of x, `all`, rounded. They read as x where the next digits are within half a bit
 * of x, `half` in units of the last: 2. 1: they may; 0: they do not; -1: ties that the digits do not decide. */
static int round_digits(uint64_t all, double half, int n, char *digits, int *exponent) {
  const uint64_t unit = n == WHOLE - 1 ? 10 : 100;
  uint64_t rest = all % unit, head = all / unit + (2 * rest > unit);
  double away = 2 * rest > unit ? (double)(unit - rest) : (double)rest;
  if (2 * rest == unit) return -1;
  if (away > half + 1) return 0;
  *exponent += write_digits(head, digits) > n; /* 9.99... has become 10 */
  return away < half - 1 ? 2 : 1;
}

const char *lag_number_text(double x, char text[64]) {
  char all[40], digits[WHOLE + 4], *to = text;
  if (!(fabs(x) >= DBL_MIN && fabs(x) <= DBL_MAX)) return by_trials(x, text);
  int bits, first;
  uint64_t whole = 0;
  double power = frexp(fabs(x), &bits);
  snprintf(all, sizeof all, "%.*e", WHOLE - 1, fabs(x)); /* d.dddde+xx */
  all[1] = all[0];
  for (int i = 1; i <= WHOLE; i++) whole = 10 * whole + (uint64_t)(all[i] - '0');
  first = (int)strtol(all + WHOLE + 2, NULL, 10);
  double half = (double)whole / power * (0.25 * DBL_EPSILON);
  if (x < 0) *to++ = '-';
  for (int n = DBL_DIG; n < WHOLE; n++) {
    int exponent = first, may = round_digits(whole, half, n, digits, &exponent);
    if (may < 0) return by_trials(x, text);
    if (may) write_general(digits, n, exponent, n, to);
    if (may && ((may == 2 && power > 0.5) || strtod(text, NULL) == x)) return text;
  }
  write_general(all + 1, WHOLE, first, WHOLE, to);
  return text;
}
#else
const char *lag_number_text(double x, char text[64]) { return by_trials(x, text); }
#endif
