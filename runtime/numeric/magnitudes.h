/* Magnitudes by which states and residuals of constraints are judged. */
#pragma once

/* Whether a quantity is an angle: declared periodic, or in a unit of angles. */
int lag_is_angle(int periodic, const char *unit);

/* Scale of a component from the largest magnitude of its unit: 1 where that is 0, and at least 1 for an angle.
 * periodic: it is an angle, as are those in rad, deg or without a unit. */
double lag_component_scale(double most, int periodic, const char *unit);

/* Order of doubles, for qsort. */
int lag_ascending(const void *a, const void *b);

/* Factor from 0.5 to 1.5 of a displacement, different for each i, so that nothing cancels (golden ratio sequence). */
double lag_uneven(int i);

/* Index of the residual that is largest in units of the rounding of its terms; *times: that number of units. -1, -1:
 * n is 0. */
int lag_worst_residual(int n, const double *residual, const double *terms, double rounding, double *times);
