/* Many motions at once: the emitted header swing.h (lagc header models/double_pendulum.lag -o swing.h) over lanes.
 * LANES double pendulums with different starts and masses make the same steps in one loop; the same header, as
 * one.h, makes them one by one, and both end in the same place. Exit status 0 when they do. */
#include <math.h>
#include <stdio.h>

#ifndef LANES
#define LANES 4
#endif
#define SWING_LANES LANES
#define SWING_STATIC
#include "swing.h"

#define ONE_STATIC
#include "one.h"

enum { STEPS = 1000 };
static const double h = 1.0/1024;

/* What lane k starts from. */
static double start_of(int k) { return 0.3 + 0.2*k; }
static double mass_of(int k) { return 1 + 0.5*k; }

static int by_lanes(swing_state *s) {
  swing_params p;
  swing_defaults(&p);
  swing_start(&p, s);
  for (int k = 0; k < LANES; k++) {
    s->q[SWING_TH1][k] = start_of(k); /* a lane is an element */
    p.m2[k] = mass_of(k);
  }
  int status = SWING_OK;
  for (int i = 0; i < STEPS && status == SWING_OK; i++) status = swing_rk4_step(&p, s, SWING_C(1.0/1024));
  return status;
}

static int one_by_one(int k, one_state *s) {
  one_params p;
  one_defaults(&p);
  one_start(&p, s);
  s->q[ONE_TH1] = start_of(k);
  p.m2 = mass_of(k);
  int status = ONE_OK;
  for (int i = 0; i < STEPS && status == ONE_OK; i++) status = one_rk4_step(&p, s, h);
  return status;
}

/* One lane without masses is singular, and only that one: its bit is set in minus the status. */
static int singular_lane(swing_state *s) {
  swing_params p;
  swing_defaults(&p);
  p.m1[1] = p.m2[1] = 0;
  swing_start(&p, s);
  SWING_REAL a[SWING_NQ];
  const int status = swing_accel(s->t, s->q, s->v, &p, a);
  return status == -(1 << 1) && isfinite(a[0][0]) && isfinite(a[1][LANES > 2 ? LANES - 1 : 0]);
}

int main(void) {
  swing_state all;
  int bad = by_lanes(&all) != SWING_OK;
  for (int k = 0; k < LANES; k++) {
    one_state s;
    bad |= one_by_one(k, &s) != ONE_OK;
    const double got = all.q[SWING_TH1][k], want = s.q[ONE_TH1];
    if (fabs(got - want) <= 1e-12) continue; /* a thousand steps of rounding, grown ten times in a second */
    printf("lane %d: th1 is %.17g, alone %.17g\n", k, got, want);
    bad = 1;
  }
  if (!singular_lane(&all)) bad = 1, puts("a singular lane");
  return bad;
}
