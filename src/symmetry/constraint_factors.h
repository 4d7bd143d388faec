/* Factors of constraints that are products: where c = f1 f2 .. = 0 holds, a factor is 0, and each factor has its own set of states. */
#ifndef LAGC_SYMMETRY_CONSTRAINT_FACTORS_H
#define LAGC_SYMMETRY_CONSTRAINT_FACTORS_H

#include "mech/eqns.h"

typedef struct ConstraintFactors ConstraintFactors;

/* The factors of the holonomic constraints, contacts left out, in which two or more factors contain coordinates and may be 0. */
ConstraintFactors *constraint_factors_new(const Eqns *e);

uint32_t constraint_factors_count(const ConstraintFactors *p);
Expr constraint_factors_at(const ConstraintFactors *p, uint32_t part);

/* Moves coordinates to a zero of the factor, by Newton's method along its gradient. 0: no convergence from this state. */
int constraint_factors_solve(ConstraintFactors *p, uint32_t part, long double *symbols);

/* Whether the factor is 0 at the state, up to rounding. */
int constraint_factors_is_zero(ConstraintFactors *p, uint32_t part, const long double *symbols);

#endif
