/* Methods against exact digits: trajectories of the algorithms themselves, run in 40- and 60-digit arithmetic by an
 * independent script (both agree to 39 digits), and solutions from closed forms or from independent Taylor
 * integrations in multiple precision at two precisions and step sequences. Tolerances are those that were stated
 * with the digits: 1e-11 for an algorithm, 1e-10 from 4000 steps on, and 300 times what a good solver of order 8
 * reaches for solutions. */
#include "test_rt_systems.h"

/* Exact digits of a discrete trajectory; energy: the largest |E - E0|, to 6 digits, 0 when not given. */
typedef struct Discrete {
  const lag_scene *scene;
  const lag_method *method;
  double start[4], h, steps, end[4], tolerance, energy;
} Discrete;

static const Discrete discrete[] = {{&kepler,
                                     &lag_verlet, {0.4, 0, 0, 2}, 0.05, 4000,
                                     {0.1492567601618686452370138, -0.4160761029934289527359370,
                                      1.531565705425547941352493, 1.090417007790144464923146},
                                     1e-10,
                                     0.00938867238199},
                                    {&pendulum,
                                     &lag_verlet, {1.5, 0}, 0.1, 10000,
                                     {1.496887913263532132286482, -0.07878300337218273195097739}, 1e-10,
                                     0.00196369010629},
                                    {&kepler,
                                     &lag_verlet, {0.4, 0, 0, 2}, 0.01, 2000,
                                     {-0.7503456613720981161838697, 0.7928058677994100135840482,
                                      -0.9061409160242350656781928, -0.1087580950006789977059197},
                                     1e-11,
                                     0.000370680480534},
                                    {&kepler,
                                     &lag_rk45, {0.4, 0, 0, 2}, 0.05, 400,
                                     {-0.7700850653912251838484968, 0.7883357639969538934158134,
                                      -0.8941805936606926376995140, -0.1234737276369075566322038},
                                     1e-11,
                                     0}};

typedef struct Energy {
  double first, worst;
  int steps;
} Energy;

static int watch(void *context, const lag_sim *s)
{
  Energy *e = context;
  double now[2];
  lag_sim_scene(s)->model->energy(lag_sim_scene(s)->model, 0, lag_sim_q(s), lag_sim_v(s), NULL, NULL, NULL, now, NULL);
  e->worst = fmax(e->worst, fabs(now[0] - e->first));
  return ++e->steps < 0;
}

static void algorithms_reproduce_their_digits(void **state)
{
  static const char *const names[2][4] = {{"x", "x'"}, {"x", "y", "x'", "y'"}};
  (void)state;
  for (size_t k = 0; k < sizeof discrete / sizeof *discrete; k++) {
    const Discrete *d = &discrete[k];
    int nq = d->scene->model->nq;
    double e0[2];
    lag_sim *s = equal_steps(d->scene, d->method, d->h);
    for (int i = 0; i < 2 * nq; i++) {
      assert_int_equal(lag_sim_set(s, names[nq - 1][i], d->start[i]), 0);
    }
    d->scene->model->energy(d->scene->model, 0, d->start, d->start + nq, NULL, NULL, NULL, e0, NULL);
    Energy e = {e0[0], 0, 0};
    lag_sim_on_step(s, watch, &e);
    /* To the end of the last step itself: h is no binary number, and the sum of the steps knows better than n h. */
    assert_int_equal(lag_sim_advance(s, (d->steps - 0.5) * d->h), LAG_OK);
    double end = d->steps * d->h;
    assert_int_equal(lag_sim_advance(s, end), LAG_OK);
    assert_close(distance(2 * nq, lag_sim_q(s), d->end), 0, d->tolerance);
    if (d->energy > 0) {
      assert_close(e.worst / d->energy, 1, 1e-6);
    }
    lag_sim_free(s);
  }
}

/* The first error estimate of Dormand-Prince on the same problem: the step is accepted just above that tolerance. */
static void the_error_estimate_is_that_of_dormand_and_prince(void **state)
{
  const double estimate = 6.27877034354e-7; /* max norm, of y after one step of 0.05 */
  (void)state;
  /* With a huge atol the norm is the root mean square over four components: between max/2 and max. */
  for (int pass = 0; pass < 2; pass++) {
    double atol = estimate * (pass ? 1.0001 : 0.4999);
    lag_option opt[] = {{"step", 0.05, NULL}, {"max_step", 0.05, NULL}, {"atol", atol, NULL}};
    lag_sim *s = sim_with(&kepler, &lag_rk45, 1e-15, 3, opt);
    lag_stats st;
    assert_int_equal(lag_sim_advance(s, 1e-3), LAG_OK);
    lag_sim_stats(s, &st);
    assert_int_equal(st.rejected > 0, pass == 0);
    lag_sim_free(s);
  }
}

/* ---- Solutions */

/* Arenstorf's orbit (1963; HNW I II.0): restricted three bodies in the rotating frame, mu = 0.012277471. */
static int arenstorf_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  double mu = 0.012277471, m = 1 - mu, x = q[0], y = q[1];
  double r1 = (x + mu) * (x + mu) + y * y, r2 = (x - m) * (x - m) + y * y, d1 = r1 * sqrt(r1), d2 = r2 * sqrt(r2);
  a[0] = x + 2 * v[1] - m * (x + mu) / d1 - mu * (x - m) / d2;
  a[1] = y - 2 * v[0] - m * y / d1 - mu * y / d2;
  return 0;
}

static void arenstorf_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 0.994;
  q[1] = v[0] = 0;
  v[1] = -2.00158510637908252240537862224;
}

SYSTEM(arenstorf, 2, LAG_CONSTANT_MASS | LAG_AUTONOMOUS, NULL, NO_DERIVATIVES);

typedef struct Solution {
  const lag_scene *scene;
  double start; /* of x, NaN: the scene's */
  double t, end[4], tolerance;
} Solution;

#define PERIOD 17.0652165601579625588917206249
static const Solution solutions[] = {
    {&kepler,
     NAN,
     1,
     {-0.628948176826624230582918587818, 0.799664730970039266599484724505, -0.982515690938811327687772587326,
      -0.0227631700974304199197307940278},
     1e-9},
    {&kepler,
     NAN,
     10,
     {-1.53502359190981369430580688532, -0.283668406499780861856428531946, 0.227150732077498337689395655191,
      -0.47918775820321956529070678904},
     1e-9},
    {&kepler,
     NAN,
     100,
     {-0.104183204434180604733859662899, -0.694741715567950599318859370424, 1.2361777626870763242209823319,
      0.564623251085864573762719469537},
     1e-9},
    {&pendulum,
     1e-8,
     100,
     {0.00000000862318872287683618084045888876, 0.00000000506365641109753159328142681138225},
     1e-17},
    {&pendulum, 1e-4, 100, {0.0000862318840685892997161406120368, 0.0000506365694558370124426153695047}, 1e-13},
    {&pendulum, 1, 1, {0.60008536612750643779047453581, -0.754963713953130824903981788725}, 1e-9},
    {&pendulum, 1, 10, {-0.998949814623850651730667870227, -0.0420333775342122936799219791302}, 1e-9},
    {&pendulum, 1, 100, {0.896182477693015934236784564246, 0.410593457294924472471690694807}, 1e-9},
    {&pendulum, 2.5, 10, {2.46853204863864863459435656744, 0.196092889365668955247381105511}, 1e-9},
    {&pendulum, 2.5, 100, {-1.15567611425885054499133443365, 1.55205898822995739414242140821}, 1e-9},
    {&pendulum, 3.1, 10, {-3.09425936152411480692806594359, -0.022590325755831855804806673761}, 1e-9},
    {&henon,
     NAN,
     50,
     {-0.196192724097036858688914468350, -0.102743931477078567947916243528, -0.455526935449929934586996935673,
      -0.0251753704132432471100549299249},
     5e-11},
    {&henon,
     NAN,
     100,
     {0.0902728177367600394760858411426, -0.134665764231043382711149952142, 0.372355009058697092434016554961,
      0.292633613668781284899971604437},
     2e-9},
    {&henon,
     NAN,
     200,
     {0.295031687498594665397831452491, -0.0612477175930419273402883932240, 0.312790277868354086766012783637,
      0.268098016317840059475235719435},
     1e-7},
    {&arenstorf,
     NAN,
     PERIOD / 4,
     {-0.0887192133093007462541229967522, 1.10277575563049389938861685740239, 0.365460971706843224341858802883,
      -0.192342876780349199754895780943},
     9e-11},
    {&arenstorf, NAN, PERIOD / 2, {-1.24482205202656970558478816348, 0, 0, 0.553990308142223067775290840622}, 1e-10},
    {&arenstorf, NAN, PERIOD, {0.994, 0, 0, -2.00158510637908252240537862224}, 8e-8},
    {&arenstorf, NAN, 2 * PERIOD, {0.994, 0, 0, -2.00158510637908252240537862224}, 8e-6},
    {&arenstorf, NAN, 3 * PERIOD, {0.994, 0, 0, -2.00158510637908252240537862224}, 2e-3},
};

static double solution_error(const Solution *c, const lag_method *m, int nopt, const lag_option *opt)
{
  lag_sim *s = sim_with(c->scene, m, 1e-13, nopt, opt);
  if (!isnan(c->start)) {
    assert_int_equal(lag_sim_set(s, "x", c->start), 0);
  }
  assert_int_equal(lag_sim_advance(s, c->t), LAG_OK);
  double e = distance(2 * c->scene->model->nq, lag_sim_q(s), c->end);
  lag_sim_free(s);
  return e;
}

static void dop853_reaches_the_solutions(void **state)
{
  lag_option opt[] = {{"atol", 1e-15, NULL}};
  (void)state;
  for (size_t k = 0; k < sizeof solutions / sizeof *solutions; k++) {
    /* The digits relative to 1e-8 rad need an absolute tolerance below 1e-15 of 1. */
    opt[0].value = solutions[k].start < 1e-6 ? 1e-22 : 1e-15;
    assert_close(solution_error(&solutions[k], &lag_dop853, 1, opt), 0, solutions[k].tolerance);
  }
}

/* verlet8 at 0.01 a step, on the models that it can treat, up to t = 100. */
static void verlet8_reaches_the_solutions(void **state)
{
  lag_option opt[] = {{"step", 0.01, NULL}};
  (void)state;
  for (size_t k = 0; k < sizeof solutions / sizeof *solutions; k++) {
    if ((solutions[k].scene->model->flags & LAG_SEPARABLE) && solutions[k].t <= 100) {
      assert_close(solution_error(&solutions[k], &lag_verlet8, 1, opt), 0, solutions[k].tolerance);
    }
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(algorithms_reproduce_their_digits),
      cmocka_unit_test(the_error_estimate_is_that_of_dormand_and_prince),
      cmocka_unit_test(dop853_reaches_the_solutions),
      cmocka_unit_test(verlet8_reaches_the_solutions),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
