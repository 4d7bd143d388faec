#include "base/dense.h"

#include <math.h>
#include <stddef.h>

static void exchange(long double *x, long double *y, uint32_t n, size_t stride) {
  for (size_t i = 0; i < n * stride; i += stride) {
    long double t = x[i];
    x[i] = y[i];
    y[i] = t;
  }
}

/* The largest element behind row and column k comes to (k, k); 0 when it is not above `least`. */
static int pivot(uint32_t n, uint32_t k, long double *a, long double *b, long double least, uint32_t *column) {
  size_t w = n, row = k, col = k;
  for (size_t i = k; i < n; i++)
    for (size_t j = k; j < n; j++)
      if (fabsl(a[i * w + j]) > fabsl(a[row * w + col])) row = i, col = j;
  if (!(fabsl(a[row * w + col]) > least)) return 0;
  exchange(a + k * w, a + row * w, n, 1);
  exchange(a + k, a + col, n, w);
  if (b) exchange(b + k, b + row, 1, 1);
  uint32_t t = column[k];
  column[k] = column[col];
  column[col] = t;
  return 1;
}

/* The upper triangle's first `rank` rows: x of the columns before `rank`, for the right-hand side in x. */
static void back(uint32_t n, uint32_t rank, const long double *a, long double *x) {
  size_t w = n;
  for (size_t k = rank; k-- > 0;) {
    for (size_t j = k + 1; j < rank; j++) x[k] -= a[k * w + j] * x[j];
    x[k] /= a[k * w + k];
  }
}

/* x[k] and y[k] belong to unknown column[k]; either may be NULL. */
static void unscramble(uint32_t n, long double *x, long double *y, uint32_t *column) {
  for (uint32_t k = 0; k < n; k++)
    while (column[k] != k) {
      uint32_t to = column[k];
      if (x) exchange(x + k, x + to, 1, 1);
      if (y) exchange(y + k, y + to, 1, 1);
      column[k] = column[to];
      column[to] = to;
    }
}

uint32_t dense_solve(uint32_t n, long double *a, long double *b, long double rest, uint32_t *column, long double *null) {
  size_t w = n;
  long double largest = 0;
  uint32_t rank = 0;
  for (size_t i = 0; i < w * w; i++) largest = fmaxl(largest, fabsl(a[i]));
  for (uint32_t i = 0; i < n; i++) column[i] = i;
  for (; rank < n && pivot(n, rank, a, b, rest * largest, column); rank++)
    for (size_t i = rank + 1; i < n; i++) {
      long double f = a[i * w + rank] / a[rank * w + rank];
      for (size_t j = rank; j < n; j++) a[i * w + j] -= f * a[rank * w + j];
      if (b) b[i] -= f * b[rank];
    }
  for (uint32_t k = rank; b && k < n; k++) b[k] = 0;
  if (b) back(n, rank, a, b);
  if (null && rank < n) {
    for (uint32_t k = 0; k < n; k++) null[k] = k < rank ? -a[k * w + rank] : k == rank;
    back(n, rank, a, null);
  }
  unscramble(n, b, rank < n ? null : NULL, column);
  return rank;
}

long double dense_reduce(uint32_t n, long double *row, const long double *before, uint32_t rank) {
  long double was = 0, left = 0;
  for (uint32_t j = 0; j < n; j++) was += row[j] * row[j];
  for (uint32_t k = 0; k < 2 * rank; k++) {
    const long double *q = before + (size_t)(k % rank) * n;
    long double along = 0;
    for (uint32_t j = 0; j < n; j++) along += q[j] * row[j];
    for (uint32_t j = 0; j < n; j++) row[j] -= along * q[j];
  }
  for (uint32_t j = 0; j < n; j++) left += row[j] * row[j];
  left = sqrtl(left);
  for (uint32_t j = 0; j < n && left > 0; j++) row[j] /= left;
  return was > 0 ? left / sqrtl(was) : 0;
}
