/* gauss_points.h: Gauss's quadrature, to the last digits of the scalar, from Legendre's polynomials by Newton's method:
 * P. Davis, P. Rabinowitz, Methods of Numerical Integration, 2nd ed. (1984), 2.7; M. Abramowitz, I. Stegun, 25.4.29.
 * A kernel (kernels/README.md) that the compiler calls, too: without lag_lanes.h numbers are those of the includer. */
#ifndef LAG_GAUSS_POINTS_H
#define LAG_GAUSS_POINTS_H

#ifndef LAG_C
#include <math.h>
#define LAG_C(x) x
#define LAG_FN(f) f
#ifndef LAG_REAL       /* (as it stands) */
#define LAG_REAL double /* (as it stands) */
#endif
#endif

/* ---- gauss points ---- */

/* Legendre's P_n at x; *below: P_(n-1). */
static inline LAG_REAL lag_legendre_at(int n, LAG_REAL x, LAG_REAL *below) {
  LAG_REAL a = LAG_C(1.0), b = LAG_C(0.0);
  for (int k = 1; k <= n; k++) {
    const LAG_REAL next = ((LAG_REAL)(2*k - 1)*x*a - (LAG_REAL)(k - 1)*b)/(LAG_REAL)k;
    b = a;
    a = next;
  }
  *below = b;
  return a;
}

/* Gauss points and weights of a step of length 1; half of the zeros is mirrored, so that the rule is
 * symmetric to the last bit. */
static inline void lag_gauss_rule(int n, LAG_REAL *c, LAG_REAL *b) {
  const LAG_REAL one = LAG_C(1.0), half = LAG_C(0.5), many = (LAG_REAL)n;
  for (int i = 0; i < (n + 1)/2; i++) {
    LAG_REAL below, slope = one, x = LAG_FN(cos)(LAG_C(3.141592653589793)*((LAG_REAL)i + LAG_C(0.75))/(many + half));
    for (int turn = 0; turn < 10; turn++) {
      const LAG_REAL f = lag_legendre_at(n, x, &below);
      slope = many*(below - x*f)/(one - x*x);
      x -= f/slope;
    }
    if (2*i + 1 == n) x = LAG_C(0.0);
    (void)lag_legendre_at(n, x, &below);
    slope = many*below/(one - x*x);
    c[i] = half - x/LAG_C(2.0);
    c[n - 1 - i] = half + x/LAG_C(2.0);
    b[i] = b[n - 1 - i] = one/((one - x*x)*slope*slope);
  }
}

/* ---- end ---- */
#endif
