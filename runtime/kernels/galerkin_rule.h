/* galerkin_rule.h: a discrete Lagrangian as data: quadrature points in a step of length 1, and the nodes of the
 * velocity polynomial. Includes scalar.h, gauss_points.h.
 *
 *   L_d(q0, q1) = the extremum over u of  sum_i b_i L(c_i, Q_i, V_i),  where
 *   V_i = sum_k value[i][k] u_k,  Q_i = q0 + sum_k integral[i][k] u_k,  q1 = q0 + sum_k whole[k] u_k:
 *
 * the velocity is a polynomial with values u_k, the free velocities, at nodes. J.E. Marsden, M. West, Acta Numerica
 * 10 (2001) 357, DOI 10.1017/S096249290100006X, section 2.6; S. Ober-Blobaum, N. Saake, Adv. Comput. Math. 41 (2015)
 * 955, DOI 10.1007/s10444-014-9394-8: degree u with u Gauss points has order 2 u, and is Gauss collocation of
 * Hamilton's equations (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), VI.6.2). */
#ifndef LAG_GALERKIN_RULE_H
#define LAG_GALERKIN_RULE_H

#include "kernels/scalar.h"
#include "numeric/gauss_points.h"

#ifndef LAG_RULE_FREE
#define LAG_RULE_FREE 4 /* most points and free velocities */
#endif

/* ---- rule ---- */

/* Scalars only, because a rule is saved with the run: numbers of points and of free velocities, their tables. */
typedef struct lag_rule {
  LAG_REAL points, free, c[LAG_RULE_FREE], b[LAG_RULE_FREE], node[LAG_RULE_FREE];
  LAG_REAL value[LAG_RULE_FREE][LAG_RULE_FREE], integral[LAG_RULE_FREE][LAG_RULE_FREE], whole[LAG_RULE_FREE];
} lag_rule;

/* ---- rule: tables ---- */

/* Polynomial a[0] + a[1] x + ... below x^n, and its integral from 0. */
static inline LAG_REAL lag_rule_polynomial(const LAG_REAL *a, int n, LAG_REAL x, LAG_REAL *integral) {
  LAG_REAL y = LAG_C(0.0), sum = LAG_C(0.0);
  for (int k = n - 1; k >= 0; k--) {
    y = y*x + a[k];
    sum = sum*x + a[k]/(LAG_REAL)(k + 1);
  }
  *integral = sum*x;
  return y;
}

/* The Lagrange basis and its integral from 0, at the points, and over the step. */
static inline void lag_rule_fill(lag_rule *r) {
  const LAG_REAL zero = LAG_C(0.0);
  const int n = (int)r->free;
  for (int k = 0; k < n; k++) {
    LAG_REAL a[LAG_RULE_FREE];
    for (int j = 0; j < n; j++) a[j] = j ? zero : LAG_C(1.0);
    for (int j = 0, degree = 0; j < n; j++) {
      if (j == k) continue;
      const LAG_REAL gap = r->node[k] - r->node[j];
      degree++;
      for (int d = degree; d >= 0; d--) a[d] = ((d > 0 ? a[d - 1] : zero) - r->node[j]*a[d])/gap;
    }
    for (int i = 0; i < (int)r->points; i++)
      r->value[i][k] = lag_rule_polynomial(a, n, r->c[i], &r->integral[i][k]);
    (void)lag_rule_polynomial(a, n, LAG_C(1.0), &r->whole[k]);
  }
}

/* Gauss rule of order 2 n, n = 1 .. LAG_RULE_FREE, to the last digits. */
static inline void lag_rule_gauss(lag_rule *r, int n) {
  r->points = r->free = (LAG_REAL)n;
  lag_gauss_rule(n, r->c, r->b);
  for (int i = 0; i < n; i++) r->node[i] = r->c[i];
  lag_rule_fill(r);
}

/* One point at the start (c = 0) or the end (c = 1) of the step: symplectic Euler or its adjoint. */
static inline void lag_rule_euler(lag_rule *r, LAG_REAL c) {
  r->points = r->free = r->b[0] = LAG_C(1.0);
  r->c[0] = c;
  r->node[0] = LAG_C(0.5);
  lag_rule_fill(r);
}

/* ---- end ---- */
#endif
