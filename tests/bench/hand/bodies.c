/* N bodies in space by hand, each pair once, and each pair twice without storing what the other body gets; p: m[N],
 * G, soft. */
#include <math.h>

#include "accel.h"

#ifndef N
#define N 256
#endif

ACCEL(pairs) {
  const double *m = p, G = p[N], eps = p[N + 1]*p[N + 1];
  for (int i = 0; i < 3*N; i++) a[i] = 0;
  for (int i = 0; i < N; i++) {
    double ax = 0, ay = 0, az = 0;
    for (int j = 0; j < i; j++) {
      double x = q[3*j] - q[3*i], y = q[3*j + 1] - q[3*i + 1], z2 = q[3*j + 2] - q[3*i + 2];
      double d2 = x*x + y*y + z2*z2 + eps, k = G/(d2*sqrt(d2)), mi = k*m[i], mj = k*m[j];
      ax += mj*x, ay += mj*y, az += mj*z2;
      a[3*j] -= mi*x, a[3*j + 1] -= mi*y, a[3*j + 2] -= mi*z2;
    }
    a[3*i] += ax, a[3*i + 1] += ay, a[3*i + 2] += az;
  }
  ONLY_QVP;
  return 0;
}

ACCEL(ordered) {
  const double *m = p, G = p[N], eps = p[N + 1]*p[N + 1];
  for (int i = 0; i < N; i++) {
    double ax = 0, ay = 0, az = 0;
    for (int j = 0; j < N; j++) { /* where j is i nothing is added */
      double x = q[3*j] - q[3*i], y = q[3*j + 1] - q[3*i + 1], z2 = q[3*j + 2] - q[3*i + 2];
      double d2 = x*x + y*y + z2*z2 + eps, k = G*m[j]/(d2*sqrt(d2));
      ax += k*x, ay += k*y, az += k*z2;
    }
    a[3*i] = ax, a[3*i + 1] = ay, a[3*i + 2] = az;
  }
  ONLY_QVP;
  return 0;
}
