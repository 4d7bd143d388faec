/* Steps of discrete Lagrangians: the instance of kernels/galerkin_step.h for a lag_problem, and derivatives. */
#pragma once

#include <stddef.h>

#include "lag.h"

/* Calls of the model, and failures: status of the step. */
struct lag_discrete;
struct lag_discrete_room;
int lag_discrete_variation(lag_problem *pb, double t, const struct lag_discrete_room *w);
int lag_discrete_second(lag_problem *pb, double t, const struct lag_discrete_room *w);
int lag_discrete_infinite(lag_problem *pb, const struct lag_discrete *d, const struct lag_discrete_room *w);
int lag_discrete_leaves(lag_problem *pb, const struct lag_discrete *d, const struct lag_discrete_room *w, int status);
int lag_discrete_fails(lag_problem *pb, const struct lag_discrete *d, const struct lag_discrete_room *w,
                       const char *what);

#define LAG_MODEL lag_problem *pb
#define LAG_THE_MODEL pb
#define LAG_COORDINATES(w) (w)->n
#define LAG_VARIATION(t, w) lag_discrete_variation(pb, t, w)
#define LAG_SECOND(t, w) lag_discrete_second(pb, t, w)
#define LAG_NEWTON_SOLVES(d) pb->systems += (d)->counted
#define LAG_NEWTON_CORRECTS(d) pb->iterations += (d)->counted
#define LAG_NEWTON_INFINITE(d, w) lag_discrete_infinite(pb, d, w)
#define LAG_NEWTON_LEAVES(d, w, status) lag_discrete_leaves(pb, d, w, status)
#define LAG_NEWTON_SINGULAR(d, w) lag_discrete_fails(pb, d, w, NULL)
#define LAG_NEWTON_FAILS(d, w) lag_discrete_fails(pb, d, w, "did not converge in 25 corrections")
#include "kernels/galerkin_step.h"

/* Doubles of lag_discrete.work, for rules with up to this number of free velocities. */
size_t lag_discrete_size(const lag_problem *pb, int free);

/* LAG_OK, or a failure with time and reason in pb; d->u is then undefined. */
int lag_discrete_solve(lag_problem *pb, const lag_discrete *d);

/* Product of the second derivatives h[nsecond] of L and of the forces with changes dQ, dV[nq * k] of coordinates and
 * velocities, row-major: added to the changes dP of momenta and dF of dL/dq + Q. dV, dP and dF may be NULL. */
void lag_hessian_times(const lag_problem *pb, const double *h, int k, const double *dQ, const double *dV, double *dP,
                       double *dF);

/* Derivative of the step by the implicit function theorem. In: changes dq, dp[nq * k] at its start, and d->u of the
 * step; out: dq, dp at its end, and du[free nq * k]. scratch has lag_discrete_tangent_size doubles. */
size_t lag_discrete_tangent_size(const lag_problem *pb, int free, int k);
int lag_discrete_tangent(lag_problem *pb, const lag_discrete *d, int k, double *dq, double *dp, double *du,
                         double *scratch);
