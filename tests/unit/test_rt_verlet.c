/* The Verlet family: its tables, measured orders of steps and of dense output, what it refuses, forces with explicit
 * time. Expected values: closed forms; for pendulum and Henon-Heiles digits of independent Taylor integrations in
 * multiple precision (pendulum also 2 asin(k sn(K - t, k)) with mpmath), on which two precisions and step sequences
 * agree. */
#include "test_rt_systems.h"

#include "core/core.h"
#include "kernels/composition.h"
#include "methods/step_interpolant.h"

typedef struct Member {
  const lag_method *method;
  const lag_composition *table;
} Member;

static const Member family[] = {{&lag_symplectic_euler, &lag_compose_symplectic_euler},
                                {&lag_verlet, &lag_compose_verlet},
                                {&lag_verlet4, &lag_compose_verlet4},
                                {&lag_verlet6, &lag_compose_verlet6},
                                {&lag_verlet8, &lag_compose_verlet8}};
enum { MEMBERS = sizeof family / sizeof *family };

static void tables_are_consistent_and_symmetric(void **state)
{
  (void)state;
  for (int m = 0; m < MEMBERS; m++) {
    const lag_composition *c = family[m].table;
    double drifts = 0, kicks = 0;
    for (int i = 0; i < c->stages; i++) drifts += c->drift[i];
    for (int i = 0; i <= c->stages; i++) kicks += c->kick[i];
    assert_close(drifts, 1, 1e-15);
    assert_close(kicks, 1, 1e-15);
    assert_int_equal(c->order > 1, !!(family[m].method->flags & LAG_METHOD_SYMMETRIC));
    assert_int_equal(c->order, family[m].method->order);
    assert_true(family[m].method->flags & LAG_METHOD_SYMPLECTIC);
  }
}

/* ---- Order: error at the end of a run, or at 0.37 of its last step, in n and in 1.5 n steps */

static const double henon_50[] = {-0.196192724097036858688914468350, -0.102743931477078567947916243528,
    -0.455526935449929934586996935673, -0.0251753704132432471100549299249};
static const double pendulum_10[] = {2.46853204863864863459435656744, 0.196092889365668955247381105511};

static double error_of(const lag_scene *scene, const lag_method *m, int n, double end, const double *right)
{
  lag_sim *s = equal_steps(scene, m, end / n);
  assert_int_equal(lag_sim_advance(s, end), LAG_OK);
  double e = distance(2 * scene->model->nq, lag_sim_q(s), right);
  lag_sim_free(s);
  return e;
}

static void check_order(const lag_scene *scene, const lag_method *m, int n, double end, const double *right)
{
  double e1 = error_of(scene, m, 2 * n, end, right), e2 = error_of(scene, m, 3 * n, end, right);
  assert_close(log(e1 / e2) / log(1.5), m->order, 0.15);
}

/* Steps small enough for the leading term, large enough to stay above rounding. */
static void steps_have_their_order(void **state)
{
  static const int on_pendulum[] = {2000, 400, 130, 70, 24}, on_kepler[] = {8000, 1000, 500, 120, 50},
                   on_henon[] = {8000, 1000, 500, 150, 100};
  double kepler_4[4];
  (void)state;
  kepler_exact(4, kepler_4);
  for (int m = 0; m < MEMBERS; m++) {
    check_order(&pendulum, family[m].method, on_pendulum[m], 10, pendulum_10);
    check_order(&kepler, family[m].method, on_kepler[m], 4, kepler_4);
    check_order(&henon, family[m].method, on_henon[m], 50, henon_50);
  }
}

/* The largest error along one orbit at the place 0.37 in each step. */
static double dense_error(const lag_method *m, double h, double end)
{
  lag_sim *s = equal_steps(&kepler, m, h);
  double worst = 0, y[4];
  for (int k = 0; k < (int)lround(end / h); k++) {
    assert_int_equal(lag_sim_advance(s, (k + 0.37) * h), LAG_OK);
    kepler_exact((k + 0.37) * h, y);
    worst = fmax(worst, distance(4, lag_sim_q(s), y));
  }
  lag_sim_free(s);
  return worst;
}

static void dense_output_has_the_order_of_the_steps(void **state)
{
  static const int n[] = {4000, 1000, 300, 200, 100};
  (void)state;
  for (int m = 0; m < MEMBERS; m++) {
    double e1 = dense_error(family[m].method, 4.0 / (2 * n[m]), 4),
           e2 = dense_error(family[m].method, 4.0 / (3 * n[m]), 4);
    assert_int_equal(family[m].method->dense_order, family[m].method->order);
    assert_close(log(e1 / e2) / log(1.5), family[m].method->dense_order, 0.3);
  }
}

/* Dense output of order 6 costs 2 forces, of order 8 6, in a step in which it is asked for. */
static void dense_output_is_paid_for_when_asked_for(void **state)
{
  static const int extra[] = {0, 0, 0, 2, 6};
  (void)state;
  for (int m = 0; m < MEMBERS; m++) {
    lag_sim *s = equal_steps(&kepler, family[m].method, 0.125);
    lag_stats st;
    assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
    assert_int_equal(lag_sim_advance(s, 1.01), LAG_OK);
    assert_int_equal(lag_sim_advance(s, 1.07), LAG_OK);
    lag_sim_stats(s, &st);
    assert_int_equal(st.steps, 9);
    assert_int_equal(st.rhs_calls - (long long)s->run->pole_calls, 1 + 9 * family[m].table->stages + extra[m]);
    lag_sim_free(s);
  }
}

/* The path between steps is exact where its polynomials are: q of degree 5 + 2 level, v of degree 3 + 2 level. */
static int degree; /* of the motion q = t^degree - t */

static int power_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = degree * (degree - 1) * pow(t, degree - 2);
  return 0;
}

static void paths_reproduce_polynomials(void **state)
{
  static const lag_model model = {MODEL("power"), .nq = 1, .q = names_q, .accel = power_accel};
  lag_problem pb = {.model = &model, .n = 2, .nq = 1, .dir = 1};
  double *path = calloc(lag_interpolant_size(1), sizeof *path), t0 = 0.3, h = 0.7, y[2][2], f[2][2], out[2];
  (void)state;
  for (int level = 0; level <= 2; level++) {
    for (degree = 2; degree <= 5 + 2 * level; degree++) {
      for (int k = 0; k < 2; k++) {
        double t = t0 + k * h;
        y[k][0] = pow(t, degree) - t;
        y[k][1] = degree * pow(t, degree - 1) - 1;
        assert_int_equal(lag_rhs(&pb, t, y[k], f[k]), 0);
      }
      StepEnds ends = {t0, h, y[0], f[0], y[1], f[1]};
      assert_int_equal(lag_interpolant_make(path, &pb, &ends, level, 1), 0);
      for (double s = 0; s <= 1; s += 0.125) {
        double t = t0 + s * h;
        lag_interpolant_at(path, &pb, &ends, level, s, out);
        assert_close(out[0], pow(t, degree) - t, 2e-14);
        if (degree <= 4 + 2 * level) {
          assert_close(out[1], degree * pow(t, degree - 1) - 1, 2e-13);
        }
      }
    }
  }
  free(path);
}

/* A force with explicit time is taken at the right time: the order stays. Reference: dop853 in small steps. */
static void forces_may_depend_on_time(void **state)
{
  static const int n[] = {4000, 400, 130, 40, 24};
  double start[] = {2.5, 0}, right[2];
  (void)state;
  flow(&driven, &lag_dop853, 0.01, 10, start, right);
  for (int m = 0; m < MEMBERS; m++) {
    check_order(&driven, family[m].method, n[m], 10, right);
  }
}

/* ---- The tables that were not chosen, for comparison: compositions of Verlet steps of size w_1 h, w_2 h, ..., w_1
 * h. */

/* M. Suzuki, Phys. Lett. A 146 (1990) 319, DOI 10.1016/0375-9601(90)90962-N; W. Kahan, R.-C. Li, Math. Comp. 66
 * (1997) 1089, DOI 10.1090/S0025-5718-97-00873-9, s9odr6a and s17odr8a. */
static const double suzuki4[] = {0.41449077179437573714, 0.41449077179437573714};
static const double kahan_li6[] = {0.39216144400731413927925056, 0.33259913678935943859974864,
                                   -0.70624617255763935980996482, 0.08221359629355080023149045};
static const double kahan_li8[] = {0.13020248308889008087881763,  0.56116298177510838456196441,
                                   -0.38947496264484728640807860, 0.15884190655515560089621075,
                                   -0.39590389413323757733623154, 0.18453964097831570709183254,
                                   0.25837438768632204729397911,  0.29501172360931029887096624};

/* n steps of 2 half + 1 Verlet steps each. */
static void compose(const lag_scene *scene, const double *weight, int half, int n, double end, double *y)
{
  double a[2], zd[1], work[1], total = 0, h = end / n, *q = y, *v = y + scene->model->nq;
  for (int i = 0; i < half; i++) {
    total += 2 * weight[i];
  }
  scene->start(scene, NULL, q, v, NULL);
  for (int k = 0; k < n * (2 * half + 1); k++) {
    int j = k % (2 * half + 1), i = j > half ? 2 * half - j : j;
    double w = h * (i == half ? 1 - total : weight[i]);
    for (int pass = 0; pass < 2; pass++) {
      scene->model->accel(scene->model, 0, q, v, NULL, NULL, NULL, a, zd, work);
      for (int c = 0; c < scene->model->nq; c++) {
        v[c] += w / 2 * a[c];
        q[c] += pass ? 0 : w * v[c];
      }
    }
  }
}

/* Ten times more accurate, or more, than the best composition of Verlet steps for as many forces. */
static void the_chosen_tables_are_the_efficient_ones(void **state)
{
  static const struct {
    const double *weight;
    int half, member, forces;
  } rivals[] = {{suzuki4, 2, 2, 6000}, {kahan_li6, 4, 3, 3960}, {kahan_li8, 8, 4, 2907}};
  double kepler_4[4], y[4];
  (void)state;
  kepler_exact(4, kepler_4);
  for (int i = 0; i < 3; i++) {
    const Member *m = &family[rivals[i].member];
    double mine = error_of(&henon, m->method, rivals[i].forces / m->table->stages, 50, henon_50);
    compose(&henon, rivals[i].weight, rivals[i].half, rivals[i].forces / (2 * rivals[i].half + 1), 50, y);
    assert_true(mine * 10 < distance(4, y, henon_50));
    mine = error_of(&kepler, m->method, rivals[i].forces / 2 / m->table->stages, 4, kepler_4);
    compose(&kepler, rivals[i].weight, rivals[i].half, rivals[i].forces / 2 / (2 * rivals[i].half + 1), 4, y);
    assert_true(mine * 10 < distance(4, y, kepler_4));
  }
}

/* ---- What is refused */

static void what_needs_derivatives_is_refused_without_them(void **state)
{
  lag_model bare = double_pendulum_model;
  lag_scene scene = double_pendulum;
  (void)state;
  bare.variation = NULL;
  scene.model = &bare;
  for (int m = 0; m < MEMBERS; m++) {
    lag_sim *s = lag_sim_new(&scene);
    assert_int_equal(lag_sim_set_method(s, family[m].method, NULL, 0), LAG_EMETHOD);
    assert_non_null(strstr(lag_sim_message(s), "derivatives of the model"));
    assert_non_null(strstr(lag_sim_message(s), "lagc build MODEL --method"));
    assert_non_null(strstr(lag_sim_message(s), family[m].method->name));
    assert_non_null(strstr(lag_sim_message(s), "dop853"));
    assert_int_equal(lag_sim_advance(s, 1), LAG_OK); /* with the method it had */
    lag_sim_free(s);
  }
}

/* A scene that names such a method says so at the first step, and goes on with another one. */
static void a_scene_with_a_refused_method_says_so(void **state)
{
  lag_model bare = double_pendulum_model;
  lag_scene scene = double_pendulum;
  (void)state;
  bare.variation = NULL;
  scene.model = &bare;
  scene.method = "verlet";
  lag_sim *s = lag_sim_new(&scene);
  assert_non_null(s);
  assert_int_equal(lag_sim_advance(s, 1), LAG_EMETHOD);
  assert_non_null(strstr(lag_sim_message(s), "derivatives of the model"));
  assert_int_equal(lag_sim_set_method(s, &lag_rk45, NULL, 0), LAG_OK);
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  lag_sim_free(s);
}

/* ---- Failures: the state stays that of the last step */

static int wall_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = 1 / sqrt(1 - q[0]);
  return 0;
}

static void wall_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 0;
  v[0] = 1;
}

SYSTEM(wall, 1, LAG_SEPARABLE, NULL, NO_DERIVATIVES);

/* Forces that change their course within a step: where a pole could be, it is looked for. All evaluations are
 * counted, and bounded. */
static int evaluations;

static int rough_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  evaluations++;
  a[0] = -q[0] + 5 * sin(40 * q[0]) + 3 * sin(77 * q[0] + 1);
  return 0;
}

static void poles_are_looked_for_in_bounded_time(void **state)
{
  lag_model rough_model = kepler_model;
  lag_scene rough = kepler;
  lag_stats st;
  (void)state;
  rough_model.nq = 1, rough_model.accel = rough_accel, rough_model.energy = NULL;
  rough.model = &rough_model, rough.t1 = 20, rough.monitors = NULL, rough.nmonitors = 0;
  evaluations = 0;
  lag_sim *s = equal_steps(&rough, &lag_verlet, 0.1);
  assert_int_equal(lag_sim_advance(s, 20), LAG_OK);
  lag_sim_stats(s, &st);
  assert_int_equal(st.steps, 200);
  assert_in_range(evaluations - st.rhs_calls, 0, 24); /* periods, not counted: 16 here; sizes: 7 */
  assert_true(s->run->pole_calls > 20);
  assert_in_range(st.rhs_calls, 201, 201 + 48 + 200 / 4 + 27); /* the last search takes up to 3 + 24 */
  lag_sim_free(s);
}

static void a_failed_step_leaves_the_last_state(void **state)
{
  (void)state;
  for (int m = 0; m < MEMBERS; m++) {
    lag_sim *s = equal_steps(&wall, family[m].method, 0.05);
    int rc = lag_sim_advance(s, 5);
    assert_int_equal(rc, LAG_ENAN);
    assert_true(lag_sim_q(s)[0] > 0.5 && lag_sim_q(s)[0] < 1 && isfinite(lag_sim_v(s)[0]));
    assert_non_null(strstr(lag_sim_message(s), "no finite value"));
    lag_sim_free(s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tables_are_consistent_and_symmetric),
      cmocka_unit_test(steps_have_their_order),
      cmocka_unit_test(dense_output_has_the_order_of_the_steps),
      cmocka_unit_test(dense_output_is_paid_for_when_asked_for),
      cmocka_unit_test(paths_reproduce_polynomials),
      cmocka_unit_test(forces_may_depend_on_time),
      cmocka_unit_test(the_chosen_tables_are_the_efficient_ones),
      cmocka_unit_test(what_needs_derivatives_is_refused_without_them),
      cmocka_unit_test(a_scene_with_a_refused_method_says_so),
      cmocka_unit_test(poles_are_looked_for_in_bounded_time),
      cmocka_unit_test(a_failed_step_leaves_the_last_state),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
