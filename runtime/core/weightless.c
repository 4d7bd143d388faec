/* Which coordinate has neither inertia nor a constraint. Enters: what both say of each direction; leaves: the coordinate that the direction
 * without either changes most. */
#include <math.h>

#include "core/core.h"

static void swap(double *a, double *b)
{
  double x = *a;
  *a = *b;
  *b = x;
}

/* The largest element of the rest of K comes to k, k. Returns its size. */
static double bring_pivot(int n, int k, double *K, int *column)
{
  int row = k, col = k;

  for (int i = k; i < n; i++) {
    for (int j = k; j < n; j++) {
      if (fabs(K[i * n + j]) > fabs(K[row * n + col])) {
        row = i;
        col = j;
      }
    }
  }
  for (int j = 0; j < n; j++) {
    swap(&K[k * n + j], &K[row * n + j]);
  }
  for (int i = 0; i < n; i++) {
    swap(&K[i * n + k], &K[i * n + col]);
  }
  int was = column[k];
  column[k] = column[col];
  column[col] = was;
  return fabs(K[k * n + k]);
}

int lag_weightless(int n, double *K, double *x, int *column)
{
  const double least = 1e-12;
  int r = 0, most;

  for (int i = 0; i < n; i++) {
    column[i] = i;
  }
  for (double first = 0, size; r < n; r++) {
    size = bring_pivot(n, r, K, column);
    first = r == 0 ? size : first;
    if (!(size > least * first)) {
      break;
    }
    for (int i = r + 1; i < n; i++) {
      double factor = K[i * n + r] / K[r * n + r];
      for (int j = r; j < n; j++) {
        K[i * n + j] -= factor * K[r * n + j];
      }
    }
  }
  if (r == n) {
    return -1;
  }
  most = r;
  x[r] = 1; /* of the directions that are left: along the first */
  for (int i = r - 1; i >= 0; i--) {
    x[i] = -K[i * n + r];
    for (int j = i + 1; j < r; j++) {
      x[i] -= K[i * n + j] * x[j];
    }
    x[i] /= K[i * n + i];
    most = fabs(x[i]) > fabs(x[most]) * (1 + 1e-9) ? i : most;
  }
  return column[most];
}
