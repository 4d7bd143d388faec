/* What the methods share: sums that lose nothing, and what a failure inside a step is called. */
#ifndef LAG_METHODS_STEPS_H
#define LAG_METHODS_STEPS_H

#include <math.h>

#include "lag.h"

/* s + d, where *c is what earlier sums have lost: two-sum, valid for operands of any size. A. Neumaier, ZAMM 54
 * (1974) 39, DOI 10.1002/zamm.19740540106. Rounding then grows with the root of the number of steps at most. */
static inline double lag_sum(double s, double d, double *c)
{
  double x = d + *c, r = s + x, b = r - s;

  *c = (s - (r - b)) + (x - b);
  return r;
}

/* The option of a method with steps of equal size. */
#define LAG_STEP_OPTION {"step", "size of the step [s]; 0: a 10000th of the scene's span", 0, 0, HUGE_VAL, NULL}

/* Sets where it failed; returns status. */
static inline int lag_step_failed(lag_problem *pb, int status, double t)
{
  pb->bad_t = t;
  return status;
}

/* What the model's answer rc != 0 means to a method that cannot take a smaller step. */
static inline int lag_step_refused(lag_problem *pb, int rc, double t)
{
  return lag_step_failed(pb, rc > 0 ? LAG_EDOMAIN : rc == LAG_ESINGULAR ? LAG_ESINGULAR : LAG_EMODEL, t);
}

/* The same of lag_project. */
static inline int lag_step_unmet(lag_problem *pb, int rc, double t)
{
  return rc > 0 ? lag_step_failed(pb, LAG_EMETHOD, t) : lag_step_refused(pb, rc, t);
}

/* f(t, y) into dy for a method that cannot take a smaller step: LAG_OK, or the failure. */
static inline int lag_step_rhs(lag_problem *pb, double t, const double *y, double *dy)
{
  int rc = lag_rhs(pb, t, y, dy);

  if (rc) {
    return lag_step_refused(pb, rc, t);
  }
  pb->bad_index = lag_not_finite(pb->n, dy);
  return pb->bad_index >= 0 ? lag_step_failed(pb, LAG_ENAN, t) : LAG_OK;
}

#endif
