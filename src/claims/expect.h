/* Expectations: equations that the user wrote, proved or refuted by the equations of motion M q'' = f. */
#pragma once

#include "claims/case_proofs.h"
#include "mech/eqns.h"

typedef enum {
  EXPECT_PROVED,  /* for all states at which both sides have real values */
  EXPECT_REFUTED, /* at some state both sides have real values, and these differ */
  EXPECT_AGREES, /* not decided by the prover; the sides agree to the digits that rounding leaves */
  EXPECT_UNKNOWN /* not decided: no state gives the sides meaningful values, or `missing` was never seen */
} ExpectVerdict;

typedef struct {
  const char *label; /* "th1'' (form_a)" */
  Span span;
  ExpectVerdict verdict;
  int digits; /* digits to which the sides agree */
  int states; /* number of states at which the sides were compared */
  /* a side of a switch, or a proved difference, that no compared state showed; NULL: none, or no state was compared */
  const char *missing;
  const char *difference; /* if refuted: both values, and a state that has them */
  int between; /* holds between jumps of what its brackets contain */
  int inexact; /* a number in the sides or in the equations is not exact, which may be why it is not decided */
} ExpectResult;

typedef VEC(ExpectResult) ExpectResults;

/* Verdict on one equation without contacts, reported nowhere. Of a claim that stands in no text, lhs_ast is 0 and
 * `name` its label. */
ExpectResult expect_judge(const Eqns *e, const CaseSymbols *symbols, const Expect *x);

/* Judges the expectations declared in `effect` (NULL: outside effects) and appends the verdicts. A refuted one is an
 * error in the model's diagnostics, with the single edit that corrects it if there is one; one that is not decided
 * is an error too, or, where the sides agree in numbers and allow_numeric is set, a warning. */
void expects_check(const Eqns *e, Name effect, int allow_numeric, ExpectResults *out);

/* Appends a line for each expectation and a summary; nothing when there are none. */
void expects_print(const ExpectResults *r, const Sources *sources, StrBuf *out);

/* canonical_claims.c: whether a canonical transformation is one: the Poisson brackets of its map,
 * or the mixed Hessian of its generating function, and the agreement of all that is given.
 * Otherwise reported, with the bracket that is wrong. *how: the proof, in words. Holds between
 * jumps of its functions, which *how then says. */
int canonical_holds(Eqns *e, const Canonical *c, const CaseSymbols *symbols, const char **how);

/* Judges all canonical transformations, and appends a line for each that holds. */
void canonicals_check(Eqns *e, StrBuf *out);

/* mobility.c: appends the degrees of freedom and a line for each constraint: its kind, and whether it is redundant.
 * Nothing without constraints. 0, reported in the model's diagnostics, when no motion is possible from the start
 * that the scene gives: no state near it obeys the constraints, redundant ones disagree, M is singular on their
 * kernel, or a contact is violated. */
int mobility_show(const Eqns *e, StrBuf *out);
