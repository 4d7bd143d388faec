/* Gauss's and Radau's quadrature, for methods and for what is integrated along a run. */
#ifndef LAG_CORE_GAUSS_H
#define LAG_CORE_GAUSS_H

/* Nodes c[n] in (0, 1), ascending, and weights b[n], to the last digits of a double; order 2 n. */
void lag_gauss_points(int n, double *c, double *b);

/* Nodes in (0, 1], the last of which is 1; order 2 n - 1. */
void lag_radau_points(int n, double *c, double *b);

/* Legendre's P_n at x, and P_(n-1). */
double lag_legendre(int n, double x, double *below);

#endif
