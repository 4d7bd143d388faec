/* Expectations: equations that a person wrote, proved or refuted with M q'' = f as what is known. */
#ifndef LAGC_EXPECT_H
#define LAGC_EXPECT_H

#include "mech/eqns.h"

typedef enum {
  EXPECT_PROVED,  /* for all states at which both sides have real values */
  EXPECT_REFUTED, /* at some state both sides have real values, and these differ */
  EXPECT_AGREES, /* not decided by the prover; the sides agree as far as rounding lets one see */
  EXPECT_UNKNOWN /* not decided, and no state tried gives the sides values that mean something */
} ExpectVerdict;

typedef struct {
  const char *label; /* "th1'' (form_a)" */
  Span span;
  ExpectVerdict verdict;
  int digits; /* of agreement */
  int states; /* at which the sides were compared */
  const char *missing; /* what no state that was compared showed; NULL: nothing, or none was compared */
  const char *difference; /* of a refuted one: both values, and a state that has them */
  int inexact; /* a number in the sides, or in the equations, is not exact: that is why it is not decided */
} ExpectResult;

typedef VEC(ExpectResult) ExpectResults;

/* Judges the expectations that stand in `effect` (NULL: in none) and appends the verdicts. A false
 * one is an error in the model's diagnostics, with the edit that would mend it where there is a
 * single one; one that is not decided is an error too, or a warning when allow_numeric. */
void expects_check(const Eqns *e, Name effect, int allow_numeric, ExpectResults *out);

/* A line each, and a summary; nothing when there are none. */
void expects_print(const ExpectResults *r, const Sources *sources, StrBuf *out);

#endif
