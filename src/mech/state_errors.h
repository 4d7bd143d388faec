/* How far a completed state may be from one that obeys the equations exactly: bounds for its coordinates and velocities, which constraints
 * hold, and for its accelerations and multipliers. */
#ifndef LAGC_STATE_ERRORS_H
#define LAGC_STATE_ERRORS_H

#include "mech/states.h"

typedef struct StateErrors StateErrors;
StateErrors *state_errors_new(const Eqns *e);

/* errors[s] of each symbol at a state that states_complete accepted: infinite where the equations do not determine it, or too many of
 * them are coupled. 0: no bound is known. */
int state_errors_at(StateErrors *w, StateSolver *solver, const long double *symbols, long double *errors);

#endif
