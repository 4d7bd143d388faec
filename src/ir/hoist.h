/* Derived parameters: values that depend on parameters alone are computed when parameters change, not at each call. A constant mass
 * matrix that is eliminated in straight-line code is factored then, too. */
#ifndef LAGC_IR_HOIST_H
#define LAGC_IR_HOIST_H

#include "ir/unit.h"

/* Moves such values from the programs that a step calls to u->derived, and leaves loads of parameters u->p.n, u->p.n + 1, ... in their
 * place. Only for emitted models, whose callers compute derived parameters; call once, after all programs are made. Checks of pivots
 * stay where they are. */
void unit_hoist(IrUnit *u);

#endif
