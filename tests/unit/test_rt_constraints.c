/* Models with constraints: steps end on them, and so does what lies between steps; methods keep their order; who
 * cannot hold them refuses. Expected values: closed forms, the pendulum in its angle by a step size that leaves
 * nothing, and published rules. */
#include "test_rt_constrained.h"

/* The largest |c| and |r| against what they are made of, of size 1 here. */
static double off(const lag_scene *scene, double t, const double *y)
{
  const lag_model *m = scene->model;
  double c[MOST_C] = {0}, r[MOST_C], most = 0;
  m->constraints->residuals(m->constraints, t, y, y + m->nq, NULL, NULL, NULL, c, r, NULL);
  for (int k = 0; k < m->constraints->n; k++) {
    most = fmax(most, fmax(k < m->constraints->nholonomic ? fabs(c[k]) : 0, fabs(r[k])));
  }
  return most;
}

static double state_error(const lag_scene *scene, const lag_sim *s, const double *y)
{
  int nq = scene->model->nq;
  return fmax(distance(nq, lag_sim_q(s), y), distance(nq, lag_sim_v(s), y + nq));
}

/* Where the rod is at t: its angle from below, by steps of order 8. */
static int angle_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -9.81 * sin(q[0]);
  return 0;
}

static void angle_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 1.57079632679489661923;
  v[0] = 0;
}

SYSTEM(angle, 1, SEPARABLE, NULL, NO_DERIVATIVES);

static void rod_exact(double t, double *y)
{
  lag_sim *s = sim_with(&angle, &lag_dop853, 1e-14, 0, NULL);
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  double a = lag_sim_q(s)[0], w = lag_sim_v(s)[0];
  y[0] = sin(a);
  y[1] = -cos(a);
  y[2] = w * cos(a);
  y[3] = w * sin(a);
  lag_sim_free(s);
}

typedef struct Case {
  const lag_scene *scene;
  void (*exact)(double t, double *y);
} Case;

static const Case cases[] = {
    {&rod, rod_exact}, {&twice, rod_exact}, {&reel, reel_exact}, {&turntable, turntable_exact}, {&knife, knife_exact}};
enum { CASES = sizeof cases / sizeof *cases };

static int watch_step(void *worst, const lag_sim *s)
{
  double y[2 * MOST_Q];
  memcpy(y, lag_sim_q(s), (size_t)lag_sim_scene(s)->model->nq * 2 * sizeof *y); /* q and v are one array */
  *(double *)worst = fmax(*(double *)worst, off(lag_sim_scene(s), lag_sim_time(s), y));
  return 0;
}

/* Each model to t = 3 by the adaptive methods; and on the constraints, at ends of steps and between, to a few last
 * digits. */
static void adaptive_methods_follow_and_hold(void **state)
{
  static const lag_method *const methods[] = {&lag_rk45, &lag_dop853, &lag_radau};
  static const double tolerances[] = {1e-10, 1e-10, 1e-13}; /* of radau 0.1 tol^(2/3), by an estimate of order 3 */
  (void)state;
  for (size_t k = 0; k < CASES; k++) {
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
      double y[2 * MOST_Q], worst = 0, between = 0;
      lag_sim *s = sim_with(cases[k].scene, methods[i], tolerances[i], 0, NULL);
      lag_sim_on_step(s, watch_step, &worst);
      for (double t = 0; t < 3; t += 0.01) {
        assert_int_equal(lag_sim_advance(s, t), LAG_OK);
        watch_step(&between, s);
      }
      assert_int_equal(lag_sim_advance(s, 3), LAG_OK);
      cases[k].exact(3, y);
      /* tolerance times what a good solver's error is made of */
      assert_close(distance(2, lag_sim_q(s), y), 0, 3e-8);
      assert_close(distance(2, lag_sim_v(s), y + cases[k].scene->model->nq), 0, 3e-8);
      assert_close(worst, 0, 2e-14); /* terms up to 25, in the last digit */
      assert_close(between, 0, 2e-14);
      lag_sim_free(s);
    }
  }
}

/* The error at t = 1 with n steps. */
static double error_at_1(const Case *c, const lag_method *m, int n, int nopt, const lag_option *more)
{
  lag_option opt[4] = {{"step", 1.0 / n, NULL}};
  double y[2 * MOST_Q];
  if (nopt) {
    memcpy(opt + 1, more, (size_t)nopt * sizeof *more);
  }
  lag_sim *s = sim_with(c->scene, m, 1e-9, nopt + 1, opt);
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  c->exact(1, y);
  double e = c->scene == &turntable ? distance(2, lag_sim_q(s), y) : state_error(c->scene, s, y); /* a, b: not told */
  lag_sim_free(s);
  return e;
}

static void projection_keeps_the_order(void **state)
{
  static const lag_option fixed[] = {{"adapt", 0, "off"}};
  static const struct {
    const lag_method *method;
    int n, nopt;
    double order;
  } at[] = {{&lag_rk4, 40, 0, 4}, {&lag_rk45, 40, 1, 5}, {&lag_dop853, 10, 1, 8}, {&lag_radau, 20, 1, 5}};
  (void)state;
  for (size_t k = 0; k < CASES; k++) {
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
      double e1 = error_at_1(&cases[k], at[i].method, at[i].n, at[i].nopt, fixed);
      double e2 = error_at_1(&cases[k], at[i].method, 2 * at[i].n, at[i].nopt, fixed);
      double slope = log2(e1 / e2);
      if (e2 > 1e-13 && !(slope > at[i].order - 0.4 && slope < at[i].order + 1.6)) {
        fail_msg("%s, %s: errors %g and %g, order %g", cases[k].scene->name, at[i].method->name, e1, e2, slope);
      }
    }
  }
}

/* Without care the radius of the rod drifts: what is measured here is that it does not, in every digit that is
 * there. */
static void long_runs_stay(void **state)
{
  (void)state;
  lag_sim *s = sim_with(&rod, &lag_rk4, 0, 1, (lag_option[]){{"step", 1e-2, NULL}});
  double worst = 0;
  for (int i = 1; i <= 20000; i++) {
    assert_int_equal(lag_sim_advance(s, i * 0.005), LAG_OK);
    worst = fmax(worst, off(&rod, 0, lag_sim_q(s)));
  }
  assert_close(worst, 0, 1e-14);
  lag_sim_free(s);
}

static void what_cannot_hold_refuses(void **state)
{
  (void)state;
  for (int i = 0; i < lag_nmethods; i++) {
    lag_sim *s = lag_sim_new(&rod);
    int holds = (lag_methods[i]->flags & LAG_METHOD_CONSTRAINTS) != 0;
    int rc = lag_sim_set_method(s, lag_methods[i], NULL, 0);
    assert_int_equal(rc, holds ? LAG_OK : LAG_EMETHOD);
    if (!holds) {
      assert_non_null(strstr(lag_sim_message(s), "cannot hold constraints (rod); rk45"));
    }
    lag_sim_free(s);
  }
  lag_sim *s = lag_sim_new(&rod);
  assert_int_equal(lag_sim_set_method(s, &lag_variational, (lag_option[]){{"order", 4, NULL}}, 1), LAG_EINVAL);
  assert_non_null(strstr(lag_sim_message(s), "order = 4: with constraints it is 2"));
  lag_sim_free(s);
}

/* ---- RATTLE */

/* Exact digits of the algorithm itself, in 60-digit arithmetic by an independent script: p0+ = p0 + A(q0)^T lambda,
 * c(q1) = 0, A(q1) v1 = 0, from (1, 0) at rest, 1000 steps of 0.01; and the largest error of the energy on the way.
 * */
static int watch_energy(void *worst, const lag_sim *s)
{
  double e[2];
  lag_sim_scene(s)->model->energy(lag_sim_scene(s)->model, 0, lag_sim_q(s), lag_sim_v(s), NULL, NULL, NULL, e, NULL);
  *(double *)worst = fmax(*(double *)worst, fabs(e[0]));
  return 0;
}

static void verlet_is_rattle(void **state)
{
  static const double end[4] = {0.2692700072386527847616967, -0.9630647243055348649666615, -4.185581063924643524422612,
                                -1.170275906630961487629979};
  static const lag_option step[] = {{"step", 0.01, NULL}};
  (void)state;
  for (int pass = 0; pass < 2; pass++) { /* each rule of order 2 is the same here but for the gravity's place */
    lag_sim *s = sim_with(&rod, pass ? &lag_variational : &lag_verlet, 0, 1, step);
    double energy = 0, worst = 0;
    lag_sim_on_step(s, watch_energy, &energy);
    assert_int_equal(lag_sim_advance(s, 9.995), LAG_OK); /* to the end of the last step itself: h is no binary number */
    assert_int_equal(lag_sim_advance(s, 10), LAG_OK);
    watch_step(&worst, s);
    assert_close(distance(2, lag_sim_q(s), end), 0, 1e-11); /* the tolerance that was stated with the digits */
    assert_close(distance(2, lag_sim_v(s), end + 2), 0, 1e-11);
    assert_close(energy / 0.00360941780225761, 1, 1e-6);
    assert_close(worst, 0, 4e-15);
    lag_sim_free(s);
  }
}

/* The errors at t = 1 with n and 2 n steps, of all that are symplectic: all order, with constraints of each kind. */
static void rattle_and_its_compositions_have_their_order(void **state)
{
  static const struct {
    const lag_method *method;
    int n;
  } at[] = {{&lag_symplectic_euler, 40}, {&lag_verlet, 20}, {&lag_variational, 20},
            {&lag_verlet4, 10},          {&lag_verlet6, 6}, {&lag_verlet8, 4}};
  (void)state;
  for (size_t k = 0; k < CASES; k++) {
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
      double e1 = error_at_1(&cases[k], at[i].method, at[i].n, 0, NULL),
             e2 = error_at_1(&cases[k], at[i].method, 2 * at[i].n, 0, NULL);
      double slope = log2(e1 / e2), order = at[i].method->order;
      /* the reel's Euler step is of order 2: its force is that of the string alone */
      if (e2 > 1e-12 && !(slope > order - 0.5 && slope < order + 1.6)) {
        fail_msg("%s, %s: errors %g and %g, order %g", cases[k].scene->name, at[i].method->name, e1, e2, slope);
      }
    }
  }
}

/* Backwards from the end of a run one is back at its start: the rules are their own reverse. */
static void steps_are_their_own_reverse(void **state)
{
  (void)state;
  for (size_t k = 0; k < CASES; k++) {
    const lag_model *m = cases[k].scene->model;
    const lag_option opt[] = {{"step", 1.0 / 16, NULL}};
    double y[2 * MOST_Q], worst = 0;
    lag_sim *s = sim_with(cases[k].scene, &lag_variational, 0, 1, opt);
    assert_int_equal(lag_sim_advance(s, 2), LAG_OK);
    memcpy(y, lag_sim_q(s), (size_t)m->nq * 2 * sizeof *y);
    lag_sim_free(s);
    lag_scene back = *cases[k].scene;
    back.t0 = 2;
    back.t1 = 0;
    s = sim_with(&back, &lag_variational, 0, 1, opt);
    for (int i = 0; i < 2 * m->nq; i++) {
      char name[16];
      lag_sim_state_info(s, i, name, sizeof name, NULL, 0);
      assert_int_equal(lag_sim_set(s, name, y[i]), 0);
    }
    if (lag_sim_advance(s, 0)) {
      fail_msg("%s: %s", m->name, lag_sim_message(s));
    }
    double q0[MOST_Q], v0[MOST_Q];
    cases[k].scene->start(cases[k].scene, NULL, q0, v0, NULL);
    worst = fmax(distance(m->nq, lag_sim_q(s), q0), distance(m->nq, lag_sim_v(s), v0));
    assert_close(worst, 0, 1e-12); /* 64 steps, rounding */
    lag_sim_free(s);
  }
}

typedef struct Trend {
  double n, st, se, stt, ste, worst;
} Trend;

static int watch_trend(void *context, const lag_sim *s)
{
  Trend *w = context;
  double e[2], t = lag_sim_time(s), y[4];
  memcpy(y, lag_sim_q(s), sizeof y);
  rod_energy(NULL, 0, y, y + 2, NULL, NULL, NULL, e, NULL);
  w->n += 1;
  w->st += t;
  w->se += e[0];
  w->stt += t * t;
  w->ste += t * e[0];
  w->worst = fmax(w->worst, fabs(y[0] * y[0] + y[1] * y[1] - 1));
  return 0;
}

/* The straight line through the energies of many swings is level: what is left of their error, 4e-3 that goes to and
 * fro about 700 times, is at most one swing's worth at the end. */
static void energy_has_no_trend(void **state)
{
  Trend w = {0};
  (void)state;
  lag_sim *s = sim_with(&rod, &lag_variational, 0, 1, (lag_option[]){{"step", 0.01, NULL}});
  lag_sim_on_step(s, watch_trend, &w);
  assert_int_equal(lag_sim_advance(s, 1000), LAG_OK);
  double slope = (w.n * w.ste - w.st * w.se) / (w.n * w.stt - w.st * w.st);
  assert_close(slope * 1000, 0, 4e-3 / 700 * 12);
  assert_close(w.worst, 0, 1e-14);
  lag_sim_free(s);
}

/* Long steps need many corrections of the impulse, too long ones have no solution. */
static void long_steps_say_what_is_wrong(void **state)
{
  (void)state;
  lag_sim *s = sim_with(&rod, &lag_variational, 0, 1, (lag_option[]){{"step", 0.2, NULL}});
  assert_int_equal(lag_sim_advance(s, 10), LAG_OK);
  lag_sim_free(s);
  s = sim_with(&rod, &lag_variational, 0, 1, (lag_option[]){{"step", 0.6, NULL}});
  assert_int_equal(lag_sim_advance(s, 10), LAG_EMETHOD);
  assert_true(strstr(lag_sim_message(s), "the step is too long") || strstr(lag_sim_message(s), "take smaller steps"));
  lag_sim_free(s);
}

/* ---- starts */

typedef struct Given {
  const lag_scene *of;
  double x, y; /* NaN: not given */
  double at[2];
  double within;
} Given;

/* The rod from what is given of its end: the other coordinate follows; where that cannot be, both move to the
 * nearest place. */
static void starts_are_made_consistent(void **state)
{
  static const unsigned char none[4] = {0};
  static const Given given[] = {
      {&rod, 0.6, NAN, {0.6, 0.8}, 1e-15},       /* in the middle between 0.8 and -0.8: the upper one */
      {&rod, NAN, -0.8, {0.6, -0.8}, 1e-15},     /* x is 1 as the scene has it, and gives way */
      {&rod, 3, -4, {0.6, -0.8}, 1e-15},         /* both given: along the radius */
      {&twice, 3, -4, {0.6, -0.8}, 1e-15},
      {&rod, 2, NAN, {1, 0}, 1e-8},              /* no y helps; the nearest place is a double root in y */
  };
  (void)state;
  for (size_t k = 0; k < sizeof given / sizeof *given; k++) {
    lag_scene scene = *given[k].of;
    scene.given = none;
    lag_sim *s = lag_sim_new(&scene);
    assert_int_equal(isnan(given[k].x) ? 0 : lag_sim_set(s, "x", given[k].x), 0);
    assert_int_equal(isnan(given[k].y) ? 0 : lag_sim_set(s, "y", given[k].y), 0);
    assert_int_equal(lag_sim_set(s, "x'", 1), 0);
    assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
    double x = given[k].at[0], y = given[k].at[1];
    assert_close(lag_sim_q(s)[0], x, given[k].within);
    assert_close(lag_sim_q(s)[1], y, given[k].within);
    if (y != 0.0) { /* x' = 1 stays, and y' follows */
      assert_close(lag_sim_v(s)[0], 1, 1e-15);
      assert_close(lag_sim_v(s)[1], -x / y, 4e-15);
    }
    assert_close(lag_sim_requested_start(s, 0), isnan(given[k].x) ? 1 : given[k].x, 0);
    assert_close(lag_sim_actual_start(s, 0), lag_sim_q(s)[0], 0);
    lag_sim_free(s);
  }
}

/* On x^2/4 + y^2 = 1 the nearest place to (3, 1) is where the way to it stands upright on the curve. */
static int oval_residuals(ARGS, double *c, double *r, UNUSED double *w)
{
  c[0] = q[0] * q[0] / 4 + q[1] * q[1] - 1;
  r[0] = q[0] * v[0] / 2 + 2 * q[1] * v[1];
  return 0;
}

static int oval_matrices(ARGS, double *A, double *M, UNUSED double *w)
{
  A[0] = q[0] / 2;
  A[1] = 2 * q[1];
  M[0] = 1;
  M[1] = 9; /* the way is measured with it */
  return 0;
}

#define oval_of rod_of
#define oval_jacobian rod_jacobian
CONSTRAINED(oval, 2, 1, 1, 2);

static void positions_move_the_least(void **state)
{
  lag_model model = rod_model;
  lag_scene scene = rod;
  (void)state;
  model.constraints = &oval_held;
  scene.model = &model;
  lag_sim *s = lag_sim_new(&scene);
  assert_int_equal(lag_sim_set(s, "x", 3), 0);
  assert_int_equal(lag_sim_set(s, "y", 1), 0);
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  double x = lag_sim_q(s)[0], y = lag_sim_q(s)[1];
  assert_close(x * x / 4 + y * y, 1, 4e-16);
  assert_close((3 - x) * 2 * y - 9 * (1 - y) * x / 2, 0, 1e-6); /* at a minimum, half the digits decide */
  assert_true(x > 1 && y > 0);
  lag_sim_free(s);
}

/* Without what is given, all velocities move to the nearest: (1, 1) at 45 degrees on the rod loses what is radial. */
static void velocities_move_the_least(void **state)
{
  (void)state;
  lag_sim *s = lag_sim_new(&rod);
  assert_int_equal(lag_sim_set(s, "x", sqrt(0.5)), 0);
  assert_int_equal(lag_sim_set(s, "y", -sqrt(0.5)), 0);
  assert_int_equal(lag_sim_set(s, "x'", 3), 0);
  assert_int_equal(lag_sim_set(s, "y'", 1), 0);
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  assert_close(lag_sim_v(s)[0], 2, 1e-15);
  assert_close(lag_sim_v(s)[1], 2, 1e-15);
  lag_sim_free(s);
}

static void exactly_means_that(void **state)
{
  lag_scene scene = rod;
  (void)state;
  scene.exactly = 1;
  lag_sim *s = lag_sim_new(&scene);
  assert_int_equal(lag_sim_set(s, "x", 1.1), 0);
  assert_int_equal(lag_sim_advance(s, 1), LAG_EINVAL);
  assert_non_null(strstr(lag_sim_message(s), "constraint rod (line 7) is off by 0.21 m^2; without `exactly`"));
  lag_sim_free(s);
  s = lag_sim_new(&scene); /* what digits of a text leave out is no contradiction */
  assert_int_equal(lag_sim_set(s, "x", 0.7071067812), 0);
  assert_int_equal(lag_sim_set(s, "y", 0.7071067812), 0);
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  assert_close(off(&scene, 0, lag_sim_q(s)), 0, 5e-16);
  lag_sim_free(s);
}

/* x^2 + y^2 = 1 and x^2 + y^2 = -1. */
static int never_residuals(ARGS, double *c, double *r, double *w)
{
  twice_residuals(self, t, q, v, z, p, u, c, r, w);
  c[1] = q[0] * q[0] + q[1] * q[1] + 1;
  return 0;
}

static void impossible_starts_are_refused(void **state)
{
  lag_constraints of = twice_held;
  lag_model model = twice_model;
  lag_scene scene = twice;
  (void)state;
  of.residuals = never_residuals;
  model.constraints = &of;
  scene.model = &model;
  lag_sim *s = lag_sim_new(&scene);
  assert_int_equal(lag_sim_advance(s, 1), LAG_EINVAL);
  assert_non_null(strstr(lag_sim_message(s), "no start obeys the constraints"));
  assert_non_null(strstr(lag_sim_message(s), "constraint again (line 8)"));
  lag_sim_free(s);
}

/* x^2 + y^2 = 1 and 3 (x^2 + y^2) = 3 + t^3, which agree at the start. */
static int parting_residuals(ARGS, double *c, double *r, double *w)
{
  twice_residuals(self, t, q, v, z, p, u, c, r, w);
  c[1] -= t * t * t;
  r[1] -= 3 * t * t;
  return 0;
}

static void constraints_that_part_are_named(void **state)
{
  static const lag_method *const methods[] = {&lag_rk4, &lag_rk45, &lag_dop853, &lag_variational, &lag_verlet4};
  lag_constraints of = twice_held;
  lag_model model = twice_model;
  lag_scene scene = twice;
  (void)state;
  of.residuals = parting_residuals;
  model.constraints = &of;
  scene.model = &model;
  for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
    lag_sim *s = sim_with(&scene, methods[i], 1e-9, 0, NULL);
    assert_true(lag_sim_advance(s, 1) < 0);
    assert_true(lag_sim_time(s) < 0.01);
    assert_non_null(strstr(lag_sim_message(s), "constraint "));
    lag_sim_free(s);
  }
}

static void redundant_constraints_are_found(void **state)
{
  (void)state;
  lag_sim *s = lag_sim_new(&twice);
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  assert_int_equal(lag_sim_rank(s), 1);
  assert_int_equal(lag_sim_is_redundant(s, 0) + lag_sim_is_redundant(s, 1), 1);
  lag_sim_free(s);
  s = lag_sim_new(&turntable);
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  assert_int_equal(lag_sim_rank(s), 2);
  lag_sim_free(s);
}

/* ---- many rods that swing beside each other, from other angles */

enum { RODS = 60, RODS_Q = 2 * RODS };
static int corrections;
static lag_var rods_q[RODS_Q];
static lag_constraint rods_of[RODS];
static lag_entry rods_jacobian[RODS_Q], rods_mass[RODS_Q];

static int rods_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  for (int i = 0; i < RODS_Q; i += 2) {
    double l = (v[i] * v[i] + v[i + 1] * v[i + 1] - 9.81 * q[i + 1]) / (q[i] * q[i] + q[i + 1] * q[i + 1]);
    a[i] = -l * q[i];
    a[i + 1] = -9.81 - l * q[i + 1];
  }
  return 0;
}

RESIDUALS(rods)
{
  for (int i = 0; i < RODS_Q; i += 2) {
    c[i / 2] = (q[i] * q[i] + q[i + 1] * q[i + 1] - 1) / 2;
    r[i / 2] = q[i] * v[i] + q[i + 1] * v[i + 1];
  }
  return 0;
}

MATRICES(rods)
{
  for (int i = 0; i < RODS_Q; i++) {
    A[i] = q[i];
    M[i] = 1;
  }
  return 0;
}

static int rods_change(ARGS, const double *g, double *d, double *force, UNUSED double *w)
{
  corrections++;
  for (int i = 0; i < RODS_Q; i++) {
    const double *rod = q + i / 2 * 2;
    force[i] = d[i] = g[i / 2] * q[i] / (rod[0] * rod[0] + rod[1] * rod[1]);
  }
  return 0;
}

static void rods_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  for (int i = 0; i < RODS; i++) {
    q[2 * i] = sin(1 + 0.01 * i);
    q[2 * i + 1] = -cos(1 + 0.01 * i);
    v[2 * i] = v[2 * i + 1] = 0;
  }
}

static const lag_constraints rods_held = {.n = RODS, .nholonomic = RODS, .of = rods_of, .njacobian = RODS_Q,
    .jacobian = rods_jacobian, .nmass = RODS_Q, .mass = rods_mass, .residuals = rods_residuals,
    .matrices = rods_matrices, .position = rods_change, .velocity = rods_change};
HELD(rods, RODS_Q, 0, NULL, NO_DERIVATIVES);

/* Rounding is never 0 in all of many constraints: one correction of positions and one of velocities a step are enough,
 * and a few at the start. Waiting for residuals that shrink by half took 3.1 a step. */
static void corrections_end_at_rounding(void **state)
{
  lag_stats stats;
  (void)state;
  for (int i = 0; i < RODS_Q; i++) {
    rods_q[i] = rod_q[i % 2];
    rods_of[i / 2] = rod_of[0];
    rods_jacobian[i] = (lag_entry){i / 2, i};
    rods_mass[i] = (lag_entry){i, i};
  }
  corrections = 0;
  lag_sim *s = sim_with(&rods, &lag_dop853, 1e-10, 0, NULL);
  assert_int_equal(lag_sim_advance(s, 3), LAG_OK);
  lag_sim_stats(s, &stats);
  assert_true(corrections < 2.5 * (double)(stats.steps + stats.rejected) + 8);
  for (int i = 0; i < RODS_Q; i += 2) assert_close(hypot(lag_sim_q(s)[i], lag_sim_q(s)[i + 1]), 1, 1e-15); /* ulps */
  lag_sim_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(adaptive_methods_follow_and_hold),
      cmocka_unit_test(projection_keeps_the_order),
      cmocka_unit_test(long_runs_stay),
      cmocka_unit_test(what_cannot_hold_refuses),
      cmocka_unit_test(verlet_is_rattle),
      cmocka_unit_test(rattle_and_its_compositions_have_their_order),
      cmocka_unit_test(steps_are_their_own_reverse),
      cmocka_unit_test(energy_has_no_trend),
      cmocka_unit_test(long_steps_say_what_is_wrong),
      cmocka_unit_test(starts_are_made_consistent),
      cmocka_unit_test(positions_move_the_least),
      cmocka_unit_test(velocities_move_the_least),
      cmocka_unit_test(exactly_means_that),
      cmocka_unit_test(impossible_starts_are_refused),
      cmocka_unit_test(constraints_that_part_are_named),
      cmocka_unit_test(redundant_constraints_are_found),
      cmocka_unit_test(corrections_end_at_rounding),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
