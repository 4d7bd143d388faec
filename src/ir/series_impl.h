/* Shared by series.c (the programs, the linear system) and series_fn.c (a recurrence for each operation). */
#ifndef LAGC_SERIES_IMPL_H
#define LAGC_SERIES_IMPL_H

#include "ir/series.h"

typedef uint32_t Val; /* index of a value; 0: the structural zero */

/* A value along the motion. */
typedef struct {
  Slot zero;      /* coefficient 0, in `first` */
  Slot coef;      /* coefficient k, in `next`; 0 while it is not known */
  int varies;     /* with time: else all coefficients but the first are 0 */
  Slot factor;    /* != 0: this is factor * base, the factor (in `first`) constant in time; */
  Val base;       /* so that products with it are products with the base */
  Val theta;      /* t d/dt of it: coefficients k x[k]; 0: not made yet */
  Val sine, cosine, sinh, cosh; /* of it; 0: not made yet */
  uint32_t pairs; /* the last of its sums + 1: see Pair */
} Value;

/* s[i] = sum of a[j] b[k-j], 0 < j < k; the pairs with one a are a list. */
typedef struct {
  Val a, b;
  uint32_t before; /* index + 1 */
} Pair;

typedef struct {
  Arena *arena;
  Prog *first, *next;
  VEC(Value) values;
  VEC(Pair) pairs;
  VEC(Slot) constants;       /* c: slots in `first` */
  VEC(uint32_t) constant_at; /* by slot of `first`: index in c + 1 */
  VEC(uint32_t) columns;     /* the pair whose sum stands in each column; UINT32_MAX: none. See series_place */
  const char *why;           /* the first thing that is not analytic */
} Maker;

/* A value with coefficients 0 and k; coef == 0: constant in time. */
Val series_value(Maker *m, Slot zero, Slot coef);
/* The same with its coefficient k still to come, which may need sums over the coefficients before: see series_set. */
Val series_open(Maker *m, Slot zero);
void series_set(Maker *m, Val v, Slot coef);

/* A slot of `first` as seen from `next`, where it is constant. */
Slot series_constant(Maker *m, Slot s);

/* In `next`: coefficient 0 of a; the sum over the pair (a, b); coefficient k of the product a b. */
Slot series_zero(Maker *m, Val a);
Slot series_sum(Maker *m, Val a, Val b);
Slot series_product(Maker *m, Val a, Val b);

/* Instructions of `next`. */
Slot series_op(Maker *m, IrOp op, Slot a, Slot b);
/* x / k, and x divided by a slot of `first`. */
Slot series_per_order(Maker *m, Slot x);
Slot series_over(Maker *m, Slot x, Slot divisor);
Slot series_order(Maker *m);

/* t d/dt of it. */
Val series_theta(Maker *m, Val v);

/* The value of an instruction of the program; v, w, x are those of its operands, zero its slot in `first`.
 * 0 when it is not analytic: m->why says what. */
Val series_instruction(Maker *m, const Ins *i, Slot zero, Val v, Val w, Val x);

/* Gives the sums and constants that the stores of `next` need their places, and stores what they are made of. */
void series_place(Maker *m, Series *s);

/* Gives sums and constants of long families an order in which loops read and write neighbours. */
void series_arrange(const Series *s, Prog *first, Prog *next);

#endif
