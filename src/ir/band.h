/* Symmetric matrices as bands. M[n*n] is row-major with its lower triangle filled; 0 is zero. */
#ifndef LAGC_BAND_H
#define LAGC_BAND_H

#include "ir/prog.h"

/* How far from the diagonal there are entries. */
uint32_t band_width(uint32_t n, const Slot *M);

/* An order [n] in which entries stand near the diagonal: level by level from an end of the graph (E. Cuthill, J. McKee, Proc. 24th
 * Nat. Conf. ACM (1969) 157, DOI 10.1145/800195.805928). M must not fall into blocks. */
const uint32_t *band_order(Arena *a, uint32_t n, const Slot *M);

#endif
