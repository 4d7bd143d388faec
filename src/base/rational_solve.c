/* Exact linear systems modulo three primes: two make the fractions (P. S. Wang, SYMSAC 1981, DOI 10.1145/800206.806398), the third confirms them. */
#include "base/rational_solve.h"

#include <math.h>
#include <string.h>

__extension__ typedef unsigned __int128 Product;
__extension__ typedef __int128 Wide;

enum { PRIMES = 3 };
static const uint64_t primes[PRIMES] = {4611686018427387847u, 4611686018427387817u, 4611686018427387787u}; /* the largest below 2^62 */
static const uint64_t MOST = (uint64_t)1 << 61; /* numerators and denominators up to here are unique modulo two primes */

static uint64_t multiply(uint64_t a, uint64_t b, uint64_t p) { return (uint64_t)((Product)a * b % p); }
static uint64_t subtract(uint64_t a, uint64_t b, uint64_t p) { return a >= b ? a - b : a + p - b; }

/* 1/a = a^(p - 2), by Fermat. */
static uint64_t inverse(uint64_t a, uint64_t p) {
  uint64_t r = 1;
  for (uint64_t n = p - 2; n; n >>= 1, a = multiply(a, a, p))
    if (n & 1) r = multiply(r, a, p);
  return r;
}

static uint64_t residue(int64_t x, uint64_t p) {
  uint64_t size = (x < 0 ? (uint64_t)0 - (uint64_t)x : (uint64_t)x) % p;
  return x < 0 ? subtract(0, size, p) : size;
}

/* Gauss-Jordan elimination of m[n*width] modulo p. Returns 0 where its first n columns are singular. */
static int eliminate(uint32_t n, uint32_t width, uint64_t *m, uint64_t p) {
  for (size_t k = 0; k < n; k++) {
    size_t from = k;
    while (from < n && !m[from * width + k]) from++;
    if (from == n) return 0;
    uint64_t *pivot = m + k * width, scale = inverse(m[from * width + k], p);
    for (size_t j = 0; j < width; j++) {
      uint64_t x = m[from * width + j];
      m[from * width + j] = pivot[j];
      pivot[j] = multiply(x, scale, p);
    }
    for (size_t i = 0; i < n; i++) {
      uint64_t *row = m + i * width, factor = row[k];
      for (size_t j = k; j < width && i != k && factor; j++) row[j] = subtract(row[j], multiply(factor, pivot[j], p), p);
    }
  }
  return 1;
}

/* [A B] modulo p, eliminated; NULL where a number is not exact, or A is singular. */
static uint64_t *solve_modulo(Arena *a, uint32_t n, const Num *A, uint32_t columns, const Num *B, uint64_t p) {
  uint32_t width = n + columns;
  uint64_t *m = ARENA_ARRAY(a, uint64_t, (size_t)n * width + 1);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < width; j++) {
      Num x = j < n ? A[i * n + j] : B[i * columns + j - n];
      if (!num_is_exact(x)) return NULL;
      m[i * width + j] = x.den == 1 ? residue(x.num, p) : multiply(residue(x.num, p), inverse(residue(x.den, p), p), p);
    }
  return eliminate(n, width, m, p) ? m : NULL;
}

/* *x := the fraction with these residues, by Euclid's algorithm. Returns 0 where there is none up to MOST. */
static int fraction(const uint64_t r[PRIMES], Num *x) {
  uint64_t p = primes[0], q = primes[1];
  Product above = (Product)p * q, below = (Product)p * multiply(subtract(r[1], r[0] % q, q), inverse(p % q, q), q) + r[0];
  Wide before = 0, factor = 1;
  while (below > MOST) {
    Product times = above / below, rest = above % below;
    Wide next = before - (Wide)times * factor;
    above = below;
    below = rest;
    before = factor;
    factor = next;
  }
  if (factor == 0 || factor > (Wide)MOST || factor < -(Wide)MOST) return 0;
  *x = num_ratio(factor < 0 ? -(int64_t)below : (int64_t)below, factor < 0 ? -(int64_t)factor : (int64_t)factor);
  return num_is_exact(*x) && residue(x->num, primes[2]) == multiply(r[2], residue(x->den, primes[2]), primes[2]);
}

/* Columns of X, [n*(n + columns)] behind the unit matrix, by Gauss-Jordan elimination of numbers that keep error bounds and residues. */
static Num *solve_rounded(Arena *a, uint32_t n, const Num *A, uint32_t columns, const Num *B) {
  uint32_t width = n + columns;
  Num *m = ARENA_ARRAY(a, Num, (size_t)n * width + 1);
  for (size_t i = 0; i < n; i++) {
    memcpy(m + i * width, A + i * n, n * sizeof *m);
    memcpy(m + i * width + n, B + i * columns, columns * sizeof *m);
  }
  for (size_t k = 0; k < n; k++) {
    size_t best = k;
    for (size_t i = k; i < n; i++)
      if (fabs(num_value(m[i * width + k])) > fabs(num_value(m[best * width + k]))) best = i;
    Num *pivot = m + k * width, by = m[best * width + k];
    for (size_t j = 0; j < width; j++) {
      Num x = m[best * width + j];
      m[best * width + j] = pivot[j];
      pivot[j] = num_div(x, by);
    }
    for (size_t i = 0; i < n; i++) {
      Num *row = m + i * width, factor = row[k];
      for (size_t j = k; j < width && i != k && !num_is_zero(factor); j++) row[j] = num_sub(row[j], num_mul(factor, pivot[j]));
    }
  }
  return m;
}

int rational_solve(Arena *a, uint32_t n, const Num *A, uint32_t columns, const Num *B, Num *X) {
  uint64_t *m[PRIMES];
  const Num *rounded = NULL;
  Num *out = ARENA_ARRAY(a, Num, (size_t)n * columns + 1);
  for (int k = 0; k < PRIMES; k++)
    if (!(m[k] = solve_modulo(a, n, A, columns, B, primes[k]))) return 0;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < columns; j++) {
      size_t at = i * (n + columns) + n + j;
      if (fraction((const uint64_t[]){m[0][at], m[1][at], m[2][at]}, &out[i * columns + j])) continue;
      if (!rounded) rounded = solve_rounded(a, n, A, columns, B);
      out[i * columns + j] = rounded[at];
    }
  memcpy(X, out, (size_t)n * columns * sizeof *X);
  return 1;
}
