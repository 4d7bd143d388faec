/* Fractions, recognised together: each entry of a row in echelon form has as many digits as all of them need, but their common denominator
 * is told by all. */
#ifndef LAGC_NOETHER_FRACTION_H
#define LAGC_NOETHER_FRACTION_H

#include <stdint.h>

#include "base/arena.h"

/* The least q > 0 such that all q x[i] are whole numbers but for what is left of n values of about 16 digits; 0: there is none below 1e15 or so. */
int64_t common_denominator(Arena *a, const long double *x, uint32_t n);

#endif
