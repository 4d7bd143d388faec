/* Equilibria: q' = 0 and every force balanced. Enters: a simulation before its first step; leaves: the state where it would stay. */
#ifndef LAG_ANALYSIS_EQUILIBRIUM_H
#define LAG_ANALYSIS_EQUILIBRIUM_H

#include "analysis/equilibrium_state.h"

/* Finds an equilibrium from the simulation's start (velocities do not matter) by algebra->root, stable or not. If none is within one scale of
 * the start, it follows the overdamped motion, with all inertia replaced by friction, to rest; it takes any other root last. Unknowns that no
 * force determines keep their start. The model must not depend on time. 1: found. 0: not found, see worst and rate. < 0: a status; LAG_EDOMAIN
 * and others from the model: no values at the start. Call lag_equilibrium_free in every case. */
int lag_equilibrium_find(Equilibrium *rest, lag_sim *sim, const lag_algebra *algebra);
void lag_equilibrium_free(Equilibrium *rest);

/* Whether the state at rest moved by c dx[n] (in SI) is a root, or indistinguishable from one. */
int lag_equilibrium_holds(Equilibrium *rest, const double *dx, double c);

/* Whether another equilibrium lies near that place, nearer to it than to the first one: then they form a curve. */
int lag_equilibrium_continues(Equilibrium *rest, const lag_algebra *algebra, const double *dx, double c);

#endif
