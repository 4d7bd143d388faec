/* What lag_math.h and an emitted model cost: nanoseconds a lane, the least of many rounds. Compiled with
 * -DLAG_LANES=4 or 8, or without for doubles; SCENE is a scene of the emitted model. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "lag_math.h"
#include "lag_model.h"

extern const lag_scene SCENE;

#ifdef LAG_LANES
enum { LANES = LAG_LANES };
#else
enum { LANES = 1 };
#endif
enum { N = 256, STATES = 16, ROUNDS = 3000, MOST = 8 }; /* so many states, as in driver.c, stay in the nearest cache */

LAG_REAL x[N], s[N], c[N]; /* seen from outside: no store may be left out */
static LAG_REAL q[STATES][MOST], v[STATES][MOST], a[MOST], p[64], t;

static double now(void) {
  struct timespec at;
  clock_gettime(CLOCK_MONOTONIC, &at);
  return (double)at.tv_sec + 1e-9*(double)at.tv_nsec;
}

#define KERNEL(name, work) \
  __attribute__((noinline)) static void name(void) { \
    for (int i = 0; i < N; i++) work; \
    __asm__ volatile("" ::: "memory"); \
  }
KERNEL(own_sincos, lag_sincos(x[i], &s[i], &c[i]))
KERNEL(own_exp, s[i] = lag_exp(x[i]))
KERNEL(own_log, s[i] = lag_log(x[i]))
KERNEL(own_rsqrt, s[i] = lag_rsqrt(x[i]))
KERNEL(accelerations, SCENE.model->accel(SCENE.model, t, q[i % STATES], v[i % STATES], NULL, p, NULL, a, NULL, NULL))
#ifndef LAG_LANES
KERNEL(libm_sincos, (s[i] = sin(x[i]), c[i] = cos(x[i])))
KERNEL(libm_exp, s[i] = exp(x[i]))
KERNEL(libm_log, s[i] = log(x[i]))
KERNEL(libm_rsqrt, s[i] = 1/sqrt(x[i]))
#endif

static void measure(const char *name, void (*f)(void)) {
  double best = 1;
  for (int r = 0; r < ROUNDS; r++) {
    const double begin = now();
    f();
    const double took = now() - begin;
    if (took < best) best = took;
  }
  printf("  %s %.2f", name, 1e9*best/N/LANES);
}

static void fill(LAG_REAL *to, size_t n, double low, double high) {
  double *d = (double *)(void *)to;
  for (size_t i = 0; i < n*sizeof *to/sizeof *d; i++) d[i] = low + (high - low)*rand()/RAND_MAX;
}

int main(void) {
  static const unsigned char none[64];
  fill(x, N, 0.1, 3);
  fill(q[0], STATES*MOST, -2, 2);
  fill(v[0], STATES*MOST, -2, 2);
  SCENE.params(&SCENE, p, none);
  measure("sincos", own_sincos);
  measure("exp", own_exp);
  measure("log", own_log);
  measure("rsqrt", own_rsqrt);
#ifndef LAG_LANES
  printf("  (the C library's:");
  measure("sincos", libm_sincos);
  measure("exp", libm_exp);
  measure("log", libm_log);
  measure("rsqrt", libm_rsqrt);
  printf(")");
#endif
  measure("accelerations", accelerations);
  printf("  ns a lane\n");
  return 0;
}
