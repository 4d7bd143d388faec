/* Quasi-random sequences: see `points` of lag_extras (lag.h). */
#pragma once

int lag_gsl_points(const char *sequence, int dimensions, long long n, double *u);
