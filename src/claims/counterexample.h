/* Refutation of an expectation by value: a state at which both sides are defined and differ. */
#pragma once

#include "mech/eqns.h"

typedef struct {
  const char *text; /* "the left side is 1, the right side 2 at x = 1"; NULL: none was found, and then: */
  int states;       /* number of states compared */
  int digits;       /* digits to which the sides agree at states of ordinary size */
  const char *missing; /* a side of a switch that no state was on, see claims/branch_coverage.h; NULL: none */
} Counterexample;

/* Tries simple states, random ones, states from 1e-6 to 1e12 in size, and whole numbers. The sides differ where the
 * difference exceeds 16 times the bound of all rounding, the state's included. quick: a few simple and random states
 * only. */
Counterexample counterexample_find(const Eqns *e, const Expect *x, int quick);
