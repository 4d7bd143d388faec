/* variational, gauss and the implicit form of the Verlet family: exact digits of the algorithm, solutions, which
 * forms are the same map and which are not, forces, what Newton's method costs and how it fails, what symmetries
 * conserve. Expected values: closed forms, trajectories of the algorithm itself in 40- and 60-digit arithmetic by an
 * independent script, and dop853. Orders are measured in quadruple precision: tests/exec/long_quad.sh. LAG_STEPS:
 * steps of the long runs. */
#include "slow.h"
#include "test_rt_systems.h"

#include "kernels/band_matrix.h"
#include "kernels/galerkin_rule.h"

/* ---- Digits */

typedef struct Digits {
  double start[2], h, steps, end[2], energy;
} Digits;

/* Of the midpoint rule on the pendulum, p = v: both precisions agree to 40 digits; energy: the largest |E - E0|, to
 * 6 digits. Tolerance as stated with the digits: 1e-11. */
static const Digits midpoint[] = {
    {{1.5, 0}, 0.1, 1000, {-0.5554837009712650754947232, 1.248327344720310737258077}, 0.000359406393757},
    {{0.5, 1.9}, 0.2, 500, {2.699866315986761219670719, -0.1897434875691169385021294}, 0.00540163363051},
};

typedef struct Watch {
  double first, worst;
} Watch;

static int watch(void *context, const lag_sim *s)
{
  Watch *w = context;
  double e[2];
  lag_sim_scene(s)->model->energy(lag_sim_scene(s)->model, 0, lag_sim_q(s), lag_sim_v(s), NULL, NULL, NULL, e, NULL);
  w->worst = fmax(w->worst, fabs(e[0] - w->first));
  return 0;
}

static void the_midpoint_rule_reproduces_its_digits(void **state)
{
  (void)state;
  for (size_t k = 0; k < sizeof midpoint / sizeof *midpoint; k++) {
    const Digits *d = &midpoint[k];
    double e[2];
    lag_sim *s = equal_steps(&pendulum, &lag_variational, d->h);
    assert_int_equal(lag_sim_set(s, "x", d->start[0]), 0);
    assert_int_equal(lag_sim_set(s, "x'", d->start[1]), 0);
    pendulum_energy(NULL, 0, d->start, d->start + 1, NULL, NULL, NULL, e, NULL);
    Watch w = {e[0], 0};
    lag_sim_on_step(s, watch, &w);
    assert_int_equal(lag_sim_advance(s, (d->steps - 0.5) * d->h), LAG_OK);
    assert_int_equal(lag_sim_advance(s, d->steps * d->h), LAG_OK);
    assert_close(distance(2, lag_sim_q(s), d->end), 0, 1e-11);
    assert_close(w.worst / d->energy, 1, 1e-6);
    lag_sim_free(s);
  }
}

/* Nodes and weights of Gauss and Lobatto on [0, 1]: closed forms (Abramowitz, Stegun, tables 25.4 and 25.6). */
static void rules_have_their_nodes_and_weights(void **state)
{
  const double ulps = 2.3e-16; /* two of 0.5 */
  lag_rule r;
  (void)state;
  lag_rule_gauss(&r, 2);
  assert_close(r.c[0], 0.5 - sqrt(3) / 6, ulps);
  assert_close(r.b[1], 0.5, ulps);
  lag_rule_gauss(&r, 3);
  assert_close(r.c[2], 0.5 + sqrt(15) / 10, ulps);
  assert_close(r.c[1], 0.5, 0);
  assert_close(r.b[0], 5.0 / 18, ulps);
  assert_close(r.b[1], 4.0 / 9, ulps);
  assert_close(r.integral[0][1], 2.0 / 9 - sqrt(15) / 15, ulps); /* Kuntzmann and Butcher, HNW I table II.7.4 */
  lag_rule_gauss(&r, 4);
  assert_close(r.c[0], 0.0694318442029737, ulps);
  assert_close(r.b[1], 0.3260725774312731, ulps);
}

/* A band is solved as the full matrix is, with rows exchanged: residuals, and an exact inverse. */
static void bands_are_solved(void **state)
{
  enum { N = 8 };
  double a[N * N], pivot[N], scale[N], b[N], right[N], full[N][N];
  (void)state;
  for (int band = 1; band < N; band += band < 3 ? 1 : 4) {
    lag_band_matrix m = {N, band, a, pivot};
    uint64_t seed = 1;
    memset(a, 0, sizeof a);
    for (int i = 0; i < N; i++) {
      for (int j = 0; j < N; j++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        /* pivots elsewhere */
        full[i][j] = abs(i - j) > band ? 0 : i == j ? 1e-8 : (double)(seed >> 11) / 9007199254740992.0 - 0.5;
        full[i][j] *= i == 2 ? 1e12 : 1; /* a row in other units */
        if (abs(i - j) <= band) {
          *lag_band_matrix_at(&m, i, j) = full[i][j];
        }
      }
    }
    for (int i = 0; i < N; i++) {
      right[i] = 0;
      for (int j = 0; j < N; j++) {
        right[i] += full[i][j] * (j + 1);
      }
    }
    assert_int_equal(lag_band_matrix_factor(&m, scale), 0);
    memcpy(b, right, sizeof b);
    lag_band_matrix_solve(&m, b);
    for (int i = 0; i < N; i++) {
      assert_close(b[i], i + 1, 1e-12);
    }
  }
  lag_band_matrix singular = {2, 1, a, pivot};
  memcpy(a, (double[]){1, 2, 2, 4}, 4 * sizeof *a);
  assert_int_equal(lag_band_matrix_factor(&singular, scale), -1);
}

/* ---- Solutions */

/* within: of the solution, at steps of 0.01 to t = 4. */
static const Setting settings[] = {
    {&lag_symplectic_euler, {{0}}, 0, 0.1},
    {&lag_verlet, {{0}}, 0, 3e-2},
    {&lag_verlet4, {{0}}, 0, 1e-6},
    {&lag_verlet6, {{0}}, 0, 3e-9},
    {&lag_verlet8, {{0}}, 0, 2e-11},
    {&lag_variational, {{0}}, 0, 3e-2},
    {&lag_variational, {{"order", 4, NULL}}, 1, 2e-5},
    {&lag_variational, {{"order", 6, NULL}}, 1, 1e-8},
    {&lag_variational, {{"order", 8, NULL}}, 1, 1e-11},
    {&lag_gauss, {{0}}, 0, 2e-5},
    {&lag_gauss, {{"stages", 4, NULL}}, 1, 1e-11},
};
enum { SETTINGS = sizeof settings / sizeof *settings };

static double end_of(const lag_scene *scene, const Setting *k, double h, double t, double *y)
{
  lag_sim *s = sim_at(scene, k, h);
  lag_stats st;
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  memcpy(y, lag_sim_q(s), (size_t)(2 * scene->model->nq) * sizeof *y);
  lag_sim_stats(s, &st);
  lag_sim_free(s);
  return st.systems ? (double)st.iterations / (double)st.systems : 0;
}

static void best(const lag_scene *scene, double t, double *y)
{
  lag_sim *s = sim_with(scene, &lag_dop853, 1e-15, 1, (lag_option[]){{"atol", 1e-16, NULL}});
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  memcpy(y, lag_sim_q(s), (size_t)(2 * scene->model->nq) * sizeof *y);
  lag_sim_free(s);
}

static void solutions_of_the_double_pendulum_are_reached(void **state)
{
  double right[4], y[4];
  (void)state;
  best(&double_pendulum, 4, right);
  for (int k = 0; k < SETTINGS; k++) {
    double mean = end_of(&double_pendulum, &settings[k], 0.01, 4, y), off = distance(4, y, right);
    print_message("# %-16s off by %.1e, %.2f corrections a system\n", settings[k].method->name, off, mean);
    assert_true(off < settings[k].within && off > settings[k].within / 100);
    assert_true(mean >= 1 && mean < 2.5); /* with extrapolated start values a correction or two are enough */
  }
}

/* ---- Which are the same map */

static lag_scene without_flag(const lag_scene *scene, lag_model *model)
{
  lag_scene same = *scene;
  *model = *scene->model;
  model->flags &= ~(unsigned)LAG_SEPARABLE;
  same.model = model;
  return same;
}

/* With constant mass the generalised Stoermer-Verlet method is the explicit method. Tolerance: rounding over 400
 * steps. */
static void implicit_verlet_is_explicit_verlet_where_mass_is_constant(void **state)
{
  static const Setting verlet = {&lag_verlet, {{0}}, 0, 0};
  const lag_scene *const separable[] = {&pendulum, &kepler, &henon};
  double a[4], b[4];
  (void)state;
  for (int i = 0; i < 3; i++) {
    lag_model model;
    lag_scene general = without_flag(separable[i], &model);
    end_of(separable[i], &verlet, 0.01, 4, a);
    end_of(&general, &verlet, 0.01, 4, b);
    assert_close(distance(2 * model.nq, a, b), 0, 2e-13);
  }
}

/* Both forms of the compositions are different maps of the same order: on a separable model they meet the same
 * solution. */
static void both_forms_of_the_family_agree(void **state)
{
  double right[4], a[4], b[4];
  (void)state;
  kepler_exact(4, right);
  for (int k = 2; k < 5; k++) {
    lag_model model;
    lag_scene general = without_flag(&kepler, &model);
    end_of(&kepler, &settings[k], 0.02, 4, a);
    end_of(&general, &settings[k], 0.02, 4, b);
    assert_close(distance(4, a, right), 0, k == 2 ? 1e-5 : 1e-7);
    assert_close(distance(4, b, right), 0, k == 2 ? 1e-4 : 1e-6);
    assert_true(distance(4, a, b) > 1e-13);
  }
}

static void gauss_is_variational_with_gauss_points(void **state)
{
  double a[4], b[4];
  (void)state;
  for (int u = 1; u <= 4; u++) {
    Setting g = {&lag_gauss, {{"stages", u, NULL}}, 1, 0}, v = {&lag_variational, {{"order", 2 * u, NULL}}, 1, 0};
    end_of(&double_pendulum, &g, 0.01, 4, a);
    end_of(&double_pendulum, &v, 0.01, 4, b);
    assert_memory_equal(a, b, sizeof a);
  }
}

/* ---- Forces: x'' = -x - c x' + cos(w t), in closed form */

static const double damping = 0.2, drive = 2;

static int damped_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -q[0] - damping * v[0] + cos(drive * t);
  return 0;
}

FIRST(damped)
{
  Lq[0] = -q[0];
  Lv[0] = v[0];
  Q[0] = -damping * v[0] + cos(drive * t);
  return 0;
}

SECOND(damped)
{
  h[0] = -1;
  h[1] = 1;
  h[2] = -damping;
  return 0;
}

static const lag_second damped_at[] = {{LAG_QQ, 0, 0}, {LAG_VV, 0, 0}, {LAG_FV, 0, 0}};
#define damped_start osc_start
SYSTEM(damped, 1, LAG_CONSTANT_MASS, NULL, DERIVATIVES(damped));

static double damped_exact(double t)
{
  double k = 1 - drive * drive, g = damping * drive, size = k * k + g * g, a = k / size, b = g / size;
  double rate = damping / 2, w = sqrt(1 - rate * rate), x0 = 1 - a, v0 = -b * drive;
  return exp(-rate * t) * (x0 * cos(w * t) + (v0 + rate * x0) / w * sin(w * t)) + a * cos(drive * t) +
         b * sin(drive * t);
}

static void forces_are_followed(void **state)
{
  double y[2];
  (void)state;
  for (int k = 0; k < SETTINGS; k++) {
    end_of(&damped, &settings[k], 0.02, 10, y);
    double order = settings[k].method->order, off = fabs(y[0] - damped_exact(10));
    assert_true(off < (order < 2 ? 2e-2 : settings[k].within > 1e-3 ? 2e-4 : 1e-7) && off > 1e-16);
  }
}

/* ---- Newton's method: what it says when it fails, and what it leaves */

static int steep_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = 256 * q[0];
  return 0;
}

static double steepness; /* of L = v^2/2 + steepness q^2/2 */

FIRST(steep)
{
  Lq[0] = steepness * q[0];
  Lv[0] = v[0];
  Q[0] = 0;
  return 0;
}

SECOND(steep)
{
  h[0] = steepness;
  h[1] = 1;
  return 0;
}

#define steep_at pendulum_at
#define steep_start osc_start
SYSTEM(steep, 1, LAG_CONSTANT_MASS | LAG_AUTONOMOUS, NULL, DERIVATIVES(steep));

static void check_failure(const lag_scene *scene, double h, int status, const char *words)
{
  lag_sim *s = equal_steps(scene, &lag_variational, h);
  double before[4];
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  memcpy(before, lag_sim_q(s), (size_t)(2 * scene->model->nq) * sizeof *before);
  assert_int_equal(lag_sim_advance(s, 1000 * h), status);
  if (!strstr(lag_sim_message(s), words)) {
    fail_msg("%s: no \"%s\"", lag_sim_message(s), words);
  }
  for (int i = 0; i < 2 * scene->model->nq; i++) {
    assert_true(isfinite(lag_sim_q(s)[i]));
  }
  lag_sim_free(s);
}

static void failures_say_when_and_what_to_do(void **state)
{
  (void)state;
  steepness = 256; /* 1 - h^2/4 steepness = 0 for h = 1/8: the step has no solution */
  check_failure(&steep, 0.125, LAG_EMETHOD,
                "in a step of 0.125 s Newton's method has a singular matrix, the residual is 0.3 of its terms; take "
                "smaller steps");
  /* of u - h/2 256 (1 + h/2 u) at the guess u = 0 + h/2 256 = 16: 16/48 */
  steepness = NAN;
  check_failure(&steep, 0.1, LAG_ENAN, "no finite value");
  check_failure(&steep, 0.1, LAG_ENAN, "steps of 0.1 s may be too long");
  check_failure(&double_pendulum, 1.5, LAG_EMETHOD,
                "in a step of 1.5 s Newton's method did not converge in 25 corrections, the residual is");
  check_failure(&double_pendulum, 1.5, LAG_EMETHOD, "take smaller steps");
  lag_sim *s = lag_sim_new(&pendulum);
  assert_int_equal(lag_sim_set_method(s, &lag_gauss, (lag_option[]){{"step", -0.1, NULL}}, 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_method(s, &lag_gauss, (lag_option[]){{"step", NAN, NULL}}, 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_method(s, &lag_gauss, (lag_option[]){{"stages", 5, NULL}}, 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set_method(s, &lag_variational, (lag_option[]){{"order", 3, NULL}}, 1), LAG_EINVAL);
  lag_sim_free(s);
}

/* At rest where nothing moves it, a coordinate stays, to the last bit; and one that only rounding moves holds
 * nothing up. */
static void what_rests_stays(void **state)
{
  (void)state;
  for (int k = 0; k < SETTINGS; k++) {
    lag_sim *s = sim_at(&double_pendulum, &settings[k], 0.01);
    assert_int_equal(lag_sim_set(s, "x", 0), 0);
    assert_int_equal(lag_sim_set(s, "y", 0), 0);
    assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
    for (int i = 0; i < 4; i++) {
      assert_true(lag_sim_q(s)[i] == 0);
    }
    lag_sim_free(s);
    s = sim_at(&kepler, &settings[k], 0.01);
    assert_int_equal(lag_sim_set(s, "y", 1e-17), 0);
    assert_int_equal(lag_sim_set(s, "y'", 0), 0);
    assert_int_equal(lag_sim_advance(s, 0.1), LAG_OK);
    lag_sim_free(s);
  }
}

/* ---- Discrete Noether: p.xi is conserved where L has the symmetry q -> q + s xi(q), xi affine */

static int long_run(void)
{
  const char *text = getenv("LAG_STEPS");
  return text ? atoi(text) : slow(10000, 3000);
}

typedef struct Charge {
  double (*of)(const double *q, const double *p);
  double first, worst;
} Charge;

static double turning(const double *q, const double *p)
{
  return q[0] * p[1] - q[1] * p[0];
}

static double both(UNUSED const double *q, const double *p)
{
  return p[0] + p[1];
}

static int measure(void *context, const lag_sim *s)
{
  Charge *c = context;
  double p[2];
  momenta(lag_sim_scene(s), lag_sim_q(s), p);
  c->worst = fmax(c->worst, fabs(c->of(lag_sim_q(s), p) - c->first));
  return 0;
}

/* The double pendulum without weight: L depends on q1 - q2 only. */
FIRST(floating)
{
  double_pendulum_variation(self, t, q, v, z, p, u, Lq, Lv, Q, w);
  double s = v[0] * v[1] * sin(q[0] - q[1]);
  Lq[0] = -s;
  Lq[1] = s;
  return 0;
}

SECOND(floating)
{
  double_pendulum_second(self, t, q, v, z, p, u, h, w);
  h[0] = h[2] = -v[0] * v[1] * cos(q[0] - q[1]);
  return 0;
}

static int floating_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  double s = sin(q[0] - q[1]), c = cos(q[0] - q[1]), den = 2 - c * c;
  a[0] = -s * (v[1] * v[1] + v[0] * v[0] * c) / den;
  a[1] = s * (2 * v[0] * v[0] + v[1] * v[1] * c) / den;
  return 0;
}

static void floating_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 1;
  q[1] = -0.5;
  v[0] = 0.7;
  v[1] = -1.1;
}

#define floating_at double_pendulum_at
SYSTEM(floating, 2, LAG_AUTONOMOUS | LAG_CONSERVES_ENERGY, NULL, DERIVATIVES(floating));

static double drift_of(const lag_scene *scene, const Setting *k, double h, double (*of)(const double *, const double *),
                       int steps) {
  double y[4], p[2];
  scene->start(scene, NULL, y, y + 2, NULL);
  momenta(scene, y, p);
  Charge c = {of, of(y, p), 0};
  lag_sim *s = sim_at(scene, k, h);
  lag_sim_on_step(s, measure, &c);
  assert_int_equal(lag_sim_advance(s, steps * h), LAG_OK);
  lag_sim_free(s);
  return c.worst;
}

/* With compensated sums what is lost is the rounding of the residual, h times 1e-16 of its terms a step, and the
 * orbit repeats it: 1e-20 or so a step on the average. Without compensation it is ten times more, and grows. */
static void momenta_are_conserved_to_rounding(void **state)
{
  int steps = long_run();
  double most = 2.5e-15 + 5e-20 * steps;
  (void)state;
  for (int k = 1; k < SETTINGS; k++) {
    double a = drift_of(&kepler, &settings[k], 0.02, turning, steps),
           b = drift_of(&floating, &settings[k], 0.05, both, steps);
    print_message("# %-16s after %d steps: angular momentum %.1e, momentum of both angles %.1e\n",
                  settings[k].method->name, steps, a, b);
    assert_true(a <= most && b <= most);
  }
  static const Setting rk4 = {&lag_rk4, {{0}}, 0, 0};
  assert_true(drift_of(&kepler, &rk4, 0.05, turning, 2000) > 1e-8);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_midpoint_rule_reproduces_its_digits),
      cmocka_unit_test(rules_have_their_nodes_and_weights),
      cmocka_unit_test(bands_are_solved),
      cmocka_unit_test(solutions_of_the_double_pendulum_are_reached),
      cmocka_unit_test(implicit_verlet_is_explicit_verlet_where_mass_is_constant),
      cmocka_unit_test(both_forms_of_the_family_agree),
      cmocka_unit_test(gauss_is_variational_with_gauss_points),
      cmocka_unit_test(forces_are_followed),
      cmocka_unit_test(failures_say_when_and_what_to_do),
      cmocka_unit_test(what_rests_stays),
      cmocka_unit_test(momenta_are_conserved_to_rounding),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
