/* Solution space of B0 u + B1 u' = 0: the space of all coefficients, restricted by equations at random states until
 * it contains u' with u. */
#include <math.h>

#include "base/tolerance.h"
#include "symmetry/determining_equations.h"

enum { SPARE_ROWS = 12 };
/* least pivot of a column of length 1: rounding is 1e-18, random pivots were never seen below 1e-6 */
static const long double REST = 1e-11L;

/* x * space: coordinates in the space become coefficients u. */
static DenseRows combine(Arena *a, const DenseRows *x, const DenseRows *space) {
  DenseRows u = {x->n, space->width, ARENA_ARRAY(a, long double, (size_t)x->n * space->width + 1), x->gap};
  for (size_t k = 0; k < x->n; k++)
    for (size_t i = 0; i < space->n; i++)
      for (size_t j = 0; x->at[k * x->width + i] != 0 && j < space->width; j++)
        u.at[k * u.width + j] += x->at[k * x->width + i] * space->at[i * space->width + j];
  return u;
}

/* Nonzero elements of the space's rows, those of row k from begin[k] on; at first one a row. */
typedef struct {
  uint32_t *begin, *column;
  long double *value;
} Sparse;

static Sparse sparse_rows(Arena *a, const DenseRows *space) {
  size_t all = (size_t)space->n * space->width, count = 0;
  for (size_t i = 0; i < all; i++) count += space->at[i] != 0;
  Sparse s = {ARENA_ARRAY(a, uint32_t, space->n + 1), ARENA_ARRAY(a, uint32_t, count + 1),
              ARENA_ARRAY(a, long double, count + 1)};
  uint32_t next = 0;
  for (uint32_t k = 0; k < space->n; k++) {
    for (uint32_t j = 0; j < space->width; j++) {
      long double x = space->at[(size_t)k * space->width + j];
      if (x == 0) continue;
      s.column[next] = j;
      s.value[next++] = x;
    }
    s.begin[k + 1] = next;
  }
  return s;
}

/* Rounding in products with the rows of a space: eps over the smallest pivot that they were solved with, about
 * 1/gap. */
static long double rounding_of(const DenseRows *space) {
  const long double least = LONG_TOLERANCE(1e-15L);
  return space->gap > 0 ? fmaxl(least, 30 / space->gap) : least;
}

/* to[n] = products of a row with the rows of the space, all of length about 1. A product far below 1 is rounding and
 * becomes 0, as a kernel scales columns. */
static void project(const Sparse *s, uint32_t n, const long double *row, long double rounding, long double *to) {
  for (uint32_t k = 0; k < n; k++) {
    to[k] = 0;
    for (uint32_t x = s->begin[k]; x < s->begin[k + 1]; x++) to[k] += s->value[x] * row[s->column[x]];
    if (fabsl(to[k]) < rounding) to[k] = 0;
  }
}

/* Number of columns of m with a nonzero element. */
static uint32_t columns_used(const long double *m, uint32_t rows, uint32_t columns) {
  uint32_t used = 0;
  for (size_t j = 0; j < columns; j++) {
    size_t i = 0;
    while (i < rows && m[i * columns + j] == 0) i++;
    used += i < rows;
  }
  return used;
}

/* Kernel of (B0, B1) on vectors (x, y), u = x*space, u' = y*space. Its rank is at most the number of nonzero
 * columns, a third of all for ROWS_EVEN. It takes half as many rows again, because square random matrices are badly
 * conditioned. */
static DenseRows kernel_of_rows(RowSource *r, Arena *a, RowKind kind, const DenseRows *space, SearchLimit *limit) {
  uint32_t n = space->n, rows = 0, wanted = SPARE_ROWS;
  size_t most = 3 * n + SPARE_ROWS, w = space->width;
  if (!search_fits(limit, (double)most * 2 * (double)(w + n))) return (DenseRows){.width = 2 * n};
  long double *b0 = ARENA_ARRAY(a, long double, most * w), *b1 = ARENA_ARRAY(a, long double, most * w);
  long double *m = ARENA_ARRAY(a, long double, most * 2 * n + 1);
  Sparse sparse = sparse_rows(a, space);
  for (; rows < wanted; wanted = columns_used(m, rows, 2 * n) * 3 / 2 + SPARE_ROWS) {
    if (rows_fill(r, kind, wanted - rows, b0, b1) < wanted - rows) return (DenseRows){.width = 2 * n};
    for (size_t i = 0; rows < wanted; rows++, i++) {
      project(&sparse, n, b0 + i * w, rounding_of(space), m + (size_t)rows * 2 * n);
      project(&sparse, n, b1 + i * w, rounding_of(space), m + (size_t)rows * 2 * n + n);
    }
  }
  arena_release(a, b0, most * w * sizeof *b0);
  arena_release(a, b1, most * w * sizeof *b1);
  double used = columns_used(m, rows, 2 * n);
  DenseRows kernel = {.width = 2 * n};
  if (search_goes_on(limit, 2 * used * used * rows)) kernel = dense_kernel(a, rows, 2 * n, m, REST);
  arena_release(a, m, (most * 2 * n + 1) * sizeof *m);
  return kernel;
}

/* Intersects the space with the solutions of rows of one kind. 0: such rows could not be had. */
static int intersect(RowSource *r, Arena *a, RowKind kind, DenseRows *space, SearchLimit *limit, int *sure) {
  DenseRows kernel = kernel_of_rows(r, a, kind, space, limit);
  if (kernel.at == NULL) return 0;
  if (kernel.gap < 1e4L) *sure = 0;
  DenseRows x = dense_orthonormal(a, &kernel, space->n), u = combine(a, &x, space);
  long double gap = space->gap > 0 ? fminl(space->gap, kernel.gap) : kernel.gap;
  *space = dense_orthonormal(a, &u, u.width);
  space->gap = gap;
  return 1;
}

/* Whether a column of a space, of rows of length 1, is more than rounding. */
static int reaches(const DenseRows *space, uint32_t column) {
  for (size_t k = 0; k < space->n; k++)
    if (fabsl(space->at[k * space->width + column]) > REST) return 1;
  return 0;
}

/* The space to start from: all coefficients, or those that occur in another space. */
static DenseRows initial_space(const Ansatz *s, Arena *a, const DenseRows *within) {
  if (!search_fits(s->limit, 3.0 * s->columns * s->columns)) return (DenseRows){.width = s->columns};
  DenseRows all = {.width = s->columns, .at = ARENA_ARRAY(a, long double, (size_t)s->columns * s->columns)};
  for (uint32_t j = s->has_tau ? 0 : 1; j < s->columns; j++)
    if (!within || reaches(within, j)) all.at[(size_t)all.n++ * s->columns + j] = 1;
  return all;
}

/* A of x' = A x: the kernel spans (x, A x), with one row for each x. */
static long double *rates(RowSource *r, Arena *a, const DenseRows *space, SearchLimit *limit, int *sure) {
  uint32_t n = space->n, *pivot = ARENA_ARRAY(a, uint32_t, 2 * n + 1);
  long double *A = ARENA_ARRAY(a, long double, (size_t)n * n + 1);
  DenseRows kernel = kernel_of_rows(r, a, ROWS_ALL, space, limit);
  if (kernel.n != n) {
    *sure = 0;
    return A;
  }
  dense_echelon(n, 2 * n, kernel.at, 1e-12L, pivot);
  for (uint32_t k = 0; k < n; k++) {
    if (pivot[k] != k) *sure = 0; /* an x without a derivative: the space was not restricted far enough */
    for (uint32_t i = 0; i < n; i++) A[(size_t)i * n + k] = kernel.at[(size_t)k * 2 * n + n + i];
  }
  return A;
}

SolutionSpace solution_space(const Ansatz *s, Arena *a, const long double *parameters, const SolutionSpace *like) {
  RowSource *r = rows_new(s, a, parameters);
  SolutionSpace found = {.space = initial_space(s, a, like ? &like->space : NULL), .sure = 1};
  DenseRows *space = &found.space;
  if (!intersect(r, a, ROWS_EVEN, space, s->limit, &found.sure) ||
      !intersect(r, a, ROWS_AT_REST, space, s->limit, &found.sure))
    return (SolutionSpace){0};
  for (uint32_t before = UINT32_MAX; before != space->n;) {
    before = space->n;
    if (!intersect(r, a, ROWS_ALL, space, s->limit, &found.sure)) return (SolutionSpace){0};
    if (s->held.n && !intersect(r, a, ROWS_CONSTRAINTS, space, s->limit, &found.sure)) return (SolutionSpace){0};
  }
  found.A = rates(r, a, space, s->limit, &found.sure);
  return found;
}
