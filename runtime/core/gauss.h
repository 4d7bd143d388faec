/* Gauss's quadrature, for methods and for what is integrated along a run. */
#ifndef LAG_CORE_GAUSS_H
#define LAG_CORE_GAUSS_H

/* Nodes c[n] in (0, 1), ascending, and weights b[n], to the last digits of a double; order 2 n. */
void lag_gauss_points(int n, double *c, double *b);

/* Legendre's P_n at x, and P_(n-1). */
double lag_legendre(int n, double x, double *below);

#endif
