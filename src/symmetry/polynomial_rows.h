/* Generators whose coefficients are polynomials of parameters, from tables at several choices of these: rows free of parameters are common to all
 * tables; rows linear in parameters combine a few rows of numbers that fit all tables. For tables whose echelon form has quotients of such
 * polynomials, which entry by entry nobody would recognise. */
#ifndef LAGC_SYMMETRY_POLYNOMIAL_ROWS_H
#define LAGC_SYMMETRY_POLYNOMIAL_ROWS_H

#include "symmetry/number_recognition.h"
#include "symmetry/generator_table.h"

typedef struct {
  Expr *c;             /* [blocks*shown] */
  long double *value;  /* c at the first choice */
} PolynomialRow;

typedef struct {
  uint32_t n;
  PolynomialRow *at;
} PolynomialRows;

/* at[count]: tables of one shape at the first `count` choices. Rows free of parameters come first, then those linear in all of them; rows that are
 * not whole numbers are left out. The rows are candidates: noether_prove decides whether they are symmetries. */
PolynomialRows polynomial_rows(Arena *a, const Choices *choices, const GeneratorTable *at, uint32_t count);

/* The rows that are common to all these tables. */
DenseRows polynomial_common_rows(Arena *a, const Choices *choices, const GeneratorTable *at, uint32_t count);

#endif
