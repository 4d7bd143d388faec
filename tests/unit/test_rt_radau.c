/* radau: order, exactness of what it is made of, stiff models, its step control, failures. Expected values: closed
 * forms, and digits published with the problems. */
#include "test_rt_systems.h"

/* ---- order: nonlinear pendulum, double pendulum, Kepler */

static double end_of(const lag_scene *scene, double h, double t, double *y)
{
  lag_option opt[] = {{"step", h, NULL}, {"adapt", 0, "off"}};
  lag_sim *s = sim_with(scene, &lag_radau, 1e-14, 2, opt);
  lag_stats st;
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  memcpy(y, lag_sim_q(s), (size_t)(2 * scene->model->nq) * sizeof *y);
  lag_sim_stats(s, &st);
  lag_sim_free(s);
  return st.rejected;
}

static void exact(const lag_scene *scene, double t, double *y)
{
  if (scene == &kepler) {
    kepler_exact(t, y);
    return;
  }
  lag_sim *s = sim_with(scene, &lag_dop853, 1e-15, 1, (lag_option[]){{"atol", 1e-16, NULL}});
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  memcpy(y, lag_sim_q(s), (size_t)(2 * scene->model->nq) * sizeof *y);
  lag_sim_free(s);
}

static void steps_have_order_5(void **state)
{
  static const struct {
    const lag_scene *scene;
    double h, t;
  } runs[] = {{&pendulum, 0.1, 4}, {&double_pendulum, 0.01, 2}, {&kepler, 0.02, 4}};
  (void)state;
  for (int i = 0; i < 3; i++) {
    double y[3][4];
    int n = 2 * runs[i].scene->model->nq;
    exact(runs[i].scene, runs[i].t, y[0]);
    assert_true(end_of(runs[i].scene, runs[i].h, runs[i].t, y[1]) == 0);
    end_of(runs[i].scene, runs[i].h / 2, runs[i].t, y[2]);
    double p = log2(distance(n, y[1], y[0]) / distance(n, y[2], y[0]));
    print_message("# %s: order %.2f\n", runs[i].scene->name, p);
    assert_close(p, 5, 0.15);
  }
}

/* Within a step from exact values the error of the interpolant is of order 4: order 3, and the step. */
static void dense_output_has_order_3(void **state)
{
  double e[2], right[4];
  (void)state;
  for (int i = 0; i < 2; i++) {
    double h = 0.02 / (1 << i);
    lag_sim *s = sim_with(&kepler, &lag_radau, 1e-14, 2, (lag_option[]){{"step", h, NULL}, {"adapt", 0, "off"}});
    assert_int_equal(lag_sim_advance(s, 0.85 * h), LAG_OK);
    kepler_exact(0.85 * h, right);
    e[i] = distance(4, lag_sim_q(s), right);
    lag_sim_free(s);
  }
  assert_close(log2(e[0] / e[1]), 4, 0.2);
}

static void errors_follow_the_tolerance(void **state)
{
  double y[4];
  (void)state;
  for (int digits = 4; digits <= 12; digits += 2) {
    double tol = pow(10, -digits);
    lag_sim *s = sim_with(&kepler, &lag_radau, tol, 0, NULL);
    assert_int_equal(lag_sim_advance(s, 4), LAG_OK);
    kepler_exact(4, y);
    double e = distance(4, lag_sim_q(s), y);
    print_message("# Kepler, tolerance %.0e: error %.1e\n", tol, e);
    assert_true(e < 300 * tol && e > 1e-2 * tol);
    lag_sim_free(s);
  }
}

/* ---- stiff models: flows z' = f(z) */

#define STIFF_FLOW(name_, nz_, z_)                                                                   \
  static const lag_model name_##_model = {MODEL(#name_), .nz = nz_, .z = z_, .accel = name_##_accel, \
                                          .linear = &name_##_linear};                                \
  static const lag_scene name_ = {                                                                   \
      .name = #name_, .doc = "", .model = &name_##_model, .start = name_##_start, .t1 = 1, .has_span = 1}

static const lag_var three[] = {{"a", "", 1, 0, 0, 0}, {"b", "", 1, 0, 0, 0}, {"c", "", 1, 0, 0, 0}};

/* van der Pol's equation, eps = 1e-6: F. Mazzia, C. Magherini, Test Set for IVP Solvers, release 2.4 (2008), problem
 * VDPOL: z at t = 2, 16 digits. */
static int vdpol_accel(ARGS, UNUSED double *a, double *zd, UNUSED double *w)
{
  zd[0] = z[1];
  zd[1] = ((1 - z[0] * z[0]) * z[1] - z[0]) / 1e-6;
  return 0;
}

LINEARISE(vdpol)
{
  (void)M;
  dr[0] = 1;
  dr[1] = (-2 * z[0] * z[1] - 1) / 1e-6;
  dr[2] = (1 - z[0] * z[0]) / 1e-6;
  return 0;
}

static void vdpol_start(SELF, UNUSED const double *p, UNUSED double *q, UNUSED double *v, double *z) {
  z[0] = 2;
  z[1] = 0;
}

static const lag_entry vdpol_dr[] = {{0, 1}, {1, 0}, {1, 1}}, none[] = {{0, 0}};
static const lag_linear vdpol_linear = {.ndr = 3, .dr = vdpol_dr, .nmass = 0, .mass = none, .eval = vdpol_linearise};
STIFF_FLOW(vdpol, 2, three);

/* Robertson's reaction, to t = 40: the values that the documentation of LSODE gives (A.C. Hindmarsh, 1983), 4
 * digits. */
static int robertson_accel(ARGS, UNUSED double *a, double *zd, UNUSED double *w)
{
  zd[0] = -0.04 * z[0] + 1e4 * z[1] * z[2];
  zd[2] = 3e7 * z[1] * z[1];
  zd[1] = -zd[0] - zd[2];
  return 0;
}

LINEARISE(robertson)
{
  (void)M;
  dr[0] = -0.04;
  dr[1] = 1e4 * z[2];
  dr[2] = 1e4 * z[1];
  dr[6] = 0;
  dr[7] = 6e7 * z[1];
  dr[8] = 0;
  for (int k = 0; k < 3; k++) {
    dr[3 + k] = -dr[k] - dr[6 + k];
  }
  return 0;
}

static void robertson_start(SELF, UNUSED const double *p, UNUSED double *q, UNUSED double *v, double *z) {
  z[0] = 1;
  z[1] = z[2] = 0;
}

static const lag_entry robertson_dr[] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}, {2, 0}, {2, 1}, {2, 2}};
static const lag_linear robertson_linear = {
    .ndr = 9, .dr = robertson_dr, .nmass = 0, .mass = none, .eval = robertson_linearise};
STIFF_FLOW(robertson, 3, three);

static void stiff_flows_are_solved(void **state)
{
  const double vdp[] = {1.706167732170483, -0.8928097010247975}, rober[] = {7.158e-01, 9.185e-06, 2.842e-01};
  lag_stats st;
  (void)state;
  lag_sim *s = sim_with(&vdpol, &lag_radau, 1e-8, 0, NULL);
  assert_int_equal(lag_sim_advance(s, 2), LAG_OK);
  assert_close(lag_sim_z(s)[0], vdp[0], 1e-6);
  assert_close(lag_sim_z(s)[1], vdp[1], 1e-6);
  lag_sim_stats(s, &st);
  print_message("# van der Pol, 1e-8: %lld steps, %lld rejected, %lld right-hand sides\n", st.steps, st.rejected,
                st.rhs_calls);
  assert_true(st.steps < 1200 && st.iterations < 4 * st.systems);
  lag_sim_free(s);
  s = sim_with(&robertson, &lag_radau, 1e-8, 1, (lag_option[]){{"atol", 1e-12, NULL}});
  assert_int_equal(lag_sim_advance(s, 40), LAG_OK);
  for (int i = 0; i < 3; i++) {
    assert_close(lag_sim_z(s)[i] / rober[i], 1, 2e-4); /* half of the last digit */
  }
  lag_sim_free(s);
}

/* A first step on which Newton's method cannot converge is made smaller, and nothing is lost. */
static void newtons_failures_make_steps_smaller(void **state)
{
  lag_stats st;
  (void)state;
  lag_sim *s = sim_with(&vdpol, &lag_radau, 1e-8, 2, (lag_option[]){{"step", 1, NULL}, {"max_step", 2, NULL}});
  assert_int_equal(lag_sim_advance(s, 2), LAG_OK);
  assert_close(lag_sim_z(s)[0], 1.706167732170483, 1e-6);
  lag_sim_stats(s, &st);
  assert_true(st.rejected > 3);
  lag_sim_free(s);
}

/* ---- a stiff spring with a damper: two rates, in closed form */

static const double spring = 1e6, damper = 1e4; /* rates -101.02... and -9898.97... */

static int stiff_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -spring * q[0] - damper * v[0];
  return 0;
}

LINEARISE(stiff)
{
  dr[0] = -spring;
  dr[1] = -damper;
  M[0] = 1;
  return 0;
}

static const lag_entry stiff_dr[] = {{0, 0}, {0, 1}}, stiff_mass[] = {{0, 0}};
LINEAR(stiff);
#define stiff_start osc_start
SYSTEM(stiff, 1, LAG_CONSTANT_MASS | LAG_AUTONOMOUS, NULL, .linear = &stiff_linear);

static void a_stiff_spring_with_a_damper_is_solved(void **state)
{
  double root = sqrt(damper * damper / 4 - spring), slow = -damper / 2 + root, fast = -damper / 2 - root;
  double t = 0.01, right = (slow * exp(fast * t) - fast * exp(slow * t)) / (slow - fast);
  lag_stats few, many;
  (void)state;
  lag_sim *s = sim_with(&stiff, &lag_radau, 1e-9, 0, NULL);
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  /* v, which reaches 100 times x, has 1e-6 a step, of which a hundredth is seen in x */
  assert_close(lag_sim_q(s)[0], right, 3e-8);
  assert_int_equal(lag_sim_advance(s, 10), LAG_OK);
  assert_close(lag_sim_q(s)[0], 0, 1e-9);
  lag_sim_stats(s, &few);
  lag_sim_free(s);
  s = sim_with(&stiff, &lag_rk45, 1e-9, 0, NULL);
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  lag_sim_stats(s, &many);
  print_message("# stiff spring: %lld right-hand sides, rk45 %lld\n", few.rhs_calls, many.rhs_calls);
  assert_true(few.rhs_calls < many.rhs_calls / 15); /* for ten times the time */
  lag_sim_free(s);
}

/* ---- what goes wrong */

static double limit; /* of |z|, beyond which there is no value */

static int edge_accel(ARGS, UNUSED double *a, double *zd, UNUSED double *w)
{
  zd[0] = z[0] * z[0]; /* 1/(1 - t) */
  return fabs(z[0]) > limit ? LAG_ERETRY : 0;
}

LINEARISE(edge)
{
  (void)M;
  dr[0] = 2 * z[0];
  return 0;
}

static const lag_entry edge_dr[] = {{0, 0}};
static const lag_linear edge_linear = {.ndr = 1, .dr = edge_dr, .nmass = 0, .mass = none, .eval = edge_linearise};
#define edge_start flow_start
STIFF_FLOW(edge, 1, three);

/* A wall in the domain, and a pole. */
static void failures_keep_the_last_state(void **state)
{
  (void)state;
  for (int i = 0; i < 2; i++) {
    limit = i ? 1e300 : 1e3;
    lag_sim *s = sim_with(&edge, &lag_radau, 1e-8, 0, NULL);
    int rc = lag_sim_advance(s, 2);
    assert_int_equal(rc, i ? LAG_ESTEP : LAG_EDOMAIN);
    assert_close(lag_sim_time(s), i ? 1 : 0.999, 1e-5);
    assert_close(lag_sim_z(s)[0] * (1 - lag_sim_time(s)), 1, i ? HUGE_VAL : 1e-3);
    lag_stats st;
    lag_sim_stats(s, &st);
    assert_true(i || st.rejected > 0);
    lag_sim_free(s);
  }
}

/* A model without its linearisation is refused, with the command that builds it in. */
static void it_needs_the_linearisation(void **state)
{
  lag_sim *s = lag_sim_new(&stiff);
  lag_model bare = stiff_model;
  lag_scene scene = stiff;
  (void)state;
  lag_sim_free(s);
  bare.linear = NULL;
  scene.model = &bare;
  s = lag_sim_new(&scene);
  assert_int_equal(lag_sim_set_method(s, &lag_radau, NULL, 0), LAG_EMETHOD);
  assert_non_null(strstr(lag_sim_message(s), "lagc build MODEL --method radau"));
  lag_sim_free(s);
}

/* A fixed step that is too long for Newton's method says so. */
static void a_fixed_step_may_be_too_long(void **state)
{
  (void)state;
  lag_sim *s = sim_with(&double_pendulum, &lag_radau, 1e-9, 2, (lag_option[]){{"step", 2, NULL}, {"adapt", 0, "off"}});
  int rc = lag_sim_advance(s, 100);
  assert_int_equal(rc, LAG_EMETHOD);
  assert_non_null(strstr(lag_sim_message(s), "leave out adapt=off"));
  assert_true(isfinite(lag_sim_q(s)[0]));
  lag_sim_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_have_order_5),
      cmocka_unit_test(dense_output_has_order_3),
      cmocka_unit_test(errors_follow_the_tolerance),
      cmocka_unit_test(stiff_flows_are_solved),
      cmocka_unit_test(newtons_failures_make_steps_smaller),
      cmocka_unit_test(a_stiff_spring_with_a_damper_is_solved),
      cmocka_unit_test(failures_keep_the_last_state),
      cmocka_unit_test(it_needs_the_linearisation),
      cmocka_unit_test(a_fixed_step_may_be_too_long),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
