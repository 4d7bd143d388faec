/* What every symplectic method keeps in the long run, in its implicit form: energy without a trend, and the area of
 * phase space. LAG_STEPS: steps of the long runs (tests/exec/long_energy.sh sets 1000000). The explicit forms:
 * test_rt_geometry.c. */
#include "slow.h"
#include "test_rt_trend.h"

/* All methods that claim it, in each of their orders; h, and the bound of |E - E0|, of the double pendulum where it
 * swings and does not tumble, the pendulum from 3.0, Kepler with e = 0.6. Steps so long that the method's error
 * stands well above rounding; the bounds are twice what 20000 steps show. */
typedef struct Kind {
  Setting set;
  double h[3], bound[3];
} Kind;

static const Kind kinds[] = {
    {{&lag_symplectic_euler, {{0}}, 0, 0}, {0.005, 0.02, 0.005}, {8e-2, 3e-2, 1e-2}},
    {{&lag_verlet, {{0}}, 0, 0}, {0.05, 0.1, 0.05}, {1e-1, 7e-3, 2e-2}},
    {{&lag_verlet4, {{0}}, 0, 0}, {0.05, 0.5, 0.2}, {7e-4, 3e-5, 2e-3}},
    {{&lag_verlet6, {{0}}, 0, 0}, {0.05, 0.8, 0.2}, {2e-4, 1e-4, 3e-4}},
    {{&lag_verlet8, {{0}}, 0, 0}, {0.05, 0.8, 0.2}, {3e-7, 4e-5, 3e-5}},
    {{&lag_variational, {{0}}, 0, 0}, {0.05, 0.1, 0.05}, {9e-2, 3e-3, 2e-2}},
    {{&lag_variational, {{"order", 4, NULL}}, 1, 0}, {0.05, 0.5, 0.1}, {1e-3, 4e-4, 1e-4}},
    {{&lag_variational, {{"order", 6, NULL}}, 1, 0}, {0.1, 0.5, 0.2}, {1e-2, 8e-6, 3e-4}},
    {{&lag_variational, {{"order", 8, NULL}}, 1, 0}, {0.1, 0.5, 0.2}, {6e-4, 6e-8, 4e-6}},
    {{&lag_gauss, {{"stages", 1, NULL}}, 1, 0}, {0.05, 0.1, 0.05}, {9e-2, 3e-3, 2e-2}},
    {{&lag_gauss, {{0}}, 0, 0}, {0.05, 0.5, 0.2}, {1e-3, 4e-4, 4e-3}},
    {{&lag_gauss, {{"stages", 3, NULL}}, 1, 0}, {0.1, 0.5, 0.2}, {1e-2, 8e-6, 3e-4}},
    {{&lag_gauss, {{"stages", 4, NULL}}, 1, 0}, {0.1, 0.5, 0.2}, {6e-4, 6e-8, 4e-6}},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* Each method on one system, another each day; in `make test-all` on all three. */
static int left_out(const Kind *k, int system) {
  return !all_rows() && ((size_t)(k - kinds) + first_row(3)) % 3 != (size_t)system;
}

static void regular_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 0.7;
  q[1] = -0.4;
  v[0] = v[1] = 0;
}

/* The three systems without the fact that they are separable. */
static void systems(lag_scene *scenes, lag_model *models)
{
  scenes[0] = double_pendulum;
  scenes[0].start = regular_start;
  scenes[1] = pendulum;
  scenes[2] = kepler;
  for (int i = 1; i < 3; i++) {
    models[i] = *scenes[i].model;
    models[i].flags &= ~(unsigned)LAG_SEPARABLE;
    scenes[i].model = &models[i];
  }
}

static void energy_is_bounded_without_trend(void **state)
{
  lag_scene scenes[3];
  lag_model models[3];
  int steps = long_run(6000);
  (void)state;
  systems(scenes, models);
  for (const Kind *k = kinds; k < kinds + KINDS; k++) {
    assert_true(k->set.method->flags & LAG_METHOD_SYMPLECTIC);
    for (int i = 0; i < 3; i++) {
      if (left_out(k, i)) continue;
      double worst, gain = trend(sim_at(&scenes[i], &k->set, k->h[i]), i == 1 ? 3.0 : NAN, k->h[i], steps, &worst);
      print_message("# %-15s %-16s %d h %-5g worst %.2e, trend over the run %+.1e\n", scenes[i].name,
                    k->set.method->name, (int)(k - kinds), k->h[i], worst, gain);
      assert_true(worst < k->bound[i] && worst > 1e-11);
      assert_true(fabs(gain) < 0.1 * worst);
    }
  }
}

/* Every method whose descriptor says so is in the table, or in test_rt_wisdom_holman. */
static void all_that_claim_it(void **state)
{
  (void)state;
  for (int i = 0; i < lag_nmethods; i++) {
    int tried = 0;
    for (int m = 0; m < KINDS; m++) {
      tried |= lag_methods[i] == kinds[m].set.method;
    }
    assert_int_equal(tried || OF_BODIES(lag_methods[i]), (lag_methods[i]->flags & LAG_METHOD_SYMPLECTIC) != 0);
  }
}

/* ---- A blob: the points of a closed curve in phase space, and the area inside, the integral of p dq along it,
 * summed over the coordinates (Poincare). With N points of an analytic curve, dq by differences of order 8, the rest
 * is below 1e-12. */

enum { N = 144 };

static void at_blob(int i, const lag_scene *scene, double *y)
{
  int nq = scene->model->nq;
  double angle = 2 * acos(-1) * i / N;
  scene->start(scene, NULL, y, y + nq, NULL);
  y[0] += 0.03 * cos(angle);
  y[nq] += 0.03 * sin(angle);
  if (nq > 1) {
    y[1] += 0.02 * sin(angle + 1);
    y[nq + 1] += 0.03 * cos(angle - 2);
  }
}

static double area(int nq, double q[][N], double p[][N])
{
  static const double weight[4] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
  double sum = 0;
  for (int c = 0; c < nq; c++) {
    for (int i = 0; i < N; i++) {
      for (int k = 1; k <= 4; k++) {
        sum += p[c][i] * weight[k - 1] * (q[c][(i + k) % N] - q[c][(i + N - k) % N]);
      }
    }
  }
  return sum;
}

/* How much of the area is lost on the way to t. */
static double lost_area(const lag_scene *scene, const Setting *k, double h, double t)
{
  static double q[2][2][N], p[2][2][N];
  int nq = scene->model->nq;
  for (int i = 0; i < N; i++) {
    static const char *const names[2][4] = {{"x", "x'"}, {"x", "y", "x'", "y'"}};
    double y[2][4], at[2];
    lag_sim *s = sim_at(scene, k, h);
    at_blob(i, scene, y[0]);
    for (int c = 0; c < 2 * nq; c++) {
      assert_int_equal(lag_sim_set(s, names[nq - 1][c], y[0][c]), 0);
    }
    assert_int_equal(lag_sim_advance(s, t), LAG_OK);
    memcpy(y[1], lag_sim_q(s), (size_t)(2 * nq) * sizeof(double));
    lag_sim_free(s);
    for (int end = 0; end < 2; end++) {
      momenta(scene, y[end], at);
      for (int c = 0; c < nq; c++) {
        q[end][c][i] = y[end][c];
        p[end][c][i] = at[c];
      }
    }
  }
  return area(nq, q[1], p[1]) / area(nq, q[0], p[0]) - 1;
}

static void the_area_of_a_blob_is_kept(void **state)
{
  static const Setting rk4 = {&lag_rk4, {{0}}, 0, 0}, rk45 = {&lag_rk45, {{"adapt", 0, "off"}}, 1, 0};
  lag_scene scenes[3];
  lag_model models[3];
  (void)state;
  systems(scenes, models);
  for (int i = 0; i < 3; i++) {
    double h = i == 1 ? 0.2 : 0.05, t = 1;
    for (const Kind *k = kinds; k < kinds + KINDS; k++) {
      if (left_out(k, i)) continue;
      double lost = lost_area(&scenes[i], &k->set, h, t);
      print_message("# %-15s %-16s area lost %.1e\n", scenes[i].name, k->set.method->name, lost);
      assert_close(lost, 0, 1e-11); /* rounding of the points is 1e-16 of 1, the area 0.003 */
    }
    double lost = lost_area(&scenes[i], &rk4, h, t), lost5 = lost_area(&scenes[i], &rk45, h, t);
    print_message("# %-15s rk4 %.1e, rk45 %.1e\n", scenes[i].name, lost, lost5);
    assert_true(fabs(lost) > 1e-7 && fabs(lost5) > 1e-8);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energy_is_bounded_without_trend),
      cmocka_unit_test(all_that_claim_it),
      cmocka_unit_test(the_area_of_a_blob_is_kept),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
