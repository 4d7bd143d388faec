/* The model as y' = f(t, y), the only way in which methods call it. Enters: t, y = [q|v|z]; leaves:
 * y' = [v|a|z']. Holds: an input is the model's formula unless a constant replaces it. */
#include <math.h>
#include <string.h>

#include "core/core.h"

int lag_inputs(lag_problem *pb, double t)
{
  const lag_model *m = pb->model;

  if (m->nu == 0) {
    return 0;
  }
  if (m->inputs) {
    int rc = m->inputs(t, pb->p, pb->u);
    if (rc) {
      return rc;
    }
  }
  for (int i = 0; i < m->nu; i++) {
    if (!isnan(pb->hold[i])) {
      pb->u[i] = pb->hold[i];
    } else if (!m->inputs) {
      pb->u[i] = 0;
    }
  }
  return 0;
}

int lag_rhs(lag_problem *pb, double t, const double *y, double *dy)
{
  int nq = pb->nq;
  int rc = lag_inputs(pb, t);

  pb->rhs_calls++;
  if (rc) {
    return rc;
  }
  memcpy(dy, y + nq, (size_t)nq * sizeof *dy);
  return pb->model->accel(t, y, y + nq, y + 2 * nq, pb->p, pb->u, dy + nq, dy + 2 * nq, pb->work);
}

int lag_variation(lag_problem *pb, double t, const double *q, const double *v, double *Lq, double *Lv, double *Q)
{
  int rc = lag_inputs(pb, t);

  pb->rhs_calls++;
  return rc ? rc : pb->model->variation(t, q, v, NULL, pb->p, pb->u, Lq, Lv, Q, pb->work);
}

int lag_second_derivatives(lag_problem *pb, double t, const double *q, const double *v, double *h)
{
  int rc = lag_inputs(pb, t);

  return rc ? rc : pb->model->second(t, q, v, NULL, pb->p, pb->u, h, pb->work);
}

int lag_not_finite(int n, const double *x)
{
  for (int i = 0; i < n; i++) {
    if (!isfinite(x[i])) {
      return i;
    }
  }
  return -1;
}
