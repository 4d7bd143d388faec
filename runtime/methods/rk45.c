/* rk45: Dormand-Prince 5(4) with adaptive steps and dense output. Enters: t, y; leaves: the next accepted
 * t, y. Holds: a rejected step leaves t, y as they were; the last stage of a step is the first of the next.
 *
 * Sources: J.R. Dormand, P.J. Prince, J. Comput. Appl. Math. 6 (1980) 19, DOI 10.1016/0771-050X(80)90013-3
 * (coefficients). E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I (1993),
 * II.4 (error norm, PI controller, first step) and II.6 with code dopri5 (Shampine's dense output of order 4).
 *
 * A step is accepted when sqrt(1/n sum (err_i / s_i)^2) <= 1, s_i = atol + tol max(|y_i|, |y1_i|), with
 * atol = tol unless the option says otherwise; err is the difference to the embedded method, SI units. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "lag.h"
#include "methods/tableau.h"

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
    .b = {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84, 0},
    .e = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40},
    .d = {-12715105075.0 / 11282082432, 0, 87487479700.0 / 32700410799, -10690763975.0 / 1880347072,
          701980252875.0 / 199316789632, -1453857185.0 / 822651844, 69997945.0 / 29380423},
};

static const lag_tableau *const tab = &lag_dopri5_tableau;

/* One block of doubles; x holds K1..K7, then the arrays of n named below. */
typedef struct Rk45 {
  double h;         /* the next step to try, > 0; 0: not chosen yet */
  double h_option, h_max, atol;
  double ready;     /* 1: K1 = f(t, y) is known; 2: it stands in K7 */
  double err_power; /* (error of the last accepted step)^beta, of the PI controller */
  double t0, dt;    /* the last step */
  double t_begin;   /* where the first step began */
  double begun;
  double x[];
} Rk45;

enum { K7 = 6, Y0 = 7, Y1, YS, NARRAYS };

static const double beta = 0.04, safety = 0.9, shrink_most = 0.2, grow_most = 10;

enum { OPT_STEP, OPT_MAX, OPT_ATOL };

static const lag_method_option options[] = {
    {"step", "first step to try [s]; 0: chosen from the tolerance", 0, 0, HUGE_VAL, NULL},
    {"max_step", "largest step [s]; 0: a tenth of the scene's span, or the time since the start", 0, 0, HUGE_VAL,
     NULL},
    {"atol", "absolute tolerance [SI]; 0: the same number as the relative one", 0, 0, HUGE_VAL, NULL},
};

static size_t work_size(const lag_problem *pb)
{
  return sizeof(Rk45) / sizeof(double) + NARRAYS * (size_t)pb->n;
}

static void reset(void *work, lag_problem *pb)
{
  Rk45 *w = work;

  (void)pb;
  w->ready = 0;
  w->h = w->h_option;
  w->err_power = pow(1e-4, beta);
}

static int init(void *work, lag_problem *pb, const double *opt)
{
  Rk45 *w = work;

  w->h_option = opt[OPT_STEP];
  w->h_max = opt[OPT_MAX] > 0 ? opt[OPT_MAX] : pb->span / 10;
  w->atol = opt[OPT_ATOL] > 0 ? opt[OPT_ATOL] : pb->tol;
  reset(work, pb);
  return LAG_OK;
}

/* Root mean square of x against the scale of the error norm at y. */
static double norm(const Rk45 *w, const lag_problem *pb, const double *x, const double *y)
{
  double s = 0;

  for (int i = 0; i < pb->n; i++) {
    double r = x[i] / (w->atol + pb->tol * fabs(y[i]));
    s += r * r;
  }
  return sqrt(s / (pb->n ? pb->n : 1));
}

/* The first step, HNW II.4 "starting step size": one Euler step measures the second derivative. */
static double first_step(Rk45 *w, lag_problem *pb, double t, const double *y)
{
  int n = pb->n;
  const double *k1 = w->x;
  double *y1 = w->x + Y1 * n, *f1 = w->x + n;
  double d0 = norm(w, pb, y, y), d1 = norm(w, pb, k1, y);
  double h0 = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1;

  if (w->h_max > 0 && h0 > w->h_max) {
    h0 = w->h_max;
  }
  for (int i = 0; i < n; i++) {
    y1[i] = y[i] + pb->dir * h0 * k1[i];
  }
  if (lag_rhs(pb, t + pb->dir * h0, y1, f1) != 0) {
    return h0 * 1e-3;
  }
  for (int i = 0; i < n; i++) {
    f1[i] -= k1[i];
  }
  double d2 = norm(w, pb, f1, y) / h0, d = d1 > d2 ? d1 : d2;
  double h1 = d <= 1e-15 ? fmax(1e-6, h0 * 1e-3) : pow(0.01 / d, 0.2);
  double h = fmin(100 * h0, h1);
  return isfinite(h) && h > 0 ? h : h0 * 1e-3;
}

/* f at the start of a step into K1, and a step to try. */
static int prepare(Rk45 *w, lag_problem *pb, double t, const double *y)
{
  int n = pb->n;

  if (w->ready == 2.0) {
    memcpy(w->x, w->x + K7 * n, (size_t)n * sizeof(double));
  } else if (w->ready == 0.0) {
    int rc = lag_rhs(pb, t, y, w->x);
    pb->bad_t = t;
    if (rc) {
      return rc > 0 ? LAG_EDOMAIN : rc < -1 ? LAG_EMODEL : rc;
    }
    if ((pb->bad_index = lag_not_finite(n, w->x)) >= 0) {
      return LAG_ENAN;
    }
  }
  w->ready = 1;
  if (w->begun == 0.0) {
    w->begun = 1;
    w->t_begin = t;
  }
  if (w->h == 0.0) {
    w->h = first_step(w, pb, t, y);
  }
  return LAG_OK;
}

/* out := sum_j coef[j] K_j over j < count, two columns a pass: each pass is a plain loop over contiguous arrays. */
static void sum_up(const double *k, int n, int count, const double *coef, double *restrict out)
{
  double c0 = coef[0];

  for (int i = 0; i < n; i++) {
    out[i] = c0 * k[i];
  }
  for (int j = 1; j < count; j += 2) {
    const double *restrict ka = k + j * n, *restrict kb = j + 1 < count ? ka + n : ka;
    double ca = coef[j], cb = j + 1 < count ? coef[j + 1] : 0;
    for (int i = 0; i < n; i++) {
      out[i] += ca * ka[i] + cb * kb[i];
    }
  }
}

/* K2..K7 and the result in Y1. > 0: a smaller step may help. */
static int stages(Rk45 *w, lag_problem *pb, double t, const double *y, double dt)
{
  int n = pb->n;

  for (int s = 1; s < tab->stages; s++) {
    double *ys = w->x + (s == K7 ? Y1 : YS) * n, ts = t + tab->c[s] * dt;
    sum_up(w->x, n, s, tab->a[s], ys);
    for (int i = 0; i < n; i++) {
      ys[i] = y[i] + dt * ys[i];
    }
    int rc = lag_rhs(pb, ts, ys, w->x + s * n);
    if (rc) {
      pb->bad_t = ts;
      return rc < -1 ? LAG_EMODEL : rc;
    }
  }
  return LAG_OK;
}

/* The norm of the error of the step just computed; NaN when anything in it is not finite. */
static double error_of(Rk45 *w, const lag_problem *pb, const double *y, double dt)
{
  int n = pb->n;
  const double *y1 = w->x + Y1 * n;
  double s = 0, *err = w->x + YS * n;

  sum_up(w->x, n, tab->stages, tab->e, err);
  for (int i = 0; i < n; i++) {
    double a = fabs(y[i]), b = fabs(y1[i]), e = dt * err[i] / (w->atol + pb->tol * (a > b ? a : b));
    s += e * e;
  }
  return isfinite(s) ? sqrt(s / (n ? n : 1)) : NAN;
}

/* The limit on steps: the option, or else what has been seen of the motion so far. */
static double longest(const Rk45 *w, double t)
{
  if (w->h_max > 0) {
    return w->h_max;
  }
  double seen = fabs(t - w->t_begin);
  return seen > 0 ? seen : HUGE_VAL;
}

/* Takes the step just computed, and chooses the next. One pow for the error, one for its memory. */
static void accept(Rk45 *w, lag_problem *pb, double *t, double *y, double dt, double tb, double err, int retried)
{
  int n = pb->n;
  size_t bytes = (size_t)n * sizeof(double);
  double f = err > 0 ? pow(err, 0.2 - 0.75 * beta) / (w->err_power * safety) : 0;

  f = fmin(1 / shrink_most, fmax(retried ? 1 : 1 / grow_most, f));
  memcpy(w->x + Y0 * n, y, bytes);
  memcpy(y, w->x + Y1 * n, bytes);
  w->t0 = *t;
  w->dt = dt;
  w->h /= f;
  w->err_power = pow(fmax(err, 1e-4), beta);
  w->ready = 2;
  *t = tb;
}

/* Why a step could not be made small enough. */
static int too_small(const Rk45 *w, lag_problem *pb, double t, int cause)
{
  pb->bad_index = -1;
  for (int s = 0; s < tab->stages && cause == LAG_ENAN && pb->bad_index < 0; s++) {
    pb->bad_index = lag_not_finite(pb->n, w->x + s * pb->n);
  }
  if (cause != LAG_ENAN) {
    pb->bad_t = t;
  }
  return cause;
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop)
{
  Rk45 *w = work;
  int cause = LAG_ESTEP, retried = 0, rc = prepare(w, pb, *t, y);

  (void)t_stop;
  while (rc == 0) {
    w->h = fmin(w->h, longest(w, *t));
    double dt = pb->dir * w->h, tb = *t + dt;
    if (w->h <= 4 * DBL_EPSILON * fabs(*t) || w->h < DBL_MIN / DBL_EPSILON) {
      return too_small(w, pb, *t, cause);
    }
    rc = stages(w, pb, *t, y, dt);
    if (rc < 0) {
      return rc;
    }
    double err = rc ? NAN : error_of(w, pb, y, dt);
    if (err <= 1) {
      accept(w, pb, t, y, dt, tb, err, retried);
      return LAG_OK;
    }
    if (isnan(err)) {
      cause = rc ? LAG_EDOMAIN : LAG_ENAN;
      pb->bad_t = tb;
      w->h /= 2;
    } else {
      cause = LAG_ESTEP;
      w->h *= fmax(shrink_most, safety * pow(err, -(0.2 - 0.75 * beta)));
    }
    retried = 1;
    pb->rejected++;
    rc = 0;
  }
  return rc;
}

/* HNW II.6, code dopri5, function contd5. At the ends it returns the states themselves. */
static void dense(const void *work, const lag_problem *pb, double t, double *y)
{
  const Rk45 *w = work;
  int n = pb->n;
  double s = (t - w->t0) / w->dt, r = 1 - s;
  const double *k = w->x, *y0 = k + Y0 * n, *y1 = k + Y1 * n;

  for (int i = 0; i < n; i++) {
    double diff = y1[i] - y0[i], b = w->dt * k[i] - diff, e = 0;
    for (int j = 0; j < tab->stages; j++) {
      e += tab->d[j] * k[j * n + i];
    }
    y[i] = y0[i] + s * (diff + r * (b + s * (diff - w->dt * k[K7 * n + i] - b + r * w->dt * e)));
  }
}

const lag_method lag_rk45 = {
    .name = "rk45",
    .order = 5,
    .dense_order = 4,
    .doc = "Dormand-Prince 5(4), adaptive. DOI 10.1016/0771-050X(80)90013-3",
    .flags = LAG_METHOD_ADAPTIVE,
    .noptions = 3,
    .options = options,
    .work_size = work_size,
    .init = init,
    .step = step,
    .dense = dense,
    .reset = reset,
};
