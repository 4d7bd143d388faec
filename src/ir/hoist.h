/* Derived parameters: what depends on parameters alone is computed when those change, not at each call. A constant mass matrix is factored
 * so, too. */
#ifndef LAGC_IR_HOIST_H
#define LAGC_IR_HOIST_H

#include "ir/unit.h"

/* Moves such values out of the programs that a step calls, into u->derived, and leaves loads of the parameters u->p.n, u->p.n + 1, ...
 * in their place. For emitted models, whose callers know of derived parameters; once, when all programs are there. Checks of pivots stay
 * where they are. */
void unit_hoist(IrUnit *u);

#endif
