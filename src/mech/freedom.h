/* How freely a constrained model moves where its scene starts. */
#ifndef LAGC_FREEDOM_H
#define LAGC_FREEDOM_H

#include "mech/eqns.h"

/* Appends the degrees of freedom, and a line for each constraint: its kind, and whether it follows from others. Nothing where there are
 * none. 0, reported in the model's diagnostics, when no state that obeys them is found near the start that the scene gives. */
int freedom_show(const Eqns *e, StrBuf *out);

#endif
