/* Numerical states of a model: projection onto the constraints; accelerations, multipliers, rates and energy from
 * the equations of motion; rank of the constraints. A state is an array of values by symbol. */
#pragma once

#include "base/row_span.h"
#include "base/sparse_solve.h"
#include "mech/eqns.h"
#include "sym/expr_eval.h"

typedef struct StateSolver StateSolver;

StateSolver *states_new(const Eqns *e);

/* Entries of M and A in the order of Eqns, c, r and the right-hand side of A q'' = demand. Valid until the solver
 * evaluates another state. */
typedef struct {
  const long double *mass, *A, *c, *r, *demand;
} StateValues;
StateValues states_at(StateSolver *s, const long double *symbols);

/* Projects the state onto the constraints, then fills in q'', z', multipliers and energy. 0: M is singular, the
 * projection failed, or a value is not finite. */
int states_complete(StateSolver *s, long double *symbols);

/* Projects positions, then velocities onto the constraints by Newton's method with least changes. 0: no convergence. */
int states_project(StateSolver *s, long double *symbols);

/* [M -A^T; A 0] at the state evaluated last. Valid until the next call of a function of this solver. */
const SparseElements *states_system(StateSolver *s);

/* Adds M, and A and -A^T of the first `rows` constraints, at their places in [M -A^T; A 0]. values: of the entries,
 * in the order of Eqns. */
void states_put_mass(const Eqns *e, const long double *values, SparseElements *a);
void states_put_constraints(const Eqns *e, const long double *values, uint32_t rows, SparseElements *a);

/* Exponents of 2, one a coordinate, that scale the columns of A so that its rank does not depend on units:
 * sparse_equilibrate of [M -A^T; A 0] at the state evaluated last. Valid until another state is evaluated. */
const int *states_column_scale(StateSolver *s);

/* Row k of A at the state evaluated last, columns scaled; valid until the next call. *at: index in A of the row's
 * first entry; becomes that of the next row. */
const SparseVector *states_row(StateSolver *s, uint32_t k, uint32_t *at);

/* Rank of the constraints at the state evaluated last, leaving out constraint `without` (UINT32_MAX: none).
 * counts[k]: constraint k is independent of those before it. held[n], or NULL: squared length of each coordinate
 * direction's projection on the rows of A. */
uint32_t states_rank(StateSolver *s, uint32_t without, unsigned char *counts, long double *held);

/* x with flows and the energy's formula put in for z' and the energy symbol; q'' stays. */
Expr states_substitute(const Eqns *e, Expr x);
