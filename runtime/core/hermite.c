/* Hermite interpolation of a state, for methods: an instance of kernels/dense_output.h. */
#include "kernels/dense_output.h"
#include "lag.h"

void lag_hermite(int nq, int nz, double h, double s, const double *y0, const double *f0, const double *y1,
                 const double *f1, double *y) {
  const lag_step_ends ends = {h, y0, f0, y1, f1};
  lag_hermite_within(&ends, nq, nz, s, y);
}
