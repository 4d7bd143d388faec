/* Orthonormalisation of a tangent (orthonormalise.h). */
#include "analysis/orthonormalise.h"

#include <math.h>

#include "lag.h"
#include "numeric/dense.h"

static void scale(int n, int k, double *Y, int a, double by) {
  for (int i = 0; i < n; i++) Y[i * k + a] *= by;
}

int lag_orthonormalise(int n, int k, double *Y, double *sum, int counts, int joins) {
  const double rounding = 1e-9;
  for (int a = 0; a < k; a++) {
    double before = sqrt(lag_columns_dot(n, k, Y, a, a));
    for (int b = 0; b < a; b++) {
      double c = lag_columns_dot(n, k, Y, a, b);
      for (int i = 0; i < n; i++) Y[i * k + a] -= c * Y[i * k + b];
    }
    double length = sqrt(lag_columns_dot(n, k, Y, a, a));
    if (joins && length <= rounding * fmax(before, 1)) sum[a] = -HUGE_VAL;
    int gone = sum[a] == -HUGE_VAL;
    if (!gone && (!(length > 0) || !isfinite(length))) return LAG_EDOMAIN;
    scale(n, k, Y, a, gone ? 0 : 1 / length);
    sum[a] += counts && !gone ? log(length) : 0;
  }
  return LAG_OK;
}
