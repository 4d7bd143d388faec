/* Implicit symplectic methods for any L, in q and p: a step is a chain of substeps, each the step of one discrete Lagrangian (galerkin_rule.h),
 * solved by Newton's method (discrete_lagrangian.h). */
#ifndef LAG_METHODS_IMPLICIT_SYMPLECTIC_H
#define LAG_METHODS_IMPLICIT_SYMPLECTIC_H

#include "lag.h"
#include "methods/composition.h"
#include "methods/galerkin_rule.h"

/* Doubles of state: for one rule with this number of free velocities, or for a composition of symplectic Euler and its adjoint. */
size_t lag_implicit_size(const lag_problem *pb, int free);
size_t lag_implicit_composed_size(const lag_problem *pb, const lag_composition *c);

/* Prepares steps of size h by one rule of this order, or by a composition. */
void lag_implicit_init(void *work, lag_problem *pb, double h, int order, const lag_rule *rule);
void lag_implicit_compose(void *work, lag_problem *pb, double h, const lag_composition *c);

/* Members of lag_method of the same names. Forces enter by the discrete Lagrange-d'Alembert principle at the points of the rules. */
void lag_implicit_reset(void *work, lag_problem *pb);
int lag_implicit_step(void *work, lag_problem *pb, double *t, double *y, double t_stop);
void lag_implicit_dense(void *work, lag_problem *pb, double t, double *y);

/* Derivative of the last step, or of a shorter step from the same start, in q and v. */
size_t lag_implicit_tangent_size(const lag_problem *pb, int k);
int lag_implicit_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch);

#endif
