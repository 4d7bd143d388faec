/* Interpolants of order 6 and 8 within one step of q'' = f(t, q, q'): dense output of symplectic methods. */
#pragma once

#include "lag.h"

/* Both ends of a step: y = [q|v], f = [v|a]; nq coordinates, no states. */
typedef struct StepEnds {
  double t0, h;
  const double *y0, *f0, *y1, *f1;
} StepEnds;

/* The level for a method of this order: 0, 1, 2 have order 4, 6, 8. */
static inline int lag_interpolant_level(double order) { return order > 6 ? 2 : order > 4 ? 1 : 0; }

/* Doubles of a path. */
size_t lag_interpolant_size(int nq);

/* Builds the interpolant: level 1 has order 6 and costs 2 evaluations of f, level 2 has order 8 and costs 6. passes:
 * of each level; 2 where f depends on velocities. != 0: the model failed inside the step. */
int lag_interpolant_make(double *path, lag_problem *pb, const StepEnds *ends, int level, int passes);

/* y := interpolant at t0 + s h. Level 0 is lag_hermite, of order 4, and needs no path. */
void lag_interpolant_at(const double *path, const lag_problem *pb, const StepEnds *ends, int level, double s,
                        double *y);

/* y := cubic Hermite interpolant of q, and v as its derivative, without f: for methods whose q and v agree to O(h)
 * only. With v as the derivative, a body that reaches a surface has a velocity towards it. */
void lag_interpolant_cubic(int nq, const StepEnds *ends, double s, double *y);
