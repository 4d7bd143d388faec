/* Regularity of a place: the reasons why small motion about it means nothing. Both tests evaluate the state at rest and nearby, and leave rest's
 * values undefined. */
#ifndef LAG_ANALYSIS_PLACE_H
#define LAG_ANALYSIS_PLACE_H

#include "analysis/equilibrium.h"

/* Whether the mass matrix is nearly singular here and not nearby: a coordinate loses its meaning, as longitude does at a pole. */
int lag_place_is_pole(Rest *rest);

/* Whether derivatives of forces jump here, or have no limit. */
int lag_place_is_rough(Rest *rest);

#endif
