/* Butcher tableau of an explicit Runge-Kutta method with an embedded error estimate, as data that a test can check. */
#pragma once

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

extern const lag_tableau lag_euler_tableau, lag_rk4_tableau, lag_rk45_tableau, lag_dop853_tableau;
