/* Proofs that expressions vanish, sample states, and values with rounding bounds. */
#pragma once

#include "sym/normal_form.h"
#include "sym/verdict.h"

/* Default limits on the cost of a proof: about 0.2 s at most. */
NormalLimits prove_limits(void);

/* Decides whether e is 0 wherever it is defined; numbers beyond 64 bits are compared by their residues (base/num.h).
 * PROVED_NONZERO: the normal form is unique and not 0, or the value at some state exceeds its rounding bound. limits
 * NULL: prove_limits(). */
Verdict prove_zero(ExprGraph *g, Expr e, const NormalLimits *limits);

/* Whether the value of e at some random state exceeds its rounding bound: the quick half of prove_zero. */
int prove_nonzero(ExprGraph *g, Expr e);

/* Decides whether e vanishes when the symbols acc[0..n-1] solve M acc = f (M is n*n, row by row; its entries
 * do not contain acc). Proved by Cramer's rule on normal forms of the block of M that e needs.
 * A singular M gives NOT_DECIDED. PROVED_NONZERO: the normal form is unique and not 0, so e fails at some states. */
Verdict prove_solves(ExprGraph *g, uint32_t n, const Expr *M, const Expr *f, const SymId *acc, Expr e,
                     const NormalLimits *limits);

/* Random sample state: symbols[s] for s in 1 .. expr_symbol_count, of magnitude 0.3 .. 2 and of the declared sign,
 * determined by seed. pi keeps its value. */
void sample_state(const ExprGraph *g, uint32_t seed, long double *symbols);

/* Value of symbol s in the sample state of that seed. */
long double sample_symbol(const ExprGraph *g, SymId s, uint32_t seed);

/* sample_state with coordinates, states and time of magnitude 1.2 .. 8: angles beyond half a turn, across branch
 * cuts. */
void sample_state_wide(const ExprGraph *g, uint32_t seed, long double *symbols);

/* Tape that evaluates all nodes of the roots with rounding bounds at a state (bound_run); bound_value reads one node
 * after a run. errors[s]: error of symbol s, or NULL for exact symbols. */
typedef struct BoundTape BoundTape;
BoundTape *bound_tape(ExprGraph *g, const Expr *roots, uint32_t n);
void bound_tape_free(BoundTape *t); /* gives up its memory */
void bound_run(BoundTape *t, const long double *symbols, const long double *errors);
long double bound_value(const BoundTape *t, Expr node, long double *bound);

/* Value of e and a bound of its error, given the errors of the symbols (NULL: none). The bound is infinite where
 * none is known. */
long double value_with_bound(ExprGraph *g, Expr e, const long double *symbols, const long double *errors,
                        long double *bound);
