/* The equations of one step of discrete mechanics, and Newton's method for them. */
#ifndef LAG_METHODS_DISCRETE_H
#define LAG_METHODS_DISCRETE_H

#include <stddef.h>

#include "lag.h"
#include "methods/rule.h"

/* A step from (q, p) at t, of length h, by a rule. With L_i = L(t + c_i h, Q_i, V_i), F = dL/dq + Q and u the free
 * velocities (rule.h) the equations are those of the discrete Lagrange-d'Alembert principle, p = -D1 L_d - F_d-:
 *
 *   sum_i b_i (value[i][k] dL_i/dv - h (whole[k] - integral[i][k]) F_i) = whole[k] p    for each k
 *
 * and the step leads to q + h sum_k whole[k] u_k, p + h sum_i b_i F_i, which is p1 = D2 L_d + F_d+. With h = 0 they say
 * dL/dv(q, u) = p: the velocity that belongs to a momentum. */
typedef struct lag_discrete {
  const lag_rule *rule;
  lag_problem *pb;
  double t, h;
  double size;          /* of a whole step: corrections are compared with how far it moves q */
  const double *q, *dq; /* [nq] the sum is where the step begins */
  const double *p, *dp; /* [nq] likewise */
  double *u;            /* [free nq], u[k nq + i]: on entry a guess */
  double *force;        /* [points nq] F at the points, at the end */
  double *work;         /* [lag_discrete_size] */
  int counted;          /* its corrections count as iterations of the method */
} lag_discrete;

/* Doubles of work for rules with as many free velocities as this one, or fewer. */
size_t lag_discrete_size(const lag_problem *pb, int free);

/* Newton's method with exact derivatives, until corrections are rounding: otherwise what it leaves, always on the same side,
 * would add up over a long run. The matrix is taken anew while corrections are large. LAG_OK, or a failure with its place
 * and reason in pb; u is then spoilt. */
int lag_discrete_solve(const lag_discrete *d);

/* How the second derivatives h[nsecond] of L and of the forces act on changes dQ, dV[nq * k] of coordinates and velocities: dP,
 * of momenta, and dF, of dL/dq + Q, are added to. Row by row; dV and dP may be NULL. */
void lag_second_times(const lag_problem *pb, const double *h, int k, const double *dQ, const double *dV, double *dP, double *dF);

/* The derivative of the step, by the implicit function theorem: du[free nq * k], and on return dq, dp[nq * k] at its end, where
 * they were changes at its beginning. Needs the u of the step; scratch has lag_discrete_tangent_size doubles. */
size_t lag_discrete_tangent_size(const lag_problem *pb, int free, int k);
int lag_discrete_tangent(const lag_discrete *d, int k, double *dq, double *dp, double *du, double *scratch);

#endif
