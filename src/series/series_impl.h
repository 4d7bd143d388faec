/* Shared by series.c (the two programs, the linear system), series_recurrences.c (a recurrence for each operation)
 * and series_columns.c (columns of sums and constants). */
#pragma once

#include "series/series.h"

typedef uint32_t Val; /* index of a value; 0: the structural zero */

/* A value along the motion. */
typedef struct {
  Slot zero;      /* coefficient 0, in `first` */
  Slot coef;      /* coefficient k, in `next`; 0 while it is not known */
  int varies;     /* 0: constant in time, all coefficients but the first are 0 */
  Slot factor;    /* != 0: the value is factor * base, the factor (in `first`) constant in time, */
  Val base;       /* so that its sums are multiples of sums over the base */
  Val theta;      /* its t d/dt, with coefficients k x[k]; 0: not made yet */
  Val sine, cosine, sinh, cosh; /* its functions; 0: not made yet */
  uint32_t pairs; /* head of its list of pairs, + 1 */
} Value;

/* The convolution sum of a[j] b[k-j], 0 < j < k; pairs with the same a are a list. */
typedef struct {
  Val a, b;
  uint32_t before; /* previous pair of the list, + 1 */
} Pair;

typedef struct {
  Arena *arena;
  Prog *first, *next;
  VEC(Value) values;
  VEC(Pair) pairs;
  VEC(Slot) constants;       /* c: slots in `first` */
  VEC(uint32_t) constant_at; /* by slot of `first`: index in c + 1 */
  VEC(uint32_t) columns;     /* by column: the pair whose sum it holds; UINT32_MAX: padding. See series_columns */
  const char *why;           /* the first function or word that is not analytic; NULL: none */
} SeriesBuilder;

/* A value with coefficients 0 and k; coef == 0: constant in time. */
Val series_value(SeriesBuilder *m, Slot zero, Slot coef);
/* A value whose coefficient k is set later, by series_set, since it needs sums over the value's own lower
 * coefficients. */
Val series_open(SeriesBuilder *m, Slot zero);
void series_set(SeriesBuilder *m, Val v, Slot coef);

/* Slot of `next` for a slot of `first`: a number, or a load of c. */
Slot series_constant(SeriesBuilder *m, Slot s);

/* In `next`: coefficient 0 of a; the sum over the pair (a, b); coefficient k of the product a b. */
Slot series_zero(SeriesBuilder *m, Val a);
Slot series_sum(SeriesBuilder *m, Val a, Val b);
Slot series_product(SeriesBuilder *m, Val a, Val b);

/* Instructions of `next`. */
Slot series_op(SeriesBuilder *m, IrOp op, Slot a, Slot b);
/* x / k, and x divided by a slot of `first`. */
Slot series_per_order(SeriesBuilder *m, Slot x);
Slot series_over(SeriesBuilder *m, Slot x, Slot divisor);
Slot series_order(SeriesBuilder *m);

/* The value t d/dt v. */
Val series_theta(SeriesBuilder *m, Val v);

/* The value of an instruction of the program, by its recurrence; v, w, x: values of its operands, zero: its slot in
 * `first`. 0 when it is not analytic, with m->why set. */
Val series_instruction(SeriesBuilder *m, const Ins *i, Slot zero, Val v, Val w, Val x);

/* Assigns columns to the sums, and places to the constants, that the stores of `next` need; stores the factors a[k],
 * b[k] and the constants. */
void series_columns(SeriesBuilder *m, Series *s);
