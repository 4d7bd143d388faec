/* Work-precision measurement: a scene run with many settings of many methods. Enters: a function that makes the
 * simulation, and a reference motion; leaves: errors, processor times, observed orders. */
#pragma once

#include "lag.h"

/* The motion at `rows` times: y[rows * n] is q, v, z in SI. uncertainty: its own error, measured as the errors
 * below. */
typedef struct Samples {
  int rows, n;
  double *t, *y;
  /* [n] largest size of each component between the rows, where it is known; 0: only rows count for scales */
  double *largest;
  double uncertainty;
  int output; /* 0: the state; k > 0: y[rows] is output k - 1 of the scene alone, n = 1; LAG_SAMPLES_RESIDUAL */
} Samples;

/* y: the largest of what is left of the equations of motion, y' - f(t, y), in the middle of each step since the row
 * before, where y is the method's own motion between the ends of steps. */
enum { LAG_SAMPLES_RESIDUAL = -1 };

/* Allocates samples of zeros. LAG_OK or LAG_ENOMEM. Free with lag_samples_free, also after an error. */
int lag_samples_init(Samples *s, int rows, int n);
void lag_samples_free(Samples *s);

/* A source of simulations at their start, with the user's values, method and tolerance still to choose; fresh
 * returns NULL where it fails. */
typedef struct CostScene {
  lag_sim *(*fresh)(void *context);
  void *context;
  double t0; /* start of the run */
} CostScene;

/* Runs `sim` to each of the times s->t and fills s->y. Fewer rows remain where an event ends the run. < 0: failure,
 * see lag_sim_message. */
int lag_samples_take(Samples *s, lag_sim *sim);

/* Notes in s->largest the state, or output, of sim: after each step of a reference. LAG_OK, or a failure of the
 * output. */
int lag_samples_note(Samples *s, lag_sim *sim);

/* scale[n] := divisor of the error of component i: the largest reference value, at rows and between them, among
 * components of its kind (coordinate, velocity or state) and unit; where that is rounding, the size of the terms
 * that it is the rounding of (core/sizes.c); 1 where there are none. LAG_OK or LAG_ENOMEM. sim: of the scene;
 * scratch: ya, yb, yc. */
int lag_cost_scales(const Samples *reference, lag_sim *sim, double *scale);

/* The largest size of component i in a reference, at rows and between them. */
double lag_size_in(const Samples *reference, int i);

/* The largest |a - b| / scale of n components, or over times and components; HUGE_VAL when one is not finite. */
double lag_cost_row_error(int n, const double *a, const double *b, const double *scale);
double lag_cost_error(const Samples *a, const Samples *b, const double *scale);

enum { LAG_COST_MOST_ROWS = 17 };

/* One setting: knob is its tolerance, or its step where steps are of equal size. */
typedef struct CostRun {
  double knob;
  double error;
  /* median processor time [s] of the repeats; their interquartile range relative to it, NaN for one run */
  double time, spread;
  long long steps, calls;
  double at[LAG_COST_MOST_ROWS]; /* error at each row of the reference, for its growth */
  int stopped;         /* 1: the scene's monitors stop this setting, so that it is no answer */
  int best;            /* Pareto-optimal: no other run of any method is both faster and more accurate */
} CostRun;

enum { LAG_COST_MOST_RUNS = 48 };

/* A method at one value of its option `option` (name NULL: without). */
typedef struct CostMethod {
  const lag_method *method;
  lag_option option;
  char name[64];  /* the caller's: "variational(order=4)" */
  CostRun run[LAG_COST_MOST_RUNS]; /* [nruns], from the least accurate on */
  int nruns;
  double order;   /* observed order, the slope of log error against log of the number of steps; NaN: not visible */
  char why[512];  /* why the last setting tried has no result; "": its error was too large */
  /* largest error from which on finer settings were left out: behind the front, or for want of time; 0: none were */
  double left_out;
} CostMethod;

/* A sweep over the settings of all methods. */
typedef struct CostSweep {
  CostMethod *method; /* [n] */
  int n;
  CostScene scene;
  const Samples *reference;
  const double *scale;
  double seconds;  /* time to spend, by the clock */
  double end;      /* its end, set by lag_cost_sweep; 0: none */
  double target;   /* an error for which settings between those of the grid are tried, too; 0: none */
  /* before each setting, with the part of the time that is used, and about once a millisecond of it, with -1; != 0
   * ends the sweep */
  int (*note)(void *context, const CostMethod *m, double part);
  void *context;
} CostSweep;

/* cost_sweep.c. Runs settings from coarse to fine, methods near the front first and the shortest run next, until
 * errors stop falling or the time is used; then repeats the runs of the front for their times, and marks it. LAG_OK,
 * also where no method has a result (why); LAG_ENOMEM. */
int lag_cost_sweep(CostSweep *s);

/* One setting of *m, run once, and again while `enough` processor time [s] is not used, at most `most` times.
 * LAG_OK: *run has its result; LAG_STOPPED: the run ended before the reference; LAG_INTERRUPTED: it took longer than
 * `longest` [s of the processor], or the sweep has ended; < 0: it failed. Not LAG_OK: m->why says why. */
int lag_cost_run(CostMethod *m, const CostSweep *s, double enough, int most, double longest, Samples *own,
                 CostRun *run);
/* A simulation with the method at this setting; NULL without memory, or with *rc and m->why set. */
lag_sim *lag_cost_prepare(CostMethod *m, const CostScene *scene, double knob, int *rc);
/* Observed order: the median of the last three slopes between runs that neither rounding nor the reference's error
 * affects; NaN: none is visible. */
double lag_cost_order(const CostMethod *m, double uncertainty);

/* The last component before i of the same kind (coordinate, velocity or state) and unit; -1: there is none. */
int lag_previous_alike(const lag_sim *sim, int i);

/* Marks the Pareto front of all runs. */
void lag_pareto_front(CostMethod *m, int n);

/* Of all runs; HUGE_VAL: there is none. */
double lag_cost_smallest_error(const CostMethod *m, int n);

/* The method of the fastest run with an error of at most `target`, and *run; NULL: there is none. lag_cost_answer:
 * of those that are not `stopped`. */
const CostMethod *lag_cost_cheapest(const CostMethod *m, int n, double target, const CostRun **run);
const CostMethod *lag_cost_answer(const CostMethod *m, int n, double target, const CostRun **run);
