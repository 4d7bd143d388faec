/* Forms without t of equations from which it drops out, as in rotating coordinates written with cos(w*t). */
#pragma once

#include "mech/eqns.h"

/* Brings M, f, flows and constraints to forms without t, each entry where that is possible; then L, if none is left. */
void drop_idle_time(Eqns *e);
