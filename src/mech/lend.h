#ifndef LAGC_LEND_H
#define LAGC_LEND_H

#include "mech/eqns.h"

/* For discrete Lagrangians, which find velocities from momenta: sum of w_k r_k^2/2, with w_k > 0 and r_k the rate of constraint k (contacts
 * left out). On the constraints it and its derivatives along any motion that obeys them vanish, so neither motion nor multipliers change;
 * the mass matrix gains A^T W A, and is regular where it was so on the kernel of A. Needs mass and constraints of e. */
Expr lend_inertia(const Eqns *e);

#endif
