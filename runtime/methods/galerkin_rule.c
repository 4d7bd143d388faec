/* Computes the tables (points, weights, nodes) that define discrete Lagrangians. */
#include "methods/galerkin_rule.h"

#include <string.h>

#include "numeric/quadrature.h"

/* Returns p(x); *integral := the integral of p from 0 to x. p has degree n and coefficients a. */
static double polynomial(const double *a, int n, double x, double *integral) {
  double p = 0, s = 0;
  for (int k = n; k >= 0; k--) {
    p = p * x + a[k];
    s = s * x + a[k] / (k + 1);
  }
  *integral = s * x;
  return p;
}

/* Fills value and integral (the Lagrange basis and its integral from 0, at the points) and whole (its integral over
 * the step). */
static void fill(lag_rule *r) {
  int n = (int)r->free, points = (int)r->points;
  for (int k = 0; k < n; k++) {
    double a[LAG_RULE_FREE] = {1};
    for (int j = 0, degree = 0; j < n; j++) {
      if (j == k) continue;
      double gap = r->node[k] - r->node[j];
      degree++;
      for (int d = degree; d >= 0; d--) a[d] = ((d > 0 ? a[d - 1] : 0) - r->node[j] * a[d]) / gap;
    }
    for (int i = 0; i < points; i++) r->value[i][k] = polynomial(a, n - 1, r->c[i], &r->integral[i][k]);
    polynomial(a, n - 1, 1, &r->whole[k]);
  }
}

void lag_rule_gauss(lag_rule *r, int u) {
  *r = (lag_rule){.points = u, .free = u};
  lag_gauss_points(u, r->c, r->b);
  memcpy(r->node, r->c, sizeof r->node);
  fill(r);
}

void lag_rule_euler(lag_rule *r, double c) {
  *r = (lag_rule){.points = 1, .free = 1, .c = {c}, .b = {1}, .node = {0.5}};
  fill(r);
}
