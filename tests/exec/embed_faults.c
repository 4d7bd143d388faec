/* Steps of an emitted header that cannot be made: each says so and keeps the state. A status of -1: any but 0. */
#include <stdio.h>
#include <stdlib.h>
#define POLE_IMPLEMENTATION
#include "pole.h"

static int bad = 0;
static void expect(const char *what, int ok) {
  if (!ok) printf("%s\n", what);
  bad += !ok;
}

static int step(int method, const pole_params *p, pole_state *s, double h, double tolerance) {
  static pole_adaptive adaptive;
  static pole_taylor taylor;
  static pole_variational variational;
  double a[POLE_NQ];
  pole_adaptive_begin(&adaptive, tolerance);
  pole_taylor_begin(&taylor, tolerance, 0);
  pole_variational_begin(&variational, 4);
  switch (method) {
    case 0: return pole_rk4_step(p, s, h);
    case 1: pole_accel(s->t, s->q, s->v, p, a); return pole_verlet_step(p, s, h, a);
    case 2: return pole_rk45_step(p, s, &adaptive, s->t + h);
    case 3: return pole_dop853_step(p, s, &adaptive, s->t + h);
    case 4: return pole_taylor_step(p, s, &taylor, s->t + h);
    default: return pole_variational_step(p, s, &variational, h);
  }
}

static int same(const pole_state *a, const pole_state *b) {
  return a->t == b->t && (a->q[0] == b->q[0] || (a->q[0] != a->q[0] && b->q[0] != b->q[0])) && a->v[0] == b->v[0];
}

int main(int argc, char **argv) {
  (void)argv;
  static const char *const names[] = {"rk4", "verlet", "rk45", "dop853", "taylor", "variational"};
  pole_params p;
  pole_state start, s;
  double a[POLE_NQ];
  char what[80];
  pole_defaults(&p);
  pole_start(&p, &start);
  if (argc > 1) { /* a sum of cosines, in hexadecimals */
    double sum = 0;
    for (int i = 0; i < 20000; i++) {
      const double q[POLE_NQ] = {1, 0.3701*i};
      pole_accel(0, q, start.v, &p, a);
      sum += a[1]*i;
    }
    printf("%a\n", sum);
    return 0;
  }
  for (int m = 0; m < 6; m++) {
    const double times[] = {0.01, NAN, 0.01, m < 2 || m > 4 ? INFINITY : NAN, 0.01}, at[] = {0, 1, NAN, 1, INFINITY};
    for (int k = 0; k < 5; k++) {
      s = start;
      s.q[0] = at[k];
      const pole_state before = s;
      snprintf(what, sizeof what, "%s, x = %g, h = %g: a status, and the state as it was", names[m], at[k], times[k]);
      expect(what, step(m, &p, &s, times[k], 1e-9) < 0 && same(&s, &before));
    }
    s = start;
    snprintf(what, sizeof what, "%s to the time that it has", names[m]);
    expect(what, step(m, &p, &s, 0, 1e-9) == POLE_OK && same(&s, &start));
    for (int k = 0; k < 3 && m > 1 && m < 5; k++) {
      s = start;
      snprintf(what, sizeof what, "%s, a tolerance that is none", names[m]);
      expect(what, step(m, &p, &s, 0.1, k == 0 ? -1e-9 : k == 1 ? 0 : NAN) == POLE_ETOLERANCE && same(&s, &start));
    }
  }
  for (int m = 2; m < 5; m++) {
    s = start;
    s.q[0] = 1.7e308, s.v[0] = 1e307;
    int status = 0;
    for (int k = 0; k < 1000 && !status; k++) status = step(m, &p, &s, 10, 1e-9);
    snprintf(what, sizeof what, "%s, where x outgrows its numbers: a status, and a state that is finite", names[m]);
    expect(what, status < 0 && isfinite(s.q[0]) && isfinite(s.t));
  }
  s = start;
  s.q[0] = 0;
  expect("accelerations at the pole", pole_accel(s.t, s.q, s.v, &p, a) == POLE_ENAN);
  expect("accelerations elsewhere", pole_accel(s.t, start.q, start.v, &p, a) == POLE_OK);
  return bad != 0;
}
