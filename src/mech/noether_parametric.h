/* Generators whose coefficients are polynomials of parameters, from tables at several choices of these: what does not depend on parameters
 * is common to all tables, and what is linear in them is a combination of few rows of numbers that fits them all. Where the rows of a
 * table in echelon form are quotients of such polynomials, which nobody would recognise. */
#ifndef LAGC_NOETHER_PARAMETRIC_H
#define LAGC_NOETHER_PARAMETRIC_H

#include "mech/noether_number.h"
#include "mech/noether_table.h"

typedef struct {
  Expr *c;             /* [blocks*shown] */
  long double *value;  /* the same at the first choice */
} ParametricRow;

typedef struct {
  uint32_t n;
  ParametricRow *at;
} ParametricRows;

/* at[count]: tables of one shape at the first `count` choices. Rows free of parameters come first, those that are linear in all of them behind;
 * rows that are not recognised as whole numbers are left out. They need not be symmetries: that is for noether_prove to say. */
ParametricRows parametric_rows(Arena *a, const Choices *choices, const Table *at, uint32_t count);

/* The rows that are common to all these tables. */
DenseRows parametric_common(Arena *a, const Choices *choices, const Table *at, uint32_t count);

#endif
