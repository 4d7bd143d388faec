/* Eqns -> the linearisation of the equations of motion. */
#ifndef LAGC_MECH_LINEARISE_H
#define LAGC_MECH_LINEARISE_H

#include "mech/eqns.h"

/* A partial derivative of residual `row` by component `col` of y = (q, q', z). */
typedef struct {
  uint32_t row, col;
  Expr e;
} Partial;

typedef struct {
  const Partial *at;
  uint32_t n;
} Partials;

/* The exact linearisation: nonzero derivatives of the residuals
 *   r_i = f_i - sum_j M_ij q_j''   (i < n),   r_(n + k) = flow_k
 * at fixed q'', row by row, columns ascending. The Jacobian of the accelerations is dq''/dy = M^-1 dr/dy. Entries contain the symbols q''. */
Partials eqns_linearise(Eqns *e);

#endif
