/* Contacts by Moreau's method in headers, against closed forms. REAL: the scalar; NEAR: relative tolerance of what
 * is exact but for rounding. Exit status 0 when all hold. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define SLOPE_REAL REAL
#define SLOPE_IMPLEMENTATION
#include "slope.h"
#define PUCK_REAL REAL
#define PUCK_IMPLEMENTATION
#include "puck.h"
#define WALL_REAL REAL
#define WALL_IMPLEMENTATION
#include "wall.h"

static int wrong = 0;

static void near(const char *what, REAL got, double want, double tolerance) {
  if (fabs((double)got - want) <= tolerance) return;
  printf("%s: %.17g, not %.17g within %g\n", what, (double)got, want, tolerance);
  wrong = 1;
}

static const double g = 9.81, h = 0.001;

/* A block on a plane, tilted by a [deg], until t. */
static slope_state slope(double a, double v, double y, double t, double e, double mu, double et) {
  slope_params p;
  slope_state s;
  int touched[3] = {0, 0, 0}, struck = 0;
  slope_defaults(&p);
  p.a = (REAL)(a*3.14159265358979323846/180);
  p.e = (REAL)e, p.mu = (REAL)mu, p.et = (REAL)et;
  (void)slope_start(&p, &s);
  s.v[SLOPE_X] = (REAL)v;
  s.q[SLOPE_Y] = (REAL)y;
  while (s.t < (REAL)(t - h/2)) {
    if (slope_moreau_step(&p, &s, (REAL)h, 0) != SLOPE_OK)
      printf("a step fails at %g\n", (double)s.t), wrong = 1, s.t = (REAL)t;
    touched[(int)s.touch[SLOPE_CONTACT_PLANE]] = 1;
    struck += s.struck[SLOPE_CONTACT_PLANE] > 0;
  }
  if (y > 0) near("one impact", (REAL)struck, e > 0 ? 1 : 0, 0);
  if (y > 0 && !touched[SLOPE_OPEN]) printf("it flew\n"), wrong = 1;
  return s;
}

static void block(void) {
  const double weight = 2*g, deg = 3.14159265358979323846/180;
  slope_state s = slope(0, 3, 0, 1, 0, 0.3, 0);
  near("slides: x'", s.v[SLOPE_X], 3 - 0.3*g, 1000*NEAR);
  near("slips", s.touch[SLOPE_CONTACT_PLANE], SLOPE_SLIPS, 0);
  near("mu m g h", s.impulse[SLOPE_CONTACT_PLANE_SLIP], -0.3*weight*h, NEAR);
  s = slope(0, 3, 0, 2, 0, 0.3, 0);
  near("stops at v^2/(2 mu g), to h^2 mu g/8", s.q[SLOPE_X], 9/(2*0.3*g), 4e-7 + 1000*NEAR);
  near("at rest", s.v[SLOPE_X], 0, NEAR);
  near("sticks", s.touch[SLOPE_CONTACT_PLANE], SLOPE_STICKS, 0);
  s = slope(16, 0, 0, 2, 0, 0.3, 0);
  near("tan 16 deg < mu: stays", s.q[SLOPE_X], 0, 1000*NEAR);
  near("held by m g sin a", s.impulse[SLOPE_CONTACT_PLANE_SLIP], weight*sin(16*deg)*h, 10*NEAR);
  near("and pressed by m g cos a", s.impulse[SLOPE_CONTACT_PLANE], weight*cos(16*deg)*h, 10*NEAR);
  s = slope(17, 0, 0, 1, 0, 0.3, 0);
  near("tan 17 deg > mu: slides down", s.v[SLOPE_X], -g*(sin(17*deg) - 0.3*cos(17*deg)), 1000*NEAR);
  s = slope(0, 3, 1, 0.5, 0.5, 0.3, 0); /* falls for 0.4515 s */
  near("mu (1 + e) v is lost along the plane, v known to h g", s.v[SLOPE_X], 3 - 0.3*1.5*sqrt(2*g), 0.3*2.5*g*h);
  near("it flies again", s.touch[SLOPE_CONTACT_PLANE], SLOPE_OPEN, 0);
  s = slope(0, 3, 1, 0.5, 0.5, 2, 0.8);
  near("elastic along the plane", s.v[SLOPE_X], -0.8*3, 1000*NEAR);
}

/* A copy of the state goes on with the same digits. */
static void copied(void) {
  slope_params p;
  slope_state s, was;
  slope_defaults(&p);
  p.e = (REAL)0.7;
  (void)slope_start(&p, &s);
  s.q[SLOPE_Y] = (REAL)0.02;
  for (int i = 0; i < 200; i++) wrong |= slope_moreau_step(&p, &s, (REAL)h, 0) != SLOPE_OK;
  was = s;
  for (int i = 0; i < 200; i++) wrong |= slope_moreau_step(&p, &s, (REAL)h, 0) != SLOPE_OK;
  for (int i = 0; i < 200; i++) wrong |= slope_moreau_step(&p, &was, (REAL)h, 0) != SLOPE_OK;
  for (int i = 0; i < SLOPE_NQ; i++)
    near("a copy", s.q[i], (double)was.q[i], 0), near("its speed", s.v[i], (double)was.v[i], 0);
  s.v[SLOPE_X] = (REAL)(HUGE_VAL);
  was = s;
  near("no step from an infinite state", (REAL)slope_moreau_step(&p, &s, (REAL)h, 0), SLOPE_ECONTACT, 0);
  near("which stays", s.t, (double)was.t, 0);
}

/* A ball with side spin in space: friction lies in the cone; it rolls on with 5/7 of its speed, and 2/7 of that of
 * its spin across. */
static void space(double turn) {
  puck_params p;
  puck_state s;
  puck_defaults(&p);
  (void)puck_start(&p, &s);
  const double c = cos(turn), n = sin(turn);
  s.v[PUCK_X] = (REAL)(5*c), s.v[PUCK_Y] = (REAL)(5*n), s.v[PUCK_A] = (REAL)(20*c), s.v[PUCK_B] = (REAL)(20*n);
  for (int i = 0; i < 2000; i++) {
    if (puck_moreau_step(&p, &s, (REAL)h, 0) != PUCK_OK) wrong = 1;
    if (i == 500)
      near("friction is mu m g",
           (REAL)hypot((double)s.impulse[PUCK_CONTACT_FLOOR_SLIP_X], (double)s.impulse[PUCK_CONTACT_FLOOR_SLIP_Y]),
           0.2 * 2 * g * h, 10 * NEAR);
  }
  near("5/7", (REAL)(s.v[PUCK_X]*(REAL)c + s.v[PUCK_Y]*(REAL)n), 25./7, 1e5*NEAR);
  near("2/7", (REAL)(s.v[PUCK_Y]*(REAL)c - s.v[PUCK_X]*(REAL)n), -4./7, 1e5*NEAR);
  near("rolls", s.touch[PUCK_CONTACT_FLOOR], PUCK_STICKS, 0);
}

/* A pendulum of length 1 on a rod, let go 0.2 m from a wall with e = 0: it hangs there, its rod kept. */
static void wall(void) {
  wall_params p;
  wall_state s;
  wall_defaults(&p);
  (void)wall_start(&p, &s);
  for (int i = 0; i < 3000; i++)
    if (wall_moreau_step(&p, &s, (REAL)h, 0) != WALL_OK) wrong = 1;
  near("hangs at the wall, 0.2 m from the line below, to half a step of its speed", s.q[WALL_X], 0.2, 3e-3);
  near("on its rod", s.q[WALL_X]*s.q[WALL_X] + s.q[WALL_Y]*s.q[WALL_Y], 1, 100*NEAR);
  near("pressed by m g tan(a), sin(a) = x", s.impulse[WALL_CONTACT_WALL],
       g * h * (double)s.q[WALL_X] / sqrt(1 - (double)(s.q[WALL_X] * s.q[WALL_X])), 1000 * NEAR);
}

int main(void) {
  block();
  copied();
  for (int k = 0; k < 4; k++) space(0.7*k);
  wall();
  return wrong;
}
