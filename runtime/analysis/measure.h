/* Measures: numbers that one keeps of a run. A measure is an expression of
 *   x  x'  t  energy         a quantity: an output, coordinate, velocity, state, parameter, input or charge; its value at the end of the run
 *   x(10)                    its value at a time [s]
 *   max(x) min(x) mean(x) rms(x) drift(x)   over the run, also of an expression of quantities; drift: the largest |x(t) - x(start)|
 *   period(x)                the mean time between upward passages of 0
 *   hit(EVENT) hit(EVENT, 3) count(EVENT)   the time of its first, third firing; the number of firings
 *   end                      the time at which the run ends
 *   lyapunov                 the largest Lyapunov exponent over the run, less its first tenth, by a second run with a tangent
 *   + - * / ^ ( ) sin cos tan asin acos atan atan2 sqrt exp log abs pi deg
 *
 * Units: expressions are computed in SI, sines of radians. A measure whose parts have one declared unit is given in it, so max(th) is in degrees where
 * th is; others are in SI. A plain number that is added to a quantity, or subtracted, is in the unit of the quantity: max(th) - 90; 0.5[SI] is in SI. A
 * name in quotes may have any characters, as an output does: max("l*sin(th)").
 *
 * All measures come from one run, by dense output within each step; the steps are those of a run without measures, bit by bit. Exceptions: methods of
 * GSL (LAG_METHOD_STEPS_TO) step to the times of x(10), as they do to rows, and their dense output is Hermite's, of order 4, whatever the order of
 * the steps; and a value at a time that is itself a measure, x(hit(e)/2), takes a second run. */
#pragma once

#include "lag.h"

typedef struct Measures Measures;

/* Expressions text[n] for runs of a scene. NULL: the message in why[size] says what is wrong, at which character, and the nearest name. */
Measures *lag_measures_new(const lag_scene *scene, int n, const char *const *text, char *why, size_t size);
void lag_measures_free(Measures *m);
int lag_measures_count(const Measures *m);
/* Unit of the values of measure k; "": it has none, or it is in SI. */
const char *lag_measures_unit(const Measures *m, int k);

/* Why runs like this one, to `until`, have no such measures: the method has no tangent for a Lyapunov exponent. 0, or -1 with the reason. */
int lag_measures_refused(const Measures *m, const lag_sim *like, double until, char *why, size_t size);

/* Runs sim, at its start, to `until`, or to where an event or a failure ends it. value[n] := the measures up to there; NaN: see lag_measures_why.
 * Returns what lag_sim_advance returned last. Each thread needs Measures of its own. */
int lag_measures_run(Measures *m, lag_sim *sim, double until, double *value);
/* Why value k of the last run is NaN; "" where it is a number. */
const char *lag_measures_why(const Measures *m, int k);

/* The same in parts, for a run that also stops elsewhere: begin before the first advance, or after a load, with the hooks set; advance in place of
 * lag_sim_advance; end. Between begin and end the hook of lag_sim_on_event is taken, and calls the one set before. begin and advance return a status
 * of lag_sim_advance, end LAG_OK or LAG_ENOMEM. */
int lag_measures_begin(Measures *m, lag_sim *sim);
int lag_measures_advance(Measures *m, double t);
int lag_measures_end(Measures *m, double *value);

/* Whether a measure is taken along the run, as max(x) is, and not at some times only: each step has to be looked at. */
int lag_measures_follow(const Measures *m);

/* ---- For programs with words of their own, as the checker of models/NAME.facts */

/* A function of one number, or of two. */
typedef struct MeasureFunction {
  const char *name;
  double (*one)(double);
  double (*two)(double, double);
} MeasureFunction;

typedef struct MeasureDialect {
  int si;        /* 1: values, and numbers beside them, are in SI */
  int past_end;  /* 1: x(10) is also known after the end of the run, by a longer run */
  int nfunctions;
  const MeasureFunction *functions;                /* [nfunctions] */
  const char *(*text)(void *context, const char *name); /* the expression that a name stands for, or NULL; NULL: no such names */
  void *context;
} MeasureDialect;

Measures *lag_measures_new_dialect(const lag_scene *scene, int n, const char *const *text, const MeasureDialect *dialect, char *why, size_t size);
