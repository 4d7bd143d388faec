/* Measures: numbers that one keeps of a run. lagc reads and checks them (src/model/measure.c) and writes them in words,
 * operations behind their operands: `max(y) - 1` of y in cm is `y max() 1 0.01 * - [0.01 0 cm]`. A word is
 *   x  x'  t  energy  "l*sin(th)"   a quantity: an output, coordinate, velocity, state, parameter, input or charge
 *   0.5  pi()               a number
 *   + - * / ^ neg() abs() sin() ... greater()   operations on the numbers before them
 *   max() ... period()      TRACKS of functions.def: of the expression before, along the run; max(10..20): 10 to 20 s
 *   at()                    the quantity at the time [s] before; without these words, at the end of the run
 *   hit(EVENT) count(EVENT) the time of its firing number n, which stands before; the number of firings
 *   end() lyapunov() megno() the time at which the run ends; the largest Lyapunov exponent without the run's first
 *                           tenth; the mean exponential growth of nearby orbits; by runs with a tangent
 *   [FACTOR OFFSET UNIT] the last word: the unit of the value; without it a quantity alone is in its own, others in
 *   SI.
 * All is computed in SI.
 *
 * All measures come from one run, by dense output within each step; the steps are those of a run without measures,
 * bit by bit. Exceptions: methods of GSL (LAG_METHOD_STEPS_TO) step to the times of x(10), as they do to rows, and
 * their dense output is Hermite's, of order 4, whatever the order of the steps; and a value at a time that is itself
 * a measure, x(hit(e)/2), takes a second run. */
#pragma once

#include "lag.h"

typedef struct Measures Measures;

/* A function of one number, or of two. */
typedef struct MeasureFunction {
  const char *name;
  double (*one)(double);
  double (*two)(double, double);
} MeasureFunction;

/* For programs with words of their own, as the checker of models/NAME.facts. */
typedef struct MeasureDialect {
  int past_end;  /* 1: x(10) is also known after the end of the run, by a longer run */
  int nfunctions;
  const MeasureFunction *functions;                /* [nfunctions] */
} MeasureDialect;

/* Measures text[n], as compiled, for runs of a scene; dialect: NULL or more words. NULL: the message in why[size]
 * says what is wrong. */
Measures *lag_measures_new(const lag_scene *scene, int n, const char *const *text, const MeasureDialect *dialect,
                           char *why, size_t size);
void lag_measures_free(Measures *m);
int lag_measures_count(const Measures *m);
/* Unit of the values of measure k; "": it has none. */
const char *lag_measures_unit(const Measures *m, int k);

/* Why runs like this one, to `until`, have no such measures: the method has no tangent for a Lyapunov exponent. 0,
 * or -1 with the reason. */
int lag_measures_refused(const Measures *m, const lag_sim *like, double until, char *why, size_t size);

/* Runs sim, at its start, to `until`, or to where an event or a failure ends it. value[n] := the measures up to
 * there; NaN: see lag_measures_why. Returns what lag_sim_advance returned last. Each thread needs Measures of its
 * own. */
int lag_measures_run(Measures *m, lag_sim *sim, double until, double *value);
/* Why value k of the last run is NaN; "" where it is a number. */
const char *lag_measures_why(const Measures *m, int k);

/* The same in parts, for a run that also stops elsewhere: begin before the first advance, or after a load, with the
 * hooks set; advance in place of lag_sim_advance; end. Between begin and end the hook of lag_sim_on_event is taken,
 * and calls the one set before. begin and advance return a status of lag_sim_advance, end LAG_OK or LAG_ENOMEM. */
int lag_measures_begin(Measures *m, lag_sim *sim);
int lag_measures_advance(Measures *m, double t);
int lag_measures_end(Measures *m, double *value);

/* Derivatives of measure k of the last run, in its unit, by starts [n] and parameters [np], in SI, by reverse mode
 * (lag_sim_gradient) over a run of its own: `sim`, at its start, with the settings of the last one but perhaps another
 * method. Values at times and at the end, largest and smallest values, drifts, and expressions of them have a
 * gradient. 0, or -1 with the reason. */
int lag_measures_gradient(Measures *m, int k, lag_sim *sim, double *by_start, double *by_p, char *why, size_t size);

/* Whether a measure is taken along the run, as max(x) is, and not at some times only: each step has to be looked at. */
int lag_measures_follow(const Measures *m);
