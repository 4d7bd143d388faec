/* Errors of sums by a tree, sum(..., by tree(theta)). */
#pragma once

#include "mech/eqns.h"

/* Says which sums a tree takes, and how far its forces are from direct ones at bodies of the scene's start. */
void far_errors_note(const Eqns *e);
