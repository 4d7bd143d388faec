/* Each way in which a run can fail: the status, when and where it says so, and the state that is left. */
#include "test_rt_systems.h"

static lag_option step_10ms[] = {{"step", 0.01, NULL}};

/* Runs a scene to t with method i; the message must hold `words`. */
static void expect_failure(const lag_scene *scene, const lag_method *m, double t, int status, double when,
                           double within, const char *words) {
  lag_sim *s = sim_with(scene, m, 1e-8, m == &lag_rk4, step_10ms);
  assert_int_equal(lag_sim_advance(s, t), status);
  assert_close(lag_sim_time(s), when, within);
  if (!strstr(lag_sim_message(s), words)) {
    fail_msg("\"%s\" does not say \"%s\"", lag_sim_message(s), words);
  }
  for (int i = 0; i < 2 * scene->model->nq + scene->model->nz; i++) {
    assert_true(isfinite(lag_sim_q(s)[i]));
  }
  lag_sim_free(s);
}

FLOW(nan_after_1, (zd[0] = sqrt(1 - t), 0));
FLOW(outside_after_1, (zd[0] = 1, t > 1 ? LAG_ERETRY : 0));
FLOW(singular_after_1, (zd[0] = 1, t > 1 ? LAG_ESINGULAR : 0));
FLOW(broken_after_1, (zd[0] = 1, t > 1 ? -7 : 0));
FLOW(blows_up_at_1, (zd[0] = z[0] * z[0], 0));
FLOW(drains, (zd[0] = -1, z[0] < 0 ? LAG_ERETRY : 0));

static void nan_stops_the_run(void **state)
{
  (void)state;
  expect_failure(&nan_after_1, &lag_rk45, 5, LAG_ENAN, 1, 1e-6, "z'");
  expect_failure(&nan_after_1, &lag_rk4, 5, LAG_ENAN, 1, 0.011, "z'");
  expect_failure(&nan_after_1, lag_gsl_methods[0], 5, LAG_ENAN, 1, 1e-6, "z'");
}

/* x'' = -sqrt(1 - x), which is no number past x = 1. L = v^2/2 + 2/3 (1 - x)^(3/2). */
static int cliff_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -sqrt(1 - q[0]);
  return 0;
}

static void cliff_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 0;
  v[0] = 3;
}

UNIT_MASS(cliff, cliff_accel, -0.5 / sqrt(1 - q[0]));
SYSTEM(cliff, 1, LAG_AUTONOMOUS | LAG_CONSTANT_MASS | LAG_SEPARABLE, NULL, EXACT(cliff));

/* Explicit and implicit, separable and not: the last state is one before the cliff, and nothing that is no number is
 * left. */
static void nan_stops_every_method(void **state)
{
  lag_option step[] = {{"step", 1e-3, NULL}};
  lag_model model = cliff_model;
  lag_scene general = cliff;
  int tried = 0;
  (void)state;
  model.flags &= ~(unsigned)LAG_SEPARABLE;
  general.model = &model;
  for (int i = 0; i < 2 * lag_nmethods; i++) {
    const lag_method *m = lag_methods[i / 2];
    if (OF_BODIES(m)) continue;
    if (m->flags & LAG_METHOD_TAYLOR) {
      continue; /* its coefficients are emitted: tests/exec/run_taylor.sh */
    }
    lag_sim *s = sim_with(i % 2 ? &cliff : &general, m, 1e-8, 1, step);
    int rc = lag_sim_advance(s, 2);
    if (rc != LAG_ENAN || !strstr(lag_sim_message(s), "last good state, t = ")) {
      fail_msg("%s: %s, \"%s\"", m->name, lag_status_name(rc), lag_sim_message(s));
    }
    assert_true(isfinite(lag_sim_q(s)[0]) && isfinite(lag_sim_v(s)[0]));
    /* a step is 0.003 long there; the end of one may lie past it */
    assert_true(lag_sim_q(s)[0] > 0.98 && lag_sim_q(s)[0] <= 1.01);
    lag_sim_free(s);
    tried++;
  }
  assert_true(tried >= 20);
}

static void a_singular_mass_matrix_stops_the_run(void **state)
{
  (void)state;
  expect_failure(&singular_after_1, &lag_rk45, 5, LAG_ESINGULAR, 1, 0.75, "mass matrix is singular");
  expect_failure(&singular_after_1, &lag_rk4, 5, LAG_ESINGULAR, 1, 0.011, "last good state, t = ");
  expect_failure(&singular_after_1, lag_gsl_methods[0], 5, LAG_ESINGULAR, 1, 0.75, "mass matrix is singular");
  expect_failure(&broken_after_1, &lag_rk45, 5, LAG_EMODEL, 1, 0.5, "failed");
}

static void outside_the_domain_smaller_steps_are_tried(void **state)
{
  (void)state;
  expect_failure(&outside_after_1, &lag_rk45, 5, LAG_EDOMAIN, 1, 1e-14, "domain");
  expect_failure(&outside_after_1, &lag_rk4, 5, LAG_EDOMAIN, 1, 0.011, "domain");
  expect_failure(&drains, &lag_rk45, 5, LAG_EDOMAIN, 1, 1e-13, "z = ");
}

static void a_singularity_stops_at_the_smallest_step(void **state)
{
  (void)state;
  expect_failure(&blows_up_at_1, &lag_rk45, 5, LAG_ESTEP, 1, 1e-6, "step became too small");
}

static void a_step_that_time_does_not_feel_is_refused(void **state)
{
  lag_option tiny[] = {{"step", 1e-17, NULL}};
  static lag_scene late;
  (void)state;
  late = osc;
  late.t0 = 1;
  lag_sim *s = lag_sim_new(&late);
  assert_int_equal(lag_sim_set_method(s, &lag_rk4, tiny, 1), LAG_EINVAL);
  assert_non_null(strstr(lag_sim_message(s), "time would not move"));
  late.has_span = 1; /* nor at its end: 1e4 is rounded to 1e-12 */
  late.t1 = 1e4;
  tiny->value = 1e-13;
  assert_int_equal(lag_sim_set_method(s, &lag_rk45, tiny, 1), LAG_EINVAL);
  tiny->value = 0; /* is what the method chooses */
  assert_int_equal(lag_sim_set_method(s, &lag_rk45, tiny, 1), LAG_OK);
  lag_sim_free(s);
}

static void settings_are_checked(void **state)
{
  lag_sim *s = lag_sim_new(&ball);
  lag_option bad_name[] = {{"stepp", 0.1, NULL}}, bad_value[] = {{"step", -1, NULL}},
             no_number[] = {{"atol", HUGE_VAL, NULL}}, word[] = {{"step", 0, "large"}};
  (void)state;
  assert_int_equal(lag_sim_set_tolerance(s, 0), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tolerance(s, -1e-9), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tolerance(s, NAN), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tolerance(s, 1e-17), LAG_EINVAL);
  assert_non_null(strstr(lag_sim_message(s), "1e-15"));
  assert_int_equal(lag_sim_set_method(s, &lag_rk4, bad_name, 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_method(s, &lag_rk4, bad_value, 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_method(s, &lag_rk4, word, 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_method(s, &lag_rk45, no_number, 1), LAG_EINVAL);
  assert_ptr_equal(lag_sim_method(s), &lag_rk45); /* unchanged */
  assert_int_equal(lag_sim_set(s, "G", 1), LAG_EINVAL);
  assert_non_null(strstr(lag_sim_message(s), "did you mean"));
  assert_int_equal(lag_sim_set(s, "g", 0), LAG_EINVAL); /* declared > 0 */
  assert_int_equal(lag_sim_set(s, "h", INFINITY), LAG_EINVAL);
  assert_int_equal(lag_sim_advance(s, NAN), LAG_EINVAL);
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  assert_int_equal(lag_sim_advance(s, 0.5), LAG_EINVAL);
  assert_int_equal(lag_sim_set(s, "g", 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tolerance(s, 1e-3), LAG_EINVAL);
  assert_close(lag_sim_time(s), 1, 0);
  lag_sim_free(s);
}

static void another_abi_is_refused(void **state)
{
  lag_model m = osc_model;
  lag_scene c = osc;
  (void)state;
  c.model = &m;
  m.abi = LAG_ABI + 1;
  assert_null(lag_sim_new(&c));
  m.abi = LAG_ABI;
  m.real_size = sizeof(float);
  assert_null(lag_sim_new(&c));
  lag_sim_free(NULL);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nan_stops_the_run),
      cmocka_unit_test(nan_stops_every_method),
      cmocka_unit_test(a_singular_mass_matrix_stops_the_run),
      cmocka_unit_test(outside_the_domain_smaller_steps_are_tried),
      cmocka_unit_test(a_singularity_stops_at_the_smallest_step),
      cmocka_unit_test(a_step_that_time_does_not_feel_is_refused),
      cmocka_unit_test(settings_are_checked),
      cmocka_unit_test(another_abi_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
