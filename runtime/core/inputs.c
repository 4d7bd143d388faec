/* Inputs of the model at a time, and what is finite. Holds: an input is the model's formula or table unless a function
 * or a constant replaces it. */
#include <math.h>

#include "core/rhs.h"

int lag_inputs(lag_problem *pb, double t) {
  const lag_model *m = pb->model;
  for (int i = m->nu; i < m->nu + m->nmodes; i++) pb->u[i] = pb->hold[i];
  if (m->nu == 0) return 0;
  if (m->inputs) {
    int rc = m->inputs(m, t, pb->p, pb->u);
    if (rc) return rc;
  }
  for (int i = 0; i < m->nu; i++) {
    if (pb->signal[i].fn) {
      pb->u[i] = pb->signal[i].fn(pb->signal[i].context, t);
      if (!isfinite(pb->u[i])) pb->detail = "the function of an input gave no finite value";
    } else if (!isnan(pb->hold[i])) {
      pb->u[i] = pb->hold[i];
    } else if (!m->inputs) {
      pb->u[i] = 0;
    }
  }
  return 0;
}

unsigned lag_facts(const lag_problem *pb) {
  unsigned flags = pb->model->flags;
  for (int i = 0; i < pb->model->nu; i++)
    if (pb->signal[i].fn) flags &= ~(unsigned)(LAG_AUTONOMOUS | LAG_SMOOTH);
  return flags;
}

int lag_not_finite(int n, const double *x) {
  double zero = 0;
  for (int i = 0; i < n; i++) {
    zero += x[i] * 0; /* NaN where x[i] is not finite */
  }
  for (int i = 0; i < n && isnan(zero); i++)
    if (!isfinite(x[i])) return i;
  return -1;
}
