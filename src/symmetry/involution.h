/* Charges in involution: a largest set, among those known, whose gradients are independent and whose Poisson
 * brackets with one another are 0. With n of them for n degrees of freedom the motion is integrable in Liouville's
 * sense. J. Liouville, J. Math. Pures Appl. 20 (1855) 137; V. I. Arnold, Mathematical Methods of Classical
 * Mechanics, 2nd ed. (1989), 49.
 *
 * Known are the conserved charges of the report that are free of t, sums of the squares of three angular momenta,
 * and functions that the model declares: operands of brackets in expectations, observed quantities, charges of
 * declared symmetries; declared ones count where {f, H} = 0 is proved, and f is free of inputs and does not jump, as
 * an angle of atan2 does. A charge that is not the same after a turn of a periodic coordinate is none. Ranks are
 * numbers, of gradients at random states; brackets are proved. */
#pragma once

#include "symmetry/polynomial_charges.h"

typedef enum {
  INVOLUTION_LISTED,  /* charge `number` of the report, from 0: symmetries, then charges of higher degree */
  INVOLUTION_SQUARES, /* the sum of squares of the charges of[3] */
  INVOLUTION_DECLARED /* a function of the model's text */
} InvolutionKind;

typedef struct {
  InvolutionKind kind;
  uint32_t number, of[3];
  const char *name; /* of a declared one; NULL: it has none */
  Expr charge;      /* as the report prints it */
} InvolutionCharge;

typedef struct {
  const char *why_not;     /* reason for no answer; or NULL */
  uint32_t n;              /* degrees of freedom */
  uint32_t independent;    /* rank of the gradients of all known charges */
  uint32_t left_out;       /* known charges that are not looked at: beyond the first few hundred, or for want of time */
  /* 0, or the number of tries after which the search ended before its end: larger sets may exist */
  uint32_t steps;
  const char *stopped; /* or: how to go on where time ended it */
  VEC(InvolutionCharge) all; /* the set; integrable: n of them */
} Involution;

/* polynomial: NULL, or charges of higher degree. */
Involution *involution_find(Eqns *e, const FoundSymmetries *found, const PolynomialCharges *polynomial,
                            SearchLimit *limit);
