/* The linear system M q'' = f with the mass matrix kept as a product, as sparse as the text of L.
 *
 * Let L reach its velocities through definitions, w_k = W_k(q, q', w_1 .. w_{k-1}, t), as it does along
 * a chain: x[i]' = x[i-1]' + l*cos(th[i])*th[i]'. With u = (q', w) and
 *   Phi(q, u, lambda) = L(q, u) + sum lambda_k (W_k - w_k),      lambda_k = adjoint of w_k, from dPhi/dw_k = 0,
 * Lagrange's equations are the time derivatives of dPhi/dq' = p, dPhi/dw = 0, dPhi/dlambda = 0: a symmetric system for
 * (u', lambda') with the matrix
 *   [ H  C^T - [0 I] ]      H = d2Phi/du2,  C = dW/du, strictly triangular in w,
 *   [ C - [0 I]    0 ]
 * as sparse as the text. The pivot of (w_k', lambda_k') is [[h, -1], [-1, 0]], regular for any h: eliminating a pair
 * substitutes w_k' = C_k u' in the quadratic form. The pivot of q_i'' is positive where M is positive definite, once
 * no remaining definition contains q_i'. Eliminating all pairs first turns H into M. Pairs and coordinates by turns
 * are Featherstone's articulated bodies (Rigid Body Dynamics Algorithms, 2008, section 7.3), for any L. The
 * right-hand side is f. */
#pragma once

#include "mech/eqns.h"

/* H and C as differentiated, for the definitions through which L reaches its velocities; ndefs = 0 where there are
 * none. */
LinearSystem augmented_system(const Eqns *e);
