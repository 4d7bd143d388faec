/* The algebra of the charges that the search found: Poisson brackets at a fixed time, {x, p} = 1, written as combinations of the charges.
 *
 * In numbers: with M = dp/dv the derivatives of a charge A(q, v, t) in phase space are
 *   dA/dp = M^-1 dA/dv,   dA/dq at fixed p = dA/dq - (dp/dq)^T M^-1 dA/dv,
 * and for an L of first order {A, B} = dA/dz omega^-1 dB/dz. Random states give the coefficients, further ones check them.
 * Symbolically, without an inverse: the charge of (xi, tau), F generates xi - tau q' along the motion, so
 *   dA/dp_i = xi_i - tau q_i',   dA/dq_i at fixed p = sum_k p_k dxi_k/dq_i + tau dL/dq_i - dF/dq_i.
 * The two ways share nothing but the charges. V. I. Arnold, Mathematical Methods of Classical Mechanics, 2nd ed. (1989), 40. */
#ifndef LAGC_BRACKETS_H
#define LAGC_BRACKETS_H

#include "mech/noether_find.h"

typedef struct {
  uint32_t a, b;   /* a < b */
  const Expr *c;   /* [n] constants: the bracket is their combination of the charges, and `constant`; NULL: none was recognised */
  Expr constant;
  int is_outside;  /* where c is NULL: random states say that it is no combination; otherwise it is one, with coefficients not recognised */
  Expr value;      /* in q, q', t */
  int proved;      /* symbolically; otherwise seen at random states */
} Bracket;

typedef struct {
  uint32_t n;           /* charges */
  VEC(Bracket) all;     /* those that are not 0 */
  uint32_t by_value;    /* how many of all pairs are not proved */
  const char *why_not;  /* no brackets, for this reason; or NULL */
} Algebra;

Algebra brackets_find(Eqns *e, const FoundSymmetries *of);

#endif
