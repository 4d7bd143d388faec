/* The Taylor coefficients of the models of test_rt_models.h, by hand: a rule for the accelerations of each order. No
 * states, at most two coordinates. */
#ifndef TEST_RT_TAYLOR_H
#define TEST_RT_TAYLOR_H

enum { TAYLOR_COLUMNS = 8, TAYLOR_WIDTH = 4, TAYLOR_ORDERS = LAG_TAYLOR_ORDER + 1 };

/* The accelerations of order k > 0, at x[k*TAYLOR_COLUMNS + 2 nq], from all that x has of the orders up to k. */
typedef void taylor_order(int k, double T, double *x, double *w);

UNUSED static void taylor_orders(taylor_order *order, int nq, int n, double T, double *x, double *w)
{
  for (int k = 1; k <= n; k++) {
    const double *last = x + (k - 1) * TAYLOR_COLUMNS;
    for (int i = 0; i < 2 * nq; i++) {
      x[k * TAYLOR_COLUMNS + i] = T * last[nq + i] / k;
    }
    order(k, T, x, w);
  }
}

UNUSED static void taylor_at(SELF, int n, double s, const double *x, double *y, double *dy) {
  for (int i = 0; i < TAYLOR_WIDTH; i++) {
    double sum = 0, slope = 0;
    for (int k = n; k > 0; k--) {
      slope = slope * s + sum;
      sum = sum * s + x[k * TAYLOR_COLUMNS + i];
    }
    y[i] = sum * s;
    dy[i] = slope * s + sum;
  }
}

/* name_taylor, from name_accel and name_order, which finds in w[0] whether the input, if there is one, follows its
 * formula. */
#define TAYLOR(name, nq, nu)                                                                 \
  UNUSED static int name##_first(ARGS, UNUSED const double *follows, double *x, double *w) { \
    memcpy(x, q, (nq) * sizeof *q);                                                          \
    memcpy(x + (nq), v, (nq) * sizeof *v);                                                   \
    w[0] = (nu) > 0 ? follows[0] : 0;                                                        \
    return name##_accel(self, t, q, v, z, p, u, x + 2 * (nq), NULL, w);                      \
  }                                                                                          \
  UNUSED static void name##_rest(SELF, int n, double T, double *x, double *w) {              \
    taylor_orders(name##_order, nq, n, T, x, w);                                             \
  }                                                                                          \
  UNUSED static const lag_taylor name##_taylor = {.order = LAG_TAYLOR_ORDER,                 \
                                                  .columns = TAYLOR_COLUMNS,                 \
                                                  .width = TAYLOR_WIDTH,                     \
                                                  .nw = 2 * TAYLOR_ORDERS,                   \
                                                  .cost_first = 20,                          \
                                                  .cost_next = 20,                           \
                                                  .sums = 4,                                 \
                                                  .first = name##_first,                     \
                                                  .rest = name##_rest,                       \
                                                  .at = taylor_at}

/* x'' = -slope x + c + rate t, where the input follows its formula. */
#define TAYLOR_LINEAR(name, slope, rate)                                                                \
  UNUSED static void name##_order(int k, UNUSED double T, double *x, UNUSED double *w)                  \
  {                                                                                                     \
    double *row = x + k * TAYLOR_COLUMNS;                                                               \
    row[2] = -(slope) * row[0] + ((rate) != 0 && k == 1 && w[0] != 0.0 ? (rate) * T : 0);               \
  }                                                                                                     \
  TAYLOR(name, 1, (rate) != 0)

/* a = -q k, k = r2^(-3/2), r2 = q.q: so r2 k' = -(3/2) r2' k. Of order 0, k is -a/q by the larger coordinate. */
UNUSED static void kepler_order(int k, UNUSED double T, double *x, double *w)
{
  double *r2 = w, *c = w + TAYLOR_ORDERS, sum = 0;
  int larger = fabs(x[1]) > fabs(x[0]);

  if (k == 1) {
    r2[0] = x[0] * x[0] + x[1] * x[1];
    c[0] = -x[4 + larger] / x[larger];
  }
  r2[k] = 0;
  for (int j = 0; j <= k; j++) {
    for (int i = 0; i < 2; i++) {
      r2[k] += x[j * TAYLOR_COLUMNS + i] * x[(k - j) * TAYLOR_COLUMNS + i];
    }
  }
  for (int j = 0; j < k; j++) {
    sum += (-1.5 * (k - j) - j) * r2[k - j] * c[j];
  }
  c[k] = sum / (k * r2[0]);
  for (int i = 0; i < 2; i++) {
    double *a = &x[k * TAYLOR_COLUMNS + 4 + i];
    *a = 0;
    for (int j = 0; j <= k; j++) {
      *a -= c[j] * x[(k - j) * TAYLOR_COLUMNS + i];
    }
  }
}

#endif
