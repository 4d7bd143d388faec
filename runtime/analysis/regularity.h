/* What makes a place unfit for small motion. Both look at the state at rest and beside it, and leave rest's values undefined. */
#ifndef LAG_ANALYSIS_REGULARITY_H
#define LAG_ANALYSIS_REGULARITY_H

#include "analysis/rest.h"

/* Is the mass matrix nearly singular, as it is not beside that place? A coordinate loses its meaning there, as a longitude does
 * at a pole. */
int lag_place_is_pole(Rest *rest);

/* Do derivatives of forces jump there, or have no limit? */
int lag_place_is_rough(Rest *rest);

#endif
