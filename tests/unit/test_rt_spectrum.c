/* lag_spectrum, and GSL's algebra under it, on matrices whose eigenvalues are known: S J S^-1 with a Jordan form J
 * and an S of small integers whose inverse is integer too. */
#include "test_rt_models.h"

#include "analysis/spectrum.h"

enum { N = 6 };

/* Unit upper times unit lower triangular: determinant 1, so the inverse is integer. */
static void basis(double S[N][N], double inverse[N][N])
{
  double L[N][N] = {{0}}, U[N][N] = {{0}}, Li[N][N] = {{0}}, Ui[N][N] = {{0}};

  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      L[i][j] = i == j ? 1 : i > j ? (i * 2 + j) % 3 - 1 : 0;
      U[i][j] = i == j ? 1 : i < j ? (i + j * 2) % 3 - 1 : 0;
      Li[i][j] = Ui[i][j] = i == j;
    }
  }
  for (int j = 0; j < N; j++) {
    for (int i = j + 1; i < N; i++) {
      for (int k = j; k < i; k++) {
        Li[i][j] -= L[i][k] * Li[k][j];
      }
    }
    for (int i = j; i-- > 0;) {
      for (int k = i + 1; k <= j; k++) {
        Ui[i][j] -= U[i][k] * Ui[k][j];
      }
    }
  }
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      S[i][j] = inverse[i][j] = 0;
      for (int k = 0; k < N; k++) {
        S[i][j] += U[i][k] * L[k][j];
        inverse[i][j] += Li[i][k] * Ui[k][j];
      }
    }
  }
}

/* A = D S J S^-1 D^-1, D = diag(scale^i). */
static void matrix(double A[N][N], const double J[N][N], double scale)
{
  double S[N][N], inverse[N][N], SJ[N][N] = {{0}};

  basis(S, inverse);
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      for (int k = 0; k < N; k++) {
        SJ[i][j] += S[i][k] * J[k][j];
      }
    }
  }
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      A[i][j] = 0;
      for (int k = 0; k < N; k++) {
        A[i][j] += SJ[i][k] * inverse[k][j];
      }
      A[i][j] *= pow(scale, i - j);
    }
  }
}

/* Is re + i im among the eigenvalues, so often? The tolerance is absolute. */
static void has(const Spectrum *s, double re, double im, int times, int repeats, double tolerance)
{
  int found = 0;

  for (int k = 0; k < s->count; k++) {
    found += fabs(s->re[k] - re) <= tolerance && fabs(s->im[k] - im) <= tolerance && (int)s->repeats[k] == repeats;
  }
  if (found != times) {
    for (int k = 0; k < s->count; k++) {
      print_message("%.17g %+.17gi, %g\n", s->re[k], s->im[k], s->repeats[k]);
    }
    fail_msg("%g %+gi: %d times, not %d", re, im, found, times);
  }
}

/* |A x - lambda x| is small for each pair, and |A x| for each vector of the kernel. */
static void check_vectors(double A[N][N], const Spectrum *s, double tolerance)
{
  for (int k = 0; k < s->count; k++) {
    double off = 0, size = 0;
    for (int i = 0; i < N; i++) {
      double x = s->vre[i * s->n + k], y = s->vim[i * s->n + k];
      double re = s->im[k] * y - s->re[k] * x, im = -s->im[k] * x - s->re[k] * y;
      for (int j = 0; j < N; j++) {
        re += A[i][j] * s->vre[j * s->n + k];
        im += A[i][j] * s->vim[j * s->n + k];
      }
      off = fmax(off, hypot(re, im));
      size = fmax(size, hypot(x, y));
    }
    assert_true(size > 0);
    assert_close(off / size, 0, tolerance);
  }
  for (int k = 0; k < s->nkernel; k++) {
    double size = 0;
    for (int i = 0; i < N; i++) {
      double sum = 0;
      for (int j = 0; j < N; j++) {
        sum += A[i][j] * s->kernel[j * s->n + s->n - s->nkernel + k];
      }
      size = fmax(size, fabs(s->kernel[i * s->n + s->n - s->nkernel + k]));
      assert_close(sum, 0, tolerance);
    }
    assert_true(size > 0);
  }
}

static Spectrum spectrum(double A[N][N], Pool *pool)
{
  double copy[N * N], exact[N * N] = {0};
  Spectrum s;

  memcpy(copy, A, sizeof copy);
  assert_int_equal(lag_spectrum(&s, pool, &lag_gsl_algebra, N, copy, exact), LAG_OK);
  return s;
}

/* Entries of A go up to 200, and sensitivities to some thousands: 1e-10 is rounding. */
static const double ROUNDING = 1e-10;

static void test_simple(void **state)
{
  (void)state;
  const double J[N][N] = {{1, 2}, {-2, 1}, {0, 0, -3}, {0, 0, 0, 4}, {0, 0, 0, 0, 0, 5}, {0, 0, 0, 0, -5, 0}};
  double A[N][N];
  Pool pool = {0};

  matrix(A, J, 1);
  Spectrum s = spectrum(A, &pool);
  assert_int_equal(s.count, N);
  assert_int_equal(s.zeros, 0);
  has(&s, 1, 2, 1, 1, ROUNDING);
  has(&s, 1, -2, 1, 1, ROUNDING);
  has(&s, -3, 0, 1, 1, ROUNDING);
  has(&s, 4, 0, 1, 1, ROUNDING);
  has(&s, 0, 5, 1, 1, ROUNDING);
  check_vectors(A, &s, ROUNDING);
  lag_pool_free(&pool);
}

/* 0 three times, once alone and once in a block of two; and a complex pair, whose vectors pass through both stages. */
static void test_zeros(void **state)
{
  (void)state;
  const double J[N][N] = {{0, 1}, {0, 0}, {0}, {0, 0, 0, -2, 3}, {0, 0, 0, -3, -2}, {0, 0, 0, 0, 0, 7}};
  double A[N][N];
  Pool pool = {0};

  matrix(A, J, 1);
  Spectrum s = spectrum(A, &pool);
  assert_int_equal(s.zeros, 3);
  assert_int_equal(s.nkernel, 2);
  assert_int_equal(s.count, 3);
  has(&s, -2, 3, 1, 1, ROUNDING);
  has(&s, 7, 0, 1, 1, ROUNDING);
  check_vectors(A, &s, ROUNDING);
  lag_pool_free(&pool);
}

static void test_defective(void **state)
{
  (void)state;
  const double J[N][N] = {{-1, 1}, {0, -1}, {0, 0, 3, 1}, {0, 0, 0, 3, 1}, {0, 0, 0, 0, 3}, {0, 0, 0, 0, 0, 9}};
  double A[N][N];
  Pool pool = {0};

  matrix(A, J, 1);
  Spectrum s = spectrum(A, &pool);
  has(&s, -1, 0, 2, 2, ROUNDING);
  has(&s, 3, 0, 3, 3, 1e-8); /* a mean of three that are 1e-4 apart, with sensitivities of 1e8 */
  has(&s, 9, 0, 1, 1, ROUNDING);
  lag_pool_free(&pool);
}

/* Complex pairs twice: in a Jordan block, and beside each other. */
static void test_complex_pairs(void **state)
{
  (void)state;
  const double block[N][N] = {{1, 2, 1, 0},  {-2, 1, 0, 1},   {0, 0, 1, 2},
                              {0, 0, -2, 1}, {0, 0, 0, 0, 3}, {0, 0, 0, 0, 0, 9}};
  const double beside[N][N] = {{1, 2}, {-2, 1}, {0, 0, 1, 2}, {0, 0, -2, 1}, {0, 0, 0, 0, 3}, {0, 0, 0, 0, 0, 9}};
  double A[N][N];
  Pool pool = {0};

  matrix(A, block, 1);
  Spectrum s = spectrum(A, &pool);
  has(&s, 1, 2, 2, 2, ROUNDING);
  has(&s, 1, -2, 2, 2, ROUNDING);
  matrix(A, beside, 1);
  s = spectrum(A, &pool);
  has(&s, 1, 2, 2, 1, ROUNDING);
  has(&s, 1, -2, 2, 1, ROUNDING);
  check_vectors(A, &s, ROUNDING);
  lag_pool_free(&pool);
}

/* Equal eigenvalues that do not lack eigenvectors are not defective. */
static void test_repeated(void **state)
{
  (void)state;
  const double J[N][N] = {{2}, {0, 2}, {0, 0, 2}, {0, 0, 0, -1}, {0, 0, 0, 0, -1}, {0, 0, 0, 0, 0, 5}};
  double A[N][N];
  Pool pool = {0};

  matrix(A, J, 1);
  Spectrum s = spectrum(A, &pool);
  has(&s, 2, 0, 3, 1, ROUNDING);
  has(&s, -1, 0, 2, 1, ROUNDING);
  check_vectors(A, &s, ROUNDING);
  lag_pool_free(&pool);
}

/* Units of coordinates may differ by anything: 1e8 from row to row. */
static void test_scales(void **state)
{
  (void)state;
  const double J[N][N] = {{0, 1}, {0, 0}, {0, 0, 1, 2}, {0, 0, -2, 1}, {0, 0, 0, 0, 3}, {0, 0, 0, 0, 0, -4}};
  double A[N][N];
  Pool pool = {0};

  matrix(A, J, ldexp(1, 27));
  Spectrum s = spectrum(A, &pool);
  assert_int_equal(s.zeros, 2);
  assert_int_equal(s.nkernel, 1);
  has(&s, 1, 2, 1, 1, ROUNDING);
  has(&s, 3, 0, 1, 1, ROUNDING);
  lag_pool_free(&pool);
}

static void test_nothing_but_zeros(void **state)
{
  (void)state;
  double A[N][N] = {{0, 1}, {0, 0, 1}, {0}, {0, 0, 0, 0, 1}, {0}, {0}};
  Pool pool = {0};
  Spectrum s = spectrum(A, &pool);

  assert_int_equal(s.zeros, N);
  assert_int_equal(s.nkernel, 3);
  assert_int_equal(s.count, 0);
  check_vectors(A, &s, 0);
  lag_pool_free(&pool);
}

/* ---- GSL's part */

static void test_symmetric(void **state)
{
  (void)state;
  double K[] = {2, -1, -1, 2}, M[] = {2, 0, 0, 1}, values[2], x[4];
  double bad[] = {1, 2, 2, 1}, K2[] = {1, 0, 0, 1};

  assert_int_equal(lag_gsl_algebra.symmetric(2, K, M, values, x), LAG_OK);
  assert_close(values[0], (3 - sqrt(3)) / 2, 1e-15); /* det(K - w M) = 2 w^2 - 6 w + 3 */
  assert_close(values[1], (3 + sqrt(3)) / 2, 1e-15);
  for (int k = 0; k < 2; k++) {
    assert_close(x[2 + k] / x[k], 2 - 2 * values[k], 1e-14);
  }
  assert_int_equal(lag_gsl_algebra.symmetric(2, K2, bad, values, x), LAG_EINVAL);
}

static int circle(void *context, const double *x, double *f, double *J)
{
  double rr = x[0] * x[0] + x[1] * x[1];

  (void)context;
  f[0] = x[0] * (rr - 1);
  f[1] = x[1] * (rr - 1);
  if (J) {
    J[0] = rr - 1 + 2 * x[0] * x[0];
    J[1] = J[2] = 2 * x[0] * x[1];
    J[3] = rr - 1 + 2 * x[1] * x[1];
  }
  return x[0] > 9; /* no values beyond */
}

static void test_root(void **state)
{
  (void)state;
  double x[] = {3, 4}, outside[] = {10, 0};
  int steps = 0;

  /* a circle of roots: the Jacobian is singular on it */
  assert_int_equal(lag_gsl_algebra.root(2, x, circle, NULL, 100, &steps), LAG_OK);
  assert_close(hypot(x[0], x[1]), 1, 1e-15);
  assert_close(atan2(x[1], x[0]), atan2(4, 3), 1e-12);
  assert_true(steps > 2 && steps < 40);
  assert_int_equal(lag_gsl_algebra.root(2, outside, circle, NULL, 100, &steps), LAG_EDOMAIN);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_simple),   cmocka_unit_test(test_zeros),     cmocka_unit_test(test_defective),
      cmocka_unit_test(test_repeated), cmocka_unit_test(test_scales),    cmocka_unit_test(test_nothing_but_zeros),
      cmocka_unit_test(test_symmetric), cmocka_unit_test(test_root),
      cmocka_unit_test(test_complex_pairs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
