/* Error bounds of a completed state: how far coordinates and velocities may be from values that obey the constraints
 * exactly, and accelerations and multipliers from the solution of the equations of motion. */
#pragma once

#include "mech/states.h"

typedef struct StateErrorBounds StateErrorBounds;
/* Compiles the equations with bounds on rounding; lives in the model's arena. */
StateErrorBounds *state_error_bounds_new(const Eqns *e);

/* Bounds errors[s] of all symbols at a state that states_complete accepted; infinite where the equations do not
 * determine the symbol, or too many of them are coupled. 0: no bound is known. */
int state_error_bounds_at(StateErrorBounds *w, StateSolver *solver, const long double *symbols, long double *errors);
