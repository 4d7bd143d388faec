/* Common denominators: the entries of a row in echelon form share a denominator with more digits than one entry can tell, but all of them together
 * tell it. */
#ifndef LAGC_SYMMETRY_LATTICE_REDUCTION_H
#define LAGC_SYMMETRY_LATTICE_REDUCTION_H

#include <stdint.h>

#include "base/dense.h"

/* The least q > 0 such that all q x[i] are whole numbers, up to the rounding of n 16-digit inputs; 0: there is none below about 1e15. */
int64_t common_denominator(Arena *a, const long double *x, uint32_t n);

/* Short rows of whole numbers in the span of `space`, which is brought to echelon form: to[n*width], n <= space->n. A block of the space is left
 * out if it has no such rows, more than eight rows, or more than forty distinct columns. Returns their number. */
uint32_t integer_rows(Arena *a, DenseRows *space, int64_t *to);

#endif
