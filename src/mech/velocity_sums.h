/* Long sums of velocities become definitions, as if the user had written lets for them. */
#ifndef LAGC_MECH_VELOCITY_SUMS_H
#define LAGC_MECH_VELOCITY_SUMS_H

#include "sym/expr.h"

/* L with a definition for each long sum that is linear in the velocities and is squared or multiplied by others; L itself where there is none.
 * The linear system then has the sum's rate as an unknown (mech/augmented_system.h) instead of the full matrix of (sum of all x[i]')^2. A sum that contains
 * another one is built on it, so that a chain written without lets gets them back. n: number of coordinates. */
Expr define_velocity_sums(ExprGraph *g, Expr L, uint32_t n);

#endif
