/* Mobility of a constrained model at its scene's start: degrees of freedom, rank and redundancy of the constraints. */
#ifndef LAGC_CLAIMS_MOBILITY_H
#define LAGC_CLAIMS_MOBILITY_H

#include "mech/eqns.h"

/* Appends the degrees of freedom and a line for each constraint: its kind, and whether it is redundant. Nothing without constraints.
 * 0, reported in the model's diagnostics, when no motion is possible from the start that the scene gives: no state near it obeys the
 * constraints, redundant ones disagree, M is singular on their kernel, or a contact is violated. */
int mobility_show(const Eqns *e, StrBuf *out);

#endif
