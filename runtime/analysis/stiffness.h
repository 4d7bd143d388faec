/* Stiffness of a model for an explicit method. Enters: a simulation ready to run; leaves: how many of its steps are limited by stability, not by
 * the tolerance. */
#ifndef LAG_ANALYSIS_STIFFNESS_H
#define LAG_ANALYSIS_STIFFNESS_H

#include "lag.h"

typedef struct Stiffness {
  int steps, looked, limited; /* steps made; of these examined; of these with h*rho near or past the stability bound. In a trial that gets past
                               * half of its steps, only later ones count */
  int unfinished;             /* 1: the trial ended at its largest number of steps */
  double needed;              /* least number of steps of an explicit method at its stability bound: the sum of h*rho/bound */
  double calls, until;        /* right-hand sides computed; time reached */
} Stiffness;

/* Runs `trial` towards `until` for at most `most` steps, and compares each with an explicit method's `bound` of stability on the negative real
 * axis. A mode that grows in the direction of the run does not count: backwards, a stiff model is not stiff. Needs the model's linearisation.
 * Uses up the trial, however it ends. LAG_OK or LAG_ENOMEM. Source of the criterion, and of the bounds 3.3 of rk45 and 6.1 of dop853: Hairer,
 * Wanner, Solving Ordinary Differential Equations II (1996), DOI 10.1007/978-3-642-05221-7, IV.2. */
int lag_stiffness(lag_sim *trial, double until, double bound, int most, Stiffness *s);

/* After a trial of an explicit method: whether stability limits most of its steps. */
int lag_is_stiff(const Stiffness *s);

/* After a trial of radau, with n components of the state: whether its steps are so far past the bound that it is much cheaper than dop853 can
 * be. At tight tolerances rounding or a transient may limit an explicit method's first steps far below the stability bound; this test still sees
 * stiffness. Costs are right-hand sides, 12 a step of dop853; radau's Jacobian and decompositions count as n of them. */
int lag_exceeds_stability(const Stiffness *s, int n);

#endif
