/* A discrete Lagrangian as data: quadrature points in a step of length 1, and the nodes of the velocity polynomial.
 *
 *   L_d(q0, q1) = the extremum over u of  sum_i b_i L(c_i, Q_i, V_i),  where
 *   V_i = sum_k value[i][k] u_k,  Q_i = q0 + sum_k integral[i][k] u_k,  q1 = q0 + sum_k whole[k] u_k:
 *
 * the velocity is a polynomial with values u_k, the free velocities, at nodes. J.E. Marsden, M. West, Acta Numerica
 * 10 (2001) 357, DOI 10.1017/S096249290100006X, section 2.6; S. Ober-Blobaum, N. Saake, Adv. Comput. Math. 41 (2015)
 * 955, DOI 10.1007/s10444-014-9394-8: degree u with u Gauss points has order 2 u, and is Gauss collocation of
 * Hamilton's equations (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), VI.6.2). */
#pragma once

enum { LAG_RULE_POINTS = 4, LAG_RULE_FREE = 4 };

/* Doubles only, because a rule is saved with the run. */
typedef struct lag_rule {
  double points, free; /* numbers of points <= LAG_RULE_POINTS and of free velocities <= LAG_RULE_FREE */
  double c[LAG_RULE_POINTS], b[LAG_RULE_POINTS];
  double node[LAG_RULE_FREE];
  double value[LAG_RULE_POINTS][LAG_RULE_FREE];
  double integral[LAG_RULE_POINTS][LAG_RULE_FREE];
  double whole[LAG_RULE_FREE];
} lag_rule;

/* Gauss rule of order 2 u, u = 1 .. LAG_RULE_FREE, computed to the last digits of a double. */
void lag_rule_gauss(lag_rule *r, int u);

/* One point at the start (c = 0) or the end (c = 1) of the step: symplectic Euler or its adjoint. */
void lag_rule_euler(lag_rule *r, double c);
