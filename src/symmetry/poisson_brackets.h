/* The algebra of the charges found: Poisson brackets at a fixed time, {x, p} = 1, as linear combinations of the
 * charges.
 *
 * In numbers: with M = dp/dv the derivatives of a charge A(q, v, t) in phase space are
 *   dA/dp = M^-1 dA/dv,   dA/dq at fixed p = dA/dq - (dp/dq)^T M^-1 dA/dv,
 * and for a first-order L {A, B} = dA/dz omega^-1 dB/dz. Random states give the coefficients, further ones check them.
 * Symbolically, without an inverse: the charge of (xi, tau), F generates xi - tau q' along the motion, so
 *   dA/dp_i = xi_i - tau q_i',   dA/dq_i at fixed p = sum_k p_k dxi_k/dq_i + tau dL/dq_i - dF/dq_i.
 * The two ways share nothing but the charges. V. I. Arnold, Mathematical Methods of Classical Mechanics, 2nd ed.
 * (1989), 40. */
#pragma once

#include "symmetry/find_symmetries.h"

typedef struct {
  uint32_t a, b;   /* a < b */
  const Expr *c;   /* [n] constants: the bracket is sum of c_i Q_i, plus `constant`; NULL: not recognised */
  Expr constant;
  /* where c is NULL, 1: no combination, by random states; 0: a combination, its coefficients not recognised */
  int is_outside;
  Expr value;      /* in q, q', t */
  int proved;      /* symbolically; otherwise seen at random states */
} Bracket;

typedef struct {
  uint32_t n;           /* number of charges */
  VEC(Bracket) all;     /* nonzero brackets */
  uint32_t by_value;    /* number of pairs whose bracket is not proved */
  const char *why_not;  /* reason for giving no brackets; or NULL */
} Algebra;

/* All brackets of the charges found; up to 48 charges. */
Algebra brackets_find(Eqns *e, const FoundSymmetries *of, SearchLimit *limit);
