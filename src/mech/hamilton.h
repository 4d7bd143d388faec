/* The Hamiltonian H(q, p, t) by the Legendre transformation of L: p_i = dL/dq_i', H = p q' - L.
 *
 * Symbolic where L is quadratic in velocities, L = q'Mq'/2 + a q' - V, and M has a short inverse in closed form, in
 * blocks of at most three coordinates. Then
 *   H = (p - a) M^-1 (p - a)/2 + V,   q' = dH/dp,   p' = -dH/dq + Q + A^T lambda
 * with Q the generalised forces outside L, and lambda the multipliers of constraints.
 *
 * Back from H(q, p, t): q' = dH/dp = W p + b with W = d2H/dp2, and L = (q' - b) W^-1 (q' - b)/2 - H(q, 0, t), where
 * H is quadratic in p. */
#pragma once

#include "mech/eqns.h"

typedef struct {
  int is_closed;       /* 0: no closed form; only p and why_not are set */
  const char *why_not;
  const SymId *p;      /* [n] symbols of momenta, p_x */
  Expr H;
  const Expr *rate;    /* [n] q' in q, p, t */
  const Expr *force;   /* [n] p' in q, p, z, t, inputs and multipliers */
} Hamilton;

typedef struct {
  const char *why_not; /* reason for no closed form; NULL: there is one */
  /* det d2H/dp2 of up to three coordinates, 0 node where it vanishes everywhere; 0: not computed */
  Expr det;
  Expr L;
  const Expr *p;       /* [pairs] momenta in q, q', t */
} InverseLegendre;

/* Lagrangian of a model that gives its Hamiltonian. */
InverseLegendre lagrangian_derive(Eqns *e);

/* Needs coordinates with accelerations: for an L of first order the Legendre transformation is singular. May derive
 * e->mass. */
Hamilton hamilton_derive(Eqns *e);
