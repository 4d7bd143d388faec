/* Error norm and first step of adaptive methods (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I,
 * II.4). */
#include "methods/step_control.h"

#include <math.h>

const char *const lag_on_off[] = {"on", "off", NULL};

void lag_step_limits_init(lag_step_limits *l, const lag_problem *pb, const double *opt) {
  l->fixed = opt[LAG_OPT_ADAPT];
  l->h_option = l->fixed != 0.0 ? lag_step_size(pb, opt[LAG_OPT_STEP]) : opt[LAG_OPT_STEP];
  l->h_max = opt[LAG_OPT_MAX] > 0 ? opt[LAG_OPT_MAX] : pb->span / 10;
  l->atol = opt[LAG_OPT_ATOL];
}

/* Weighted root mean square of x[n], with weights 1/(relative (floor_i + |y_i|)). */
static double lag_error_norm(const lag_problem *pb, const lag_tolerance *tol, const double *x, const double *y) {
  double s = 0;
  for (int i = 0; i < pb->n; i++) {
    double r = x[i] / (tol->relative * lag_tolerance_floor(tol->limits, pb, i) + tol->relative * fabs(y[i]));
    s += r * r;
  }
  return sqrt(s / (pb->n ? pb->n : 1));
}

double lag_first_step(lag_problem *pb, const lag_tolerance *tol, int order, double h_max, double t, const double *y,
                      const double *f0, double *y1, double *f1) {
  const double unit = tol->limits->atol > 0 ? 1 : pb->size[pb->n + 1]; /* of h0, h1, 1/d1 and 1/d2 */
  double d0 = lag_error_norm(pb, tol, y, y), d1 = unit * lag_error_norm(pb, tol, f0, y);
  double h0 = lag_first_euler_step(d0, d1, h_max / unit);

  for (int i = 0; i < pb->n; i++) y1[i] = y[i] + pb->dir * h0 * unit * f0[i];
  if (lag_rhs(pb, t + pb->dir * h0 * unit, y1, f1) != 0) return h0 * unit * 1e-3;
  for (int i = 0; i < pb->n; i++) f1[i] -= f0[i];
  return unit * lag_first_size(order, h0, d1, unit * lag_error_norm(pb, tol, f1, y) / h0);
}
