/* Proofs of expectations case by case, where one normal form for all states does not decide. */
#pragma once

#include "mech/motion_proof.h"

/* The equations with symbol s replaced by with[s] where that is not 0; `with` covers all symbols. */
const Eqns *equations_with(const Eqns *e, const Expr *with);

/* Positive symbols for the cases of all proofs, declared once, before any table over symbols is made. */
enum { CASES_DEPTH_MAX = 8 };
typedef struct {
  SymId positive[CASES_DEPTH_MAX];
} CaseSymbols;
CaseSymbols cases_symbols(const Model *m);

/* Whether the sides are equal at all states where `domain` holds (0: everywhere). The cases: signs that the domain
 * gives; states on the constraints and velocities along them; both sides, and the place itself, of each `abs`,
 * `sign`, `min`, `max` and comparison. */
int prove_by_cases(const Eqns *e, const CaseSymbols *symbols, Expr lhs, Expr rhs, Expr domain);
