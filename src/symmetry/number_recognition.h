/* Recognition of numbers that depend on parameters: c * product of parameters^e, c rational or the root of a
 * rational, e halves of integers. */
#pragma once

#include "mech/eqns.h"

/* Sample values of the parameters in L and the constraints: two random choices, and the first one with each
 * parameter in turn a hundredth larger, which shows the exponents of a monomial without truncation error. */
typedef struct {
  const Eqns *e;
  uint32_t n;                /* number of these parameters */
  const SymId *param;        /* [n] */
  long double *const *at;    /* [2 + n] values by symbol */
} Choices;

enum { CHOICE_FIRST, CHOICE_SECOND, CHOICE_MOVED };

/* attempt 0; or other random values, the second choice near the first, for motions that oscillate for some values of
 * the parameters only. moved 0: the first two choices alone. */
Choices choices_new(Arena *a, const Eqns *e, uint32_t attempt, int moved);

/* x as a rational p/q that is short against the digits of x; 0: it is none. */
int recognise_rational(long double x, Num *out);

/* From the first two choices alone: 0, a rational, a rational times p or 1/p of one parameter or times a ratio or
 * product of two, or a rational or such a product times rate^e for one of n rates, expressions of parameters, e =
 * -2, -1, 1 or 2; 0: none. */
Expr recognise_by_two(const Choices *c, const long double *value, const Expr *rate, uint32_t n);

/* A sum of parameters times small fractions, plus a fraction (m1 + m2), from value[2 + n]; 0: none takes these
 * values. */
Expr recognise_linear(const Choices *c, const long double *value);

/* Such a sum over a parameter, or over none: (k + 2 c)/m. */
Expr recognise_quotient(const Choices *c, const long double *value);

/* The monomial with these values at all 2 + n choices; 0: none. */
Expr recognise_monomial(const Choices *c, const long double *value);

/* The value of an expression of parameters at a choice. */
long double choice_value(const Choices *c, uint32_t choice, Expr e);
