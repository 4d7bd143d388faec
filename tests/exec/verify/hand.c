/* Right-hand sides written by hand from textbooks, and functions that are no right-hand sides: tests/exec/verify.sh. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* GSL's arguments: const double y[], void *params. */
struct rod {
  double m, l, g;
};
int pendulum_gsl(double t, const double y[], double dydt[], void *params) {
  const struct rod *p = params;
  dydt[0] = y[1];
  dydt[1] = -p->g/p->l*sin(y[0]);
  (void)t;
  return 0;
}

/* static, without const, with output of its own, and its arguments are overwritten. */
static void pendulum(double t, double *y, double *dydt, double *p) {
  printf("%g\n", t);
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sin(y[0]);
  y[0] = y[1] = p[0] = p[1] = p[2] = 0;
}

/* Times before the start of the scene are refused. */
void from_start(double t, const double *y, double *dydt, const double *p) {
  assert(t >= 0);
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sin(y[0]);
}

/* Newton's gravitation. */
void kepler(double t, const double *y, double *dydt, const double *p) {
  double r = hypot(y[0], y[1]), mu = p[0];
  dydt[0] = y[2];
  dydt[1] = y[3];
  dydt[2] = -mu*y[0]/(r*r*r);
  dydt[3] = -mu*y[1]/(r*r*r);
  (void)t;
}

/* The coordinates with their velocities: y = x, x', th, th'. */
void cart_pendulum(double t, const double *y, double *dydt, const double *p) {
  double M = p[0], m = p[1], l = p[2], g = p[3], s = sin(y[2]), c = cos(y[2]), w = y[3];
  dydt[0] = y[1];
  dydt[1] = m*s*(l*w*w + g*c)/(M + m*s*s);
  dydt[2] = w;
  dydt[3] = -(m*l*w*w*s*c + (M + m)*g*s)/(l*(M + m*s*s));
  (void)t;
}

/* Lorenz 1963, equations (25) to (27): states only. */
void lorenz(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = p[0]*(y[1] - y[0]);
  dydt[1] = y[0]*(p[1] - y[2]) - y[1];
  dydt[2] = y[0]*y[1] - p[2]*y[2];
  (void)t;
}

/* Two effects, and the time. p = J, w0, beta, gamma, w. */
void driven(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = -2*p[2]*y[1] - p[1]*p[1]*sin(y[0]) + p[3]*p[1]*p[1]*cos(p[4]*t);
}

void spherical(double t, const double *y, double *dydt, const double *p) {
  double s = sin(y[0]), c = cos(y[0]);
  dydt[0] = y[2];
  dydt[1] = y[3];
  dydt[2] = s*c*y[3]*y[3] - p[2]/p[1]*s;
  dydt[3] = -2*y[2]*y[3]*c/s;
  (void)t;
}

/* One coordinate and one state: y = th, th', i. */
void motor(double t, const double *y, double *dydt, const double *p) {
  double U = p[0], m = p[1], l = p[2], J = p[3], g = p[4], K = p[5], R = p[6], L = p[7], b = p[8];
  dydt[0] = y[1];
  dydt[1] = (K*y[2] - b*y[1] - m*g*l*sin(y[0]))/(m*l*l + J);
  dydt[2] = (U - R*y[2] - K*y[1])/L;
  (void)t;
}

/* A planar pendulum as a point on a constraint: x'' = -lambda x, lambda from x x'' + y y'' + v^2 = 0 and x^2 + y^2 =
 * l^2. p = m, l, g. */
void point_on_rod(double t, const double *y, double *dydt, const double *p) {
  double lambda = (y[2]*y[2] + y[3]*y[3] - p[2]*y[1])/(p[1]*p[1]);
  dydt[0] = y[2];
  dydt[1] = y[3];
  dydt[2] = -lambda*y[0];
  dydt[3] = -lambda*y[1] - p[2];
  (void)t;
}

/* 1 - cos(x) and 1 - 1/(1 + x) lose digits near 0; p = m, a, b. */
void cancels(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = -(p[1]*(1 - cos(y[0])) + p[2]*(1 - 1/(1 + y[0]*y[0])))/p[0];
  (void)t;
}

/* Loses 13 bits of each value. */
void loses_digits(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = 1e4 - (1e4 + p[2]/p[1]*sin(y[0]));
  (void)t;
}

/* Subtracts 9.81 exactly, which is no double. */
void balance(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = 9.81 - y[0];
  (void)t, (void)p;
}

/* A ball above a floor; what it says below means nothing. */
void ball(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = y[0] < 0 ? -1e4*y[0] : -p[1];
  (void)t;
}

/* Real for a few of the states that are drawn. */
void narrow(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = -sqrt(y[0] - 1.8);
  (void)t, (void)p;
}

/* Real for x >= 0, as the model's text; the derived equation is -x. */
void root(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = -sqrt(y[0])*sqrt(y[0]);
  (void)t, (void)p;
}

/* ---- functions that are no right-hand sides of the pendulum ---- */

void crashes(double t, const double *y, double *dydt, const double *p) {
  (void)t, (void)y, (void)dydt, (void)p;
  abort();
}
void crashes_late(double t, const double *y, double *dydt, const double *p) {
  if (t > 0.25) abort();
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sin(y[0]);
}
void loops(double t, const double *y, double *dydt, const double *p) {
  for (volatile double *d = dydt;; *d = t) (void)y, (void)p;
}
void exits(double t, const double *y, double *dydt, const double *p) {
  (void)t, (void)y, (void)dydt, (void)p;
  exit(0);
}
void writes_past(double t, const double *y, double *dydt, const double *p) {
  pendulum(t, (double[]){y[0], y[1]}, dydt, (double[]){p[0], p[1], p[2]});
  dydt[2] = 0;
}
void leaves_out(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  (void)t, (void)p;
}
void is_nan(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = sqrt(-1 - p[2]);
  (void)t;
}
void reads_past_y(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sin(y[0]) + 0*y[2];
  (void)t;
}
void reads_past_p(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sin(y[0]) - p[3]*y[1];
  (void)t;
}
void reads_before_y(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1] + 0*y[-1];
  dydt[1] = -p[2]/p[1]*sin(y[0]);
  (void)t;
}
int fails(double t, const double *y, double *dydt, const double *p) {
  pendulum(t, (double[]){y[0], y[1]}, dydt, (double[]){p[0], p[1], p[2]});
  return 7;
}
void remembers(double t, const double *y, double *dydt, const double *p) {
  static double calls;
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sin(y[0])*(1 + 1e-3*calls++);
  (void)t;
}
void single(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = -(float)p[2]/p[1]*sin(y[0]);
  (void)t;
}
void random_bits(double t, const double *y, double *dydt, const double *p) {
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sin(y[0]) + sin(1e17*y[0]);
  (void)t;
}
void of_floats(double t, const float *y, float *dydt, const float *p) {
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sinf(y[0]);
  (void)t;
}
void of_three(double t, const double *y, double *dydt) {
  dydt[0] = y[1];
  dydt[1] = -9.81*sin(y[0]);
  (void)t;
}
void p_before_dydt(double t, const double *y, const double *p, double *dydt) {
  dydt[0] = y[1];
  dydt[1] = -p[2]/p[1]*sin(y[0]);
  (void)t;
}

int main(void) { return 3; }
