/* rk4: the classical Runge-Kutta method with a fixed step. Enters: t, y; leaves: t + h, y one step later.
 * Holds: sums over steps of y and t are compensated (steps.h).
 *
 * Source: W. Kutta, Z. Math. Phys. 46 (1901) 435. f at the end of a step is the first stage of the next,
 * so dense output (lag_hermite) costs nothing. */
#include <math.h>
#include <string.h>

#include "lag.h"
#include "methods/steps.h"
#include "methods/tangent.h"

/* Saved state of the method, doubles only; x holds the arrays of n named below. */
typedef struct Rk4 {
  lag_fixed_step step;
  double ready; /* 1: K1 = f(t, y) is known */
  double x[];
} Rk4;

enum { K1, K2, K3, K4, F0, Y0, Y1, YS, COMP, NARRAYS };

static const lag_tableau tableau = {
    .stages = 5,
    .order = 4,
    .c = {0, 0.5, 0.5, 1, 1},
    .a = {{0}, {0.5}, {0, 0.5}, {0, 0, 1}, {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}},
};

static const lag_method_option options[] = {LAG_STEP_OPTION};

static size_t work_size(const lag_problem *pb) { return sizeof(Rk4) / sizeof(double) + NARRAYS * (size_t)pb->n; }

static void reset(void *work, lag_problem *pb) {
  Rk4 *w = work;
  w->ready = 0;
  w->step.tc = 0;
  memset(w->x + COMP * pb->n, 0, (size_t)pb->n * sizeof(double));
}

static int init(void *work, lag_problem *pb, const double *opt) {
  Rk4 *w = work;
  w->step.h = lag_step_size(pb, opt[0]);
  reset(work, pb);
  return LAG_OK;
}

/* K1..K4 := the four stages, YS := their weighted sum, the increment of y divided by h. */
static int stages(Rk4 *w, lag_problem *pb, double t, const double *y, double dt) {
  int n = pb->n;
  double *restrict ys = w->x + YS * n;

  for (int s = w->ready != 0.0; s < 4; s++) {
    const double *restrict k = w->x + (s ? s - 1 : 0) * n;
    double c = tableau.c[s] * dt, ts = t + c; /* each stage takes the slope of the one before */
    for (int i = 0; i < n; i++) ys[i] = s ? y[i] + c * k[i] : y[i];
    int rc = lag_rhs(pb, ts, ys, w->x + s * n);
    if (rc) return lag_step_refused(pb, rc, ts);
  }
  const double *restrict k1 = w->x + K1 * n, *restrict k2 = w->x + K2 * n;
  const double *restrict k3 = w->x + K3 * n, *restrict k4 = w->x + K4 * n, *weight = tableau.a[4];
  for (int i = 0; i < n; i++) ys[i] = weight[0] * k1[i] + weight[1] * k2[i] + weight[2] * k3[i] + weight[3] * k4[i];
  return LAG_OK;
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Rk4 *w = work;
  int n = pb->n, rc;
  size_t bytes = (size_t)n * sizeof(double);
  double *y1 = w->x + Y1 * n, *comp = w->x + COMP * n, *ys = w->x + YS * n;
  lag_next_step next;
  (void)t_stop;
  if ((rc = lag_fixed_step_begin(&w->step, pb, *t, &next)) != 0 || (rc = stages(w, pb, *t, y, next.dt)) != 0) return rc;
  /* A failure must leave y and its compensation unchanged: test before the sums. */
  if ((pb->bad_index = lag_not_finite(n, ys)) >= 0) return lag_step_failed(pb, LAG_ENAN, *t);
  memcpy(w->x + F0 * n, w->x + K1 * n, bytes);
  memcpy(w->x + Y0 * n, y, bytes);
  for (int i = 0; i < n; i++) y1[i] = lag_compensated_sum(y[i], next.dt * ys[i], &comp[i]);
  w->ready = 0;
  if ((rc = lag_project_step(pb, next.tb, y, y1, comp)) != 0) return lag_step_not_projected(pb, rc, next.tb);
  rc = lag_step_rhs(pb, next.tb, y1, w->x + K1 * n);
  if (rc) return rc;
  memcpy(y, y1, bytes);
  w->ready = 1;
  lag_fixed_step_end(&w->step, &next, t);
  return LAG_OK;
}

static void dense(void *work, lag_problem *pb, double t, double *y) {
  const Rk4 *w = work;
  int n = pb->n;
  lag_hermite(pb->nq, pb->nz, w->step.dt, (t - w->step.t0) / w->step.dt, w->x + Y0 * n, w->x + F0 * n, w->x + Y1 * n,
              w->x + K1 * n, y);
}

static size_t tangent_size(const lag_problem *pb, int k) { return lag_tangent_size(pb, tableau.stages, k); }

static int tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  Rk4 *w = work;
  double dt = lag_tangent_span(w->step.t0, t, w->step.h * pb->dir);
  return lag_tangent_explicit(&tableau, pb, w->step.t0, dt, w->x + Y0 * pb->n, k, Y, scratch);
}

const lag_method lag_rk4 = {
    .name = "rk4",
    .order = 4,
    .dense_order = 4,
    .flags = LAG_METHOD_CONSTRAINTS,
    .doc = "classical Runge-Kutta, fixed step. Kutta 1901",
    .noptions = 1,
    .options = options,
    .work_size = work_size,
    .init = init,
    .step = step,
    .dense = dense,
    .reset = reset,
    .tangent_size = tangent_size,
    .tangent = tangent,
};
