/* Recognising numbers: from the values of a quantity at many states, the monomial
 * c * product of features^integers that takes them. */
#ifndef LAGC_MONOMIAL_H
#define LAGC_MONOMIAL_H

#include "mech/eqns.h"
#include "sym/eval.h"

enum { FEATURES_MAX = 44, FEATURE_STATES = FEATURES_MAX + 6 };

typedef struct Features Features;

/* features[0..n-1] (n <= FEATURES_MAX, the ones to prefer first) at the given states, of which there
 * are FEATURE_STATES. A feature that is a monomial of earlier ones, or that vanishes somewhere, is
 * left out. */
Features *features_new(ExprGraph *g, const Expr *features, uint32_t n, long double *const *states);

typedef struct {
  Expr e;
  Expr divisor;  /* 1/e, where that is all there is to it; otherwise 0 */
  int mixed;     /* it has a numerator and a denominator */
  uint32_t size; /* factors; those of a denominator below a numerator count three times */
} Monomial;

/* The monomial with these values at the states; e = 0 when there is none. Nothing is
 * divided by accelerations or by sums with velocities: solutions of M q'' = f have no such denominators. */
Monomial features_fit(const Features *f, const long double *values);

/* The rational with a small denominator that x is, to 10 digits; 0 when there is none. */
int small_rational(long double x, Num *out);

#endif
