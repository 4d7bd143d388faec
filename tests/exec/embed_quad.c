/* A header in quadruple precision, and in the complex numbers of C: the pendulum's acceleration against -g/l
 * sin(th). */
#ifdef QUAD
#include <quadmath.h>
#define PENDULUM_REAL __float128
#define PENDULUM_FN(f) f##q
#define PENDULUM_C(x) x##Q
#else
#include <complex.h>
typedef double _Complex scalar;
#define PENDULUM_REAL scalar
#define PENDULUM_FN(f) c##f
#define PENDULUM_COMPLEX
#endif
#define PENDULUM_LIBM
#define PENDULUM_IMPLEMENTATION
#include "pendulum.h"

int main(void) {
  pendulum_params p;
  pendulum_state s;
  PENDULUM_REAL a[1];
  pendulum_defaults(&p);
  pendulum_start(&p, &s);
#ifdef QUAD
  s.q[0] = 0.7Q;
  if (pendulum_accel(s.t, s.q, s.v, &p, a) != PENDULUM_OK) return 1;
  /* sin(0.7) by mpmath */
  const __float128 want = -9.81Q * 0.64421768723769105367261435139872018306581Q;
  return !(fabsq(a[0] - want) <= 1e-32Q);
#else
  s.q[0] = 0.7 + 1e-100 * _Complex_I;
  if (pendulum_accel(s.t, s.q, s.v, &p, a) != PENDULUM_OK) return 1;
  return !(fabs(cimag(a[0]) / 1e-100 + 9.81 * cos(0.7)) <= 1e-14);
#endif
}
