/* Eqns -> the linearisation of the equations of motion, and the derivatives of events. */
#pragma once

#include "mech/eqns.h"
#include "sym/diff.h"

/* A partial derivative of residual `row` by component `col` of y = (q, q', z), or of what PartialsBy says. */
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
 * at fixed q'', row by row, columns ascending. The Jacobian of the accelerations is dq''/dy = M^-1 dr/dy. Entries
 * contain the symbols q''. With constraints also r_(n + states + k) = demand_k - sum_j A_kj q_j'', at fixed
 * multipliers, whose symbols are in entries of the first n rows:
 *   M dq'' - A^T dlambda = dr_i,   A dq'' = dr_(n + states + k). */
Partials eqns_linearise(Eqns *e);

/* Reverse mode for all at once: S = sum_i w_i r_i over the residuals above, with new symbols w[n + states]; the
 * nonzero derivatives of S by y, by inputs, and by parameters as in PartialsBy; and those of the inputs' formulas (row:
 * input) by parameters. Where M w = x for the first n, these are the products x^T dq''/dy and so on. With constraints
 * S has the terms -l_k (demand_k - A_k q''), with new symbols l[constraints], and M w - A^T l = x, A w = 0.
 *
 * r: the same derivatives of sum l_k r_k over the rates of constraints, and c: of sum k_j c_j over the functions of
 * positions, with new symbols k[nholonomic], for the transpose of the projection onto them. */
typedef struct {
  ExprPartials by_state, by_inputs, by_params;
} SumPartials;
typedef struct {
  const SymId *w, *l, *k;
  SumPartials S, r, c;
  Partials formulas;
} AdjointPartials;
AdjointPartials eqns_adjoint(Eqns *e);

/* The same by inputs, or by the parameters that are not fixed (col: their place), each as if it were free. */
typedef enum { BY_STATE, BY_INPUTS, BY_PARAMS } PartialsBy;
Partials eqns_partials(Eqns *e, PartialsBy by);

/* Derivatives of x[0..n), such as outputs: row: the index; columns: the components of y, then inputs, q'', z' and
 * the parameters that are not fixed, each as if it were free. */
Partials eqns_output_partials(const Eqns *e, const Expr *x, uint32_t n);

/* Forces M q'' - f that give the accelerations q'', [n], in the symbols q''; those of constraints are part of them. */
const Expr *eqns_inverse_dynamics(Eqns *e);
/* f without multipliers, [n]. */
const Expr *eqns_forces(const Eqns *e);

/* Derivative of an event: of its function g (row < 0) or of the value that an action assigns to component `row` of
 * [q|v|z], by component `col` of the state, or by time (col = 2 n + states). Of g the nonzero ones; of a value also
 * that by its own component, so that each assigned row is there. Events that depend on inputs have none, since the
 * compiler does not know the inputs' values. */
typedef struct {
  uint32_t event;
  int row;
  uint32_t col;
  Expr e;
} EventPartial;

typedef struct {
  const EventPartial *at;
  uint32_t n;
} EventPartials;

EventPartials eqns_event_derivatives(const Eqns *e);
