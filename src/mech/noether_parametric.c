#include "mech/noether_parametric.h"

#include <math.h>

#include "mech/noether_fraction.h"

enum { PARAMETERS_MOST = 4, UNKNOWNS_MOST = 400 };

typedef long double Real;

typedef struct {
  Arena *arena;
  const Choices *choices;
  const Table *at;
  uint32_t count, width;
  uint32_t ncolumns, *column;  /* those in use */
  Expr mu[PARAMETERS_MOST + 1]; /* what rows of numbers are multiplied by */
  uint32_t nmu;
  ParametricRows out;
} Fit;

static Real entry(const Fit *f, uint32_t choice, uint32_t row, uint32_t column) { return f->at[choice].at[(size_t)row * f->width + column]; }

/* The row of the pivot; UINT32_MAX: the column has none. */
static uint32_t row_of_pivot(const Fit *f, uint32_t column) {
  for (uint32_t r = 0; r < f->at[0].rows; r++)
    if (f->at[0].pivot[r] == column) return r;
  return UINT32_MAX;
}

/* Columns that are not zero at all choices, less those that are to be left out. */
static void take_columns(Fit *f, const unsigned char *left_out) {
  f->ncolumns = 0;
  for (uint32_t k = 0; k < f->width; k++) {
    int used = 0;
    for (uint32_t c = 0; c < f->count; c++)
      for (uint32_t r = 0; r < f->at[0].rows; r++) used |= entry(f, c, r, k) != 0;
    if (used && !left_out[k]) f->column[f->ncolumns++] = k;
  }
}

/* sum of mu_j A_j lies in the space of each table: its entry in a column without a pivot is what its entries at pivots make there. */
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

/* A row of numbers as coefficients; 0: its fractions are not recognised. */
static int recognise(Fit *f, const Real *x) {
  ExprGraph *g = f->choices->e->g;
  ParametricRow row = {ARENA_ARRAY(f->arena, Expr, f->width), ARENA_ARRAY(f->arena, Real, f->width)};
  int64_t q = common_denominator(x, f->nmu * f->ncolumns);
  if (!q) return 0;
  for (uint32_t k = 0; k < f->width; k++) row.c[k] = expr_int(g, 0);
  for (uint32_t j = 0; j < f->nmu; j++)
    for (uint32_t k = 0; k < f->ncolumns; k++) {
      Num number = num_ratio((int64_t)roundl(x[(size_t)j * f->ncolumns + k] * (Real)q), q);
      Expr part = expr_scale(g, number, f->mu[j]);
      row.c[f->column[k]] = expr_add(g, row.c[f->column[k]], part);
      row.value[f->column[k]] += (Real)num_value(number) * choice_value(f->choices, CHOICE_FIRST, f->mu[j]);
    }
  f->out.at[f->out.n++] = row;
  return 1;
}

/* All rows for this choice of mu; marks the columns of their pivots. */
static void fit(Fit *f, unsigned char *pivots) {
  uint32_t unknowns = f->nmu * f->ncolumns;
  if (!unknowns || unknowns > UNKNOWNS_MOST) return;
  DenseRows kernel = kernel_of(f);
  uint32_t *pivot = ARENA_ARRAY(f->arena, uint32_t, kernel.n + 1);
  if (kernel.gap < 1e2L) return;
  uint32_t rows = dense_echelon(kernel.n, unknowns, kernel.at, 1e-10L, pivot);
  for (uint32_t r = 0; r < rows && f->out.n < f->at[0].rows * 4; r++) {
    recognise(f, kernel.at + (size_t)r * unknowns);
    if (f->nmu == 1) pivots[f->column[pivot[r]]] = 1;
  }
}

ParametricRows parametric_rows(Arena *a, const Choices *choices, const Table *at, uint32_t count) {
  ExprGraph *g = choices->e->g;
  Fit f = {.arena = a, .choices = choices, .at = at, .count = count, .width = at[0].blocks * at[0].shown, .nmu = 1};
  unsigned char *pivots = ARENA_ARRAY(a, unsigned char, f.width + 1);
  f.column = ARENA_ARRAY(a, uint32_t, f.width + 1);
  f.out.at = ARENA_ARRAY(a, ParametricRow, 4 * (size_t)at[0].rows + 1);
  f.mu[0] = expr_int(g, 1);
  take_columns(&f, pivots);
  fit(&f, pivots);
  if (choices->n < 2 || choices->n > PARAMETERS_MOST) return f.out;
  for (f.nmu = 0; f.nmu < choices->n; f.nmu++) f.mu[f.nmu] = expr_symbol(g, choices->param[f.nmu])->node;
  take_columns(&f, pivots);
  fit(&f, pivots);
  return f.out;
}
