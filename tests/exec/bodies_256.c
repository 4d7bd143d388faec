/* 256 gravitating bodies: what lagc emitted against loops over all ordered pairs, in long double.
 *
 * The bound is that of a sum of n terms in any order, n*2^-53 of the terms' sizes (Higham, Accuracy and Stability of
 * Numerical Algorithms, 2nd ed., section 4.2), and 30 roundings of each term. */
#include <math.h>
#include <stdio.h>

#include "lag_model.h"

extern const lag_scene bodies_drift;
enum { N = 256 };

static double q[3*N], v[3*N], p[N + 8], a[3*N], room[1024], energy[2];

static int check_accelerations(void) {
  for (int i = 0; i < N; i++) {
    long double want[3] = {0}, size[3] = {0};
    for (int j = 0; j < N; j++) {
      if (j == i) continue;
      long double d[3], d2 = (long double)p[N + 1]*p[N + 1];
      for (int k = 0; k < 3; k++) d[k] = (long double)q[3*j + k] - q[3*i + k], d2 += d[k]*d[k];
      for (int k = 0; k < 3; k++) {
        want[k] += p[N]*p[j]*d[k]/(d2*sqrtl(d2));
        size[k] += fabsl(p[N]*p[j]*d[k]/(d2*sqrtl(d2)));
      }
    }
    for (int k = 0; k < 3; k++)
      if (!(fabsl(a[3*i + k] - want[k]) <= (N + 30)*0x1p-53L*size[k])) {
        printf("body %d, component %d: %.17g, by hand %.17Lg\n", i + 1, k, a[3*i + k], want[k]);
        return 1;
      }
  }
  return 0;
}

static int check_energy(void) {
  long double T = 0, V = 0;
  for (int i = 0; i < N; i++) {
    for (int k = 0; k < 3; k++) T += p[i]*(long double)v[3*i + k]*v[3*i + k]/2;
    for (int j = 0; j < i; j++) {
      long double d2 = (long double)p[N + 1]*p[N + 1];
      for (int k = 0; k < 3; k++) d2 += ((long double)q[3*i + k] - q[3*j + k])*((long double)q[3*i + k] - q[3*j + k]);
      V -= p[N]*p[i]*p[j]/sqrtl(d2);
    }
  }
  if (fabsl(energy[0] - (T + V)) <= (N*N/2 + 30)*0x1p-53L*(T - V)) return 0;
  printf("energy %.17g, by hand %.17Lg\n", energy[0], T + V);
  return 1;
}

int main(void) {
  static const unsigned char none[N + 2];
  const lag_model *m = bodies_drift.model;
  if (m->nq != 3*N || m->np != N + 2 || m->nderived > 6 || m->nw > 1024) return 2;
  bodies_drift.params(&bodies_drift, p, none);
  bodies_drift.start(&bodies_drift, p, q, v, NULL);
  /* masses and velocities of their own; the start by its formulas, to rounding of arguments up to 435 */
  for (int i = 0; i < N; i++) {
    const double want[3] = {cos(i + 1), sin(1.7*(i + 1)), sin(0.6*(i + 1))};
    for (int k = 0; k < 3; k++) {
      if (!(fabs(q[3*i + k] - want[k]) <= 435*0x1p-52)) return 3;
      v[3*i + k] = want[(k + 1) % 3]/(i + 2);
    }
    p[i] = 1 + 0.5*want[0];
  }
  if (m->derive) m->derive(m, p);
  if (m->accel(m, 0, q, v, NULL, p, NULL, a, NULL, room) != 0 ||
      m->energy(m, 0, q, v, NULL, p, NULL, energy, room) != 0)
    return 4;
  return check_accelerations() | check_energy();
}
