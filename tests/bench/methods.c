/* Time against error: methods of liblag on emitted models, next to GSL's rk8pd on hand-written ones, in one run.
 *   methods          prints, for each problem and each error to be reached, the fastest setting of each method
 *
 * Every method runs at tolerances from 1e-4 to 1e-15; its time is the least of several runs, its error the largest of the
 * coordinates at the end. liblag's times are of lag_sim_advance: they include the watch on the energy at each step, which
 * GSL's do not. Linked with the emitted models; without -DBENCH_GSL there are no peers. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lag.h"
#ifdef BENCH_GSL
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#endif

extern const lag_scene double_pendulum_swing, henon_heiles_regular, kepler_hundred, kepler_narrow, outer_planets_years;

enum { MOST = 64 };

typedef struct {
  const char *name;
  const lag_scene *scene;
  int (*f)(double t, const double *y, double *dy, void *p); /* the same by hand */
  double t;
  const double *exact; /* coordinates; where from: see below */
  double errors[3];    /* to be reached; 0: no more */
  double least_tol;
} Problem;

/* ---- the same by hand ---- */

static int double_pendulum(double t, const double *y, double *d, void *p) {
  const double g = 9.81, delta = y[0] - y[1], s = sin(delta), c = cos(delta);
  const double f1 = -s*y[3]*y[3] - 2*g*sin(y[0]), f2 = s*y[2]*y[2] - g*sin(y[1]), det = 1/(2 - c*c);
  (void)t, (void)p;
  d[0] = y[2], d[1] = y[3], d[2] = (f1 - c*f2)*det, d[3] = (2*f2 - c*f1)*det;
  return 0;
}

static int henon_heiles(double t, const double *y, double *d, void *p) {
  (void)t, (void)p;
  d[0] = y[2], d[1] = y[3], d[2] = -y[0] - 2*y[0]*y[1], d[3] = -y[1] - y[0]*y[0] + y[1]*y[1];
  return 0;
}

static int kepler(double t, const double *y, double *d, void *p) {
  const double r2 = y[0]*y[0] + y[1]*y[1], k = -1/(r2*sqrt(r2));
  (void)t, (void)p;
  d[0] = y[2], d[1] = y[3], d[2] = k*y[0], d[3] = k*y[1];
  return 0;
}

static int planets(double t, const double *y, double *d, void *p) {
  static const double m[6] = {1.00000597682, 0.000954786104043, 0.000285583733151, 0.0000437273164546, 0.0000517759138449, 1/1.3e8};
  const double G = 2.95912208286e-4;
  (void)t, (void)p;
  for (int i = 0; i < 18; i++) d[i] = y[18 + i], d[18 + i] = 0;
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < i; j++) {
      const double x[3] = {y[3*i] - y[3*j], y[3*i + 1] - y[3*j + 1], y[3*i + 2] - y[3*j + 2]}, r2 = x[0]*x[0] + x[1]*x[1] + x[2]*x[2], k = G/(r2*sqrt(r2));
      for (int c = 0; c < 3; c++) d[18 + 3*i + c] -= m[j]*k*x[c], d[18 + 3*j + c] += m[i]*k*x[c];
    }
  return 0;
}

/* mpmath.odefun in 30 digits, from the double nearest to pi/2. */
static const double at_double_pendulum[] = {-0.5684746640159468775, -0.5263937279324087944};
/* Taylor series in quadruple precision, orders 40 and 45, which agree to 25 digits and more. */
static const double at_henon_heiles[] = {-0.1502491465785045186567, -0.2968890649442036631256};
static const double at_planets[] = {
#include "planets.h"
};
/* 100 periods, and five and a half: back at the pericentre; at the apocentre. */
static const double at_kepler[] = {0.4, 0}, at_narrow[] = {-1.9, 0};

static const Problem problems[] = {
  {"double pendulum, th1 = th2 = pi/2, to t = 10", &double_pendulum_swing, double_pendulum, 10, at_double_pendulum, {1e-6, 1e-9, 1e-12}, 1e-15},
  {"Henon-Heiles, E = 1/8, to t = 1000", &henon_heiles_regular, henon_heiles, 1000, at_henon_heiles, {1e-6, 1e-11, 0}, 1e-15},
  {"Kepler, e = 0.6, 100 periods", &kepler_hundred, kepler, 628.31853071795864769, at_kepler, {1e-5, 1e-10, 0}, 1e-15},
  {"Kepler, e = 0.9, 5.5 periods", &kepler_narrow, kepler, 34.557519189487725623, at_narrow, {1e-8, 0, 0}, 1e-15},
  {"outer planets, 10^4 years", &outer_planets_years, planets, 3652500, at_planets, {2e-9, 5e-6, 0}, 1e-15},
};
enum { N_PROBLEMS = sizeof problems/sizeof *problems };

/* ---- one run ---- */

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9*(double)t.tv_nsec;
}

static double error_at(const Problem *p, const double *q) {
  double worst = 0;
  for (int i = 0; i < p->scene->model->nq; i++) worst = fmax(worst, fabs(q[i] - p->exact[i]));
  return worst;
}

typedef double runner(const Problem *p, double tol, const char *method, double *error);

static const lag_method *find(const char *name) {
  for (int i = 0; i < lag_nmethods; i++)
    if (strcmp(lag_methods[i]->name, name) == 0) return lag_methods[i];
  return NULL;
}

static double run_liblag(const Problem *p, double tol, const char *name, double *error) {
  const lag_option opt = {"max_step", p->t, NULL};
  lag_sim *sim = lag_sim_new(p->scene);
  if (lag_sim_set_tolerance(sim, tol) || lag_sim_set_method(sim, find(name), &opt, 1)) exit(1);
  double t0 = now();
  int rc = lag_sim_advance(sim, p->t);
  double t = now() - t0;
  *error = rc ? HUGE_VAL : error_at(p, lag_sim_q(sim));
  lag_sim_free(sim);
  return t;
}

#ifdef BENCH_GSL
static double run_gsl(const Problem *p, double tol, const char *name, double *error) {
  lag_sim *sim = lag_sim_new(p->scene);
  int n = 2*p->scene->model->nq;
  double y[MOST], t = 0;
  (void)name;
  memcpy(y, lag_sim_q(sim), (size_t)n*sizeof *y); /* q and v stand side by side */
  lag_sim_free(sim);
  gsl_odeiv2_system system = {p->f, NULL, (size_t)n, NULL};
  double t0 = now();
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, p->t*1e-4, tol, tol);
  int rc = gsl_odeiv2_driver_apply(d, &t, p->t, y);
  double took = now() - t0;
  gsl_odeiv2_driver_free(d);
  *error = rc ? HUGE_VAL : error_at(p, y);
  return took;
}
#endif

/* ---- all of them ---- */

typedef struct {
  const char *label, *method;
  runner *run;
  double time[40], error[40], tol[40];
  int n;
} Series;

static void measure(const Problem *p, Series *s) {
  s->n = 0;
  for (double tol = 1e-4; tol >= p->least_tol*0.9; tol /= sqrt(10), s->n++) {
    double best = HUGE_VAL, spent = 0;
    for (int i = 0; i < 200 && (i < 3 || spent < 0.05); i++) {
      double t = s->run(p, fmax(tol, p->least_tol), s->method, &s->error[s->n]);
      best = fmin(best, t);
      spent += t;
    }
    s->time[s->n] = best;
    s->tol[s->n] = tol;
  }
}

/* The fastest setting whose error is at most that; -1: none. */
static int fastest(const Series *s, double error) {
  int best = -1;
  for (int i = 0; i < s->n; i++)
    if (s->error[i] <= error && (best < 0 || s->time[i] < s->time[best])) best = i;
  return best;
}

int main(void) {
  static Series series[] = {
#ifdef BENCH_GSL
    {.label = "GSL rk8pd, by hand", .run = run_gsl},
#endif
    {.label = "dop853", .method = "dop853", .run = run_liblag},
    {.label = "taylor", .method = "taylor", .run = run_liblag},
  };
  enum { N_SERIES = sizeof series/sizeof *series };
#ifdef BENCH_GSL
  gsl_set_error_handler_off();
#endif
  for (int i = 0; i < N_PROBLEMS; i++) {
    const Problem *p = &problems[i];
    printf("%s\n", p->name);
    for (int k = 0; k < N_SERIES; k++) measure(p, &series[k]);
    for (int e = 0; e < 3 && p->errors[e] > 0; e++) {
      printf("  error %.0e: ", p->errors[e]);
      int first = fastest(&series[0], p->errors[e]);
      for (int k = 0; k < N_SERIES; k++) {
        int at = fastest(&series[k], p->errors[e]);
        if (at < 0) printf("%s%s does not reach it", k ? ", " : "", series[k].label);
        else printf("%s%s %.3g ms", k ? ", " : "", series[k].label, 1e3*series[k].time[at]);
        if (k && at >= 0 && first >= 0) printf(" (%.2f)", series[k].time[at]/series[0].time[first]);
      }
      putchar('\n');
    }
  }
  return 0;
}
