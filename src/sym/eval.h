/* Evaluation of the graph in extended precision, for checks; simulations run emitted C. */
#ifndef LAGC_EVAL_H
#define LAGC_EVAL_H

#include "sym/expr.h"

/* out[i] = value of roots[i], with symbols[s] the value of symbol s. Truth is 1 and 0. */
void expr_eval(ExprGraph *g, const Expr *roots, uint32_t n, const long double *symbols, long double *out);

/* Roots laid out once, to be evaluated at many states: no allocation, and no look at the graph. */
typedef struct EvalTape EvalTape;
EvalTape *eval_tape(ExprGraph *g, const Expr *roots, uint32_t n);
void eval_run(EvalTape *t, const long double *symbols, long double *out);

/* eval_run with the range of doubles, and symbols as `symbol` gives them: what overflows there is infinite here. */
void eval_run_double(EvalTape *t, long double (*symbol)(SymId s, const void *data), const void *data, long double *out);

/* eval_run again when only the symbol `changed` has another value: computes what depends on it. */
void eval_rerun(EvalTape *t, const long double *symbols, SymId changed, long double *out);

#endif
