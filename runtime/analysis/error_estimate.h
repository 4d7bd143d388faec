/* Error of a run by a second, more accurate run: the differences of the two motions within steps, where rows are
 * interpolated, and at its end, relative to the largest value of their kind and unit, as in work_precision.h.
 * Enters: a run under way, then a simulation of the same scene; leaves: the error, its law of growth, and the
 * horizon, the time from which no digit is left. Holds: the run is the same, bit by bit, with an estimate or
 * without. */
#pragma once

#include "analysis/formula_noise.h"

/* How an error grows with the time t since the start. */
typedef enum ErrorGrowth {
  LAG_ERROR_UNKNOWN, LAG_ERROR_BOUNDED, LAG_ERROR_LINEAR, LAG_ERROR_QUADRATIC,
  LAG_ERROR_EXPONENTIAL
} ErrorGrowth;

enum { LAG_ERROR_PLACES = 4096 };

typedef struct ErrorEstimate {
  Samples motion;        /* the run at `motion.rows` places; [room] */
  int room;
  long long stride, seen; /* each stride-th place of the steps is kept; places seen */
  double t0;
  double error[LAG_ERROR_PLACES]; /* [compared] */
  int compared;          /* rows that the second run reached, */
  double met[LAG_ERROR_PLACES]; /* [rows] events of the run before each place */
  int continued;         /* 1: fewer than all; exponential growth goes on to known_to */
  double whole;          /* error of the run per difference of the two; 1: the second run has none */
  int rough;             /* 1: errors at a few times only, where laws are a guess */
  int drifts;            /* 1: a charge of the run drifts with a trend */
  double largest;        /* largest error up to known_to; NaN: no estimate */
  int at_most;           /* 1: the rounding of the second run may be the larger part of it */
  double floor;          /* error by the rounding of the time, which all runs share */
  double known_to;       /* the end of the run or of the second one, or beyond it where growth is exponential */
  double horizon;        /* NaN: not before known_to */
  FormulaNoise formula;  /* rounding that both runs share */
  ErrorGrowth growth;
  double rate;           /* of exponential growth [1/s] */
  double events;         /* events of the run so far: a step that ends at an event has no place */
  int held;              /* 1: a contact was closed at the last place */
  char why[200];         /* without an estimate: the reason */
} ErrorEstimate;

/* LAG_OK or LAG_ENOMEM. Free with lag_error_estimate_free, also after an error. */
int lag_error_estimate_init(ErrorEstimate *e, const lag_sim *sim);
void lag_error_estimate_free(ErrorEstimate *e);

/* Notes places of the last step: call it at the end of each. The run goes on as it would have. */
void lag_error_estimate_note(ErrorEstimate *e, lag_sim *sim);

/* Notes the state at the end of the run, unless it ended at an event. */
void lag_error_estimate_note_end(ErrorEstimate *e, lag_sim *sim);

/* *least := the smallest divisor of errors along the noted motion. LAG_OK or LAG_ENOMEM. */
int lag_error_least_scale(const ErrorEstimate *e, lag_sim *other, double *least);

/* Runs `other`, a simulation of the same scene at its start with a more accurate setting, along the noted motion,
 * until it fails or its hook (lag_sim_on_step) ends it, and fills in the rest of *e; until: end of the run. LAG_OK,
 * also where `other` fails (e->why), or LAG_ENOMEM. */
int lag_error_estimate_compare(ErrorEstimate *e, lag_sim *other, double until);

/* *e as before the last comparison, for another one. */
void lag_error_estimate_reset(ErrorEstimate *e);

/* After a comparison: whether the motions are the same to the last bit. If so, *e is as before it, for another one. */
int lag_error_estimate_is_blind(ErrorEstimate *e);

/* After a comparison: the error up to known_to, of rounding at least; NaN: no estimate. */
double lag_error_size(const ErrorEstimate *e);

/* After a comparison: whether a formula has lost many digits. */
int lag_formula_is_lossy(const ErrorEstimate *e);

/* After a comparison: time since the start at which errors `factor` times as large leave no digit, by their law of
 * growth; HUGE_VAL: never; NaN: no law is known. */
double lag_error_reach(ErrorEstimate *e, double factor);

/* The law of errors at n times t, the first of which is the start; LAG_ERROR_UNKNOWN: none is visible, or no digit
 * is left at the last ones. */
ErrorGrowth lag_error_growth(int n, double *t, const double *error);
