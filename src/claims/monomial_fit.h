/* Recognition of monomials: from the values of a quantity at many states, c * product of features^integers with
 * these values. */
#pragma once

#include "mech/eqns.h"
#include "sym/expr_eval.h"

enum { FEATURES_MAX = 44, FEATURE_STATES = FEATURES_MAX + 6 };

typedef struct Features Features;

/* features[0..n-1], preferred ones first (n <= FEATURES_MAX), at FEATURE_STATES states. A feature that vanishes
 * somewhere, or is a monomial of earlier ones, is left out. */
Features *features_new(ExprGraph *g, const Expr *features, uint32_t n, long double *const *states);

typedef struct {
  Expr e;
  Expr divisor;  /* 1/e, where e has no numerator; otherwise 0 */
  int mixed;     /* e has a numerator and a denominator */
  uint32_t size; /* number of factors; those of a denominator below a numerator count three times */
} Monomial;

/* The monomial with these values at the states; e = 0: there is none. Accelerations and sums with velocities are
 * kept out of denominators: solutions of M q'' = f have none such. */
Monomial features_fit(const Features *f, const long double *values);
