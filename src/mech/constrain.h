/* Constraints: Model -> the equations that they add. */
#ifndef LAGC_CONSTRAIN_H
#define LAGC_CONSTRAIN_H

#include "mech/eqns.h"

/* Fills e->constraints and adds A^T lambda to e->f. 0, reported, when a constraint is not linear in velocities, contains no
 * coordinate, contradicts another, or when there are more than coordinates. */
int constrain(Eqns *e);

/* Whether their forces do no work on any motion that obeys them: q'.A^T lambda = -lambda.b is zero, b = 0. */
int constraints_do_no_work(const Eqns *e);

/* For programs that have no place for what constraints on velocities keep, as emitted headers: these are then held as what they say. */
void constraints_keep_none(Eqns *e);

#endif
