/* One step of a discrete Lagrangian: its equations, and Newton's method for them. */
#pragma once

#include <stddef.h>

#include "lag.h"
#include "methods/galerkin_rule.h"

/* A step of length h from (q, p) at t, by a rule. With L_i = L(t + c_i h, Q_i, V_i), F = dL/dq + Q and the free
 * velocities u (galerkin_rule.h), the discrete Lagrange-d'Alembert principle p = -D1 L_d - F_d- gives the equations
 *
 *   sum_i b_i (value[i][k] dL_i/dv - h (whole[k] - integral[i][k]) F_i) = whole[k] p    for each k
 *
 * and the step ends at q + h sum_k whole[k] u_k and at p + h sum_i b_i F_i, which is p1 = D2 L_d + F_d+. With h = 0
 * the equations are dL/dv(q, u) = p, for the velocity u of a momentum p. */
typedef struct lag_discrete {
  const lag_rule *rule;
  lag_problem *pb;
  double t, h;
  double size;          /* length of a whole step [s]: corrections of u are compared with the motion of q over it */
  const double *q, *dq; /* [nq] the step begins at q + dq */
  const double *p, *dp; /* [nq] and at p + dp */
  double *u;            /* [free nq], u[k nq + i]: in: a guess; out: the solution */
  double *force;        /* [points nq] out: F at the points */
  double *work;         /* [lag_discrete_size] */
  int counted;          /* 1: its corrections count as iterations of the method */
} lag_discrete;

/* Doubles of lag_discrete.work, for rules with up to this number of free velocities. */
size_t lag_discrete_size(const lag_problem *pb, int free);

/* Newton's method with exact derivatives, until corrections are rounding: larger residuals would have the same sign
 * step after step and add up over a long run. The matrix is refreshed while corrections are large. LAG_OK, or a
 * failure with time and reason in pb; u is then undefined. */
int lag_discrete_solve(const lag_discrete *d);

/* Product of the second derivatives h[nsecond] of L and of the forces with changes dQ, dV[nq * k] of coordinates and
 * velocities, row-major: added to the changes dP of momenta and dF of dL/dq + Q. dV, dP and dF may be NULL. */
void lag_hessian_times(const lag_problem *pb, const double *h, int k, const double *dQ, const double *dV, double *dP,
                       double *dF);

/* Derivative of the step by the implicit function theorem. In: changes dq, dp[nq * k] at its start, and d->u of the
 * step; out: dq, dp at its end, and du[free nq * k]. scratch has lag_discrete_tangent_size doubles. */
size_t lag_discrete_tangent_size(const lag_problem *pb, int free, int k);
int lag_discrete_tangent(const lag_discrete *d, int k, double *dq, double *dp, double *du, double *scratch);
