/* What accuracy costs: a scene run by many settings of many methods, its errors against a reference beside the
 * processor time. Enters: how to make the simulation, and what it should come to; leaves: errors, times, orders. */
#ifndef LAG_ANALYSIS_COST_H
#define LAG_ANALYSIS_COST_H

#include "lag.h"

/* The motion at some times: y[rows * n] is q, v, z in SI. uncertainty: how far it may itself be off, as errors below are
 * measured. */
typedef struct Samples {
  int rows, n;
  double *t, *y;
  double uncertainty;
} Samples;

/* Zeros; LAG_OK or LAG_ENOMEM. Free with lag_samples_free, also after an error. */
int lag_samples_init(Samples *s, int rows, int n);
void lag_samples_free(Samples *s);

/* A simulation at its start, with the user's values, method and tolerance still to choose; NULL: not to be had. */
typedef struct CostScene {
  lag_sim *(*fresh)(void *context);
  void *context;
  double t0; /* where it begins */
} CostScene;

/* Runs `sim` to each of the times s->t and fills s->y. Fewer rows remain where an event ends the run. < 0: it failed, see
 * lag_sim_message. */
int lag_samples_take(Samples *s, lag_sim *sim);

/* By what errors of component i are divided: scale[n], the largest reference value among components of the same kind
 * (coordinate, velocity or state) and unit; 1 where all of them are 0. */
void lag_cost_scales(const Samples *reference, const lag_sim *sim, double *scale);

/* The largest |a - b| / scale over times and components; HUGE_VAL when one is no number. */
double lag_cost_error(const Samples *a, const Samples *b, const double *scale);

/* One setting: a tolerance, or a step where the method's steps are of one size. */
typedef struct CostRun {
  double knob;
  double error;
  double time, spread; /* processor time [s]: the median; the middle half of the times, relative to it, NaN for one run */
  long long steps, calls;
  int best;            /* no other run of any method is both faster and more accurate */
} CostRun;

enum { LAG_COST_MOST_RUNS = 40 };

/* A method at one value of its option `option` (name NULL: without). */
typedef struct CostMethod {
  const lag_method *method;
  lag_option option;
  CostRun run[LAG_COST_MOST_RUNS]; /* [nruns], from the least accurate on */
  int nruns;
  double order;   /* the slope of log error against log of the number of steps; NaN: no window to see it */
  char why[512];  /* of no runs: why the last one tried has no result; "": it was too far off */
} CostMethod;

/* Runs the settings of one method, from coarse to fine, until its error stops falling, or a run takes longer than `longest` [s of
 * processor time]. LAG_OK, also where no run has a result (m->why); LAG_ENOMEM. */
int lag_cost_measure(CostMethod *m, const CostScene *scene, const Samples *reference, const double *scale, double longest);

/* Marks the Pareto front of all runs. */
void lag_cost_front(CostMethod *m, int n);

/* The fastest run with an error of at most `target`: its method, and *run; NULL: there is none. */
const CostMethod *lag_cost_cheapest(const CostMethod *m, int n, double target, const CostRun **run);

#endif
