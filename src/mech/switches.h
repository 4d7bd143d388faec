/* Places where an expression switches: comparisons, `min`, `max`, `abs` and `sign` change sides there. */
#ifndef LAGC_SWITCHES_H
#define LAGC_SWITCHES_H

#include "sym/expr.h"

/* The functions that are 0 at such places, each once. */
typedef struct {
  const Expr *at;
  uint32_t n;
} Switches;
Switches switches_of(ExprGraph *g, const Expr *roots, uint32_t n);

/* A line through the states: symbol `axis` is t; or, with axis 0, symbol s is base[s] + t*slope[s]. */
typedef struct {
  SymId axis;
  const long double *base, *slope;
  uint32_t count;
} SwitchLine;
void switch_go(SwitchLine line, long double t, long double *symbols);

/* Looks for places along lines through `base`, with t from 1e-12 to 1e12 in size: where a switching function changes its sign, to the last digit, or
 * comes nearest to 0. Each is shown to `try`, until that returns 1: then 1. exactly: `where` is the place itself. */
typedef int SwitchTry(void *data, long double *base, SwitchLine line, long double where, int exactly);
int switches_search(ExprGraph *g, const Switches *all, const SymId *free, uint32_t nfree, long double *base, uint32_t seed, SwitchTry *try, void *data);

#endif
