/* Which contacts with friction stay closed, and which of them stick: Coulomb's law on accelerations, in one tangential direction for each contact. */
#pragma once

#include "contacts/cone_forces.h"

/* Rows 0..n-1 are gaps, behind them the tangents: accelerations are W[rows rows] x + pull for forces x[rows]. Fills in mode, to, shared and x. A contact sticks
 * where some forces that hold it obey Coulomb's law; at rest, with a larger static friction, as few contacts begin to slip as can. Returns the number of motions, 0, 1 or 2: none (Painleve's paradox, where friction is large), one, or more than one. room[rows (rows + 5)] is scratch. All
 * combinations are tried, at most 4^n: n <= LAG_MOST_TOUCHES. P. Loetstedt, SIAM J. Appl. Math. 42 (1982) 281, DOI 10.1137/0142022. */
int lag_contact_modes(int n, lag_touch *of, int rows, const double *W, const double *pull, double *x, double *room);
