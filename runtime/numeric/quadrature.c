/* Gauss and Radau quadrature: nodes and weights from Legendre's polynomials, by Newton's method: P. Davis, P.
 * Rabinowitz, Methods of Numerical Integration, 2nd ed. (1984), 2.7; M. Abramowitz, I. Stegun, 25.4.29 and 25.4.31.
 * Computed, so no digits to mistype, and as many as the scalar has. */
#include "numeric/quadrature.h"

#include <math.h>

double lag_legendre(int n, double x, double *below) {
  double p = 1, q = 0;
  for (int k = 1; k <= n; k++) {
    double next = ((2 * k - 1) * x * p - (k - 1) * q) / k;
    q = p;
    p = next;
  }
  *below = q;
  return p;
}

/* Half of the zeros is computed and mirrored, so that the rule is symmetric to the last bit. */
void lag_gauss_points(int n, double *c, double *b) {
  for (int i = 0; i < (n + 1) / 2; i++) {
    double below, slope = 1, x = cos(3.141592653589793 * (i + 0.75) / (n + 0.5));
    for (int turn = 0; turn < 10; turn++) {
      double p = lag_legendre(n, x, &below);
      slope = n * (below - x * p) / (1 - x * x);
      x -= p / slope;
    }
    x = 2 * i + 1 == n ? 0 : x;
    lag_legendre(n, x, &below);
    slope = n * below / (1 - x * x); /* where P_n = 0 */
    c[i] = 0.5 - x / 2;
    c[n - 1 - i] = 0.5 + x / 2;
    b[i] = b[n - 1 - i] = 1 / ((1 - x * x) * slope * slope);
  }
}

/* The zeros of P_n - P_(n-1), whose derivative is n (P_n + P_(n-1))/(1 + x), from zeros of Chebyshev's polynomials. */
void lag_radau_points(int n, double *c, double *b) {
  for (int i = 1; i < n; i++) {
    double p, below, x = cos(2 * 3.141592653589793 * (n - i) / (2 * n - 1));
    for (int turn = 0; turn < 10; turn++) {
      p = lag_legendre(n, x, &below);
      x -= (p - below) * (1 + x) / (n * (p + below));
    }
    lag_legendre(n, x, &below);
    c[i - 1] = 0.5 + x / 2;
    b[i - 1] = (1 + x) / (2 * n * n * below * below);
  }
  c[n - 1] = 1;
  b[n - 1] = 1.0 / (n * n);
}
