/* The method gauss on Lagrangians that are linear in the velocities, by closed forms and by what the exact motion
 * keeps: first_order TEST. Linked with the emitted scenes pair, three (tests/hard/cases), cycle
 * (models/lotka_volterra.lag) and banana (models/guiding_centre.lag). Prints TAP. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"

extern const lag_scene vortex_pair_go, vortices_3_go, lotka_volterra_cycle, guiding_centre_banana;

enum { MOST = 8 };
static const double PI = 3.14159265358979323846;
static int tests, bad;

static void check(int ok, const char *what, double got, double limit) {
  printf("%sok %d - %s: %.3g, limit %.3g\n", ok ? "" : "not ", ++tests, what, got, limit);
  bad |= !ok;
}

static const lag_method *method(const char *name) {
  for (int i = 0; i < lag_nmethods; i++)
    if (strcmp(lag_methods[i]->name, name) == 0) return lag_methods[i];
  exit(2);
}

/* A run of steps of size h by gauss with so many stages, 0: by rk4. */
static lag_sim *open_run(const lag_scene *scene, int stages, double h) {
  lag_sim *sim = lag_sim_new(scene);
  const lag_option opt[] = {{"step", h, NULL}, {"stages", stages, NULL}};
  if (!sim || lag_sim_set_method(sim, method(stages ? "gauss" : "rk4"), opt, stages ? 2 : 1)) {
    printf("Bail out! %s\n", sim ? lag_sim_message(sim) : "no simulation");
    exit(2);
  }
  return sim;
}

static void go(lag_sim *sim, double t) {
  if (lag_sim_advance(sim, t) == LAG_OK) return;
  printf("Bail out! %s\n", lag_sim_message(sim));
  exit(2);
}

/* The error of the pair at t: it turns by 1/pi a second at a distance of 1/2. */
static double pair_error(int stages, double h, double t) {
  lag_sim *sim = open_run(&vortex_pair_go, stages, h);
  go(sim, t);
  const double *z = lag_sim_z(sim); /* x1, x2, y1, y2 */
  double error = hypot(z[0] - cos(t / PI) / 2, z[2] - sin(t / PI) / 2);
  lag_sim_free(sim);
  return error;
}

/* Orders 2, 4, 6, 8, by steps whose errors stand far above rounding; the third test is between steps. */
static void orders(void) {
  static const double h[] = {0.5, 1, 2, 4};
  for (int s = 1; s <= 4; s++) {
    char what[80];
    double order = log2(pair_error(s, h[s - 1], 40) / pair_error(s, h[s - 1] / 2, 40));
    snprintf(what, sizeof what, "%d stages: order less %d", s, 2 * s);
    /* the next power of h is the second: (h/pi)^2/4 < 0.5 of 1 in log2 */
    check(fabs(order - 2 * s) < 0.15, what, fabs(order - 2 * s), 0.15);
    order = log2(pair_error(s, h[s - 1], 40 + 0.3 * h[s - 1]) / pair_error(s, h[s - 1] / 2, 40 + 0.15 * h[s - 1]));
    snprintf(what, sizeof what, "%d stages: order between steps less %d", s, 2 * s);
    check(fabs(order - 2 * s) < 0.35, what, fabs(order - 2 * s), 0.35);
  }
}

/* omega of three vortices: G_i (dx_i ^ dy_i), x before y. */
static double form(const double *a, const double *b) {
  static const double G[] = {1, 2, -0.5};
  double sum = 0;
  for (int i = 0; i < 3; i++) sum += G[i] * (a[i] * b[3 + i] - a[3 + i] * b[i]);
  return sum;
}

/* The largest change of omega on the columns of the tangent, over its entries' size. */
static double form_change(int stages, double h, double t) {
  lag_sim *sim = open_run(&vortices_3_go, stages, h);
  double Y[36] = {0}, worst = 0, size = 1;
  for (int i = 0; i < 6; i++) Y[7 * i] = 1;
  if (lag_sim_set_tangent(sim, 6, Y)) exit(2);
  go(sim, t);
  lag_sim_tangent(sim, Y);
  for (int i = 0; i < 36; i++) size = fmax(size, Y[i] * Y[i]);
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) {
      double a[6], b[6], e[6] = {0}, f[6] = {0};
      for (int k = 0; k < 6; k++) a[k] = Y[6 * k + i], b[k] = Y[6 * k + j];
      e[i] = f[j] = 1;
      worst = fmax(worst, fabs(form(a, b) - form(e, f)));
    }
  lag_sim_free(sim);
  return worst / size;
}

static void symplectic(void) {
  for (int s = 1; s <= 4; s++)
    check(form_change(s, 0.25, 25) < 1e-13, "the step keeps the two-form of three vortices", form_change(s, 0.25, 25),
          1e-13);
  check(form_change(2, 0.25, 25.1) < 1e-13, "so does a part of a step", form_change(2, 0.25, 25.1), 1e-13);
  check(form_change(0, 0.25, 25) > 1e-9, "this test sees that rk4 does not", form_change(0, 0.25, 25), 1e-9);
}

/* Energies of a long run by blocks: mean over each tenth, and how far it swings. */
typedef struct {
  double mean[10], swing;
} Energies;

static Energies energies(const lag_scene *scene, int stages, double h, int steps,
                         double (*energy)(const double *z, const double *p)) {
  lag_sim *sim = open_run(scene, stages, h);
  Energies e = {{0}, 0};
  double first = 0;
  for (int i = 0; i < steps; i++) {
    go(sim, (i + 1) * h);
    double now = energy(lag_sim_z(sim), lag_sim_p(sim));
    if (i == 0) first = now;
    e.mean[(long long)i * 10 / steps] += (now - first) / (steps / 10);
    e.swing = fmax(e.swing, fabs(now - first));
  }
  lag_sim_free(sim);
  return e;
}

/* The slope of the means by least squares over the whole run, relative to the swing. */
static double trend(const Energies *e) {
  double sum = 0, norm = 0;
  for (int i = 0; i < 10; i++) {
    sum += (i - 4.5) * e->mean[i];
    norm += (i - 4.5) * (i - 4.5);
  }
  return fabs(10 * sum / norm) / e->swing;
}

static double of_three(const double *z, const double *p) {
  double H = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < i; j++) {
      double dx = z[i] - z[j], dy = z[3 + i] - z[3 + j];
      H += p[i] * p[j] * log(dx * dx + dy * dy) / (4 * PI);
    }
  return H;
}

static double of_cycle(const double *z, const double *p) {
  (void)p;
  return z[0] - log(z[0]) + z[1] - log(z[1]);
}

static double of_banana(const double *z, const double *p) { /* R z phi u; q mu */
  double x = z[0] - 1;
  return z[3] * z[3] / 2 + p[1] * sqrt(1 + (x * x + z[1] * z[1]) / (p[0] * p[0])) / z[0];
}

/* 1e5 steps so long that the energy swings by far more than rounding; a trend would be seen among the means of
 * tenths. What is left is that a tenth holds no whole number of swings: some hundred of them, so below 1e-2. rk4
 * shows that a trend is found. */
static void long_runs(void) {
  static const struct {
    const char *name;
    const lag_scene *scene;
    double (*energy)(const double *z, const double *p);
    int stages;
    double h, limit;
  } runs[] = {
    {"three vortices, 1 stage", &vortices_3_go, of_three, 1, 0.2, 0.02},
    {"three vortices, 2 stages", &vortices_3_go, of_three, 2, 0.5, 0.02},
    {"hunters and prey, 1 stage", &lotka_volterra_cycle, of_cycle, 1, 0.1, 0.02},
    {"hunters and prey, 2 stages", &lotka_volterra_cycle, of_cycle, 2, 0.2, 0.02},
    {"a guiding centre, 2 stages", &guiding_centre_banana, of_banana, 2, 1000, 0.02},
  };
  for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
    Energies e = energies(runs[i].scene, runs[i].stages, runs[i].h, 100000, runs[i].energy);
    char what[120];
    snprintf(what, sizeof what, "%s: energy over 1e5 steps, its swing %.1e, trend over swing", runs[i].name, e.swing);
    check(e.swing > 0 && trend(&e) < runs[i].limit, what, trend(&e), runs[i].limit);
  }
  Energies e = energies(&vortices_3_go, 0, 0.2, 100000, of_three);
  check(trend(&e) > 0.5, "this test sees the trend of rk4", trend(&e), 0.5);
}

/* sum G_i x_i, sum G_i y_i, sum G_i (x_i^2 + y_i^2): for steps of any size. 1e4 steps round by 1e-16 each, at
 * random. */
static void invariants(void) {
  lag_sim *sim = open_run(&vortices_3_go, 2, 0.5);
  double first[3] = {0}, worst = 0;
  for (int i = 0; i <= 10000; i += 100) {
    go(sim, 0.5 * i);
    const double *z = lag_sim_z(sim), *G = lag_sim_p(sim);
    double now[3] = {0};
    for (int k = 0; k < 3; k++) {
      now[0] += G[k] * z[k];
      now[1] += G[k] * z[3 + k];
      now[2] += G[k] * (z[k] * z[k] + z[3 + k] * z[3 + k]);
    }
    for (int k = 0; k < 3; k++) {
      if (i == 0) first[k] = now[k];
      worst = fmax(worst, fabs(now[k] - first[k]));
    }
  }
  lag_sim_free(sim);
  check(worst < 1e-13, "impulse and angular impulse over 1e4 long steps", worst, 1e-13);
}

int main(void) {
  orders();
  symplectic();
  invariants();
  long_runs();
  printf("1..%d\n", tests);
  return bad;
}
