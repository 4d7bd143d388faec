/* euler: Euler's method with a fixed step, y1 = y0 + dt f(t0, y0). Oscillations gain energy, which courses show
 * beside symplectic_euler. Steps: adaptive_rk.c, without an error estimate. Source: L. Euler, Institutiones calculi
 * integralis I (1768), paragraph 650. Dense output is the tangent. */
#include "methods/adaptive_rk.h"
#include "methods/steps.h"

/* The method's tables, and its trial step. */
static double trial(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc);
static const EmbeddedPair pair = {.tab = &lag_euler_tableau, .trial = trial};
#define EMBEDDED_STAGES LAG_EULER_STAGES LAG_EULER_RESULT
#define EMBEDDED_ERRORS (void)per;
#include "methods/embedded_trial.h"
EMBEDDED_TRIAL(trial, pair, 0)

static const lag_method_option options[] = {LAG_STEP_OPTION};

static void dense(void *work, lag_problem *pb, double t, double *y) {
  const Embedded *w = work;
  int row = lag_adaptive_rk_row(pb);
  const double *y0 = w->x + EMBEDDED_Y0 * row, *k = w->x + EMBEDDED_K1 * row;
  for (int i = 0; i < pb->n; i++) y[i] = y0[i] + (t - w->t0) * k[i];
}

const lag_method lag_euler = {
    .name = "euler",
    .order = 1,
    .dense_order = 1,
    .doc = "Euler's method, fixed step; it gains energy. Euler 1768",
    .flags = LAG_METHOD_CONSTRAINTS,
    .noptions = 1,
    .options = options,
    EMBEDDED_FUNCTIONS,
};
