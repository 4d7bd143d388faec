/* Two emitted headers in one program, C or C++, in the precision REAL: the oscillator against its
 * closed form, the double pendulum against equations written by hand. Exit status 0 when they agree. */
#ifndef REAL
#define REAL double
#endif
#define OSCILLATOR_REAL REAL
#define DOUBLE_PENDULUM_REAL REAL
#ifdef WITH_BODY
#define OSCILLATOR_IMPLEMENTATION
#define DOUBLE_PENDULUM_IMPLEMENTATION
#endif
#ifdef C99_LONG_DOUBLE
#define OSCILLATOR_FN(f) f##l
#define DOUBLE_PENDULUM_FN(f) f##l
#endif
#include "double_pendulum.h"
#include "oscillator.h"

#ifdef MAIN
#include <float.h>
#include <math.h>
#include <stdio.h>

static int bad;
static void near(const char *what, double got, double want, double tolerance) {
  if (fabs(got - want) <= tolerance) return;
  printf("%s: got %.17g, want %.17g, tolerance %g\n", what, got, want, tolerance);
  bad = 1;
}

/* One rounding of a quantity of size 1. */
static double rounding(void) { return sizeof(REAL) == sizeof(float) ? FLT_EPSILON : DBL_EPSILON; }

/* x'' = -4 x, x(0) = 1/2, x'(0) = 1: x = cos(2t)/2 + sin(2t)/2. RK4 errs by t h^4 2^5/120 * 0.7. */
static void oscillator(void) {
  oscillator_params p;
  oscillator_state s;
  oscillator_defaults(&p);
  oscillator_start(&p, &s);
  near("a parameter given in degrees", (double)p.tilt, 1.5707963267948966, 4 * rounding());
  near("a parameter by index", (double)*oscillator_param(&p, OSCILLATOR_P_K), 8, 0);
  near("there are three", oscillator_param(&p, OSCILLATOR_NP) == 0, 1, 0);
  const int n = 1000;
  for (int i = 0; i < n; i++)
    if (oscillator_rk4_step(&p, &s, (REAL)0.0078125) != OSCILLATOR_OK) bad = 1;
  const double t = n * 0.0078125, tolerance = t * 3.7e-9 * 0.19 * 1.5 + n * rounding();
  near("time", (double)s.t, t, 0);
  near("x", (double)s.q[OSCILLATOR_X], 0.5 * cos(2 * t) + 0.5 * sin(2 * t), tolerance);
  near("x'", (double)s.v[OSCILLATOR_X], cos(2 * t) - sin(2 * t), 2 * tolerance);
  REAL e[2], out[OSCILLATOR_NOUT], g[OSCILLATOR_NEV];
  oscillator_energy(s.t, s.q, s.v, &p, e);
  near("energy", (double)e[0], 2, 20 * tolerance);
  oscillator_observe(s.t, s.q, s.v, &p, out);
  near("output energy", (double)out[OSCILLATOR_OUT_ENERGY], (double)e[0], 8 * rounding());
  oscillator_events(s.t, s.q, s.v, &p, g);
  near("event function", (double)g[OSCILLATOR_EV_FAR], (double)s.q[0] - 3, 4 * rounding());
  int stop = 0;
  const double v = (double)s.v[0];
  oscillator_act(OSCILLATOR_EV_ZERO, &p, &s, &stop);
  near("an action", (double)s.v[0], -v, 0);
  near("goes on", stop, 0, 0);
  oscillator_act(OSCILLATOR_EV_FAR, &p, &s, &stop);
  near("stops", stop, 1, 0);
}

/* The textbook's accelerations, over the common denominator (equal lengths 1, g = 9.81). */
static void by_hand(const double *y, double *dy, double m1, double m2) {
  const double d = y[0] - y[1], g = 9.81, s = sin(d), c = cos(d), den = m1 + m2 * s * s;
  dy[0] = y[2];
  dy[1] = y[3];
  dy[2] = (m2 * g * sin(y[1]) * c - m2 * s * (y[2] * y[2] * c + y[3] * y[3]) - (m1 + m2) * g * sin(y[0])) / den;
  dy[3] = ((m1 + m2) * (y[2] * y[2] * s - g * sin(y[1]) + g * sin(y[0]) * c) + m2 * y[3] * y[3] * s * c) / den;
}

static void hand_step(double *y, double h, double m1, double m2) {
  double k[4][4], x[4];
  by_hand(y, k[0], m1, m2);
  for (int i = 0; i < 4; i++) x[i] = y[i] + h / 2 * k[0][i];
  by_hand(x, k[1], m1, m2);
  for (int i = 0; i < 4; i++) x[i] = y[i] + h / 2 * k[1][i];
  by_hand(x, k[2], m1, m2);
  for (int i = 0; i < 4; i++) x[i] = y[i] + h * k[2][i];
  by_hand(x, k[3], m1, m2);
  for (int i = 0; i < 4; i++) y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

/* The same method on the same equations: what is left is rounding, which grows about 100 times in 1 s. */
static void double_pendulum(void) {
  double_pendulum_params p;
  double_pendulum_state s;
  double_pendulum_defaults(&p);
  double_pendulum_start(&p, &s);
  p.m1 = (REAL)2;
  double y[4] = {(double)s.q[DOUBLE_PENDULUM_TH1], (double)s.q[DOUBLE_PENDULUM_TH2], 0, 0};
  for (int i = 0; i < 256; i++) {
    if (double_pendulum_rk4_step(&p, &s, (REAL)0.00390625) != DOUBLE_PENDULUM_OK) bad = 1;
    hand_step(y, 0.00390625, 2, 1);
  }
  const double tolerance = 256 * 100 * rounding();
  near("th1", (double)s.q[DOUBLE_PENDULUM_TH1], y[0], tolerance);
  near("th2", (double)s.q[DOUBLE_PENDULUM_TH2], y[1], tolerance);
  near("th1'", (double)s.v[DOUBLE_PENDULUM_TH1], y[2], 10 * tolerance);
  near("th2'", (double)s.v[DOUBLE_PENDULUM_TH2], y[3], 10 * tolerance);
  p.m1 = p.m2 = (REAL)0;
  const double before = (double)s.q[0];
  near("no mass: refused", double_pendulum_rk4_step(&p, &s, (REAL)1), DOUBLE_PENDULUM_ESINGULAR, 0);
  near("and the state is as it was", (double)s.q[0], before, 0);
}

int main(void) {
  oscillator();
  double_pendulum();
  return bad;
}
#endif
