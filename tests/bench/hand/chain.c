/* The chain of N rods in absolute angles by hand, in two ways; p: m[N], l[N], g. */
#include <math.h>

#include "accel.h"

#ifndef N
#define N 10
#endif

/* Dense: M_ij = mu_max(i,j) l_i l_j cos(th_i - th_j), mu_i the mass from i down, by L D L^T; forces by sums from
 * both ends, since sin(th_i - th_j) falls apart into products. Up to 12 rods the compiler unrolls it; then rows go
 * four columns at a time, which GCC does not do by itself at -O2, and code is short enough for the cache of
 * instructions. */
#if N <= 12
#define UNROLL _Pragma("GCC unroll 16")
typedef double Lane;
#else
#define UNROLL
typedef double Lane __attribute__((vector_size(32)));
#endif
#define LANES (unsigned)(sizeof(Lane)/sizeof(double))
#define LONG ((N + LANES - 1)/LANES)
typedef union {
  Lane lane[LONG];
  double at[LONG*LANES];
} Row;

ACCEL(dense) {
  const double *m = p, *l = p + N, g = p[2*N];
  Row M[N], S = {{0}}, C = {{0}}; /* of M the part on and above the diagonal; mu l sin, mu l cos */
  double f[N], s[N], c[N], inv[N], mu = 0, P = 0, Q = 0;
  for (int i = 0; i < N; i++) s[i] = l[i]*sin(q[i]), c[i] = l[i]*cos(q[i]);
  UNROLL for (int i = N - 1; i >= 0; i--) { /* what the rods below do to rod i */
    mu += m[i];
    S.at[i] = mu*s[i], C.at[i] = mu*c[i];
    f[i] = c[i]*Q - s[i]*P - g*S.at[i];
    P += C.at[i]*v[i]*v[i], Q += S.at[i]*v[i]*v[i];
  }
  P = Q = 0;
  UNROLL for (int i = 0; i < N; i++) { /* and those above */
    f[i] += C.at[i]*Q - S.at[i]*P;
    P += c[i]*v[i]*v[i], Q += s[i]*v[i]*v[i];
    UNROLL for (unsigned j = (unsigned)i/LANES; j < LONG; j++) M[i].lane[j] = s[i]*S.lane[j] + c[i]*C.lane[j];
  }
  UNROLL for (int k = 0; k < N; k++) {
    if (!(M[k].at[k] > 0)) return -1;
    inv[k] = 1/M[k].at[k];
    UNROLL for (int i = k + 1; i < N; i++) {
      const double x = M[k].at[i]*inv[k];
      UNROLL for (unsigned j = (unsigned)i/LANES; j < LONG; j++) M[i].lane[j] -= x*M[k].lane[j];
      f[i] -= x*f[k];
    }
  }
  UNROLL for (int k = N - 1; k >= 0; k--) {
    const double x = a[k] = f[k]*inv[k];
    UNROLL for (int i = 0; i < k; i++) f[i] -= M[i].at[k]*x;
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
