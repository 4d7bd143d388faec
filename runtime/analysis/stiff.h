/* Is a model stiff for an explicit method? Enters: a simulation ready to run; leaves: how many of its steps stability limits,
 * and not the tolerance. */
#ifndef LAG_ANALYSIS_STIFF_H
#define LAG_ANALYSIS_STIFF_H

#include "lag.h"

typedef struct Stiffness {
  int looked, limited; /* at so many steps; at so many of them h*rho was near the bound of stability, or past it */
} Stiffness;

/* Runs `trial`, of an explicit method, towards `until` for at most 600 steps, and compares each with the method's `bound` of
 * stability on the negative real axis. Needs the model's linearisation. The trial is used up, whatever ends it. LAG_OK or
 * LAG_ENOMEM. Source of the criterion, and of the bounds 3.3 of rk45 and 6.1 of dop853: Hairer, Wanner, Solving Ordinary
 * Differential Equations II (1996), DOI 10.1007/978-3-642-05221-7, IV.2. */
int lag_stiffness(lag_sim *trial, double until, double bound, Stiffness *s);

/* Whether most of them are. */
int lag_is_stiff(const Stiffness *s);

#endif
