/* Shared by all methods: steps of equal size, the option `step`, and the status of a failed step. */
#pragma once

#include "core/rhs.h"

/* Steps of equal size: head of a method's saved state. */
typedef struct lag_fixed_step {
  double h;      /* the step, > 0 */
  double t0, dt; /* the last step began at t0 and was dt long */
  double tc;     /* compensation of t: rounding lost so far */
} lag_fixed_step;

/* A step from t to tb, of signed length dt; tc: compensation of tb. */
typedef struct lag_next_step {
  double dt, tb, tc;
} lag_next_step;

#ifndef LAG_LANES /* sums are of vectors there */
/* A step of the size s->h, or to a kick within it. LAG_ESTEP: the step is lost in the rounding of t. */
static inline int lag_fixed_step_begin(const lag_fixed_step *s, lag_problem *pb, double t, lag_next_step *next) {
  next->dt = s->h * pb->dir;
  next->tc = s->tc;
  next->tb = lag_compensated_sum(t, next->dt, &next->tc);
  if (pb->kick > t && next->tb + 1e-4 * s->h >= pb->kick) { /* the rest after this step would be too short */
    next->tb = pb->kick;
    next->dt = pb->kick - t;
    next->tc = 0;
  }
  pb->bad_index = -1;
  if (next->tb == t) {
    pb->bad_t = t;
    return LAG_ESTEP;
  }
  return LAG_OK;
}
#endif

static inline void lag_fixed_step_end(lag_fixed_step *s, const lag_next_step *next, double *t) {
  s->t0 = *t;
  s->dt = next->tb - *t;
  s->tc = next->tc;
  *t = next->tb;
}

/* Members of lag_method that are functions of the same names in its file. */
#define LAG_METHOD_FUNCTIONS .work_size = work_size, .init = init, .step = step, .dense = dense, .reset = reset
#define LAG_METHOD_TANGENT .tangent_size = tangent_size, .tangent = tangent

/* The option `step` of fixed-step methods. */
#define LAG_STEP_OPTION \
  { "step", "size of the step [s]; 0: a 10000th of the scene's span", 0, 0, HUGE_VAL, .choices = NULL }

/* Records the time of a failure in pb; returns status. */
static inline int lag_step_failed(lag_problem *pb, int status, double t) {
  pb->bad_t = t;
  return status;
}

/* Status of a step whose model call returned rc != 0, for a method that cannot take a smaller step. */
static inline int lag_step_refused(lag_problem *pb, int rc, double t) {
  return lag_step_failed(pb, rc > 0 ? LAG_EDOMAIN : rc == LAG_ESINGULAR ? LAG_ESINGULAR : LAG_EMODEL, t);
}
static inline int lag_step_checked(lag_problem *pb, int rc, double t) { return rc ? lag_step_refused(pb, rc, t) : 0; }

/* Status of a step whose projection (lag_project) returned rc != 0. */
static inline int lag_step_not_projected(lag_problem *pb, int rc, double t) {
  return rc > 0 ? lag_step_failed(pb, LAG_EMETHOD, t) : lag_step_refused(pb, rc, t);
}

/* dy := f(t, y), for a method that cannot take a smaller step. LAG_OK, or a failure, also where a rate is not
 * finite. */
static inline int lag_step_rhs(lag_problem *pb, double t, const double *y, double *dy) {
  int rc = lag_rhs(pb, t, y, dy);
  if (rc) return lag_step_refused(pb, rc, t);
  pb->bad_index = lag_not_finite(pb->n, dy);
  return pb->bad_index >= 0 ? lag_step_failed(pb, LAG_ENAN, t) : LAG_OK;
}
