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

/* The first n of WHOLE digits of x, rounded, if they may read as x: the next digits, in units of the last, are within
 * half a bit of x. -1: ties that the digits do not decide. */
static int round_digits(const char *whole, int n, char *digits, int *exponent) {
  const uint64_t unit = n == WHOLE - 1 ? 10 : 100;
  uint64_t all = strtoull(whole, NULL, 10), rest = all % unit, head = all / unit + (2 * rest > unit);
  double away = 2 * rest > unit ? (double)(unit - rest) : (double)rest;
  if (2 * rest == unit) return -1;
  if (away > 0.5 * DBL_EPSILON * (double)all + 1) return 0;
  sprintf(digits, "%llu", (unsigned long long)head);
  *exponent += digits[n] != '\0'; /* 9.99... has become 10 */
  return 1;
}

const char *lag_number_text(double x, char text[64]) {
  char all[40], whole[WHOLE + 1], digits[WHOLE + 4], *to = text;
  if (!(fabs(x) >= DBL_MIN && fabs(x) <= DBL_MAX)) return by_trials(x, text);
  snprintf(all, sizeof all, "%.*e", WHOLE - 1, fabs(x)); /* d.dddde+xx */
  whole[0] = all[0];
  memcpy(whole + 1, all + 2, WHOLE - 1);
  whole[WHOLE] = '\0';
  const int first = (int)strtol(all + WHOLE + 2, NULL, 10);
  if (x < 0) *to++ = '-';
  for (int n = DBL_DIG; n < WHOLE; n++) {
    int exponent = first, may = round_digits(whole, n, digits, &exponent);
    if (may < 0) return by_trials(x, text);
    if (may) write_general(digits, n, exponent, n, to);
    if (may && strtod(text, NULL) == x) return text;
  }
  write_general(whole, WHOLE, first, WHOLE, to);
  return text;
}
#else
const char *lag_number_text(double x, char text[64]) { return by_trials(x, text); }
#endif
