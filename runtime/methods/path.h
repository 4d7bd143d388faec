/* The motion within one step of q'' = f(t, q, q'), to order 6 and 8: for dense output of symplectic methods. */
#ifndef LAG_METHODS_PATH_H
#define LAG_METHODS_PATH_H

#include "lag.h"

/* The two ends of a step: y = [q|v], f = [v|a], of nq coordinates and no states. */
typedef struct StepEnds {
  double t0, h;
  const double *y0, *f0, *y1, *f1;
} StepEnds;

/* Doubles that a path needs. */
size_t lag_path_size(int nq);

/* Makes the path: level 1 has order 6 and costs 2 evaluations of f, level 2 has order 8 and costs 6. passes: how often; 2
 * where f depends on velocities. != 0: the model failed inside the step. */
int lag_path_make(double *path, lag_problem *pb, const StepEnds *ends, int level, int passes);

/* y at t0 + s h. */
void lag_path_at(const double *path, const lag_problem *pb, const StepEnds *ends, int level, double s, double *y);

/* The same without f, for a method whose q and v do not fit together better than O(h): cubic in q, and v as its derivative,
 * so that what falls onto something meets it falling. */
void lag_path_cubic(int nq, const StepEnds *ends, double s, double *y);

#endif
