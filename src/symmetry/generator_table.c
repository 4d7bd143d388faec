/* Generators as functions of time from x' = A x: polynomials of t from the generalised kernel of A, oscillations and
 * exponentials from that of A^2
 * - rate2, rates from the minimal polynomial of A^2; where L contains t, a fit to listed functions. */
#include "symmetry/generator_table.h"

#include <complex.h>
#include <math.h>

#include "base/dense_matrix.h"
#include "sym/diff.h"

static void multiply(uint32_t n, const long double *a, const long double *b, long double *to) {
  memset(to, 0, (size_t)n * n * sizeof *to);
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < n; k++)
      for (size_t j = 0; a[i * n + k] != 0 && j < n; j++) to[i * n + j] += a[i * n + k] * b[k * n + j];
}

/* to = A x */
static void apply(uint32_t n, const long double *A, const long double *x, long double *to) {
  for (size_t i = 0; i < n; i++) {
    to[i] = 0;
    for (size_t k = 0; k < n; k++) to[i] += A[i * n + k] * x[k];
  }
}

/* Sets to 0 the elements that are rounding, for a matrix made from numbers of this size. */
static void clear_rounding(long double *m, size_t n, long double size) {
  for (size_t i = 0; i < n; i++)
    if (fabsl(m[i]) < 1e-12L * size) m[i] = 0;
}

static long double size_of(const SolutionSpace *s) {
  return fmaxl(dense_largest(s->A, (size_t)s->space.n * s->space.n), 1e-3L) * (long double)(s->space.n + 1);
}

/* Orthonormal basis of the x with m^k x = 0 for some k up to `most`: the kernel of m[n*n], then the x that m maps
 * into it, and so on. *depth: the k needed. */
static DenseRows generalised_kernel(Arena *a, uint32_t n, const long double *m, uint32_t most, uint32_t *depth) {
  DenseRows x = {.width = n, .at = ARENA_ARRAY(a, long double, (size_t)n * n + 1)};
  for (*depth = 0; *depth < most; ++*depth) {
    uint32_t w = n + x.n, before = x.n;
    long double *both = ARENA_ARRAY(a, long double, (size_t)n * w + 1);
    for (size_t i = 0; i < n; i++) {
      for (size_t j = 0; j < n; j++) both[i * w + j] = m[i * n + j];
      for (size_t k = 0; k < x.n; k++) both[i * w + n + k] = x.at[k * n + i];
    }
    DenseRows kernel = dense_kernel(a, n, w, both, 1e-8L), next = dense_orthonormal(a, &kernel, n);
    if (next.n == before) break;
    x = next;
  }
  return x;
}

/* The x whose solutions are polynomials of time. */
static DenseRows polynomials(Arena *a, const SolutionSpace *s) {
  uint32_t n = s->space.n, depth;
  long double *m = ARENA_ARRAY(a, long double, (size_t)n * n + 1);
  memcpy(m, s->A, (size_t)n * n * sizeof *m);
  clear_rounding(m, (size_t)n * n, size_of(s));
  return generalised_kernel(a, n, m, TIME_BLOCKS_MOST, &depth);
}

/* Adds `factor` times the part of solution x in tau and xi to a block of a row. */
static void add_solution(const SolutionSpace *s, const long double *x, long double factor, uint32_t shown,
                         long double *block) {
  for (size_t k = 0; k < s->space.n; k++)
    for (size_t j = 0; x[k] != 0 && j < shown; j++) block[j] += factor * x[k] * s->space.at[k * s->space.width + j];
}

static GeneratorTable table_new(Arena *a, uint32_t rows, uint32_t blocks, uint32_t shown) {
  size_t size = (size_t)rows * blocks * shown;
  return (GeneratorTable){rows, blocks, shown, ARENA_ARRAY(a, long double, size), ARENA_ARRAY(a, uint32_t, rows)};
}

int table_same_shape(const GeneratorTable *a, const GeneratorTable *b) {
  return a->rows == b->rows && a->shown == b->shown &&
         (!a->rows || memcmp(a->pivot, b->pivot, a->rows * sizeof *a->pivot) == 0);
}

static void reduce(GeneratorTable *t) {
  uint32_t width = t->blocks * t->shown;
  long double size = dense_largest(t->at, (size_t)t->rows * width);
  t->rows = dense_echelon(t->rows, width, t->at, 1e-9L * size, t->pivot);
}

GeneratorTable table_powers(Arena *a, const SolutionSpace *s, uint32_t shown) {
  uint32_t n = s->space.n, width = TIME_BLOCKS_MOST * shown;
  DenseRows x = polynomials(a, s);
  GeneratorTable t = table_new(a, x.n, TIME_BLOCKS_MOST, shown);
  long double *at = ARENA_ARRAY(a, long double, n + 1), *next = ARENA_ARRAY(a, long double, n + 1), size = size_of(s);
  for (uint32_t r = 0; r < x.n; r++) {
    long double factor = 1;
    memcpy(at, x.at + (size_t)r * n, n * sizeof *at);
    for (uint32_t m = 0; m < TIME_BLOCKS_MOST; m++) {
      add_solution(s, at, factor, shown, t.at + (size_t)r * width + (size_t)m * shown);
      apply(n, s->A, at, next);
      clear_rounding(next, n, dense_largest(at, n) * size);
      memcpy(at, next, n * sizeof *at);
      factor /= m + 1;
    }
  }
  reduce(&t);
  return t;
}

/* A = S + N with S^2 = rate2, where m = A^2 - rate2 has m^3 = 0: S = A (1 + m/rate2)^(-1/2), by its series. */
typedef struct {
  uint32_t n;
  long double *S, *N;
} Parts;

static Parts parts_of(Arena *a, const SolutionSpace *s, const long double *m, long double rate2) {
  uint32_t n = s->space.n;
  size_t size = (size_t)n * n;
  Parts p = {n, ARENA_ARRAY(a, long double, size + 1), ARENA_ARRAY(a, long double, size + 1)};
  long double *square = ARENA_ARRAY(a, long double, size + 1), *factor = ARENA_ARRAY(a, long double, size + 1);
  multiply(n, m, m, square);
  for (size_t i = 0; i < size; i++) factor[i] = m[i] / (2 * rate2) - 3 * square[i] / (8 * rate2 * rate2);
  multiply(n, s->A, factor, p.N);
  clear_rounding(p.N, size, size_of(s));
  for (size_t i = 0; i < size; i++) p.S[i] = s->A[i] - p.N[i];
  return p;
}

/* The blocks of t^k exp(S t) in exp(A t) x = exp(S t) (1 + N t + ..) x. */
static void show_periodic(const SolutionSpace *s, const Parts *p, const long double *x, long double *next,
                          long double rate2, uint32_t shown, long double *block) {
  long double rate = sqrtl(fabsl(rate2)), *second = block + shown;
  apply(p->n, p->S, x, next);
  if (rate2 < 0) {
    add_solution(s, x, 1, shown, block);
    add_solution(s, next, 1 / rate, shown, second);
    return;
  }
  add_solution(s, x, 0.5L, shown, block);
  add_solution(s, next, 0.5L / rate, shown, block);
  add_solution(s, x, 0.5L, shown, second);
  add_solution(s, next, -0.5L / rate, shown, second);
}

GeneratorTable table_periodic(Arena *a, const SolutionSpace *s, uint32_t shown, long double rate2) {
  uint32_t n = s->space.n, depth;
  long double *m = ARENA_ARRAY(a, long double, (size_t)n *n + 1), *next = ARENA_ARRAY(a, long double, n + 1),
              *at = ARENA_ARRAY(a, long double, n + 1);
  multiply(n, s->A, s->A, m);
  for (size_t i = 0; i < n; i++) m[i * n + i] -= rate2;
  clear_rounding(m, (size_t)n * n, size_of(s) * size_of(s));
  DenseRows x = generalised_kernel(a, n, m, TIME_BLOCKS_MOST / 2, &depth);
  Parts p = parts_of(a, s, m, rate2);
  GeneratorTable t = table_new(a, x.n, 2 * (depth ? depth : 1), shown);
  for (uint32_t r = 0; r < x.n; r++) {
    memcpy(at, x.at + (size_t)r * n, n * sizeof *at);
    for (uint32_t k = 0; k < depth; k++) {
      show_periodic(s, &p, at, next, rate2, shown, t.at + ((size_t)r * t.blocks + 2 * k) * shown);
      apply(n, p.N, at, next);
      for (uint32_t i = 0; i < n; i++) at[i] = next[i] / (k + 1);
    }
  }
  reduce(&t);
  return t;
}

/* --- rates --- */

/* All roots of the monic polynomial sum of c[k] x^k (c[n] = 1) at once. Weierstrass 1891, Durand 1960, Kerner 1966. */
static void roots_of(uint32_t n, const long double *c, complex long double *root) {
  long double radius = 0;
  for (uint32_t k = 0; k < n; k++) radius = fmaxl(radius, powl(fabsl(c[k]), 1.0L / (n - k)));
  for (uint32_t k = 0; k < n; k++)
    root[k] = 1.2L * radius * cexpl((long double)(6.3 * k / n + 0.4) * (complex long double)I);
  for (int turn = 0; turn < 500; turn++)
    for (uint32_t k = 0; k < n; k++) {
      complex long double value = 1, others = 1;
      for (uint32_t j = n; j-- > 0;) value = value * root[k] + c[j];
      for (uint32_t j = 0; j < n; j++)
        if (j != k) others *= root[k] - root[j];
      if (others != 0) root[k] -= value / others;
    }
}

/* A on the space modulo polynomial solutions, where it is regular: C A C^T, C orthonormal and orthogonal to them. */
static SolutionSpace without_polynomials(Arena *a, const SolutionSpace *s) {
  uint32_t n = s->space.n;
  DenseRows x = polynomials(a, s), all = {x.n + n, n, ARENA_ARRAY(a, long double, (size_t)(x.n + n) * n + 1), 0};
  memcpy(all.at, x.at, (size_t)x.n * n * sizeof *all.at);
  for (size_t i = 0; i < n; i++) all.at[(x.n + i) * n + i] = 1;
  all = dense_orthonormal(a, &all, n);
  SolutionSpace rest = {.space = {.n = n - x.n, .width = n, .at = all.at + (size_t)x.n * n}};
  long double *moved = ARENA_ARRAY(a, long double, n + 1);
  rest.A = ARENA_ARRAY(a, long double, (size_t)rest.space.n * rest.space.n + 1);
  for (size_t j = 0; j < rest.space.n; j++) {
    apply(n, s->A, rest.space.at + j * n, moved);
    for (size_t i = 0; i < rest.space.n; i++)
      for (size_t k = 0; k < n; k++) rest.A[i * rest.space.n + j] += rest.space.at[i * n + k] * moved[k];
  }
  return rest;
}

/* Minimal polynomial of A^2 from its powers on one vector; A. N. Krylov 1931. 0: its degree exceeds `most`. */
static uint32_t minimal_polynomial(Arena *a, const SolutionSpace *s, uint32_t most, long double *c) {
  uint32_t n = s->space.n, count = n < most ? n : most;
  long double *x = ARENA_ARRAY(a, long double, n + 1), *y = ARENA_ARRAY(a, long double, n + 1);
  long double *krylov = ARENA_ARRAY(a, long double, (size_t)n *(most + 1) + 1),
              *copy = ARENA_ARRAY(a, long double, (size_t)n *(most + 1) + 1);
  for (uint32_t i = 0; i < n; i++) x[i] = sinl(1.0L + 17.0L * i);
  for (uint32_t m = 0; m <= count; m++) {
    for (uint32_t i = 0; i < n; i++) krylov[(size_t)i * (most + 1) + m] = x[i];
    for (uint32_t i = 0; i < n; i++)
      memcpy(copy + (size_t)i * (m + 1), krylov + (size_t)i * (most + 1), (m + 1) * sizeof *copy);
    DenseRows null = dense_kernel(a, n, m + 1, copy, 1e-10L);
    if (null.n) {
      for (uint32_t k = 0; k <= m; k++) c[k] = null.at[k] / null.at[m];
      return m;
    }
    apply(n, s->A, x, y);
    apply(n, s->A, y, x);
  }
  return 0;
}

/* Moves the roots that equal root k up to the rounding of a double root to the places behind it. Returns their
 * number, with root k. */
static uint32_t gather_close_roots(uint32_t n, complex long double *root, uint32_t k) {
  const long double apart = 3e-8L;
  uint32_t count = 1;
  for (uint32_t i = k + 1; i < n; i++) {
    complex long double x = root[i];
    if (!(cabsl(x - root[k]) < apart * cabsl(x))) continue;
    root[i] = root[k + count];
    root[k + count++] = x;
  }
  return count;
}

/* Refines a root of multiplicity `count`, a simple root of the derivative of order count - 1, by Newton's method. */
static complex long double multiple_root(uint32_t n, const long double *c, uint32_t count, complex long double x) {
  enum { TURNS = 3 };
  for (int turn = 0; turn < TURNS; turn++) {
    complex long double value = 0, slope = 0;
    for (uint32_t k = n + 1; k-- > count - 1;) {
      long double factor = c[k];
      for (uint32_t j = 0; j < count - 1; j++) factor *= k - j;
      slope = slope * x + value;
      value = value * x + factor;
    }
    if (slope != 0) x -= value / slope;
  }
  return x;
}

Rates space_rates(Arena *a, const SolutionSpace *s) {
  enum { MOST = 10 };
  long double c[MOST + 1];
  complex long double root[MOST];
  SolutionSpace rest = without_polynomials(a, s);
  uint32_t m = rest.space.n ? minimal_polynomial(a, &rest, MOST, c) : 0;
  Rates r = {.at = ARENA_ARRAY(a, long double, MOST)};
  if (m) roots_of(m, c, root);
  for (uint32_t k = 0; k < m;) {
    uint32_t count = gather_close_roots(m, root, k);
    root[k] = multiple_root(m, c, count, root[k]);
    if (fabsl(cimagl(root[k])) < 1e-8L * cabsl(root[k])) r.at[r.n++] = creall(root[k]);
    else r.others += count;
    k += count;
  }
  return r;
}

/* --- functions of time that are listed --- */

GeneratorTable table_listed(Arena *a, const Ansatz *s, const TimeList *times, const long double *parameters,
                            int *sure) {
  enum { SPARE_ROWS = 16 };
  ExprGraph *g = s->e->g;
  SymId t = s->e->m->time;
  uint32_t first = s->shown + 1, gauge = s->columns - first, nT = times->ngauge,
           width = times->n * s->shown + nT * gauge, rows = width + SPARE_ROWS;
  uint32_t more = s->held.n ? times->n * s->shown + SPARE_ROWS : 0;
  *sure = 0;
  double elements = (double)(rows + more) * width;
  if (!search_fits(s->limit, elements) || !search_goes_on(s->limit, 2 * width * elements)) return (GeneratorTable){0};
  Expr *roots = ARENA_ARRAY(a, Expr, 2 * (size_t)nT);
  long double *value = ARENA_ARRAY(a, long double, 2 * (size_t)nT),
              *symbols = ARENA_ARRAY(a, long double, expr_symbol_count(g) + 1);
  long double *b0 = ARENA_ARRAY(a, long double, s->columns), *b1 = ARENA_ARRAY(a, long double, s->columns);
  long double *m = ARENA_ARRAY(a, long double, (size_t)(rows + more) * width);
  for (uint32_t k = 0; k < nT; k++) roots[k] = times->f[k], roots[nT + k] = expr_diff(g, times->f[k], t);
  memcpy(symbols, parameters, s->symbols * sizeof *symbols);
  RowSource *source = rows_new(s, a, parameters);
  EvalTape *tape = eval_tape(g, roots, 2 * nT);
  for (size_t i = 0; i < rows + more; i++) {
    long double *row = m + i * width;
    RowKind kind = i < rows ? ROWS_DIFFERENCE : ROWS_CONSTRAINTS;
    if (!search_goes_on(s->limit, 0) || !rows_at_time(source, kind, b0, b1, &symbols[t])) return (GeneratorTable){0};
    eval_run(tape, symbols, value);
    for (uint32_t k = 0; k < nT; k++) {
      for (uint32_t j = 0; k < times->n && j < s->shown; j++)
        row[k * s->shown + j] = b0[j] * value[k] + b1[j] * value[nT + k];
      for (uint32_t j = 0; j < gauge; j++)
        row[times->n * s->shown + k * gauge + j] = b0[first + j] * value[k] + b1[first + j] * value[nT + k];
    }
  }
  DenseRows kernel = dense_kernel(a, rows + more, width, m, 1e-12L);
  GeneratorTable to = table_new(a, kernel.n, times->n, s->shown);
  for (size_t k = 0; k < kernel.n; k++)
    memcpy(to.at + k * times->n * s->shown, kernel.at + k * width, times->n * s->shown * sizeof *to.at);
  *sure = kernel.gap > 1e3L;
  reduce(&to);
  return to;
}
