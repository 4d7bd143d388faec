/* Hermite interpolation of a state. Enters: y and f = y' at both ends; leaves: y between. For q three derivatives are known at each end (q, v,
 * a): quintic. For v and z two: cubic (E. Hairer, S. Norsett, G. Wanner, Solving Ordinary Differential Equations I, II.6, eq. 6.7). v is not the
 * derivative of q's quintic: that would magnify errors of q by 1/h. */
#include "lag.h"

static double quintic(double h, double s, double q0, double v0, double a0, double q1, double v1, double a1) {
  double h2 = h * h;
  double d = q1 - q0 - h * v0 - 0.5 * h2 * a0; /* change of position beyond q0, v0, a0 */
  double e = h * (v1 - v0) - h2 * a0;          /* change of velocity beyond a0, times h */
  double f = h2 * (a1 - a0);                   /* change of acceleration, times h^2 */
  double c3 = 10 * d - 4 * e + 0.5 * f, c4 = -15 * d + 7 * e - f, c5 = 6 * d - 3 * e + 0.5 * f;
  return q0 + s * (h * v0 + s * (0.5 * h2 * a0 + s * (c3 + s * (c4 + s * c5))));
}

static double cubic(double h, double s, double y0, double f0, double y1, double f1) {
  double d = y1 - y0, r = 1 - s;
  return y0 + s * (d + r * (r * (h * f0 - d) + s * (d - h * f1)));
}

void lag_hermite(int nq, int nz, double h, double s, const double *y0, const double *f0, const double *y1,
                 const double *f1, double *y) {
  for (int i = 0; i < nq; i++) {
    int j = nq + i;
    y[i] = quintic(h, s, y0[i], y0[j], f0[j], y1[i], y1[j], f1[j]);
  }
  for (int i = nq; i < 2 * nq + nz; i++) y[i] = cubic(h, s, y0[i], f0[i], y1[i], f1[i]);
}
