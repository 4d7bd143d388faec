/* lag_algebra by the GNU Scientific Library. All matrices are row-major. Holds: GSL's abort handler is off while it
 * runs, and its allocations are freed on every way out. Sources: GSL Reference Manual, "Eigensystems", "Linear
 * Algebra" and "Nonlinear Least-Squares Fitting", and the papers named there. */
#include <float.h>
#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_version.h>
#include <math.h>
#include <string.h>

#include "lag.h"

/* ---- Roots */

typedef struct Problem {
  lag_equations *equations;
  void *context;
  double *f; /* scratch */
} Problem;

/* Residuals; 1e100 each where the equations have no values, so that the step is refused. */
static int equations_f(const gsl_vector *x, void *context, gsl_vector *f) {
  Problem *p = context;
  if (p->equations(p->context, x->data, f->data, NULL) || lag_not_finite((int)f->size, f->data) >= 0)
    gsl_vector_set_all(f, 1e100);
  return GSL_SUCCESS;
}

static int equations_df(const gsl_vector *x, void *context, gsl_matrix *J) {
  Problem *p = context;
  return p->equations(p->context, x->data, p->f, J->data) || lag_not_finite((int)(J->size1 * J->size2), J->data) >= 0
             ? GSL_EDOM
             : GSL_SUCCESS;
}

/* Dogleg steps (Powell, 1970), solved by QR with column pivoting, so that a singular Jacobian is no obstacle. */
static int iterate(gsl_multifit_nlinear_workspace *w, gsl_multifit_nlinear_fdf *fdf, double *x, int most, int *steps) {
  gsl_vector_view start = gsl_vector_view_array(x, fdf->p);
  int rc = gsl_multifit_nlinear_init(&start.vector, fdf, w);
  double reach = gsl_blas_dnrm2(&start.vector), moved = HUGE_VAL;
  if (rc || gsl_vector_get(gsl_multifit_nlinear_residual(w), 0) >= 1e100) return LAG_EDOMAIN;
  for (*steps = 0; *steps < most && gsl_blas_dnrm2(gsl_multifit_nlinear_residual(w)) > 0 && moved > DBL_EPSILON * reach;
       ++*steps) {
    if (gsl_multifit_nlinear_iterate(w)) {
      break; /* no step gains any more */
    }
    moved = gsl_blas_dnrm2(w->dx);
    reach = fmax(reach, gsl_blas_dnrm2(gsl_multifit_nlinear_position(w)));
  }
  gsl_vector_memcpy(&start.vector, gsl_multifit_nlinear_position(w));
  return LAG_OK;
}

static int root(int n, double *x, lag_equations *equations, void *context, int most, int *steps) {
  size_t size = (size_t)n;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  parameters.trs = gsl_multifit_nlinear_trs_dogleg;
  parameters.solver = gsl_multifit_nlinear_solver_qr;
  parameters.scale = gsl_multifit_nlinear_scale_levenberg;
  gsl_multifit_nlinear_workspace *w = gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, size, size);
  gsl_vector *f = gsl_vector_alloc(size);
  int rc = LAG_ENOMEM;
  if (w && f) {
    Problem p = {equations, context, f->data};
    gsl_multifit_nlinear_fdf fdf = {.f = equations_f, .df = equations_df, .n = size, .p = size, .params = &p};
    rc = iterate(w, &fdf, x, most, steps);
  }
  gsl_vector_free(f);
  if (w) gsl_multifit_nlinear_free(w);
  gsl_set_error_handler(handler);
  return rc;
}

/* ---- Eigenvalues */

static int symmetric(int n, double *K, double *M, double *values, double *vectors) {
  size_t size = (size_t)n;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_eigen_gensymmv_workspace *w = gsl_eigen_gensymmv_alloc(size);
  int rc = LAG_ENOMEM;
  if (w) {
    gsl_matrix_view k = gsl_matrix_view_array(K, size, size), m = gsl_matrix_view_array(M, size, size);
    gsl_matrix_view x = gsl_matrix_view_array(vectors, size, size);
    gsl_vector_view value = gsl_vector_view_array(values, size);
    rc = gsl_eigen_gensymmv(&k.matrix, &m.matrix, &value.vector, &x.matrix, w);
    rc = rc == GSL_EDOM ? LAG_EINVAL : rc ? LAG_EMETHOD : LAG_OK;
    if (rc == LAG_OK) gsl_eigen_gensymmv_sort(&value.vector, &x.matrix, GSL_EIGEN_SORT_VAL_ASC);
    gsl_eigen_gensymmv_free(w);
  }
  gsl_set_error_handler(handler);
  return rc;
}

/* Condition numbers |x_k| |y_k| / |y_k x_k| of eigenvalues: the rows of X^-1 are left eigenvectors with y_k x_k = 1,
 * and |x_k| = 1. X is destroyed. */
static void sensitivities(gsl_matrix_complex *X, gsl_matrix_complex *inverse, gsl_permutation *perm,
                          double *sensitivity) {
  size_t n = X->size1;
  int sign, singular = gsl_linalg_complex_LU_decomp(X, perm, &sign) || gsl_linalg_complex_LU_invert(X, perm, inverse);
  for (size_t k = 0; k < n; k++) {
    gsl_vector_complex_view row = gsl_matrix_complex_row(inverse, k);
    double s = singular ? HUGE_VAL : gsl_blas_dznrm2(&row.vector);
    sensitivity[k] = isfinite(s) ? s : HUGE_VAL;
  }
}

static int general(int n, double *A, double *re, double *im, double *vre, double *vim, double *sensitivity) {
  size_t size = (size_t)n;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_eigen_nonsymmv_workspace *w = gsl_eigen_nonsymmv_alloc(size);
  gsl_vector_complex *value = gsl_vector_complex_alloc(size);
  gsl_matrix_complex *x = gsl_matrix_complex_alloc(size, size), *inverse = gsl_matrix_complex_alloc(size, size);
  gsl_permutation *perm = gsl_permutation_alloc(size);
  int rc = LAG_ENOMEM;
  if (w && value && x && inverse && perm) {
    gsl_matrix_view a = gsl_matrix_view_array(A, size, size);
    rc = gsl_eigen_nonsymmv(&a.matrix, value, x, w) ? LAG_EMETHOD : LAG_OK;
    for (size_t i = 0; i < size && rc == LAG_OK; i++) {
      re[i] = GSL_REAL(gsl_vector_complex_get(value, i));
      im[i] = GSL_IMAG(gsl_vector_complex_get(value, i));
      for (size_t k = 0; k < size; k++) {
        vre[i * size + k] = GSL_REAL(gsl_matrix_complex_get(x, i, k));
        vim[i * size + k] = GSL_IMAG(gsl_matrix_complex_get(x, i, k));
      }
    }
    if (rc == LAG_OK) sensitivities(x, inverse, perm, sensitivity);
  }
  gsl_permutation_free(perm);
  gsl_matrix_complex_free(inverse);
  gsl_matrix_complex_free(x);
  gsl_vector_complex_free(value);
  if (w) gsl_eigen_nonsymmv_free(w);
  gsl_set_error_handler(handler);
  return rc;
}

/* ---- Balancing and rank */

static int balance(int n, double *A, double *scale) {
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_matrix_view a = gsl_matrix_view_array(A, (size_t)n, (size_t)n);
  gsl_vector_view d = gsl_vector_view_array(scale, (size_t)n);
  int rc = gsl_linalg_balance_matrix(&a.matrix, &d.vector);
  gsl_set_error_handler(handler);
  return rc ? LAG_EMETHOD : LAG_OK;
}

/* A' P = Q R with column pivoting: columns of Q beyond the rank are orthogonal to the range of A', so they span the
 * kernel of A. */
static int kernel(int n, const double *A, double tol, double *Q, int *rank) {
  size_t size = (size_t)n;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_matrix *a = gsl_matrix_alloc(size, size), *r = gsl_matrix_alloc(size, size);
  gsl_vector *tau = gsl_vector_alloc(size), *norm = gsl_vector_alloc(size);
  gsl_permutation *perm = gsl_permutation_alloc(size);
  int rc = LAG_ENOMEM, sign;
  if (a && r && tau && norm && perm) {
    gsl_matrix_const_view from = gsl_matrix_const_view_array(A, size, size);
    gsl_matrix_view q = gsl_matrix_view_array(Q, size, size);
    gsl_matrix_transpose_memcpy(a, &from.matrix);
    rc = gsl_linalg_QRPT_decomp2(a, &q.matrix, r, tau, perm, &sign, norm) ? LAG_EMETHOD : LAG_OK;
    for (*rank = 0; *rank < n && fabs(gsl_matrix_get(r, (size_t)*rank, (size_t)*rank)) > tol;) ++*rank;
  }
  gsl_permutation_free(perm);
  gsl_vector_free(norm);
  gsl_vector_free(tau);
  gsl_matrix_free(r);
  gsl_matrix_free(a);
  gsl_set_error_handler(handler);
  return rc;
}

const lag_algebra lag_gsl_algebra = {
    .name = "GSL " GSL_VERSION,
    .root = root,
    .symmetric = symmetric,
    .general = general,
    .balance = balance,
    .kernel = kernel,
};
