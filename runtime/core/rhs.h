/* Inline parts of the right-hand side, called so often, for so few numbers, that a function call would take as long as the work: for rhs.c and
 * for methods with many stages; and the compensated sum of all steps. */
#pragma once

#include <math.h>

#include "lag.h"

#ifdef __GNUC__
#define LAG_ALWAYS_INLINE static inline __attribute__((always_inline))
#else
#define LAG_ALWAYS_INLINE static inline
#endif

/* s + d with compensation: *c is the rounding lost so far (two-sum, for operands of any size). A. Neumaier, ZAMM 54
 * (1974) 39, DOI 10.1002/zamm.19740540106. Rounding then grows at most with the root of the number of steps. */
static inline double lag_compensated_sum(double s, double d, double *c) {
  double x = d + *c, r = s + x, b = r - s;
  *c = (s - (r - b)) + (x - b);
  return r;
}

/* to[n] := from[n]. */
LAG_ALWAYS_INLINE void lag_copy(int n, const double *from, double *to) {
  int i = 0;
  for (; i + 1 < n; i += 2) {
    double a = from[i], b = from[i + 1];
    to[i] = a;
    to[i + 1] = b;
  }
  if (i < n) to[i] = from[i];
}

/* The parts that few models have: pb->u := inputs; where constraints are redundant, *y := its projection onto them. */
int lag_rhs_prepare(lag_problem *pb, double t, const double **y);

/* Inline lag_inputs and lag_next_row. */
LAG_ALWAYS_INLINE int lag_inputs_inline(lag_problem *pb, double t) { return pb->model->nu ? lag_inputs(pb, t) : 0; }

LAG_ALWAYS_INLINE double lag_next_row_inline(const lag_problem *pb, double t, double *row) {
  return pb->model->ntables ? lag_next_row(pb, t, row) : HUGE_VAL;
}

/* Inline lag_rhs; nq is the model's, perhaps a compile-time constant. */
LAG_ALWAYS_INLINE int lag_rhs_inline(lag_problem *pb, int nq, double t, const double *y, double *dy) {
  const lag_model *m = pb->model;
  pb->rhs_calls++;
  if (m->nu | pb->redundant) {
    int rc = lag_rhs_prepare(pb, t, &y);
    if (rc) return rc;
  }
  lag_copy(nq, y + nq, dy);
  return m->accel(t, y, y + nq, y + 2 * nq, pb->p, pb->u, dy + nq, dy + 2 * nq, pb->work);
}

/* methods/taylor.c: the order of the series, from the work of a run by taylor that has begun. */
double lag_taylor_order(const double *method_work);
