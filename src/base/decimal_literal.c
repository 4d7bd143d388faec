/* Decimal literals by long multiplication and long division, digit by digit, from 1, pi or 1/pi. */
#include "base/num.h"

#include <string.h>

enum { KEPT = 40, ROOM = 160 };

/* The number 0.d0 d1 ... * 10^point, with at[i] the decimal digit di. */
typedef struct {
  unsigned char at[ROOM];
  int n, point;
} Decimal;

static void trim(Decimal *d) {
  int zeros = 0;
  while (zeros < d->n && d->at[zeros] == 0) zeros++;
  memmove(d->at, d->at + zeros, (size_t)(d->n - zeros));
  d->n -= zeros;
  d->point -= zeros;
  while (d->n > 0 && d->at[d->n - 1] == 0) d->n--;
}

/* A constant from the text of its digits, the point after `point` of them. */
static Decimal decimal_of(const char *digits, int point) {
  Decimal d = {.n = (int)strlen(digits), .point = point};
  for (int i = 0; i < d.n; i++) d.at[i] = (unsigned char)(digits[i] - '0');
  return d;
}

static void multiply(Decimal *d, uint64_t by) {
  unsigned char out[ROOM] = {0};
  int places = 0;
  for (uint64_t rest = by; rest > 0; rest /= 10) places++;
  for (int j = places - 1; by > 0; by /= 10, j--) {
    int digit = (int)(by % 10);
    for (int i = d->n - 1, carry = 0, at; i >= -1 - j; i--) {
      at = i + j + 1;
      carry += out[at] + (i >= 0 ? digit*d->at[i] : 0);
      out[at] = (unsigned char)(carry % 10);
      carry /= 10;
      if (i < 0 && carry == 0) break;
    }
  }
  memcpy(d->at, out, sizeof out);
  d->n += places;
  d->point += places;
}

/* by <= 10^18, so that ten remainders fit into 64 bits. */
static void divide(Decimal *d, uint64_t by) {
  Decimal q = {.point = d->point};
  uint64_t rest = 0;
  for (int i = 0, started = 0; (i < d->n || rest > 0) && q.n < ROOM && started <= KEPT; i++) {
    rest = rest*10 + (i < d->n ? d->at[i] : 0);
    q.at[q.n++] = (unsigned char)(rest/by);
    rest %= by;
    started += started > 0 || q.at[q.n - 1] > 0;
  }
  *d = q;
}

static const char *write(Arena *a, Decimal *d, int negative) {
  StrBuf b = strbuf(a);
  int n = d->n < KEPT ? d->n : KEPT, point = d->point, scientific = point < -4 || point > 20;
  int before = scientific ? 1 : point; /* digits before the point */
  if (negative) sb_putc(&b, '-');
  if (before <= 0) sb_putc(&b, '0');
  for (int i = 0; i < before; i++) sb_putc(&b, i < n ? (char)('0' + d->at[i]) : '0');
  sb_putc(&b, '.');
  for (int i = before; i < 0; i++) sb_putc(&b, '0');
  for (int i = before > 0 ? before : 0; i < n; i++) sb_putc(&b, (char)('0' + d->at[i]));
  if (n <= before) sb_putc(&b, '0');
  if (scientific) sb_printf(&b, "e%d", point - 1);
  return sb_text(&b);
}

const char *decimal_literal(Arena *a, Num x, int pi_power) {
  const uint64_t most = UINT64_C(1000000000000000000);
  if (!num_is_exact(x) || (uint64_t)x.den > most || pi_power < -1 || pi_power > 1) return NULL;
  if (num_is_zero(x)) return "0.0";
  Decimal d = pi_power == 0 ? decimal_of("1", 1)
              : pi_power > 0 ? decimal_of("314159265358979323846264338327950288419716939937510582097", 1)
                             : decimal_of("318309886183790671537767526745028724068919291480912897495", 0);
  multiply(&d, x.num < 0 ? (uint64_t)0 - (uint64_t)x.num : (uint64_t)x.num);
  divide(&d, (uint64_t)x.den);
  trim(&d);
  return write(a, &d, x.num < 0);
}
