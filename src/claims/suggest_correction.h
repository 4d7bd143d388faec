/* Correction of a false expectation: the single edit that makes it provable, and its place in the text. */
#pragma once

#include "mech/eqns.h"

typedef struct {
  Span caret;
  /* "`sin(th1)` should be `cos(th1)`"; NULL: no single edit was found, and the caret is at the right side */
  const char *edit;
} SuggestedEdit;

/* Needs an expectation that does not hold. An edit that it returns is proved to correct it. */
SuggestedEdit suggest_correction(const Eqns *e, const Expect *x);
