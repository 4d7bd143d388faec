/* Missing inertia. Enters: a state; leaves: the condition of its mass matrix on the directions that constraints
 * allow, and the coordinate that moves most along the direction of least inertia. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/dense.h"
#include "numeric/magnitudes.h"

int lag_massless_direction(int n, double *K, double *x, int *column, double *part) {
  double first = 0, size = 0;
  int r = 0, row, col;
  for (int i = 0; i < n; i++) column[i] = i;
  for (; r < n; r++) {
    size = lag_complete_pivot(n, r, K, &row, &col);
    int was = column[r];
    column[r] = column[col];
    column[col] = was;
    first = r == 0 ? size : first;
    if (r == n - 1 || !(size > 1e-15 * first)) break;
    for (int i = r + 1; i < n; i++) lag_eliminate_row(n, K, r, i);
  }
  *part = first > 0 ? size / first : 0;
  int most = r;
  x[r] = 1; /* the first of the remaining directions */
  for (int i = r - 1; i >= 0; i--) {
    x[i] = -K[i * n + r];
    for (int j = i + 1; j < r; j++) x[i] -= K[i * n + j] * x[j];
    x[i] /= K[i * n + i];
    most = fabs(x[i]) > fabs(x[most]) * (1 + 1e-9) ? i : most;
  }
  return column[most];
}

/* Kinetic energy: E at y less E at rest there. */
static double kinetic(lag_problem *pb, double t, const double *y, double rest) {
  double e[2];
  return pb->model->energy(pb->model, t, y, y + pb->nq, y + 2 * pb->nq, pb->p, pb->u, e, pb->work) ? NAN : e[0] - rest;
}

/* M[nq nq] by second differences of the energy p.v - L over velocities, from rest: exact up to rounding where L is
 * quadratic in them. Speeds are doubled, as long as it stays quadratic, until the energy at rest costs no digits.
 * unit[nq] := 1/sqrt of the diagonal. y[pb->n] is scratch. */
static int mass_by_energy(lag_problem *pb, double t, double *y, double *M, double *unit) {
  int n = pb->nq;
  double *v = y + n, factor = 1, most = 0;
  if (!pb->model->energy || lag_inputs(pb, t)) return LAG_EMODEL;
  for (int i = 0; i < n; i++) unit[i] = lag_typical_magnitude(pb, y, 0, i);
  memset(v, 0, (size_t)n * sizeof *v);
  double rest = kinetic(pb, t, y, 0), whole = 0, before;
  for (int turn = 0; turn < 60 && !(fabs(whole) > 0x1p10 * fabs(rest)); turn++, factor *= 2) {
    for (int i = 0; i < n; i++) v[i] = 2 * factor * unit[i];
    before = whole;
    whole = kinetic(pb, t, y, rest);
    if (!isfinite(whole) || (turn > 20 && fabs(whole - 4 * before) > 0.01 * fabs(whole))) break;
  }
  for (int k = 0; k < n; k++) { /* diagonal by diagonal, in units of speed[i] speed[j] */
    for (int i = k; i < n; i++) {
      int j = i - k;
      memset(v, 0, (size_t)n * sizeof *v);
      v[i] = factor * unit[i];
      v[j] = factor * unit[j];
      double both = kinetic(pb, t, y, rest);
      M[i * n + j] = M[j * n + i] = k == 0 ? 2 * both : both - M[i * n + i] / 2 - M[j * n + j] / 2;
      most = k == 0 ? fmax(most, fabs(2 * both)) : most;
    }
  }
  for (int i = 0; i < n; i++)
    unit[i] = fabs(M[i * n + i]) > 0x1p-50 * most ? 1 / sqrt(fabs(M[i * n + i])) : 1 / sqrt(most);
  return most > 0 && isfinite(most) ? 0 : LAG_EMODEL;
}

double lag_mass_condition(lag_problem *pb, double t, const double *y, int *which) {
  const lag_constraints *of = pb->model->constraints;
  size_t n = (size_t)pb->nq, m = of ? (size_t)of->n : 0;
  double *M = calloc(n * n + m * n + 2 * n + (size_t)pb->n, sizeof *M), *A = M + n * n, part = NAN;
  double *unit = A + m * n, *x = unit + n, *at = x + n;
  int *column = malloc((n + 1) * sizeof *column);
  *which = 0;
  if (M && column && n > 0) {
    int begun = 0, rc = 0;
    /* inertia 1 at the start: if it has vanished since, that shows */
    for (int now = pb->begin == NULL; now < 2 && rc == 0; now++) {
      memcpy(at, now ? y : pb->begin, (size_t)pb->n * sizeof *at);
      rc = of ? lag_constraint_jacobian(pb, t, at, A, x, M) : mass_by_energy(pb, t, at, M, x);
      if (rc == 0 && !begun) memcpy(unit, x, n * sizeof *x);
      begun |= !now && rc == 0;
      rc = now ? rc : 0;
    }
    for (size_t k = 0; k < n * n; k++) M[k] *= unit[k / n] * unit[k % n];
    for (size_t k = 0; k < m && rc == 0; k++) {
      double size = 0;
      for (size_t i = 0; i < n; i++) {
        A[k * n + i] *= unit[i];
        size = fmax(size, fabs(A[k * n + i]));
      }
      for (size_t i = 0; i < n * n && size > 0; i++) { /* a multiple of each constraint that no inertia cancels */
        M[i] += lag_uneven((int)k) * (A[k * n + i / n] / size) * (A[k * n + i % n] / size);
      }
    }
    if (rc == 0) *which = lag_massless_direction((int)n, M, x, column, &part);
  }
  free(M);
  free(column);
  return 1 / part;
}
