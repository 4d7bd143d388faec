/* The simulation object: values by name, energy and monitors, inputs, and runs that are split or saved. Expected
 * values: closed forms, GSL, and the same run done in one piece. */
#include "numeric/workspace.h"
#include "test_rt_systems.h"

/* Steps of 0.01 where the method does not choose them. */
static lag_sim *sim_of(const lag_scene *scene, const lag_method *m)
{
  return sim_with(scene, m, 1e-7, !(m->flags & LAG_METHOD_ADAPTIVE), (lag_option[]){{"step", 0.01, NULL}});
}

/* ---- values */

static void values_are_in_declared_units(void **state)
{
  lag_sim *s = lag_sim_new(&ball);
  (void)state;
  assert_int_equal(lag_sim_set(s, "h", 250), 0); /* cm */
  assert_close(lag_sim_p(s)[1], 2.5, 1e-15);
  assert_int_equal(lag_sim_set(s, "e", 0.25), 0); /* ground.e, the only one */
  assert_close(lag_sim_p(s)[2], 0.25, 0);
  assert_int_equal(lag_sim_set(s, "y'", 2), 0);
  assert_int_equal(lag_sim_advance(s, 0.1), LAG_OK);
  assert_close(lag_sim_q(s)[0], 2.5 + 0.2 - 9.81 * 0.005, 1e-12);
  assert_close(lag_sim_v(s)[0], 2 - 0.981, 1e-12);
  lag_sim_free(s);
}

#ifdef __SANITIZE_ADDRESS__
int __asan_address_is_poisoned(void const volatile *p);
/* The number behind each part of a work space is out of bounds. */
static void parts_of_a_work_space_have_gaps(void **state)
{
  double *a, *b, *c;
  const lag_part parts[] = {{&a, 3}, {&b, 0}, {&c, 5}};
  (void)state;
  double *block = lag_workspace(3, parts);
  for (int i = 0; i < 3; i++) {
    assert_true(__asan_address_is_poisoned(*parts[i].at + parts[i].n));
    assert_false(parts[i].n && __asan_address_is_poisoned(*parts[i].at + parts[i].n - 1));
  }
  free(block);
}
#endif

/* One value for all members of a family, whose name may have more than one letter, or for all their rates. */
static void families_are_set_at_once(void **state)
{
  static const lag_var members[] = {{"th[1]", "m", 1, 0, 0, 0}, {"th[2]", "m", 1, 0, 0, 0}};
  lag_model m = kepler_model;
  lag_scene scene = kepler;
  (void)state;
  m.q = members;
  scene.model = &m;
  lag_sim *s = lag_sim_new(&scene);
  assert_int_equal(lag_sim_set(s, "th", 0.5), LAG_OK);
  assert_int_equal(lag_sim_set(s, "th'", -0.25), LAG_OK);
  assert_int_equal(lag_sim_set(s, "t", 1), LAG_EINVAL);
  assert_int_equal(lag_sim_set(s, "'", 1), LAG_EINVAL);
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  for (int i = 0; i < 2; i++) {
    assert_true(lag_sim_q(s)[i] == 0.5 && lag_sim_v(s)[i] == -0.25);
  }
  lag_sim_free(s);
}

static void outputs_have_names_and_units(void **state)
{
  lag_sim *s = lag_sim_new(&kepler);
  char name[16], unit[16];
  double out[4];
  (void)state;
  assert_int_equal(lag_sim_noutputs(s), 4);
  assert_close(lag_sim_output_info(s, 3, name, sizeof name, unit, sizeof unit), 1, 0);
  assert_string_equal(name, "y'");
  assert_string_equal(unit, "m/s");
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  assert_int_equal(lag_sim_outputs(s, out), LAG_OK);
  assert_close(out[0], 0.4, 1e-15);
  assert_close(out[3], 2, 1e-15);
  lag_sim_free(s);
}

/* ---- inputs: x'' = u, u = t; or held at a constant */

static int ramp(SELF, double t, UNUSED const double *p, double *u) {
  u[0] = t;
  return 0;
}

static int pushed_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = u[0];
  return 0;
}

static const lag_var push_u[] = {{"push", "m/s^2", 1, 0, 0, 0}};
UNIT_MASS(pushed, pushed_accel, 0);
TAYLOR_LINEAR(pushed, 0, 1);
static const lag_model pushed_model = {MODEL("pushed"), .flags = LAG_SEPARABLE | LAG_SMOOTH,
                                       .nq = 1,         .nu = 1,
                                       .q = names_q,    .u = push_u,
                                       .inputs = ramp,  .accel = pushed_accel,
                                       ANALYTIC(pushed)};
static const lag_scene pushed = {
    .name = "pushed", .doc = "", .model = &pushed_model, .start = osc_start, .t1 = 5, .has_span = 1};

static void inputs_follow_their_formula_or_a_constant(void **state)
{
  (void)state;
  for (int i = 0; i < lag_nmethods; i++) {
    if (OF_BODIES(lag_methods[i])) continue;
    lag_sim *a = lag_sim_new(&pushed), *b = sim_with(&pushed, lag_methods[i], 0, 0, NULL);
    assert_int_equal(lag_sim_set_method(a, lag_methods[i], NULL, 0), 0);
    /* a force of degree 1 in t: exact but for the methods of order 1 and 2, at the default step, 5e-4 */
    double within = lag_methods[i]->order > 2 ? 1e-12 : lag_methods[i]->order == 2 ? 1e-6 : 1e-2;
    assert_int_equal(lag_sim_set(b, "push", 0.5), 0);
    assert_int_equal(lag_sim_advance(a, 2), LAG_OK);
    assert_int_equal(lag_sim_advance(b, 2), LAG_OK);
    assert_close(lag_sim_q(a)[0], 1 + 8.0 / 6, within);
    assert_close(lag_sim_q(b)[0], 1 + 0.25 * 4, within);
    lag_sim_free(a);
    lag_sim_free(b);
  }
}

static double slope(void *context, double t)
{
  return *(const double *)context * t;
}

static void inputs_follow_a_function(void **state)
{
  double rate = 3;
  (void)state;
  for (int i = 0; i < lag_nmethods + lag_gsl_nmethods; i++) {
    const lag_method *m = i < lag_nmethods ? lag_methods[i] : lag_gsl_methods[i - lag_nmethods];
    if (OF_BODIES(m)) continue;
    lag_sim *s = sim_with(&pushed, m, 1e-10, 0, NULL);
    assert_int_equal(lag_sim_set(s, "push", 7), 0);
    int series = (m->flags & LAG_METHOD_TAYLOR) != 0; /* a function has none */
    /* instead of the constant */
    assert_int_equal(lag_sim_set_input(s, "push", slope, &rate), series ? LAG_EMETHOD : 0);
    if (series) {
      assert_non_null(strstr(lag_sim_message(s), "dop853"));
      lag_sim_free(s);
      continue;
    }
    assert_int_equal(lag_sim_advance(s, 2), LAG_OK);
    /* as above: exact but for the methods of order 1 and 2; GSL's at their tolerance */
    double within = m->order > 2 ? 1e-8 : m->order == 2 ? 3e-6 : 3e-2;
    assert_close(lag_sim_q(s)[0], 1 + 3 * 8.0 / 6, within);
    assert_int_equal(lag_sim_set_input(s, "push", NULL, NULL), LAG_EINVAL); /* it has begun */
    lag_sim_free(s);
  }
}

static void a_constant_takes_the_place_of_a_function(void **state)
{
  double rate = 3;
  (void)state;
  lag_sim *s = lag_sim_new(&pushed);
  assert_int_equal(lag_sim_set_input(s, "push", slope, &rate), 0);
  assert_int_equal(lag_sim_set(s, "push", 0.5), 0);
  assert_int_equal(lag_sim_advance(s, 2), LAG_OK);
  assert_close(lag_sim_q(s)[0], 1 + 0.25 * 4, 1e-9);
  lag_sim_free(s);
}

/* The facts of the model alone are not those of the model with a function in it. */
static int sees_facts(void *work, lag_problem *pb, const double *opt)
{
  (void)work, (void)opt;
  pb->detail = lag_facts(pb) & (LAG_SMOOTH | LAG_AUTONOMOUS) ? "smooth" : "not smooth";
  return LAG_EMETHOD;
}

static void a_function_takes_facts_away(void **state)
{
  double rate = 3;
  lag_model model = pushed_model;
  lag_scene scene = pushed;
  lag_method method = lag_rk4;
  (void)state;
  model.flags |= LAG_SMOOTH | LAG_AUTONOMOUS;
  scene.model = &model;
  method.init = sees_facts;
  for (int with = 0; with < 2; with++) {
    lag_sim *s = lag_sim_new(&scene);
    assert_int_equal(lag_sim_set_method(s, &method, NULL, 0), 0);
    assert_int_equal(lag_sim_set_input(s, "push", with ? slope : NULL, &rate), 0);
    assert_int_equal(lag_sim_advance(s, 1), LAG_EMETHOD);
    assert_non_null(strstr(lag_sim_message(s), with ? "not smooth" : "(smooth"));
    lag_sim_free(s);
  }
}

/* ---- energy and monitors */

static void energy_drift_is_what_the_method_loses(void **state)
{
  lag_stats st;
  (void)state;
  /* rk4 on the oscillator: |R(ih)|^2 = 1 - h^6/72, over 1000 steps of 0.1; scale: |p.v| + |L| = sin^2 + |cos 2t|/2,
   * 1/2 + 1/pi in the mean of whole periods. */
  lag_sim *s = sim_with(&osc, &lag_rk4, 0, 1, (lag_option[]){{"step", 0.1, NULL}});
  assert_int_equal(lag_sim_advance(s, 100), LAG_OK);
  lag_sim_stats(s, &st);
  assert_close(st.energy_drift, 1000 * 1e-6 / 72 / (1 + 2 / PI), 2e-7);
  assert_close(st.energy, 0.5 * (1 - 1000 * 1e-6 / 72), 2e-7);
  lag_sim_free(s);
  s = sim_with(&kepler, &lag_rk45, 1e-12, 0, NULL);
  assert_int_equal(lag_sim_advance(s, 20), LAG_OK);
  lag_sim_stats(s, &st);
  assert_true(st.energy_drift > 0 && st.energy_drift < 1e-10);
  lag_sim_free(s);
}

static int watch_x(ARGS, double *out, UNUSED double *w)
{
  out[0] = q[0];
  return 0;
}

/* Where one monitor fails, the drift of those behind it is known, too. */
static void all_monitors_are_known_where_one_fails(void **state)
{
  const lag_monitor both[] = {{"energy", -1, 1e-9, 0}, {"x", 0, 10, 0}};
  lag_scene c = osc;
  (void)state;
  c.nmonitors = 2;
  c.monitors = both;
  c.nout = 1;
  c.outputs = names_q;
  c.observe = watch_x;
  lag_sim *s = sim_with(&c, &lag_rk4, 0, 1, (lag_option[]){{"step", 0.1, NULL}});
  assert_int_equal(lag_sim_advance(s, 10), LAG_EMONITOR);
  assert_close(lag_sim_monitor_drift(s, 1), 1 - cos(0.1), 1e-6); /* rk4: 0.1^5/120 */
  lag_sim_free(s);
}

static void monitors_end_the_run(void **state)
{
  const lag_monitor tight = {"energy", -1, 1e-9, 0}, loose = {"energy", -1, 1e-3, 0}, x = {"x", 0, 0.5, 0};
  (void)state;
  for (int i = 0; i < 3; i++) {
    lag_scene c = osc;
    c.nmonitors = 1;
    c.monitors = i == 0 ? &tight : i == 1 ? &loose : &x;
    c.nout = 1;
    c.outputs = names_q;
    c.observe = watch_x;
    lag_sim *s = sim_with(&c, &lag_rk4, 0, 1, (lag_option[]){{"step", 0.1, NULL}});
    assert_int_equal(lag_sim_advance(s, 10), i == 1 ? LAG_OK : LAG_EMONITOR);
    if (i == 0) { /* h^6/72 a step, at first judged against |E0| = 1/2, passes 1e-9 at once */
      assert_close(lag_sim_time(s), 0.1, 1e-12);
      assert_close(lag_sim_monitor_drift(s, 0), 1e-6 / 72, 1e-10);
    } else if (i == 2) { /* |cos t - 1| > 1/2 after pi/3 = 1.047 */
      assert_close(lag_sim_time(s), 1.1, 1e-12);
    }
    lag_sim_free(s);
  }
}

/* ---- split and saved runs are the same run */

static void asking_more_often_changes_nothing(void **state)
{
  (void)state;
  for (int i = 0; i < lag_nmethods; i++) {
    if (OF_BODIES(lag_methods[i])) continue;
    lag_sim *a = sim_of(&ball, lag_methods[i]), *b = sim_of(&ball, lag_methods[i]);
    lag_stats sa, sb;
    assert_int_equal(lag_sim_advance(a, 4), LAG_OK);
    for (int k = 1; k <= 4000; k++) {
      assert_int_equal(lag_sim_advance(b, k / 1000.0), LAG_OK);
    }
    assert_memory_equal(lag_sim_q(a), lag_sim_q(b), 2 * sizeof(double));
    lag_sim_stats(a, &sa);
    lag_sim_stats(b, &sb);
    assert_int_equal(sa.steps, sb.steps);
    assert_int_equal(sa.rhs_calls, sb.rhs_calls);
    assert_int_equal(sa.events, sb.events);
    lag_sim_free(a);
    lag_sim_free(b);
  }
}

/* Saved at `cut`, loaded into another object, run to the end: bit for bit. */
static void check_cut(const lag_scene *scene, const lag_method *m, double cut, double end)
{
  lag_sim *whole = sim_of(scene, m), *first = sim_of(scene, m), *second = sim_of(scene, m);
  size_t n = lag_sim_save_size(first), bytes = (size_t)(2 * scene->model->nq) * sizeof(double);
  double *x = calloc(n, sizeof *x);
  lag_stats a, b;
  assert_int_equal(lag_sim_advance(whole, end), LAG_OK);
  assert_int_equal(lag_sim_advance(first, cut), LAG_OK);
  assert_int_equal(lag_sim_save(first, x), LAG_OK);
  assert_true(lag_sim_signature(first) == lag_sim_signature(second));
  assert_int_equal(lag_sim_load(second, x), LAG_OK);
  assert_memory_equal(lag_sim_q(second), lag_sim_q(first), bytes);
  assert_int_equal(lag_sim_advance(second, end), LAG_OK);
  assert_memory_equal(lag_sim_q(second), lag_sim_q(whole), bytes);
  lag_sim_stats(whole, &a);
  lag_sim_stats(second, &b);
  assert_true(a.energy_drift == b.energy_drift && a.steps == b.steps && a.events == b.events);
  /* the state at the cut, and the search for poles, which has lost its history */
  assert_in_range(b.rhs_calls - a.rhs_calls, 0, 12);
  free(x);
  lag_sim_free(whole);
  lag_sim_free(first);
  lag_sim_free(second);
}

/* Looking at every step in between, an event included, gives the outputs that advance finds there, and the same run. */
static void looking_ahead_changes_nothing(void **state)
{
  lag_sim *plain = lag_sim_new(&kepler), *looked = lag_sim_new(&kepler);
  double y[4], here[4], there[4], reach;
  int steps = 0;
  (void)state;
  assert_int_equal(lag_sim_advance(plain, 5), LAG_OK);
  while (lag_sim_time(looked) < 5) {
    assert_int_equal(lag_sim_ensure_step(looked, 5, &reach), LAG_OK);
    double t = lag_sim_time(looked), middle = t + (reach - t) / 2;
    assert_true(reach > t && reach <= 5);
    assert_int_equal(lag_sim_outputs_at(looked, reach, y, there), LAG_OK);
    assert_int_equal(lag_sim_outputs_at(looked, middle, y, there), LAG_OK);
    assert_true(lag_sim_time(looked) == t);
    assert_int_equal(lag_sim_advance(looked, middle), LAG_OK);
    assert_int_equal(lag_sim_outputs(looked, here), LAG_OK);
    assert_memory_equal(here, there, sizeof here);
    assert_int_equal(lag_sim_outputs_at(looked, reach + 10, y, there), LAG_EINVAL);
    assert_int_equal(lag_sim_advance(looked, reach), LAG_OK);
    steps++;
  }
  assert_true(steps > 10);
  assert_memory_equal(lag_sim_q(plain), lag_sim_q(looked), 2 * sizeof(double));
  assert_memory_equal(lag_sim_v(plain), lag_sim_v(looked), 2 * sizeof(double));
  lag_sim_free(plain);
  lag_sim_free(looked);
}

/* An event is at the end of what is known, and happens in the next call. */
static void looking_ahead_ends_at_events(void **state)
{
  lag_sim *s = lag_sim_new(&ball);
  double reach, hit = 0;
  (void)state;
  assert_int_equal(lag_sim_set(s, "y", 1), 0);
  assert_int_equal(lag_sim_set(s, "y'", 0), 0);
  assert_int_equal(lag_sim_advance(s, 0), LAG_OK);
  double floor_at = sqrt(2 * (lag_sim_q(s)[0]) / 9.81);
  while (hit == 0.0 && lag_sim_time(s) < 3) {
    assert_int_equal(lag_sim_ensure_step(s, 3, &reach), LAG_OK);
    assert_int_equal(lag_sim_advance(s, reach), LAG_OK);
    if (fabs(reach - floor_at) < 1e-6) {
      hit = reach;
    }
  }
  assert_close(hit, floor_at, 1e-9);
  assert_true(lag_sim_v(s)[0] < 0);
  assert_int_equal(lag_sim_ensure_step(s, 3, &reach), LAG_OK);
  assert_true(lag_sim_time(s) == hit && lag_sim_v(s)[0] > 0);
  lag_sim_free(s);
}

static void a_saved_run_goes_on_bit_by_bit(void **state)
{
  (void)state;
  for (int i = 0; i < lag_nmethods; i++) {
    for (double cut = 0.05; cut < 4; cut += 0.317) {
      if (!OF_BODIES(lag_methods[i])) check_cut(&ball, lag_methods[i], cut, 4);
      check_cut(&kepler, lag_methods[i], cut, 4);
    }
  }
}

static void what_cannot_be_saved_says_so(void **state)
{
  lag_sim *s = sim_with(&kepler, lag_gsl_methods[0], 0, 0, NULL), *t = lag_sim_new(&ball);
  double x = 0;
  (void)state;
  assert_int_equal(lag_sim_save(s, &x), LAG_EINVAL);
  assert_int_equal(lag_sim_load(s, &x), LAG_EINVAL);
  assert_true(lag_sim_signature(s) != lag_sim_signature(t));
  lag_sim_free(s);
  lag_sim_free(t);
}

/* ---- against independent integrators */

static void all_methods_agree(void **state)
{
  double right[4];
  lag_stats st;
  (void)state;
  lag_sim *s = sim_with(&double_pendulum, lag_gsl_methods[0], 1e-14, 0, NULL);
  assert_int_equal(lag_sim_advance(s, 5), LAG_OK);
  memcpy(right, lag_sim_q(s), sizeof right);
  lag_sim_free(s);
  for (int i = 0; i < lag_nmethods + lag_gsl_nmethods; i++) {
    const lag_method *m = i < lag_nmethods ? lag_methods[i] : lag_gsl_methods[i - lag_nmethods];
    /* taylor: tests/exec/run_taylor.sh, with the emitted series */
    if (m->order < 4 || (m->flags & LAG_METHOD_TAYLOR)) {
      continue;
    }
    s = sim_with(&double_pendulum, m, 1e-11, !(m->flags & LAG_METHOD_ADAPTIVE), (lag_option[]){{"step", 1e-3, NULL}});
    assert_int_equal(lag_sim_advance(s, 5), LAG_OK);
    for (int j = 0; j < 4; j++) {
      assert_close(lag_sim_q(s)[j], right[j], 1e-6);
    }
    lag_sim_stats(s, &st);
    assert_true(st.energy_drift < 1e-8 && st.rhs_calls > 100);
    lag_sim_free(s);
  }
}

static int stop_after_5(void *context, const lag_sim *s)
{
  (void)s;
  return ++*(int *)context == 5;
}

static void the_hook_interrupts_and_the_run_can_go_on(void **state)
{
  int n = 0;
  lag_sim *s = sim_with(&kepler, &lag_rk45, 1e-7, 0, NULL), *t = sim_with(&kepler, &lag_rk45, 1e-7, 0, NULL);
  (void)state;
  lag_sim_on_step(s, stop_after_5, &n);
  assert_int_equal(lag_sim_advance(s, 4), LAG_INTERRUPTED);
  assert_true(lag_sim_time(s) > 0 && lag_sim_time(s) < 4);
  assert_int_equal(lag_sim_advance(s, 4), LAG_OK);
  assert_int_equal(lag_sim_advance(t, 4), LAG_OK);
  assert_memory_equal(lag_sim_q(s), lag_sim_q(t), 4 * sizeof(double));
  lag_sim_free(s);
  lag_sim_free(t);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_are_in_declared_units),
      cmocka_unit_test(families_are_set_at_once),
#ifdef __SANITIZE_ADDRESS__
      cmocka_unit_test(parts_of_a_work_space_have_gaps),
#endif
      cmocka_unit_test(outputs_have_names_and_units),
      cmocka_unit_test(inputs_follow_their_formula_or_a_constant),
      cmocka_unit_test(inputs_follow_a_function),
      cmocka_unit_test(a_constant_takes_the_place_of_a_function),
      cmocka_unit_test(a_function_takes_facts_away),
      cmocka_unit_test(energy_drift_is_what_the_method_loses),
      cmocka_unit_test(all_monitors_are_known_where_one_fails),
      cmocka_unit_test(monitors_end_the_run),
      cmocka_unit_test(asking_more_often_changes_nothing),
      cmocka_unit_test(looking_ahead_changes_nothing),
      cmocka_unit_test(looking_ahead_ends_at_events),
      cmocka_unit_test(a_saved_run_goes_on_bit_by_bit),
      cmocka_unit_test(what_cannot_be_saved_says_so),
      cmocka_unit_test(all_methods_agree),
      cmocka_unit_test(the_hook_interrupts_and_the_run_can_go_on),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
