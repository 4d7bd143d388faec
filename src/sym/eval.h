/* Evaluation of the graph in extended precision, for checks; simulations run emitted C. */
#ifndef LAGC_EVAL_H
#define LAGC_EVAL_H

#include "sym/expr.h"

/* out[i] = value of roots[i], with symbols[s] the value of symbol s. Truth is 1 and 0. */
void expr_eval(ExprGraph *g, const Expr *roots, uint32_t n, const long double *symbols, long double *out);

#endif
