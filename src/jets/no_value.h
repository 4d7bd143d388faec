/* Where a run ended for want of a finite value: which expression of the text has none. */
#ifndef LAGC_NO_VALUE_H
#define LAGC_NO_VALUE_H

#include "ir/unit.h"
#include "mech/eqns.h"

/* number[n] is t, q, v, z, p of the last good state, as the scene's simulator has them. Looks there and along the motion from there, up to a tenth of t and of 1 s,
 * for the first expression without a finite value, or with derivatives that have none; says so in a note of the model's diags. 0: there is none, or n is another. */
int no_value_note(const Eqns *e, const IrUnit *u, const double *number, uint32_t n);

#endif
