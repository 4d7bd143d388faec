/* Taylor and variational steps of a header against closed forms: the pendulum with g = l = 1, released at a right
 * angle, passes its lowest point at K = (pi/2)/agm(1, sqrt(1/2)) with the speed sqrt(2). REAL: the scalar; QUAD:
 * __float128. Exit status 0 when all hold. */
#include <float.h>
#include <stdio.h>
#include <string.h>
#ifdef QUAD
#include <quadmath.h>
#define PENDULUM_REAL __float128
#define PENDULUM_FN(f) f##q
#define PENDULUM_C(x) x##Q
#define PENDULUM_LIBM
#define NUMBER(x) x##Q
#define EPSILON FLT128_EPSILON
#else
#define PENDULUM_REAL REAL
#define NUMBER(x) ((REAL)x##L)
#define EPSILON                                         \
  (sizeof(REAL) == sizeof(float)    ? (REAL)FLT_EPSILON \
   : sizeof(REAL) == sizeof(double) ? (REAL)DBL_EPSILON \
                                    : (REAL)LDBL_EPSILON)
#endif
#define PENDULUM_IMPLEMENTATION
#include "pendulum.h"

typedef PENDULUM_REAL Real;
static int bad;
static void near(const char *what, Real got, Real want, Real tolerance) {
  Real d = got - want;
  if (d <= tolerance && -d <= tolerance) return;
  printf("%s: got %.20Lg, want %.20Lg, tolerance %Lg\n", what, (long double)got, (long double)want,
         (long double)tolerance);
  bad = 1;
}

static const Real quarter = NUMBER(1.854074677301371918433850347195260046),
                  right = NUMBER(1.570796326794896619231321691639751442),
                  speed = NUMBER(1.414213562373095048801688724209698079);

static void start(pendulum_params *p, pendulum_state *s) {
  pendulum_defaults(p);
  pendulum_start(p, s);
  p->g = p->l = p->m = NUMBER(1.0);
  s->t = 0, s->q[0] = right, s->v[0] = 0;
}

static int taylor_to(pendulum_params *p, pendulum_state *s, pendulum_taylor *w, Real until) {
  int steps = 0;
  for (; s->t != until && steps < 1000; steps++)
    if (pendulum_taylor_step(p, s, w, until) != PENDULUM_OK) return -1;
  return steps;
}

/* Few steps, so that rounding stays near that of the result: 10 units in the last place of the angles that occur,
 * and for a lower order the tolerance. */
static void taylor(int order, Real tolerance) {
  pendulum_params p;
  pendulum_state s;
  static pendulum_taylor w;
  const Real allowed = 10*(tolerance > EPSILON ? tolerance : EPSILON);
  start(&p, &s);
  pendulum_taylor_begin(&w, tolerance, order);
  near("steps to the lowest point", taylor_to(&p, &s, &w, quarter) > 0, 1, 0);
  near("angle", s.q[0], 0, allowed);
  near("speed", s.v[0], -speed, allowed);
  near("and back", taylor_to(&p, &s, &w, 0) > 0, 1, 0);
  near("angle at the start", s.q[0], right, 2*allowed);
  const pendulum_state before = s;
  s.v[0] = PENDULUM_FN(sqrt)(-NUMBER(1.0));
  near("no number is refused", pendulum_taylor_step(&p, &s, &w, quarter) != PENDULUM_OK, 1, 0);
  near("and leaves the time", s.t, before.t, 0);
  s = before;
  near("nor is it a time to reach", pendulum_taylor_step(&p, &s, &w, PENDULUM_FN(sqrt)(-NUMBER(1.0))), PENDULUM_ESTEP,
       0);
  pendulum_adaptive a;
  pendulum_adaptive_begin(&a, tolerance);
  near("for dop853 either", pendulum_dop853_step(&p, &s, &a, PENDULUM_FN(sqrt)(-NUMBER(1.0))), PENDULUM_ESTEP, 0);
  near("which leaves the time", s.t, before.t, 0);
}

/* Bits of two states. */
static Real differs(const pendulum_state *a, const pendulum_state *b) {
  return a->t != b->t || a->q[0] != b->q[0] || a->v[0] != b->v[0];
}

/* A step of Taylor's method from the start at t, towards `until`; the first try is `first` long, or with 0 by the
 * series. */
static int taylor_once(Real t, Real until, Real first, pendulum_state *s, pendulum_taylor *w) {
  pendulum_params p;
  start(&p, s);
  s->t = t;
  pendulum_taylor_begin(w, PENDULUM_FN(sqrt)(EPSILON), 8);
  w->step = first;
  w->last = -NUMBER(1.0);
  return pendulum_taylor_step(&p, s, w, until);
}

/* Steps beside the caller's time: up to 1e-4 too short they are stretched to it, longer ones end there, and are as
 * if they had been tried so; a way of one rounding is gone, where the step itself may be four roundings at least. */
static void taylor_ends(void) {
  static pendulum_taylor w;
  pendulum_state free_step, s, same;
  near("a step", taylor_once(0, 1000, 0, &free_step, &w), PENDULUM_OK, 0);
  const Real h = free_step.t, unit = w.unit, stretched = h*NUMBER(1.00005);
  near("a step that is all but long enough", taylor_once(0, stretched, 0, &s, &w), PENDULUM_OK, 0);
  near("is stretched", s.t, stretched, 0);
  near("one that is not", taylor_once(0, h*NUMBER(1.0002), 0, &s, &w), PENDULUM_OK, 0);
  near("is the same as without an end", differs(&s, &free_step), 0, 0);
  near("a way far too long for a step", taylor_once(0, 8, 8, &s, &w), PENDULUM_OK, 0);
  near("is tried again, shorter", s.t < 8, 1, 0);
  near("and so is a try beyond it", taylor_once(0, 8, 64, &same, &w), PENDULUM_OK, 0);
  near("by the same steps", differs(&s, &same), 0, 0);
  near("and one of half the way", taylor_once(0, 1000, 4, &same, &w), PENDULUM_OK, 0);
  near("follows it at once", differs(&s, &same), 0, 0); /* a retry is never shorter than half */
  pendulum_params p;
  start(&p, &s);
  (void)taylor_once(0, 1000, 0, &s, &w);
  near("a short way", pendulum_taylor_step(&p, &s, &w, s.t + h/64), PENDULUM_OK, 0);
  near("keeps the unit of time", w.unit, unit, 0);
  near("a way of one rounding", taylor_once(1, 1 + EPSILON, 0, &s, &w), PENDULUM_OK, 0);
  near("is gone", s.t, 1 + EPSILON, 0);
  near("a step of two or three", taylor_once(1, 2, 3*EPSILON, &s, &w), PENDULUM_ESTEP, 0);
  if (EPSILON < NUMBER(1e-15))
    near("or one near the least number", taylor_once(0, 2, NUMBER(1e-306), &s, &w), PENDULUM_ESTEP, 0);
}

static Real variational_error(int order, int n) {
  pendulum_params p;
  pendulum_state s;
  static pendulum_variational w;
  start(&p, &s);
  near("an order that exists", pendulum_variational_begin(&w, order), PENDULUM_OK, 0);
  for (int i = 0; i < n; i++)
    if (pendulum_variational_step(&p, &s, &w, quarter/n) != PENDULUM_OK) return -1;
  const Real error = s.q[0];
  for (int i = 0; i < n; i++) /* the method is symmetric */
    if (pendulum_variational_step(&p, &s, &w, -quarter/n) != PENDULUM_OK) return -1;
  near("forth and back", s.q[0], right, 100*EPSILON); /* rounding of 2 n steps */
  return error;
}

/* The error falls by 2^order when the step is halved, within a quarter; floats have too few digits for that. */
static void variational(void) {
  pendulum_params p;
  pendulum_state s, other;
  static pendulum_variational w, fresh;
  for (int order = 2; order <= PENDULUM_VARIATIONAL_ORDER && EPSILON < NUMBER(1e-15); order += 2) {
    const Real ratio = variational_error(order, 6)/variational_error(order, 12), want = (Real)(1 << order);
    near("order", ratio, want, want/4);
  }
  near("odd orders", pendulum_variational_begin(&w, 3), PENDULUM_ENEWTON, 0);
  near("orders without room", pendulum_variational_begin(&w, PENDULUM_VARIATIONAL_ORDER + 2), PENDULUM_ENEWTON, 0);
  start(&p, &s);
  (void)pendulum_variational_begin(&w, 2);
  for (int i = 0; i < 5; i++) (void)pendulum_variational_step(&p, &s, &w, NUMBER(0.01));
  s.v[0] = NUMBER(0.5); /* a kick by the caller: the momentum is the new one */
  other = s;
  (void)pendulum_variational_begin(&fresh, 2);
  near("a step after a kick", pendulum_variational_step(&p, &s, &w, NUMBER(0.01)), PENDULUM_OK, 0);
  (void)pendulum_variational_step(&p, &other, &fresh, NUMBER(0.01));
  near("is that of a new start", s.v[0], other.v[0], 0);
  other = s;
  near("no number", pendulum_variational_step(&p, &s, &w, PENDULUM_FN(sqrt)(-NUMBER(1.0))), PENDULUM_ENEWTON, 0);
  near("leaves the state", s.q[0], other.q[0], 0);
}

int main(void) {
  taylor(0, 2*EPSILON);
  taylor(8, PENDULUM_FN(sqrt)(EPSILON));
  taylor_ends();
  variational();
  return bad;
}
