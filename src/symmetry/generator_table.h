/* Tables of generators from the solution space: coefficients of known functions of time, in echelon form. Shared by
 * the files of the search. */
#pragma once

#include "symmetry/determining_equations.h"

/* How the coefficients of a family of generators depend on time. */
typedef enum { TIME_POWERS, TIME_CIRCULAR, TIME_EXPONENTIAL, TIME_LISTED } TimeKind;

enum { TIME_BLOCKS_MOST = 6 };

/* One row a generator, entry [m*shown + column]. Block m stands for t^m; or for cos wt, sin wt (exp st, exp -st),
 * then both times t, then t^2, where these occur; or for function m of a list, which begins with 1, t and t^2. */
typedef struct {
  uint32_t rows, blocks, shown;
  long double *at;  /* reduced echelon form */
  uint32_t *pivot;
} GeneratorTable;

/* Whether numbers of rows and pivots agree. */
int table_same_shape(const GeneratorTable *a, const GeneratorTable *b);

/* Generators that are polynomials of t. */
GeneratorTable table_powers(Arena *a, const SolutionSpace *s, uint32_t shown);

/* rate2 < 0: generators with frequency sqrt(-rate2); > 0: those that grow and fall with sqrt(rate2). */
GeneratorTable table_periodic(Arena *a, const SolutionSpace *s, uint32_t shown, long double rate2);

/* For an L that contains t or is of first order: coefficients are combinations of listed functions of time, those of
 * F of a longer list. *sure 0: the equations could not be solved reliably. */
typedef struct {
  uint32_t n, ngauge; /* the first n functions are for xi and tau */
  const Expr *f;      /* [ngauge] */
} TimeList;

GeneratorTable table_listed(Arena *a, const Ansatz *s, const TimeList *times, const long double *parameters, int *sure);

/* Squared rates of solutions that are real and not 0: eigenvalues of A^2. */
typedef struct {
  uint32_t n, others; /* others: number that are not real */
  long double *at;
} Rates;

Rates space_rates(Arena *a, const SolutionSpace *s);

/* The change row += factor*other that makes the row's entries `one` and `two` equal (sign 1) or opposite (-1). */
typedef struct {
  uint32_t row, other, one, two;
  int sign;
} RowChange;

enum { CHANGES_MOST = 3 };

/* Makes up to CHANGES_MOST changes that leave fewer distinct magnitudes in a row: formulas in books have few. The
 * rows span what they did, but the row gets entries at pivots of others. Returns the number of changes, in to[]. */
uint32_t table_shorten(Arena *a, GeneratorTable *t, uint32_t row, RowChange *to);

/* Makes a change that was found on another table of this shape. 0: it has no factor here. */
int table_change(Arena *a, GeneratorTable *t, RowChange c);
