/* Dense linear algebra in long double, all matrices row-major: inverse, Gram-Schmidt, kernel by pivoted QR, row
 * echelon form. */
#include "base/dense_matrix.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/sparse_solve.h"
#include "base/tolerance.h"

static void exchange(long double *x, long double *y, uint32_t n, size_t stride) {
  for (size_t i = 0; i < n * stride; i += stride) {
    long double t = x[i];
    x[i] = y[i];
    y[i] = t;
  }
}

uint32_t dense_solve(Arena *arena, uint32_t n, const long double *a, long double *b, long double tolerance,
                     long double *null) {
  ArenaMark before = arena_mark(arena);
  SparseElements all = {0};
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < n; j++) sparse_put(arena, &all, i, j, a[(size_t)i * n + j]);
  uint32_t rank = sparse_solve(arena, n, &all, b, tolerance, null);
  arena_forget(arena, before);
  return rank;
}

/* Orthonormal rows; row k has its nonzeros in column[begin[k]] .. column[begin[k + 1] - 1]. */
typedef struct {
  const long double *at;
  uint32_t n, width, *begin, *column; /* NULL: all columns */
} Basis;

/* Subtracts from the row its projection onto row k of the basis. */
static void subtract_projection(const Basis *b, uint32_t k, long double *row) {
  const long double *q = b->at + (size_t)k * b->width;
  uint32_t from = b->begin ? b->begin[k] : 0, to = b->begin ? b->begin[k + 1] : b->width;
  const uint32_t *column = b->column;
  long double along = 0;
  for (uint32_t x = from; x < to; x++) {
    uint32_t j = column ? column[x] : x;
    along += q[j] * row[j];
  }
  for (uint32_t x = from; x < to && along != 0; x++) {
    uint32_t j = column ? column[x] : x;
    row[j] -= along * q[j];
  }
}

static long double gram_schmidt(const Basis *b, long double *row) {
  long double was = 0, left = 0;
  for (uint32_t j = 0; j < b->width; j++) was += row[j] * row[j];
  for (uint32_t k = 0; k < 2 * b->n; k++) subtract_projection(b, k % b->n, row);
  for (uint32_t j = 0; j < b->width; j++) left += row[j] * row[j];
  left = sqrtl(left);
  for (uint32_t j = 0; j < b->width && left > 0; j++) row[j] /= left;
  return was > 0 ? left / sqrtl(was) : 0;
}

long double dense_gram_schmidt(uint32_t n, long double *row, const long double *before, uint32_t rank) {
  return gram_schmidt(&(Basis){.at = before, .n = rank, .width = n}, row);
}

/* --- kernels --- */

typedef struct {
  uint32_t rows, columns, active; /* columns from `active` on are 0 */
  long double *m;
  long double *along;  /* [columns] scratch */
  long double *scale;  /* [columns] 1 / length of the column, by its original index */
  long double *length; /* [columns] squared length below the triangle, updated; */
  long double *sure;   /* [columns] its value when last computed afresh */
  uint32_t *from;      /* [columns] original index of the column now here */
} PivotedQR;

static long double squared_below(const PivotedQR *t, uint32_t row, uint32_t column) {
  long double s = 0;
  for (size_t i = row; i < t->rows; i++) s += t->m[i * t->columns + column] * t->m[i * t->columns + column];
  return s;
}

static void exchange_columns(PivotedQR *t, uint32_t one, uint32_t other) {
  uint32_t from = t->from[one];
  t->from[one] = t->from[other];
  t->from[other] = from;
  exchange(t->m + one, t->m + other, t->rows, t->columns);
  exchange(t->length + one, t->length + other, 1, 1);
  exchange(t->sure + one, t->sure + other, 1, 1);
}

static PivotedQR pivoted_qr_new(Arena *a, uint32_t rows, uint32_t columns, long double *m) {
  PivotedQR t = {rows,
                 columns, columns, m, ARENA_ARRAY(a, long double, columns + 1),
                 ARENA_ARRAY(a, long double, columns + 1), ARENA_ARRAY(a, long double, columns + 1),
                 ARENA_ARRAY(a, long double, columns + 1),
                 ARENA_ARRAY(a, uint32_t, columns + 1)};
  long double largest = 0;
  for (uint32_t j = 0; j < columns; j++) largest = fmaxl(largest, t.length[j] = sqrtl(squared_below(&t, 0, j)));
  for (uint32_t j = 0; j < columns; j++) {
    int zero = !(t.length[j] > LONG_TOLERANCE(1e-14L) * largest);
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

/* Exchanges the longest remaining column into place k and returns its length below row k. */
static long double bring_pivot_column(PivotedQR *t, uint32_t k) {
  uint32_t best = k;
  for (uint32_t j = k; j < t->active; j++) {
    if (t->length[j] < 1e-6L * t->sure[j]) t->sure[j] = t->length[j] = squared_below(t, k, j);
    if (t->length[j] > t->length[best]) best = j;
  }
  exchange_columns(t, k, best);
  return sqrtl(squared_below(t, k, k));
}

/* Householder reflection of rows k..: column k keeps one element -+length there; applied to the columns after it. */
static void reflect(PivotedQR *t, uint32_t k, long double length) {
  size_t w = t->columns, to = t->active;
  long double *m = t->m, alpha = m[k * w + k] > 0 ? -length : length;
  m[k * w + k] -= alpha;
  long double half = -alpha * m[k * w + k]; /* |u|^2/2 of the reflector u, which stands in column k */
  for (size_t j = k + 1; j < to; j++) t->along[j] = 0;
  for (size_t i = k; i < t->rows; i++)
    for (size_t j = k + 1; j < to && m[i * w + k] != 0; j++) t->along[j] += m[i * w + k] * m[i * w + j];
  for (size_t j = k + 1; j < to; j++) t->along[j] /= half;
  for (size_t i = k; i < t->rows; i++)
    for (size_t j = k + 1; j < to && m[i * w + k] != 0; j++) m[i * w + j] -= m[i * w + k] * t->along[j];
  m[k * w + k] = alpha;
  for (size_t j = k + 1; j < to; j++) t->length[j] -= m[k * w + j] * m[k * w + j];
}

DenseRows dense_kernel(Arena *a, uint32_t rows, uint32_t columns, long double *m, long double tolerance) {
  PivotedQR t = pivoted_qr_new(a, rows, columns, m);
  uint32_t rank = 0;
  long double taken = 1, left = 0;
  for (; rank < t.active && rank < rows; rank++) {
    long double length = bring_pivot_column(&t, rank);
    if (!(length > tolerance)) {
      left = length;
      break;
    }
    taken = length;
    reflect(&t, rank, length);
  }
  DenseRows null = {columns - rank, columns, ARENA_ARRAY(a, long double, (size_t)(columns - rank) * columns + 1),
                    taken / fmaxl(left, 1e-20L)};
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

uint32_t dense_echelon(uint32_t rows, uint32_t columns, long double *m, long double tolerance, uint32_t *pivot) {
  size_t w = columns;
  uint32_t rank = 0;
  for (size_t c = 0; c < w && rank < rows; c++) {
    size_t best = rank;
    for (size_t i = rank; i < rows; i++)
      if (fabsl(m[i * w + c]) > fabsl(m[best * w + c])) best = i;
    if (!(fabsl(m[best * w + c]) > tolerance)) continue;
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
      if (i >= rank || fabsl(m[i * w + j]) <= tolerance) m[i * w + j] = 0;
  return rank;
}

/* Appends the row behind the basis to it: records its nonzeros. */
static void append_to_basis(Basis *b) {
  uint32_t next = b->begin[b->n];
  for (uint32_t j = 0; j < b->width; j++)
    if (b->at[(size_t)b->n * b->width + j] != 0) b->column[next++] = j;
  b->begin[++b->n] = next;
}

DenseRows dense_orthonormal(Arena *a, const DenseRows *from, uint32_t columns) {
  size_t all = (size_t)from->n * columns;
  DenseRows o = {.width = columns, .at = ARENA_ARRAY(a, long double, all + 1)};
  Basis basis = {.at = o.at,
                 .width = columns,
                 .begin = ARENA_ARRAY(a, uint32_t, from->n + 1),
                 .column = ARENA_ARRAY(a, uint32_t, all + 1)};
  for (uint32_t k = 0; k < from->n; k++) {
    long double *row = o.at + (size_t)basis.n * columns, length = 0;
    memcpy(row, from->at + (size_t)k * from->width, columns * sizeof *row);
    for (uint32_t j = 0; j < columns; j++) length += row[j] * row[j];
    /* else the next row takes its place */
    if (length > 0 && gram_schmidt(&basis, row) > 1e-9L) append_to_basis(&basis);
  }
  o.n = basis.n;
  return o;
}

long double dense_largest(const long double *x, size_t n) {
  long double most = 0;
  for (size_t i = 0; i < n; i++) most = fmaxl(most, fabsl(x[i]));
  return most;
}

/* The solutions X of m X = B, row i of them at [i * (n + count)]; column k of B is rows[k * n ..],
 * without rows of the identity. NULL: m is singular. */
static const long double *solve_beside(Arena *a, uint32_t n, const long double *m, uint32_t count,
                                       const long double *rows, long double tolerance) {
  size_t w = (size_t)n + count;
  long double *both = ARENA_ARRAY(a, long double, n * w + 1);
  uint32_t *pivot = ARENA_ARRAY(a, uint32_t, n + 1);
  for (size_t i = 0; i < n; i++) {
    memcpy(both + i * w, m + i * n, n * sizeof *m);
    for (size_t k = 0; k < count; k++) both[i * w + n + k] = rows ? rows[k * n + i] : i == k;
  }
  uint32_t rank = dense_echelon(n, (uint32_t)w, both, tolerance, pivot);
  for (uint32_t i = 0; i < n; i++)
    if (rank < n || pivot[i] != i) return NULL; /* a column without a pivot was passed over */
  return isfinite(dense_largest(m, (size_t)n * n)) ? both + n : NULL;
}

int dense_invert(Arena *arena, uint32_t n, const long double *a, long double *inverse) {
  ArenaMark before = arena_mark(arena);
  const long double *x = solve_beside(arena, n, a, n, NULL, 0);
  for (size_t i = 0; i < n && x; i++) memcpy(inverse + i * n, x + i * 2 * n, n * sizeof *inverse);
  arena_forget(arena, before);
  return x != NULL;
}

int dense_solve_rows(Arena *a, uint32_t n, const long double *m, uint32_t count, long double *rows) {
  ArenaMark before = arena_mark(a);
  const long double *x = solve_beside(a, n, m, count, rows, 1e-13L * dense_largest(m, (size_t)n * n));
  for (size_t i = 0; i < n && x; i++)
    for (size_t k = 0; k < count; k++) rows[k * n + i] = x[i * ((size_t)n + count) + k];
  arena_forget(a, before);
  return x != NULL;
}
