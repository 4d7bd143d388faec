/* Perturbation noise: parameters and unknowns are numbers of 53 bits, so values of a model are known no better than rounding of these lets them
 * be. */
#ifndef LAG_ANALYSIS_PERTURBATION_NOISE_H
#define LAG_ANALYSIS_PERTURBATION_NOISE_H

#include "analysis/equilibrium_state.h"

/* out[] := values at the unknowns x[n] with the parameters of r->sim->pb.p. Not 0: no values. */
typedef int lag_values(Equilibrium *r, const double *x, double *out);

/* noise[count] := sum over all parameters and unknowns of |change of values[count] at x| when one of them changes by DBL_EPSILON of itself;
 * base[count] := the values. With more than 32 parameters and unknowns several are perturbed at once. Perturbations without values are skipped.
 * scratch[count + np + nderived + n]. 0, or the status of `values` at x. */
int lag_perturbation_noise(Equilibrium *r, lag_values *values, const double *x, size_t count, double *base, double *noise, double *scratch);

#endif
