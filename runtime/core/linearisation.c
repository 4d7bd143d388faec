/* The linearisation of a model as dense matrices. Enters: a state; leaves: derivatives of its residuals, or of its
 * right-hand side. Holds: without constraints both are exact, from emitted derivatives; with constraints those of a
 * tangent are rows of the emitted reverse mode; without it, and while the motion slides, finite differences: to half of
 * the digits for a simplified Newton's method, of order 6 for a tangent. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"
#include "numeric/dense.h"
#include "numeric/magnitudes.h"

/* Layout of `work`. */
typedef struct LinearLayout {
  double *rate; /* [n] y' */
  double *dr;   /* [ndr] sparse */
  double *mass; /* [nmass] sparse */
  double *M;    /* [nq * nq] */
  double *part; /* derivatives by parameters or inputs */
  double *u;    /* [2 nu] */
} LinearLayout;

static size_t partials_size(const lag_linear *l) {
  int params = l->by_params ? l->by_params->n : 0, inputs = l->by_inputs ? l->by_inputs->n : 0;
  return (size_t)(params > inputs ? params : inputs);
}

static LinearLayout parts_of(const lag_model *m, double *work) {
  LinearLayout p;
  p.rate = work;
  p.dr = p.rate + 2 * m->nq + m->nz;
  p.mass = p.dr + m->linear->ndr;
  p.M = p.mass + m->linear->nmass;
  p.part = p.M + m->nq * m->nq;
  p.u = p.part + partials_size(m->linear);
  return p;
}

/* Scratch of the rows of a Jacobian by reverse mode with constraints. */
static size_t reverse_rows_size(const lag_model *m) {
  const lag_adjoint *of = m->constraints ? m->constraints->adjoint : NULL;
  size_t rows = (size_t)(m->nq + m->nz), n = rows + (size_t)m->nq;
  return of ? 2 * n + 2 * (size_t)m->constraints->n + rows + 2 * (size_t)(m->nu + m->np) + (size_t)of->n : 0;
}

size_t lag_linear_work(const lag_model *m) {
  size_t nq = (size_t)m->nq, n = 2 * nq + (size_t)m->nz;
  size_t exact = m->linear ? n + (size_t)m->linear->ndr + (size_t)m->linear->nmass + nq * nq +
                                 partials_size(m->linear) + 2 * (size_t)m->nu
                           : 0,
         differences = m->constraints || m->nmodes ? 5 * n : 0, reverse = reverse_rows_size(m),
         most = exact > differences ? exact : differences;
  return most > reverse ? most : reverse;
}

void lag_symmetric_matrix(size_t nq, int n, const lag_entry *at, const double *entry, double *M) {
  memset(M, 0, nq * nq * sizeof(double));
  for (int k = 0; k < n; k++) {
    size_t i = (size_t)at[k].row, j = (size_t)at[k].col;
    M[i * nq + j] = M[j * nq + i] = entry[k];
  }
}

/* lag_linearise with rows of dr `width` apart; columns past n are 0. */
static int linearise(lag_problem *pb, double t, const double *y, const double *a, size_t width, double *dr,
                     LinearLayout p) {
  const lag_model *m = pb->model;
  const lag_linear *l = m->linear;
  size_t nq = (size_t)m->nq, n = (size_t)pb->n;
  int rc = lag_inputs_at(pb, t, y);
  if (!a) memset(p.rate, 0, n * sizeof(double));
  rc = rc ? rc : l->eval(l, t, y, y + nq, y + 2 * nq, pb->p, pb->u, a ? a : p.rate, p.dr, p.mass, pb->work);
  if (rc) return rc;
  memset(dr, 0, (nq + (size_t)m->nz) * width * sizeof(double));
  for (int k = 0; k < l->ndr; k++) dr[(size_t)l->dr[k].row * width + (size_t)l->dr[k].col] = p.dr[k];
  lag_symmetric_matrix(nq, l->nmass, l->mass, p.mass, p.M);
  return LAG_OK;
}

int lag_linearise(lag_problem *pb, double t, const double *y, const double *a, double *dr, double *M, double *work) {
  if (!pb->model->linear) {
    pb->detail = "the model was emitted without its linearisation: lagc emit --with linear";
    return LAG_EMETHOD;
  }
  LinearLayout p = parts_of(pb->model, work);
  p.M = M;
  return linearise(pb, t, y, a, (size_t)pb->n, dr, p);
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
  /* a coordinate without unit may be an angle that has turned often */
  return lag_is_angle(q->periodic, q->unit) ? 1 : q->unit[0] ? size : sqrt(size);
}

/* column[n - nq] := derivative of rates by component k of the state, or by parameter k - n, with `part` of the step, by
 * differences of order 6, wrong by rounding over 2^-9 and by 2^-54/140 of a seventh derivative, for a scale of 1.
 * *apart := how far those of order 4 are, as a part. rate[n], there[n] are scratch. */
static int central_column(lag_problem *pb, const lag_parameter_columns *by, double t, const double *y, int k,
                          double part, double *column, double *there, double *rate, double *apart) {
  int n = pb->n, nq = pb->nq, rc = LAG_OK;
  const double *p = pb->p;
  double h = k < n ? part * LAG_DIFFERENCE_PART * lag_difference_scale(pb, y, k) : by->h[k - n], most = 0, far = 0;
  double *other = rate + n;
  memset(column, 0, (size_t)(n - nq) * sizeof *column);
  memset(other, 0, (size_t)(n - nq) * sizeof *other);
  memcpy(there, y, (size_t)n * sizeof *y);
  LAG_EACH_DIFFERENCE(j) {
    double fourth = (j < 0 ? -1 : 1) * (j == 1 || j == -1 ? 8 : j == 2 || j == -2 ? -1 : 0) / 12.0;
    if (k < n) there[k] = y[k] + j * h;
    else pb->p = lag_shifted_parameters(pb, by, k - n, j);
    rc = rc ? rc : lag_rhs(pb, t, there, rate);
    for (int i = nq; i < n; i++) {
      column[i - nq] += lag_difference_weight(j) * rate[i] / h;
      other[i - nq] += fourth * rate[i] / h;
    }
  }
  pb->p = p;
  for (int i = 0; i < n - nq; i++) most = fmax(most, fabs(column[i])), far = fmax(far, fabs(column[i] - other[i]));
  *apart = far > 0 ? far / most : 0;
  return rc;
}

/* J by central differences, column by column; closer ones where these differ, as of slow slips. */
static int central_jacobian(lag_problem *pb, const lag_parameter_columns *by, double t, const double *y, double *J,
                            double *work) {
  const double enough = 1e-8, smallest = 0x1p-16;
  int n = pb->n, nq = pb->nq, width = n + (by ? by->n : 0), rc = lag_rhs(pb, t, y, work);
  double *there = work + n, *column = there + n, *rate = column + n;
  for (int k = 0; k < width && rc == LAG_OK; k++) {
    double least = HUGE_VAL, apart = HUGE_VAL;
    for (double part = 1; part >= smallest && least > enough && rc == LAG_OK; part = k < n ? part / 16 : 0) {
      rc = central_column(pb, by, t, y, k, part, column, there, rate, &apart);
      if (!(apart < least)) break;
      least = apart;
      for (int i = 0; i < n - nq; i++) J[i * width + k] = column[i];
    }
  }
  return rc;
}

/* du[nu] := derivatives of inputs that follow their formulas by parameter j; at[nu] is scratch. */
static int inputs_by_parameter(lag_problem *pb, const lag_parameter_columns *by, int j, double t, double *du,
                               double *at) {
  const lag_model *m = pb->model;
  int rc = LAG_OK;
  memset(du, 0, (size_t)m->nu * sizeof *du);
  memset(at, 0, (size_t)m->nu * sizeof *at);
  LAG_EACH_DIFFERENCE(k) {
    rc = rc ? rc : m->inputs(m, t, lag_shifted_parameters(pb, by, j, k), at);
    for (int i = 0; i < m->nu; i++)
      if (isnan(pb->hold[i]) && !pb->signal[i].fn) du[i] += lag_difference_weight(k) * at[i] / by->h[j];
  }
  return rc;
}

int lag_has_listed_jacobian(const lag_problem *pb) {
  const lag_model *m = pb->model;
  const lag_linear *l = m->linear;
  if (m->constraints || pb->nslide || !l || l->nmass != m->nq) return 0;
  for (int k = 0; k < l->nmass; k++)
    if (l->mass[k].row != l->mass[k].col) return 0;
  return 1;
}

/* Adds to columns n ... of dr, rows width apart, the derivatives of residuals by parameters, with those by inputs that
 * depend on them. */
static int by_parameters(lag_problem *pb, const lag_parameter_columns *by, double t, const double *y, double *dr,
                         const LinearLayout *w) {
  const lag_partials *of = pb->model->linear->by_params, *in = pb->model->linear->by_inputs;
  int n = pb->n, nq = pb->nq, width = n + by->n, rc = LAG_OK;
  const double *a = w->rate + nq, *v = y + nq, *z = v + nq;
  if (of && of->n) rc = of->eval(of, t, y, v, z, pb->p, pb->u, a, w->part, w->mass, pb->work);
  for (const lag_parameter_term *k = by->term; k < by->term + by->nterms; k++)
    dr[k->to] += k->factor * w->part[k->from];
  if (rc == LAG_OK && in && pb->model->inputs)
    rc = in->eval(in, t, y, v, z, pb->p, pb->u, a, w->part, w->mass, pb->work);
  for (int j = 0; j < by->n && in && pb->model->inputs && rc == LAG_OK; j++) {
    rc = inputs_by_parameter(pb, by, j, t, w->u, w->u + pb->model->nu);
    for (int k = 0; k < in->n; k++) dr[in->at[k].row * width + n + j] += w->part[k] * w->u[in->at[k].col];
  }
  return rc;
}

void lag_add_by_parameters(const lag_problem *pb, const double *by_up, const double *d, double *g) {
  const lag_adjoint *of = lag_adjoint_of(pb->model);
  int nu = pb->model->nu;
  for (int i = 0; i < nu + pb->model->np; i++) g[i] += by_up[i];
  for (int k = 0; k < of->n; k++)
    if (isnan(pb->hold[of->at[k].row]) && !pb->signal[of->at[k].row].fn)
      g[nu + of->at[k].col] += by_up[of->at[k].row] * d[k];
}

/* J with constraints, a row for each rate by reverse mode. */
static int reverse_rows(lag_problem *pb, const lag_parameter_columns *by, double t, const double *y, double *J,
                        double *work) {
  const lag_model *m = pb->model;
  const lag_adjoint *of = m->constraints->adjoint;
  int n = pb->n, nq = pb->nq, rows = n - nq, width = n + (by ? by->n : 0), nup = m->nu + m->np,
      rc = lag_inputs_at(pb, t, y);
  const double *v = y + nq, *z = v + nq;
  double *f = work, *held = f + n, *weight = held + m->constraints->n, *out = weight + rows + m->constraints->n,
         *by_up = out + n, *g = by_up + nup, *d = g + nup;
  memcpy(f, v, (size_t)nq * sizeof *f);
  pb->rhs_calls++;
  rc = rc ? rc : of->rates(of, t, y, v, z, pb->p, pb->u, f + nq, f + 2 * nq, held, pb->work);
  memcpy(weight + rows, held, (size_t)m->constraints->n * sizeof *held);
  memset(J, 0, (size_t)(rows * width) * sizeof *J);
  for (int i = 0; i < rows && rc == LAG_OK; i++) {
    memset(weight, 0, (size_t)rows * sizeof *weight);
    memset(g, 0, (size_t)nup * sizeof *g);
    weight[i] = 1;
    rc = of->eval(of, t, y, v, z, pb->p, pb->u, f + nq, weight, out, by_up, d, pb->work);
    memcpy(J + i * width, out, (size_t)n * sizeof *out);
    if (!by || rc) continue;
    lag_add_by_parameters(pb, by_up, d, g);
    for (const lag_parameter_term *k = by->term; k < by->term + by->nterms; k++)
      J[i * width + n + k->to] += k->factor * g[m->nu + k->from];
  }
  return rc;
}

int lag_fine_jacobian(lag_problem *pb, const lag_parameter_columns *by, double t, const double *y, double *J,
                      double *work) {
  const lag_model *m = pb->model;
  if (m->constraints && m->constraints->adjoint && !pb->nslide && !pb->redundant)
    return reverse_rows(pb, by, t, y, J, work);
  if (m->constraints || pb->nslide) return central_jacobian(pb, by, t, y, J, work);
  if (!by || !m->linear) return lag_jacobian(pb, t, y, J, work);
  LinearLayout p = parts_of(m, work);
  size_t width = (size_t)(pb->n + by->n);
  int rc = lag_rhs(pb, t, y, p.rate);
  rc = rc ? rc : linearise(pb, t, y, p.rate + m->nq, width, J, p);
  rc = rc ? rc : by_parameters(pb, by, t, y, J, &p);
  return rc ? rc : lag_solve_dense((size_t)m->nq, width, p.M, J) ? LAG_ESINGULAR : LAG_OK;
}

int lag_listed_jacobian(lag_problem *pb, const lag_parameter_columns *by, double t, const double *y, double *J,
                        double *work) {
  const lag_model *m = pb->model;
  const lag_linear *l = m->linear;
  LinearLayout p = parts_of(m, work);
  int n = pb->n, nq = pb->nq, nby = by ? by->n : 0, width = n + nby, rc = lag_rhs(pb, t, y, p.rate);
  rc = rc ? rc : lag_inputs_at(pb, t, y);
  rc = rc ? rc
          : l->eval(l, t, y, y + nq, y + 2 * nq, pb->p, pb->u, p.rate + nq, p.dr, p.mass, pb->work);
  if (rc) return rc;
  for (int k = 0; k < nq; k++) p.M[l->mass[k].row] = p.mass[k];
  for (int k = 0; k < l->ndr; k++) J[l->dr[k].row * width + l->dr[k].col] = p.dr[k];
  for (int i = 0; i < n - nq; i++) memset(J + i * width + n, 0, (size_t)nby * sizeof *J);
  rc = by ? by_parameters(pb, by, t, y, J, &p) : LAG_OK;
  for (int k = 0; k < l->ndr && rc == LAG_OK; k++)
    if (l->dr[k].row < nq) J[l->dr[k].row * width + l->dr[k].col] /= p.M[l->dr[k].row];
  for (int i = 0; i < nq && rc == LAG_OK; i++) {
    if (!(fabs(p.M[i]) > 0)) return LAG_ESINGULAR;
    for (int j = n; j < width; j++) J[i * width + j] /= p.M[i];
  }
  return rc;
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

int lag_input_jacobian(lag_problem *pb, double t, const double *y, double *J, double *work) {
  const lag_model *m = pb->model;
  const lag_linear *l = m->linear;
  const lag_partials *in = l ? l->by_inputs : NULL;
  size_t nq = (size_t)m->nq, nu = (size_t)m->nu;
  if (!in || m->constraints || pb->nslide) return LAG_EMETHOD;
  LinearLayout p = parts_of(m, work);
  int rc = lag_rhs(pb, t, y, p.rate);
  rc = rc ? rc : in->eval(in, t, y, y + nq, y + 2 * nq, pb->p, pb->u, p.rate + nq, p.part, p.mass, pb->work);
  memset(J, 0, (nq + (size_t)m->nz) * nu * sizeof *J);
  for (int k = 0; k < in->n; k++) J[(size_t)in->at[k].row * nu + (size_t)in->at[k].col] = p.part[k];
  lag_symmetric_matrix(nq, l->nmass, l->mass, p.mass, p.M);
  return rc ? rc : lag_solve_dense(nq, nu, p.M, J) ? LAG_ESINGULAR : LAG_OK;
}
