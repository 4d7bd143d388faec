/* Embedded explicit Runge-Kutta methods with adaptive steps. Enters: t, y; leaves: the next accepted t, y. Holds: a
 * rejected step leaves t and y unchanged; the last stage of a step is the first of the next; sums over steps are
 * compensated (steps.h).
 *
 * Source: E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), DOI
 * 10.1007/978-3-540-78862-1: II.4 (error norm, PI controller, first step), II.10 (the estimate of order 5 with a
 * correction of order 3).
 *
 * A step is accepted when err <= 1, with |x|^2 = 1/n sum (x_i / s_i)^2, s_i = tol (floor_i + max(|y_i|, |y1_i|)),
 * with the floor of step_control.h: err = |e| for one estimate, |e|^2 / sqrt(|e|^2 + 0.01 |e3|^2) for two. */
#include "methods/adaptive_rk.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "core/rhs.h"
#include "methods/step_control.h"
#include "methods/steps.h"
#include "methods/method_tangent.h"

const lag_method_option lag_adaptive_rk_options[LAG_NADAPTIVE_OPTIONS] = {
    {"step", "first step to try [s]; 0: chosen from the tolerance", 0, 0, HUGE_VAL, .choices = NULL},
    LAG_MAX_STEP_OPTION,
    LAG_ATOL_OPTION,
    {"adapt", "off: every step has the size `step` (0: a 10000th of the scene's span), whatever the error", 0, 0, 1,
     .choices = lag_on_off},
};

size_t lag_adaptive_rk_work_size(const lag_problem *pb) {
  const EmbeddedPair *pair = pb->variant;
  int arrays = EMBEDDED_K1 + pair->tab->stages + pair->tab->extra + pair->more;
  return sizeof(Embedded) / sizeof(double) + (size_t)arrays * (size_t)lag_adaptive_rk_row(pb);
}

void lag_adaptive_rk_reset(void *work, lag_problem *pb) {
  Embedded *w = work;
  w->ready = w->have_extra = 0;
  w->h = w->limits.h_option;
  w->err_power = 0;
  w->tc = 0;
  memset(lag_adaptive_rk_array(w, pb, EMBEDDED_COMP), 0, (size_t)pb->n * sizeof(double));
}

int lag_adaptive_rk_init(void *work, lag_problem *pb, const double *opt) {
  Embedded *w = work;
  const EmbeddedPair *pair = pb->variant;
  if (pair->tab->order_embedded) lag_step_limits_init(&w->limits, pb, opt);
  else w->limits = (lag_step_limits){.fixed = 1, .h_option = lag_step_size(pb, opt[LAG_OPT_STEP])};
  w->per = 1 / (pb->n ? (double)pb->n : 1);
  lag_adaptive_rk_reset(work, pb);
  return LAG_OK;
}

LAG_RARE double first_size(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, const double *y) {
  lag_tolerance tol = {pb->tol, &w->limits};
  double *k1 = lag_adaptive_rk_array(w, pb, EMBEDDED_K1);
  return lag_first_step(pb, &tol, (lag_first_try){.order = pair->tab->order, .t = t, .y = y, .f = k1,
                                                  .y1 = lag_adaptive_rk_array(w, pb, EMBEDDED_Y1),
                                                  .f1 = k1 + lag_adaptive_rk_row(pb)});
}

LAG_ALWAYS_INLINE int prepare(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, const double *y) {
  int row = lag_adaptive_rk_row(pb);
  double *k1 = w->x + EMBEDDED_K1 * row;
  lag_copy(pb->n, y, w->x + EMBEDDED_Y0 * row);
  if (w->ready == 2.0) {
    lag_copy(pb->n, k1 + (pair->tab->stages - 1) * row, k1);
  } else if (w->ready == 0.0) {
    int rc = lag_step_rhs(pb, t, y, k1);
    if (rc) return rc;
  }
  w->ready = 1;
  w->have_extra = 0;
  w->h = w->limits.fixed != 0.0 ? w->limits.h_option : w->h;
  lag_step_limits_begin(&w->limits, t);
  if (w->h == 0.0) w->h = first_size(pair, w, pb, t, y);
  return LAG_OK;
}

int lag_adaptive_rk_prepare(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, const double *y) {
  return prepare(pair, w, pb, t, y);
}

/* Makes the step just computed the last accepted one. */
static int accept(Embedded *w, lag_problem *pb, double *t, double *y, const lag_aimed *a) {
  int row = lag_adaptive_rk_row(pb);
  lag_copy(pb->n, w->x + EMBEDDED_Y1 * row, y);
  lag_copy(pb->n, w->x + EMBEDDED_COMP1 * row, w->x + EMBEDDED_COMP * row);
  w->t0 = *t;
  w->dt = pb->dir * a->h;
  w->tc = a->lost;
  w->ready = 2;
  *t = a->t;
  return LAG_OK;
}

/* Status of a step that would have to be shorter than rounding of t allows. */
LAG_RARE int too_small(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, int cause) {
  pb->bad_index = -1;
  for (int s = 0; s < pair->tab->stages && cause == LAG_ENAN && pb->bad_index < 0; s++)
    pb->bad_index = lag_not_finite(pb->n, lag_adaptive_rk_array(w, pb, EMBEDDED_K1 + s));
  return cause == LAG_ENAN || cause == LAG_EDOMAIN ? cause : lag_step_failed(pb, cause, t);
}

/* Squared norm of the part of sum coef_j K_j along the constraints; NaN where that is not known. */
static double square_along(Embedded *w, lag_problem *pb, double tb, int count, const double *coef) {
  int row = lag_adaptive_rk_row(pb), n = pb->n;
  const double *y0 = w->x + EMBEDDED_Y0 * row, *y1 = w->x + EMBEDDED_Y1 * row, *k = w->x + EMBEDDED_K1 * row;
  double sum = 0, *e = w->x + EMBEDDED_YS * row;
  for (int i = 0; i < n; i++) {
    e[i] = 0;
    for (int j = 0; j < count; j++) e[i] += coef[j] * k[j * row + i];
  }
  if (lag_project_tangent(pb, tb, y1, e)) return NAN;
  for (int i = 0; i < n; i++) {
    double part = e[i] / (pb->tol * (lag_tolerance_floor(&w->limits, pb, i) + fmax(fabs(y0[i]), fabs(y1[i]))));
    sum += part * part;
  }
  return sum * w->per;
}

double lag_adaptive_rk_error_along(const lag_tableau *tab, int late, Embedded *w, lag_problem *pb, double tb, double dt,
                                   double whole) {
  double fine = dt * dt * square_along(w, pb, tb, tab->stages - late, tab->errors[0]);
  double coarse = late ? 0.01 * dt * dt * square_along(w, pb, tb, tab->stages - 1, tab->errors[1]) : 0,
         both = fine + coarse;
  w->across = whole;
  return !isfinite(both) ? NAN : late ? (both > 0 ? fine * (fine / both) : 0) : fine;
}

int lag_adaptive_rk_reversal(Embedded *w, lag_problem *pb, double tb) {
  const double *y0 = lag_adaptive_rk_array(w, pb, EMBEDDED_Y0), *y1 = lag_adaptive_rk_array(w, pb, EMBEDDED_Y1);
  int nq = pb->nq;
  for (int i = 0; i < nq && !(pb->model->flags & LAG_AUTONOMOUS); i++) {
    double moved = y1[i] - y0[i], v0 = pb->dir * y0[nq + i], v1 = pb->dir * y1[nq + i];
    if (((v0 > 0 && v1 > 0 && moved < 0) || (v0 < 0 && v1 < 0 && moved > 0)) &&
        fabs(moved) > 1e-3 * lag_typical_magnitude(pb, y0, 1, i))
      return lag_report_leap(pb, tb, y1, i, moved);
  }
  return LAG_OK;
}

/* Search for a step size that passes a singular position, where constraints become dependent. Near one a step leaves
 * the constraints far, and its end gives the next step a poor derivative. Where the step ends there a shorter one
 * passes better, where it begins there a longer one. The first good size is taken, or else the least bad of those
 * with a small error along the constraints: shrinking alone never passes. */
typedef struct SizeSearch {
  double base, base_err; /* size before the search, and its squared error */
  /* size of least singularity_penalty among those with a small error, and that singularity_penalty */
  double best, least;
  int tries;
} SizeSearch;

enum { SEARCH_TRIES = 8 };

/* Badness of a step with respect to singular positions; above 1 another size should be tried. 0 where the step came
 * near none (w->across = 0). */
static double singularity_penalty(const Embedded *w, lag_problem *pb, double tb) {
  const double factor = 100;  /* estimates across the constraints are some ten times too small there; squared */
  const double weight = 1e-2; /* weight of the derivative at the end, whose error is rounding/s^2 */
  int weakest;
  if (w->across == 0.0) return 0;
  double across = factor * w->across * pb->tol,
         s = lag_independence(pb, tb, lag_adaptive_rk_array((Embedded *)w, pb, EMBEDDED_Y1), &weakest);
  return lag_max(across, weight * DBL_EPSILON / (pb->tol * s * s));
}

/* 1: try again with the step w->h; *err is the squared error of the step to tb, or NaN. 0: keep the step. After the
 * last try without success w->h and *err are those of the first. */
LAG_RARE int try_other_size(SizeSearch *l, Embedded *w, lag_problem *pb, double tb, double *err) {
  double bad = l->tries <= SEARCH_TRIES ? singularity_penalty(w, pb, tb) : 0;
  if (!(bad > 1) && (l->tries == 0 || l->tries > SEARCH_TRIES || *err <= 1)) return 0;
  if (l->tries == 0) *l = (SizeSearch){.base = w->h, .base_err = *err, .least = HUGE_VAL};
  if (*err <= 1 && bad < l->least) {
    l->best = w->h;
    l->least = bad;
  }
  int k = l->tries++; /* 1/1.25, 1.25, 1/1.25^2, 1.25^2, ... */
  if (k == SEARCH_TRIES && l->best == 0.0) {
    w->h = l->base;
    *err = l->base_err;
    return 0;
  }
  w->h = k < SEARCH_TRIES ? l->base * pow(1.25, k % 2 ? (k + 1) / 2 : -(k + 2) / 2) : l->best;
  return 1;
}

int lag_adaptive_rk_step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  const EmbeddedPair *pair = pb->variant;
  Embedded *w = work;
  SizeSearch search = {.tries = 0};
  int cause = LAG_ESTEP, rc = prepare(pair, w, pb, *t, y);
  (void)t_stop;
  while (rc == 0) {
    double wanted = lag_min(w->h, lag_longest_step(&w->limits, *t, pb->longest)), row = *t;
    double gap = w->limits.fixed != 0.0 ? lag_next_kick(pb, *t, &row) : lag_next_row_inline(pb, *t, &row);
    lag_aimed a = lag_aim(*t, w->tc, pb->dir, wanted, gap, row);
    w->h = a.h;
    if (w->h <= 4 * DBL_EPSILON * fabs(*t) || w->h < DBL_MIN / DBL_EPSILON) return too_small(pair, w, pb, *t, cause);
    w->across = 0;
    double err = pair->trial(w, pb, *t, a.t, pb->dir * a.h, &rc); /* squared */
    if (rc < 0) return rc;
    const int fixed = w->limits.fixed != 0.0;
    if (!fixed && (w->across != 0.0 || search.tries) && try_other_size(&search, w, pb, a.t, &err)) {
      pb->rejected++;
      rc = 0;
      continue;
    }
    a.h = w->h; /* of the search's first try, if no size is good */
    int taken = err <= 1 || (fixed && !isnan(err));
    if (fixed) w->h = wanted;
    else lag_next_size(&pair->control, &a, err, taken, 1, &w->h, &w->err_power);
    if (taken) return accept(w, pb, t, y, &a);
    cause = !isnan(err) ? LAG_ESTEP : rc ? LAG_EDOMAIN : LAG_ENAN;
    if (isnan(err)) pb->bad_t = a.t;
    if (fixed) return too_small(pair, w, pb, *t, cause);
    pb->rejected++;
    rc = 0;
  }
  return rc;
}

size_t lag_adaptive_rk_tangent_size(const lag_problem *pb, int k) {
  const EmbeddedPair *pair = pb->variant;
  return lag_tangent_size(pb, pair->tab->stages, k);
}

int lag_adaptive_rk_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  const EmbeddedPair *pair = pb->variant;
  Embedded *w = work;
  const double *y0 = lag_adaptive_rk_array(w, pb, EMBEDDED_Y0);
  return lag_tangent_explicit(pair->tab, (lag_step_taken){pb, w->t0, lag_tangent_span(w->t0, t, w->dt), y0}, k, Y,
                              scratch);
}

double lag_adaptive_rk_span(const void *work, const lag_problem *pb, double t) {
  const Embedded *w = work;
  (void)pb;
  return lag_tangent_span(w->t0, t, w->dt);
}

size_t lag_adaptive_rk_adjoint_size(const lag_problem *pb) {
  const EmbeddedPair *pair = pb->variant;
  return lag_reverse_size(pb, pair->tab->stages);
}

int lag_adaptive_rk_adjoint(lag_problem *pb, double t0, double dt, const double *y0, double *x, double *g,
                            double *scratch) {
  const EmbeddedPair *pair = pb->variant;
  return lag_reverse_explicit(pair->tab, (lag_step_taken){pb, t0, dt, y0}, x, g, scratch);
}
