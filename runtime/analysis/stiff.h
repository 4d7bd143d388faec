/* Is a model stiff for an explicit method? Enters: a simulation ready to run; leaves: how many of its steps stability limits,
 * and not the tolerance. */
#ifndef LAG_ANALYSIS_STIFF_H
#define LAG_ANALYSIS_STIFF_H

#include "lag.h"

typedef struct Stiffness {
  int steps, looked, limited; /* steps; at so many of them looked; there h*rho was near the bound of stability, or past it. Of a
                               * trial that gets past half of the steps it may take only those after that are counted */
  int unfinished;             /* there were as many steps as there may be */
  double needed;              /* steps that an explicit method would need at least, at its bound of stability: the sum of h*rho/bound */
  double calls, until;        /* right-hand sides, and the time that was reached */
} Stiffness;

/* Runs `trial` towards `until` for at most `most` steps, and compares each with an explicit method's `bound` of stability on the negative
 * real axis. A mode that grows in the direction of the run counts nothing: backwards, what was stiff is not. Needs the model's
 * linearisation. The trial is used up, whatever ends it. LAG_OK or LAG_ENOMEM. Source of the criterion, and of the bounds 3.3 of rk45
 * and 6.1 of dop853: Hairer, Wanner, Solving Ordinary Differential Equations II (1996), DOI 10.1007/978-3-642-05221-7, IV.2. */
int lag_stiffness(lag_sim *trial, double until, double bound, int most, Stiffness *s);

/* Of a trial of an explicit method: whether stability limits most of its steps. */
int lag_is_stiff(const Stiffness *s);

/* Of a trial of radau, with n components of the state: whether its steps are so far past the bound that it is much cheaper than dop853
 * can be. Where the tolerance is tight, rounding or what is left of a transient may limit an explicit method's first steps to far
 * less than stability does, and this sees it all the same. Counted in right-hand sides, 12 a step of dop853; what radau does besides them,
 * a Jacobian and decompositions, counts as n of them. */
int lag_strides(const Stiffness *s, int n);

#endif
