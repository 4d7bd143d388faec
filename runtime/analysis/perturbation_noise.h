/* What rounding may change of a model's values: parameters and unknowns are numbers of 53 bits, and what they make can be
 * known no better than that. */
#ifndef LAG_ANALYSIS_PERTURBATION_NOISE_H
#define LAG_ANALYSIS_PERTURBATION_NOISE_H

#include "analysis/rest.h"

/* Values out[] at the unknowns x[n], of the parameters in r->sim->pb.p. Not 0: there are none. */
typedef int lag_values(Rest *r, const double *x, double *out);

/* noise[count] := by how much values[count] at x change when each parameter, and each unknown, changes by DBL_EPSILON times
 * itself: the sum of what each does. base[count] := the values. With 32 parameters and unknowns or fewer it is that sum; of
 * more, several are moved at once. Changes at which there are no values are passed over. scratch[count + np + nderived + n].
 * 0, or what `values` returned at x. */
int lag_blur(Rest *r, lag_values *values, const double *x, size_t count, double *base, double *noise, double *scratch);

#endif
