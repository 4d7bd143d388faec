/* What methods.c compares: problems, with right-hand sides written by hand, and integrators of others for these. */
#ifndef BENCH_METHODS_H
#define BENCH_METHODS_H

#include <math.h>
#include <time.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { BENCH_MOST = 64 };

/* f(t, y[n]) into dy; n even. */
typedef int bench_rhs(double t, const double *y, double *dy, void *calls);

/* A peer: from y[n] at 0 to y at t, with absolute and relative tolerance tol. The processor's time of the steps in
 * seconds, < 0 when it fails. Objects of its own are made and freed outside of that time. */
typedef double bench_peer(int problem, bench_rhs *f, int n, double t, double tol, double *y);
bench_peer peer_rk8pd, peer_adams, peer_arkode, peer_odeint, peer_inlined, peer_sympy;

static inline double bench_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9*(double)t.tv_nsec;
}

/* The problems by hand, static so that an integrator can have them inlined. */
enum { DOUBLE_PENDULUM, HENON_HEILES, KEPLER, PLANETS, CHAIN_10, CHAIN_20, OSCILLATORS, N_BY_HAND };

static inline int by_hand_double_pendulum(double t, const double *y, double *d, void *p) {
  const double g = 9.81, delta = y[0] - y[1], s = sin(delta), c = cos(delta);
  const double f1 = -s*y[3]*y[3] - 2*g*sin(y[0]), f2 = s*y[2]*y[2] - g*sin(y[1]), det = 1/(2 - c*c);
  (void)t, (void)p;
  d[0] = y[2], d[1] = y[3], d[2] = (f1 - c*f2)*det, d[3] = (2*f2 - c*f1)*det;
  return 0;
}

static inline int by_hand_henon_heiles(double t, const double *y, double *d, void *p) {
  (void)t, (void)p;
  d[0] = y[2], d[1] = y[3], d[2] = -y[0] - 2*y[0]*y[1], d[3] = -y[1] - y[0]*y[0] + y[1]*y[1];
  return 0;
}

static inline int by_hand_kepler(double t, const double *y, double *d, void *p) {
  const double r2 = y[0]*y[0] + y[1]*y[1], k = -1/(r2*sqrt(r2));
  (void)t, (void)p;
  d[0] = y[2], d[1] = y[3], d[2] = k*y[0], d[3] = k*y[1];
  return 0;
}

static inline int by_hand_planets(double t, const double *y, double *d, void *p) {
  static const double m[6] = {1.00000597682,      0.000954786104043,  0.000285583733151,
                              0.0000437273164546, 0.0000517759138449, 1 / 1.3e8};
  const double G = 2.95912208286e-4;
  (void)t, (void)p;
  for (int i = 0; i < 18; i++) d[i] = y[18 + i], d[18 + i] = 0;
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < i; j++) {
      const double x[3] = {y[3 * i] - y[3 * j], y[3 * i + 1] - y[3 * j + 1], y[3 * i + 2] - y[3 * j + 2]},
                   r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2], k = G / (r2 * sqrt(r2));
      for (int c = 0; c < 3; c++) d[18 + 3*i + c] -= m[j]*k*x[c], d[18 + 3*j + c] += m[i]*k*x[c];
    }
  return 0;
}

/* Two oscillators: a right-hand side that costs next to nothing, so that a run shows what the integrator takes. */
static inline int by_hand_oscillators(double t, const double *y, double *d, void *p) {
  (void)t, (void)p;
  d[0] = y[2], d[1] = y[3], d[2] = -y[0], d[3] = -y[1];
  return 0;
}

/* A chain of N rods of length 1 with masses 1, at linear cost: hand/chain.c. */
int by_hand_chain_10(double t, const double *y, double *d, void *p);
int by_hand_chain_20(double t, const double *y, double *d, void *p);

#ifdef __cplusplus
}
#endif
#endif
