/* Embedded explicit Runge-Kutta methods with adaptive steps. Enters: t, y; leaves: the next accepted t, y.
 * Holds: a rejected step leaves t, y as they were; the last stage of a step is the first of the next; t and y are
 * summed with compensation (steps.h).
 *
 * Source: E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), DOI
 * 10.1007/978-3-540-78862-1: II.4 (error norm, PI controller, first step), II.10 (the estimate of order 5 with a
 * correction of order 3).
 *
 * A step is accepted when err <= 1, with |x|^2 = 1/n sum (x_i / s_i)^2, s_i = atol + tol max(|y_i|, |y1_i|), atol = tol
 * unless the option says otherwise: err = |e| for one estimate, |e|^2 / sqrt(|e|^2 + 0.01 |e3|^2) for two. */
#include "methods/embedded.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "methods/control.h"
#include "methods/steps.h"
#include "methods/tangent.h"

static const double safety = 0.9;

enum { OPT_STEP, OPT_MAX, OPT_ATOL, OPT_ADAPT };

static const char *const on_off[] = {"on", "off", NULL};

const lag_method_option lag_embedded_options[EMBEDDED_NOPTIONS] = {
    {"step", "first step to try [s]; 0: chosen from the tolerance", 0, 0, HUGE_VAL, NULL},
    {"max_step", "largest step [s]; 0: a tenth of the scene's span, or the time since the start", 0, 0, HUGE_VAL,
     NULL},
    {"atol", "absolute tolerance [SI]; 0: the same number as the relative one", 0, 0, HUGE_VAL, NULL},
    {"adapt", "off: every step has the size `step` (0: a 10000th of the scene's span), whatever the error", 0, 0, 1, on_off},
};

static double *array(Embedded *w, const lag_problem *pb, int which)
{
  return w->x + which * pb->n;
}

size_t lag_embedded_size(const EmbeddedPair *pair, const lag_problem *pb, int more)
{
  int arrays = EMBEDDED_K1 + pair->tab->stages + pair->tab->extra + more;

  return sizeof(Embedded) / sizeof(double) + (size_t)arrays * (size_t)pb->n;
}

void lag_embedded_reset(void *work, lag_problem *pb)
{
  Embedded *w = work;

  w->ready = w->have_extra = 0;
  w->h = w->h_option;
  w->err_power = 0;
  w->tc = 0;
  memset(array(w, pb, EMBEDDED_COMP), 0, (size_t)pb->n * sizeof(double));
}

int lag_embedded_init(void *work, lag_problem *pb, const double *opt)
{
  Embedded *w = work;

  w->fixed = opt[OPT_ADAPT];
  w->h_option = w->fixed != 0.0 ? lag_step_size(pb, opt[OPT_STEP]) : opt[OPT_STEP];
  w->h_max = opt[OPT_MAX] > 0 ? opt[OPT_MAX] : pb->span / 10;
  w->atol = opt[OPT_ATOL] > 0 ? opt[OPT_ATOL] : pb->tol;
  lag_embedded_reset(work, pb);
  return LAG_OK;
}

/* f at the start of a step into K1, and a step to try. */
static int prepare(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, const double *y)
{
  int n = pb->n;
  double *k1 = array(w, pb, EMBEDDED_K1);

  if (w->ready == 2.0) {
    memcpy(k1, k1 + (pair->tab->stages - 1) * n, (size_t)n * sizeof(double));
  } else if (w->ready == 0.0) {
    int rc = lag_step_rhs(pb, t, y, k1);
    if (rc) {
      return rc;
    }
  }
  w->ready = 1;
  w->have_extra = 0;
  if (w->begun == 0.0) {
    w->begun = 1;
    w->t_begin = t;
  }
  if (w->h == 0.0) {
    lag_tolerance tol = {w->atol, pb->tol};
    w->h = lag_first_step(pb, &tol, pair->tab->order, w->h_max, t, y, k1, array(w, pb, EMBEDDED_Y1), k1 + n);
  }
  return LAG_OK;
}

/* Two columns a pass, each pass a plain loop over contiguous arrays; columns of zeros are left out. */
void lag_embedded_sum(const double *k, int n, int count, const double *coef, double *restrict out)
{
  double c0 = coef[0];

  for (int i = 0; i < n; i++) {
    out[i] = c0 * k[i];
  }
  for (int j = 1; j < count; j += 2) {
    double ca = coef[j], cb = j + 1 < count ? coef[j + 1] : 0;
    if (ca == 0.0 && cb == 0.0) {
      continue;
    }
    const double *restrict ka = k + j * n, *restrict kb = j + 1 < count ? ka + n : ka;
    for (int i = 0; i < n; i++) {
      out[i] += ca * ka[i] + cb * kb[i];
    }
  }
}

/* f(t, y) into k. > 0: a smaller step may help. */
static int call(lag_problem *pb, double t, const double *y, double *k)
{
  int rc = lag_rhs(pb, t, y, k);

  if (rc) {
    pb->bad_t = t;
  }
  return rc < -1 ? LAG_EMODEL : rc;
}

int lag_embedded_stage(const lag_tableau *tab, lag_problem *pb, int s, double t0, double dt, const double *y0, double *k,
                       double *ys)
{
  int n = pb->n;

  lag_embedded_sum(k, n, s, tab->a[s], ys);
  for (int i = 0; i < n; i++) {
    ys[i] = y0[i] + dt * ys[i];
  }
  return call(pb, t0 + tab->c[s] * dt, ys, k + s * n);
}

/* The last stage: f at the end of the step, which is brought back to the constraints first. */
static int last_stage(const lag_tableau *tab, Embedded *w, lag_problem *pb, double tb)
{
  int rc = lag_project(pb, tb, array(w, pb, EMBEDDED_Y1), array(w, pb, EMBEDDED_COMP1));

  return rc ? rc : call(pb, tb, array(w, pb, EMBEDDED_Y1), array(w, pb, EMBEDDED_K1 + tab->stages - 1));
}

/* The stages, and the result in Y1 with what it lost in COMP1. > 0: a smaller step may help. */
static int stages(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, double tb, const double *y, double dt)
{
  int n = pb->n, last = pair->tab->stages - 1;
  double *k = array(w, pb, EMBEDDED_K1), *ys = array(w, pb, EMBEDDED_YS), *y1 = array(w, pb, EMBEDDED_Y1);
  const double *comp = array(w, pb, EMBEDDED_COMP);
  double *comp1 = array(w, pb, EMBEDDED_COMP1);

  for (int s = 1; s < last; s++) {
    int rc = lag_embedded_stage(pair->tab, pb, s, t, dt, y, k, ys);
    if (rc) {
      return rc;
    }
  }
  lag_embedded_sum(k, n, last, pair->tab->a[last], ys);
  for (int i = 0; i < n; i++) {
    comp1[i] = comp[i];
    y1[i] = lag_sum(y[i], dt * ys[i], &comp1[i]);
  }
  return pair->late ? LAG_OK : last_stage(pair->tab, w, pb, tb);
}

/* sum (e_i / s_i)^2 over the components of the estimate sum coef_j K_j, not yet scaled by the step. */
static double square(Embedded *w, lag_problem *pb, const double *along, int count, const double *coef, const double *y)
{
  const double *y1 = array(w, pb, EMBEDDED_Y1);
  double s = 0, *err = array(w, pb, EMBEDDED_YS);

  lag_embedded_sum(array(w, pb, EMBEDDED_K1), pb->n, count, coef, err);
  if (along && lag_along_constraints(pb, *along, y1, err)) {
    return NAN;
  }
  for (int i = 0; i < pb->n; i++) {
    double a = fabs(y[i]), b = fabs(y1[i]), e = err[i] / (w->atol + pb->tol * (a > b ? a : b));
    s += e * e;
  }
  return s;
}

/* The norm of the error of the step just computed; NaN when anything in it is not finite. */
static double error_of(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, const double *along, const double *y, double dt)
{
  const lag_tableau *tab = pair->tab;
  double n = pb->n ? pb->n : 1, fine = square(w, pb, along, tab->stages - pair->late, tab->e, y), h = fabs(dt);

  if (!pair->late) {
    return isfinite(fine) ? h * sqrt(fine / n) : NAN;
  }
  double coarse = square(w, pb, along, tab->stages - 1, tab->e3, y), both = fine + 0.01 * coarse;
  return !isfinite(both) ? NAN : both > 0 ? h * fine / sqrt(n * both) : 0;
}

/* The limit on steps: the option, or else what has been seen of the motion so far; and what the problem says. */
static double longest(const Embedded *w, const lag_problem *pb, double t)
{
  if (w->fixed != 0.0) {
    return w->h_option;
  }
  double seen = fabs(t - w->t_begin), most = w->h_max > 0 ? w->h_max : seen > 0 ? seen : HUGE_VAL;
  return pb->longest > 0 ? fmin(most, pb->longest) : most;
}

/* The size of the next step. One pow for the error, one for its memory. */
static void next_size(const EmbeddedPair *pair, Embedded *w, double err, int retried)
{
  double old = w->err_power > 0 ? w->err_power : pow(1e-4, pair->beta);
  double f = err > 0 ? pow(err, pair->power) / (old * safety) : 0;

  w->h /= fmin(1 / pair->shrink_most, fmax(retried ? 1 : 1 / pair->grow_most, f));
  w->err_power = pow(fmax(err, 1e-4), pair->beta);
}

/* Takes the step just computed. */
static void accept(Embedded *w, lag_problem *pb, double *t, double *y, double dt, double tb, double tc)
{
  size_t bytes = (size_t)pb->n * sizeof(double);

  memcpy(array(w, pb, EMBEDDED_Y0), y, bytes);
  memcpy(y, array(w, pb, EMBEDDED_Y1), bytes);
  memcpy(array(w, pb, EMBEDDED_COMP), array(w, pb, EMBEDDED_COMP1), bytes);
  w->t0 = *t;
  w->dt = dt;
  w->tc = tc;
  w->ready = 2;
  *t = tb;
}

/* Why a step could not be made small enough. */
static int too_small(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, int cause)
{
  pb->bad_index = -1;
  for (int s = 0; s < pair->tab->stages && cause == LAG_ENAN && pb->bad_index < 0; s++) {
    pb->bad_index = lag_not_finite(pb->n, array(w, pb, EMBEDDED_K1 + s));
  }
  return cause == LAG_ENAN || cause == LAG_EDOMAIN ? cause : lag_step_failed(pb, cause, t);
}

/* Stages and error of one trial; *rc < 0: it failed for good. NaN: a smaller step may help. */
static double trial(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, double tb, const double *y, double dt,
                    int *rc)
{
  *rc = stages(pair, w, pb, t, tb, y, dt);
  double err = *rc ? NAN : error_of(pair, w, pb, NULL, y, dt);

  if (err > 1 && pb->model->constraints) { /* what the constraints take back is no error */
    err = error_of(pair, w, pb, &tb, y, dt);
  }
  if (pair->late && (err <= 1 || (w->fixed != 0.0 && !isnan(err)))) {
    *rc = last_stage(pair->tab, w, pb, tb);
    if (*rc || lag_not_finite(pb->n, array(w, pb, EMBEDDED_K1 + pair->tab->stages - 1)) >= 0) {
      return NAN;
    }
  }
  return err;
}

int lag_embedded_step(const EmbeddedPair *pair, void *work, lag_problem *pb, double *t, double *y)
{
  Embedded *w = work;
  int cause = LAG_ESTEP, retried = 0, rc = prepare(pair, w, pb, *t, y);

  while (rc == 0) {
    double wanted = fmin(w->h, longest(w, pb, *t)), row, gap = w->fixed != 0.0 ? HUGE_VAL : lag_next_row(pb, *t, &row);
    int clipped = wanted * (1 + 1e-4) >= gap; /* what is left would be too short a step */
    w->h = clipped ? gap : wanted;
    double dt = pb->dir * w->h, tc = w->tc, tb = lag_sum(*t, dt, &tc);
    if (clipped) {
      tb = row;
      tc = 0;
    }
    if (w->h <= 4 * DBL_EPSILON * fabs(*t) || w->h < DBL_MIN / DBL_EPSILON) {
      return too_small(pair, w, pb, *t, cause);
    }
    double err = trial(pair, w, pb, *t, tb, y, dt, &rc);
    if (rc < 0) {
      return rc;
    }
    if (err <= 1 || (w->fixed != 0.0 && !isnan(err))) {
      if (w->fixed == 0.0) {
        next_size(pair, w, err, retried);
        w->h = clipped ? fmax(w->h, wanted) : w->h;
      }
      accept(w, pb, t, y, dt, tb, tc);
      return LAG_OK;
    }
    if (isnan(err)) {
      cause = rc ? LAG_EDOMAIN : LAG_ENAN;
      pb->bad_t = tb;
      w->h /= 2;
    } else {
      cause = LAG_ESTEP;
      w->h *= fmax(pair->shrink_most, safety * pow(err, -pair->power));
    }
    if (w->fixed != 0.0) {
      return too_small(pair, w, pb, *t, cause);
    }
    retried = 1;
    pb->rejected++;
    rc = 0;
  }
  return rc;
}

size_t lag_embedded_tangent_size(const EmbeddedPair *pair, const lag_problem *pb, int k)
{
  return lag_tangent_size(pb, pair->tab->stages, k);
}

int lag_embedded_tangent(const EmbeddedPair *pair, void *work, lag_problem *pb, double t, int k, double *Y, double *scratch)
{
  Embedded *w = work;

  return lag_tangent_explicit(pair->tab, pb, w->t0, lag_tangent_span(w->t0, t, w->dt), array(w, pb, EMBEDDED_Y0), k, Y, scratch);
}
