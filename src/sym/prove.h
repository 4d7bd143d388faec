/* Proofs that expressions vanish. */
#ifndef LAGC_PROVE_H
#define LAGC_PROVE_H

#include "sym/normal.h"

typedef enum { NOT_DECIDED, PROVED_ZERO, PROVED_NONZERO } Verdict;

/* What a proof may cost; about a fifth of a second at most. */
NormalLimits prove_limits(void);

/* Whether e is 0 wherever it is defined; where numbers have more than 64 bits, by their residues (base/num.h). PROVED_NONZERO: the normal form is unique and not 0, or a
 * value at some state is larger than all its rounding errors. limits NULL: prove_limits(). */
Verdict prove_zero(ExprGraph *g, Expr e, const NormalLimits *limits);

/* Whether e vanishes when the symbols acc[0..n-1] solve M acc = f (M is n*n, row by row; the entries
 * do not contain acc). Proved by Cramer's rule on normal forms; only the block of M that e needs is
 * looked at. A singular M is not decided. PROVED_NONZERO: not for all states, by a normal form that is unique. */
Verdict prove_solves(ExprGraph *g, uint32_t n, const Expr *M, const Expr *f, const SymId *acc, Expr e,
                     const NormalLimits *limits);

/* A state for comparing values: symbols[s] for s in 1 .. expr_symbol_count, different for each seed,
 * within 0.3 .. 2 in size and of the sign that is known. pi is pi. */
void prove_state(const ExprGraph *g, uint32_t seed, long double *symbols);

/* The value of one of them there. */
long double prove_symbol(const ExprGraph *g, SymId s, uint32_t seed);

/* The same with coordinates, states and time of 1.2 .. 8 in size: angles past half a turn, where branches end. */
void prove_state_wide(const ExprGraph *g, uint32_t seed, long double *symbols);

/* Values of all nodes of the roots with bounds of their rounding errors, state by state; of one of the nodes, after a run. */
typedef struct BoundTape BoundTape;
BoundTape *bound_tape(ExprGraph *g, const Expr *roots, uint32_t n);
void bound_run(BoundTape *t, const long double *symbols, const long double *errors);
long double bound_value(const BoundTape *t, Expr node, long double *bound);

/* The value of e, and a bound of its rounding error when the symbols have the errors given
 * (NULL: none). The bound is infinite where none is known. */
long double prove_value(ExprGraph *g, Expr e, const long double *symbols, const long double *errors,
                        long double *bound);

#endif
