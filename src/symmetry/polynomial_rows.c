/* Fits rows sum of mu_j A_j with known factors mu (1, or the parameters) and unknown numbers A_j: the row lies in the space of every table, which
 * is a linear system; its kernel, times common denominators, gives the A_j. */
#include "symmetry/polynomial_rows.h"

#include <math.h>

#include "symmetry/lattice_reduction.h"

enum { PARAMETERS_MOST = 4, UNKNOWNS_MOST = 400 };

typedef long double Real;

typedef struct {
  Arena *arena;
  const Choices *choices;
  const GeneratorTable *at;
  uint32_t count, width;
  uint32_t ncolumns, *column;  /* columns in use */
  Expr mu[PARAMETERS_MOST + 1]; /* factors of the rows of numbers */
  uint32_t nmu;
  PolynomialRows out;
  uint32_t most;                /* capacity of out */
} Fit;

static Real entry(const Fit *f, uint32_t choice, uint32_t row, uint32_t column) { return f->at[choice].at[(size_t)row * f->width + column]; }

/* Row whose pivot stands in a column; UINT32_MAX: there is none. */
static uint32_t row_of_pivot(const Fit *f, uint32_t column) {
  for (uint32_t r = 0; r < f->at[0].rows; r++)
    if (f->at[0].pivot[r] == column) return r;
  return UINT32_MAX;
}

/* Lists the columns that are nonzero at some choice. */
static void list_used_columns(Fit *f) {
  f->ncolumns = 0;
  for (uint32_t k = 0; k < f->width; k++) {
    int used = 0;
    for (uint32_t c = 0; c < f->count; c++)
      for (uint32_t r = 0; r < f->at[0].rows; r++) used |= entry(f, c, r, k) != 0;
    if (used) f->column[f->ncolumns++] = k;
  }
}

/* Adds the condition that sum of mu_j A_j lies in a table's space: its entry in a column without a pivot is the combination of rows that its
 * entries at the pivots give. */
static void put_equation(const Fit *f, uint32_t choice, uint32_t column, Real *row) {
  for (uint32_t j = 0; j < f->nmu; j++) {
    Real mu = choice_value(f->choices, choice, f->mu[j]), *at = row + (size_t)j * f->ncolumns;
    for (uint32_t k = 0; k < f->ncolumns; k++) {
      uint32_t r = row_of_pivot(f, f->column[k]);
      if (f->column[k] == column) at[k] += mu;
      else if (r != UINT32_MAX) at[k] -= mu * entry(f, choice, r, column);
    }
  }
}

static DenseRows kernel_of(Fit *f) {
  uint32_t unknowns = f->nmu * f->ncolumns, rows = 0;
  Real *m = ARENA_ARRAY(f->arena, Real, (size_t)f->count * f->width * unknowns + 1);
  for (uint32_t c = 0; c < f->count; c++)
    for (uint32_t k = 0; k < f->width; k++)
      if (row_of_pivot(f, k) == UINT32_MAX) put_equation(f, c, k, m + (size_t)rows++ * unknowns);
  return dense_kernel(f->arena, rows, unknowns, m, 1e-9L);
}

/* Adds a row of whole numbers to the results, as coefficients and values. */
static void add_row(Fit *f, const int64_t *x) {
  ExprGraph *g = f->choices->e->g;
  if (f->out.n == f->most) return;
  PolynomialRow row = {ARENA_ARRAY(f->arena, Expr, f->width), ARENA_ARRAY(f->arena, Real, f->width)};
  for (uint32_t k = 0; k < f->width; k++) row.c[k] = expr_int(g, 0);
  for (uint32_t j = 0; j < f->nmu; j++)
    for (uint32_t k = 0; k < f->ncolumns; k++) {
      int64_t number = x[(size_t)j * f->ncolumns + k];
      uint32_t column = f->column[k];
      Expr part = expr_scale(g, num_int(number), f->mu[j]);
      row.c[column] = expr_add(g, row.c[column], part);
      row.value[column] += (Real)number * choice_value(f->choices, CHOICE_FIRST, f->mu[j]);
    }
  f->out.at[f->out.n++] = row;
}

/* x times the common denominator of its entries; 0: there is none. */
static int whole_row(const Fit *f, const Real *x, int64_t *whole) {
  uint32_t n = f->nmu * f->ncolumns;
  int64_t q = common_denominator(f->arena, x, n);
  for (uint32_t k = 0; k < n; k++) whole[k] = (int64_t)roundl(x[k] * (Real)q);
  return q != 0;
}

/* Adds all rows for these factors mu. */
static void fit_rows(Fit *f) {
  uint32_t unknowns = f->nmu * f->ncolumns;
  if (!unknowns || unknowns > UNKNOWNS_MOST) return;
  DenseRows kernel = kernel_of(f);
  uint32_t *pivot = ARENA_ARRAY(f->arena, uint32_t, kernel.n + 1);
  int64_t *whole = ARENA_ARRAY(f->arena, int64_t, unknowns + 1);
  if (kernel.gap < 1e2L) return;
  uint32_t rows = dense_echelon(kernel.n, unknowns, kernel.at, 1e-10L, pivot);
  for (uint32_t r = 0; r < rows; r++)
    if (whole_row(f, kernel.at + (size_t)r * unknowns, whole)) add_row(f, whole);
}

/* Begins with mu = 1, for rows free of parameters. */
static Fit begin(Arena *a, const Choices *choices, const GeneratorTable *at, uint32_t count) {
  Fit f = {.arena = a, .choices = choices, .at = at, .count = count, .width = at[0].blocks * at[0].shown, .nmu = 1};
  f.column = ARENA_ARRAY(a, uint32_t, f.width + 1);
  f.mu[0] = expr_int(choices->e->g, 1);
  list_used_columns(&f);
  return f;
}

DenseRows polynomial_common_rows(Arena *a, const Choices *choices, const GeneratorTable *at, uint32_t count) {
  Fit f = begin(a, choices, at, count);
  DenseRows all = {.width = f.width};
  if (!f.ncolumns || f.ncolumns > UNKNOWNS_MOST) return all;
  DenseRows kernel = kernel_of(&f);
  all.at = ARENA_ARRAY(a, Real, (size_t)kernel.n * f.width + 1);
  for (all.n = 0; kernel.gap >= 1e2L && all.n < kernel.n; all.n++)
    for (uint32_t k = 0; k < f.ncolumns; k++) all.at[(size_t)all.n * f.width + f.column[k]] = kernel.at[(size_t)all.n * f.ncolumns + k];
  return all;
}

PolynomialRows polynomial_rows(Arena *a, const Choices *choices, const GeneratorTable *at, uint32_t count) {
  ExprGraph *g = choices->e->g;
  Fit f = begin(a, choices, at, count);
  f.most = 4 * (1 + PARAMETERS_MOST) * at[0].rows;
  f.out.at = ARENA_ARRAY(a, PolynomialRow, (size_t)f.most + 1);
  fit_rows(&f);
  if (choices->n < 2 || choices->n > PARAMETERS_MOST) return f.out;
  for (f.nmu = 0; f.nmu < choices->n; f.nmu++) f.mu[f.nmu] = expr_symbol(g, choices->param[f.nmu])->node;
  fit_rows(&f);
  return f.out;
}
