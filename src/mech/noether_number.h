/* Numbers that depend on parameters, recognised: c * product of parameters^e, c rational or the
 * root of a rational, e halves of integers. */
#ifndef LAGC_NOETHER_NUMBER_H
#define LAGC_NOETHER_NUMBER_H

#include "mech/eqns.h"

/* Choices of values for the parameters that L and the constraints contain: two at random, and the first one with each parameter in turn a
 * hundredth larger, which shows the exponents of a monomial without any error of truncation. */
typedef struct {
  const Eqns *e;
  uint32_t n;                /* of parameters in question */
  const SymId *param;        /* [n] */
  long double *const *at;    /* [2 + n] values by symbol */
} Choices;

enum { CHOICE_FIRST, CHOICE_SECOND, CHOICE_MOVED };

/* attempt 0, or other random values, the second ones near the first: where motions oscillate for some values of the parameters only. */
Choices choices_new(Arena *a, const Eqns *e, uint32_t attempt);

/* The rational p/q that x is, to its digits, with q small against them; 0: it is none. */
int rational_of(long double x, Num *out);

/* The same with a power of one parameter, or with the ratio or product of two, from the first two choices alone. */
Expr ratio_of(const Choices *c, const long double *value);

/* A sum of parameters times small fractions, and of such a fraction: m1 + m2. 0: none takes these values, 2 + n of them. */
Expr linear_of(const Choices *c, const long double *value);

/* The same over a parameter, or over none: (k + 2 c)/m. */
Expr quotient_of(const Choices *c, const long double *value);

/* A rational times a power of `rate`, an expression of parameters: -2, -1, 1 or 2. */
Expr power_of(const Choices *c, const long double *value, Expr rate);

/* What ratio_of knows, times such a power of `rate`. */
Expr ratio_with(const Choices *c, const long double *value, Expr rate);

/* value[choice], 2 + n of them. 0: no such monomial takes these values. */
Expr monomial_of(const Choices *c, const long double *value);

/* The value of an expression of parameters at a choice. */
long double choice_value(const Choices *c, uint32_t choice, Expr e);

#endif
