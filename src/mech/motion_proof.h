/* Proofs about motions: expressions that are 0 where the equations of motion and the constraints hold. */
#pragma once

#include "mech/eqns.h"
#include "sym/verdict.h"

/* Whether two sides are equal by the equations of motion: accelerations and multipliers solved for, or a combination of
 * rows of M q'' = f + A^T lambda, A q'' = demand and r = 0; rates and the energy substituted. */
Verdict prove_by_motion(const Eqns *e, Expr lhs, Expr rhs);

/* Whether x is rounding at random states that obey the constraints, with accelerations and multipliers of the
 * motion. */
int motion_vanishes(const Eqns *e, Expr x);

/* Whether x is 0 along all motions. PROVED_NONZERO: it is not at a state that obeys the constraints. */
Verdict motion_verdict(const Eqns *e, Expr x);
