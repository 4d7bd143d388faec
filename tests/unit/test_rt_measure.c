/* Measures of a run against closed forms, by each method; their units; the messages for wrong expressions; the run
 * itself, which they leave as it is. */
#include "test_rt_systems.h"

#include "analysis/measure.h"

#include "../measure_words.h"

enum { MOST = 16 };

/* Measures of arithmetic as one writes it, in SI. */
static Measures *measures_of(const lag_scene *scene, int n, const char *const *text)
{
  static char words[MOST][300];
  const char *all[MOST];
  char why[300];
  for (int k = 0; k < n; k++) {
    assert_true(measure_words(text[k], NULL, words[k], sizeof words[k]));
    all[k] = words[k];
  }
  Measures *m = lag_measures_new(scene, n, all, NULL, why, sizeof why);
  if (!m) {
    fail_msg("%s", why);
  }
  return m;
}

/* Runs `sim` with n expressions; frees it. Returns the status. */
static int measure(lag_sim *sim, double until, int n, const char *const *text, double *value)
{
  Measures *m = measures_of(lag_sim_scene(sim), n, text);
  int rc = lag_measures_run(m, sim, until, value);
  for (int k = 0; k < n; k++) {
    assert_int_equal(isnan(value[k]), lag_measures_why(m, k)[0] != '\0');
  }
  lag_measures_free(m);
  lag_sim_free(sim);
  return rc;
}

/* Each function at x = cos 3: the C library's value, 1e-9 for the run's error. */
static void functions(void **state)
{
  static const char *const text[] = {"sin(x(3))",  "cos(x(3))",  "tan(x(3))",  "asin(x(3))",
                                     "acos(x(3))", "atan(x(3))", "sinh(x(3))", "cosh(x(3))",
                                     "tanh(x(3))", "cbrt(x(3))", "exp(x(3))",  "floor(x(3))"};
  const double x = cos(3), expected[] = {sin(x),  cos(x),  tan(x),  asin(x), acos(x), atan(x),
                                         sinh(x), cosh(x), tanh(x), cbrt(x), exp(x),  -1};
  static const char *const more[] = {"sqrt(2 + x(3))", "log(2 + x(3))", "abs(x(3))", "atan2(x(3), x(1))",
                                     "hypot(x(3), x(1))"};
  const double values[] = {sqrt(2 + x), log(2 + x), -x, atan2(x, cos(1)), hypot(x, cos(1))};
  lag_option none[] = {{"step", 0.002, NULL}};
  double value[12];
  (void)state;
  assert_int_equal(measure(sim_with(&osc, &lag_dop853, 1e-12, 0, none), 4, 12, text, value), LAG_OK);
  for (int k = 0; k < 12; k++) assert_true(fabs(value[k] - expected[k]) < 1e-9);
  assert_int_equal(measure(sim_with(&osc, &lag_dop853, 1e-12, 0, none), 4, 5, more, value), LAG_OK);
  for (int k = 0; k < 5; k++) assert_true(fabs(value[k] - values[k]) < 1e-9);
}

/* x = cos t, x' = -sin t to t = 20: extremes inside steps, means and the period. */
static void an_oscillator_by_every_method(void **state)
{
  static const char *const text[] = {"max(x')", "min(x)", "mean(x)",         "rms(x)",          "period(x)", "drift(x)",
                                     "x(3)",    "x",      "max(x^2 + x'^2)", "2*x(1) + x(2)^2", "x(end/2)",  "end"};
  const double T = 20, expected[] = {1,      -1,     sin(T) / T, sqrt(0.5 + sin(2 * T) / (4 * T)), 2 * PI,     2,
                                     cos(3), cos(T), 1,          2 * cos(1) + cos(2) * cos(2),     cos(T / 2), T};
  double value[MOST];
  (void)state;
  for (int i = 0; i < lag_nmethods + lag_gsl_nmethods; i++) {
    const lag_method *m = i < lag_nmethods ? lag_methods[i] : lag_gsl_methods[i - lag_nmethods];
    int adaptive = m->flags & LAG_METHOD_ADAPTIVE;
    if (OF_BODIES(m)) continue;
    /* Phase error of a method with equal steps: T h^2/12 of the midpoint rule, T h/2 of Euler's, whose energy
     * explicit steps change by T h; Hermite's interpolation in GSL's steps, a third of a period with gsl-bsimp, but
     * for values at times, to which these methods step. */
    double within = !adaptive ? 1e-10 + T * pow(0.002, m->order) /
                                            (m == &lag_euler ? 0.9
                                             : m->order == 1 ? 2
                                                             : 12)
                              : 1e-7,
           between = m->flags & LAG_METHOD_STEPS_TO ? 0.03 : within;
    lag_option step[] = {{"step", 0.002, NULL}};
    lag_sim *s = sim_with(&osc, m, 1e-10, adaptive ? 0 : 1, step);
    assert_int_equal(measure(s, T, sizeof text / sizeof *text, text, value), LAG_OK);
    for (size_t k = 0; k < sizeof text / sizeof *text; k++) {
      int at_time = strchr(text[k], '(') == NULL || text[k][0] == 'x' || text[k][0] == '2';
      /* the drift at ends of steps, half a step from the bottom */
      double off = (at_time ? within : between) + (text[k][0] == 'd' && !adaptive ? 0.002*0.002/8 : 0);
      if (!(fabs(value[k] - expected[k]) <= off)) {
        fail_msg("%s: %s = %.15g, expected %.15g within %.2g", m->name, text[k], value[k], expected[k], off);
      }
    }
  }
}

/* 2 pi/agm(1, cos(a/2)), the period of a pendulum with g/l = 1 released at the angle a. */
static double pendulum_period(double a)
{
  double x = 1, y = cos(a/2);
  while (fabs(x - y) > 1e-15) {
    double mean = (x + y)/2;
    y = sqrt(x*y);
    x = mean;
  }
  return 2*PI/x;
}

static double amplitude;

static void released(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = amplitude;
  v[0] = 0;
}

static void the_period_of_a_pendulum_over_its_amplitude(void **state)
{
  static const char *const text[] = {"period(x)", "max(x')"};
  lag_scene scene = pendulum;
  double value[2];
  (void)state;
  scene.start = released;
  for (amplitude = 0.3; amplitude < 3; amplitude += 0.6) {
    measure(sim_with(&scene, &lag_dop853, 1e-13, 0, NULL), 100, 2, text, value);
    assert_close(value[0], pendulum_period(amplitude), 1e-9);
    assert_close(value[1], 2*sin(amplitude/2), 1e-10);
  }
}

static double phase;

static void begun_at_phase(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = sin(phase);
  v[0] = cos(phase);
}

/* One top and one bottom, wherever they lie in a step. */
static void an_extreme_anywhere_in_a_step(void **state)
{
  static const char *const text[] = {"max(x)", "min(x)", "period(x - 0.5)"};
  static const lag_method *const methods[] = {&lag_rk45, &lag_dop853, &lag_radau, &lag_taylor_method};
  lag_scene scene = osc;
  double value[3];
  (void)state;
  scene.start = begun_at_phase;
  for (int i = 0; i < 4; i++) {
    for (phase = 0.01; phase < 0.5; phase += 0.03) {
      measure(sim_with(&scene, methods[i], 1e-8, 0, NULL), 6.9, 3, text, value);
      assert_close(value[0], 1, 3e-7); /* the error of these methods at this tolerance */
      assert_close(value[1], -1, 3e-7);
      assert_close(value[2], 2*PI, 1e-6);
    }
  }
}

/* x'' = -x - x'/5 + cos 2 t in its steady state A cos(2 t - phi). */
static int forced_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -q[0] - 0.2*v[0] + cos(2*t);
  return 0;
}

static void forced_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  double A = 1/hypot(3, 0.4), phi = atan2(0.4, -3);
  q[0] = A*cos(phi);
  v[0] = 2*A*sin(phi);
}

static const lag_model forced_model = {MODEL("forced"), .flags = LAG_SMOOTH | LAG_CONSTANT_MASS, .nq = 1, .q = names_q,
                                       .accel = forced_accel};
static const lag_scene forced = {
    .name = "steady", .doc = "", .model = &forced_model, .start = forced_start, .t1 = 10, .has_span = 1};

static void a_driven_oscillator_in_its_steady_state(void **state)
{
  static const char *const text[] = {"max(x)",    "min(x)",         "mean(x)",   "rms(x)",
                                     "period(x)", "max(x')/max(x)", "mean(x*x')"};
  const double A = 1/hypot(3, 0.4), expected[] = {A, -A, 0, A/sqrt(2), PI, 2, 0};
  double value[MOST];
  (void)state;
  measure(sim_with(&forced, &lag_rk45, 1e-12, 0, NULL), 10*PI, 7, text, value); /* ten periods */
  for (int k = 0; k < 7; k++) {
    assert_close(value[k], expected[k], 1e-9);
  }
}

/* A ball that falls from 1 m onto the ground and keeps 0.9 of its speed: fall T, flights of 2 T 0.9^n. */
static void a_ball_that_bounces(void **state)
{
  static const char *const text[] = {
      "hit(ground)", "hit(ground, 3)", "count(ground)", "y((hit(ground, 1) + hit(ground, 2))/2)",
      "min(y)",      "max(y')",        "min(y')",       "hit(ground, 9)",
      "end",         "y(7)",           "mean(y')"};
  const double T = sqrt(2/9.81), until = 1.5, g = 9.81;
  double value[MOST];
  (void)state;
  double since = until - T*(1 + 2*0.9), y = 0.81*g*T*since - g/2*since*since;
  const double expected[] = {T, NAN, 2, 0.81, 0, 0.9*g*T, -g*T, NAN, until, NAN, (y - 1)/until};
  for (int i = 0; i < 2; i++) {
    measure(sim_with(&ball, i ? &lag_taylor_method : &lag_rk45, 1e-12, 0, NULL), until, 11, text, value);
    for (int k = 0; k < 11; k++) {
      if (isnan(expected[k])) {
        assert_true(isnan(value[k]));
      } else {
        assert_close(value[k], expected[k], 1e-10);
      }
    }
  }
}

/* At the ground the ball is thrown up with 100 m/s, and the run ends. */
static int throw_up(SELF, UNUSED int k, STATE, UNUSED double *q1, double *v1, UNUSED double *z1, int *stop,
                    UNUSED double *w) {
  v1[0] = 100;
  *stop = 1;
  return 0;
}

static void an_event_that_ends_the_run(void **state)
{
  static const char *const text[] = {"max(y')", "y'", "end", "count(ground)", "y'(1)", "drift(y')"};
  lag_model model = ball_model;
  lag_scene scene = ball;
  double value[6];
  (void)state;
  model.act = throw_up;
  scene.model = &model;
  assert_int_equal(measure(sim_with(&scene, &lag_rk45, 1e-12, 0, NULL), 5, 6, text, value), LAG_STOPPED);
  const double expected[] = {100, 100, sqrt(2/9.81), 1, NAN, 100};
  for (int k = 0; k < 6; k++) {
    if (k == 4) {
      assert_true(isnan(value[k]));
    } else {
      assert_close(value[k], expected[k], 1e-10);
    }
  }
}

/* Times that are values at times: by a third run; those that lie before the run, or behind its end, have no value.
 * Backwards in time. */
static void times_that_are_measures(void **state)
{
  static const char *const text[] = {"x(t - 19 + 0*x(t/2))", "x(x(t/2)^2)", "x(-1)", "x(21)"};
  static const char *const back[] = {"x(-2)", "max(x')", "mean(x)", "end", "x(2)"};
  double value[5];
  (void)state;
  measure(sim_with(&osc, &lag_dop853, 1e-12, 0, NULL), 20, 4, text, value);
  assert_close(value[0], cos(1), 1e-9);
  assert_close(value[1], cos(cos(10)*cos(10)), 1e-9);
  assert_true(isnan(value[2]) && isnan(value[3]));
  measure(sim_with(&osc, &lag_dop853, 1e-12, 0, NULL), -3, 5, back, value);
  assert_close(value[0], cos(2), 1e-10);
  assert_close(value[1], 1, 1e-10);
  assert_close(value[2], sin(3)/3, 1e-10);
  assert_close(value[3], -3, 0);
  assert_true(isnan(value[4]));
}

/* rk4 multiplies the energy of x'' = -x by 1 - h^6/72 + h^8/576 in each step; between the ends of steps Hermite's
 * cubic of x' is off by h^4/384. */
static void the_drift_of_rk4(void **state)
{
  static const char *const text[] = {"energy", "drift(energy)"};
  const double h = 0.25, factor = 1 - pow(h, 6)/72 + pow(h, 8)/576;
  double value[2];
  (void)state;
  measure(equal_steps(&osc, &lag_rk4, h), 500*h, 2, text, value);
  assert_close(value[0], 0.5*pow(factor, 500), 1e-13);
  assert_close(value[1], 0.5 - value[0], pow(h, 4)/384);
}

/* A run with measures ends in the same bits, after as many steps. */
static void the_run_stays_as_it_is(void **state)
{
  static const char *const text[] = {"max(x)", "mean(y)", "x(1.5)", "period(y)", "rms(x^2)", "y(7.25)"};
  double value[MOST];
  (void)state;
  for (int i = 0; i < lag_nmethods; i++) {
    lag_option step[] = {{"step", 0.01, NULL}};
    int adaptive = lag_methods[i]->flags & LAG_METHOD_ADAPTIVE;
    lag_sim *plain = sim_with(&kepler, lag_methods[i], 1e-8, adaptive ? 0 : 1, step),
            *measured = sim_with(&kepler, lag_methods[i], 1e-8, adaptive ? 0 : 1, step);
    Measures *m = measures_of(&kepler, 6, text);
    lag_stats a, b;
    assert_int_equal(lag_sim_advance(plain, 10), LAG_OK);
    assert_int_equal(lag_measures_run(m, measured, 10, value), LAG_OK);
    lag_sim_stats(plain, &a);
    lag_sim_stats(measured, &b);
    assert_memory_equal(lag_sim_q(plain), lag_sim_q(measured), 4*sizeof(double));
    assert_int_equal(a.steps, b.steps);
    lag_measures_free(m);
    lag_sim_free(plain);
    lag_sim_free(measured);
  }
}

/* The same Measures for another run; a run that fails has the values up to there. */
static void a_second_run_and_one_that_fails(void **state)
{
  static const char *const text[] = {"count(ground)", "max(y)", "y(0)"};
  double value[3];
  (void)state;
  Measures *m = measures_of(&ball, 3, text);
  for (int i = 1; i <= 2; i++) {
    lag_sim *s = lag_sim_new(&ball);
    assert_int_equal(lag_sim_set(s, "h", 100*i), LAG_OK);
    lag_measures_run(m, s, 0.9, value);
    assert_close(value[0], 1, 0);
    assert_close(value[1], i, 0);
    assert_close(value[2], i, 0);
    lag_sim_free(s);
  }
  lag_sim *s = lag_sim_new(&ball);
  assert_int_equal(lag_sim_set(s, "h", 1e-6), LAG_OK); /* comes to rest, and never gets to t = 5 */
  assert_int_equal(lag_measures_run(m, s, 5, value), LAG_EZENO);
  assert_true(value[0] > 10);
  lag_sim_free(s);
  lag_measures_free(m);
}

/* ---- Units */

static const lag_var turn_q[] = {{"th", "deg", 3.14159265358979323846/180, 1, 0, 0}};
static const lag_model turn_model = {
    MODEL("turn"),      .flags = LAG_CONSTANT_MASS, .nq = 1, .np = 3, .nev = 0, .q = turn_q, .p = ball_p,
    .accel = osc_accel, .energy = osc_energy};

static void turn_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = PI/2;
  v[0] = 0;
}

static const lag_scene turn = {.name = "turn",
                               .doc = "", .model = &turn_model, .params = ball_params, .start = turn_start, .t1 = 10,
                               .has_span = 1};

static void values_are_in_their_units(void **state)
{
  static const struct {
    const char *text, *unit;
    double value;
  } of[] = {
      {"th", "deg", 90 * 0.40808206181339199},
      {"h", "cm", 100},
      {"t", "s", 20},
      {"th max()", "", PI / 2},
      {"h []", "", 1},
      {"h 2 *", "", 2},
      {"th max() pi() - [0.017453292519943295 0 deg]", "deg", -90},
      {"h 1 + [1 0 m]", "m", 2},
      {"h [1 -1 above]", "above", 2},
      {"\"h\" [0.5 0 half m]", "half m", 2},
      {"ground.e", "", 0.9},
      {"2 3 2 ^ ^", "", 512},
      {"-2", "", -2},
      {"7 2 - 1 -", "", 4},
      {"8 4 / 2 /", "", 1},
      {"-1.5 floor() abs() neg() sign()", "", -1},
      {"1 2 lesser() 3 greater()", "", 3},
      {"th max(1..2) ; th", "", PI / 2 * 0.54030230586813977}, /* the first of two variants: cos t falls from t = 1 */
  };
  char why[300];
  (void)state;
  for (size_t i = 0; i < sizeof of/sizeof *of; i++) {
    double value;
    Measures *m = lag_measures_new(&turn, 1, &of[i].text, NULL, why, sizeof why);
    lag_sim *s = sim_with(&turn, &lag_dop853, 1e-12, 0, NULL);
    if (!m) {
      fail_msg("%s", why);
    }
    assert_string_equal(lag_measures_unit(m, 0), of[i].unit);
    lag_measures_run(m, s, 20, &value);
    if (!(fabs(value - of[i].value) <= 1e-8)) {
      fail_msg("%s = %.15g, expected %.15g", of[i].text, value, of[i].value);
    }
    lag_measures_free(m);
    lag_sim_free(s);
  }
}

static void wrong_words_get_a_message(void **state)
{
  static const struct {
    const char *text, *why;
  } of[] = {
      {"z max()", "no output, coordinate, parameter or charge is called z"},
      {"yy", "did you mean y?"},
      {"1 hit(grund)", "no event is called grund; did you mean ground?"},
      {"max(y)", "lagc compiles them"},
      {"max()", "`max()` is no word"}, {"y max(1)", "is no word"}, {"y sin() +", "`+` is no word"},
      {"1 at()", "is no word"}, {"hit(ground)", "is no word"}, {"y y", "is no word"}, {"", "is no word"},
      {"1.5.2", "is no word"}, {"y mxa()", "`mxa()` is no word"},
      {"this_name_is_so_long_that_nobody_would_ever_write_it_and_no_model_has_it_for_it_has_more_than_a_hundred_and_"
       "twenty_seven_characters_and_that_is_more_than_any_word_of_a_measure_may_have_in_this_runtime",
       "too long"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof of/sizeof *of; i++) {
    char why[600];
    const char *two[] = {"y 1 at()", of[i].text};
    assert_null(lag_measures_new(&ball, 2, two, NULL, why, sizeof why));
    if (!strstr(why, of[i].why) || strncmp(why, of[i].text, strlen(of[i].text)) != 0) {
      fail_msg("\"%s\" does not say \"%s\"", why, of[i].why);
    }
    char cut[8]; /* a small buffer is not overrun */
    assert_null(lag_measures_new(&ball, 2, two, NULL, cut, sizeof cut));
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(functions), cmocka_unit_test(an_oscillator_by_every_method),
      cmocka_unit_test(the_period_of_a_pendulum_over_its_amplitude),
      cmocka_unit_test(an_extreme_anywhere_in_a_step),
      cmocka_unit_test(a_driven_oscillator_in_its_steady_state),
      cmocka_unit_test(a_ball_that_bounces),
      cmocka_unit_test(an_event_that_ends_the_run),
      cmocka_unit_test(times_that_are_measures),
      cmocka_unit_test(the_drift_of_rk4),
      cmocka_unit_test(the_run_stays_as_it_is),
      cmocka_unit_test(a_second_run_and_one_that_fails),
      cmocka_unit_test(values_are_in_their_units),
      cmocka_unit_test(wrong_words_get_a_message),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
