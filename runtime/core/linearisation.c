/* The linearisation of a model as dense matrices. Enters: a state; leaves: derivatives of its residuals, or of its right-hand side. Holds:
 * without constraints both are exact, from emitted derivatives; with constraints those of the right-hand side are finite differences, to half of
 * the digits, which is enough for a simplified Newton's method only. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "numeric/dense.h"

/* Layout of `work`. */
typedef struct LinearLayout {
  double *rate; /* [n] y' */
  double *dr;   /* [ndr] sparse */
  double *mass; /* [nmass] sparse */
  double *M;    /* [nq * nq] */
} LinearLayout;

static LinearLayout parts_of(const lag_model *m, double *work) {
  LinearLayout p;
  p.rate = work;
  p.dr = p.rate + 2 * m->nq + m->nz;
  p.mass = p.dr + m->linear->ndr;
  p.M = p.mass + m->linear->nmass;
  return p;
}

size_t lag_linear_work(const lag_model *m) {
  size_t nq = (size_t)m->nq, n = 2 * nq + (size_t)m->nz;
  return m->linear ? n + (size_t)m->linear->ndr + (size_t)m->linear->nmass + nq * nq : m->constraints ? 3 * n : 0;
}

int lag_linearise(lag_problem *pb, double t, const double *y, const double *a, double *dr, double *M, double *work) {
  const lag_model *m = pb->model;
  const lag_linear *l = m->linear;
  size_t nq = (size_t)m->nq, n = (size_t)pb->n;
  if (!l) {
    pb->detail = "the model was emitted without its linearisation: lagc emit --with linear";
    return LAG_EMETHOD;
  }
  LinearLayout p = parts_of(m, work);
  int rc = lag_inputs(pb, t);
  if (!a) memset(p.rate, 0, n * sizeof(double));
  rc = rc ? rc : l->eval(t, y, y + nq, y + 2 * nq, pb->p, pb->u, a ? a : p.rate, p.dr, p.mass, pb->work);
  if (rc) return rc;
  memset(dr, 0, (nq + (size_t)m->nz) * n * sizeof(double));
  memset(M, 0, nq * nq * sizeof(double));
  for (int k = 0; k < l->ndr; k++) dr[(size_t)l->dr[k].row * n + (size_t)l->dr[k].col] = p.dr[k];
  for (int k = 0; k < l->nmass; k++) {
    size_t i = (size_t)l->mass[k].row, j = (size_t)l->mass[k].col;
    M[i * nq + j] = M[j * nq + i] = p.mass[k];
  }
  return LAG_OK;
}

/* J by forward differences, column by column; backward where the model has no value ahead. */
static int difference_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work) {
  int n = pb->n, nq = pb->nq, rc = lag_rhs(pb, t, y, work);
  double *there = work + n, *rate = there + n;
  for (int k = 0; k < n && rc == 0; k++) {
    double far = k < 2 * nq ? lag_typical_magnitude(pb, y, k < nq, k % nq) : fabs(y[k]) > 0 ? fabs(y[k]) : 1, step = sqrt(DBL_EPSILON) * far;
    memcpy(there, y, (size_t)n * sizeof *y);
    there[k] = y[k] + step;
    rc = lag_rhs(pb, t, there, rate);
    if (rc > 0 || lag_not_finite(n, rate) >= 0) {
      there[k] = y[k] - step;
      rc = lag_rhs(pb, t, there, rate);
    }
    for (int i = nq; i < n && rc == 0; i++) J[(size_t)(i - nq) * (size_t)n + (size_t)k] = (rate[i] - work[i]) / (there[k] - y[k]);
  }
  return rc;
}

int lag_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work) {
  const lag_model *m = pb->model;
  if (m->constraints) return difference_jacobian(pb, t, y, J, work);
  if (!m->linear) return lag_linearise(pb, t, y, NULL, J, NULL, work);
  LinearLayout p = parts_of(m, work);
  int rc = lag_rhs(pb, t, y, p.rate);
  rc = rc ? rc : lag_linearise(pb, t, y, p.rate + m->nq, J, p.M, work);
  return rc ? rc : lag_solve_dense((size_t)m->nq, (size_t)pb->n, p.M, J) ? LAG_ESINGULAR : LAG_OK;
}
