/* States at which expressions are compared: every symbol has a value, and accelerations, rates and
 * the energy have those that follow from the others by the equations of motion. */
#ifndef LAGC_STATES_H
#define LAGC_STATES_H

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

/* The rank of the constraints, less one of them (UINT32_MAX: of all), at the state that was looked at last; counts[k]: constraint k is independent of
 * those before it. */
uint32_t states_rank(StateSolver *s, uint32_t without, unsigned char *counts);

/* e with z' and the energy replaced by what they are; q'' stays. */
Expr states_substitute(const Eqns *e, Expr x);

#endif
