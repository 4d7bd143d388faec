/* Finds the expression of the text without a finite value that ended a run. */
#ifndef LAGC_JETS_NONFINITE_H
#define LAGC_JETS_NONFINITE_H

#include "ir/unit.h"
#include "mech/eqns.h"

/* number[n] is t, q, v, z, p of the last good state, in the order of the scene's simulator. Searches from there along the motion, for
 * 0.1 (1 + |t|) seconds, for the first expression whose value or derivatives are not finite, and adds a note to the model's diags.
 * 0: none was found, or n does not fit the model. */
int nonfinite_note(const Eqns *e, const IrUnit *u, const double *number, uint32_t n);

#endif
