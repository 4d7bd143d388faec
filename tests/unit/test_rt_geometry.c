/* What symplectic and symmetric methods keep, measured: energy without a trend, the symplectic form, time reversal, and
 * rounding that grows with the root of the number of steps. Each is shown to be lost by a method that does not keep it.
 * LAG_STEPS: steps of the long runs (tests/exec/long_geometry.sh sets 1000000). */
#include "test_rt_trend.h"

static const lag_method *const family[] = {&lag_symplectic_euler, &lag_verlet, &lag_verlet4, &lag_verlet6,
                                           &lag_verlet8};
enum { MEMBERS = sizeof family / sizeof *family };

typedef struct Long {
  const lag_scene *scene;
  double start, h[MEMBERS], bound[MEMBERS]; /* |E - E0| < bound */
} Long;

/* Steps so long that the error of the method stands well above rounding; and not so long that what a symplectic
 * method keeps is no energy near E any more (verlet6 on Henon and Heiles at h = 1: the chaos of the map itself is
 * seen to drift). */
static const Long runs[] = {
    {&pendulum, 3.0, {0.02, 0.1, 0.5, 0.8, 1}, {2e-2, 5e-3, 5e-6, 2e-5, 3e-5}},
    {&kepler, NAN, {0.005, 0.05, 0.2, 0.25, 0.3}, {1e-2, 1.2e-2, 3e-4, 1e-4, 3e-4}},
    {&henon, NAN, {0.05, 0.1, 0.5, 0.5, 0.6}, {6e-3, 4e-4, 8e-7, 5e-9, 8e-9}},
};

static void energy_is_bounded_without_trend(void **state)
{
  int steps = long_run(100000);
  (void)state;
  for (size_t r = 0; r < sizeof runs / sizeof *runs; r++) {
    for (int m = 0; m < MEMBERS; m++) {
      double worst,
          gain = trend(equal_steps(runs[r].scene, family[m], runs[r].h[m]), runs[r].start, runs[r].h[m], steps, &worst);
      print_message("# %-9s %-16s h %-5g worst %.2e, trend over the run %+.1e\n", runs[r].scene->name, family[m]->name,
                    runs[r].h[m], worst, gain);
      assert_true(worst < runs[r].bound[m] && worst > 1e-11);
      assert_true(fabs(gain) < 0.1 * worst);
    }
  }
}

/* The same measure finds the drift of a method that has one. */
static void rk4_has_a_trend(void **state)
{
  (void)state;
  for (size_t r = 0; r < sizeof runs / sizeof *runs; r++) {
    double worst,
        gain = trend(equal_steps(runs[r].scene, &lag_rk4, runs[r].h[1]), runs[r].start, runs[r].h[1], 20000, &worst);
    assert_true(fabs(gain) > 0.5 * worst);
  }
}

/* ---- The symplectic form: J^T Omega J - Omega of one step, with p = v (unit mass). J by central differences of
 * order 8: rounding 1e-16/0.02, truncation 0.02^8/630 times a ninth derivative. */

static void jacobian(const lag_scene *scene, const lag_method *m, double h, const double *y, double (*jac)[4])
{
  static const double weight[4] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
  int n = 2 * scene->model->nq;
  double delta = 0.02;
  for (int j = 0; j < n; j++) {
    for (int i = 0; i < n; i++) {
      jac[i][j] = 0;
    }
    for (int k = 0; k < 8; k++) {
      double at[4], out[4], sign = k < 4 ? 1 : -1;
      memcpy(at, y, sizeof at);
      at[j] += sign * (k % 4 + 1) * delta;
      flow(scene, m, h, h, at, out);
      for (int i = 0; i < n; i++) {
        jac[i][j] += sign * weight[k % 4] * out[i] / delta;
      }
    }
  }
}

static double symplectic_defect(const lag_scene *scene, const lag_method *m, double h, const double *y)
{
  int nq = scene->model->nq, n = 2 * nq;
  double jac[4][4], worst = 0;
  jacobian(scene, m, h, y, jac);
  for (int a = 0; a < n; a++) {
    for (int b = 0; b < n; b++) {
      double sum = 0, omega = b == a + nq ? 1 : a == b + nq ? -1 : 0;
      for (int i = 0; i < nq; i++) {
        sum += jac[i][a] * jac[nq + i][b] - jac[nq + i][a] * jac[i][b];
      }
      worst = fmax(worst, fabs(sum - omega));
    }
  }
  return worst;
}

static void one_step_is_symplectic(void **state)
{
  const double pend[4] = {2, 0.7}, orbit[4] = {-1.5, -0.28, 0.22, -0.48}, star[4] = {0.1, -0.25, 0.4, 0.1};
  (void)state;
  for (int m = 0; m < MEMBERS; m++) {
    assert_close(symplectic_defect(&pendulum, family[m], 0.5, pend), 0, 1e-12);
    assert_close(symplectic_defect(&kepler, family[m], 0.2, orbit), 0, 1e-12);
    assert_close(symplectic_defect(&henon, family[m], 0.5, star), 0, 1e-12);
  }
  assert_true(symplectic_defect(&pendulum, &lag_rk45, 0.5, pend) > 1e-8);
  assert_true(symplectic_defect(&pendulum, &lag_rk4, 0.5, pend) > 1e-6);
  assert_true(symplectic_defect(&henon, &lag_dop853, 1, star) > 1e-9);
}

/* ---- Time reversal: n steps forth, the velocity turned, n steps: the start again */

static double not_returned(const lag_method *m, double h, int n)
{
  double start[4] = {0.4, 0, 0, 2}, y[4];
  flow(&kepler, m, h, n * h, start, y);
  y[2] = -y[2];
  y[3] = -y[3];
  flow(&kepler, m, h, n * h, y, y);
  y[2] = -y[2];
  y[3] = -y[3];
  return distance(4, y, start);
}

static void symmetric_methods_find_their_way_back(void **state)
{
  const double h = 0x1p-6; /* n h is exact */
  (void)state;
  for (int m = 0; m < MEMBERS; m++) {
    double away = not_returned(family[m], h, 1000);
    if (family[m]->flags & LAG_METHOD_SYMMETRIC) {
      assert_close(away, 0, 5e-12);
    } else {
      assert_true(away > 1e-4);
    }
  }
  assert_true(not_returned(&lag_rk4, h, 1000) > 1e-8);
}

/* ---- Rounding. Verlet's map of the oscillator keeps p^2 + q^2 (1 - h^2/4) exactly, so what it loses is rounding. */

static double invariant(const double *y, double h)
{
  return y[1] * y[1] + y[0] * y[0] * (1 - h * h / 4);
}

/* Root mean square over the phases of the oscillator, after n steps: by the method, and by sums without
 * compensation. */
static void lost(int n, double h, double *method, double *plain)
{
  *method = *plain = 0;
  for (int k = 0; k < 8; k++) {
    double start[4] = {cos(k), sin(k)}, y[4], i0 = invariant(start, h);
    flow(&osc, &lag_verlet, h, n * h, start, y);
    double d = invariant(y, h) / i0 - 1, q = start[0], v = start[1], a = -q;
    *method += d * d / 8;
    for (int i = 0; i < n; i++) {
      v += h / 2 * a;
      q += h * v;
      a = -q;
      v += h / 2 * a;
    }
    d = invariant((double[]){q, v}, h) / i0 - 1;
    *plain += d * d / 8;
  }
  *method = sqrt(*method);
  *plain = sqrt(*plain);
}

static void rounding_grows_with_the_root_of_the_steps(void **state)
{
  double few, many, plain;
  int steps = long_run(100000);
  (void)state;
  lost(steps / 100, 0.01, &few, &plain);
  lost(steps, 0.01, &many, &plain);
  print_message("# invariant of verlet after %d steps: %.1e, without compensation %.1e\n", steps, many, plain);
  assert_true(many < 50 * fmax(few, 1e-16)); /* the root of 100 is 10 */
  assert_true(many < 5e-14 && many < 0.2 * plain);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energy_is_bounded_without_trend),
      cmocka_unit_test(rk4_has_a_trend),
      cmocka_unit_test(one_step_is_symplectic),
      cmocka_unit_test(symmetric_methods_find_their_way_back),
      cmocka_unit_test(rounding_grows_with_the_root_of_the_steps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
