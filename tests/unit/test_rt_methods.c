/* Methods: order conditions, measured orders of steps and of dense output. Expected values: closed forms. */
#include "test_rt_systems.h"

#include "methods/step_control.h"
#include "methods/tableau.h"

/* ---- Order conditions (Butcher; HNW I II.2 theorem 2.13): sum b_i Phi_i(tree) = 1/gamma(tree). */

static const char *const trees[] = {"()",         "(())",       "(()())",     "((()))",     "(()()())",   "(()(()))",
                                    "((()()))",   "(((())))",   "(()()()())", "(()()(()))", "(()(()()))", "(()((())))",
                                    "((())(()))", "((()()()))", "((()(())))", "(((()())))", "((((()))))"};

/* Reads one tree: Phi, gamma and the number of its nodes. */
static const char *read_tree(const lag_tableau *b, const char *s, double *phi, double *gamma, int *nodes)
{
  *gamma = 1;
  *nodes = 1;
  for (int i = 0; i < b->stages; i++) {
    phi[i] = 1;
  }
  for (s++; *s == '(';) {
    double child[LAG_MAX_STAGES], g;
    int n;
    s = read_tree(b, s, child, &g, &n);
    *gamma *= g;
    *nodes += n;
    for (int i = 0; i < b->stages; i++) {
      double sum = 0;
      for (int j = 0; j < i; j++) {
        sum += b->a[i][j] * child[j];
      }
      phi[i] *= sum;
    }
  }
  *gamma *= *nodes;
  return s + 1;
}

static double defect(const lag_tableau *b, const double *weights, const char *tree, int *order)
{
  double phi[LAG_MAX_STAGES], gamma, sum = 0;
  read_tree(b, tree, phi, &gamma, order);
  for (int i = 0; i < b->stages; i++) {
    sum += weights[i] * phi[i];
  }
  return sum - 1 / gamma;
}

static void dopri5_satisfies_the_order_conditions(void **state)
{
  const lag_tableau *b = &lag_rk45_tableau;
  double hat[LAG_MAX_STAGES], worst = 0;
  int order;
  (void)state;
  for (int i = 0; i < b->stages; i++) {
    double sum = 0;
    hat[i] = b->a[b->stages - 1][i] - b->errors[0][i];
    for (int j = 0; j < i; j++) {
      sum += b->a[i][j];
    }
    assert_close(sum, b->c[i], 1e-14);
  }
  assert_int_equal(sizeof trees / sizeof *trees, 17); /* 1 + 1 + 2 + 4 + 9 */
  for (size_t k = 0; k < 17; k++) {
    assert_close(defect(b, b->a[b->stages - 1], trees[k], &order), 0, 1e-14);
    double d = fabs(defect(b, hat, trees[k], &order));
    if (order <= 4) {
      assert_close(d, 0, 1e-14);
    } else {
      worst = fmax(worst, d);
    }
  }
  assert_true(worst > 1e-4);                                      /* the embedded method has order 4, no more */
  assert_true(fabs(defect(b, b->a[b->stages - 1], "(()()()()())", &order)) > 1e-5); /* and this one 5 */
}

/* ---- Measured orders: Kepler's problem, and for the fifth order the oscillator, where the leading term
 * of the error rules at larger steps. */

static void exact(const lag_scene *scene, double t, double *y)
{
  if (scene == &kepler) {
    kepler_exact(t, y);
  } else {
    y[0] = cos(t);
    y[1] = -sin(t);
  }
}

/* Largest error at times (k + at) h, or at the end only for at = 0. */
static double error_of(const lag_scene *scene, const lag_method *m, double h, double end, double at)
{
  lag_sim *s = equal_steps(scene, m, h);
  double worst = 0, y[4];
  int n = (int)lround(end / h);
  for (int k = at > 0 ? 0 : n; k <= (at > 0 ? n - 1 : n); k++) {
    double t = (k + at) * h;
    assert_int_equal(lag_sim_advance(s, t), LAG_OK);
    exact(scene, t, y);
    worst = fmax(worst, distance(2 * scene->model->nq, lag_sim_q(s), y));
  }
  lag_stats st;
  lag_sim_stats(s, &st);
  assert_in_range(st.steps, n, n + 1);
  assert_int_equal(st.rejected, 0);
  lag_sim_free(s);
  return worst;
}

static void check_order(const lag_scene *scene, const lag_method *m, double h, double at, double expected)
{
  double end = 4, e1 = error_of(scene, m, h, end, at), e2 = error_of(scene, m, h / 2, end, at);
  assert_close(log2(e1 / e2), expected, 0.15);
}

static void rk4_has_order_4(void **state)
{
  (void)state;
  check_order(&kepler, &lag_rk4, 1.0 / 256, 0, 4);
}

static void rk4_dense_output_has_order_4(void **state)
{
  (void)state;
  check_order(&kepler, &lag_rk4, 1.0 / 256, 0.37, 4);
}

/* The oscillator, whose closed form is exact for every step: y(n h) = (1 - i h)^n, and on the tangent between. */
static void euler_is_its_closed_form(void **state)
{
  double h = 1.0 / 64, gain = pow(1 + h * h, 128), angle = 256 * atan(h);
  lag_sim *s = equal_steps(&osc, &lag_euler, h);
  double q0 = lag_sim_q(s)[0], v0 = lag_sim_v(s)[0], between[2];
  (void)state;
  check_order(&osc, &lag_euler, 1.0 / 1024, 0, 1);
  assert_int_equal(lag_sim_advance(s, 256 * h), LAG_OK);
  assert_close(lag_sim_q(s)[0], gain * (q0 * cos(angle) + v0 * sin(angle)), 1e-12);
  assert_close(lag_sim_v(s)[0], gain * (v0 * cos(angle) - q0 * sin(angle)), 1e-12);
  double q = lag_sim_q(s)[0], v = lag_sim_v(s)[0];
  assert_int_equal(lag_sim_advance(s, 256.25 * h), LAG_OK);
  between[0] = lag_sim_q(s)[0];
  between[1] = lag_sim_v(s)[0];
  assert_close(between[0], q + 0.25 * h * v, 1e-13);
  assert_close(between[1], v - 0.25 * h * q, 1e-13);
  lag_sim_free(s);
}

static void rk45_has_order_5(void **state)
{
  (void)state;
  check_order(&osc, &lag_rk45, 1.0 / 16, 0, 5);
}

/* Within one step from exact values the error of the interpolant is of order 5 (order 4 plus the step). */
static void rk45_dense_output_has_order_4(void **state)
{
  double e[2], y[4], right[4];
  (void)state;
  for (int i = 0; i < 2; i++) {
    double h = 0.02 / (1 << i);
    lag_sim *s = equal_steps(&kepler, &lag_rk45, h);
    assert_int_equal(lag_sim_advance(s, 0.6 * h), LAG_OK);
    kepler_exact(0.6 * h, right);
    e[i] = distance(4, lag_sim_q(s), right);
    assert_int_equal(lag_sim_eval(s, 0.6 * h, y), LAG_OK);
    assert_memory_equal(y, lag_sim_q(s), sizeof y);
    assert_int_equal(lag_sim_eval(s, 2 * h, y), LAG_EINVAL);
    lag_sim_free(s);
  }
  assert_close(log2(e[0] / e[1]), 5, 0.15);
}

/* The error follows the tolerance: between 1e-6 and 1e-10 it falls by 10^4 within a factor of 10. */
static void rk45_error_follows_the_tolerance(void **state)
{
  double e[2], y[4];
  (void)state;
  for (int i = 0; i < 2; i++) {
    lag_sim *s = sim_with(&kepler, &lag_rk45, i ? 1e-10 : 1e-6, 0, NULL);
    assert_int_equal(lag_sim_advance(s, 4), LAG_OK);
    kepler_exact(4, y);
    e[i] = distance(4, lag_sim_q(s), y);
    lag_sim_free(s);
  }
  assert_close(log10(e[0] / e[1]), 4, 1);
  assert_true(e[1] < 1e-7);
}

/* Exact for q of degree 5, v and z of degree 3, at any place and for a backward step. */
static void hermite_reproduces_polynomials(void **state)
{
  (void)state;
  for (int pass = 0; pass < 4; pass++) {
    double c = pass / 2, h = pass % 2 ? -0.7 : 0.7, y[2][3], f[2][3], out[3];
    for (int k = 0; k < 2; k++) {
      double t = k * h;
      y[k][0] = c * pow(t, 5) + pow(t, 4) - 2 * pow(t, 3) + t - 4;
      y[k][1] = f[k][0] = 5 * c * pow(t, 4) + 4 * pow(t, 3) - 6 * t * t + 1;
      f[k][1] = 20 * c * pow(t, 3) + 12 * t * t - 12 * t;
      y[k][2] = t * t * t - t;
      f[k][2] = 3 * t * t - 1;
    }
    for (double s = 0; s <= 1; s += 0.125) {
      double t = s * h;
      lag_hermite(1, 1, h, s, y[0], f[0], y[1], f[1], out);
      assert_close(out[0], c * pow(t, 5) + pow(t, 4) - 2 * pow(t, 3) + t - 4, 1e-14);
      if (pass < 2) {
        assert_close(out[1], 4 * pow(t, 3) - 6 * t * t + 1, 1e-14);
      }
      assert_close(out[2], t * t * t - t, 1e-15);
    }
  }
}

/* Summed with compensation, the oscillator's energy loses in 10^6 steps what the method loses, and no more. */
static void rk4_does_not_gather_rounding(void **state)
{
  lag_option opt[] = {{"step", 0.001, NULL}};
  lag_sim *s = sim_with(&osc, &lag_rk4, 0, 1, opt);
  lag_stats st;
  (void)state;
  assert_int_equal(lag_sim_advance(s, 1000), LAG_OK);
  lag_sim_stats(s, &st);
  assert_in_range(st.steps, 1000000, 1000001);
  /* |R(ih)|^2 = 1 - h^6/72 + ...; E0 = 1/2 is judged against 1/2 + 1/pi, the mean of sin^2 + |cos 2t|/2. */
  assert_close(st.energy_drift, 1e6 * 1e-18 / 72 / (1 + 2 / PI), 1e-15);
  lag_sim_free(s);
}

/* Time is summed with compensation: step k ends at k h to the last bit, for an h that is no binary number. */
static int compare_time(void *context, const lag_sim *s)
{
  double *k = context, t = ++*k * 0.1;
  assert_close(lag_sim_time(s), t, 2 * 1.1e-16 * t);
  return 0;
}

static void rk4_keeps_time(void **state)
{
  double k = 0;
  lag_sim *s = sim_with(&osc, &lag_rk4, 0, 1, (lag_option[]){{"step", 0.1, NULL}});
  (void)state;
  lag_sim_on_step(s, compare_time, &k);
  assert_int_equal(lag_sim_advance(s, 10000), LAG_OK);
  assert_true(k >= 99999);
  lag_sim_free(s);
}

static void backwards_undoes_forwards(void **state)
{
  double y[4];
  (void)state;
  for (int i = 0; i < lag_nmethods; i++) {
    lag_option opt[] = {{"step", 1e-3, NULL}};
    lag_sim *s = sim_with(&kepler, lag_methods[i], 1e-12, 1, opt);
    assert_int_equal(lag_sim_advance(s, -2.5), LAG_OK);
    kepler_exact(-2.5, y);
    assert_close(distance(4, lag_sim_q(s), y), 0,
                 lag_methods[i]->order > 2    ? 1e-8
                 : lag_methods[i]->order == 2 ? 1e-4
                                              : 0.05);
    assert_int_equal(lag_sim_advance(s, -2), LAG_EINVAL);
    lag_sim_free(s);
  }
}

static int once(UNUSED void *context, UNUSED const lag_sim *s)
{
  return 1;
}

/* The first step from h; whether steps were rejected before, and how far it went. */
static double first_step_of(const lag_method *m, double h, double *y, long long *rejected)
{
  lag_option opt[] = {{"step", h, NULL}, {"max_step", 100, NULL}};
  lag_sim *s = sim_with(&kepler, m, 1e-8, 2, opt);
  lag_stats st;
  lag_sim_on_step(s, once, NULL);
  assert_int_equal(lag_sim_advance(s, 50), LAG_INTERRUPTED);
  memcpy(y, lag_sim_q(s), 4 * sizeof *y);
  lag_sim_stats(s, &st);
  *rejected = st.rejected;
  double t = lag_sim_time(s);
  lag_sim_free(s);
  return t;
}

/* Steps that are refused leave nothing behind: the one that is taken is, bit by bit, the one taken without them. */
static void a_refused_step_loses_no_state(void **state)
{
  const lag_method *const adaptive[] = {&lag_rk45, &lag_dop853, &lag_radau};
  (void)state;
  for (int i = 0; i < 3; i++) {
    double y[2][4];
    long long rejected;
    double h = first_step_of(adaptive[i], 10, y[0], &rejected);
    assert_true(rejected >= 2 && h < 5);
    assert_true(first_step_of(adaptive[i], h, y[1], &rejected) == h && rejected == 0);
    assert_memory_equal(y[0], y[1], sizeof y[0]);
  }
}

FLOW(slow, (zd[0] = 1e-12, 0));

/* E. Hairer, S. Norsett, G. Wanner, Solving Ordinary Differential Equations I, section II.4: where y' is no larger
 * than 1e-5 of the tolerance, h0 is 1e-6, and the first step is 100 h0 if the second derivative allows it. */
static void the_first_step_of_what_hardly_moves(void **state)
{
  const lag_method *const adaptive[] = {&lag_rk45, &lag_dop853};
  (void)state;
  for (int i = 0; i < 2; i++) {
    lag_sim *s = sim_with(&slow, adaptive[i], 1e-6, 0, NULL);
    lag_sim_on_step(s, once, NULL);
    assert_int_equal(lag_sim_advance(s, 5), LAG_INTERRUPTED);
    assert_close(lag_sim_time(s), 1e-4, 1e-18);
    lag_sim_free(s);
  }
}

static int quick_accel(ARGS, UNUSED double *a, double *zd, UNUSED double *w) { return zd[0] = -4, 0; }
static void quick_start(SELF, UNUSED const double *p, UNUSED double *q, UNUSED double *v, double *z) { z[0] = 1e-16; }

/* z' = -4 from z = 1e-16 at t = 0.45, both ways: errors that are allowed there would have steps shorter than time
 * resolves. */
static void a_start_near_zero_at_a_later_time(void **state)
{
  static const lag_model model = {MODEL("quick"), .nz = 1, .z = names_z, .accel = quick_accel};
  static const lag_scene quick = {.name = "s", .doc = "", .model = &model, .start = quick_start, .t0 = 0.45, .t1 = 1};
  const lag_method *const adaptive[] = {&lag_rk45, &lag_dop853};
  (void)state;
  for (int i = 0; i < 4; i++) {
    lag_sim *s = sim_with(&quick, adaptive[i / 2], 1e-9, 0, NULL);
    const double t = i % 2 ? 0.2 : 0.7;
    assert_int_equal(lag_sim_advance(s, t), LAG_OK);
    assert_close(lag_sim_z(s)[0], -4 * (t - 0.45), 1e-15);
    lag_sim_free(s);
  }
}

static void rough_powers_are_near(void **state)
{
  (void)state;
  for (double x = 1e-24; x < 1e300; x *= 1.37) { /* errors, squared */
    for (int k = -10; k <= 10; k++) {
      double p = k / 80.0;
      assert_true(fabs(lag_rough_power(x, p) / pow(x, p) - 1) < 2e-4);
    }
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(dopri5_satisfies_the_order_conditions),
      cmocka_unit_test(rk4_has_order_4),
      cmocka_unit_test(rk4_dense_output_has_order_4),
      cmocka_unit_test(euler_is_its_closed_form),
      cmocka_unit_test(rk45_has_order_5),
      cmocka_unit_test(rk45_dense_output_has_order_4),
      cmocka_unit_test(rk45_error_follows_the_tolerance),
      cmocka_unit_test(hermite_reproduces_polynomials),
      cmocka_unit_test(rk4_does_not_gather_rounding),
      cmocka_unit_test(the_first_step_of_what_hardly_moves),
      cmocka_unit_test(a_start_near_zero_at_a_later_time),
      cmocka_unit_test(rk4_keeps_time),
      cmocka_unit_test(backwards_undoes_forwards),
      cmocka_unit_test(a_refused_step_loses_no_state),
      cmocka_unit_test(rough_powers_are_near),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
