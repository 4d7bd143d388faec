/* Evaluation of the graph in long double, for checks; simulations run emitted C. */
#pragma once

#include "sym/expr.h"

/* out[i] = value of roots[i], with symbols[s] the value of symbol s. True is 1, false is 0. */
void expr_eval(ExprGraph *g, const Expr *roots, uint32_t n, const long double *symbols, long double *out);

/* Evaluation tape: roots compiled once for many states; running the tape allocates nothing and does not touch the
 * graph. */
typedef struct EvalTape EvalTape;
EvalTape *eval_tape(ExprGraph *g, const Expr *roots, uint32_t n);
void eval_tape_free(ExprGraph *g, EvalTape *t); /* gives up its memory */
void eval_run(EvalTape *t, const long double *symbols, long double *out);

/* eval_run with every value rounded to double, so that an overflow of doubles gives infinity; symbol(s, data) gives
 * the symbols. */
void eval_run_double(EvalTape *t, long double (*symbol)(SymId s, const void *data), const void *data, long double *out);
