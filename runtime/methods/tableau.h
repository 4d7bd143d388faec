/* The coefficients of an embedded explicit Runge-Kutta method as data, so that a test can check them. */
#ifndef LAG_METHODS_TABLEAU_H
#define LAG_METHODS_TABLEAU_H

enum { LAG_MAX_STAGES = 7 };

typedef struct lag_tableau {
  int stages, order, order_embedded;
  double c[LAG_MAX_STAGES];
  double a[LAG_MAX_STAGES][LAG_MAX_STAGES]; /* a[i][j], j < i */
  double b[LAG_MAX_STAGES];                 /* of the result */
  double e[LAG_MAX_STAGES];                 /* b minus the weights of the embedded method: the error */
  double d[LAG_MAX_STAGES];                 /* of the highest term of the dense output */
} lag_tableau;

extern const lag_tableau lag_dopri5_tableau;

#endif
