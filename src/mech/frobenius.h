/* Whether constraints on velocities could be stated for positions. */
#ifndef LAGC_FROBENIUS_H
#define LAGC_FROBENIUS_H

#include "mech/states.h"

typedef enum {
  INTEGRABLE_NO,       /* nonholonomic: shown at a state */
  INTEGRABLE_PROVED,
  INTEGRABLE_UNDECIDED /* at all states tried it looks so, and that is not proved */
} Integrable;

/* With the one-forms omega_i = A_i dq + b_i dt of all constraints, time among the coordinates: they are integrable when d omega_i ^ omega_1 ^
 * ... ^ omega_m = 0 for all i. G. Frobenius, J. reine angew. Math. 82 (1877) 230, DOI 10.1515/crelle-1877-18789723. Proved on the graph for
 * up to three constraints of up to eight coordinates, and where every d omega_i is 0. */
Integrable frobenius(const Eqns *e, StateSolver *solver);

/* F(q, t) with dF/dt = r, proved, for r = A q' + b of a constraint on velocities: it keeps F. 0 where none is found. */
Expr frobenius_leaf(const Eqns *e, Expr r);

#endif
