/* Rank of the constraints at a state and near it, to recognise singular starts. */
#ifndef LAGC_CLAIMS_NEARBY_RANK_H
#define LAGC_CLAIMS_NEARBY_RANK_H

#include "mech/states.h"

/* The larger rank of the constraints: at a state that obeys them, or at one that is a hundredth away and obeys them, too. loose[n]: the
 * constraints determine this coordinate's velocity near the state but not at it, where the rank is smaller. symbols: values by symbol. */
uint32_t nearby_rank(const Eqns *e, StateSolver *solver, const long double *symbols, long double *loose);

#endif
