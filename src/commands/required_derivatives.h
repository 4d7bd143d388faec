/* Required derivatives: those that the requested methods of integration need. Most methods need none, so that programs
 * leave them out otherwise. */
#ifndef LAGC_COMMANDS_REQUIRED_DERIVATIVES_H
#define LAGC_COMMANDS_REQUIRED_DERIVATIVES_H

#include "commands/options.h"
#include "mech/eqns.h"

/* Flags WANT_... (ir/unit.h) for the scene of e: by its own method, by the method of --method or of the state of
 * --resume, and by --with. */
unsigned derivatives_required(const Eqns *e, const Options *o);

#endif
