/* Warnings for a discontinuous L: equations of motion and charges come from derivatives of its branches and lack
 * impulses at the jumps.
 *
 * The motion goes through a jump as if there were none. That is right where L jumps at a time, as with a switched
 * force. An impulse is missing where L jumps with coordinates or velocities, or where a momentum jumps. A charge is
 * conserved, or balanced, between jumps only, if the charge itself jumps or its symmetry moves the places where L
 * does. A constraint whose rate jumps has a corner, at which no equation holds. */
#pragma once

#include "mech/eqns.h"
#include "sym/jump.h"

/* The jumps of x, with inputs replaced by their formulas. */
ExprJumps discontinuities_of(const Eqns *e, Expr x);

/* Warns of each place in the text where L, a momentum or a constraint's rate jumps and the equations do not tell
 * what follows. */
void discontinuity_warn(const Eqns *e);
