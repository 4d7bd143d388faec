/* Model -> Eqns. */
#pragma once

#include "mech/eqns.h"

/* Derives the equations. NULL, with the reason in m->diags, for example when the mass matrix is singular in every
 * state or the momenta depend on an input (its derivative would be needed). */
Eqns *eqns_derive(const Model *m);

/* The same model where its mass matrix is singular: L gets a term that is 0 on the constraints and gives inertia to
 * coordinates without their own. Discrete Lagrangians, which find velocities from momenta, need it
 * (mech/constraint_regularise.h). */
Eqns *eqns_derive_regularised(const Eqns *singular);

/* 0, with the reason in the model's diagnostics, when a number in the equations or outputs is not finite or has lost
 * its digits. */
int eqns_check_numbers(const Eqns *e);
