/* States that decide an expectation by value: one at which both sides are defined and differ shows that it is false. */
#ifndef LAGC_WITNESS_H
#define LAGC_WITNESS_H

#include "mech/eqns.h"

typedef struct {
  const char *text; /* "the left side is 1, the right side 2 at x = 1"; NULL: none was found, and then: */
  int states;       /* how many were compared */
  int digits;       /* to which the sides agree at those of ordinary size */
  const char *missing; /* what no state showed: see mech/seen_sides.h; NULL: nothing */
} Witness;

/* Looks at simple states, random ones, states from 1e-6 to 1e12 in size, whole numbers, and at both sides of places where a comparison, `min`,
 * `max`, `abs` or `sign` switches. The sides differ where they do by 16 times the bound of all rounding, of the state's too. quick: a few simple and random states only. */
Witness witness_find(const Eqns *e, const Expect *x, int quick);

#endif
