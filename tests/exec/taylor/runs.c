/* The method taylor on emitted models: accuracy from rest, gaps in the series, order, events, one run in many pieces,
 * rounding in long runs. Prints TAP. Each number that is expected has its source beside it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"

extern const lag_scene pendulum_wide, double_pendulum_swing, kepler_orbit, kepler_e0_6_go, gap_go, bouncing_ball_drop;

static int count, bad;

static void check(int ok, const char *name, double got, double allowed) {
  printf("%sok %d - %s\n", ok ? "" : "not ", ++count, name);
  if (!ok) printf("# %.3g, allowed %.3g\n", got, allowed);
  bad |= !ok;
}

static void small(double x, double allowed, const char *name) { check(fabs(x) <= allowed, name, x, allowed); }

static lag_sim *start(const lag_scene *scene, double tol, const lag_option *opt, int n) {
  lag_sim *sim = lag_sim_new(scene);
  if (lag_sim_set_tolerance(sim, tol) || lag_sim_set_method(sim, &lag_taylor_method, opt, n)) {
    printf("Bail out! %s\n", lag_sim_message(sim));
    exit(1);
  }
  return sim;
}

static void go(lag_sim *sim, double t) {
  if (lag_sim_advance(sim, t) < 0) printf("# %s\n", lag_sim_message(sim));
}

/* --- from rest --- */

/* A pendulum from 90 degrees: only the coefficients 2, 6, 10, ... of its angle are not zero. It passes the lowest
 * point after K/sqrt(g), K = K(sin 45 deg) = 1.854074677301371918433850..., at the speed sqrt(2 g). */
static void from_rest(void) {
  lag_sim *sim = start(&pendulum_wide, 1e-15, NULL, 0);
  go(sim, 1.8540746773013719184 / sqrt(9.81));
  small(lag_sim_q(sim)[0], 1e-15, "a pendulum from rest at a right angle: the angle");
  small(lag_sim_v(sim)[0] / -sqrt(2 * 9.81) - 1, 1e-15, "and its rate");
  lag_sim_free(sim);

  /* mpmath.odefun, 30 digits, from the double that is nearest to pi/2. Errors grow about a hundred times. */
  static const double y[] = {-0.5684746640159468775, -0.5263937279324087944, 6.078384885761968967,
                             -9.681360681708884608};
  lag_stats st;
  sim = start(&double_pendulum_swing, 1e-15, NULL, 0);
  go(sim, 10);
  double worst = 0;
  for (int i = 0; i < 2; i++)
    worst = fmax(worst, fmax(fabs(lag_sim_q(sim)[i] / y[i] - 1), fabs(lag_sim_v(sim)[i] / y[2 + i] - 1)));
  small(worst, 2e-13, "the double pendulum from rest at right angles");
  lag_sim_stats(sim, &st);
  check(st.rhs_calls == st.steps + st.rejected + 1, "M is factored once a step", (double)st.rhs_calls,
        (double)st.steps);
  lag_sim_free(sim);
}

/* x'' = t^8 x, x = 1 + t^10/(9 10) + t^20/(9 10 19 20) + ...: more gaps than the step rule looks at. The defect must
 * see them. */
static void gaps(void) {
  lag_sim *sim = start(&gap_go, 1e-15, NULL, 0);
  double worst = 0;
  for (double t = 0.25; t <= 3; t += 0.25) {
    long double sum = 0, term = 1;
    for (int n = 10; n < 2000; n += 10) {
      sum += term;
      term *= powl(t, 10) / ((long double)n * (n - 1));
    }
    go(sim, t);
    worst = fmax(worst, fabs(lag_sim_q(sim)[0] / (double)sum - 1));
  }
  /* x grows as exp(t^5/5): 1e21, of which rounding of t takes 1e-13 */
  small(worst, 1e-12, "a series with gaps of ten");
  lag_sim_free(sim);
}

/* --- order --- */

typedef struct {
  const char *name;
  double value;
} Setting;

/* The coordinates after a run; order 0: as the method does best. */
static void run(const lag_scene *scene, const Setting *set, double order, double h, double t, double *q) {
  const lag_option opt[] = {{"order", order, NULL}, {"step", h, NULL}, {"adapt", 0, "off"}};
  lag_sim *sim = start(scene, 1e-15, opt, order > 0 ? 3 : 0);
  for (; set->name; set++) lag_sim_set(sim, set->name, set->value);
  go(sim, t);
  memcpy(q, lag_sim_q(sim), (size_t)scene->model->nq * sizeof *q);
  lag_sim_free(sim);
}

/* The slope of the error against the step, at steps where the errors are small but well above rounding. */
static void order_on(const lag_scene *scene, const Setting *set, double t, const double *h, const char *name) {
  double exact[8], q[8], error[2], most = 0;
  run(scene, set, 0, 0, t, exact);
  for (int k = 0; k < 3; k++) {
    int p = 3 + k;
    for (int fine = 0; fine < 2; fine++) {
      run(scene, set, p, fine ? h[k] / 1.25 : h[k], t, q);
      error[fine] = 0;
      for (int i = 0; i < scene->model->nq; i++) error[fine] = fmax(error[fine], fabs(q[i] - exact[i]));
    }
    double slope = log(error[0] / error[1]) / log(1.25);
    printf("# %s: order %d measured %.3f (errors %.2g, %.2g)\n", name, p, slope, error[0], error[1]);
    most = fmax(most, fabs(slope - p));
  }
  small(most, 0.15, name);
}

/* --- runs in pieces, backwards, limits --- */

static void pieces(void) {
  lag_sim *one = start(&double_pendulum_swing, 1e-12, NULL, 0), *many = start(&double_pendulum_swing, 1e-12, NULL, 0);
  go(one, 5);
  for (int i = 1; i <= 500; i++) go(many, i * 0.01);
  check(memcmp(lag_sim_q(one), lag_sim_q(many), 2 * sizeof(double)) == 0 &&
            memcmp(lag_sim_v(one), lag_sim_v(many), 2 * sizeof(double)) == 0,
        "one run in five hundred pieces: the same bits", 0, 0);
  lag_sim_free(many);

  many = start(&double_pendulum_swing, 1e-12, NULL, 0);
  double *saved = malloc(lag_sim_save_size(many) * sizeof *saved);
  go(many, 2.345);
  lag_sim_save(many, saved);
  lag_sim_free(many);
  many = start(&double_pendulum_swing, 1e-12, NULL, 0);
  lag_sim_load(many, saved);
  go(many, 5);
  check(memcmp(lag_sim_q(one), lag_sim_q(many), 2 * sizeof(double)) == 0, "saved and resumed: the same bits", 0, 0);
  free(saved);
  lag_sim_free(one);
  lag_sim_free(many);

  /* The motion from rest is even in time. */
  one = start(&double_pendulum_swing, 1e-14, NULL, 0);
  many = start(&double_pendulum_swing, 1e-14, NULL, 0);
  go(one, 3);
  go(many, -3);
  small(lag_sim_q(one)[0] - lag_sim_q(many)[0], 1e-12, "backwards from rest: the mirror image");
  lag_sim_free(one);
  lag_sim_free(many);

  const lag_option limit = {"max_step", 0.01, NULL};
  lag_stats st;
  one = start(&pendulum_wide, 1e-9, &limit, 1);
  go(one, 2);
  lag_sim_stats(one, &st);
  check(st.steps >= 200 && st.steps <= 201, "max_step is a limit", (double)st.steps, 200);
  lag_sim_free(one);

  /* Dense output has the accuracy of the steps. Kepler's equation at t = 1 to 30 digits:
   * tests/hard/cases/kepler_e0_6.lag. */
  one = start(&kepler_orbit, 1e-15, NULL, 0);
  go(one, 1);
  small(lag_sim_q(one)[0] + 0.628948176826624230582918587818, 5e-16, "between two steps: Kepler at t = 1");
  lag_sim_free(one);
}

/* --- events --- */

typedef struct {
  double t[16];
  int n;
} Hits;

static void hit(void *context, int k, double t, const double *before, const double *after) {
  (void)before, (void)after;
  Hits *h = context;
  (void)k;
  if (h->n < 16) h->t[h->n++] = t;
}

/* A ball dropped from 1 m that keeps 0.8 of its speed: the impacts in closed form. */
static void events(void) {
  Hits h = {.n = 0};
  lag_sim *sim = start(&bouncing_ball_drop, 1e-15, NULL, 0);
  lag_sim_set(sim, "e", 0.8);
  lag_sim_set(sim, "g", 9.81);
  lag_sim_on_event(sim, hit, &h);
  go(sim, 3.6);
  double t = sqrt(2 / 9.81), between = 2 * t * 0.8, worst = h.n == 10 ? 0 : HUGE_VAL;
  for (int i = 0; i < h.n && i < 10; i++) {
    worst = fmax(worst, fabs(h.t[i] - t));
    t += between;
    between *= 0.8;
  }
  small(worst, 1e-14, "ten impacts of a ball, to rounding");
  lag_sim_free(sim);
}

/* --- rounding --- */

/* The root mean square of the error of the energy over a sample of orbits, after n periods; longest: the limit on
 * steps. */
static double energy_error(double periods, double longest) {
  enum { ORBITS = 24 };
  double sum = 0;
  for (int i = 0; i < ORBITS; i++) {
    const lag_option opt = {"max_step", longest, NULL};
    lag_sim *sim = start(&kepler_orbit, 1e-15, &opt, 1);
    lag_sim_set(sim, "e", 0.3 + 0.01 * i);
    lag_stats st;
    lag_sim_stats(sim, &st);
    double e0 = st.energy;
    go(sim, periods * 6.283185307179586);
    lag_sim_stats(sim, &st);
    sum += (st.energy / e0 - 1) * (st.energy / e0 - 1);
    lag_sim_free(sim);
  }
  return sqrt(sum / ORBITS);
}

static void rounding(void) {
  double few = energy_error(20, 100), many = energy_error(2000, 100), slope = log(many / few) / log(100);
  printf("# energy of Kepler orbits: %.2g after 20 periods, %.2g after 2000: as n^%.2f\n", few, many, slope);
  /* Half a unit in the last place a step adds up to 2^-53 sqrt(50000) = 2.5e-14; twice that is allowed, as such
   * means over 24 orbits were seen from 1.4e-14 to 3.9e-14. */
  small(many, 5e-14, "rounding after 2000 periods, 50000 steps");
  /* Short steps add little to the state each, and what that loses is kept: 4e-16 to 9e-16 are left. Lost, it is
   * 2^-53 sqrt(6300) = 9e-15. */
  small(energy_error(20, 0.02), 2e-15, "rounding of 6300 short steps is not that of their sums");
  check(slope > 0.2 && slope < 0.75, "rounding grows as the root of the number of steps, not as the number", slope,
        0.5);
}

int main(void) {
  from_rest();
  gaps();
  static const Setting swinging[] = {{"th", 1}, {"th'", 0.5}, {NULL, 0}},
                       both[] = {{"th1", 1}, {"th2", -0.4}, {"th1'", 0.7}, {NULL, 0}};
  static const Setting round[] = {{"x", 1}, {"y'", 1.1}, {NULL, 0}};
  order_on(&pendulum_wide, swinging, 3, (const double[]){0.001, 0.004, 0.01}, "order on the pendulum");
  order_on(&double_pendulum_swing, both, 2, (const double[]){0.0005, 0.001, 0.002}, "order on the double pendulum");
  order_on(&kepler_e0_6_go, round, 5, (const double[]){0.002, 0.01, 0.02}, "order on Kepler's orbit");
  pieces();
  events();
  rounding();
  printf("1..%d\n", count);
  return bad;
}
