/* lag_least_squares by the GNU Scientific Library: trust-region steps with geodesic acceleration (M. K. Transtrum, J.
 * P. Sethna, arXiv:1201.5885), singular values by one-sided Jacobi rotations. Holds: GSL's abort handler is off while
 * it runs, and its allocations are freed on every way out. */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_multimin.h>
#include <math.h>

#include "lag.h"

typedef struct Problem {
  lag_residuals_at *residuals;
  void *context;
} Problem;

/* Residuals; 1e100 each where a run fails, so that the step is refused. */
static int residuals_f(const gsl_vector *x, void *context, gsl_vector *f) {
  const Problem *p = context;
  if (p->residuals(p->context, x->data, f->data, NULL)) gsl_vector_set_all(f, 1e100);
  return GSL_SUCCESS;
}

static int residuals_df(const gsl_vector *x, void *context, gsl_matrix *J) {
  const Problem *p = context;
  return p->residuals(p->context, x->data, NULL, J->data) ? GSL_EDOM : GSL_SUCCESS;
}

/* Steps until one gains less than a part of 1e-9 of |f|^2, which is a step of 1e-4 standard errors for a few hundred
 * residuals, or until none gains. */
static int descend(gsl_multifit_nlinear_workspace *w, int most, int *steps) {
  const double least_gain = 1e-9;
  const gsl_vector *f = gsl_multifit_nlinear_residual(w);
  double before, now = HUGE_VAL;
  gsl_blas_ddot(f, f, &now);
  for (*steps = 0; *steps < most; ++*steps) {
    before = now;
    if (gsl_multifit_nlinear_iterate(w)) return LAG_OK;
    gsl_blas_ddot(f, f, &now);
    if (before - now <= least_gain * now) return LAG_OK;
  }
  return LAG_EMETHOD;
}

static int minimise(int m, int n, double *x, lag_residuals_at *residuals, void *context, int most, int *steps) {
  Problem problem = {residuals, context};
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  parameters.trs = gsl_multifit_nlinear_trs_lmaccel;
  parameters.scale = gsl_multifit_nlinear_scale_levenberg; /* coordinates have scales of their own */
  parameters.solver = gsl_multifit_nlinear_solver_qr;
  gsl_multifit_nlinear_fdf fdf = {
      .f = residuals_f, .df = residuals_df, .n = (size_t)m, .p = (size_t)n, .params = &problem};
  gsl_multifit_nlinear_workspace *w =
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, (size_t)m, (size_t)n);
  gsl_vector_view start = gsl_vector_view_array(x, (size_t)n);
  int rc = !w ? LAG_ENOMEM : gsl_multifit_nlinear_init(&start.vector, &fdf, w) ? LAG_EDOMAIN : LAG_OK;
  if (rc == LAG_OK) {
    rc = descend(w, most, steps);
    gsl_vector_memcpy(&start.vector, gsl_multifit_nlinear_position(w));
  }
  gsl_multifit_nlinear_free(w);
  gsl_set_error_handler(handler);
  return rc;
}

/* ---- Functions of many values */

typedef struct Objective {
  lag_objective_at *at;
  void *context;
} Objective;

/* Values 1e100 where a run fails, so that a search along a line comes back. */
static double value_of(const gsl_vector *x, void *objective) {
  const Objective *o = objective;
  double f;
  return o->at(o->context, x->data, &f, NULL) ? 1e100 : f;
}

static void value_and_gradient(const gsl_vector *x, void *objective, double *f, gsl_vector *g) {
  const Objective *o = objective;
  if (o->at(o->context, x->data, f, g->data)) *f = 1e100, gsl_vector_set_zero(g);
}

static void gradient_of(const gsl_vector *x, void *objective, gsl_vector *g) {
  double f;
  value_and_gradient(x, objective, &f, g);
}

/* BFGS steps; where one gains nothing they begin again along the gradient, once in a row. */
static int take_steps(gsl_multimin_fdfminimizer *w, gsl_multimin_function_fdf *fdf, gsl_vector *x,
                      int (*goes_on)(void *, double), void *context, int most, int *steps) {
  const double first_step = 0.01, line_tolerance = 0.1;
  for (int begins = 1; *steps < most;) {
    if (begins && gsl_multimin_fdfminimizer_set(w, fdf, x, first_step, line_tolerance)) return LAG_EDOMAIN;
    int stuck = gsl_multimin_fdfminimizer_iterate(w);
    gsl_vector_memcpy(x, gsl_multimin_fdfminimizer_x(w));
    if (stuck && begins) return LAG_OK;
    begins = stuck;
    if (stuck) continue;
    ++*steps;
    if (!goes_on(context, gsl_multimin_fdfminimizer_minimum(w))) return LAG_OK;
  }
  return LAG_EMETHOD;
}

static int minimise_function(int n, double *x, lag_objective_at *objective, int (*goes_on)(void *, double),
                             void *context, int most, int *steps) {
  Objective o = {objective, context};
  double f;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_multimin_function_fdf fdf = {value_of, gradient_of, value_and_gradient, (size_t)n, &o};
  gsl_multimin_fdfminimizer *w = gsl_multimin_fdfminimizer_alloc(gsl_multimin_fdfminimizer_vector_bfgs2, (size_t)n);
  gsl_vector_view at = gsl_vector_view_array(x, (size_t)n);
  int rc = !w ? LAG_ENOMEM : objective(context, x, &f, NULL) ? LAG_EDOMAIN : LAG_OK;
  *steps = 0;
  if (rc == LAG_OK) rc = take_steps(w, &fdf, &at.vector, goes_on, context, most, steps);
  gsl_multimin_fdfminimizer_free(w);
  gsl_set_error_handler(handler);
  return rc;
}

static int singular_values(int m, int n, double *A, double *values, double *V) {
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_matrix_view a = gsl_matrix_view_array(A, (size_t)m, (size_t)n),
                  v = gsl_matrix_view_array(V, (size_t)n, (size_t)n);
  gsl_vector_view s = gsl_vector_view_array(values, (size_t)n);
  int rc = gsl_linalg_SV_decomp_jacobi(&a.matrix, &v.matrix, &s.vector);
  gsl_set_error_handler(handler);
  return rc ? LAG_EMETHOD : LAG_OK;
}

static double chance_of_more(double chi_squared, double freedom) { return gsl_cdf_chisq_Q(chi_squared, freedom); }
static double chance_of_f(double f, double above, double below) { return gsl_cdf_fdist_Q(f, above, below); }

const lag_least_squares lag_gsl_least_squares = {minimise, singular_values, chance_of_more, chance_of_f,
                                                 minimise_function};
