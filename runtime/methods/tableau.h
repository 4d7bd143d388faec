/* The coefficients of an embedded explicit Runge-Kutta method as data, so that a test can check them. */
#ifndef LAG_METHODS_TABLEAU_H
#define LAG_METHODS_TABLEAU_H

enum { LAG_MAX_STAGES = 16, LAG_MAX_DENSE = 4 };

typedef struct lag_tableau {
  int stages; /* with the last one, f at the end of the step, which the next step begins with */
  int extra;  /* stages that only the dense output needs */
  int order, order_embedded;
  double c[LAG_MAX_STAGES];
  double a[LAG_MAX_STAGES][LAG_MAX_STAGES]; /* a[i][j], j < i; the row of the last stage is the result's */
  double e[LAG_MAX_STAGES];                 /* the result minus that of the embedded method: the error */
  double e3[LAG_MAX_STAGES];                /* a second, coarser estimate, or zeros */
  double d[LAG_MAX_DENSE][LAG_MAX_STAGES];  /* of the highest terms of the dense output */
} lag_tableau;

extern const lag_tableau lag_dopri5_tableau, lag_dop853_tableau;

#endif
