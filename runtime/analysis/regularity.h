/* Regularity of a place: the reasons why small motion about it means nothing. Both tests evaluate the state at rest and nearby, and leave rest's
 * values undefined. */
#ifndef LAG_ANALYSIS_REGULARITY_H
#define LAG_ANALYSIS_REGULARITY_H

#include "analysis/equilibrium_state.h"

/* Whether the mass matrix is nearly singular here and not nearby: a coordinate loses its meaning, as longitude does at a pole. */
int lag_is_coordinate_pole(Equilibrium *rest);

/* Whether derivatives of forces jump here, or have no limit. */
int lag_is_nonsmooth(Equilibrium *rest);

#endif
