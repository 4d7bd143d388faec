/* Proofs of expectations case by case, where one normal form for all states does not decide. */
#ifndef LAGC_CASES_H
#define LAGC_CASES_H

#include "mech/eqns.h"

/* The equations with these expressions in the place of symbols: with[s] where it is not 0, for all symbols there are. */
const Eqns *cases_with(const Eqns *e, const Expr *with);

/* Positive symbols for the cases of all proofs: declared once, before any table of symbols is made. */
enum { CASES_DEEP = 8 };
typedef struct {
  SymId positive[CASES_DEEP];
} CaseSymbols;
CaseSymbols cases_symbols(const Model *m);

/* Whether the sides are equal for all states at which `domain` holds (0: all). The cases: what the domain says of signs; states on the
 * constraints and velocities along them; both sides, and the place itself, of each `abs`, `sign`, `min`, `max` and comparison. */
int cases_prove(const Eqns *e, const CaseSymbols *symbols, Expr lhs, Expr rhs, Expr domain);

#endif
