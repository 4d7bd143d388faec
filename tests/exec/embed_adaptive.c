/* Adaptive steps over lanes: the emitted header all.h makes LANES motions at once, one.h the same ones by one, each
 * with a start, parameters and ends of its own, the last one backwards; lane 1 has an end that is no number, or with
 * SINGULAR parameters of 0. METHOD: rk45 or dop853, or taylor with TAYLOR; GIVEN: `, NULL` for a model with inputs;
 * TOL: the tolerance. Lane 2 rests in the first part, and without HOLD its state is 0. Exit status 0 when each lane
 * has the bits of its motion alone: state, number of steps, memory of the method. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#define ALL_LANES LANES
#define ALL_STATIC
#include "all.h"

#define ONE_STATIC
#define ONE_AS_LANES 1 /* sines by the polynomials of lanes */
#include "one.h"

#define STEP_3(prefix, method) prefix##_##method##_step
#define STEP_2(prefix, method) STEP_3(prefix, method)
#define STEP(prefix) STEP_2(prefix, METHOD)
#ifndef TOL
#define TOL 1e-9
#endif
#ifndef GIVEN
#define GIVEN
#endif
#ifdef TAYLOR
typedef one_taylor one_memory;
typedef all_taylor all_memory;
#define FORCE(w, k) ((w)->last k = -1) /* no try came before it */
#define NEXT unit /* and noise, step, last */
#define BEGIN(prefix, w, tolerance) prefix##_taylor_begin(w, tolerance, 0)
#else
typedef one_adaptive one_memory;
typedef all_adaptive all_memory;
#define FORCE(w, k) ((void)(w))
#define NEXT step /* and memory */
#define BEGIN(prefix, w, tolerance) prefix##_adaptive_begin(w, tolerance)
#endif

#ifdef TAYLOR
enum { KEPT = 4 };
#else
enum { KEPT = 2 };
#endif
enum { NUMBERS = 2 + 2*ONE_NY, BROKEN = 1, RESTS = 2, MOST = 100000 };

/* The first step of lane k to try: 0, found by the method; or too long, so that tries follow each other. A lane that
 * rests keeps it. */
static double first_of(int k) { return k % 2 || k == RESTS ? 0.3*(1 + k) : 0; }

static double end_of(int k, int part) {
  return k == RESTS && part == 1 ? 0 : (k == LANES - 1 ? -0.1 : 1) * (0.7 * part + 0.11 * k * part);
}

/* Number i that lane k of a method keeps between steps. */
static double kept(const all_memory *w, int i, int k) { return (&w->NEXT)[i][k]; }

/* A number of lane k of a state or of parameters. */
static double get(const ALL_REAL *x, int i, int k) { return x[i][k]; }

static void start(int k, one_params *p, one_state *s) {
  one_defaults(p);
  for (int i = 0; i < ONE_NP; i++) *one_param(p, i) *= 1 + 0.01*k;
  (void)one_start(p, s);
#ifdef SINGULAR
  for (int i = 0; i < ONE_NP && k == BROKEN; i++) *one_param(p, i) = 0;
#endif
  for (int i = 1; i <= ONE_NY; i++) ((double *)s)[i] *= 1 + 0.02*k;
#ifdef HOLD
  (void)one_hold(p, s GIVEN);
#else
  for (int i = 1; i <= ONE_NY && k == RESTS; i++) ((double *)s)[i] = 0;
#endif
}

/* Number of steps, or minus that, where the motion failed. */
static int alone(int k, one_state *s, one_memory *w) {
  one_params p;
  int steps = 0;
  start(k, &p, s);
  BEGIN(one, w, TOL);
  w->step = first_of(k);
  FORCE(w, );
  for (int part = 1; part <= 2; part++) {
    const double end = k == BROKEN && part == 2 ? (double)NAN : end_of(k, part);
    for (; !(s->t == end); steps++)
      if (steps == MOST || STEP(one)(&p, s, w, end GIVEN) != ONE_OK) return -steps - 1;
  }
  return steps;
}

static void together(all_state *s, all_memory *w, int *steps) {
  static all_memory begun;
  all_params p;
  ALL_REAL end = {0};
  all_defaults(&p);
  BEGIN(all, w, ALL_C(TOL));
  for (int k = 0; k < LANES; k++) {
    one_params q;
    one_state from;
    start(k, &q, &from);
    for (int i = 0; i < ONE_NP; i++) (*all_param(&p, i))[k] = *one_param(&q, i);
    for (int i = 0; i < NUMBERS; i++) ((ALL_REAL *)s)[i][k] = ((double *)&from)[i];
    w->step[k] = first_of(k);
    FORCE(w, [k]);
    steps[k] = 0;
  }
  begun = *w;
  for (int part = 1; part <= 2; part++) {
    for (int k = 0; k < LANES; k++)
      end[k] = steps[k] < 0 ? s->t[k] : k == BROKEN && part == 2 ? (double)NAN : end_of(k, part);
    for (int turn = 0; turn < MOST; turn++) {
      const ALL_REAL before = s->t;
      const int status = STEP(all)(&p, s, w, end GIVEN);
      int rests = 1;
#ifdef SINGULAR
      if (part == 1 && turn == 0 && status != -(1 << BROKEN))
        printf("lane %d is singular; the status is %d\n", BROKEN, status), steps[BROKEN] = MOST;
#endif
      for (int k = 0; k < LANES; k++) {
        steps[k] += s->t[k] < before[k] || s->t[k] > before[k];
        if (-status >> k & 1) end[k] = s->t[k], steps[k] = -steps[k] - 1; /* the others go on */
        rests &= s->t[k] == end[k];
      }
      if (rests) break;
    }
    for (int i = 0; i < KEPT && part == 1; i++)
      if (kept(w, i, RESTS) != kept(&begun, i, RESTS))
        printf("lane %d rests, and number %d of its memory is %g\n", RESTS, i, kept(w, i, RESTS)), steps[RESTS] = MOST;
  }
}

#ifdef TAYLOR
/* Lanes have one order, of the least tolerance. */
static int wrong_order(void) {
  static all_taylor w;
  static one_taylor v;
  ALL_REAL tolerance;
  for (int k = 0; k < LANES; k++) tolerance[k] = k ? 1e-3 : 1e-12;
  all_taylor_begin(&w, tolerance, 0);
  one_taylor_begin(&v, 1e-12, 0);
  return w.order != v.order;
}
#else
static int wrong_order(void) { return 0; }
#endif

int main(void) {
  all_state s;
  all_memory w;
  int steps[LANES], bad = wrong_order();
  together(&s, &w, steps);
  for (int k = 0; k < LANES; k++) {
    one_state t;
    one_memory v;
    const int n = alone(k, &t, &v);
    int same = n == steps[k] && (k == BROKEN) == (n < 0);
    for (int i = 0; i < KEPT && n >= 0; i++) {
      const double x = kept(&w, i, k);
      same &= memcmp(&x, &(&v.NEXT)[i], sizeof x) == 0;
    }
    for (int i = 0; i < NUMBERS; i++) {
      const double x = get((const ALL_REAL *)&s, i, k);
      same &= memcmp(&x, &((double *)&t)[i], sizeof x) == 0;
    }
    if (same) continue;
    printf("lane %d: %d steps, %d alone; t %.17g %.17g; number 1: %.17g, %.17g alone\n", k, steps[k], n, s.t[k], t.t,
           get((const ALL_REAL *)&s, 1, k), ((double *)&t)[1]);
    bad = 1;
  }
  return bad;
}
