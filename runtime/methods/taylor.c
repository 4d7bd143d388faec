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

/* Order 0 of series[which] at t, y. Returns 0 or the model's status; > 0 with pb->bad_index >= 0 where a rate is not
 * finite. */
static int first(Taylor *w, lag_problem *pb, double which, double t, const double *y) {
  int nq = pb->nq, rc = lag_inputs_inline(pb, t);
  double *x = lag_taylor_series(w, pb, which);
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

/* Unit of time of the first series: the time scale of the state, as a power of 2. Later series use about the last
 * step. */
static double guess_unit(Taylor *w, const lag_problem *pb, const double *y) {
  double fastest = 0;
  const double *rates = lag_taylor_series(w, pb, w->now) + pb->n;
  for (int i = 0; i < pb->n; i++)
    fastest = fmax(fastest, fabs(i < pb->nq ? y[pb->nq + i] : rates[i - pb->nq]) /
                                (fabs(y[i]) + lag_tolerance_floor(&w->limits, pb, i)));
  return fastest > 0 && isfinite(fastest) ? ldexp(1, -ilogb(fastest)) : 1;
}

/* Expands series[which] from its order 0, with the given unit of time. 0: coefficients are not finite. */
static int expand(Taylor *w, lag_problem *pb, double which, double unit) {
  const lag_taylor *ty = pb->model->taylor;
  int order = (int)w->order;
  double *x = lag_taylor_series(w, pb, which);
  for (int attempt = 0; attempt < 8; attempt++, unit *= 0x1p-40) {
    w->unit[which > 0] = pb->dir * unit;
    ty->rest(ty, order, pb->dir * unit, x, pb->work);
    if (lag_not_finite(pb->n, x + order * ty->columns) < 0) return 1;
  }
  return 0;
}

int lag_taylor_prepare(Taylor *w, lag_problem *pb, double t, const double *y) {
  lag_step_limits_begin(&w->limits, t);
  if (w->ready != 0.0) return LAG_OK;
  int rc = first(w, pb, w->now, t, y);
  if (rc) return pb->bad_index >= 0 ? lag_step_failed(pb, LAG_ENAN, t) : lag_step_refused(pb, rc, t);
  if (!expand(w, pb, w->now, guess_unit(w, pb, y))) {
    pb->detail = "the Taylor series does not exist here; dop853 needs none";
    return lag_step_failed(pb, LAG_ENAN, t);
  }
  w->ready = 1;
  return LAG_OK;
}

/* Step size by the root test, item 1 above. HUGE_VAL where the last coefficients are zero. */
static double root_test_step(Taylor *w, lag_problem *pb, const double *y) {
  int n = pb->n, columns = pb->model->taylor->columns;
  const double *x = lag_taylor_series(w, pb, w->now);
  double *scale = lag_taylor_array(w, pb, TAYLOR_SCALE);
  for (int i = 0; i < n; i++)
    scale[i] = 1 / (fabs(y[i]) + fabs(x[columns + i]) + lag_tolerance_floor(&w->limits, pb, i));
  double root = lag_taylor_root(x, (int)w->order, columns, n, scale, DBL_MIN);
  return root > 0 ? fabs(w->unit[w->now > 0]) * w->reach / root : HUGE_VAL;
}

/* Error of a step of dt that ends at Y1, in tolerances: item 2 above. */
static double error_of(Taylor *w, lag_problem *pb, double dt) {
  const double *rates = lag_taylor_series(w, pb, 1 - w->now) + pb->n;
  const double *slope = lag_taylor_array(w, pb, TAYLOR_SLOPE), *scale = lag_taylor_array(w, pb, TAYLOR_SCALE);
  double unit = w->unit[w->now > 0];
  return lag_taylor_error((int)w->order, pb->nq, pb->nz, unit, fabs(dt), slope, rates, scale) / pb->tol;
}

/* Y1, COMP1 := the state at t + dt and its compensation. */
static void advance(Taylor *w, lag_problem *pb, const double *y, double dt) {
  const double *comp = lag_taylor_array(w, pb, TAYLOR_COMP);
  double *sum = lag_taylor_array(w, pb, TAYLOR_SUM), *y1 = lag_taylor_array(w, pb, TAYLOR_Y1),
         *comp1 = lag_taylor_array(w, pb, TAYLOR_COMP1);
  pb->model->taylor->at(pb->model->taylor, (int)w->order, dt / w->unit[w->now > 0], lag_taylor_series(w, pb, w->now),
                        sum, lag_taylor_array(w, pb, TAYLOR_SLOPE));
  for (int i = 0; i < pb->n; i++) {
    comp1[i] = comp[i];
    y1[i] = lag_compensated_sum(y[i], sum[i], &comp1[i]);
  }
}

/* Accepts the step, and expands the next series from order 0 at its end. */
static void accept(Taylor *w, lag_problem *pb, double *t, double *y, double dt, double tb) {
  const double *y1 = lag_taylor_array(w, pb, TAYLOR_Y1), *comp1 = lag_taylor_array(w, pb, TAYLOR_COMP1);
  double *comp = lag_taylor_array(w, pb, TAYLOR_COMP);
  for (int i = 0; i < pb->n; i++) {
    y[i] = y1[i];
    comp[i] = comp1[i];
  }
  w->t0 = *t;
  w->dt = dt;
  *t = tb;
  w->now = 1 - w->now;
  w->ready = expand(w, pb, w->now, ldexp(1, ilogb(dt)));
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Taylor *w = work;
  int cause = LAG_ESTEP, rc = lag_taylor_prepare(w, pb, *t, y);
  (void)t_stop;
  if (rc) return rc;
  double h = root_test_step(w, pb, y), most = lag_longest_step(&w->limits, *t, 0), last = -1;
  h = w->limits.fixed != 0.0 ? w->limits.h_option : h < most ? h : most;
  h = isfinite(h) ? h : 1;
  for (;;) {
    double tc = w->tc, tb = w->limits.fixed != 0.0 ? lag_compensated_sum(*t, pb->dir * h, &tc) : *t + pb->dir * h;
    double dt = tb - *t; /* the step between two times as rounded */
    if (!(fabs(dt) > 4 * DBL_EPSILON * fabs(*t)) || h < DBL_MIN / DBL_EPSILON)
      return cause == LAG_ESTEP || cause == LAG_ESINGULAR ? lag_step_failed(pb, cause, *t) : cause;
    advance(w, pb, y, dt);
    rc = first(w, pb, 1 - w->now, tb, lag_taylor_array(w, pb, TAYLOR_Y1));
    if (rc < 0 && rc != LAG_ESINGULAR) return lag_step_refused(pb, rc, tb);
    double error = rc ? NAN : error_of(w, pb, dt);
    if (lag_taylor_takes(rc == 0, error, last, &w->noise) || (w->limits.fixed != 0.0 && rc == 0)) {
      accept(w, pb, t, y, dt, tb);
      w->tc = tc;
      return LAG_OK;
    }
    cause = rc ? (pb->bad_index >= 0 ? LAG_ENAN : rc < 0 ? LAG_ESINGULAR : LAG_EDOMAIN) : LAG_ESTEP;
    pb->bad_t = tb;
    if (w->limits.fixed != 0.0) return cause;
    last = rc ? -1 : error;
    h *= lag_taylor_shrinkage((int)w->order, rc ? -1 : error);
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
  return lag_tangent_along(dense, work, pb, w->t0, t - w->t0, k, Y, scratch);
}

const lag_method lag_taylor_method = {
    .name = "taylor",
    .order = 20,
    .dense_order = 20,
    .order_least = 1,
    .order_most = LAG_TAYLOR_ORDER,
    .doc = "Taylor series of an order that follows from the tolerance, for tolerances below 1e-9. DOI "
           "10.1080/10586458.2005.10128904",
    .flags = LAG_METHOD_ADAPTIVE | LAG_METHOD_TAYLOR,
    .noptions = NOPTIONS,
    .options = options,
    .work_size = work_size,
    .init = init,
    .step = step,
    .dense = dense,
    .reset = reset,
    .tangent_size = tangent_size,
    .tangent = tangent,
};
