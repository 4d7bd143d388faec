/* The equations of a model at rest. */
#include "analysis/equilibrium_state.h"

void lag_equilibrium_state(Equilibrium *r, const double *x)
{
  int nq = r->sim->pb.nq;

  for (int i = 0; i < r->n; i++) {
    r->y[i < nq ? i : nq + i] = x[i] * r->scale[i];
  }
}

int lag_equilibrium_equations(void *context, const double *x, double *f, double *J)
{
  Equilibrium *r = context;
  lag_problem *pb = &r->sim->pb;
  int nq = pb->nq, n = r->n;
  double t = r->sim->run->t;

  lag_equilibrium_state(r, x);
  int rc = lag_rhs(pb, t, r->y, r->rate);
  rc = rc ? rc : lag_linearise(pb, t, r->y, NULL, r->dr, r->M, r->work);
  for (int i = 0; i < n && rc == 0; i++) {
    double weight = (i < nq ? r->scale[i] : 1 / r->scale[i]) * r->row[i], sum = 0;
    for (int j = 0; j < nq && i < nq; j++) {
      sum += r->M[i * nq + j] * r->rate[nq + j];
    }
    f[i] = weight * (i < nq ? sum : r->rate[nq + i]);
    for (int j = 0; j < n && J; j++) {
      J[i * n + j] = weight * r->dr[i * pb->n + (j < nq ? j : nq + j)] * r->scale[j];
    }
  }
  return rc;
}
