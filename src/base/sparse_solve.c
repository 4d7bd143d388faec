/* Sparse Gaussian elimination with equilibration and threshold pivoting, rank-revealing; and regularity of M on the
 * kernel of A. */
#include "base/sparse_solve.h"

#include <float.h>
#include <limits.h>
#include <math.h>

/* --- matrices by rows --- */

/* Compressed rows: elements of row i are at[from[i]] .. at[from[i + 1] - 1], by ascending columns. */
typedef struct {
  uint32_t n, *from;
  SparseElement *at;
} Matrix;

/* Counting sort of `from` into `to` by row or column, stable; start[n + 1]: index of the first element of each line. */
static void sort_by(uint32_t n, const SparseElement *from, size_t count, SparseElement *to, uint32_t *start,
                    int by_row) {
  for (uint32_t i = 0; i <= n; i++) start[i] = 0;
  for (size_t k = 0; k < count; k++) start[by_row ? from[k].row : from[k].col]++;
  for (uint32_t i = 0, sum = 0; i <= n; i++) {
    uint32_t here = start[i];
    start[i] = sum;
    sum += here;
  }
  for (size_t k = 0; k < count; k++) to[start[by_row ? from[k].row : from[k].col]++] = from[k];
  for (uint32_t i = n; i > 0; i--) start[i] = start[i - 1];
  start[0] = 0;
}

static Matrix matrix_of(Arena *arena, uint32_t n, const SparseElements *a) {
  Matrix m = {n, ARENA_ARRAY(arena, uint32_t, n + 1), ARENA_ARRAY(arena, SparseElement, a->n + 1)};
  SparseElement *by_column = ARENA_ARRAY(arena, SparseElement, a->n + 1);
  sort_by(n, a->at, a->n, by_column, m.from, 0);
  sort_by(n, by_column, a->n, m.at, m.from, 1);
  uint32_t kept = 0;
  for (uint32_t i = 0, k = 0; i < n; i++) {
    uint32_t end = m.from[i + 1], first = kept;
    m.from[i] = first;
    for (; k < end; k++)
      if (kept > first && m.at[kept - 1].col == m.at[k].col) m.at[kept - 1].value += m.at[k].value;
      else m.at[kept++] = m.at[k];
  }
  m.from[n] = kept;
  return m;
}

/* --- scales --- */

enum { NOT_COUNTED = INT_MIN / 4 };

/* Binary exponents of the elements; NOT_COUNTED where one is 0, not finite, or at the level of double rounding
 * beside the largest of its row and column. */
static int *exponents_of(Arena *arena, const Matrix *m) {
  const int rounding = 2 * (DBL_MANT_DIG - 1) - 8;
  uint32_t n = m->n, count = m->from[n];
  int *top = ARENA_ARRAY(arena, int, 2 * (size_t)n + 1), *size = ARENA_ARRAY(arena, int, (size_t)count + 1);
  for (uint32_t i = 0; i < 2 * n; i++) top[i] = NOT_COUNTED;
  for (uint32_t k = 0; k < count; k++) {
    const SparseElement *x = &m->at[k];
    size[k] = NOT_COUNTED;
    if (x->value == 0 || !isfinite(x->value)) continue;
    (void)frexpl(x->value, &size[k]);
    if (size[k] > top[x->row]) top[x->row] = size[k];
    if (size[k] > top[n + x->col]) top[n + x->col] = size[k];
  }
  for (uint32_t k = 0; k < count; k++)
    if (size[k] != NOT_COUNTED && 2 * size[k] < top[m->at[k].row] + top[n + m->at[k].col] - rounding)
      size[k] = NOT_COUNTED;
  return size;
}

/* Line i < n is row i, line n + j column j. */
static void equilibrate(Arena *arena, const Matrix *m, int *row, int *column) {
  uint32_t n = m->n, *counted = ARENA_ARRAY(arena, uint32_t, 2 * (size_t)n + 1);
  const int *size = exponents_of(arena, m);
  long double *scale = ARENA_ARRAY(arena, long double, 2 * (size_t)n + 1),
              *sum = ARENA_ARRAY(arena, long double, 2 * (size_t)n + 1), moved = 1;
  for (int turn = 0; turn < 60 && moved > 0.1L; turn++) {
    moved = 0;
    for (uint32_t first = 0; first < 2 * n; first += n) { /* all rows, then all columns */
      for (uint32_t line = first; line < first + n; line++) counted[line] = 0, sum[line] = 0;
      for (uint32_t k = 0; k < m->from[n]; k++) {
        uint32_t line = first ? n + m->at[k].col : m->at[k].row, other = first ? m->at[k].row : n + m->at[k].col;
        if (size[k] == NOT_COUNTED) continue;
        sum[line] += size[k] + scale[other];
        counted[line]++;
      }
      for (uint32_t line = first; line < first + n; line++) {
        long double was = scale[line];
        if (counted[line]) scale[line] = -sum[line] / counted[line];
        moved = fmaxl(moved, fabsl(scale[line] - was));
      }
    }
  }
  for (uint32_t i = 0; i < n; i++) {
    if (row) row[i] = (int)lroundl(scale[i]);
    column[i] = (int)lroundl(scale[n + i]);
  }
}

void sparse_equilibrate(Arena *arena, uint32_t n, const SparseElements *a, int *row, int *column) {
  ArenaMark before = arena_mark(arena);
  Matrix m = matrix_of(arena, n, a);
  equilibrate(arena, &m, row, column);
  arena_forget(arena, before);
}

/* --- elimination --- */

typedef struct {
  uint32_t col;
  long double value;
} Element;

typedef VEC(Element) Row;
typedef VEC(uint32_t) Lines;

typedef struct {
  Arena *arena;
  uint32_t n, rank;
  Row *rows;       /* an eliminated row begins with its pivot */
  Lines *columns;  /* rows with an element in the column, eliminated rows included */
  uint32_t *count; /* [n] elements of the column in remaining rows */
  uint32_t *taken; /* [rank] eliminated rows, in order */
  unsigned char *is_taken;
  /* remaining rows in doubly linked lists, one for each length and size class: 1 + row, 0: none */
  uint32_t *first, *next, *before;
  int top; /* binary exponent of the initial largest element */
  long double *most;  /* [2 n] tournament tree: largest element of row i at n + i, of nodes 2 k and 2 k + 1 at k */
  uint32_t *place;    /* [n] scratch: 1 + index of the column in the current row */
} Elimination;

static void update_largest(Elimination *x, uint32_t i, const Row *r) {
  size_t k = x->n + (size_t)i;
  long double most = 0;
  for (uint32_t j = 0; j < r->n; j++)
    if (fabsl(r->at[j].value) > most) most = fabsl(r->at[j].value);
  for (x->most[k] = most; k > 1; k /= 2) {
    long double one = x->most[k], other = x->most[k ^ 1];
    x->most[k / 2] = one > other ? one : other;
  }
}

/* Size classes of rows by the binary exponent of their largest element, from the initial largest on down. */
enum { SIZES = 64, LENGTHS = 64 };

static uint32_t size_class(const Elimination *x, long double most) {
  int exponent;
  if (!(most > 0) || !isfinite(most)) return most > 0 ? 0 : SIZES - 1;
  (void)frexpl(most, &exponent);
  return exponent >= x->top ? 0 : x->top - exponent < SIZES ? (uint32_t)(x->top - exponent) : SIZES - 1;
}

/* Head of the list of row i; long rows share the lists of one length. */
static uint32_t *list_of(const Elimination *x, uint32_t i) {
  uint32_t length = x->rows[i].n < LENGTHS ? x->rows[i].n : LENGTHS;
  return &x->first[length * SIZES + size_class(x, x->most[x->n + (size_t)i])];
}

static void list_row(Elimination *x, uint32_t i) {
  uint32_t *first = list_of(x, i);
  x->next[i] = *first;
  x->before[i] = 0;
  if (*first) x->before[*first - 1] = i + 1;
  *first = i + 1;
}

static void unlist_row(Elimination *x, uint32_t i) {
  if (x->before[i]) x->next[x->before[i] - 1] = x->next[i];
  else *list_of(x, i) = x->next[i];
  if (x->next[i]) x->before[x->next[i] - 1] = x->before[i];
}

static Elimination elimination_new(Arena *arena, const Matrix *m, const int *by_row, const int *by_column) {
  uint32_t n = m->n;
  Elimination x = {.arena = arena,
                   .n = n, .rows = ARENA_ARRAY(arena, Row, n + 1), .columns = ARENA_ARRAY(arena, Lines, n + 1),
                   .count = ARENA_ARRAY(arena, uint32_t, n + 1), .taken = ARENA_ARRAY(arena, uint32_t, n + 1),
                   .is_taken = ARENA_ARRAY(arena, unsigned char, n + 1),
                   .first = ARENA_ARRAY(arena, uint32_t, SIZES * ((n < LENGTHS ? n : LENGTHS) + (size_t)1)),
                   .next = ARENA_ARRAY(arena, uint32_t, n + 1), .before = ARENA_ARRAY(arena, uint32_t, n + 1),
                   .most = ARENA_ARRAY(arena, long double, 2 * (size_t)n + 2),
                   .place = ARENA_ARRAY(arena, uint32_t, n + 1)};
  for (uint32_t i = 0; i < n; i++) {
    for (uint32_t k = m->from[i]; k < m->from[i + 1]; k++) {
      uint32_t col = m->at[k].col;
      vec_push(arena, &x.rows[i], ((Element){col, ldexpl(m->at[k].value, by_row[i] + by_column[col])}));
      vec_push(arena, &x.columns[col], i);
      x.count[col]++;
    }
    update_largest(&x, i, &x.rows[i]);
  }
  if (n && isfinite(x.most[1])) (void)frexpl(x.most[1], &x.top);
  for (uint32_t i = n; i-- > 0;) list_row(&x, i);
  return x;
}

/* One of the shortest rows with an element of at least `least`, which some row has; large ones first. */
static uint32_t shortest_row(const Elimination *x, long double least) {
  uint32_t last = size_class(x, least);
  for (uint32_t length = 1;; length++)
    for (uint32_t size = 0; size <= last; size++)
      for (uint32_t i = x->first[length * SIZES + size]; i; i = x->next[i - 1])
        if (x->most[x->n + (size_t)i - 1] >= least) return i - 1;
}

/* Moves the pivot to the front of the row: of its elements of at least `least`, the one in the shortest column. */
static void bring_pivot(const Elimination *x, Row *r, long double least) {
  uint32_t at = UINT32_MAX;
  for (uint32_t k = 0; k < r->n; k++)
    if (fabsl(r->at[k].value) >= least && (at == UINT32_MAX || x->count[r->at[k].col] < x->count[r->at[at].col]))
      at = k;
  Element pivot = r->at[at];
  r->at[at] = r->at[0];
  r->at[0] = pivot;
}

/* Chooses the next pivot row, with a pivot of at least a sixteenth of the largest element, or of the initial largest
 * where elements have grown, as in a row that sums all members (its one long row would be taken and fill the others).
 * Sixteenth: a power of two, so that a size class holds no row that is searched in vain. A row a quarter as long may
 * have a pivot 2^-12 as large, as where members enter that sum with factors of many sizes: of 64 bits 12, and ranks are
 * decided at 2^-43. Returns 0 where no element is above `least`. */
static int choose_pivot_row(Elimination *x, long double least, uint32_t *row) {
  static const Row none;
  long double largest = x->n ? x->most[1] : 0;
  if (!(largest > least)) return 0;
  int exponent = 0;
  (void)frexpl(largest, &exponent);
  long double enough = isfinite(largest) ? ldexpl(1, (exponent < x->top ? exponent : x->top) - 4) : largest;
  long double relaxed = fmaxl(ldexpl(enough, -12), least);
  uint32_t i = shortest_row(x, enough), shorter = shortest_row(x, relaxed);
  if (x->rows[shorter].n <= x->rows[i].n / 4) i = shorter, enough = relaxed;
  *row = i;
  bring_pivot(x, &x->rows[i], fmaxl(enough, x->most[x->n + (size_t)i] / 16));
  unlist_row(x, i);
  update_largest(x, i, &none);
  x->is_taken[i] = 1;
  x->taken[x->rank++] = i;
  for (uint32_t k = 0; k < x->rows[i].n; k++) x->count[x->rows[i].at[k].col]--;
  return 1;
}

/* Subtracts the multiple of the pivot row that eliminates the pivot's column from row i, and returns the multiple. */
static long double subtract_pivot_row(Elimination *x, const Row *pivot, uint32_t i) {
  Row *r = &x->rows[i];
  unlist_row(x, i);
  for (uint32_t k = 0; k < r->n; k++) x->place[r->at[k].col] = k + 1;
  uint32_t out = x->place[pivot->at[0].col] - 1;
  long double f = r->at[out].value / pivot->at[0].value;
  for (uint32_t k = 1; k < pivot->n; k++) {
    uint32_t col = pivot->at[k].col;
    if (x->place[col]) {
      r->at[x->place[col] - 1].value -= f * pivot->at[k].value;
      continue;
    }
    vec_push(x->arena, r, ((Element){col, -f * pivot->at[k].value}));
    vec_push(x->arena, &x->columns[col], i);
    x->count[col]++;
  }
  for (uint32_t k = 0; k < r->n; k++) x->place[r->at[k].col] = 0;
  r->at[out] = r->at[--r->n];
  update_largest(x, i, r);
  list_row(x, i);
  return f;
}

static void eliminate(Elimination *x, long double *b, long double least) {
  for (uint32_t row; choose_pivot_row(x, least, &row);) {
    const Row *pivot = &x->rows[row];
    const Lines *below = &x->columns[pivot->at[0].col];
    for (uint32_t k = 0; k < below->n; k++) {
      uint32_t i = below->at[k];
      if (x->is_taken[i]) continue;
      long double f = subtract_pivot_row(x, pivot, i);
      if (b) b[i] -= f * b[row];
    }
  }
}

/* Back substitution: unknowns of the pivots from right-hand sides b (NULL: 0) and the free unknowns, which stand in
 * x. */
static void substitute_back(const Elimination *e, const long double *b, long double *x) {
  for (uint32_t k = e->rank; k-- > 0;) {
    const Row *r = &e->rows[e->taken[k]];
    long double sum = b ? b[e->taken[k]] : 0;
    for (uint32_t j = 1; j < r->n; j++) sum -= r->at[j].value * x[r->at[j].col];
    x[r->at[0].col] = sum / r->at[0].value;
  }
}

/* The first unknown without a pivot. */
static uint32_t first_free(const Elimination *e) {
  unsigned char *has_pivot = ARENA_ARRAY(e->arena, unsigned char, e->n + 1);
  uint32_t free = 0;
  for (uint32_t k = 0; k < e->rank; k++) has_pivot[e->rows[e->taken[k]].at[0].col] = 1;
  while (has_pivot[free]) free++;
  return free;
}

uint32_t sparse_solve(Arena *arena, uint32_t n, const SparseElements *a, long double *b, long double tolerance,
                      long double *null) {
  ArenaMark before = arena_mark(arena);
  Matrix m = matrix_of(arena, n, a);
  int *by_row = ARENA_ARRAY(arena, int, n + 1), *by_column = ARENA_ARRAY(arena, int, n + 1);
  equilibrate(arena, &m, by_row, by_column);
  Elimination e = elimination_new(arena, &m, by_row, by_column);
  long double *x = ARENA_ARRAY(arena, long double, n + 1);
  for (uint32_t i = 0; b && i < n; i++) b[i] = ldexpl(b[i], by_row[i]);
  eliminate(&e, b, tolerance * e.most[1]);
  if (b) substitute_back(&e, b, x);
  for (uint32_t i = 0; b && i < n; i++) b[i] = ldexpl(x[i], by_column[i]);
  if (null && e.rank < n) {
    for (uint32_t i = 0; i < n; i++) null[i] = 0;
    null[first_free(&e)] = 1;
    substitute_back(&e, NULL, null);
    for (uint32_t i = 0; i < n; i++) null[i] = ldexpl(null[i], by_column[i]);
  }
  arena_forget(arena, before);
  return e.rank;
}

/* M is singular on the kernel of A where K = M + A^T W A is singular, for a generic positive diagonal W, after
 * equilibration. */
int sparse_is_regular_on_kernel(Arena *arena, uint32_t n, uint32_t m, const SparseElements *a, long double *null) {
  ArenaMark before = arena_mark(arena);
  uint32_t w = n + m;
  int *row = ARENA_ARRAY(arena, int, w + 1), *column = ARENA_ARRAY(arena, int, w + 1);
  SparseElements finite = {0}, K = {0};
  for (uint32_t k = 0; k < a->n; k++)
    if (isfinite(a->at[k].value)) vec_push(arena, &finite, a->at[k]);
  Matrix x = matrix_of(arena, w, &finite);
  equilibrate(arena, &x, row, column);
  for (uint32_t k = 0; k < x.from[w]; k++)
    x.at[k].value = ldexpl(x.at[k].value, row[x.at[k].row] + column[x.at[k].col]);
  for (uint32_t k = 0; k < x.from[n]; k++)
    if (x.at[k].col < n) sparse_put(arena, &K, x.at[k].row, x.at[k].col, x.at[k].value);
  for (uint32_t c = n; c < w; c++) { /* row A of a constraint, rescaled, gives its column -A^T */
    long double weight = 0.5L + fmodl(0.618033988749894848L * (c - n + 1), 1);
    for (uint32_t i = x.from[c]; i < x.from[c + 1]; i++)
      for (uint32_t j = x.from[c]; j < x.from[c + 1]; j++) {
        int back = row[x.at[i].col] + column[c] - row[c] - column[x.at[i].col];
        sparse_put(arena, &K, x.at[i].col, x.at[j].col, ldexpl(x.at[i].value, back) * x.at[j].value * weight);
      }
  }
  int regular = sparse_solve(arena, n, &K, NULL, 1e-13L, null) == n;
  arena_forget(arena, before);
  return regular;
}
