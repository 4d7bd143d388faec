/* Charges along a run: drifts, balances with the work of forces integrated along, trends, monitors. Expected values:
 * closed forms of the damped oscillator, and orders of methods. */
#include "numeric/quadrature.h"
#include "test_rt_systems.h"

/* ---- a plane oscillator, damped: r'' = -r - c r', from (1, 0) with (0, 1/2); E' = -c v^2, L' = -c L; p = {c, how
 * wrong L' is} */
static const lag_var damped_p[] = {{"c", "", 1, 0, 0, 0}, {"wrong", "", 1, 0, 0, 0}};
static const lag_var damped_u[] = {{"push", "", 1, 0, 0, 0}};

static int damped_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -q[0] - p[0] * v[0];
  a[1] = -q[1] - p[0] * v[1];
  return 0;
}

static int damped_energy(ARGS, double *e, UNUSED double *w)
{
  double T = (v[0] * v[0] + v[1] * v[1]) / 2, V = (q[0] * q[0] + q[1] * q[1]) / 2;
  e[0] = T + V;
  e[1] = 2 * T + fabs(T - V);
  return 0;
}

static int spin_value(ARGS, double *out, UNUSED double *w)
{
  out[0] = q[0] * v[1] - q[1] * v[0];
  out[1] = fabs(q[0] * v[1]) + fabs(q[1] * v[0]);
  return 0;
}

static int damped_values(ARGS, double *out, UNUSED double *w)
{
  spin_value(self, t, q, v, z, p, u, out, w);
  return spin_value(self, t, q, v, z, p, u, out + 2, w);
}

static int damped_powers(ARGS, double *out, UNUSED double *w)
{
  out[0] = -p[0] * (v[0] * v[0] + v[1] * v[1]);
  out[1] = out[2] = -p[0] * (q[0] * v[1] - q[1] * v[0]) * (1 - p[1]);
  return 0;
}

static int no_push(SELF, UNUSED double t, UNUSED const double *p, double *u) {
  u[0] = 0;
  return 0;
}

static void damped_params(SELF, double *p, const unsigned char *fixed) { p[0] = fixed[0] ? p[0] : 0.2; }

static void damped_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 1;
  v[1] = 0.5;
  q[1] = v[0] = 0;
}

static const lag_charge damped_of[] = {
    {"energy", "", LAG_BALANCED}, {"spin", "kg", LAG_BALANCED}, {"by_formula", "", LAG_BALANCED | LAG_BY_FORMULAS}};
static const lag_charges damped_charges = {.n = 3, .of = damped_of, .values = damped_values, .powers = damped_powers};
static const lag_model damped_model = {MODEL("damped"),
                                       .flags = LAG_CONSTANT_MASS | LAG_SMOOTH, .nq = 2, .np = 2, .nu = 1, .q = names_q,
                                       .p = damped_p, .u = damped_u, .inputs = no_push, .accel = damped_accel,
                                       .energy = damped_energy,
                                       .charges = &damped_charges};
static const lag_scene damped = {.name = "damped",
                                 .doc = "", .model = &damped_model, .params = damped_params, .start = damped_start,
                                 .t1 = 10,
                                 .has_span = 1};
static const lag_monitor watch_spin[] = {{"spin", -2, 1e-8, 0}};
static const lag_scene watched = {.name = "watched",
                                  .doc = "", .model = &damped_model, .params = damped_params, .start = damped_start,
                                  .t1 = 10, .has_span = 1, .nmonitors = 1,
                                  .monitors = watch_spin};

static double energy_at(double t)
{
  double c = 0.2, w = sqrt(1 - c * c / 4), f = exp(-c * t / 2), C = cos(w * t), S = sin(w * t);
  double x = f * (C + c / (2 * w) * S), vx = -f * S / w, y = f * S / (2 * w), vy = f * (C - c / (2 * w) * S) / 2;
  return (x * x + y * y + vx * vx + vy * vy) / 2;
}

/* Balanced, unless free. */
static lag_sim *sim(const lag_scene *scene, const lag_method *m, double tol, double step, int balanced)
{
  lag_sim *s = sim_with(scene, m, tol, !(m->flags & LAG_METHOD_ADAPTIVE), (lag_option[]){{"step", step, NULL}});
  if (balanced) {
    assert_int_equal(lag_sim_balance(s), LAG_OK);
  }
  return s;
}

static lag_charge_stats charge(lag_sim *s, int k)
{
  lag_charge_stats c;
  lag_sim_charge(s, k, &c);
  return c;
}

/* Exact for polynomials of degree 2 n - 1, of Radau's 2 n - 2, and for no more; symmetric, or with the end. */
static void quadratures_have_their_order(void **state)
{
  (void)state;
  for (int n = 1; n <= 8; n++) {
    for (int radau = 0; radau < 2; radau++) {
      double c[8], b[8];
      (radau ? lag_radau_points : lag_gauss_points)(n, c, b);
      for (int k = 0; k <= 2 * n - radau; k++) {
        double sum = 0;
        for (int i = 0; i < n; i++) {
          sum += b[i] * pow(c[i], k);
        }
        double error = fabs(sum - 1.0 / (k + 1));
        /* at least (n!)^4/((2 n + 1) ((2 n)!)^2), 3.6e-10; rounding */
        assert_true(k == 2 * n - radau ? error > 1e-10 : error < 1e-14);
      }
      assert_true(c[0] > 0 && (radau ? c[n - 1] == 1 : c[n - 1] == 1 - c[0]));
    }
  }
}

/* The work of damping at any time, also within a step, is what the closed form says that is gone. */
static void balances_close(void **state)
{
  static const struct {
    const lag_method *method;
    double within; /* of errors that add up to a hundred times the tolerance, 1e-11, or to (0.01)^4 */
  } cases[] = {{&lag_dop853, 1e-9}, {&lag_rk45, 1e-9}, {&lag_rk4, 1e-8}};
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    lag_sim *s = sim(&damped, cases[i].method, 1e-11, 0.01, 1);
    for (double t = 0.777; t < 10; t += 3.1) {
      assert_int_equal(lag_sim_advance(s, t), LAG_OK);
      lag_charge_stats e = charge(s, 0), L = charge(s, 1);
      assert_close(e.begin, 0.625, 0);
      assert_close(e.now, energy_at(t), cases[i].within);
      assert_close(e.work, energy_at(t) - 0.625, cases[i].within);
      assert_close(e.drift, 0, cases[i].within);
      assert_close(L.work, 0.5 * (exp(-0.2 * t) - 1), cases[i].within);
      assert_close(L.drift, 0, cases[i].within);
      assert_true(e.flags == LAG_BALANCED && L.flags == LAG_BALANCED);
    }
    lag_sim_free(s);
  }
}

static void without_being_asked_nothing_is_integrated(void **state)
{
  lag_sim *s = sim(&damped, &lag_dop853, 1e-11, 0, 0);
  (void)state;
  assert_int_equal(lag_sim_advance(s, 5), LAG_OK);
  lag_charge_stats L = charge(s, 1);
  assert_int_equal(L.flags, 0);
  assert_close(L.work, 0, 0);
  assert_close(L.drift, 1 - exp(-1), 1e-9); /* |L| is also the sum of the sizes of its terms at the start */
  assert_int_equal(lag_sim_balance(s), LAG_EINVAL); /* too late */
  lag_sim_free(s);
}

/* What a balance leaves open is the error of the method: with half the step, 2^order times less. */
static void balances_are_of_the_order_of_the_method(void **state)
{
  double left[2];
  (void)state;
  for (int i = 0; i < 2; i++) {
    lag_sim *s = sim(&damped, &lag_rk4, 0, i ? 0.1 : 0.2, 1);
    assert_int_equal(lag_sim_advance(s, 10), LAG_OK);
    left[i] = charge(s, 1).drift;
    lag_sim_free(s);
  }
  assert_close(log2(left[0] / left[1]), 4, 0.4);
}

static void a_formula_that_is_replaced_ends_the_balance(void **state)
{
  lag_sim *s = sim(&damped, &lag_dop853, 1e-11, 0, 1);
  (void)state;
  assert_int_equal(lag_sim_set(s, "push", 0.5), LAG_OK);
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  assert_int_equal(charge(s, 2).flags, 0);
  assert_close(charge(s, 2).work, 0, 0);
  assert_close(charge(s, 2).drift, 1 - exp(-0.2), 1e-9); /* of the charge alone */
  assert_int_equal(charge(s, 1).flags, LAG_BALANCED);
  lag_sim_free(s);
}

/* The monitor of a charge watches its balance; a power that is wrong by a part in 10^4 is found. */
static void monitors_watch_balances(void **state)
{
  (void)state;
  for (int wrong = 0; wrong < 2; wrong++) {
    lag_sim *s = sim(&watched, &lag_dop853, 1e-11, 0, 0);
    assert_int_equal(lag_sim_set(s, "wrong", wrong * 1e-4), LAG_OK);
    assert_int_equal(lag_sim_advance(s, 10), wrong ? LAG_EMONITOR : LAG_OK);
    assert_true(wrong == (lag_sim_monitor_drift(s, 0) > 1e-8));
    lag_sim_free(s);
  }
}

/* The state that the caller gets lies within a step: what it has drifted counts, against a size that counts it, too.
 * Here the charge is q, which grows as sin t from 0: in rk4's only step, of 1, it ends at sin 1/2 to the method's
 * error, which is its whole scale as well. */
static int swing_value(ARGS, double *out, UNUSED double *w)
{
  out[0] = q[0];
  out[1] = fabs(q[0]);
  return 0;
}

static void swing_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = q[1] = v[1] = 0;
  v[0] = 1;
}

static void the_end_within_a_step_is_watched(void **state)
{
  static const lag_charge of[] = {{"energy", "", LAG_CONSERVED}, {"q", "", LAG_CONSERVED}};
  static const lag_charges charges = {.n = 2, .of = of, .values = swing_value};
  static const lag_monitor monitors[] = {{"q", -2, 0.9, 0}};
  lag_model model = damped_model;
  lag_scene scene = watched;
  (void)state;
  model.charges = &charges;
  scene.model = &model;
  scene.start = swing_start;
  scene.monitors = monitors;
  lag_sim *s = sim(&scene, &lag_rk4, 0, 1, 0);
  assert_int_equal(lag_sim_set(s, "c", 1e-9), LAG_OK);
  assert_int_equal(lag_sim_advance(s, 0.5), LAG_OK);
  assert_close(charge(s, 1).now, sin(0.5), 1e-2);
  assert_close(charge(s, 1).drift, 1, 0);
  assert_close(lag_sim_monitor_drift(s, 0), 1, 0);
  assert_int_equal(lag_sim_judge(s), LAG_EMONITOR);
  lag_sim_free(s);
}

static void saved_balances_go_on(void **state)
{
  lag_sim *whole = sim(&damped, &lag_dop853, 1e-9, 0, 1), *first = sim(&damped, &lag_dop853, 1e-9, 0, 1),
          *second = sim(&damped, &lag_dop853, 1e-9, 0, 0);
  double *x = calloc(lag_sim_save_size(first), sizeof *x);
  (void)state;
  assert_non_null(x);
  assert_int_equal(lag_sim_advance(whole, 9), LAG_OK);
  assert_int_equal(lag_sim_advance(first, 4.321), LAG_OK);
  assert_int_equal(lag_sim_save(first, x), LAG_OK);
  assert_int_equal(lag_sim_load(second, x), LAG_OK);
  assert_int_equal(lag_sim_advance(second, 9), LAG_OK);
  for (int k = 0; k < 3; k++) {
    lag_charge_stats a = charge(whole, k), b = charge(second, k);
    assert_true(a.work == b.work && a.drift == b.drift && a.slope == b.slope && a.flags == b.flags &&
                a.trend == b.trend);
  }
  free(x);
  lag_sim_free(whole);
  lag_sim_free(first);
  lag_sim_free(second);
}

/* ---- trends, on Kepler's problem: its energy under methods of which theory says what they do */

static lag_charge_stats kepler_energy_after(const lag_method *m, double step, double t)
{
  lag_sim *s = sim(&kepler, m, step, step, 0); /* of adaptive ones `step` is the tolerance */
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  lag_charge_stats c = charge(s, 0);
  lag_sim_free(s);
  assert_int_equal(c.flags & LAG_CONSERVED, LAG_CONSERVED);
  return c;
}

static void symplectic_methods_oscillate(void **state)
{
  static const struct {
    const lag_method *method;
    double step;
    int order;
  } cases[] = {{&lag_verlet, 0.01, 2}, {&lag_verlet4, 0.02, 4}};
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    lag_charge_stats a = kepler_energy_after(cases[i].method, cases[i].step, 200),
                     b = kepler_energy_after(cases[i].method, cases[i].step / 2, 200);
    assert_int_equal(a.trend, LAG_TREND_OSCILLATES);
    assert_int_equal(b.trend, LAG_TREND_OSCILLATES);
    /* h^p, and terms of higher order at an eccentricity of 0.6 */
    assert_close(log2(a.drift / b.drift), cases[i].order, 0.35);
  }
}

static void others_grow(void **state)
{
  lag_charge_stats a = kepler_energy_after(&lag_rk4, 0.01, 300), b = kepler_energy_after(&lag_dop853, 1e-8, 300);
  (void)state;
  assert_int_equal(a.trend, LAG_TREND_GROWS);
  assert_close(fabs(a.slope) * 300 / a.drift, 1, 0.1); /* the line explains the drift */
  assert_true(a.slope_error < fabs(a.slope) / 20);
  assert_int_equal(b.trend, LAG_TREND_GROWS);
}

static void short_runs_are_not_judged(void **state)
{
  lag_charge_stats c = kepler_energy_after(&lag_verlet, 0.01, 0.12);
  (void)state;
  assert_int_equal(c.trend, LAG_TREND_UNKNOWN);
  assert_true(isnan(c.slope));
}

static const lag_charge orbit_of[] = {{"energy", "", LAG_CONSERVED | LAG_BALANCED},
                                      {"spin", "", LAG_CONSERVED | LAG_BALANCED}};
static const lag_charges orbit_charges = {.n = 2, .of = orbit_of, .values = spin_value};

/* Verlet's discrete Lagrangian is as round as L: what it conserves of the angular momentum differs from L by
 * nothing, so only rounding is left, which walks with the root of the number of steps. The energy oscillates. */
static void rounding_is_told_from_drift(void **state)
{
  lag_model model = kepler_model;
  lag_scene orbit = kepler;
  model.charges = &orbit_charges;
  orbit.model = &model;
  (void)state;
  lag_sim *s = sim(&orbit, &lag_verlet, 0, 0.01, 1);
  assert_int_equal(lag_sim_advance(s, 500), LAG_OK);
  lag_charge_stats L = charge(s, 1), E = charge(s, 0);
  assert_int_equal(L.trend, LAG_TREND_ROUNDING);
  assert_true(L.drift < 16 * 2.3e-16 * sqrt(50000));
  assert_true(L.flags & LAG_CONSERVED);
  assert_close(L.begin, 0.8, 1e-15);
  assert_int_equal(E.trend, LAG_TREND_OSCILLATES);
  lag_sim_free(s);
}

int main(void)
{
  static const struct CMUnitTest tests[] = {
      cmocka_unit_test(quadratures_have_their_order),
      cmocka_unit_test(balances_close),
      cmocka_unit_test(without_being_asked_nothing_is_integrated),
      cmocka_unit_test(balances_are_of_the_order_of_the_method),
      cmocka_unit_test(a_formula_that_is_replaced_ends_the_balance),
      cmocka_unit_test(monitors_watch_balances),
      cmocka_unit_test(the_end_within_a_step_is_watched),
      cmocka_unit_test(saved_balances_go_on),
      cmocka_unit_test(symplectic_methods_oscillate),
      cmocka_unit_test(others_grow),
      cmocka_unit_test(short_runs_are_not_judged),
      cmocka_unit_test(rounding_is_told_from_drift),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
