/* States at which expressions are compared: every symbol has a value, and accelerations, rates and
 * the energy have those that follow from the others by the equations of motion. */
#ifndef LAGC_STATES_H
#define LAGC_STATES_H

#include "base/row_span.h"
#include "base/sparse_solve.h"
#include "mech/eqns.h"
#include "sym/eval.h"

typedef struct StateSolver StateSolver;

StateSolver *states_new(const Eqns *e);

/* Values at a state: the entries of M and A as Eqns lists them; c, r, and what A q'' must be. They stand until another state is looked at. */
typedef struct {
  const long double *mass, *A, *c, *r, *demand;
} StateValues;
StateValues states_at(StateSolver *s, const long double *symbols);

/* Fills in q'', z', the energy and multipliers; with constraints it first moves the state to the nearest one that obeys them. 0 where M
 * is singular, there is no such state, or a value is not finite. */
int states_complete(StateSolver *s, long double *symbols);

/* Moves the state to the nearest one that obeys the constraints, by Newton's method: positions, then velocities. 0: it found none. */
int states_obey(StateSolver *s, long double *symbols);

/* [M -A^T; A 0] at the state that was looked at last. It stands until the next is asked for, or another state is looked at. */
const SparseElements *states_system(StateSolver *s);

/* Elements of M, from the values of its entries, and of A and -A^T, of the first `rows` constraints, where they stand in [M -A^T; A 0]. */
void states_put_mass(const Eqns *e, const long double *values, SparseElements *a);
void states_put_constraints(const Eqns *e, const long double *values, uint32_t rows, SparseElements *a);

/* Powers of 2, one a coordinate, by which the derivatives of constraints are to be multiplied for their rank not to depend on units, at the state that was looked at
 * last: sparse_scales of [M -A^T; A 0]. They stand until another state is looked at. */
const int *states_scale(StateSolver *s);

/* Row k of A there, its coordinates scaled; entries from *at on, which moves behind them. It stands until the next. */
const SparseVector *states_row(StateSolver *s, uint32_t k, uint32_t *at);

/* The rank of the constraints, less one of them (UINT32_MAX: of all), at the state that was looked at last; counts[k]: constraint k is independent of
 * those before it. */
uint32_t states_rank(StateSolver *s, uint32_t without, unsigned char *counts);

/* e with z' and the energy replaced by what they are; q'' stays. */
Expr states_substitute(const Eqns *e, Expr x);

#endif
