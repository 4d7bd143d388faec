/* Numbers for samples: the same for a run in any order, on any number of threads and machines. */
#pragma once

#include <stdint.h>

/* out[4] := random words for this counter and key. Philox4x32-10: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E.
 * Shaw, Parallel random numbers: as easy as 1, 2, 3, Proc. SC11 (2011), DOI 10.1145/2063384.2063405. */
void lag_philox(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4]);

/* A number in (0, 1), evenly distributed, for sample i in dimension d of a seed. */
double lag_random_at(uint64_t seed, uint64_t i, uint32_t d);

/* The same with one sample in each of n equal parts of (0, 1): Latin hypercube sampling. M. D. McKay, R. J. Beckman,
 * W. J. Conover, Technometrics 21 (1979) 239, DOI 10.1080/00401706.1979.10489755. i < n. */
double lag_hypercube_at(uint64_t seed, uint64_t i, uint64_t n, uint32_t d);

/* x with normal distribution function p: P(X < x) = p in (0, 1), X of mean 0 and deviation 1; to 16 digits. */
double lag_normal_quantile(double p);
