/* lag_consistent_state without a model: a point in the plane on one constraint, M = 1. Starts that are found are the
 * nearest, and each reason to refuse one is told. */
#include <float.h>

#include "test_rt_models.h"

#include "numeric/consistent_state.h"
#include "numeric/magnitudes.h"

typedef struct Curve {
  double (*c)(double x, double y);
  void (*slope)(double x, double y, double *A);
  int first; /* component that nobody set; -1: both were set */
} Curve;

static double circle(double x, double y) { return x * x + y * y - 1; }
static void circle_slope(double x, double y, double *A) { A[0] = 2 * x, A[1] = 2 * y; }
static double square(double x, double y) { return x * x + 0 * y; }
static void square_slope(double x, double y, double *A) { A[0] = 2 * x, A[1] = 0 * y; }
static double nowhere(double x, double y) { return x * x + y * y + 1; }
static double root(double x, double y) { return sqrt(x - 1) + 0 * y; }
static void root_slope(double x, double y, double *A) { A[0] = 0.5 / sqrt(x - 1), A[1] = 0 * y; }

static int residuals(const lag_level *w, double *residual)
{
  const Curve *k = w->context;
  residual[0] = k->c(w->x[0], w->x[1]);
  return 0;
}

static int jacobian(const lag_level *w, double *A)
{
  ((Curve *)w->context)->slope(w->x[0], w->x[1], A);
  return 0;
}

static int terms(const lag_level *w, double *size)
{
  (void)w;
  size[0] = 1;
  return 0;
}

static void scales(const lag_level *w, const double *x, double *reach)
{
  for (int i = 0; i < w->n; i++) {
    reach[i] = fmax(fmax(fabs(x[0]), fabs(x[1])), 1e-3);
  }
}

/* d = g + A^T l, A d = -c, with g the pull. */
static int direction(const lag_level *w, double pull, double *d)
{
  double A[2], along = w->residual[0], norm = 0;

  jacobian(w, A);
  for (int a = 0; a < w->nfree; a++) {
    int i = w->free[a];
    d[a] = pull * (w->asked[i] - w->x[i]);
    along += A[i] * d[a];
    norm += A[i] * A[i];
  }
  for (int a = 0; a < w->nfree; a++) {
    d[a] -= norm > 0 ? A[w->free[a]] * along / norm : 0;
  }
  return 0;
}

static double distance(const lag_level *w)
{
  return (w->x[0] - w->asked[0]) * (w->x[0] - w->asked[0]) + (w->x[1] - w->asked[1]) * (w->x[1] - w->asked[1]);
}

static int stage(const lag_level *w, int i) {
  return ((Curve *)w->context)->first == i ? LAG_MOVES_FIRST : LAG_MOVES_LAST;
}
static int is_contact(const lag_level *w, int k) { return (void)w, (void)k, 0; }

/* Brings at[2] onto the curve; returns why not. */
static lag_start_kind start(Curve *curve, int exactly, double *at)
{
  static const int row[2] = {0, 0}, col[2] = {0, 1};
  double part[25] = {0};
  int free[2], which = -2;
  lag_level w = {.context = curve,
                 .n = 2, .rows = 1, .entries = 2, .row = row, .col = col, .positions = 1, .exactly = exactly,
                 .rounding = DBL_EPSILON, .residuals = residuals, .jacobian = jacobian, .terms = terms,
                 .scales = scales, .direction = direction, .distance = distance, .stage = stage,
                 .is_contact = is_contact, .x = at, .asked = part, .best = part + 2, .from = part + 4, .d = part + 6,
                 .residual = part + 8, .size = part + 9, .terms_here = part + 10, .slope = part + 11,
                 .has_terms = part + 12, .A = part + 13, .reach = part + 17, .nearest = part + 19, .along = part + 21,
                 .other = part + 23,
                 .free = free};
  lag_start_kind kind = lag_consistent_state(&w, &which);
  assert_true(kind == LAG_START_FOUND || which == 0);
  return kind;
}

static void test_found(void **state)
{
  (void)state;
  double at[2] = {0.6, 0.8}, far[2] = {3, 4}, given[2] = {0.6, 5}, centre[2] = {0, 0};
  assert_int_equal(start(&(Curve){circle, circle_slope, -1}, 1, at), LAG_START_FOUND);
  assert_true(at[0] == 0.6 && at[1] == 0.8); /* rounding is not corrected */
  assert_int_equal(start(&(Curve){circle, circle_slope, -1}, 0, far), LAG_START_FOUND);
  assert_true(fabs(far[0] - 0.6) < 1e-9 && fabs(far[1] - 0.8) < 1e-9);
  assert_int_equal(start(&(Curve){circle, circle_slope, 1}, 0, given), LAG_START_FOUND);
  assert_true(given[0] == 0.6 && fabs(given[1] - 0.8) < 1e-12); /* only the one that nobody set moves */
  assert_int_equal(start(&(Curve){circle, circle_slope, 1}, 0, centre), LAG_START_FOUND);
  assert_true(centre[0] == 0 && centre[1] == 1); /* of two equally near solutions the larger */
}

static void test_refused(void **state)
{
  (void)state;
  double broken[2] = {2, 0}, flat[2] = {1, 0}, none[2] = {1, 1}, steep[2] = {1, 0}, nan[2] = {-1, 0};
  assert_int_equal(start(&(Curve){circle, circle_slope, -1}, 1, broken), LAG_START_BROKEN);
  assert_true(broken[0] == 2);
  assert_int_equal(start(&(Curve){square, square_slope, -1}, 0, flat), LAG_START_FLAT);
  assert_int_equal(start(&(Curve){nowhere, circle_slope, -1}, 0, none), LAG_START_NONE);
  assert_int_equal(start(&(Curve){root, root_slope, -1}, 0, steep), LAG_START_STEEP);
  assert_int_equal(start(&(Curve){root, root_slope, -1}, 0, nan), LAG_START_NO_VALUE);
}

static void test_magnitudes(void **state)
{
  (void)state;
  double least = 2, most = 0, loose[2], residual[3] = {1e-3, -2, 1}, size[3] = {1, 1e6, 1}, times;
  for (int i = 0; i < 1000; i++) {
    least = fmin(least, lag_uneven(i)), most = fmax(most, lag_uneven(i));
  }
  assert_true(least >= 0.5 && least < 0.51 && most > 1.49 && most < 1.5);
  assert_int_equal(lag_worst_residual(3, residual, size, 0.5, &times), 2);
  assert_true(times == 2);
  lag_loose_directions(2, (double[]){0, 0.5}, (double[]){0.1, 0.52}, loose);
  assert_true(loose[0] == 1 && loose[1] == 0);
  assert_true(lag_component_scale(0.1, 1, "m") == 1 && lag_component_scale(0.1, 0, "rad") == 1 &&
              lag_component_scale(0.1, 0, "m") == 0.1);
  assert_true(lag_component_scale(0, 0, "m") == 1 && lag_component_scale(7, 0, "deg") == 7);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_found), cmocka_unit_test(test_refused),
                                     cmocka_unit_test(test_magnitudes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
