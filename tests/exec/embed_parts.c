/* Parts of headers against closed forms: mass and bias of the double pendulum, constraints of the slider crank,
 * events of the bouncing ball, names. Exit status 0 when all hold. */
#define DOUBLE_PENDULUM_IMPLEMENTATION
#define SLIDER_CRANK_IMPLEMENTATION
#define BOUNCING_BALL_IMPLEMENTATION
#define DOUBLE_PENDULUM_WITH_NAMES
#include "bouncing_ball.h"
#include "double_pendulum.h"
#include "slider_crank.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int bad;
static void near(const char *what, double got, double want, double tolerance) {
  if (fabs(got - want) <= tolerance) return;
  printf("%s: got %.17g, want %.17g, tolerance %g\n", what, got, want, tolerance);
  bad = 1;
}

/* Textbook: M = (m1 + m2) l1^2, m2 l1 l2 cos d, m2 l2^2 with d = th1 - th2. */
static void mass(void) {
  double_pendulum_params p;
  double_pendulum_state s;
  double M[4], b[2], force[2];
  double_pendulum_defaults(&p);
  double_pendulum_start(&p, &s);
  p.m1 = 2, p.m2 = 3, p.l1 = 0.5, p.l2 = 0.7;
  s.q[0] = 0.3, s.q[1] = -0.8, s.v[0] = 1.1, s.v[1] = -0.6;
  const double d = 1.1, a[2] = {0.4, -1.7};
  double_pendulum_mass(s.t, s.q, s.v, &p, M);
  double_pendulum_bias(s.t, s.q, s.v, &p, b);
  double_pendulum_inverse_dynamics(s.t, s.q, s.v, &p, a, force);
  const double y[4] = {0.3, -0.8, 1.1, -0.6};
  double k[4], acc[2];
  double_pendulum_rhs(s.t, y, &p, k);
  double_pendulum_accel(s.t, s.q, s.v, &p, acc);
  near("rates", fabs(k[0] - 1.1) + fabs(k[1] + 0.6) + fabs(k[2] - acc[0]) + fabs(k[3] - acc[1]), 0, 0);
  near("M11", M[0], 5 * 0.25, 1e-15);
  near("M12", M[1], 3 * 0.35 * cos(d), 1e-15);
  near("M21", M[2], M[1], 0);
  near("M22", M[3], 3 * 0.49, 1e-15);
  near("b1", b[0], 3 * 0.35 * sin(d) * 0.36 + 5 * 9.81 * 0.5 * sin(0.3), 1e-14);
  near("b2", b[1], -3 * 0.35 * sin(d) * 1.21 + 3 * 9.81 * 0.7 * sin(-0.8), 1e-14);
  near("force 1", force[0], M[0] * a[0] + M[1] * a[1] + b[0], 1e-14);
  near("force 2", force[1], M[2] * a[0] + M[3] * a[1] + b[1], 1e-14);
}

/* along: x = cos p + a cos q; across: sin p + a sin q = 0. L' = L + lambda c, M q'' + b = A^T lambda. */
static void constraints(void) {
  slider_crank_params p;
  slider_crank_state s;
  double c[2], r[2], A[6], M[9], b[3], a[3], lambda[2];
  slider_crank_defaults(&p);
  slider_crank_start(&p, &s);
  s.q[0] = 0.9, s.q[1] = 1.2, s.q[2] = -0.4, s.v[0] = 0.7, s.v[1] = -0.2, s.v[2] = 0.5;
  slider_crank_constraints(s.t, s.q, s.v, &p, c, r);
  slider_crank_constraint_jacobian(s.t, s.q, s.v, &p, A);
  const double h = p.a, sign = c[0] * (1.2 - cos(0.4) - h * cos(0.9)) < 0 ? -1 : 1;
  near("c along", c[0], sign * (1.2 - cos(0.4) - h * cos(0.9)), 1e-15);
  near("c across", c[1], sin(-0.4) + h * sin(0.9), 1e-15);
  near("r along", r[0], sign * (-0.2 + sin(-0.4) * 0.5 + h * sin(0.9) * 0.7), 1e-15);
  near("r across", r[1], cos(0.4) * 0.5 + h * cos(0.9) * 0.7, 1e-15);
  const double want[6] = {sign * h * sin(0.9), sign, sign * sin(-0.4), h * cos(0.9), 0, cos(0.4)};
  for (int i = 0; i < 6; i++) near("Jacobian of constraints", A[i], want[i], 1e-15);
  slider_crank_hold(&p, &s);
  slider_crank_constraints(s.t, s.q, s.v, &p, c, r);
  near("held", fabs(c[0]) + fabs(c[1]) + fabs(r[0]) + fabs(r[1]), 0, 1e-14);
  slider_crank_constraint_jacobian(s.t, s.q, s.v, &p, A);
  slider_crank_mass(s.t, s.q, s.v, &p, M);
  slider_crank_bias(s.t, s.q, s.v, &p, b);
  slider_crank_accel(s.t, s.q, s.v, &p, a);
  slider_crank_multipliers(s.t, s.q, s.v, &p, lambda);
  near("M11 of the crank", M[0], p.J1, 0);
  for (int i = 0; i < 3; i++)
    near("M q'' + b = A^T lambda", M[3 * i] * a[0] + M[3 * i + 1] * a[1] + M[3 * i + 2] * a[2] + b[i],
         A[i] * lambda[0] + A[3 + i] * lambda[1], 1e-13);
}

/* Bounces at sqrt(2h/g) (1 + 2e + 2e^2 + ...), with speeds e^k sqrt(2gh). */
static void events(void) {
  bouncing_ball_params p;
  bouncing_ball_state s;
  int event, stop = 0;
  bouncing_ball_defaults(&p);
  bouncing_ball_start(&p, &s);
  const double fall = sqrt(2 * p.h / p.g);
  double t = fall, speed = sqrt(2 * p.g * p.h), flight = 2 * fall;
  for (int k = 0; k < 5; k++) {
    for (event = -1; event < 0;)
      if (bouncing_ball_step_until_event(&p, &s, 0.01, &event) != BOUNCING_BALL_OK) bad = event = 1;
    near("bounce", s.t, t, 1e-13);
    near("event", event, BOUNCING_BALL_EV_FLOOR, 0);
    near("speed", s.v[0], -speed, 1e-12);
    near("place", s.q[0], 0, 1e-14);
    bouncing_ball_act(event, &p, &s, &stop);
    flight *= p.e, speed *= p.e, t += flight;
  }
}

/* Steps longer than the flights, to the end of all bounces at fall (1 + e)/(1 - e): no bounce is passed over, and
 * the end is told. */
static void long_steps(void) {
  bouncing_ball_params p;
  bouncing_ball_state s, was;
  int event, stop = 0, status, bounces = 0;
  bouncing_ball_defaults(&p);
  bouncing_ball_start(&p, &s);
  const double fall = sqrt(2 * p.h / p.g);
  double t = fall, flight = 2 * fall;
  do {
    was = s;
    status = bouncing_ball_step_until_event(&p, &s, 2, &event);
    if (status != BOUNCING_BALL_OK) break;
    near("a bounce in each step", event, 0, 0);
    near("its time", s.t, t, 1e-13 * (1 + bounces)); /* rounding of the times before adds up */
    bouncing_ball_act(event, &p, &s, &stop);
    flight *= p.e, t += flight;
  } while (++bounces < 1000);
  near("the end is told", status, BOUNCING_BALL_EZENO, 0);
  near("and changes nothing", memcmp(&s, &was, sizeof s), 0, 0);
  near("where the bounces end", s.t, fall * (1 + p.e) / (1 - p.e), 1e-12);

  /* thrown from the floor, at once or after steps: exactly on the event, which waits until the ball has left it */
  for (int k = 0; k < 2; k++) {
    bouncing_ball_start(&p, &s);
    s.q[0] = 0, s.v[0] = 3, s.lost[1] = k ? 1e-30 : 0;
    near("thrown", bouncing_ball_step_until_event(&p, &s, 1, &event), BOUNCING_BALL_OK, 0);
    near("lands", event, 0, 0);
    near("after 2 v/g", s.t, 6 / p.g, 1e-14);
  }
  bouncing_ball_start(&p, &s); /* dropped from the floor: as `lagc run`, no event at the start */
  s.q[0] = 0, s.v[0] = -3;
  near("dropped", bouncing_ball_step_until_event(&p, &s, 1, &event), BOUNCING_BALL_OK, 0);
  near("no event", event, -1, 0);
  was = s;
  p.g = sqrt(-1.0);
  near("no number", bouncing_ball_step_until_event(&p, &s, 1, &event), BOUNCING_BALL_ENAN, 0);
  near("leaves the state", memcmp(&s, &was, sizeof s), 0, 0);
}

static void names(void) {
  near("a name", strcmp(double_pendulum_names_q[DOUBLE_PENDULUM_TH2].name, "th2"), 0, 0);
  near("its unit", strcmp(double_pendulum_names_q[0].unit, "rad"), 0, 0);
  near("a bound", double_pendulum_names_p[DOUBLE_PENDULUM_P_M1].least, 0, 0);
  near("none above", double_pendulum_names_p[DOUBLE_PENDULUM_P_M1].most == HUGE_VAL, 1, 0);
  near("the interface", DOUBLE_PENDULUM_ABI, 2, 0);
}

int main(void) {
  mass();
  constraints();
  events();
  long_steps();
  names();
  return bad;
}
