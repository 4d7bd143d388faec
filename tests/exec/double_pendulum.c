/* The emitted accelerations of models/double_pendulum.lag against hand-written ones, at random states. Prints TAP.
 *   double_pendulum [STATES]      linked with the emitted model, for LAG_REAL = double
 *
 * The formulas are typed from the textbook (the Lagrangian of Landau and Lifshitz, Mechanics, paragraph 5, problem
 * 1, solved for the accelerations by Cramer's rule), not from what lagc prints:
 *   (m1 + m2) l1 th1'' + m2 l2 th2'' cos(D) = -m2 l2 th2'^2 sin(D) - (m1 + m2) g sin(th1),    D = th1 - th2
 *   l2 th2'' + l1 th1'' cos(D) = l1 th1'^2 sin(D) - g sin(th2)
 * The judge evaluates them in quadruple precision, and also the sum of the absolute values of the terms, which is what
 * rounding is proportional to. The error of an acceleration is measured in units of the last place of that sum.
 *
 * The bound, 50 units: the emitted text has some 70 additions, multiplications and divisions, whose roundings are
 * each at most half a unit of a term in that sum: 35. Where it takes sin and cos of th1 - th2, the difference, up to
 * 7, is rounded too, by up to 4 units, and enters the accelerations through three such functions: 12. Rounding has
 * no plan, so about the square root of that, 4, is what to expect. A wrong sign or factor is off by 1e15 units. */
#include <math.h>
#include <quadmath.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "lag_model.h"

extern const lag_model double_pendulum;

static const double BOUND = 50;

typedef __float128 quad;

typedef struct {
  double q[2], v[2], p[16]; /* p: m1 m2 l1 l2 g, as declared */
} State;

static uint64_t seed = 0x9e3779b97f4a7c15u;

/* Uniform in [a, b]: splitmix64 (Steele, Lea, Flood 2014, doi:10.1145/2660193.2660195). */
static double uniform(double a, double b) {
  uint64_t z = seed += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30))*0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27))*0x94d049bb133111ebu;
  z ^= z >> 31;
  return a + (b - a)*((double)(z >> 11)/9007199254740992.0);
}

static State random_state(void) {
  State s;
  for (int i = 0; i < 2; i++) s.q[i] = uniform(-3.5, 3.5);
  for (int i = 0; i < 2; i++) s.v[i] = uniform(-20, 20);
  /* masses 1/4..4, lengths 1/2..2 */
  for (int i = 0; i < 4; i++) s.p[i] = exp2(uniform(i < 2 ? -2 : -1, i < 2 ? 2 : 1));
  s.p[4] = uniform(0, 20);
  if (double_pendulum.derive) double_pendulum.derive(&double_pendulum, s.p);
  return s;
}

/* a[2]: the accelerations; size[2]: the sum of the absolute values of what each is made of. */
static void by_hand(const State *s, quad a[2], quad size[2]) {
  const quad th1 = s->q[0], th2 = s->q[1], w1 = s->v[0], w2 = s->v[1];
  const quad m1 = s->p[0], m2 = s->p[1], l1 = s->p[2], l2 = s->p[3], g = s->p[4];
  const quad c = cosq(th1 - th2), d = sinq(th1 - th2), m = m1 + m2;
  /* Right-hand sides, and Cramer: the determinant is l1 l2 (m - m2 c^2) = l1 l2 (m1 + m2 d^2). */
  const quad r1 = -m2*l2*w2*w2*d - m*g*sinq(th1), r2 = l1*w1*w1*d - g*sinq(th2);
  const quad det = m1 + m2*d*d;
  a[0] = (r1 - m2*c*r2)/(l1*det);
  a[1] = (m*r2 - c*r1)/(l2*det);
  /* Centripetal terms as the Cartesian components (|sin|, |cos| up to 1) in which positions are written. */
  const quad b1 = m2*l2*w2*w2 + m*l1*w1*w1 + m*g, b2 = l1*w1*w1 + l2*w2*w2 + g;
  const quad lost = (m + m2)/det; /* of the determinant m - m2 c^2 */
  size[0] = lost*(b1 + m2*b2)/(l1*det);
  size[1] = lost*(m*b2 + b1)/(l2*det);
}

static double ulp_of(quad x) {
  int e;
  (void)frexpq(x, &e);
  return ldexp(1.0, e - 53);
}

int main(int argc, char **argv) {
  long states = argc > 1 ? strtol(argv[1], NULL, 10) : 100000, failed = 0;
  double worst[2] = {0, 0}, work[64];
  State at[2] = {0};
  if (double_pendulum.nq != 2 || double_pendulum.np != 5 || double_pendulum.nderived > 11 || double_pendulum.nw > 64) {
    printf("1..1\nnot ok 1 - two coordinates, five parameters\n");
    return 1;
  }
  for (long n = 0; n < states; n++) {
    const State s = random_state();
    double a[2];
    quad want[2], size[2];
    int status = double_pendulum.accel(&double_pendulum, 0, s.q, s.v, NULL, s.p, NULL, a, NULL, work);
    by_hand(&s, want, size);
    for (int i = 0; i < 2; i++) {
      double error = status ? INFINITY : (double)(fabsq(a[i] - want[i])/ulp_of(size[i]));
      if (!(error <= BOUND)) failed++;
      if (!(error <= worst[i])) worst[i] = error, at[i] = s;
    }
  }
  printf("1..2\n");
  for (int i = 0; i < 2; i++) {
    printf("%sok %d - th%d'' of the emitted C agrees with the textbook at %ld states: worst %.3g units in the last "
           "place of %g\n",
           worst[i] <= BOUND ? "" : "not ", i + 1, i + 1, states, worst[i], BOUND);
    printf("# worst at th1 %.17g th2 %.17g th1' %.17g th2' %.17g m1 %g m2 %g l1 %g l2 %g g %g\n", at[i].q[0],
           at[i].q[1], at[i].v[0], at[i].v[1], at[i].p[0], at[i].p[1], at[i].p[2], at[i].p[3], at[i].p[4]);
  }
  return failed != 0;
}
