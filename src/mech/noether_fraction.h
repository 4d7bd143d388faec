/* Fractions with one denominator, recognised together: each entry of a row in echelon form has as many digits as all of them need, but the
 * common denominator is told by all. */
#ifndef LAGC_NOETHER_FRACTION_H
#define LAGC_NOETHER_FRACTION_H

#include "base/num.h"

#include <stdint.h>

/* The least q > 0 such that all q x[i] are whole numbers but for what is left of n values of about 16 digits; 0: there is none below 1e15 or so. */
int64_t common_denominator(const long double *x, uint32_t n);

#endif
