/* Models with constraints: steps end on them, and so does what lies between steps; methods keep their order; who cannot hold them
 * refuses. Expected values: closed forms, the pendulum in its angle by a step size that leaves nothing, and published rules. */
#include "test_rt_constrained.h"

/* The largest |c| and |r| against what they are made of, of size 1 here. */
static double off(const lag_scene *scene, double t, const double *y)
{
  const lag_model *m = scene->model;
  double c[MOST_C] = {0}, r[MOST_C], most = 0;
  m->constraints->residuals(t, y, y + m->nq, NULL, NULL, NULL, c, r, NULL);
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

static void angle_start(UNUSED const double *p, double *q, double *v, UNUSED double *z)
{
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

static const Case cases[] = {{&rod, rod_exact}, {&twice, rod_exact}, {&reel, reel_exact}, {&turntable, turntable_exact}, {&knife, knife_exact}};
enum { CASES = sizeof cases / sizeof *cases };

static int watch_step(void *worst, const lag_sim *s)
{
  double y[2 * MOST_Q];
  memcpy(y, lag_sim_q(s), (size_t)lag_sim_scene(s)->model->nq * 2 * sizeof *y); /* q and v are one array */
  *(double *)worst = fmax(*(double *)worst, off(lag_sim_scene(s), lag_sim_time(s), y));
  return 0;
}

/* Each model to t = 3 by the adaptive methods; and on the constraints, at ends of steps and between, to a few last digits. */
static void adaptive_methods_follow_and_hold(void **state)
{
  static const lag_method *const methods[] = {&lag_rk45, &lag_dop853};
  (void)state;
  for (size_t k = 0; k < CASES; k++) {
    for (size_t i = 0; i < 2; i++) {
      double y[2 * MOST_Q], worst = 0, between = 0;
      lag_sim *s = sim_with(cases[k].scene, methods[i], 1e-10, 0, NULL);
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
  memcpy(opt + 1, more, (size_t)nopt * sizeof *more);
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
  } at[] = {{&lag_rk4, 40, 0, 4}, {&lag_rk45, 40, 1, 5}, {&lag_dop853, 10, 1, 8}};
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

/* Without care the radius of the rod drifts: what is measured here is that it does not, in every digit that is there. */
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
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(adaptive_methods_follow_and_hold),
      cmocka_unit_test(projection_keeps_the_order),
      cmocka_unit_test(long_runs_stay),
      cmocka_unit_test(what_cannot_hold_refuses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
