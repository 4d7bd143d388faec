/* Regularisation of a singular mass matrix by the constraints, for discrete Lagrangians. */
#pragma once

#include "mech/eqns.h"

/* The term sum of w_k r_k^2/2, with w_k > 0 and r_k the rate of constraint k, contacts left out; for discrete
 * Lagrangians, which solve momenta for velocities. On the constraints the term and its derivatives along admissible
 * motions vanish: neither motion nor multipliers change. The mass matrix gains A^T W A, and is regular where M is
 * regular on the kernel of A. Needs e's mass and constraints. */
Expr regularising_term(const Eqns *e);
