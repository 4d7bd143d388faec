/* rk4: the classical Runge-Kutta method with a fixed step. Steps: adaptive_rk.c, without an error estimate. Source:
 * W. Kutta, Z. Math. Phys. 46 (1901) 435. f at the end of a step is the first stage of the next, so dense output
 * (lag_hermite) costs nothing. */
#include "lag.h"
#include "methods/adaptive_rk.h"
#include "methods/steps.h"

/* The method's tables, and its trial step. */
static double trial(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc);
static const EmbeddedPair pair = {.tab = &lag_rk4_tableau, .trial = trial};
#define EMBEDDED_STAGES LAG_RK4_STAGES
#define EMBEDDED_RESULT LAG_RK4_RESULT
#include "methods/embedded_trial.h"

static const lag_method_option options[] = {LAG_STEP_OPTION};

static void dense(void *work, lag_problem *pb, double t, double *y) {
  const Embedded *w = work;
  int row = lag_adaptive_rk_row(pb);
  const double *y0 = w->x + EMBEDDED_Y0 * row, *y1 = w->x + EMBEDDED_Y1 * row, *k = w->x + EMBEDDED_K1 * row;
  lag_hermite(pb->nq, pb->nz, w->dt, (t - w->t0) / w->dt, y0, k, y1, k + (pair.tab->stages - 1) * row, y);
}

const lag_method lag_rk4 = {
    .name = "rk4",
    .order = 4,
    .dense_order = 4,
    .doc = "classical Runge-Kutta, fixed step. Kutta 1901",
    .flags = LAG_METHOD_CONSTRAINTS,
    .noptions = 1,
    .options = options,
    EMBEDDED_FUNCTIONS,
};
