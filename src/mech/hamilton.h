/* The Hamiltonian: H(q, p, t) by the Legendre transformation of L, p_i = dL/dq_i', H = p q' - L.
 *
 * Symbolic where L is quadratic in velocities, L = q'Mq'/2 + a q' - V, and M is inverted in closed form: block by block, blocks of at most
 * three coordinates, with short results. Then
 *   H = (p - a) M^-1 (p - a)/2 + V,   q' = dH/dp,   p' = -dH/dq + Q + A^T lambda
 * with Q the forces that are in no L, and lambda the multipliers of constraints. */
#ifndef LAGC_HAMILTON_H
#define LAGC_HAMILTON_H

#include "mech/eqns.h"

typedef struct {
  int is_closed;       /* 0: what follows is 0 but p and why_not */
  const char *why_not;
  const SymId *p;      /* [n] symbols of momenta, p_x */
  const Expr *inverse; /* [n*n] of M; zero nodes where it is zero */
  const Expr *a;       /* [n] momenta at rest: magnetic terms */
  Expr H;
  const Expr *rate;    /* [n] q' in q, p, t */
  const Expr *force;   /* [n] p' in q, p, z, t, inputs and multipliers */
} Hamilton;

/* Needs coordinates with accelerations: an L of first order has no H of this kind (its own brackets are those of its two-form). */
Hamilton hamilton_derive(Eqns *e);

#endif
