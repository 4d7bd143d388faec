/* The linear system M q'' = f with the mass matrix kept as the product that the text of L is.
 *
 * Let L reach its velocities through definitions, w_k = W_k(q, q', w_1 .. w_{k-1}, t), as it does along
 * a chain: x[i]' = x[i-1]' + l*cos(th[i])*th[i]'. With u = (q', w) and
 *   Phi(q, u, lambda) = L(q, u) + sum lambda_k (W_k - w_k),      lambda_k = dPhi/dw_k's own zero, the
 * adjoint of w_k, Lagrange's equations are the time derivative of dPhi/dq' = p, dPhi/dw = 0,
 * dPhi/dlambda = 0: a symmetric system for (u', lambda') whose matrix is
 *   [ H  C^T - [0 I] ]      H = d2Phi/du2,  C = dW/du, strictly triangular in w,
 *   [ C - [0 I]    0 ]
 * and which is as sparse as the text. The pivots of (w_k', lambda_k') are [[h, -1], [-1, 0]]: never
 * singular, whatever h, so eliminating a pair is putting w_k' = C_k u' into the quadratic form; that of
 * q_i'' is positive where M is, once no definition left contains q_i'. All pairs first: H becomes M.
 * Pairs and coordinates by turns: the articulated bodies of Featherstone (Rigid Body Dynamics
 * Algorithms, 2008, section 7.3), for any L. The right-hand side is f, already as sparse as the text. */
#ifndef LAGC_LIFT_H
#define LAGC_LIFT_H

#include "mech/eqns.h"

/* H and C of the definitions through which L reaches its velocities, in e's raw form. */
LinearSystem lift_system(const Eqns *e);

#endif
