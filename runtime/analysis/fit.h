/* Parameters and starts from a measured motion: nonlinear least squares on exact sensitivities. */
#pragma once

#include "analysis/fit_problem.h"

/* Fits. LAG_OK; or a status with its reason in f->why: the first motion fails, or fewer values than targets. Needs
 * target, column, t, data, errors and the members before them; allocates the rest. */
int lag_fit(Fit *f);
void lag_fit_free(Fit *f);
/* fit_profile.c: after a fit, low and high of each determined target: where the sum of squares, least over all others,
 * has grown by the 95 % quantile (D. M. Bates, D. G. Watts, Nonlinear Regression Analysis, 1988, ch. 6). LAG_OK, or
 * LAG_ENOMEM. */
int lag_fit_profile(Fit *f);
/* For profiles: a search over all rows from x; the sum of squares there. */
int lag_fit_search(Fit *f, double *x);
int lag_fit_squares(Fit *f, const double *x, double *chi_squared);
