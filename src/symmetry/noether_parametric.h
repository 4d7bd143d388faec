/* Generators whose coefficients are polynomials of parameters, from tables at several choices of these: rows free of parameters are common to all
 * tables; rows linear in parameters combine a few rows of numbers that fit all tables. For tables whose echelon form has quotients of such
 * polynomials, which entry by entry nobody would recognise. */
#ifndef LAGC_SYMMETRY_NOETHER_PARAMETRIC_H
#define LAGC_SYMMETRY_NOETHER_PARAMETRIC_H

#include "symmetry/noether_number.h"
#include "symmetry/noether_table.h"

typedef struct {
  Expr *c;             /* [blocks*shown] */
  long double *value;  /* c at the first choice */
} ParametricRow;

typedef struct {
  uint32_t n;
  ParametricRow *at;
} ParametricRows;

/* at[count]: tables of one shape at the first `count` choices. Rows free of parameters come first, then those linear in all of them; rows that are
 * not whole numbers are left out. The rows are candidates: noether_prove decides whether they are symmetries. */
ParametricRows parametric_rows(Arena *a, const Choices *choices, const Table *at, uint32_t count);

/* The rows that are common to all these tables. */
DenseRows parametric_common(Arena *a, const Choices *choices, const Table *at, uint32_t count);

#endif
