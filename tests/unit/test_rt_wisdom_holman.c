/* wisdom_holman: Kepler's motion for one step of any length, orders in the step and in the masses, rows between steps,
 * energies over long times, what it refuses. Expected values: Kepler's equation in long double, Barker's equation;
 * dop853 at a tolerance of 1e-14 for planets that attract each other. */
#include "test_rt_systems.h"

#include "kernels/composition.h"
#include "methods/kepler_lanes.h"
#include "numeric/processor.h"

/* ---- Kepler's motion */

/* A drift of m bodies; the last of the first four is the one asked for, others are at rest without mu, or on a radial
 * hyperbola. All widths of vectors have the same bits. */
static double drift_error_in(int m, double h, const double *x0, const double *v0, const long double *right)
{
  const int lanes = lag_processor_lanes();
  KeplerMove *const moves[] = {lag_kepler_move_1, lag_kepler_move_2, lanes >= 4 ? lag_kepler_move_4 : NULL,
                               lanes >= 8 && m == KEPLER_BLOCK ? lag_kepler_move_8 : NULL};
  double mu[2 * KEPLER_BLOCK] = {0}, y[2][KEPLER_ARRAYS * 3 * KEPLER_BLOCK], worst = 0;
  const int at = m - 4, n = 3 * m;
  mu[at] = mu[2] = mu[m + at] = mu[m + 2] = 1;
  for (int k = 0; k < 4; k++) {
    double *const x = y[k > 0];
    if (!moves[k]) continue;
    memset(x, 0, sizeof *y);
    x[2] = 1, x[KEPLER_V * n + 2] = 3;
    for (int c = 0; c < 2; c++) {
      x[c * m + at] = x0[c], x[KEPLER_V * n + c * m + at] = v0[c];
      for (int b = 0; b < m; b++) x[KEPLER_ACCEL * n + c * m + b] = 1 + b;
    }
    lag_kepler_distances(m, mu, x);
    moves[k](m, mu, 0, h, x);
    for (int c = 0; c < 2 && k == 0; c++) {
      worst = fmax(worst, fmax(fabs(x[m * c + at] - (double)right[c]),
                               fabs(x[KEPLER_V * n + m * c + at] - (double)right[2 + c])));
    }
    moves[k](m, mu, 0.1, 0, x);
    assert_memory_equal(y[0], x, KEPLER_ARRAYS * (size_t)n * sizeof *x);
  }
  return worst;
}

static double drift_error(double h, const double *x0, const double *v0, const long double *right)
{
  return fmax(drift_error_in(KEPLER_FEW, h, x0, v0, right), drift_error_in(KEPLER_BLOCK, h, x0, v0, right));
}

/* The root of an increasing function M(E) = m of Kepler's equation, sign 1: E - e sin E, -1: e sinh E - E. */
static long double kepler_root(int sign, long double e, long double m)
{
  long double low = -fabsl(m) - 10, high = fabsl(m) + 10;
  for (int k = 0; k < 200; k++) {
    long double E = (low + high) / 2, M = sign > 0 ? E - e * sinl(E) : e * sinhl(E) - E;
    if (M > m) high = E;
    else low = E;
  }
  return low;
}

/* Position and velocity on the conic of eccentricity e with a = 1 at time m from the pericentre. */
static void conic(long double e, long double m, long double *y)
{
  if (e < 1) {
    long double E = kepler_root(1, e, m), b = sqrtl(1 - e * e), r = 1 - e * cosl(E);
    y[0] = cosl(E) - e, y[1] = b * sinl(E), y[2] = -sinl(E) / r, y[3] = b * cosl(E) / r;
  } else {
    long double E = kepler_root(-1, e, m), b = sqrtl(e * e - 1), r = e * coshl(E) - 1;
    y[0] = e - coshl(E), y[1] = b * sinhl(E), y[2] = -sinhl(E) / r, y[3] = b * coshl(E) / r;
  }
}

/* Rounding of the start, 1e-16/|1 - e| of 1/a near the pericentre, grows with the time, and near the pericentre by the
 * speed there: forty units of 1e-16 (1 + |h|)/(1 - e)^2. */
static void one_step_follows_ellipses_and_hyperbolas(void **state)
{
  static const long double shapes[] = {0, 0.0167, 0.2, 0.6, 0.9, 0.99, 1.01, 1.3, 2, 10};
  (void)state;
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
    for (double h = 1e-3; h < 60; h *= 1.31)
      for (int sign = -1; sign <= 1; sign += 2) {
        const long double e = shapes[k];
        long double y0[4], y1[4], gap = fabsl(1 - e);
        conic(e, 0.3L, y0);
        const double x0[] = {(double)y0[0], (double)y0[1]}, v0[] = {(double)y0[2], (double)y0[3]};
        conic(e, 0.3L + sign * (long double)h, y1);
        const double unit = (1 + h) * (1 + fabs(x0[0])) / (double)fminl(1, gap * gap);
        assert_true(drift_error(sign * h, x0, v0, y1) < 4e-15 * unit);
      }
}

/* Barker's equation, pericentre distance 1, mu = 1: h = sqrt(2) (D + D^3/3), D = tan of half the true anomaly. The
 * start is a parabola to rounding, 4e-16 of 1/a, which counts r^2/2 times: at most 5e-13. */
static void one_step_follows_a_parabola(void **state)
{
  (void)state;
  const double x0[] = {1, 0}, v0[] = {0, sqrt(2.0)};
  for (long double D = 0.001L; D < 9; D *= 1.7L) {
    const long double r = 1 + D * D, speed = sqrtl(2) / r;
    const long double right[] = {1 - D * D, 2 * D, -D * speed, speed};
    assert_true(drift_error((double)(sqrtl(2) * (D + D * D * D / 3)), x0, v0, right) < 5e-13);
  }
}

/* ---- one body about a fixed centre */

static lag_model centred;
static lag_scene one;

static int pushed_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  kepler_accel(NULL, t, q, v, z, p, u, a, zd, w);
  a[0] += 1e-3 * cos(3 * t);
  return 0;
}

static void use(int (*accel)(ARGS, double *, double *, double *))
{
  centred = *kepler.model;
  one = kepler;
  one.model = &centred;
  if (accel) centred.accel = accel, centred.flags &= ~(unsigned)(LAG_CONSERVES_ENERGY | LAG_AUTONOMOUS);
}

/* The step is of no account: what is left is rounding. 4e-16 of the energy near the pericentre, where v^2 is 4, turns
 * the body by 1.5*200 times as much, there at twice the mean speed; 30 steps by the root of 30 times that: 5e-12, and
 * three deviations of it. */
static void a_lone_planet_is_exact(void **state)
{
  static const double steps[] = {0.5, 1, 3.7, 20, 200};
  (void)state;
  use(NULL);
  for (int k = 0; k < 5; k++) {
    lag_sim *s = equal_steps(&one, &lag_wisdom_holman, steps[k]);
    double y[4];
    for (double t = 13.37; t <= 201; t += 46.7) {
      assert_int_equal(lag_sim_advance(s, t), LAG_OK);
      kepler_exact(t, y);
      assert_true(distance(4, lag_sim_q(s), y) < 1.5e-11);
    }
    lag_sim_free(s);
  }
}

/* ---- a star and two planets; coordinates: x of all, y of all, z of all; the star is the second. p: mass of the
 * planets */

static const double share[] = {1, 0, 0.3};
static double mass_of(int body, const double *p) { return body == 1 ? 1 : p[0] * share[body]; }

static int planets_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  memset(a, 0, 9 * sizeof *a);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double d[3], r2 = 0;
      for (int c = 0; c < 3; c++) d[c] = q[3 * c + j] - q[3 * c + i], r2 += d[c] * d[c];
      for (int c = 0; c < 3 && i != j; c++) a[3 * c + i] += mass_of(j, p) * d[c] / (r2 * sqrt(r2));
    }
  return 0;
}

static int planets_energy(ARGS, double *e, UNUSED double *w)
{
  double T = 0, V = 0;
  for (int i = 0; i < 3; i++)
    for (int c = 0; c < 3; c++) T += mass_of(i, p) * v[3 * c + i] * v[3 * c + i] / 2;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < i; j++) {
      double r2 = 0;
      for (int c = 0; c < 3; c++) r2 += (q[3 * c + j] - q[3 * c + i]) * (q[3 * c + j] - q[3 * c + i]);
      V -= mass_of(i, p) * mass_of(j, p) / sqrt(r2);
    }
  e[0] = T + V;
  e[1] = 2 * T + fabs(T - V);
  return 0;
}

static void planets_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z)
{
  memset(q, 0, 9 * sizeof *q);
  memset(v, 0, 9 * sizeof *v);
  q[2] = 1, v[5] = 1.03, v[8] = 0.05; /* the light planet goes inside, at distance 1, the heavy one at 1.9 */
  q[3] = 1.9, v[0] = -0.75, v[6] = -0.02;
}

static const int interleaved[] = {0, 3, 6, 1, 4, 7, 2, 5, 8};
static int planets_values(ARGS, double *out, UNUSED double *w)
{
  for (int i = 0; i < 3; i++) {
    out[i] = mass_of(i, p);
    out[3 + i] = 0;
    for (int j = 0; j < 3; j++)
      if (j != i) out[3 + i] += mass_of(i, p) * mass_of(j, p) * q[j];
  }
  return 0;
}
static const lag_kepler triple = {3, 3, 0, interleaved, planets_values};
static const lag_var planet_q[9] = {{.name = "x1", .factor = 1, .unit = ""}, {.name = "x2", .factor = 1, .unit = ""},
                                    {.name = "x3", .factor = 1, .unit = ""}, {.name = "y1", .factor = 1, .unit = ""},
                                    {.name = "y2", .factor = 1, .unit = ""}, {.name = "y3", .factor = 1, .unit = ""},
                                    {.name = "z1", .factor = 1, .unit = ""}, {.name = "z2", .factor = 1, .unit = ""},
                                    {.name = "z3", .factor = 1, .unit = ""}},
                     planet_p[1] = {{.name = "m", .factor = 1, .unit = ""}};
static void planets_params(SELF, double *p, const unsigned char *fixed)
{
  if (!fixed[0]) p[0] = 1e-3;
}
static const lag_model planets_model = {MODEL("planets"), .flags = SEPARABLE, .nq = 9, .q = planet_q, .np = 1,
                                        .p = planet_p, .accel = planets_accel, .energy = planets_energy,
                                        .kepler = &triple};
static const lag_scene planets = {.name = "planets", .doc = "", .model = &planets_model, .params = planets_params,
                                  .start = planets_start, .t1 = 10, .has_span = 1};

/* Coordinates at t of planets of mass m; step 0: by dop853. */
static void planets_at(double m, const char *scheme, double h, double t, double *y)
{
  lag_option opt[] = {{"step", h, NULL}, {"scheme", 0, scheme}};
  lag_sim *s = h > 0 ? sim_with(&planets, &lag_wisdom_holman, 0, 2, opt)
                     : sim_with(&planets, &lag_dop853, 1e-14, 0, NULL);
  assert_int_equal(lag_sim_set(s, "m", m), LAG_OK);
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  memcpy(y, lag_sim_q(s), 18 * sizeof *y);
  lag_sim_free(s);
}

static double planets_error(double m, const char *scheme, double h, double t)
{
  double y[18], right[18];
  planets_at(m, NULL, 0, t, right);
  planets_at(m, scheme, h, t, y);
  return distance(18, y, right);
}

static const struct { const char *scheme; const lag_composition *table; int order; } schemes[] = {
    {"wh", &lag_compose_verlet, 2}, {"sbab2", &lag_compose_sbab2, 4}, {"sbab3", &lag_compose_sbab3, 6},
    {"sbab4", &lag_compose_sbab4, 8}, {"aba864", &lag_compose_aba864, 8}};
enum { SCHEMES = sizeof schemes / sizeof *schemes };

/* To first order in the perturbation a step integrates it along the Kepler motion, by a quadrature with the kicks at
 * their times: of this order and no more, and symmetric. */
static void kicks_are_quadratures_of_their_order(void **state)
{
  (void)state;
  for (int k = 0; k < SCHEMES; k++) {
    const lag_composition *c = schemes[k].table;
    for (int power = 0; power <= schemes[k].order; power++) {
      double sum = 0, at = 0;
      for (int i = 0; i <= c->stages; i++) {
        sum += c->kick[i] * pow(at, power);
        at += i < c->stages ? c->drift[i] : 0;
        assert_close(c->kick[i], c->kick[c->stages - i], 1e-16);
        if (i < c->stages) assert_close(c->drift[i], c->drift[c->stages - 1 - i], 1e-16);
      }
      assert_close(at, 1, 1e-15);
      assert_int_equal(fabs(sum - 1.0 / (power + 1)) < 1e-15, power < schemes[k].order);
    }
  }
}

/* Errors of wh are of first order in the masses and second in the step. Those of sbab4 are, at small steps, of second
 * order in the masses, and of the second in the step; of aba864, which has more, of the fourth or better. */
static void errors_go_with_masses_and_steps(void **state)
{
  (void)state;
  const double wh = planets_error(1e-4, "wh", 0.1, 30), sbab4 = planets_error(1e-3, "sbab4", 0.2, 30),
               aba864 = planets_error(1e-2, "aba864", 0.3, 30);
  assert_close(wh / planets_error(1e-5, "wh", 0.1, 30), 10, 0.2);
  assert_close(wh / planets_error(1e-4, "wh", 0.05, 30), 4, 0.05);
  assert_close(sbab4 / planets_error(1e-4, "sbab4", 0.2, 30), 100, 10);
  assert_close(sbab4 / planets_error(1e-3, "sbab4", 0.1, 30), 4, 0.05);
  assert_true(aba864 / planets_error(1e-2, "aba864", 0.15, 30) > 14);
  assert_true(aba864 < sbab4 / 10); /* of masses ten times smaller */
}

/* Between steps motions are a step shorter: the largest error at 0.37 of each step is no larger than at their ends. */
static void rows_between_steps_are_as_good(void **state)
{
  lag_option opt[] = {{"step", 0.4, NULL}, {"scheme", 0, "sbab3"}};
  (void)state;
  double worst[2] = {0}, right[18];
  for (int turn = 0; turn < 2; turn++) {
    lag_sim *s = sim_with(&planets, &lag_wisdom_holman, 0, 2, opt);
    lag_sim *of = sim_with(&planets, &lag_dop853, 1e-14, 0, NULL);
    for (double t = turn ? 0.4 : 0.4 * 0.37; t < 30; t += 0.4) {
      assert_int_equal(lag_sim_advance(s, t), LAG_OK);
      assert_int_equal(lag_sim_advance(of, t), LAG_OK);
      memcpy(right, lag_sim_q(of), sizeof right);
      worst[turn] = fmax(worst[turn], distance(18, lag_sim_q(s), right));
    }
    lag_sim_free(s);
    lag_sim_free(of);
  }
  assert_true(worst[0] < 1.1 * worst[1]);
}

/* A force of explicit time acts at its time: the order of the steps. */
static void forces_may_depend_on_time(void **state)
{
  double e[2], right[4];
  (void)state;
  use(pushed_accel);
  lag_sim *of = sim_with(&one, &lag_dop853, 1e-14, 0, NULL);
  assert_int_equal(lag_sim_advance(of, 12), LAG_OK);
  memcpy(right, lag_sim_q(of), sizeof right);
  lag_sim_free(of);
  for (int k = 0; k < 2; k++) {
    lag_option opt[] = {{"step", 0.02 / (k + 1), NULL}, {"scheme", 0, "wh"}};
    lag_sim *s = sim_with(&one, &lag_wisdom_holman, 0, 2, opt);
    assert_int_equal(lag_sim_advance(s, 12), LAG_OK);
    e[k] = distance(4, lag_sim_q(s), right);
    lag_sim_free(s);
  }
  assert_close(log2(e[0] / e[1]), 2, 0.05);
}

/* 10^4 periods of the inner planet; a trend that 10^5 periods would show lies within the error of the slope. */
static void energy_has_no_trend(void **state)
{
  lag_option opt[] = {{"step", 0.35, NULL}, {"scheme", 0, "wh"}};
  lag_sim *s = sim_with(&planets, &lag_wisdom_holman, 0, 2, opt);
  lag_charge_stats c;
  (void)state;
  assert_int_equal(lag_sim_advance(s, 62832), LAG_OK);
  lag_sim_charge(s, 0, &c);
  assert_int_equal(c.trend, LAG_TREND_OSCILLATES);
  assert_true(fabs(c.slope) < 3 * c.slope_error && c.drift < 3e-6); /* masses 1e-3 times (step/2 pi)^2 = 3e-3 */
  lag_sim_free(s);
}

/* ---- what it refuses */

static void refused(const lag_scene *scene, double m, const char *words)
{
  lag_sim *s = lag_sim_new(scene);
  int rc = lag_sim_set_method(s, &lag_wisdom_holman, NULL, 0);
  if (rc == LAG_OK && m > 0) assert_int_equal(lag_sim_set(s, "m", m), LAG_OK);
  if (rc == LAG_OK) rc = lag_sim_advance(s, 1);
  assert_true(rc < 0);
  assert_non_null(strstr(lag_sim_message(s), words));
  lag_sim_free(s);
}

static int repelling_values(ARGS, double *out, UNUSED double *w)
{
  out[0] = 1;
  out[1] = -1;
  return 0;
}

static void bodies_that_do_not_suit_are_refused(void **state)
{
  (void)state;
  refused(&pendulum, 0, "terms -k/r");
  refused(&planets, 0.2, "the mass of x1 is 0.2 of the largest");
  use(NULL);
  lag_kepler repelling = about_centre;
  repelling.values = repelling_values;
  centred.kepler = &repelling;
  refused(&one, 0, "none attracts x to the origin");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_step_follows_ellipses_and_hyperbolas),
      cmocka_unit_test(one_step_follows_a_parabola),
      cmocka_unit_test(a_lone_planet_is_exact),
      cmocka_unit_test(kicks_are_quadratures_of_their_order),
      cmocka_unit_test(errors_go_with_masses_and_steps),
      cmocka_unit_test(rows_between_steps_are_as_good),
      cmocka_unit_test(forces_may_depend_on_time),
      cmocka_unit_test(energy_has_no_trend),
      cmocka_unit_test(bodies_that_do_not_suit_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
