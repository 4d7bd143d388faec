/* What an L that jumps leaves out of the equations of motion, and of claims on charges. Both come from derivatives of its branches.
 *
 * The motion goes on through a jump as if there were none. That is right where L jumps at a time: a force that is switched. Where the
 * jump is one of coordinates or velocities, or momenta jump, an impulse is missing. A charge is conserved, or balanced, between jumps only,
 * where it jumps itself, or where its symmetry moves the places at which L does. A constraint whose rate jumps has a corner: what happens there is in no equation. */
#ifndef LAGC_DISCONTINUITY_H
#define LAGC_DISCONTINUITY_H

#include "mech/eqns.h"
#include "sym/jump.h"

/* The places where x jumps while inputs follow their formulas. */
ExprJumps discontinuities_of(const Eqns *e, Expr x);

/* Warns of each place of the text where the motion lacks an impulse. */
void discontinuity_warn(const Eqns *e);

#endif
