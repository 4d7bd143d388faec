#ifndef LAGC_BESIDE_H
#define LAGC_BESIDE_H

#include "mech/states.h"

/* The rank of the constraints a hundredth beside a state that obeys them, or there, whichever is more. loose[n]: beside it the velocity of
 * this coordinate is determined, and at the state, which has a smaller rank, it is not. symbols: values by symbol. */
uint32_t rank_beside(const Eqns *e, StateSolver *solver, const long double *symbols, unsigned char *loose);

#endif
