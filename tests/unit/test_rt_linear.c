/* lag_jacobian and lag_linearise on models written by hand: what emitted derivatives become as dense matrices. */
#include "test_rt_models.h"

/* L = x'y' + y'^2/2 - k x y - c/2 x^2, force -d x' on x: M = [0 1; 1 1] needs pivoting. r = (-k y - c x - d x' - a_y,
 * -k x - a_x - a_y). And a state: z' = x - 2 z. */
enum { K = 3, C = 5, D = 7 };

static int pair_accel(ARGS, double *a, double *zd, UNUSED double *w)
{
  a[1] = -K * q[1] - C * q[0] - D * v[0];
  a[0] = -K * q[0] - a[1];
  zd[0] = q[0] - 2 * z[0];
  return 0;
}

static int pair_linear(ARGS, UNUSED const double *a, double *dr, double *M, UNUSED double *w)
{
  const double entries[] = {-C, -K, -D, -K, 1, -2};

  memcpy(dr, entries, sizeof entries);
  M[0] = M[1] = 1;
  return 0;
}

static const lag_entry pair_dr[] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {2, 0}, {2, 4}}, pair_mass[] = {{1, 0}, {1, 1}};
static const lag_linear pair_linearised = {.ndr = 6, .dr = pair_dr, .nmass = 2, .mass = pair_mass, .eval = pair_linear};
static const lag_model pair = {MODEL("pair"), .nq = 2, .nz = 1, .q = names_q, .z = names_z, .accel = pair_accel,
                               .linear = &pair_linearised};

static lag_problem problem(const lag_model *m)
{
  return (lag_problem){.model = m, .nq = m->nq, .nz = m->nz, .n = 2 * m->nq + m->nz, .dir = 1, .bad_index = -1};
}

static void test_jacobian(void **state)
{
  (void)state;
  lag_problem pb = problem(&pair);
  const double y[] = {0.1, 0.2, 0.3, 0.4, 0.5};
  /* a_y = -c x - k y - d x', a_x = -k x - a_y */
  const double want[] = {C - K, K, D, 0, 0, -C, -K, -D, 0, 0, 1, 0, 0, 0, -2};
  double J[15], *work = calloc(lag_linear_work(&pair), sizeof *work);

  assert_int_equal(lag_jacobian(&pb, 0, y, J, work), LAG_OK);
  for (int i = 0; i < 15; i++) {
    assert_close(J[i], want[i], 0); /* small integers: exact */
  }
  assert_true(pb.rhs_calls == 1);
  free(work);
}

static void test_linearise(void **state)
{
  (void)state;
  lag_problem pb = problem(&pair);
  const double y[5] = {0}, want[] = {-C, -K, -D, 0, 0, -K, 0, 0, 0, 0, 1, 0, 0, 0, -2}, mass[] = {0, 1, 1, 1};
  double dr[15], M[4], *work = calloc(lag_linear_work(&pair), sizeof *work);

  assert_int_equal(lag_linearise(&pb, 0, y, NULL, dr, M, work), LAG_OK);
  for (int i = 0; i < 15; i++) {
    assert_close(dr[i], want[i], 0);
  }
  for (int i = 0; i < 4; i++) {
    assert_close(M[i], mass[i], 0);
  }
  assert_true(pb.rhs_calls == 0);
  free(work);
}

/* M = [4 2 1; 2 3 1; 1 1 2]: with f = -M D q, a = -D q, so J = -D whatever elimination does. */
static const double full_M[3][3] = {{4, 2, 1}, {2, 3, 1}, {1, 1, 2}},
                    full_D[3][3] = {{1, 2, 3}, {-4, 5, 6}, {7, 8, -9}};

static int full_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  for (int i = 0; i < 3; i++) {
    a[i] = -full_D[i][0] * q[0] - full_D[i][1] * q[1] - full_D[i][2] * q[2];
  }
  return 0;
}

static int full_linear(ARGS, UNUSED const double *a, double *dr, double *M, UNUSED double *w)
{
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      *dr = 0;
      for (int k = 0; k < 3; k++) {
        *dr -= full_M[i][k] * full_D[k][j];
      }
      dr++;
    }
    for (int j = 0; j <= i; j++) {
      *M++ = full_M[i][j];
    }
  }
  return 0;
}

static void test_elimination(void **state)
{
  (void)state;
  static const lag_entry dr[] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}, {2, 0}, {2, 1}, {2, 2}};
  static const lag_entry mass[] = {{0, 0}, {1, 0}, {1, 1}, {2, 0}, {2, 1}, {2, 2}};
  const lag_linear linear = {.ndr = 9, .dr = dr, .nmass = 6, .mass = mass, .eval = full_linear};
  const lag_model m = {MODEL("full"), .nq = 3, .accel = full_accel, .linear = &linear};
  lag_problem pb = problem(&m);
  const double y[6] = {0};
  double J[18], *work = calloc(lag_linear_work(&m), sizeof *work);

  assert_int_equal(lag_jacobian(&pb, 0, y, J, work), LAG_OK);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 6; j++) {
      assert_close(J[i * 6 + j], j < 3 ? -full_D[i][j] : 0, 1e-14); /* rounding of numbers up to 60, three times over */
    }
  }
  free(work);
}

static int null_mass(ARGS, UNUSED const double *a, double *dr, double *M, UNUSED double *w)
{
  memset(dr, 0, 6 * sizeof *dr);
  M[0] = 0;
  M[1] = 1;
  return 0;
}

static int leaves(ARGS, UNUSED const double *a, UNUSED double *dr, UNUSED double *M, UNUSED double *w)
{
  return LAG_ERETRY;
}

static void test_errors(void **state)
{
  (void)state;
  const lag_linear singular = {.ndr = 6, .dr = pair_dr, .nmass = 2, .mass = pair_mass, .eval = null_mass},
                   outside = {.ndr = 6, .dr = pair_dr, .nmass = 2, .mass = pair_mass, .eval = leaves};
  const double y[5] = {0};
  double J[15], *work = calloc(lag_linear_work(&pair), sizeof *work);
  lag_model m = pair;
  lag_problem pb = problem(&m);

  m.linear = &singular;
  assert_int_equal(lag_jacobian(&pb, 0, y, J, work), LAG_ESINGULAR);
  m.linear = &outside;
  assert_int_equal(lag_jacobian(&pb, 0, y, J, work), LAG_ERETRY);
  m.linear = NULL;
  assert_int_equal(lag_linear_work(&m), 0);
  assert_int_equal(lag_jacobian(&pb, 0, y, J, NULL), LAG_EMETHOD);
  assert_non_null(strstr(pb.detail, "--with linear"));
  free(work);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_jacobian),
      cmocka_unit_test(test_linearise),
      cmocka_unit_test(test_elimination),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
