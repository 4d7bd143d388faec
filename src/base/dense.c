#include "base/dense.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

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

/* --- kernels --- */

typedef struct {
  uint32_t rows, columns, active; /* columns from `active` on are zero */
  long double *m;
  long double *along;  /* [columns] scratch */
  long double *scale;  /* [columns] 1 / length of the column, by its first place */
  long double *length; /* [columns] squared, of what is below the triangle; */
  long double *sure;   /* [columns] and when it was last computed as a whole */
  uint32_t *from;      /* [columns] first place of the column that is now here */
} Triangle;

static long double squared_below(const Triangle *t, uint32_t row, uint32_t column) {
  long double s = 0;
  for (size_t i = row; i < t->rows; i++) s += t->m[i * t->columns + column] * t->m[i * t->columns + column];
  return s;
}

static void exchange_columns(Triangle *t, uint32_t one, uint32_t other) {
  uint32_t from = t->from[one];
  t->from[one] = t->from[other];
  t->from[other] = from;
  exchange(t->m + one, t->m + other, t->rows, t->columns);
  exchange(t->length + one, t->length + other, 1, 1);
  exchange(t->sure + one, t->sure + other, 1, 1);
}

static Triangle triangle_new(Arena *a, uint32_t rows, uint32_t columns, long double *m) {
  Triangle t = {rows, columns, columns, m, ARENA_ARRAY(a, long double, columns + 1), ARENA_ARRAY(a, long double, columns + 1),
                ARENA_ARRAY(a, long double, columns + 1), ARENA_ARRAY(a, long double, columns + 1), ARENA_ARRAY(a, uint32_t, columns + 1)};
  long double largest = 0;
  for (uint32_t j = 0; j < columns; j++) largest = fmaxl(largest, t.length[j] = sqrtl(squared_below(&t, 0, j)));
  for (uint32_t j = 0; j < columns; j++) {
    int zero = !(t.length[j] > 1e-14L * largest);
    t.scale[j] = zero ? 1 : 1 / t.length[j];
    for (size_t i = 0; i < rows; i++) m[i * columns + j] *= zero ? 0 : t.scale[j];
    t.sure[j] = t.length[j] = zero ? 0 : 1;
    t.from[j] = j;
  }
  for (uint32_t j = 0; j < t.active;)
    if (t.length[j] == 0) exchange_columns(&t, j, --t.active);
    else j++;
  return t;
}

/* The column of which most is left comes to k; how much that is. */
static long double bring_longest(Triangle *t, uint32_t k) {
  uint32_t best = k;
  for (uint32_t j = k; j < t->active; j++) {
    if (t->length[j] < 1e-6L * t->sure[j]) t->sure[j] = t->length[j] = squared_below(t, k, j);
    if (t->length[j] > t->length[best]) best = j;
  }
  exchange_columns(t, k, best);
  return sqrtl(squared_below(t, k, k));
}

/* Reflects rows k.. so that column k has one element there, -+length; the columns behind it go along. */
static void reflect(Triangle *t, uint32_t k, long double length) {
  size_t w = t->columns, to = t->active;
  long double *m = t->m, alpha = m[k * w + k] > 0 ? -length : length;
  m[k * w + k] -= alpha;
  long double half = -alpha * m[k * w + k]; /* |u|^2/2 of the u that stands in column k */
  for (size_t j = k + 1; j < to; j++) t->along[j] = 0;
  for (size_t i = k; i < t->rows; i++)
    for (size_t j = k + 1; j < to; j++) t->along[j] += m[i * w + k] * m[i * w + j];
  for (size_t j = k + 1; j < to; j++) t->along[j] /= half;
  for (size_t i = k; i < t->rows; i++)
    for (size_t j = k + 1; j < to; j++) m[i * w + j] -= m[i * w + k] * t->along[j];
  m[k * w + k] = alpha;
  for (size_t j = k + 1; j < to; j++) t->length[j] -= m[k * w + j] * m[k * w + j];
}

DenseRows dense_kernel(Arena *a, uint32_t rows, uint32_t columns, long double *m, long double rest) {
  Triangle t = triangle_new(a, rows, columns, m);
  uint32_t rank = 0;
  long double taken = 1, left = 0;
  for (; rank < t.active && rank < rows; rank++) {
    long double length = bring_longest(&t, rank);
    if (!(length > rest)) {
      left = length;
      break;
    }
    taken = length;
    reflect(&t, rank, length);
  }
  DenseRows null = {columns - rank, columns, ARENA_ARRAY(a, long double, (size_t)(columns - rank) * columns + 1), taken / fmaxl(left, 1e-20L)};
  long double *x = t.along;
  for (uint32_t k = 0; k < null.n; k++) {
    for (uint32_t i = 0; i < rank; i++) x[i] = -m[(size_t)i * columns + rank + k];
    for (size_t i = rank; i-- > 0;) {
      for (size_t j = i + 1; j < rank; j++) x[i] -= m[i * columns + j] * x[j];
      x[i] /= m[i * columns + i];
    }
    long double *row = null.at + (size_t)k * columns;
    for (uint32_t i = 0; i < rank; i++) row[t.from[i]] = x[i] * t.scale[t.from[i]];
    row[t.from[rank + k]] = t.scale[t.from[rank + k]];
  }
  return null;
}

uint32_t dense_echelon(uint32_t rows, uint32_t columns, long double *m, long double rest, uint32_t *pivot) {
  size_t w = columns;
  uint32_t rank = 0;
  for (size_t c = 0; c < w && rank < rows; c++) {
    size_t best = rank;
    for (size_t i = rank; i < rows; i++)
      if (fabsl(m[i * w + c]) > fabsl(m[best * w + c])) best = i;
    if (!(fabsl(m[best * w + c]) > rest)) continue;
    exchange(m + rank * w, m + best * w, columns, 1);
    long double p = m[rank * w + c];
    for (size_t j = c; j < w; j++) m[rank * w + j] /= p;
    for (size_t i = 0; i < rows; i++) {
      long double f = i == rank ? 0 : m[i * w + c];
      for (size_t j = c; j < w && f != 0; j++) m[i * w + j] -= f * m[rank * w + j];
    }
    pivot[rank++] = (uint32_t)c;
  }
  for (size_t i = 0; i < rows; i++)
    for (size_t j = 0; j < w; j++)
      if (i >= rank || fabsl(m[i * w + j]) <= rest) m[i * w + j] = 0;
  return rank;
}

DenseRows dense_orthonormal(Arena *a, const DenseRows *from, uint32_t columns) {
  DenseRows o = {.width = columns, .at = ARENA_ARRAY(a, long double, (size_t)from->n * columns + 1)};
  for (uint32_t k = 0; k < from->n; k++) {
    long double *row = o.at + (size_t)o.n * columns, length = 0;
    memcpy(row, from->at + (size_t)k * from->width, columns * sizeof *row);
    for (uint32_t j = 0; j < columns; j++) length += row[j] * row[j];
    if (length > 0 && dense_reduce(columns, row, o.at, o.n) > 1e-9L) o.n++;
    else memset(row, 0, columns * sizeof *row);
  }
  return o;
}
