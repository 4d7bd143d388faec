/* Accelerations of tests/exec/models/windings.lag, or elements.lag, against its equations, M a + K q = 0, in long
 * double: no solver judges another. */
#include <math.h>
#include <stdio.h>

#include "lag_model.h"

#ifndef LAG_LANES
enum { LANES = 1 };
#else
enum { LANES = LAG_LANES };
#endif
enum { MOST = 2000, ROOM = 8000 };
extern const lag_scene SCENE;
static LAG_REAL q[MOST], v[MOST], a[MOST], p[ROOM], w[ROOM];

/* Lane k of a number. */
static double *lane(LAG_REAL *x, int k) { return (double *)(void *)x + k; }

/* Element i, j of M, and force i, of the parameters and the state of lane k. */
#ifdef ELEMENTS
enum { PARAMETERS = 2, WIDE = 1 };
static long double mass(int n, int i, int j, int k) {
  (void)n;
  return *lane(&p[0], k)*(i == j ? 4 : 1)/6.0L;
}
static long double force(int n, int i, int k) {
  const long double left = i ? *lane(&q[i - 1], k) : 0, right = i < n - 1 ? *lane(&q[i + 1], k) : 0;
  return *lane(&p[1], k)*(2L**lane(&q[i], k) - left - right);
}
static void place(int s, int k) {
  *lane(&p[0], k) = 1 + 0.5*sin(s);
  *lane(&p[1], k) = exp(3*sin(3*s));
}
#else
enum { PARAMETERS = 3, WIDE = MOST };
static long double mass(int n, int i, int j, int k) {
  (void)n;
  return i == j ? *lane(&p[0], k) : *lane(&p[1], k)/(long double)(i > j ? i - j : j - i);
}
static long double force(int n, int i, int k) {
  (void)n;
  return (i + 1)*(long double)*lane(&q[i], k)/ *lane(&p[2], k);
}
static void place(int s, int k) {
  *lane(&p[0], k) = 1 + 0.5*sin(s);
  *lane(&p[1], k) = 0.2*sin(2*s + 1);
  *lane(&p[2], k) = exp(3*sin(3*s));
}
#endif

/* The largest residual, in units of the largest term. */
static double residual(int n, int k) {
  long double worst = 0, size = 0;
  for (int i = 0; i < n; i++) {
    long double sum = force(n, i, k);
    size = fmaxl(size, fabsl(sum));
    for (int j = i > WIDE ? i - WIDE : 0; j < n && j <= i + WIDE; j++) sum += mass(n, i, j, k)**lane(&a[j], k);
    worst = fmaxl(worst, fabsl(sum));
  }
  return (double)(worst/size);
}

int main(void) {
  static const unsigned char none[8];
  const lag_model *m = SCENE.model;
  double worst = 0, stale = 0;
  if (m->np != PARAMETERS || m->nq > MOST || (size_t)(m->np + m->nderived) > sizeof p / sizeof *p ||
      (size_t)m->nw > sizeof w / sizeof *w)
    return 2;
  SCENE.params(&SCENE, p, none);
  for (int turn = 0; turn < 50; turn++) {
    for (int k = 0; k < LANES; k++) {
      const int s = turn*LANES + k;
      place(s, k);
      for (int i = 0; i < m->nq; i++) *lane(&q[i], k) = sin(s + 7*i);
    }
    for (int fresh = 0; fresh < 2; fresh++) {
      if (fresh && m->derive) m->derive(m, p);
      if (m->accel(m, q[0], q, v, NULL, p, NULL, a, NULL, w) != 0) return 3;
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
