/* 800 double pendulums from starts at rest to t = 10, one after the other or in lanes, by code that others would
 * write: microseconds a motion and the median error of th1, for some tolerances. Argument: the file of rows
 * `th1,th2,th1 at t = 10` that lagc wrote with 19 digits. */
#define lag_euler_tableau unused_euler
#define lag_rk4_tableau unused_rk4
#define lag_rk45_tableau unused_rk45
#define lag_dop853_tableau coefficients
#include "methods/tableau.c"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOTIONS = 800, STAGES = 12, TOLERANCES = 6 };
static const double tolerance[TOLERANCES] = {1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13}, END = 10;
static double start[MOTIONS][2], wanted[MOTIONS], got[MOTIONS];

static double now(void) {
  struct timespec at;
  clock_gettime(CLOCK_MONOTONIC, &at);
  return (double)at.tv_sec + 1e-9*(double)at.tv_nsec;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void judge(const char *name, void (*all)(double tol)) {
  for (int i = 0; i < TOLERANCES; i++) {
    double error[MOTIONS];
    const double begin = now();
    all(tolerance[i]);
    const double took = now() - begin;
    for (int k = 0; k < MOTIONS; k++) error[k] = fabs(got[k] - wanted[k]);
    qsort(error, MOTIONS, sizeof *error, ascending);
    printf("%s %g %.3g %.2f\n", name, tolerance[i], error[MOTIONS/2], 1e6*took/MOTIONS);
  }
}

/* ---- one after the other: textbook accelerations for m = l = 1, by the C library's sine and cosine */

static int rates(double t, const double *y, double *d, void *context) {
  const double s1 = sin(y[0]), s2 = sin(y[1]), s = sin(y[0] - y[1]), c = cos(y[0] - y[1]), per = 1 / (2 - c * c),
               g = 9.81, u = y[2] * y[2], v = y[3] * y[3];
  (void)t, (void)context;
  d[0] = y[2];
  d[1] = y[3];
  d[2] = (g*s2*c - s*(u*c + v) - 2*g*s1)*per;
  d[3] = (2*(u*s - g*s2 + g*s1*c) + v*s*c)*per;
  return 0;
}

#ifdef BENCH_GSL
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

static void by_gsl(double tol) {
  gsl_odeiv2_system system = {rates, NULL, 4, NULL};
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-3, tol, tol);
  for (int i = 0; i < MOTIONS; i++) {
    double t = 0, y[4] = {start[i][0], start[i][1], 0, 0};
    gsl_odeiv2_driver_reset_hstart(d, 1e-3);
    gsl_odeiv2_driver_apply(d, &t, END, y);
    got[i] = y[0];
  }
  gsl_odeiv2_driver_free(d);
}
#endif

#ifdef BENCH_ODEINT
double peer_odeint(int problem, int (*rates)(double, const double *, double *, void *), int n, double t, double tol,
                   double *y);
double bench_now(void) { return now(); }

static void by_odeint(double tol) {
  for (int i = 0; i < MOTIONS; i++) {
    double y[4] = {start[i][0], start[i][1], 0, 0};
    peer_odeint(0, rates, 4, END, tol, y);
    got[i] = y[0];
  }
}
#endif

/* ---- in lanes: dop853 as one would write it by hand, each lane with its own step, the next motion where one ends;
 * sine and cosine by libmvec */

#ifdef LANES
typedef double real __attribute__((vector_size(8*LANES)));
typedef long long mask __attribute__((vector_size(8*LANES)));
#define INLINE static inline __attribute__((always_inline))

#if LANES == 8
real _ZGVeN8v_sin(real), _ZGVeN8v_cos(real);
#define vector_sin _ZGVeN8v_sin
#define vector_cos _ZGVeN8v_cos
#else
real _ZGVdN4v_sin(real), _ZGVdN4v_cos(real);
#define vector_sin _ZGVdN4v_sin
#define vector_cos _ZGVdN4v_cos
#endif

INLINE real pick(mask c, real a, real b) { return (real)((c & (mask)a) | (~c & (mask)b)); }
INLINE real size(real x) { return (real)((mask)x & 0x7fffffffffffffffLL); }

INLINE void lane_rates(const real *y, real *d) {
  const real s1 = vector_sin(y[0]), s2 = vector_sin(y[1]), s = vector_sin(y[0] - y[1]), c = vector_cos(y[0] - y[1]),
             per = 1 / (2 - c * c);
  const real u = y[2]*y[2], v = y[3]*y[3];
  const double g = 9.81;
  d[0] = y[2];
  d[1] = y[3];
  d[2] = (g*s2*c - s*(u*c + v) - 2*g*s1)*per;
  d[3] = (2*(u*s - g*s2 + g*s1*c) + v*s*c)*per;
}

INLINE real sum(int count, const double *coef, real k[][4], int i) {
  real s = coef[0]*k[0][i];
#define TERM(j) if (j < count && coef[j] != 0.0) s += coef[j]*k[j][i];
  TERM(1) TERM(2) TERM(3) TERM(4) TERM(5) TERM(6) TERM(7) TERM(8) TERM(9) TERM(10) TERM(11)
  return s;
}

static void by_hand(double tol) {
  real y[4] = {{0}}, y1[4], k[STAGES + 1][4], t = {0}, h = {0};
  int motion[LANES], next = 0, left = LANES;
  for (int l = 0; l < LANES; l++) motion[l] = next++, y[0][l] = start[l][0], y[1][l] = start[l][1], h[l] = 0.01;
  lane_rates(y, k[0]);
  while (left) {
    real to_end = END - t;
    h = pick(h < to_end, h, to_end);
#define STAGE(s) \
    for (int i = 0; i < 4; i++) y1[i] = y[i] + h*sum(s, coefficients.a[s], k, i); \
    lane_rates(y1, k[s]);
    STAGE(1) STAGE(2) STAGE(3) STAGE(4) STAGE(5) STAGE(6) STAGE(7) STAGE(8) STAGE(9) STAGE(10) STAGE(11)
    real fine = {0}, coarse = {0};
    for (int i = 0; i < 4; i++) {
      y1[i] = y[i] + h*sum(STAGES, coefficients.a[12], k, i);
      const real a = size(y[i]), b = size(y1[i]), per = 1/(tol + tol*pick(a > b, a, b));
      const real e = per*sum(STAGES, coefficients.errors[0], k, i), e3 = per*sum(STAGES, coefficients.errors[1], k, i);
      fine += e*e;
      coarse += e3*e3;
    }
    const real both = fine + 0.01*coarse;
    real error, grow;
    for (int l = 0; l < LANES; l++) {
      error[l] = both[l] > 0 ? h[l]*fine[l]/sqrt(both[l]*4) : 0;
      grow[l] = fmin(6, fmax(1/3.0, 0.9*pow(error[l], -1.0/8)));
    }
    const mask good = error <= 1;
    lane_rates(y1, k[12]);
    for (int i = 0; i < 4; i++) y[i] = pick(good, y1[i], y[i]), k[0][i] = pick(good, k[12][i], k[0][i]);
    t = pick(good, t + h, t);
    h *= grow;
    for (int l = 0; l < LANES; l++) {
      if (!(t[l] >= END*(1 - 1e-15)) || motion[l] < 0) continue;
      got[motion[l]] = y[0][l];
      motion[l] = next < MOTIONS ? next++ : -1;
      if (motion[l] < 0) {
        left--;
        t[l] = 0; /* the lane idles */
        continue;
      }
      t[l] = 0;
      h[l] = 0.01;
      for (int i = 0; i < 4; i++) y[i][l] = i < 2 ? start[motion[l]][i] : 0;
      real d[4];
      lane_rates(y, d);
      for (int i = 0; i < 4; i++) k[0][i][l] = d[i][l];
    }
  }
}
#endif

int main(int argc, char **argv) {
  FILE *f = argc > 1 ? fopen(argv[1], "r") : NULL;
  char line[400];
  if (!f || !fgets(line, sizeof line, f)) return 2;
  for (int i = 0; i < MOTIONS; i++)
    if (!fgets(line, sizeof line, f) || sscanf(line, "%lf,%lf,%lf", &start[i][0], &start[i][1], &wanted[i]) != 3)
      return 2;
  fclose(f);
#ifdef BENCH_GSL
  judge("gsl_rk8pd", by_gsl);
#endif
#ifdef BENCH_ODEINT
  judge("odeint_rkf78", by_odeint);
#endif
#ifdef LANES
  judge(LANES == 8 ? "by_hand_8_lanes" : "by_hand_4_lanes", by_hand);
#endif
  return 0;
}
