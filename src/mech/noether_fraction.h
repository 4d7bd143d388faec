/* Fractions, recognised together: each entry of a row in echelon form has as many digits as all of them need, but their common denominator
 * is told by all. */
#ifndef LAGC_NOETHER_FRACTION_H
#define LAGC_NOETHER_FRACTION_H

#include <stdint.h>

#include "base/dense.h"

/* The least q > 0 such that all q x[i] are whole numbers but for what is left of n values of about 16 digits; 0: there is none below 1e15 or so. */
int64_t common_denominator(Arena *a, const long double *x, uint32_t n);

/* Short rows of whole numbers in the space that rows span, which are brought to echelon form: to[n*width], for at most space->n of them. They
 * need not span all of it: a part that has none is left out, and one with more than eight rows, or forty different columns. Returns how many there are. */
uint32_t whole_rows(Arena *a, DenseRows *space, int64_t *to);

#endif
