/* rk45: Dormand-Prince 5(4) with adaptive steps and dense output of order 4. Steps: adaptive_rk.c.
 *
 * Sources: J.R. Dormand, P.J. Prince, J. Comput. Appl. Math. 6 (1980) 19, DOI 10.1016/0771-050X(80)90013-3 (coefficients). E. Hairer, S.P. Norsett,
 * G. Wanner, Solving Ordinary Differential Equations I (1993), II.6 with code dopri5 (Shampine's dense output of order 4). */
#include "lag.h"
#include "methods/embedded_trial.h"

const lag_tableau lag_dopri5_tableau = {
    .stages = 7,
    .order = 5,
    .order_embedded = 4,
    .c = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1},
    .a = {{0},
          {1.0 / 5},
          {3.0 / 40, 9.0 / 40},
          {44.0 / 45, -56.0 / 15, 32.0 / 9},
          {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
          {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
          {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}},
    .e = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40},
    .d = {{-12715105075.0 / 11282082432, 0, 87487479700.0 / 32700410799, -10690763975.0 / 1880347072,
           701980252875.0 / 199316789632, -1453857185.0 / 822651844, 69997945.0 / 29380423}},
};

EMBEDDED_TRIAL(lag_dopri5_tableau, 0)

/* HNW II.4: beta = 0.04 damps the steps of a mildly stiff problem at little cost elsewhere. */
static const EmbeddedPair pair = {&lag_dopri5_tableau, 0, 0.04, 4, 0.9, 0.2, 10, 0, trial};

/* HNW II.6, code dopri5, function contd5. At the ends it returns the states themselves. */
static void dense(void *work, lag_problem *pb, double t, double *y) {
  Embedded *w = work;
  int row = lag_adaptive_rk_row(pb), last = pair.tab->stages - 1;
  double s = (t - w->t0) / w->dt, r = 1 - s, *high = w->x + EMBEDDED_YS * row;
  const double *k = w->x + EMBEDDED_K1 * row, *y0 = w->x + EMBEDDED_Y0 * row, *y1 = w->x + EMBEDDED_Y1 * row;
  embedded_combine(pair.tab->d[0], last + 1, embedded_shape(pb), k, high);
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
