/* Exact linear systems: integers of up to 96 limbs of 32 bits, and Bareiss's fraction-free elimination on integer rows. */
#include "base/rational_solve.h"

#include <string.h>

enum { LIMBS = 96, BITS = 32 };

/* sign * sum of at[i] 2^(32 i); n is 0 for 0, otherwise at[n - 1] is not 0. */
typedef struct {
  int sign;
  uint32_t n;
  uint32_t at[LIMBS];
} BigInt;

typedef struct {
  int overflow;
} Overflow;

static BigInt big_int(int64_t x) {
  BigInt w = {.sign = x < 0 ? -1 : 1};
  uint64_t size = x < 0 ? (uint64_t)0 - (uint64_t)x : (uint64_t)x;
  for (; size; size >>= BITS) w.at[w.n++] = (uint32_t)size;
  return w;
}

static void copy(BigInt *to, const BigInt *from) {
  to->sign = from->sign;
  to->n = from->n;
  memcpy(to->at, from->at, from->n * sizeof *from->at);
}

static void trim(BigInt *x) {
  while (x->n && !x->at[x->n - 1]) x->n--;
}

/* --- magnitudes, without signs --- */

static int compare(const BigInt *a, const BigInt *b) {
  if (a->n != b->n) return a->n < b->n ? -1 : 1;
  for (uint32_t i = a->n; i-- > 0;)
    if (a->at[i] != b->at[i]) return a->at[i] < b->at[i] ? -1 : 1;
  return 0;
}

/* a += b */
static void add_magnitudes(Overflow *w, BigInt *a, const BigInt *b) {
  uint32_t n = a->n > b->n ? a->n : b->n;
  uint64_t carry = 0;
  for (uint32_t i = 0; i < n; i++) {
    carry += (uint64_t)(i < a->n ? a->at[i] : 0) + (i < b->n ? b->at[i] : 0);
    a->at[i] = (uint32_t)carry;
    carry >>= BITS;
  }
  a->n = n;
  if (!carry) return;
  if (n == LIMBS) w->overflow = 1;
  else a->at[a->n++] = (uint32_t)carry;
}

/* to = a - b, for a >= b; `to` may be a or b. */
static void subtract_magnitudes(BigInt *to, const BigInt *a, const BigInt *b) {
  int64_t borrow = 0;
  for (uint32_t i = 0; i < a->n; i++) {
    borrow += (int64_t)a->at[i] - (i < b->n ? b->at[i] : 0);
    to->at[i] = (uint32_t)borrow;
    borrow >>= BITS;
  }
  to->n = a->n;
  trim(to);
}

/* --- arithmetic --- */

/* a -= b */
static void subtract(Overflow *w, BigInt *a, const BigInt *b) {
  if (a->n == 0) {
    copy(a, b);
    a->sign = -a->sign;
  } else if (b->n && a->sign != b->sign) add_magnitudes(w, a, b);
  else if (compare(a, b) >= 0) subtract_magnitudes(a, a, b);
  else {
    subtract_magnitudes(a, b, a);
    a->sign = -a->sign;
  }
}

static void multiply(Overflow *w, const BigInt *a, const BigInt *b, BigInt *to) {
  *to = (BigInt){.sign = a->sign * b->sign, .n = a->n && b->n ? a->n + b->n : 0};
  if (to->n > LIMBS) {
    w->overflow = 1;
    to->n = 0;
  }
  for (uint32_t i = 0; i < a->n && to->n; i++) {
    uint64_t carry = 0;
    for (uint32_t k = 0; k < b->n || carry; k++) {
      carry += to->at[i + k] + (k < b->n ? (uint64_t)a->at[i] * b->at[k] : 0);
      to->at[i + k] = (uint32_t)carry;
      carry >>= BITS;
    }
  }
  trim(to);
}

/* a 2^shift, shift < 32 */
static void shift_up(BigInt *a, uint32_t shift) {
  uint64_t carry = 0;
  for (uint32_t i = 0; i < a->n; i++) {
    carry |= (uint64_t)a->at[i] << shift;
    a->at[i] = (uint32_t)carry;
    carry >>= BITS;
  }
  if (carry) a->at[a->n++] = (uint32_t)carry;
}

static void shift_down(BigInt *a, uint32_t shift) {
  for (uint32_t i = 0; i < a->n; i++)
    a->at[i] = (uint32_t)(((uint64_t)a->at[i] | (i + 1 < a->n ? (uint64_t)a->at[i + 1] << BITS : 0)) >> shift);
  trim(a);
}

/* Subtracts q*b from rest[j ..]; where that is negative, adds b back once. Returns the correct quotient digit, q or q - 1. */
static uint32_t subtract_digit(BigInt *rest, uint32_t j, const BigInt *b, uint64_t q) {
  int64_t borrow = 0;
  uint64_t carry = 0;
  for (uint32_t i = 0; i <= b->n; i++) {
    carry += i < b->n ? q * b->at[i] : 0;
    borrow += (int64_t)rest->at[i + j] - (int64_t)(uint32_t)carry;
    rest->at[i + j] = (uint32_t)borrow;
    borrow >>= BITS;
    carry >>= BITS;
  }
  if (!borrow) return (uint32_t)q;
  carry = 0;
  for (uint32_t i = 0; i <= b->n; i++) {
    carry += (uint64_t)rest->at[i + j] + (i < b->n ? b->at[i] : 0);
    rest->at[i + j] = (uint32_t)carry;
    carry >>= BITS;
  }
  return (uint32_t)(q - 1);
}

/* a becomes the remainder of a / divisor, *quotient the quotient; signs as in C. Knuth, The Art of Computer Programming 2, 4.3.1, algorithm D. */
static void divide(Overflow *w, BigInt *a, const BigInt *divisor, BigInt *quotient) {
  BigInt b = *divisor;
  uint32_t shift = 0;
  *quotient = (BigInt){.sign = a->sign * b.sign};
  if (compare(a, &b) < 0) return;
  if (a->n == LIMBS) {
    w->overflow = 1;
    return;
  }
  while (!(b.at[b.n - 1] << shift >> (BITS - 1))) shift++;
  uint32_t n = a->n;
  shift_up(&b, shift);
  shift_up(a, shift);
  for (uint32_t i = a->n; i <= n; i++) a->at[i] = 0;
  uint64_t top = b.at[b.n - 1], next = b.n > 1 ? b.at[b.n - 2] : 0;
  for (uint32_t j = n - b.n + 1; j-- > 0;) {
    uint64_t two = (uint64_t)a->at[j + b.n] << BITS | a->at[j + b.n - 1], q = two / top, rest = two % top;
    uint64_t below = b.n > 1 ? a->at[j + b.n - 2] : 0;
    for (; q > UINT32_MAX || (rest <= UINT32_MAX && q * next > (rest << BITS | below)); rest += top) q--;
    quotient->at[j] = subtract_digit(a, j, &b, q);
  }
  quotient->n = n - b.n + 1;
  a->n = b.n;
  trim(a);
  shift_down(a, shift);
  trim(quotient);
}

/* a becomes the greatest common divisor of a and b; b is destroyed. */
static void big_gcd(Overflow *w, BigInt *a, BigInt *b) {
  BigInt rest, ignored;
  while (b->n && !w->overflow) {
    divide(w, a, b, &ignored);
    copy(&rest, a);
    copy(a, b);
    copy(b, &rest);
  }
  a->sign = 1;
}

/* --- numbers --- */

static Num num_of(const BigInt *x) {
  Num value = num_int(0), base = num_int((int64_t)1 << BITS);
  for (uint32_t i = x->n; i-- > 0;) {
    value = num_mul(value, base);
    value = num_add(value, num_int(x->at[i]));
  }
  return x->sign < 0 ? num_neg(value) : value;
}

static Num ratio(Overflow *w, const BigInt *top, const BigInt *bottom) {
  BigInt common = *top, other = *bottom, n = *top, d = *bottom, above, below;
  big_gcd(w, &common, &other);
  divide(w, &n, &common, &above);
  divide(w, &d, &common, &below);
  Num x = num_of(&above);
  return num_div(x, num_of(&below));
}

/* --- the system --- */

/* Multiplies a row by the common denominator of its entries: integers. */
static void scale_to_integers(Overflow *w, uint32_t n, const Num *from, const BigInt *common, BigInt *to) {
  for (uint32_t k = 0; k < n; k++) {
    BigInt scaled, factor, number = big_int(from[k].num), denominator = big_int(from[k].den), all = *common;
    divide(w, &all, &denominator, &factor);
    multiply(w, &factor, &number, &scaled);
    copy(&to[k], &scaled);
  }
}

/* common becomes its least common multiple with the denominators of from[n]. Returns 0 where a number is not exact. */
static int add_denominators(Overflow *w, uint32_t n, const Num *from, BigInt *common) {
  for (uint32_t k = 0; k < n; k++) {
    if (!num_is_exact(from[k])) return 0;
    BigInt shared = *common, denominator = big_int(from[k].den), other = denominator, factor, product;
    big_gcd(w, &shared, &other);
    divide(w, &denominator, &shared, &factor);
    multiply(w, common, &factor, &product);
    copy(common, &product);
  }
  return 1;
}

/* Exchanges a row with a pivot in column k into row k. Returns 0 where there is none. */
static int exchange(Arena *a, uint32_t n, uint32_t width, BigInt *m, uint32_t k) {
  uint32_t from = k;
  while (from < n && !m[(size_t)from * width + k].n) from++;
  if (from == n) return 0;
  if (from == k) return 1;
  size_t size = width * sizeof *m;
  BigInt *kept = ARENA_ARRAY(a, BigInt, width);
  memcpy(kept, m + (size_t)k * width, size);
  memcpy(m + (size_t)k * width, m + (size_t)from * width, size);
  memcpy(m + (size_t)from * width, kept, size);
  return 1;
}

/* Eliminates column k from all rows but row k; every entry is divided, exactly, by the previous pivot. */
static void eliminate(Overflow *w, uint32_t n, uint32_t width, BigInt *m, uint32_t k, const BigInt *before) {
  const BigInt *pivot = m + (size_t)k * width;
  BigInt one, other, factor;
  for (uint32_t i = 0; i < n; i++) {
    BigInt *row = m + (size_t)i * width;
    if (i == k) continue;
    copy(&factor, &row[k]);
    for (uint32_t j = 0; j < width && !w->overflow; j++) {
      multiply(w, &pivot[k], &row[j], &one);
      multiply(w, &factor, &pivot[j], &other);
      subtract(w, &one, &other);
      divide(w, &one, before, &row[j]);
    }
  }
}

int rational_solve(Arena *a, uint32_t n, const Num *A, uint32_t columns, const Num *B, Num *X) {
  Overflow w = {0};
  uint32_t width = n + columns;
  BigInt *m = ARENA_ARRAY(a, BigInt, (size_t)n * width + 1), before = big_int(1);
  for (size_t i = 0; i < n; i++) {
    BigInt common = big_int(1);
    if (!add_denominators(&w, n, A + i * n, &common) || !add_denominators(&w, columns, B + i * columns, &common)) return 0;
    scale_to_integers(&w, n, A + i * n, &common, m + i * width);
    scale_to_integers(&w, columns, B + i * columns, &common, m + i * width + n);
  }
  for (uint32_t k = 0; k < n && !w.overflow; k++) {
    if (!exchange(a, n, width, m, k)) return 0;
    eliminate(&w, n, width, m, k, &before);
    copy(&before, &m[(size_t)k * width + k]);
  }
  for (size_t i = 0; i < n && !w.overflow; i++)
    for (size_t j = 0; j < columns; j++) X[i * columns + j] = ratio(&w, &m[i * width + n + j], &m[i * width + i]);
  return !w.overflow;
}
