/* The chain of N rods in absolute angles by hand, in two ways; p: m[N], l[N], g. */
#include <math.h>
#include <string.h>

#include "accel.h"

#ifndef N
#define N 10
#endif

/* Dense: M_ij = mu_max(i,j) l_i l_j cos(th_i - th_j), mu_i the mass from i down, Cholesky's L D L^T in loops. */
ACCEL(dense) {
  const double *m = p, *l = p + N, g = p[2*N];
  double M[N][N], f[N], s[N], c[N], mu = 0; /* of M the part on and above the diagonal */
  for (int i = 0; i < N; i++) s[i] = l[i]*sin(q[i]), c[i] = l[i]*cos(q[i]), f[i] = 0;
  for (int i = N - 1; i >= 0; i--) {
    mu += m[i];
    double x = 0, si = mu*s[i], ci = mu*c[i], v2 = v[i]*v[i];
    for (int j = 0; j < i; j++) {
      double sine = si*c[j] - ci*s[j];
      M[j][i] = ci*c[j] + si*s[j];
      f[j] += sine*v2;
      x += sine*v[j]*v[j];
    }
    M[i][i] = mu*l[i]*l[i];
    f[i] -= x + g*si;
  }
  for (int k = 0; k < N; k++) {
    if (!(M[k][k] > 0)) return -1;
    double inv = M[k][k] = 1/M[k][k];
    for (int i = k + 1; i < N; i++) {
      double x = M[k][i]*inv;
      for (int j = i; j < N; j++) M[i][j] -= x*M[k][j];
      f[i] -= x*f[k];
    }
  }
  for (int k = N - 1; k >= 0; k--) {
    double x = f[k];
    for (int i = k + 1; i < N; i++) x -= M[k][i]*a[i];
    a[k] = x*M[k][k];
  }
  ONLY_QVP;
  return 0;
}

/* Linear cost: the tensions of the rods solve a tridiagonal system, since along rod i the accelerations of its ends
 * differ by -l_i th_i'^2; then each th_i'' follows from the forces across the rod. (A pendulum's case of D. Baraff's
 * constraint forces, SIGGRAPH 1996, doi:10.1145/237170.237226.) */
ACCEL(linear) {
  const double *m = p, *l = p + N, g = p[2*N];
  double e[N], T[N], inv_d[N], across[N]; /* across: sin(th_i - th_(i-1))/m_(i-1) */
  double s0 = sin(q[0]), c0 = cos(q[0]), inv0 = 1/m[0], d = inv0, r = l[0]*v[0]*v[0] + g*c0;
  double first = -g*s0;
  for (int i = 1; i < N; i++) {
    double s = sin(q[i]), c = cos(q[i]), inv = 1/m[i], off = -inv0*(c0*c + s0*s), inv_last = 1/d, x = off*inv_last;
    if (!(d > 0)) return -1;
    across[i] = inv0*(s*c0 - c*s0);
    inv_d[i - 1] = inv_last, T[i - 1] = r, e[i - 1] = x;
    d = inv + inv0 - x*off;
    r = l[i]*v[i]*v[i] - x*r;
    s0 = s, c0 = c, inv0 = inv;
  }
  if (!(d > 0)) return -1;
  double above, here = r/d, below = 0; /* tensions of rods i - 1, i, i + 1 */
  for (int i = N - 1; i > 0; i--) {
    above = T[i - 1]*inv_d[i - 1] - e[i - 1]*here;
    a[i] = (below - above*across[i])/l[i];
    below = here*across[i], here = above;
  }
  a[0] = (first + below)/l[0];
  ONLY_QVP;
  return 0;
}
