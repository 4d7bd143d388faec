/* Dry friction by Moreau's method in headers, against closed forms. REAL: the scalar; NEAR: tolerance of what is
 * exact but for rounding. Exit status 0 when all hold. */
#include <math.h>
#include <stdio.h>

#define SPRING_REAL REAL
#define SPRING_IMPLEMENTATION
#include "spring.h"
#define BELT_REAL REAL
#define BELT_IMPLEMENTATION
#include "belt.h"
#define PLANK_REAL REAL
#define PLANK_IMPLEMENTATION
#include "plank.h"
#define WIRE_REAL REAL
#define WIRE_IMPLEMENTATION
#include "wire.h"
#define RING_REAL REAL
#define RING_IMPLEMENTATION
#include "ring.h"

static int wrong = 0;

static void near(const char *what, REAL got, double want, double tolerance) {
  if (fabs((double)got - want) <= tolerance) return;
  printf("%s: %.17g, not %.17g within %g\n", what, (double)got, want, tolerance);
  wrong = 1;
}

static const double h = 0.001;

/* Each half swing is 2 R/k shorter; at rest where k x < R. */
static void spring(void) {
  spring_params p;
  spring_state s;
  double swing = 1.05;
  int turns = 0;
  spring_defaults(&p);
  (void)spring_start(&p, &s);
  while (s.t < (REAL)6) {
    const spring_state was = s;
    if (spring_moreau_step(&p, &s, (REAL)h) != SPRING_OK) { wrong = 1; break; }
    if (!(was.v[0]*s.v[0] < 0) && !(s.touch[0] == SPRING_STICKS && was.touch[0] == SPRING_SLIPS)) continue;
    /* it turns within a step, at most k x h^2/2 from the end; that of the step's own friction adds up */
    swing -= 0.2, turns++;
    near("swing", (REAL)fabs((double)s.q[0]), swing, 1e-5);
  }
  near("turns", (REAL)turns, 5, 0);
  near("at rest", s.v[0], 0, NEAR);
  near("sticks", s.touch[SPRING_SURFACE_X_DOT], SPRING_STICKS, 0);
  near("held by the spring", s.mode[SPRING_SURFACE_X_DOT], -10*(double)s.q[0], 10*NEAR);
}

/* With static friction 0.4 N and 0.25 N of motion: breaks loose at x = 0.4 m, and is caught at 2 0.25 - 0.4 m. */
static void belt(void) {
  belt_params p;
  belt_state s;
  REAL loose = 0, caught = 0;
  belt_defaults(&p);
  (void)belt_start(&p, &s);
  while (s.t < (REAL)20) {
    const belt_state was = s;
    if (belt_moreau_step(&p, &s, (REAL)h) != BELT_OK) { wrong = 1; break; }
    if (was.touch[0] == BELT_STICKS && s.touch[0] == BELT_SLIPS) near("breaks loose", loose = s.q[0], 0.4, 2*0.2*h);
    if (was.touch[0] == BELT_SLIPS && s.touch[0] == BELT_STICKS) near("is caught", caught = s.q[0], 0.1, 2*0.2*h);
  }
  if (!(loose > 0 && caught > 0)) printf("it neither slips nor sticks\n"), wrong = 1;
}

/* A block slides on a plank, and that on a table: they go on together. Friction 3 N between them, 1 N below; masses
 * 1 and 2 kg. */
static void plank(void) {
  plank_params p;
  plank_state s;
  plank_defaults(&p);
  /* the block at 4 m/s: slows by 3, the plank gains (3 - 1)/2 = 1 m/s^2; equal after 1 s, at 1 m/s; then both slow
   * by 1/3 */
  (void)plank_start(&p, &s);
  for (int i = 0; i < 2000; i++) {
    if (plank_moreau_step(&p, &s, (REAL)h) != PLANK_OK) { wrong = 1; break; }
    if (i == 499)
      near("slides on it", s.touch[PLANK_SURFACE_SLIP_DOT], PLANK_SLIPS, 0),
          near("3 m/s^2", s.v[PLANK_X], 2.5, 1000 * NEAR);
  }
  near("together", s.v[PLANK_X] - s.v[PLANK_Y], 0, 10*NEAR);
  near("at 1 - 1/3 m/s", s.v[PLANK_X], 2./3, 1000*NEAR);
  near("slid 2 m on the plank", s.q[PLANK_X] - s.q[PLANK_Y], 2, 1e-6 + 1000*NEAR);
  near("held by 1/3 N, of 3", s.mode[PLANK_SURFACE_SLIP_DOT], 1./9, 1000*NEAR);
  for (int i = 0; i < 3000; i++)
    if (plank_moreau_step(&p, &s, (REAL)h) != PLANK_OK) wrong = 1;
  near("both at rest", s.v[PLANK_Y], 0, 10*NEAR);
  near("sticks", s.touch[PLANK_SURFACE_Y_DOT], PLANK_STICKS, 0);
}

/* A bead on a straight wire that rises by 3/4, with friction 2 N along x; 10 N of weight pull 7.5 N back along x.
 * Held; then a force that grows. */
static void pull(void *context, REAL t, REAL *u) { (void)context, u[WIRE_IN_F] = 2*t; }

static void wire(void) {
  wire_params p;
  wire_state s;
  const double a = (7.5 + 2)/(1 + 0.5625); /* of the bead going up, in x */
  REAL still = 0, off[WIRE_NU] = {0};
  wire_defaults(&p);
  (void)wire_start(&p, &s);
  s.v[WIRE_X] = (REAL)1, s.v[WIRE_Y] = (REAL)0.75;
  for (int i = 0; i < 100; i++)
    if (wire_moreau_step(&p, &s, (REAL)h, off) != WIRE_OK) wrong = 1;
  near("slows down", s.v[WIRE_X], 1 - 0.1*a, 1000*NEAR);
  near("on the wire", s.q[WIRE_Y], 0.75*(double)s.q[WIRE_X], 10*NEAR);
  p.R = (REAL)8;
  (void)wire_start(&p, &s);
  while (s.t < (REAL)10) { /* 2 t = 7.5 + 8 at 7.75 s */
    if (wire_moreau_step_with(&p, &s, (REAL)h, pull, 0) != WIRE_OK) { wrong = 1; break; }
    if (s.touch[0] == WIRE_STICKS) still = s.t;
  }
  near("breaks loose", still, 7.75, 1.5*h);
  near("x = (t - 7.75)^3/3/1.5625", s.q[WIRE_X], pow(2.25, 3)/3/1.5625, 3*h*h + 1000*NEAR);
}

/* A bead on a ring with friction: it stays on the ring, and comes to rest where friction holds it. */
static void ring(void) {
  ring_params p;
  ring_state s;
  ring_defaults(&p);
  (void)ring_start(&p, &s);
  for (int i = 0; i < 10000; i++)
    if (ring_moreau_step(&p, &s, (REAL)h) != RING_OK) wrong = 1;
  near("on the ring", s.q[RING_X]*s.q[RING_X] + s.q[RING_Y]*s.q[RING_Y], 1, 100*NEAR);
  near("at rest", s.v[RING_X], 0, 100*NEAR);
  near("m g tan(a) against friction", 2*s.mode[RING_SURFACE_X_DOT], 10*(double)(s.q[RING_X]/s.q[RING_Y]), 1000*NEAR);
}

int main(void) {
  spring();
  belt();
  plank();
  wire();
  ring();
  return wrong;
}
