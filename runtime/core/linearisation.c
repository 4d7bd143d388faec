/* The linearisation of a model as dense matrices. Enters: a state; leaves: derivatives of its residuals, or of its
 * right-hand side. Holds: without constraints both are exact, from emitted derivatives; with constraints, and while
 * the motion slides, those of the right-hand side are finite differences: to half of the digits for a simplified
 * Newton's method, of order 6 for a tangent. */
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
  size_t exact = m->linear ? n + (size_t)m->linear->ndr + (size_t)m->linear->nmass + nq * nq : 0,
         differences = m->constraints || m->nmodes ? 3 * n : 0;
  return exact > differences ? exact : differences;
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
  int rc = lag_inputs_at(pb, t, y);
  if (!a) memset(p.rate, 0, n * sizeof(double));
  rc = rc ? rc : l->eval(l, t, y, y + nq, y + 2 * nq, pb->p, pb->u, a ? a : p.rate, p.dr, p.mass, pb->work);
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

static double component_magnitude(lag_problem *pb, const double *y, int k) {
  return k < 2 * pb->nq ? lag_typical_magnitude(pb, y, k < pb->nq, k % pb->nq) : fabs(y[k]) > 0 ? fabs(y[k]) : 1;
}

/* J by forward differences, column by column; backward where the model has no value ahead. */
static int difference_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work) {
  int n = pb->n, nq = pb->nq, rc = lag_rhs(pb, t, y, work);
  double *there = work + n, *rate = there + n;
  for (int k = 0; k < n && rc == 0; k++) {
    double step = sqrt(DBL_EPSILON) * component_magnitude(pb, y, k);
    memcpy(there, y, (size_t)n * sizeof *y);
    there[k] = y[k] + step;
    rc = lag_rhs(pb, t, there, rate);
    if (rc > 0 || lag_not_finite(n, rate) >= 0) {
      there[k] = y[k] - step;
      rc = lag_rhs(pb, t, there, rate);
    }
    for (int i = nq; i < n && rc == 0; i++)
      J[(size_t)(i - nq) * (size_t)n + (size_t)k] = (rate[i] - work[i]) / (there[k] - y[k]);
  }
  return rc;
}

double lag_difference_scale(lag_problem *pb, const double *y, int k) {
  double size = component_magnitude(pb, y, k);
  if (k >= pb->nq || !(size > 1)) return size;
  const lag_var *q = &pb->model->q[k];
  int is_angle =
      q->periodic || strcmp(q->unit, "rad") == 0 || strcmp(q->unit, "deg") == 0 || strcmp(q->unit, "rev") == 0;
  /* a coordinate without unit may be an angle that has turned often */
  return is_angle ? 1 : q->unit[0] ? size : sqrt(size);
}

/* J by central differences of order 6, column by column: wrong by rounding over 2^-9, and by 2^-54/140 of a seventh
 * derivative, for a scale of 1. */
static int central_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work) {
  static const double weight[] = {0.75, -0.15, 1.0 / 60};
  const double part = 0x1p-9;
  int n = pb->n, nq = pb->nq, rc = LAG_OK;
  double *there = work + n, *rate = there + n;
  memset(J, 0, (size_t)((n - nq) * n) * sizeof *J);
  for (int k = 0; k < n; k++) {
    double h = part * lag_difference_scale(pb, y, k);
    memcpy(there, y, (size_t)n * sizeof *y);
    for (int j = -3; j <= 3 && rc == LAG_OK; j++) {
      there[k] = y[k] + j * h;
      rc = j ? lag_rhs(pb, t, there, rate) : LAG_OK;
      for (int i = nq; i < n && j; i++) J[(i - nq) * n + k] += (j < 0 ? -weight[-j - 1] : weight[j - 1]) * rate[i] / h;
    }
  }
  return rc ? rc : lag_rhs(pb, t, y, work);
}

int lag_fine_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work) {
  return pb->model->constraints || pb->nslide ? central_jacobian(pb, t, y, J, work) : lag_jacobian(pb, t, y, J, work);
}

int lag_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work) {
  const lag_model *m = pb->model;
  if (m->constraints || pb->nslide) return difference_jacobian(pb, t, y, J, work);
  if (!m->linear) return lag_linearise(pb, t, y, NULL, J, NULL, work);
  LinearLayout p = parts_of(m, work);
  int rc = lag_rhs(pb, t, y, p.rate);
  rc = rc ? rc : lag_linearise(pb, t, y, p.rate + m->nq, J, p.M, work);
  return rc ? rc : lag_solve_dense((size_t)m->nq, (size_t)pb->n, p.M, J) ? LAG_ESINGULAR : LAG_OK;
}
