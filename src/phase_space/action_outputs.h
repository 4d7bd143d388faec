/* Outputs with `action(x)`: the symbol becomes the momentum where x is cyclic, else an input whose value a run
 * computes on a curve H(q, p) = E. */
#pragma once

#include "mech/eqns.h"

/* Fills e->actions, and value[k] of Model.actions.at[k], 0 where no output contains it. 0, reported at `action(x)`:
 * x has no action at any state. */
int action_outputs(Eqns *e, Expr *value);
