/* Band orders of symmetric matrices. M[n*n] is row-major with its lower triangle filled; 0 is a structural zero. */
#ifndef LAGC_BAND_H
#define LAGC_BAND_H

#include "ir/prog.h"

/* Half the band width: the largest distance of an entry from the diagonal. */
uint32_t band_width(uint32_t n, const Slot *M);

/* An order [n] that brings entries near the diagonal: level by level from an end of the graph (E. Cuthill, J. McKee, Proc. 24th
 * Nat. Conf. ACM (1969) 157, DOI 10.1145/800195.805928). The graph of M must be connected. */
const uint32_t *band_order(Arena *a, uint32_t n, const Slot *M);

#endif
