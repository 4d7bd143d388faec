/* Coordinates in which the rank of constraints does not depend on units. */
#ifndef LAGC_ALIKE_H
#define LAGC_ALIKE_H

#include "mech/states.h"

/* unit[n] := in which coordinates of one unit have, at most, inertia 1 at a state; those of a unit without inertia count as much as what they are tied
 * to, in the middle among their ties. As lag_units of runtime/include/lag_kkt.h, which decides in a run. */
void alike_units(const Eqns *e, const StateValues *v, long double *unit);

#endif
