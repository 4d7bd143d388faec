/* Time against error: methods of liblag on emitted models, next to integrators of others on hand-written ones, in
 * one run.
 *   methods [own] prints, for each problem and each error to be reached, the fastest setting of each method; own:
 *   only
 *                    liblag's, rk8pd and dop853 inlined by hand
 *
 * Every method runs at tolerances from 1e-4 to 1e-15 until the smallest error is reached, or it takes seconds; its
 * time is the least of several runs, its error the largest of the coordinates at the end. The chains, whose motion
 * is chaotic, run at one tolerance. liblag's times are of lag_sim_advance: they include the watch on the energy at
 * each step, which those of others do not. Linked with the emitted models; a peer is there when its BENCH_ macro is
 * defined. In brackets: the time over rk8pd's, and over that of dop853 inlined by hand. */
#include "methods.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"

extern const lag_scene double_pendulum_swing, henon_heiles_regular, kepler_hundred, kepler_narrow, outer_planets_years,
    chain_10_swing, chain_20_swing, oscillators_go;
int linear_10(double t, const double *q, const double *v, const double *z, const double *p, const double *u, double *a,
              double *zd, double *w);
int linear_20(double t, const double *q, const double *v, const double *z, const double *p, const double *u, double *a,
              double *zd, double *w);

typedef struct {
  const char *label;
  const lag_scene *scene;
  int by_hand;
  bench_rhs *f; /* the same by hand */
  double t;
  const double *exact; /* coordinates; where from: see below */
  double errors[3];    /* to be reached; 0: no more */
  double only_tol;     /* not 0: no errors, but this tolerance */
} Problem;

static const double masses_lengths_g[41] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,   1,
                                            1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 9.81};

int by_hand_chain_10(double t, const double *y, double *d, void *p) {
  (void)p;
  memcpy(d, y + 10, 10*sizeof *d);
  return linear_10(t, y, y + 10, NULL, masses_lengths_g + 20, NULL, d + 10, NULL, NULL);
}
int by_hand_chain_20(double t, const double *y, double *d, void *p) {
  (void)p;
  memcpy(d, y + 20, 20*sizeof *d);
  return linear_20(t, y, y + 20, NULL, masses_lengths_g, NULL, d + 20, NULL, NULL);
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
    {"double pendulum, th1 = th2 = pi/2, to t = 10",
     &double_pendulum_swing, DOUBLE_PENDULUM, by_hand_double_pendulum, 10, at_double_pendulum, {1e-6, 1e-9, 1e-12},
     0},
    {"Henon-Heiles, E = 1/8, to t = 1000",
     &henon_heiles_regular, HENON_HEILES, by_hand_henon_heiles, 1000, at_henon_heiles, {1e-6, 1e-11, 0},
     0},
    {"Kepler, e = 0.6, 100 periods",
     &kepler_hundred, KEPLER, by_hand_kepler, 628.31853071795864769, at_kepler, {1e-5, 1e-10, 0},
     0},
    {"Kepler, e = 0.9, 5.5 periods",
     &kepler_narrow, KEPLER, by_hand_kepler, 34.557519189487725623, at_narrow, {1e-8, 0, 0},
     0},
    {"outer planets, 10^4 years",
     &outer_planets_years, PLANETS, by_hand_planets, 3652500, at_planets, {5e-6, 2e-9, 0},
     0},
    {"chain of 10 rods, to t = 10", &chain_10_swing, CHAIN_10, by_hand_chain_10, 10, NULL, {0}, 1e-12},
    {"chain of 20 rods, to t = 10", &chain_20_swing, CHAIN_20, by_hand_chain_20, 10, NULL, {0}, 1e-12},
};
enum { N_PROBLEMS = sizeof problems/sizeof *problems };

/* ---- one run ---- */

static double error_at(const Problem *p, const double *q) {
  double worst = 0;
  for (int i = 0; p->exact && i < p->scene->model->nq; i++) worst = fmax(worst, fabs(q[i] - p->exact[i]));
  return worst;
}

static const lag_method *find(const char *name) {
  for (int i = 0; i < lag_nmethods; i++)
    if (strcmp(lag_methods[i]->name, name) == 0) return lag_methods[i];
  return NULL;
}

/* The state at p->t in y; *calls: of the right-hand side. blind: nothing is watched. */
static double run_liblag(const Problem *p, double tol, const char *name, int blind, double *y, double *calls) {
  const lag_option opt = {"max_step", p->t, NULL};
  lag_model model = *p->scene->model;
  lag_scene scene = *p->scene;
  if (blind) model.energy = NULL;
  scene.model = &model;
  lag_sim *sim = lag_sim_new(&scene);
  lag_stats stats;
  if (lag_sim_set_tolerance(sim, tol) || lag_sim_set_method(sim, find(name), &opt, 1)) exit(1);
  double t0 = bench_now();
  int rc = lag_sim_advance(sim, p->t);
  double took = bench_now() - t0;
  memcpy(y, lag_sim_q(sim), (size_t)p->scene->model->nq*sizeof *y);
  lag_sim_stats(sim, &stats);
  *calls = (double)stats.rhs_calls;
  lag_sim_free(sim);
  return rc ? -1 : took;
}

typedef struct {
  const char *label, *method; /* method: of liblag */
  bench_peer *peer;
  int blind;  /* with nothing watched: for the overhead alone */
  int own;    /* runs with `own`, too */
  int chains; /* only for chains */
  double time[60], error[60];
  int n;
} Series;

static double run(const Problem *p, const Series *s, double tol, double *error) {
  double y[BENCH_MOST], calls, took;
  if (s->method) {
    took = run_liblag(p, tol, s->method, s->blind, y, &calls);
  } else {
    lag_sim *sim = lag_sim_new(p->scene);
    int n = 2*p->scene->model->nq;
    memcpy(y, lag_sim_q(sim), (size_t)n*sizeof *y); /* q and v stand side by side */
    lag_sim_free(sim);
    took = s->peer(p->by_hand, p->f, n, p->t, tol, y);
  }
  *error = took < 0 ? HUGE_VAL : error_at(p, y);
  return took;
}

/* ---- all of them ---- */

static void measure(const Problem *p, Series *s) {
  double least = 0;
  int failed = 0;
  for (int e = 0; e < 3 && p->errors[e] > 0; e++) least = p->errors[e];
  s->n = 0;
  for (double tol = p->only_tol > 0 ? p->only_tol : 1e-4; tol >= 0.9e-15; tol /= pow(10, 0.25)) {
    double best = HUGE_VAL, spent = 0;
    for (int i = 0; i < 100 && (i < 2 || spent < 0.02) && spent < 0.2; i++) {
      double t = run(p, s, fmax(tol, 1e-15), &s->error[s->n]);
      if (t < 0) break; /* it failed: too large steps, or too many */
      best = fmin(best, t);
      spent += t;
    }
    failed = best == HUGE_VAL ? failed + 1 : 0;
    s->time[s->n++] = best;
    if (p->only_tol > 0 || spent > 0.5 || failed > 4 ||
        (s->n > 2 && s->error[s->n - 1] < least / 3 && s->error[s->n - 2] < least / 3))
      break;
  }
}

/* The fastest setting whose error is at most that; -1: none. */
static int fastest(const Series *s, double error) {
  int best = -1;
  for (int i = 0; i < s->n; i++)
    if (s->error[i] <= error && s->time[i] < HUGE_VAL && (best < 0 || s->time[i] < s->time[best])) best = i;
  return best;
}

/* first: rk8pd, or NULL; second: dop853 inlined by hand; both have been measured. */
static void print_row(const Problem *p, const Series *s, const Series *first, const Series *second) {
  printf("  %-28s", s->label);
  for (int e = 0; e < 3 && (e == 0 || p->errors[e] > 0); e++) {
    double error = p->only_tol > 0 ? HUGE_VAL : p->errors[e];
    char ratios[40] = "", *end = ratios;
    int at = fastest(s, error);
    for (int k = 0; k < 2 && at >= 0; k++) {
      const Series *peer = k == 0 ? first : second;
      int one = peer && peer != s && peer->n ? fastest(peer, error) : -1;
      if (one >= 0) end += sprintf(end, "%s%4.2f", end > ratios ? ", " : "(", s->time[at]/peer->time[one]);
    }
    if (at < 0) printf("  %9s %-12s", "-", "");
    else printf("  %9.3g %s%-*s", 1e3*s->time[at], ratios, (int)(12 - (end - ratios)), end > ratios ? ")" : "");
  }
  putchar('\n');
}

/* Calls of right-hand sides, counted. */
static double per_call;
static int counted_oscillators(double t, const double *y, double *d, void *p) {
  return per_call++, by_hand_oscillators(t, y, d, p);
}
static int counted_pendulum(double t, const double *y, double *d, void *p) {
  return per_call++, by_hand_double_pendulum(t, y, d, p);
}

/* Seconds that a call takes where each waits for the last, as stages do: y += 1e-9 f(y), and nothing else. */
static double waiting_call(const Problem *p, bench_rhs *f) {
  const lag_model *m = p->scene->model;
  lag_sim *sim = lag_sim_new(p->scene);
  double y[BENCH_MOST], d[BENCH_MOST], work[200], best = HUGE_VAL;
  int n = m->nq;
  for (int r = 0; r < 500; r++) {
    memcpy(y, lag_sim_q(sim), 2*(size_t)n*sizeof *y);
    double t0 = bench_now();
    for (int k = 0; k < 1000; k++) {
      if (f) f(0, y, d, NULL);
      else memcpy(d, y + n, (size_t)n * sizeof *d), m->accel(m, 0, y, y + n, y + 2 * n, work, NULL, d + n, NULL, work);
      for (int i = 0; i < 2*n; i++) y[i] += 1e-9*d[i];
    }
    best = fmin(best, (bench_now() - t0)/1000);
  }
  lag_sim_free(sim);
  return best;
}

/* Nanoseconds that a call takes in a run, and what of it a call alone does not take. */
static void print_overhead(const Series *s, const Problem *p, bench_rhs *f, double tol) {
  double y[BENCH_MOST], best = HUGE_VAL, error, calls = 0;
  for (int i = 0; i < 50; i++) {
    per_call = 0;
    double t = s->method ? run_liblag(p, tol, s->method, s->blind, y, &calls) : run(p, s, tol, &error);
    if (t < 0) return;
    best = fmin(best, t);
  }
  calls = s->method ? calls : per_call;
  if (calls > 0)
    printf("  %-28s  %7.1f  %7.1f\n", s->label, 1e9 * best / calls,
           1e9 * (best / calls - waiting_call(p, s->method ? NULL : f)));
}

int main(int argc, char **argv) {
  static Series series[] = {
#ifdef BENCH_GSL
    {.label = "GSL rk8pd", .peer = peer_rk8pd, .own = 1},
#endif
    {.label = "dop853 inlined by hand", .peer = peer_inlined, .own = 1},
#ifdef BENCH_SYMPY
    {.label = "the same, with SymPy's C", .peer = peer_sympy, .chains = 1},
#endif
#ifdef BENCH_ODEINT
    {.label = "Boost.odeint rkf78", .peer = peer_odeint},
#endif
#ifdef BENCH_SUNDIALS
    {.label = "SUNDIALS CVODE Adams", .peer = peer_adams},
    {.label = "SUNDIALS ARKODE 8", .peer = peer_arkode},
#endif
    {.label = "lagc dop853", .method = "dop853", .own = 1},
    {.label = "the same, nothing watched", .method = "dop853", .blind = 1, .own = 1},
    {.label = "lagc taylor", .method = "taylor", .own = 1},
  };
  enum { N_SERIES = sizeof series/sizeof *series };
  int own = argc > 1 && strcmp(argv[1], "own") == 0;
  for (int i = 0; i < N_PROBLEMS; i++) {
    const Problem *p = &problems[i], *shown = p;
    const Series *first = strcmp(series[0].label, "GSL rk8pd") == 0 ? &series[0] : NULL,
                 *second = first ? &series[1] : &series[0];
    for (int k = 0; k < N_SERIES; k++) series[k].n = 0;
    printf("%s: milliseconds to an error of", shown->label);
    for (int e = 0; e < 3 && p->errors[e] > 0; e++) printf(" %.0e", p->errors[e]);
    printf(p->only_tol > 0 ? " any size at tolerance %.0e\n" : "\n", p->only_tol);
    for (int k = 0; k < N_SERIES; k++) {
      if ((own && !series[k].own) || (series[k].chains && p->only_tol == 0) || series[k].blind) continue;
      measure(p, &series[k]);
      print_row(p, &series[k], &series[k] == first ? NULL : first, second);
      fflush(stdout);
    }
  }
  static const Problem small[] = {
      {"two oscillators, whose right-hand side is 2 negations",
       &oscillators_go, OSCILLATORS, counted_oscillators, 1000, NULL, {0},
       0},
      {"double pendulum", &double_pendulum_swing, DOUBLE_PENDULUM, counted_pendulum, 10, NULL, {0}, 0},
  };
  bench_rhs *const alone[] = {by_hand_oscillators, by_hand_double_pendulum};
  for (int i = 0; i < 2; i++) {
    printf("%s, tolerance 1e-10: nanoseconds a call, all in all, and beyond those of a call alone that waits for the "
           "last one\n",
           small[i].label);
    for (int k = 0; k < N_SERIES; k++)
      if ((!own || series[k].own) && !(series[k].method && strcmp(series[k].method, "taylor") == 0))
        print_overhead(&series[k], &small[i], alone[i], 1e-10);
  }
  return 0;
}
