/* Numbers for samples (sampling.h). Enters: the number of a sample, and of a dimension; leaves: a number in (0, 1).
 * Holds: nothing is kept between calls. */
#include "sweep/sampling.h"

#include <math.h>

void lag_philox(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4]) {
  enum { ROUNDS = 10 };
  const uint32_t step0 = 0x9E3779B9, step1 = 0xBB67AE85; /* golden ratio, sqrt(3) - 1 */
  const uint64_t times0 = 0xD2511F53, times1 = 0xCD9E8D57;
  uint32_t k0 = key[0], k1 = key[1];
  for (int i = 0; i < 4; i++) out[i] = counter[i];
  for (int i = 0; i < ROUNDS; i++, k0 += step0, k1 += step1) {
    uint64_t a = times0 * out[0], b = times1 * out[2];
    out[0] = (uint32_t)(b >> 32) ^ out[1] ^ k0;
    out[2] = (uint32_t)(a >> 32) ^ out[3] ^ k1;
    out[1] = (uint32_t)b;
    out[3] = (uint32_t)a;
  }
}

/* Streams of one seed. */
enum { VALUES, ORDER };

static void words_at(uint64_t seed, uint64_t i, uint32_t d, uint32_t stream, uint32_t out[4]) {
  const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)},
                 counter[4] = {(uint32_t)i, (uint32_t)(i >> 32), d, stream};
  lag_philox(counter, key, out);
}

double lag_random_at(uint64_t seed, uint64_t i, uint32_t d) {
  uint32_t w[4];
  words_at(seed, i, d, VALUES, w);
  uint64_t bits = ((uint64_t)w[0] << 32 | w[1]) >> 11; /* 53 */
  return ((double)bits + 0.5) / 9007199254740992.0; /* 2^53 */
}

/* Place of i in a random order of 0..n-1: a Feistel network on the smallest even number of bits that holds n,
 * applied until it leads below n. M. Luby, C. Rackoff, SIAM J. Comput. 17 (1988) 373, DOI 10.1137/0217022. */
static uint64_t shuffled(uint64_t seed, uint64_t i, uint64_t n, uint32_t d) {
  enum { ROUNDS = 6 };
  uint32_t half = 1, w[4];
  while (half < 32 && (uint64_t)1 << 2 * half < n) half++;
  uint64_t mask = ((uint64_t)1 << half) - 1;
  do {
    uint64_t left = i >> half, right = i & mask;
    for (uint32_t round = 0; round < ROUNDS; round++) {
      words_at(seed, right, d, ORDER + round, w);
      uint64_t next = left ^ (w[0] & mask);
      left = right;
      right = next;
    }
    i = left << half | right;
  } while (i >= n);
  return i;
}

double lag_hypercube_at(uint64_t seed, uint64_t i, uint64_t n, uint32_t d) {
  return ((double)shuffled(seed, i, n, d) + lag_random_at(seed, i, d)) / (double)n;
}

/* An approximation of four digits, then Newton's method of third order (Halley) on erfc. M. Abramowitz, I. A.
 * Stegun, Handbook of Mathematical Functions (1964), 26.2.23. */
double lag_normal_quantile(double p) {
  const double half = fmin(p, 1 - p), sign = p < 0.5 ? -1 : 1, root_of_2 = 1.41421356237309504880168872420969808,
               root_of_2pi = 2.50662827463100050241576528481104525;
  double t = sqrt(-2 * log(half)),
         x = t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  if (p == 0.5) return 0;
  for (int i = 0; i < 3; i++) {
    double off = (0.5 * erfc(x / root_of_2) - half) * root_of_2pi * exp(0.5 * x * x);
    x += off / (1 + 0.5 * x * off);
  }
  return sign * x;
}
