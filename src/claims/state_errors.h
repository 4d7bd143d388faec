/* Error bounds of a completed state: how far coordinates and velocities may be from values that obey the constraints exactly, and accelerations
 * and multipliers from the solution of the equations of motion. */
#ifndef LAGC_CLAIMS_STATE_ERRORS_H
#define LAGC_CLAIMS_STATE_ERRORS_H

#include "mech/states.h"

typedef struct StateErrors StateErrors;
/* Compiles the equations with bounds on rounding; lives in the model's arena. */
StateErrors *state_errors_new(const Eqns *e);

/* Bounds errors[s] of all symbols at a state that states_complete accepted; infinite where the equations do not determine the symbol, or too many
 * of them are coupled. 0: no bound is known. */
int state_errors_at(StateErrors *w, StateSolver *solver, const long double *symbols, long double *errors);

#endif
