/* Radau quadrature: nodes and weights from Legendre's polynomials, as in gauss_points.h; M. Abramowitz, I. Stegun,
 * 25.4.31. Computed, so no digits to mistype, and as many as the scalar has. */
#include "numeric/quadrature.h"

#include <math.h>

#include "numeric/gauss_points.h"

void lag_gauss_points(int n, double *c, double *b) { lag_gauss_rule(n, c, b); }

/* The zeros of P_n - P_(n-1), whose derivative is n (P_n + P_(n-1))/(1 + x), from zeros of Chebyshev's polynomials. */
void lag_radau_points(int n, double *c, double *b) {
  for (int i = 1; i < n; i++) {
    double p, below, x = cos(2 * 3.141592653589793 * (n - i) / (2 * n - 1));
    for (int turn = 0; turn < 10; turn++) {
      p = lag_legendre_at(n, x, &below);
      x -= (p - below) * (1 + x) / (n * (p + below));
    }
    lag_legendre_at(n, x, &below);
    c[i - 1] = 0.5 + x / 2;
    b[i - 1] = (1 + x) / (2 * n * n * below * below);
  }
  c[n - 1] = 1;
  b[n - 1] = 1.0 / (n * n);
}
