/* Derivatives of quantified sums (sym/sum_nest.h), for the sweeps of diff.c. */
#pragma once

#include "sym/expr.h"

/* Makes the nest of derivatives of the sums that a cell is one of, whose slopes are known; forward: for expr_sum_rates
 * alone, where there are several. 0: there would be too many. */
int expr_prepare_sum(ExprGraph *g, Expr cell, int forward);

typedef struct {
  uint32_t arg; /* index of the argument */
  Expr value;
} SumPartial;

typedef struct {
  const SumPartial *at;
  uint32_t n;
} SumPartials;

/* Partial derivatives of a cell by those arguments of its nest that a map has, where they are not 0 everywhere. */
SumPartials expr_sum_partials(ExprGraph *g, Expr cell, const ExprMap *live);

/* The nest of directional derivatives of the sums of a nest. rate[argument]: absent where it is 0. 0: all vanish. */
Expr expr_sum_rates(ExprGraph *g, Expr nest, const ExprMap *rate);
