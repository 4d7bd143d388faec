/* Accelerations of tests/exec/models/windings.lag against its equations, M a + K q = 0, in long double: no solver judges another. */
#include <math.h>
#include <stdio.h>

#include "lag_model.h"

#ifndef LAG_LANES
enum { LANES = 1 };
#else
enum { LANES = LAG_LANES };
#endif
enum { MOST = 40 };
extern const lag_scene SCENE;
static LAG_REAL q[MOST], v[MOST], a[MOST], p[3*MOST*MOST], w[MOST*MOST + 4*MOST];

/* Lane k of a number. */
static double *lane(LAG_REAL *x, int k) { return (double *)(void *)x + k; }

/* The largest residual, in units of its largest term. */
static double residual(int n, int k) {
  const long double L = *lane(&p[0], k), M = *lane(&p[1], k), C = *lane(&p[2], k);
  long double worst = 0;
  for (int i = 0; i < n; i++) {
    const long double force = (i + 1)*(long double)*lane(&q[i], k)/C;
    long double sum = force, size = fabsl(force);
    for (int j = 0; j < n; j++) {
      const long double term = (i == j ? L : M/(i > j ? i - j : j - i))**lane(&a[j], k);
      sum += term;
      size = fmaxl(size, fabsl(term));
    }
    worst = fmaxl(worst, fabsl(sum)/size);
  }
  return (double)worst;
}

int main(void) {
  static const unsigned char none[8];
  const lag_model *m = SCENE.model;
  double worst = 0, stale = 0;
  if (m->np != 3 || m->nq > MOST || (size_t)(m->np + m->nderived) > sizeof p/sizeof *p || (size_t)m->nw > sizeof w/sizeof *w) return 2;
  SCENE.params(p, none);
  for (int turn = 0; turn < 50; turn++) {
    for (int k = 0; k < LANES; k++) {
      const int s = turn*LANES + k;
      *lane(&p[0], k) = 1 + 0.5*sin(s);
      *lane(&p[1], k) = 0.2*sin(2*s + 1);
      *lane(&p[2], k) = exp(3*sin(3*s));
      for (int i = 0; i < m->nq; i++) *lane(&q[i], k) = sin(s + 7*i);
    }
    for (int fresh = 0; fresh < 2; fresh++) {
      if (fresh && m->derive) m->derive(p);
      if (m->accel(q[0], q, v, NULL, p, NULL, a, NULL, w) != 0) return 3;
      for (int k = 0; k < LANES; k++) {
        const double r = residual(m->nq, k);
        if (fresh) worst = fmax(worst, r);
        else if (turn) stale = fmax(stale, r);
      }
    }
  }
  printf("residual %.3g; with derived parameters of others: %.3g\n", worst, stale);
  return !(worst < 16*m->nq*0x1p-52 && stale > 1e-3); /* conditions of the matrices: below 16 */
}
