/* Constraints: the equations and forces that they add to a model's equations of motion. */
#pragma once

#include "mech/eqns.h"

/* Fills e->constraints and adds A^T lambda to e->f. 0, reported, when a constraint is not linear in velocities,
 * contains no coordinate or contradicts another, or when there are more constraints than coordinates. */
int constrain(Eqns *e);

/* The contact that stands for this constraint, which holds while the contact is closed; NULL: none. */
const Contact *contact_of_constraint(const Model *m, const Constraint *k);

/* Whether constraint forces do no work on admissible motions: q'.A^T lambda = -lambda.b, so whether b = 0. */
int constraints_do_no_work(const Eqns *e);

/* Treats all constraints on velocities as r = 0, for emitted headers, which cannot store the values of F at the
 * start. */
void constraints_keep_none(Eqns *e);
