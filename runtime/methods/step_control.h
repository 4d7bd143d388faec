/* Step size control of adaptive methods: the norm of an error estimate, the first step, and a fast power. */
#pragma once

#include <math.h>

#include "lag.h"

/* Options of adaptive steps, and the largest step that they allow; part of a method's saved state. */
typedef struct lag_step_limits {
  double h_option, h_max, atol;
  double fixed;          /* 1: every step has the size h_option */
  double t_begin, begun; /* start of the first step; 1: it is set */
} lag_step_limits;

/* The first options of an adaptive method, in this order. */
enum { LAG_OPT_STEP, LAG_OPT_MAX, LAG_OPT_ATOL, LAG_OPT_ADAPT, LAG_NADAPTIVE_OPTIONS };
extern const char *const lag_on_off[];
#define LAG_MAX_STEP_OPTION                                                                                      \
  {                                                                                                              \
    "max_step", "largest step [s]; 0: a tenth of the scene's span, or the time since the start", 0, 0, HUGE_VAL, \
        .choices = NULL                                                                                          \
  }
#define LAG_ATOL_OPTION \
  { "atol", "absolute tolerance [SI]; 0: the relative one, of the size of the motion", 0, 0, HUGE_VAL, .choices = NULL }

/* The error of component i of y may be `relative` times |y_i| + lag_tolerance_floor. */
typedef struct lag_tolerance {
  double relative;
  const lag_step_limits *limits;
} lag_tolerance;

static inline double lag_tolerance_floor(const lag_step_limits *l, const lag_problem *pb, int i) {
  return l->atol > 0 ? l->atol / pb->tol : pb->size[i];
}

void lag_step_limits_init(lag_step_limits *l, const lag_problem *pb, const double *opt);

/* Before each step: notes the time of the first one. */
static inline void lag_step_limits_begin(lag_step_limits *l, double t) {
  if (l->begun == 0.0) {
    l->begun = 1;
    l->t_begin = t;
  }
}

/* Minimum and maximum of two numbers; b where a is NaN. */
static inline double lag_min(double a, double b) { return a < b ? a : b; }
static inline double lag_max(double a, double b) { return a > b ? a : b; }

/* Largest step: the option, or else the time covered so far; at most `longest` (0: no limit). Without limit where
 * all steps have one size. */
static inline double lag_longest_step(const lag_step_limits *l, double t, double longest) {
  double seen = fabs(t - l->t_begin), most = l->h_max > 0 ? l->h_max : seen > 0 ? seen : HUGE_VAL;
  return l->fixed != 0.0 ? HUGE_VAL : longest > 0 ? lag_min(most, longest) : most;
}

#include "kernels/step_size.h"

/* The first step to try; of s: order, t, y, f and scratch are given. */
double lag_first_step(lag_problem *pb, const lag_tolerance *tol, lag_first_try s);
