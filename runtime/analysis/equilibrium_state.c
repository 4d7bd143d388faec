/* The equations of a model at rest, and tests for a singular mass matrix and for forces without a derivative. */
#include "analysis/equilibrium_state.h"

#include <math.h>

#include "numeric/dense.h"

void lag_equilibrium_state(Equilibrium *r, const double *x) {
  int nq = r->sim->pb.nq;
  for (int i = 0; i < r->n; i++) r->y[i < nq ? i : nq + i] = x[i] * r->scale[i];
}

int lag_equilibrium_equations(void *context, const double *x, double *f, double *J) {
  Equilibrium *r = context;
  lag_problem *pb = &r->sim->pb;
  int nq = pb->nq, n = r->n;
  double t = r->sim->run->t;
  lag_equilibrium_state(r, x);
  int rc = lag_rhs(pb, t, r->y, r->rate);
  rc = rc ? rc : lag_linearise(pb, t, r->y, NULL, r->dr, r->M, r->work);
  for (int i = 0; i < n && rc == 0; i++) {
    double weight = (i < nq ? r->scale[i] : 1 / r->scale[i]) * r->row[i], sum = 0;
    for (int j = 0; j < nq && i < nq; j++) sum += r->M[i * nq + j] * r->rate[nq + j];
    f[i] = weight * (i < nq ? sum : r->rate[nq + i]);
    for (int j = 0; j < n && J; j++) J[i * n + j] = weight * r->dr[i * pb->n + (j < nq ? j : nq + j)] * r->scale[j];
  }
  return rc;
}

/* ---- Regularity of a place */

/* Distance of M[n * n] from a singular matrix: the least pivot of symmetric elimination relative to size[n], the usual diagonal. M is destroyed. */
static double least_pivot(int n, double *M, const double *size) {
  double least = HUGE_VAL;
  for (int k = 0; k < n; k++) {
    double pivot = M[k * n + k];
    least = size[k] > 0 ? fmin(least, fabs(pivot) / size[k]) : least;
    for (int i = k + 1; i < n && pivot != 0.0; i++) lag_eliminate_row(n, M, k, i);
  }
  return least;
}

int lag_is_coordinate_pole(Equilibrium *r) {
  int n = r->n, nq = r->sim->pb.nq;
  double *size = r->dx;
  for (int i = 0; i < n; i++) { /* a tenth of a scale away, along no diagonal */
    r->trial[i] = r->x[i] + 0.1 / (1 + 0.3 * (i % 3));
  }
  if (lag_equilibrium_equations(r, r->trial, r->f, NULL)) return 0;
  for (int i = 0; i < nq; i++) size[i] = fabs(r->M[i * nq + i]);
  double beside = least_pivot(nq, r->M, size);
  double here = lag_equilibrium_equations(r, r->x, r->f, NULL) ? 0 : least_pivot(nq, r->M, size);
  return here < 1e-9 * beside;
}

/* to[n * n] := derivatives of the forces with each unknown displaced by +-c. */
static int displaced_derivatives(Equilibrium *r, int pattern, double c, double *to) {
  for (int i = 0; i < r->n; i++) {
    double sign = (pattern & 1 ? -1 : 1) * (pattern & 2 && i % 2 ? -1 : 1);
    r->trial[i] = r->x[i] + sign * c;
  }
  return lag_equilibrium_equations(r, r->trial, r->f, to);
}

/* Whether derivatives change within 1e-9 of a scale as much as within 1e-3; smooth ones change a million times less. */
static int changes_at_once(int n, const double *here, const double *near, const double *far) {
  for (int i = 0; i < n; i++) {
    double most = 0;
    for (int j = 0; j < n; j++) most = fmax(most, fmax(fabs(here[i * n + j]), fabs(far[i * n + j])));
    for (int j = 0; j < n; j++) {
      double a = fabs(near[i * n + j] - here[i * n + j]), b = fabs(far[i * n + j] - here[i * n + j]);
      if (a > 0.1 * b && a > 1e-6 * most) return 1;
    }
  }
  return 0;
}

int lag_is_nonsmooth(Equilibrium *r) {
  double *here = r->J, *near = r->W, *far = r->scratch;
  int rough = 0;
  for (int pattern = 0; pattern < 4 && !rough; pattern++) {
    rough = displaced_derivatives(r, pattern, 0, here) == 0 && displaced_derivatives(r, pattern, 1e-9, near) == 0 && displaced_derivatives(r, pattern, 1e-3, far) == 0 &&
            changes_at_once(r->n, here, near, far);
  }
  return rough;
}
