/* Places of the text where an impulse is missing in the motion. */
#ifndef LAGC_MECH_DISCONTINUITY_WARNING_H
#define LAGC_MECH_DISCONTINUITY_WARNING_H

#include "mech/eqns.h"

/* Warns of each place in the text where L, a momentum, a constraint's rate or a force jumps and the equations do not tell what follows. */
void discontinuity_warn(const Eqns *e);

#endif
