/* Integrability of constraints on velocities: could they be stated for positions? */
#pragma once

#include "mech/states.h"

typedef enum {
  INTEGRABLE_NO,       /* nonholonomic: a state shows it */
  INTEGRABLE_PROVED,
  INTEGRABLE_UNDECIDED /* integrable at all states tried, but not proved */
} Integrable;

/* Frobenius' theorem for the one-forms omega_i = A_i dq + b_i dt of all constraints, time among the coordinates:
 * integrable if and only if d omega_i ^ omega_1 ^ ... ^ omega_m = 0 for all i. G. Frobenius, J. reine angew. Math.
 * 82 (1877) 230, DOI 10.1515/crelle-1877-18789723. Proved where every d omega_i is 0. */
Integrable frobenius(const Eqns *e, StateSolver *solver);

/* F(q, t) with dF/dt = r, proved, for r = A q' + b of a constraint on velocities, which keeps F constant. 0: none
 * was found. */
Expr frobenius_leaf(const Eqns *e, Expr r);
