/* dop853: its table against all order conditions, measured orders of step, error and dense output, and what dense
 * output costs. Sources of expected values: the theory (Butcher; HNW I II.2), closed forms. */
#include "test_rt_systems.h"

#include "core/core.h"
#include "methods/tableau.h"

static const lag_tableau *const tab = &lag_dop853_tableau;

enum { MOST_NODES = 8, STAGES = 12 };

/* ---- All rooted trees, as level sequences: T. Beyer, S.M. Hedetniemi, SIAM J. Comput. 9 (1980) 706, DOI
 * 10.1137/0209055. */

/* The next tree of n nodes after level[n]; 0: that was the last. */
static int next_tree(int n, int *level)
{
  int p = n - 1, q;
  while (p > 0 && level[p] == 1) {
    p--;
  }
  if (p == 0) {
    return 0;
  }
  for (q = p - 1; level[q] != level[p] - 1; q--) {
  }
  for (int i = p; i < n; i++) {
    level[i] = level[i - (p - q)];
  }
  return 1;
}

/* Phi_i of the tree, its gamma: nodes from the last to the first, each multiplying into its parent. */
static void weights_of(int n, const int *level, double phi[STAGES], double *gamma)
{
  double of[MOST_NODES][STAGES];
  int nodes[MOST_NODES];
  *gamma = 1;
  for (int k = 0; k < n; k++) {
    nodes[k] = 1;
    for (int i = 0; i < STAGES; i++) {
      of[k][i] = 1;
    }
  }
  for (int k = n - 1; k >= 0; k--) {
    int parent = k - 1;
    *gamma *= nodes[k];
    while (parent >= 0 && level[parent] != level[k] - 1) {
      parent--;
    }
    for (int i = 0; i < STAGES && parent >= 0; i++) {
      double sum = 0;
      for (int j = 0; j < i; j++) {
        sum += tab->a[i][j] * of[k][j];
      }
      of[parent][i] *= sum;
    }
    if (parent >= 0) {
      nodes[parent] += nodes[k];
    }
  }
  memcpy(phi, of[0], sizeof of[0]);
}

/* Largest |sum b_i Phi_i - 1/gamma| over the trees of n nodes; counts them. */
static double worst_defect(int n, const double *b, int *count)
{
  int level[MOST_NODES];
  double worst = 0, phi[STAGES], gamma;
  *count = 0;
  for (int i = 0; i < n; i++) {
    level[i] = i;
  }
  do {
    double sum = 0;
    weights_of(n, level, phi, &gamma);
    for (int i = 0; i < STAGES; i++) {
      sum += b[i] * phi[i];
    }
    worst = fmax(worst, fabs(sum - 1 / gamma));
    ++*count;
  } while (next_tree(n, level));
  return worst;
}

static void the_table_has_order_8(void **state)
{
  static const int trees[] = {0, 1, 1, 2, 4, 9, 20, 48, 115};
  const double *b = tab->a[STAGES];
  double fine[STAGES], coarse[STAGES];
  int count;
  (void)state;
  for (int i = 0; i < STAGES; i++) {
    fine[i] = b[i] - tab->errors[0][i];
    coarse[i] = b[i] - tab->errors[1][i];
  }
  for (int i = 0; i < tab->stages + tab->extra; i++) {
    double sum = 0;
    for (int j = 0; j < i; j++) {
      sum += tab->a[i][j];
    }
    assert_close(sum, tab->c[i], 2e-14); /* coefficients up to 43 */
  }
  for (int n = 1; n <= 8; n++) {
    assert_close(worst_defect(n, b, &count), 0, 1e-14);
    assert_int_equal(count, trees[n]);
    /* The first estimate compares with order 5, the second with order 3, and neither with more. */
    assert_true(n <= 5 ? worst_defect(n, fine, &count) < 1e-14 : n > 6 || worst_defect(n, fine, &count) > 1e-6);
    assert_true(n <= 3 ? worst_defect(n, coarse, &count) < 1e-14 : n > 4 || worst_defect(n, coarse, &count) > 1e-4);
  }
  /* One of the 286 trees with nine nodes, quadrature of x^8: not met, so the order is 8. */
  double sum = 0;
  for (int i = 0; i < STAGES; i++) {
    sum += b[i] * pow(tab->c[i], 8);
  }
  assert_true(fabs(sum - 1.0 / 9) > 1e-7);
}

/* ---- Measured order. In whole runs the error is soon below rounding, and where it is not, terms of order 9 and 10
 * rule; the error of single steps, as root mean square over 24 states of a motion, shows the leading term alone:
 * order 8 is slope 9. */

/* Error at the place `at` of a step of size h, at = 1 the end; at is a multiple of 1/32. */
static double step_error(const lag_scene *scene, double h, double span, double at)
{
  int nq = scene->model->nq;
  double sum = 0;
  for (int k = 0; k < 24; k++) {
    double y0[4], y[4], fine[4], start[4];
    scene->start(scene, NULL, start, start + nq, NULL);
    flow(scene, &lag_dop853, span / 24 / 64, (k + 1) * span / 24, start, y0);
    flow(scene, &lag_dop853, h, at * h, y0, y);
    flow(scene, &lag_dop853, h / 32, at * h, y0, fine);
    for (int i = 0; i < 2 * nq; i++) {
      sum += (y[i] - fine[i]) * (y[i] - fine[i]);
    }
  }
  return sqrt(sum / 24);
}

static void check_order(const lag_scene *scene, double h, double span, double at, double expected)
{
  double e1 = step_error(scene, h, span, at), e2 = step_error(scene, h / 1.25, span, at);
  assert_close(log(e1 / e2) / log(1.25), expected, 0.15);
}

static void steps_have_order_8(void **state)
{
  (void)state;
  check_order(&pendulum, 0.459, 10, 1, 9);
  check_order(&kepler, 0.0328, 6, 1, 9);
  check_order(&henon, 1, 20, 1, 9);
  check_order(&double_pendulum, 0.0082, 2, 1, 9);
}

/* Inside a step: slope 8. */
static void dense_output_has_order_7(void **state)
{
  (void)state;
  for (double at = 0.25; at < 1; at += 0.25) {
    check_order(&pendulum, 0.3, 10, at, 8);
    check_order(&henon, 0.4, 20, at, 8);
  }
}

/* The error follows the tolerance: over three orbits, between 1e-8 and 1e-12 it falls by 10^4 within a factor of 10. */
static void the_error_follows_the_tolerance(void **state)
{
  double e[2], y[4];
  (void)state;
  for (int i = 0; i < 2; i++) {
    lag_sim *s = sim_with(&kepler, &lag_dop853, i ? 1e-12 : 1e-8, 0, NULL);
    assert_int_equal(lag_sim_advance(s, 20), LAG_OK);
    kepler_exact(20, y);
    e[i] = distance(4, lag_sim_q(s), y);
    lag_sim_free(s);
  }
  assert_close(log10(e[0] / e[1]), 4, 1);
  assert_true(e[1] < 1e-9);
}

/* The norm of HNW II.10 by hand, from the table: a step is accepted just above it, and refused just below. */
static void the_error_is_that_of_the_book(void **state)
{
  double h = 0.2, y0[4] = {0.4, 0, 0, 2}, k[STAGES][4], y[4], fine = 0, coarse = 0;
  lag_problem pb = {.model = &kepler_model, .n = 4, .nq = 2, .dir = 1};
  (void)state;
  for (int s = 0; s < STAGES; s++) {
    for (int i = 0; i < 4; i++) {
      y[i] = y0[i];
      for (int j = 0; j < s; j++) {
        y[i] += h * tab->a[s][j] * k[j][i];
      }
    }
    assert_int_equal(lag_rhs(&pb, tab->c[s] * h, y, k[s]), 0);
  }
  for (int i = 0; i < 4; i++) {
    double e5 = 0, e3 = 0;
    for (int s = 0; s < STAGES; s++) {
      e5 += tab->errors[0][s] * k[s][i];
      e3 += tab->errors[1][s] * k[s][i];
    }
    fine += e5 * e5;
    coarse += e3 * e3;
  }
  double estimate = h * fine / sqrt(4 * (fine + 0.01 * coarse));
  for (int pass = 0; pass < 2; pass++) {
    lag_option opt[] = {{"step", h, NULL}, {"max_step", h, NULL}, {"atol", estimate * (pass ? 1.001 : 0.999), NULL}};
    lag_sim *s = sim_with(&kepler, &lag_dop853, 1e-15, 3, opt);
    lag_stats st;
    assert_int_equal(lag_sim_advance(s, 1e-3), LAG_OK);
    lag_sim_stats(s, &st);
    assert_int_equal(st.rejected > 0, pass == 0);
    lag_sim_free(s);
  }
}

/* 12 evaluations a step and one to begin with; three more in a step in which a state is asked for, once. */
static void dense_output_is_paid_for_when_asked_for(void **state)
{
  lag_sim *s = equal_steps(&kepler, &lag_dop853, 0.125);
  lag_stats st;
  (void)state;
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  lag_sim_stats(s, &st);
  assert_int_equal(st.rhs_calls - (long long)s->run->pole_calls, 1 + 8 * 12);
  for (int k = 1; k < 10; k++) {
    assert_int_equal(lag_sim_advance(s, 1 + k * 0.01), LAG_OK);
  }
  lag_sim_stats(s, &st);
  assert_int_equal(st.steps, 9);
  assert_int_equal(st.rhs_calls - (long long)s->run->pole_calls, 1 + 9 * 12 + 3);
  lag_sim_free(s);
}

/* A model that fails at one of the points that only dense output visits: it becomes coarser, the run goes on. */
static int holed_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -q[0];
  return fabs(t - 0.1 * 0.2) < 1e-9;
}

#define holed_start osc_start
SYSTEM(holed, 1, 0, NULL, NO_DERIVATIVES);

static void dense_output_survives_a_hole_in_the_model(void **state)
{
  lag_sim *s = equal_steps(&holed, &lag_dop853, 0.1);
  (void)state;
  assert_int_equal(lag_sim_advance(s, 0.05), LAG_OK);
  assert_close(lag_sim_q(s)[0], cos(0.05), 1e-8);
  assert_close(lag_sim_v(s)[0], -sin(0.05), 1e-6);
  assert_int_equal(lag_sim_advance(s, 3), LAG_OK);
  assert_close(lag_sim_q(s)[0], cos(3), 1e-11);
  lag_sim_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_table_has_order_8),
      cmocka_unit_test(steps_have_order_8),
      cmocka_unit_test(dense_output_has_order_7),
      cmocka_unit_test(the_error_follows_the_tolerance),
      cmocka_unit_test(the_error_is_that_of_the_book),
      cmocka_unit_test(dense_output_is_paid_for_when_asked_for),
      cmocka_unit_test(dense_output_survives_a_hole_in_the_model),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
