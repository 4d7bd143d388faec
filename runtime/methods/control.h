/* What methods that choose their steps share: the size of an error, and the first step. */
#ifndef LAG_METHODS_CONTROL_H
#define LAG_METHODS_CONTROL_H

#include "lag.h"

typedef struct lag_tolerance {
  double absolute, relative;
} lag_tolerance;

/* Root mean square of x[n] against absolute + relative |y|. */
double lag_error_norm(const lag_problem *pb, const lag_tolerance *tol, const double *x, const double *y);

/* The first step to try from y, where f0 = f(t, y), by a method of this order; at most h_max, 0: no limit. y1[n] and
 * f1[n] are scratch. E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), II.4
 * "starting step size": one Euler step measures the second derivative. */
double lag_first_step(lag_problem *pb, const lag_tolerance *tol, int order, double h_max, double t, const double *y,
                      const double *f0, double *y1, double *f1);

#endif
