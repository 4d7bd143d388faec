/* Gauss and Radau quadrature, for methods and for integrals along a run. */
#pragma once

/* Gauss nodes c[n] in (0, 1), ascending, and weights b[n], to the last digits of a double; order 2 n. */
void lag_gauss_points(int n, double *c, double *b);

/* Radau nodes in (0, 1], the last of which is 1, and weights; order 2 n - 1. */
void lag_radau_points(int n, double *c, double *b);
