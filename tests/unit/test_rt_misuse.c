/* The library against misuse: each public function of a simulation refuses what it cannot take, and the simulation
 * stays as it was. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "lag.h"

/* x'' = -x */
static int accel(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                 const double *u, double *a, double *zd, double *w) {
  (void)self, (void)t, (void)v, (void)z, (void)p, (void)u, (void)zd, (void)w;
  a[0] = -q[0];
  return 0;
}

static int energy(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                  const double *u, double *e, double *w) {
  (void)self, (void)t, (void)z, (void)p, (void)u, (void)w;
  e[0] = e[1] = (v[0] * v[0] + q[0] * q[0]) / 2;
  return 0;
}

static const lag_var coordinate = {.name = "x", .unit = "", .factor = 1};
static const lag_model model = {.abi = LAG_ABI,
                                .real_size = sizeof(double), .name = "spring",
                                .flags = LAG_AUTONOMOUS | LAG_SMOOTH | LAG_CONSERVES_ENERGY, .nq = 1, .q = &coordinate,
                                .accel = accel,
                                .energy = energy};

static void start(const void *self, const double *p, double *q, double *v, double *z) {
  (void)self;
  (void)p, (void)z;
  q[0] = 1;
  v[0] = 0;
}

static const lag_scene scene = {
    .name = "s", .model = &model, .start = start, .t1 = 10, .has_span = 1, .tolerance = 1e-12};
static const lag_scene elsewhere = {
    .name = "s", .model = &model, .start = start, .t1 = 10, .has_span = 1, .method = "gsl-rk8pd"};

enum { SIZE = 4096 };

static void check_state(lag_sim *s, const double *saved)
{
  double now[SIZE];

  assert_int_equal(lag_sim_save(s, now), LAG_OK);
  assert_memory_equal(now, saved, lag_sim_save_size(s) * sizeof *now);
}

static void times_that_are_none_are_refused(void **state)
{
  const double bad[] = {NAN, INFINITY, -INFINITY};
  double saved[SIZE], y[2], out[2], reach;
  lag_sim *s = lag_sim_new(&scene);

  (void)state;
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  assert_true(lag_sim_save_size(s) <= SIZE);
  assert_int_equal(lag_sim_save(s, saved), LAG_OK);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(lag_sim_advance(s, bad[i]), LAG_EINVAL);
    assert_int_equal(lag_sim_ensure_step(s, bad[i], &reach), LAG_EINVAL);
    assert_int_equal(lag_sim_eval(s, bad[i], y), LAG_EINVAL);
    assert_int_equal(lag_sim_outputs_at(s, bad[i], y, out), LAG_EINVAL);
    assert_int_equal(lag_sim_set_tolerance(s, bad[i]), LAG_EINVAL);
    assert_int_equal(lag_sim_set(s, "x", bad[i]), LAG_EINVAL);
    check_state(s, saved);
  }
  assert_int_equal(lag_sim_advance(s, 2), LAG_OK);
  assert_true(fabs(lag_sim_q(s)[0] - cos(2)) < 1e-10); /* the tolerance, times a period */
  lag_sim_free(s);
}

static void indices_out_of_range_are_refused(void **state)
{
  const int bad[] = {-1, 2, 1000000, INT32_MIN};
  double saved[SIZE], a, b;
  lag_charge_stats c;
  lag_sim *s = lag_sim_new(&scene);

  (void)state;
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  assert_int_equal(lag_sim_save(s, saved), LAG_OK);
  for (int i = 0; i < 4; i++) {
    assert_true(isnan(lag_sim_requested_start(s, bad[i])) && isnan(lag_sim_actual_start(s, bad[i])) &&
                isnan(lag_sim_state_value(s, bad[i])));
    assert_true(isnan(lag_sim_declared(s, bad[i], 1)) && isnan(lag_sim_monitor_drift(s, bad[i])));
    assert_true(isnan(lag_sim_state_info(s, bad[i], NULL, 0, NULL, 0)) &&
                isnan(lag_sim_output_info(s, bad[i], NULL, 0, NULL, 0)));
    assert_int_equal(lag_sim_is_redundant(s, bad[i]), 0);
    assert_int_equal(lag_sim_is_undetermined(s, bad[i]), 0);
    assert_int_equal(lag_sim_event_times(s, bad[i], &a, &b), 0);
    assert_true(isnan(a) && isnan(b));
    lag_sim_exact(s, bad[i], &a, &b);
    lag_sim_charge(s, bad[i], &c);
    assert_true(isnan(a) && isnan(b) && isnan(c.now) && isnan(c.drift));
    if (bad[i] < 0) {
      assert_int_equal(lag_sim_set_tangent(s, bad[i], NULL), LAG_EINVAL);
    }
    check_state(s, saved);
  }
  lag_sim_free(s);
}

static void null_is_refused(void **state)
{
  double saved[SIZE], x[2] = {0, 0};
  char why[400];
  int done;
  lag_stats st;
  lag_sim *s = lag_sim_new(&scene);

  (void)state;
  assert_null(lag_sim_new(NULL));
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  assert_int_equal(lag_sim_save(s, saved), LAG_OK);
  const int refused[] = {lag_sim_ensure_step(s, 2, NULL),
                         lag_sim_eval(s, 1, NULL), lag_sim_outputs(s, NULL), lag_sim_outputs_at(s, 1, x, NULL),
                         lag_sim_outputs_at(s, 1, NULL, x), lag_sim_tangent(s, NULL), lag_sim_save(s, NULL),
                         lag_sim_load(s, NULL), lag_sim_set_method(s, NULL, NULL, 0), lag_sim_set(s, NULL, 1),
                         lag_sim_set_input(s, NULL, NULL, NULL), lag_sim_set_method(s, lag_sim_method(s), NULL, 1),
                         lag_sim_set_method(s, lag_sim_method(s), NULL, -1), lag_sim_advance(NULL, 1),
                         lag_sim_ensure_step(NULL, 1, x), lag_sim_eval(NULL, 1, x), lag_sim_outputs(NULL, x),
                         lag_sim_outputs_at(NULL, 1, x, x), lag_sim_set_tangent(NULL, 1, x), lag_sim_tangent(NULL, x),
                         lag_sim_save(NULL, x), lag_sim_load(NULL, x), lag_sim_set_method(NULL, NULL, NULL, 0),
                         lag_sim_set_tolerance(NULL, 1), lag_sim_set(NULL, "x", 1),
                         lag_sim_set_input(NULL, "x", NULL, NULL), lag_sim_balance(NULL), lag_sim_judge(NULL),
                         lag_sim_choose_method(NULL, 1, 0, NULL, 0, why, sizeof why),
                         lag_sim_choose_method(s, 1, 0, NULL, 0, NULL, 0), lag_sim_rhs(NULL, 1, x, x, x),
                         lag_sim_rhs(s, -1, x, x, x), lag_sim_rhs(s, 1, x, x, NULL),
                         lag_sim_rows(NULL, 1, x, x, x, &done), lag_sim_rows(s, 1, NULL, x, x, &done),
                         lag_sim_rows(s, 1, x, x, x, NULL), lag_sim_rows(s, -1, x, x, x, &done),
                         lag_sim_batch(NULL, 1, x, NULL, 1, x, x, &done), lag_sim_batch(s, -1, x, NULL, 1, x, x, &done),
                         lag_sim_batch(s, 1, x, NULL, -1, x, x, &done),
                         lag_sim_batch(s, 1, x, NULL, 1, x, NULL, &done)};
  for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
    assert_int_equal(refused[i], LAG_EINVAL);
  }
  assert_true(!lag_sim_like(NULL) && !lag_library_scene(NULL, 0) && !lag_scene_span(NULL, x, x, x) &&
              !lag_scene_method(NULL) && !lag_find_method(NULL));
  assert_true(!lag_item(NULL, 'q', 0, NULL, NULL, NULL) && !lag_item(&scene, 'q', -1, NULL, NULL, NULL) &&
              !lag_item(&scene, 'p', 0, NULL, NULL, NULL));
  lag_sim_stats(s, NULL);
  lag_sim_stats(NULL, &st);
  lag_sim_charge(NULL, 0, NULL);
  lag_sim_exact(NULL, 0, NULL, NULL);
  lag_sim_on_step(NULL, NULL, NULL);
  lag_sim_on_event(NULL, NULL, NULL);
  assert_true(isnan(lag_sim_time(NULL)) && isnan(lag_sim_tolerance(NULL)) && !lag_sim_q(NULL) && !lag_sim_v(NULL) &&
              !lag_sim_z(NULL) && !lag_sim_p(NULL));
  assert_true(!lag_sim_scene(NULL) && !lag_sim_method(NULL) && !lag_sim_options(NULL) && lag_sim_message(NULL));
  assert_true(!lag_sim_noutputs(NULL) && !lag_sim_rank(NULL) && !lag_sim_nearby_rank(NULL) && !lag_sim_ncharges(NULL) &&
              !lag_sim_save_size(NULL) && !lag_sim_signature(NULL));
  check_state(s, saved);
  lag_sim_free(s);
  lag_sim_free(NULL);
}

/* A batch leaves the simulation that it is like as it was, in the middle of its run. */
static void a_batch_leaves_its_model_alone(void **state)
{
  const double y0[4] = {1, 0, 0, 2}, t[2] = {1, 2};
  double saved[SIZE], y[8];
  int status[2];
  lag_sim *s = lag_sim_new(&scene);

  (void)state;
  assert_int_equal(lag_sim_advance(s, 1.5), LAG_OK);
  assert_int_equal(lag_sim_save(s, saved), LAG_OK);
  assert_int_equal(lag_sim_batch(s, 2, y0, NULL, 2, t, y, status), LAG_OK);
  for (int i = 0; i < 2; i++) {
    assert_true(status[i] == LAG_OK && fabs(y[2 * i] - cos(t[i])) < 1e-10 &&
                fabs(y[4 + 2 * i] - 2 * sin(t[i])) < 1e-10);
  }
  check_state(s, saved);
  lag_sim_free(s);
}

/* A scene's method that liblag.a has not is refused until one is set. */
static void a_method_is_never_replaced(void **state)
{
  lag_sim *s = lag_sim_new(&elsewhere);

  (void)state;
  assert_int_equal(lag_sim_advance(s, 1), LAG_EMETHOD);
  assert_non_null(strstr(lag_sim_message(s), "gsl-rk8pd"));
  assert_true(lag_sim_time(s) <= 0);
  assert_int_equal(lag_sim_set_method(s, lag_methods[0], NULL, 0), LAG_OK);
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  lag_sim_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(times_that_are_none_are_refused),
      cmocka_unit_test(indices_out_of_range_are_refused),
      cmocka_unit_test(null_is_refused), cmocka_unit_test(a_batch_leaves_its_model_alone),
      cmocka_unit_test(a_method_is_never_replaced),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
