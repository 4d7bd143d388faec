/* Constraints that are products: where they hold, one factor is 0, and each has a part of the states that obey. */
#ifndef LAGC_PARTS_H
#define LAGC_PARTS_H

#include "mech/eqns.h"

typedef struct ConstraintParts ConstraintParts;

/* Of the holonomic constraints that always hold, c = f1 f2 .. with two or more factors made of coordinates: all such factors, but those whose sign is
 * known. */
ConstraintParts *parts_new(const Eqns *e);

uint32_t parts_count(const ConstraintParts *p);
Expr parts_factor(const ConstraintParts *p, uint32_t part);

/* Moves coordinates until the factor is 0. 0: that does not succeed from this state. */
int parts_go(ConstraintParts *p, uint32_t part, long double *symbols);

/* Whether the factor is 0 there, but for rounding. */
int parts_is_on(ConstraintParts *p, uint32_t part, const long double *symbols);

#endif
