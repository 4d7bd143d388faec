/* The cut of a sum over neighbours. */
#pragma once

#include "mech/eqns.h"

typedef struct {
  long double value, force; /* of a pair at the cut, with the scene's parameters; 0: it vanishes there */
} NearCut;

/* value: a share of s, which has a test. */
NearCut near_cut(const Eqns *e, const SumNest *s, Expr value);
