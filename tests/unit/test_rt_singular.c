/* Singular places: steps that creep towards one end a run, others do not; what has neither inertia nor a constraint
 * is named. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/core.h"

/* x' = 0, x' + y y' = 0: of rows of length 1, what is left of the second beside the first is y/sqrt(1 + y^2). */
static int matrices(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                    const double *u, double *A, double *M, double *w) {
  (void)self, (void)t, (void)v, (void)z, (void)p, (void)u, (void)w;
  A[0] = 1;
  A[1] = 1;
  A[2] = q[1];
  M[0] = M[1] = 1;
  return 0;
}

static int residuals(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                     const double *u, double *c, double *r, double *w) {
  (void)self, (void)t, (void)z, (void)p, (void)u, (void)c, (void)w;
  r[0] = v[0];
  r[1] = v[0] + q[1] * v[1];
  return 0;
}

static const lag_entry entries[] = {{0, 0}, {1, 0}, {1, 1}}, diagonal[] = {{0, 0}, {1, 1}};
static const lag_constraint named[] = {{"first", 0, "m/s", 3}, {"second", 0, "m/s", 4}};
static const lag_constraints held = {.n = 2,
                                     .nholonomic = 0, .of = named, .njacobian = 3, .jacobian = entries, .nmass = 2,
                                     .mass = diagonal, .matrices = matrices,
                                     .residuals = residuals};
static const lag_var lengths[] = {{"x", "m", 1, 0, 0, 0}, {"y", "m", 1, 0, 0, 0}};
static const lag_model model = {.name = "m", .flags = LAG_SMOOTH, .nq = 2, .q = lengths, .constraints = &held},
                       free_model = {.name = "f", .flags = LAG_SMOOTH, .nq = 2};
static const lag_model jumps = {.name = "j", .nq = 2, .q = lengths, .constraints = &held},
                       free_jumps = {.name = "k", .nq = 2, .q = lengths};

static void independence_is_what_is_left_of_a_row(void **state)
{
  double ranks[100], y[4] = {0, 0.75, 0, 0};
  lag_problem pb = {.model = &model, .nq = 2, .n = 4, .ranks = ranks};
  int k;
  (void)state;
  assert_true(lag_rank_scratch_size(&model) <= sizeof ranks / sizeof *ranks);
  assert_true(fabs(lag_independence(&pb, 0, y, &k) - 0.6) < 1e-15); /* 3/4 over 5/4 */
  assert_int_equal(k, 1);
  y[1] = 1e-6;
  assert_true(fabs(lag_independence(&pb, 0, y, &k) - 1e-6) < 1e-15);
  y[1] = 0; /* follows altogether: such a constraint is left out */
  assert_true(lag_independence(&pb, 0, y, &k) == 1);
  assert_int_equal(k, -1);
}

/* Steps of h from t0 on where c2 is y far from following: how many until they are said to creep; 0: never. */
static int steps_until(const lag_model *m, double t0, double h, double y1)
{
  enum { PATIENCE = 25000 };
  double y[4] = {0, y1, 0, 0}, none[8] = {0}, scratch[4];
  lag_scene scene = {.model = m};
  Run run = {.steps = 0};
  double ranks[100];
  lag_sim s = {.scene = &scene,
               .method = &lag_rk45, .options = none, .tol = 1e-9, .run = &run, .y = y, .now = y, .ya = scratch,
               .pb = {.model = m, .nq = 2, .n = 4, .dir = 1, .ranks = ranks}};

  for (int i = 1; i <= PATIENCE; i++) {
    run.t = t0 + (i - 1) * h;
    if (lag_detect_stall(&s, t0 + i * h)) {
      assert_non_null(
          strstr(s.pb.detail, y1 < 1 ? "constraint second (line 4)" : "a force or a constraint jumps here"));
      assert_non_null(strstr(s.pb.detail, y1 < 1 ? "a larger tolerance" : "smooth it"));
      assert_true(s.pb.bad_t == t0 + i * h);
      return i;
    }
    run.steps++;
  }
  return 0;
}

static void steps_that_creep_end(void **state)
{
  (void)state;
  assert_int_equal(steps_until(&model, 1, 1e-12, 1e-4), 20000); /* the second of looks, which are 10000 steps apart */
  assert_int_equal(steps_until(&model, -1, -1e-12, 1e-4), 20000); /* backwards */
  /* far from a singular place, of a model that is not smooth */
  assert_int_equal(steps_until(&jumps, 1, 1e-12, 1), 20000);
  assert_int_equal(steps_until(&free_jumps, 1, 1e-12, 1), 20000); /* nothing is held there */
}

static void other_short_steps_do_not(void **state)
{
  (void)state;
  assert_int_equal(steps_until(&model, 1, 1e-12, 1), 0);       /* far from a singular place */
  /* all steps are as short: that is how fast the motion is */
  assert_int_equal(steps_until(&model, 0, 1e-12, 1e-4), 0);
  assert_int_equal(steps_until(&model, 1, 2e-9, 1e-4), 0);     /* 10000 of them are 2e-5 of the run */
  assert_int_equal(steps_until(&free_model, 1, 1e-12, 0), 0);  /* nothing is held, nothing jumps */
}

static void what_nothing_moves_is_named(void **state)
{
  double x[3], K[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, pair[9] = {1, 0, 0, 0, 1, 2, 0, 2, 4}, none[9] = {0},
               one[4] = {1, 0, 0, 0};
  double part;
  int column[3];
  (void)state;
  lag_massless_direction(3, K, x, column, &part);
  assert_true(part >= 1 && part <= 1);
  assert_int_equal(lag_massless_direction(3, pair, x, column, &part), 1); /* K (0, -2, 1) = 0: the second moves most */
  assert_true(part <= 0);
  assert_int_equal(lag_massless_direction(3, none, x, column, &part), 0);
  assert_true(part <= 0);
  assert_int_equal(lag_massless_direction(2, one, x, column, &part), 1);
  assert_true(part <= 0);
}

/* What has come to rest at 0 may have velocities of 1e-323 m/s, numbers with two bits: what they make of a
 * constraint is no residual. */
static void what_is_below_normal_numbers_is_no_residual(void **state)
{
  double held_room[100], begin[] = {1, 1, 0, 0}, times = -1, residual[] = {DBL_MIN / 0x1p50, DBL_MIN / 0x1p50};
  const double still[] = {0, 0, DBL_MIN / 0x1p50, 0}, moves[] = {0, 0, DBL_MIN * 0x1p50, 0};
  lag_problem pb = {.model = &model, .nq = 2, .n = 4, .held = held_room, .begin = begin, .span = 1};
  (void)state;
  assert_true(lag_constraint_scratch_size(&model) <= sizeof held_room / sizeof *held_room);
  memset(held_room, 0, sizeof held_room);
  assert_true(lag_worst_constraint(&pb, 0, still, 0, &times) >= 0);
  assert_true(times == 0);
  assert_true(lag_constraint_is_met(&pb, 0, still, 0, residual));
  assert_int_equal(lag_worst_constraint(&pb, 0, moves, 0, &times), 0);
  assert_true(times > 1e3); /* it is as large as its terms */
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(independence_is_what_is_left_of_a_row),
      cmocka_unit_test(steps_that_creep_end),
      cmocka_unit_test(other_short_steps_do_not),
      cmocka_unit_test(what_nothing_moves_is_named),
      cmocka_unit_test(what_is_below_normal_numbers_is_no_residual),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
