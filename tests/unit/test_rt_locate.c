/* kernels/locate.h without a motion: Chebyshev coefficients, roots, pairs of crossings of any distance, poles, signs
 * that are not known, both ways through a step. Sources of expected values: T_n(cos x) = cos n x, zeros that the
 * functions are built with. */
#include "test_rt_models.h"

#include <float.h>

#include "kernels/locate.h"

static const double pi = 3.14159265358979324;

static void test_coefficients(void **state)
{
  (void)state;
  for (int n = 0; n <= LAG_DEGREE; n++) {
    double value[2 * (LAG_DEGREE + 1)], c[LAG_DEGREE + 1];
    for (int j = 0; j <= LAG_DEGREE; j++) {
      value[2 * j] = cos(n * j * pi / LAG_DEGREE);
    }
    lag_locate_coefficients(value, 2, c);
    for (int k = 0; k <= LAG_DEGREE; k++) {
      assert_close(c[k], k == n, 2e-15); /* sums of nine values, off by n j ulps of pi */
    }
    assert_int_equal(lag_is_monotonic(c, 0), n == 1);
  }
}

typedef struct Function {
  double zero, apart, shift; /* (t - zero)(t - zero - apart), or as `kind` says */
  enum { PAIR, POLE, CUBE } kind;
  int direction, calls;
} Function;

static double value_of(void *context, double t)
{
  Function *f = context;
  f->calls++;
  double x = t - f->zero;
  return f->kind == PAIR ? x * (x - f->apart) : f->kind == POLE ? 1 / x : x * x * x + f->shift;
}

static int sample(void *context, int shaken, double t, double *g)
{
  *g = value_of(context, shaken ? t * (1 + 4 * DBL_EPSILON) : t);
  return 0;
}

static int direction_of(void *context, int k)
{
  return ((const Function *)context)->direction + 0 * k;
}

/* The first crossing in [a, b], or NAN; *sign: just after a, and at the end of the search. */
static double first(Function *f, double a, double b, double *sign, double noise)
{
  double root = NAN, value[LAG_LOCATE_ROWS];
  int found = 0;
  const lag_locator l = {1, sample, direction_of, f, DBL_EPSILON, 0x1p-40, sign, &noise, &root, value};
  sample(f, 0, a, value);
  assert_int_equal(lag_locate(&l, a, b, &found), 0);
  assert_int_equal(found, !isnan(root));
  return root;
}

/* x^3 - 2: no more than bisection and one; from both sides; where an end is the root. */
static void test_root(void **state)
{
  Function f = {.shift = -2, .kind = CUBE};

  (void)state;
  assert_close(lag_root(value_of, &f, 1, -1, 2, 6, DBL_EPSILON), cbrt(2), 4e-16);
  assert_true(f.calls <= 52 + 1);
  assert_close(lag_root(value_of, &f, 2, 6, 1, -1, DBL_EPSILON), cbrt(2), 4e-16);
  assert_true(lag_root(value_of, &f, 1, 0, 2, 6, DBL_EPSILON) == 1);
}

/* g falls at its first zero and rises at the second; rounding of t limits what is apart: g there is apart^2/4, and
 * is told from 4 epsilon t apart. */
static void test_pairs(void **state)
{
  (void)state;
  for (int n = 0; n <= 24; n++) {
    for (int way = 0; way < 2; way++) {
      double apart = exp2(-n), zero = 0.3 + 0.3 * apart, a = way ? 1.7 : 0, b = way ? 0 : 1.7, sign = 1;
      Function f = {zero, apart, .direction = -1};
      assert_close(first(&f, a, b, &sign, 0), way ? zero + apart : zero, 4e-16);
      sign = 1, f.direction = 1;
      assert_close(first(&f, a, b, &sign, 0), way ? zero : zero + apart, 4e-16);
      assert_true(sign == 1);
      sign = 1, f.direction = 0;
      assert_close(first(&f, a, b, &sign, 0), way ? zero + apart : zero, 4e-16);
      assert_true(sign == -1);
    }
  }
}

/* A pole is no crossing; before an event of unknown sign g leaves zero, and one at distance `apart` follows. */
static void test_signs(void **state)
{
  Function pole = {.zero = 0.7, .kind = POLE}, after = {.direction = 1},
           gap = {.apart = 1, .direction = LAG_LOCATE_UNSEEN};
  double sign = -1;

  (void)state;
  assert_true(isnan(first(&pole, 0, 1, &sign, 0)));
  for (int n = 2; n <= 38; n += 2) {
    sign = 0, after.apart = exp2(-n);
    assert_close(first(&after, 0, 1, &sign, 0), after.apart, 4e-16 * after.apart);
  }
  sign = 0;
  /* t (t - 1) = -noise: it has been above 0 */
  assert_close(first(&gap, 0, 1, &sign, 1e-3), (1 - sqrt(1 - 4e-3)) / 2, 4e-16);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_coefficients), cmocka_unit_test(test_root),
                                     cmocka_unit_test(test_pairs), cmocka_unit_test(test_signs)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
