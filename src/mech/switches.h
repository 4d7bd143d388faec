/* Switching surfaces: where the equations of motion jump or have a corner, by sign, abs, if, min, max or floor of a
 * quantity that varies.
 *
 * A run holds each switch on its present branch, so that no step sees a jump or a corner, finds the time at which
 * the motion meets the surface, and begins anew on the other branch. Where the force jumps with the velocities or
 * states, as under dry friction, and both sides lead back to the surface, the motion slides on it (A.F. Filippov,
 * Differential Equations with Discontinuous Righthand Sides (1988), DOI 10.1007/978-94-015-7793-9); the branch is
 * then a number between -1 and 1 that keeps the switching function at 0. */
#pragma once

#include "mech/eqns.h"

/* Fills e->switches; call before lowering. Programs of models without switches stay as they are. Sides with
 * inputs that have no rate have no switch. */
void switches_find(Eqns *e);

/* The switch of which `side`, or its negative (*sign := -1), is the switching function, or whose floor it is; NULL:
 * none. */
const Switch *switch_of(const Eqns *e, Expr side, int is_floor, int *sign);

/* x rewritten, but for its jumps that the equations contain, too: runs hold both, and know them by their nodes. */
Expr switches_keep(const Eqns *e, Expr x, Expr (*rewrite)(ExprGraph *g, Expr x));

/* Total time derivative of each followed switching function, in accelerations and rates: [e->switches.nmodes]. */
const Expr *switch_rates(const Eqns *e);

/* Power of dry friction: of contacts that slip, and of the generalised forces less the same with sign() of 0 where
 * they jump; 0: there is none. */
Expr switch_power(const Eqns *e);

/* Warns of surfaces on which a motion may stick that runs do not follow. */
void switches_warn(const Eqns *e);
/* Lists the surfaces that runs follow. */
void switches_show(const Eqns *e, StrBuf *out);
