/* Tables of discrete Lagrangians. Lobatto nodes and weights come from Legendre polynomials by Newton's method: P. Davis, P. Rabinowitz,
 * Methods of Numerical Integration, 2nd ed. (1984), 2.7; M. Abramowitz, I. Stegun, 25.4.32. */
#include "methods/galerkin_rule.h"

#include <math.h>
#include <string.h>

#include "numeric/quadrature.h"

/* c[n], b[n] := Lobatto nodes and weights on [0, 1]: both ends and the zeros of P'_(n-1), where (1 - x^2) P'_m = m (P_(m-1) - x P_m)
 * and (1 - x^2) P''_m = 2 x P'_m - m (m + 1) P_m. */
static void lobatto(int n, double *c, double *b)
{
  int m = n - 1;

  for (int i = 0; i < (n + 1) / 2; i++) {
    double below, p, x = i == 0 ? 1 : cos(3.141592653589793 * i / m);
    for (int turn = 0; turn < 10 && i > 0; turn++) {
      p = lag_legendre(m, x, &below);
      double first = m * (below - x * p) / (1 - x * x);
      x -= first / ((2 * x * first - m * (m + 1) * p) / (1 - x * x));
    }
    x = 2 * i + 1 == n ? 0 : x;
    p = lag_legendre(m, x, &below);
    c[i] = 0.5 - x / 2;
    c[m - i] = 0.5 + x / 2;
    b[i] = b[m - i] = 1 / (n * m * p * p);
  }
}

/* Returns p(x); *integral := the integral of p from 0 to x. p has degree n and coefficients a. */
static double polynomial(const double *a, int n, double x, double *integral)
{
  double p = 0, s = 0;

  for (int k = n; k >= 0; k--) {
    p = p * x + a[k];
    s = s * x + a[k] / (k + 1);
  }
  *integral = s * x;
  return p;
}

/* Fills value, integral and whole: the Lagrange basis of the nodes and its integrals, at the points. */
static void fill(lag_rule *r)
{
  int n = (int)r->free, points = (int)r->points;

  for (int k = 0; k < n; k++) {
    double a[LAG_RULE_FREE] = {1};
    for (int j = 0, degree = 0; j < n; j++) {
      if (j == k) {
        continue;
      }
      double gap = r->node[k] - r->node[j];
      degree++;
      for (int d = degree; d >= 0; d--) {
        a[d] = ((d > 0 ? a[d - 1] : 0) - r->node[j] * a[d]) / gap;
      }
    }
    for (int i = 0; i < points; i++) {
      r->value[i][k] = polynomial(a, n - 1, r->c[i], &r->integral[i][k]);
    }
    polynomial(a, n - 1, 1, &r->whole[k]);
  }
}

void lag_rule_gauss(lag_rule *r, int u)
{
  *r = (lag_rule){.points = u, .free = u};
  lag_gauss_points(u, r->c, r->b);
  memcpy(r->node, r->c, sizeof r->node);
  fill(r);
}

void lag_rule_lobatto(lag_rule *r, int u)
{
  double weights[LAG_RULE_FREE];

  *r = (lag_rule){.points = u + 1, .free = u};
  lobatto(u + 1, r->c, r->b);
  lag_gauss_points(u, r->node, weights);
  fill(r);
}

void lag_rule_euler(lag_rule *r, double c)
{
  *r = (lag_rule){.points = 1, .free = 1, .c = {c}, .b = {1}, .node = {0.5}};
  fill(r);
}
