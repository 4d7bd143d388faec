/* Butcher tableau of an explicit Runge-Kutta method with an embedded error estimate, as data that a test can check. */
#pragma once

#include "kernels/steppers.def"

enum { LAG_MAX_STAGES = 16, LAG_MAX_DENSE = 4 };

typedef struct lag_tableau {
  int stages; /* including the last: f at the end of the step, the first stage of the next step */
  int extra;  /* further stages, for dense output only */
  int order, order_embedded;
  double c[LAG_MAX_STAGES];
  double a[LAG_MAX_STAGES][LAG_MAX_STAGES]; /* a[i][j], j < i; row stages - 1 holds the weights of the result */
  double errors[2][LAG_MAX_STAGES];         /* of the result minus the embedded method; a second estimate, or zeros */
  double d[LAG_MAX_DENSE][LAG_MAX_STAGES];  /* weights of the highest terms of dense output */
} lag_tableau;

#define LAG_DECLARE_TABLEAU(name, NAME, kind, dense, order, line, words) extern const lag_tableau lag_##name##_tableau;
LAG_RUNGE_KUTTA_METHODS(LAG_DECLARE_TABLEAU)
extern const lag_tableau lag_euler_tableau;
