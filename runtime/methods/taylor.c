/* taylor: Taylor series of the motion, with steps and an order chosen from the tolerance. Enters: t, y; leaves: the
 * next accepted t, y. Holds: a step takes the series at its start and one evaluation at its end, which is order 0 of
 * the next series; M is factored once a step.
 *
 * Source of the recurrences: the compiler's series/series.h. Source of the step size: A. Jorba, M. Zou, Experimental
 * Mathematics 14 (2005) 99, DOI 10.1080/10586458.2005.10128904, section 3: with x_k the coefficient of order k the
 * root test of the radius of convergence gives h = c min(|x_(p-1)|^(-1/(p-1)), |x_p|^(-1/p)). Here |x| = max |x_i| /
 * (|y_i| + |T y_i'| + floor_i), T about the last step, so that a component may pass through zero. Motions with
 * symmetries have series with gaps: a pendulum released at a right angle has only the coefficients 2, 6, 10, ... of
 * its angle. So here
 *  1. the root test uses the last WINDOW coefficients, r = max_k |x_k|^(1/k), and h is such that a series with |x_k|
 *    = r^k
 *     omits a fraction of the tolerance: (r h)^(p+1) = rtol/4, and less near rounding;
 *  2. the defect at the end of the step, y'(h) of the polynomial minus the model's f(y(h)), depends on all omitted
 *     coefficients. The error it implies must be below the tolerance, or the step is made smaller. A defect that
 *     does not
 *     shrink with the step as h^p is rounding, and is accepted.
 * The order p is the one with the most time covered per operation: h = rtol^(1/(p+1))/r, and order k costs an
 * evaluation and k - 1 terms of each sum. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/rhs.h"
#include "kernels/taylor_order.h"
#include "lag.h"
#include "methods/step_control.h"
#include "methods/steps.h"
#include "methods/method_tangent.h"
#include "methods/taylor.h"

enum { LEAST_ORDER = 6 };

enum { OPT_ORDER = LAG_NADAPTIVE_OPTIONS, NOPTIONS };

static const lag_method_option options[NOPTIONS] = {
    {"step", "size of the step [s] where adapt is off; 0: a 10000th of the scene's span", 0, 0, HUGE_VAL,
     .choices = NULL},
    LAG_MAX_STEP_OPTION,
    LAG_ATOL_OPTION,
    {"adapt", "off: every step has the size `step`, whatever the error", 0, 0, 1, .choices = lag_on_off},
    {"order", "order of the series; 0: chosen from the tolerance and what an order costs", 0, 0, LAG_TAYLOR_ORDER, NULL,
     .every = 1},
};

double lag_taylor_order(const double *method_work) { return ((const Taylor *)(const void *)method_work)->order; }

static size_t work_size(const lag_problem *pb) {
  const lag_taylor *ty = pb->model->taylor;
  size_t head = sizeof(Taylor) / sizeof(double);
  return ty ? head + (size_t)(TAYLOR_ARRAYS * ty->width + 2 * (ty->order + 1) * ty->columns + pb->model->nu) : head;
}

static void reset(void *work, lag_problem *pb) {
  Taylor *w = work;
  w->ready = 0;
  w->tc = 0;
  memset(lag_taylor_array(w, pb, TAYLOR_COMP), 0, (size_t)lag_taylor_width(pb) * sizeof(double));
}

/* In lanes instructions are counted, and sums are computed for three orders at once. */
static double best_order(const lag_problem *pb) {
  const lag_taylor *ty = pb->model->taylor;
  lag_taylor_costs c = {400, 0.5, 1, 0.2, ty->cost_first, ty->cost_next, ty->sums};
#if DBL_MANT_DIG != 53
  c.step = 100, c.first = 1, c.product = 2;
#endif
  if (ty->lanes) c.step = 800, c.term = 0, c.product = 1.3;
  return fmax(LEAST_ORDER, lag_taylor_best_order(&c, pb->tol, DBL_EPSILON, ty->lanes ? 3 : 1, ty->order));
}

static int init(void *work, lag_problem *pb, const double *opt) {
  Taylor *w = work;
  w->order = fmin(pb->model->taylor->order, opt[OPT_ORDER] > 0 ? opt[OPT_ORDER] : best_order(pb));
  w->reach = exp2(-lag_taylor_bits(pb->tol, DBL_EPSILON) / (w->order + 1));
  lag_step_limits_init(&w->limits, pb, opt);
  for (int i = 0; i < pb->model->nu; i++) lag_taylor_follows(w, pb)[i] = isnan(pb->hold[i]) && pb->model->inputs;
  reset(work, pb);
  return LAG_OK;
}

/* x := order 0 of the series at t, y. Returns 0 or the model's status; > 0 with pb->bad_index >= 0 where a rate is not
 * finite. */
static int first(Taylor *w, lag_problem *pb, double t, const double *y, double *x) {
  int nq = pb->nq, rc = lag_inputs_inline(pb, t);
  pb->rhs_calls++;
  pb->bad_index = -1;
  rc = rc ? rc
          : pb->model->taylor->first(pb->model->taylor, t, y, y + nq, y + 2 * nq, pb->p, pb->u,
                                     lag_taylor_follows(w, pb), x, pb->work);
  if (rc == 0) {
    int bad = lag_not_finite(nq + pb->nz, x + pb->n);
    pb->bad_index = bad < 0 ? -1 : nq + bad;
    rc = bad < 0 ? 0 : LAG_ERETRY;
  }
  return rc;
}

/* Instance of kernels/taylor_step.h. */
#define LAG_SERIES_MODEL Taylor *w, lag_problem *pb
#define LAG_SERIES_FLOOR(i) lag_tolerance_floor(&w->limits, pb, i)
#define LAG_SERIES_BEGIN(t, y, x) first(w, pb, t, y, x)
#define LAG_SERIES_REST(order, unit, x) ((void)w, pb->model->taylor->rest(pb->model->taylor, order, unit, x, pb->work))
#define LAG_SERIES_AT(order, s, x, sum, slope) pb->model->taylor->at(pb->model->taylor, order, s, x, sum, slope)
#include "kernels/taylor_step.h"

static lag_taylor_frame frame_of(Taylor *w, lag_problem *pb) {
  return (lag_taylor_frame){
      .order = (int)w->order, .columns = pb->model->taylor->columns, .nq = pb->nq, .nz = pb->nz,
      .x = lag_taylor_series(w, pb, w->now), .end = lag_taylor_series(w, pb, 1 - w->now),
      .sum = lag_taylor_array(w, pb, TAYLOR_SUM), .slope = lag_taylor_array(w, pb, TAYLOR_SLOPE),
      .scale = lag_taylor_array(w, pb, TAYLOR_SCALE), .lost = lag_taylor_array(w, pb, TAYLOR_COMP),
      .y1 = lag_taylor_array(w, pb, TAYLOR_Y1), .lost1 = lag_taylor_array(w, pb, TAYLOR_COMP1)};
}

/* Expands the series of the next step from its order 0; the unit: of y, or else about the last step. Returns 0 where
 * there is none. */
static int expand(Taylor *w, lag_problem *pb, const double *y) {
  const lag_taylor_frame f = frame_of(w, pb);
  double unit = y ? lag_taylor_unit(w, pb, &f, y) : lag_power_below(w->dt);
  int none = lag_taylor_expand(w, pb, &f, pb->dir, 1, &unit);
  w->unit[w->now > 0] = pb->dir * unit;
  return !none;
}

int lag_taylor_prepare(Taylor *w, lag_problem *pb, double t, const double *y) {
  lag_step_limits_begin(&w->limits, t);
  if (w->ready != 0.0) return LAG_OK;
  int rc = first(w, pb, t, y, lag_taylor_series(w, pb, w->now));
  if (rc) return pb->bad_index >= 0 ? lag_step_failed(pb, LAG_ENAN, t) : lag_step_refused(pb, rc, t);
  if (!expand(w, pb, y)) {
    pb->detail = "the Taylor series does not exist here; dop853 needs none";
    return lag_step_failed(pb, LAG_ENAN, t);
  }
  w->ready = 1;
  return LAG_OK;
}

/* Accepts the step, and expands the next series from order 0 at its end. */
static void accept(Taylor *w, lag_problem *pb, double *t, double *y, double dt, double tb) {
  lag_copy(pb->n, lag_taylor_array(w, pb, TAYLOR_Y1), y);
  lag_copy(pb->n, lag_taylor_array(w, pb, TAYLOR_COMP1), lag_taylor_array(w, pb, TAYLOR_COMP));
  w->t0 = *t;
  w->dt = dt;
  *t = tb;
  w->now = 1 - w->now;
  w->ready = expand(w, pb, NULL);
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Taylor *w = work;
  int cause = LAG_ESTEP, rc = lag_taylor_prepare(w, pb, *t, y);
  (void)t_stop;
  if (rc) return rc;
  const lag_taylor_frame f = frame_of(w, pb);
  double unit = w->unit[w->now > 0], last = -1, error;
  double h = lag_taylor_size(w, pb, &f, y, fabs(unit), w->reach, lag_longest_step(&w->limits, *t, 0));
  if (w->limits.fixed != 0.0) h = w->limits.h_option;
  for (;;) {
    double tc = w->tc, tb = w->limits.fixed != 0.0 ? lag_compensated_sum(*t, pb->dir * h, &tc) : *t + pb->dir * h;
    double dt = tb - *t; /* the step between two times as rounded */
    if (!(fabs(dt) > 4 * DBL_EPSILON * fabs(*t)) || h < DBL_MIN / DBL_EPSILON)
      return cause == LAG_ESTEP || cause == LAG_ESINGULAR ? lag_step_failed(pb, cause, *t) : cause;
    rc = lag_taylor_try(w, pb, &f, y, unit, tb, dt, &error);
    if (rc < 0 && rc != LAG_ESINGULAR) return lag_step_refused(pb, rc, tb);
    error = rc ? -1 : error / pb->tol;
    if (lag_taylor_takes(rc == 0, error, last, &w->noise) || (w->limits.fixed != 0.0 && rc == 0)) {
      accept(w, pb, t, y, dt, tb);
      w->tc = tc;
      return LAG_OK;
    }
    cause = rc ? (pb->bad_index >= 0 ? LAG_ENAN : rc < 0 ? LAG_ESINGULAR : LAG_EDOMAIN) : LAG_ESTEP;
    pb->bad_t = tb;
    if (w->limits.fixed != 0.0) return cause;
    last = error;
    h *= lag_taylor_shrinkage((int)w->order, error);
    pb->rejected++;
  }
}

static void dense(void *work, lag_problem *pb, double t, double *y) {
  Taylor *w = work;
  double which = 1 - w->now, *sum = lag_taylor_array(w, pb, TAYLOR_SUM);
  const double *x = lag_taylor_series(w, pb, which);
  pb->model->taylor->at(pb->model->taylor, (int)w->order, (t - w->t0) / w->unit[which > 0], x, sum,
                        lag_taylor_array(w, pb, TAYLOR_SLOPE));
  for (int i = 0; i < pb->n; i++) y[i] = x[i] + sum[i];
}

static size_t tangent_size(const lag_problem *pb, int k) { return lag_tangent_along_size(pb, k); }

/* The series is the motion to the tolerance, so its derivative is that of the flow. */
static int tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  const Taylor *w = work;
  return lag_tangent_along(dense, work, (lag_step_taken){pb, w->t0, t - w->t0, NULL}, k, Y, scratch);
}

const lag_method lag_taylor_method = {
    .name = "taylor",
    .head = sizeof(Taylor) / sizeof(double), /* coefficients are written before they are read */
    .order = 20,
    .dense_order = 20,
    .order_least = 1,
    .order_most = LAG_TAYLOR_ORDER,
    .doc = "Taylor series of an order that follows from the tolerance, for tolerances below 1e-9. DOI "
           "10.1080/10586458.2005.10128904",
    .flags = LAG_METHOD_ADAPTIVE | LAG_METHOD_TAYLOR,
    .noptions = NOPTIONS,
    .options = options,
    LAG_METHOD_FUNCTIONS,
    LAG_METHOD_TANGENT,
};
