/* Scales against which states and residuals of constraints are compared. */
#include "numeric/magnitudes.h"

#include <float.h>
#include <math.h>
#include <string.h>

int lag_is_angle(int periodic, const char *unit) {
  return periodic || strcmp(unit, "rad") == 0 || strcmp(unit, "deg") == 0 || strcmp(unit, "rev") == 0;
}

double lag_component_scale(double most, int periodic, const char *unit) {
  return most <= 0 || (most < 1 && (!unit[0] || lag_is_angle(periodic, unit))) ? 1 : most;
}

double lag_uneven(int i) {
  double turns = 0.618033988749894848 * (i + 1);
  return 0.5 + (turns - (int)turns); /* exact, and a tenth of the time of fmod */
}

int lag_worst_residual(int n, const double *residual, const double *terms, double rounding, double *times) {
  int which = -1;
  *times = -1;
  for (int k = 0; k < n; k++) {
    /* subnormal numbers have lost digits */
    double x = fabs(residual[k]), part = x < DBL_MIN ? 0 : x / (rounding * terms[k]);
    part = isnan(part) ? HUGE_VAL : part; /* no value */
    if (part > *times) {
      *times = part;
      which = k;
    }
  }
  return which;
}

int lag_ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}
