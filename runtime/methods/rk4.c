/* rk4: the classical Runge-Kutta method with a fixed step. Steps: adaptive_rk.c, without an error estimate. Source: W. Kutta, Z. Math. Phys. 46
 * (1901) 435. f at the end of a step is the first stage of the next, so dense output (lag_hermite) costs nothing. */
#include "lag.h"
#include "methods/embedded_trial.h"
#include "methods/steps.h"

static const lag_tableau tableau = {
    .stages = 5,
    .order = 4,
    .c = {0, 0.5, 0.5, 1, 1},
    .a = {{0}, {0.5}, {0, 0.5}, {0, 0, 1}, {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}},
};

EMBEDDED_TRIAL(tableau, 0)

static const EmbeddedPair pair = {.tab = &tableau, .trial = trial};

static const lag_method_option options[] = {LAG_STEP_OPTION};

static void dense(void *work, lag_problem *pb, double t, double *y) {
  const Embedded *w = work;
  int row = lag_adaptive_rk_row(pb);
  const double *y0 = w->x + EMBEDDED_Y0 * row, *y1 = w->x + EMBEDDED_Y1 * row, *k = w->x + EMBEDDED_K1 * row;
  lag_hermite(pb->nq, pb->nz, w->dt, (t - w->t0) / w->dt, y0, k, y1, k + (tableau.stages - 1) * row, y);
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
