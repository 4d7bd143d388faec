/* What a program must hold for the methods of integration that it is asked for: derivatives that most methods do without
 * are emitted only for those that need them. */
#ifndef LAGC_WANTS_H
#define LAGC_WANTS_H

#include "cli/options.h"
#include "mech/eqns.h"

/* WANT_... of ir/unit.h for the scene that e was derived for: by its own method and by the one that the command line
 * names, with --method or in the state that --resume goes on from; and what --with says. */
unsigned wants_of(const Eqns *e, const Options *o);

#endif
