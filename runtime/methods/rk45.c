/* rk45: Dormand-Prince 5(4) with adaptive steps and dense output of order 4. Steps: adaptive_rk.c.
 *
 * Sources: J.R. Dormand, P.J. Prince, J. Comput. Appl. Math. 6 (1980) 19, DOI 10.1016/0771-050X(80)90013-3
 * (coefficients). E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I (1993), II.6 with
 * code dopri5 (Shampine's dense output of order 4). */
#include "kernels/runge_kutta_tables.h"
#include "methods/adaptive_rk.h"

/* The method's tables, and its trial step. */
static double trial(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc);
static const EmbeddedPair pair = {.tab = &lag_rk45_tableau, .control = {LAG_RK45_CONTROL}, .trial = trial};
#define EMBEDDED_STAGES LAG_RK45_STAGES LAG_RK45_RESULT
#define EMBEDDED_ERRORS LAG_RK45_ERRORS
#include "methods/embedded_trial.h"
EMBEDDED_TRIAL(trial, pair, 0)

/* HNW II.6, code dopri5, function contd5. At the ends it returns the states themselves. */
static void dense(void *work, lag_problem *pb, double t, double *y) {
  Embedded *w = work;
  int row = lag_adaptive_rk_row(pb), last = pair.tab->stages - 1;
  double s = (t - w->t0) / w->dt, r = 1 - s, *high = w->x + EMBEDDED_YS * row;
  const double *k = w->x + EMBEDDED_K1 * row, *y0 = w->x + EMBEDDED_Y0 * row, *y1 = w->x + EMBEDDED_Y1 * row;
  EmbeddedShape as = embedded_shape(pb);
  LAG_RK45_DENSE
  for (int i = 0; i < pb->n; i++) {
    double diff = y1[i] - y0[i], b = w->dt * k[i] - diff;
    y[i] = y0[i] + s * (diff + r * (b + s * (diff - w->dt * k[last * row + i] - b + r * w->dt * high[i])));
  }
}

const lag_method lag_rk45 = {
    .name = "rk45",
    .order = 5,
    .dense_order = 4,
    .doc = "Dormand-Prince 5(4), DOI 10.1016/0771-050X(80)90013-3",
    EMBEDDED_DESCRIPTOR,
};
