/* Each way in which a run can fail: the status, when and where it says so, and the state that is left. */
#include "test_rt_models.h"

static lag_option step_10ms[] = {{"step", 0.01, NULL}};

/* Runs a scene to t with method i; the message must hold `words`. */
static void expect_failure(const lag_scene *scene, const lag_method *m, double t, int status, double when, double within,
                           const char *words)
{
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
  lag_sim *s = sim_with(&late, &lag_rk4, 0, 1, tiny);
  assert_int_equal(lag_sim_advance(s, 2), LAG_ESTEP);
  lag_sim_free(s);
}

static void settings_are_checked(void **state)
{
  lag_sim *s = lag_sim_new(&ball);
  lag_option bad_name[] = {{"stepp", 0.1, NULL}}, bad_value[] = {{"step", -1, NULL}}, word[] = {{"step", 0, "large"}};
  (void)state;
  assert_int_equal(lag_sim_set_tolerance(s, 0), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tolerance(s, -1e-9), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tolerance(s, NAN), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tolerance(s, 1e-17), LAG_EINVAL);
  assert_non_null(strstr(lag_sim_message(s), "1e-15"));
  assert_int_equal(lag_sim_set_method(s, &lag_rk4, bad_name, 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_method(s, &lag_rk4, bad_value, 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_method(s, &lag_rk4, word, 1), LAG_EINVAL);
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
      cmocka_unit_test(a_singular_mass_matrix_stops_the_run),
      cmocka_unit_test(outside_the_domain_smaller_steps_are_tried),
      cmocka_unit_test(a_singularity_stops_at_the_smallest_step),
      cmocka_unit_test(a_step_that_time_does_not_feel_is_refused),
      cmocka_unit_test(settings_are_checked),
      cmocka_unit_test(another_abi_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
