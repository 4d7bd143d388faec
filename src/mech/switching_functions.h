/* Switching functions of expressions: comparisons, `min`, `max`, `abs` and `sign` switch where such a function is 0. */
#ifndef LAGC_MECH_SWITCHING_FUNCTIONS_H
#define LAGC_MECH_SWITCHING_FUNCTIONS_H

#include "sym/expr.h"

/* The switching functions in the roots, each once, at most 24. */
typedef struct {
  const Expr *at;
  uint32_t n;
} SwitchingFunctions;
SwitchingFunctions switching_functions(ExprGraph *g, const Expr *roots, uint32_t n);

/* A line in the space of states: symbol `axis` is t; or, with axis 0, symbol s is base[s] + t*slope[s]. */
typedef struct {
  SymId axis;
  const long double *base, *slope;
  uint32_t count;
} SwitchLine;
void switch_line_set(SwitchLine line, long double t, long double *symbols);

/* Searches lines through `base`, |t| from 1e-12 to 1e12, for sign changes of the switching functions, to the last digit (exactly = 1), and for
 * minima of their absolute values (exactly = 0). Calls `try` for each, with t = where; returns 1 as soon as `try` does, else 0. free[nfree]:
 * the symbols that may vary. */
typedef int SwitchTry(void *data, long double *base, SwitchLine line, long double where, int exactly);
int switching_functions_search(ExprGraph *g, const SwitchingFunctions *all, const SymId *free, uint32_t nfree, long double *base, uint32_t seed, SwitchTry *try, void *data);

#endif
