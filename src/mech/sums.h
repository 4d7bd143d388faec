/* Long sums of velocities as definitions, as if the user had written lets for them. */
#ifndef LAGC_SUMS_H
#define LAGC_SUMS_H

#include "sym/expr.h"

/* L with each long sum that is linear in the velocities, and is squared or multiplied with others, as a definition: by its rate it enters the
 * system that is solved (mech/lift.h), where (sum of all x[i]')^2 would be a full matrix. Sums that contain another one are built on it,
 * so a chain that was written without lets has them again. n: coordinates. L itself where there are none. */
Expr sums_named(ExprGraph *g, Expr L, uint32_t n);

#endif
