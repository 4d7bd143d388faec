/* dop853: Dormand-Prince 8(5,3) with adaptive steps and dense output of order 7. Steps: adaptive_rk.c.
 *
 * Source: E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), DOI
 * 10.1007/978-3-540-78862-1: II.5 (the 12 stages of order 8), II.10 (error from estimates of order 5 and 3) and II.6
 * (continuous extension of order 7 from three more stages). The numbers are those of their code dop853.f. */
#include "kernels/dense_output.h"
#include "kernels/runge_kutta_tables.h"
#include "methods/adaptive_rk.h"

/* The method's tables, and its trial step. */
static double trial(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc);
static const EmbeddedPair pair = {.tab = &lag_dop853_tableau, .late = 1, .control = {LAG_DOP853_CONTROL},
                                 .more = LAG_MAX_DENSE, .trial = trial};
#define EMBEDDED_STAGES LAG_DOP853_STAGES LAG_DOP853_RESULT
#define EMBEDDED_ERRORS LAG_DOP853_ERRORS
#include "methods/embedded_trial.h"
EMBEDDED_TRIAL(trial, pair, 0)

/* arrays HIGH..HIGH+3: the highest terms of dense output */
enum { LAST = 12, EXTRA = 3, NSTAGES = 16, HIGH = EMBEDDED_K1 + NSTAGES };

static int extra_stages(Embedded *w, lag_problem *pb, EmbeddedShape as, double t, double h) {
  double *k = w->x + EMBEDDED_K1 * as.row, *x = w->x + EMBEDDED_YS * as.row;
  const double *y = w->x + EMBEDDED_Y0 * as.row;
  int status = 0;
  LAG_DOP853_EXTRA
  return status;
}

/* The three extra stages of dense output, and its four highest terms. have_extra := -1 where the model fails at a
 * stage, though the stages lie inside an accepted step. */
static void extend(Embedded *w, lag_problem *pb) {
  EmbeddedShape as = embedded_shape(pb);
  int row = as.row;
  double *high = w->x + HIGH * row;
  w->have_extra = 1;
  const double *k = w->x + EMBEDDED_K1 * row;
  if (extra_stages(w, pb, as, w->t0, w->dt) || lag_not_finite(EXTRA * row, k + (LAST + 1) * row) >= 0) {
    w->have_extra = -1;
    return;
  }
  LAG_DOP853_DENSE
}

/* Where the extra stages failed: Hermite interpolation, of order 4. */
static void dense(void *work, lag_problem *pb, double t, double *y) {
  Embedded *w = work;
  int row = lag_adaptive_rk_row(pb);
  double s = (t - w->t0) / w->dt;
  const double *k1 = w->x + EMBEDDED_K1 * row;
  const lag_step_ends ends = {w->dt, w->x + EMBEDDED_Y0 * row, k1, w->x + EMBEDDED_Y1 * row, k1 + LAST * row};
  if (w->have_extra == 0.0) extend(w, pb);
  if (w->have_extra < 0) lag_hermite_within(&ends, pb->nq, pb->nz, s, y);
  else lag_contd8(&ends, w->x + HIGH * row, pb->n, row, s, y);
}

const lag_method lag_dop853 = {
    .finest = 1e-27, /* coefficients have 30 digits; those of dense output are as large as 390 */
    .name = "dop853",
    .order = 8,
    .dense_order = 7,
    .doc = "Dormand-Prince 8(5,3), for small tolerances. DOI 10.1007/978-3-540-78862-1, II.5",
    EMBEDDED_DESCRIPTOR,
};
