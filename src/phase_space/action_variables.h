/* Action variables of the scene's start: J = 1/(2 pi) closed integral p dq along the curve H(q, p) = E of each
 * coordinate, in numbers.
 *
 * A coordinate has a curve of its own where H separates (phase_space/separability.h): the other pairs are held at
 * the start. Cyclic coordinates have p constant.
 *
 * The integral is numeric/action_integral.h's, which runs use for outputs `action(x)`
 * (phase_space/action_outputs.h). Long double, about 1e-15. */
#pragma once

#include "phase_space/separability.h"

typedef struct {
  const char *why_not;     /* reason for no action; NULL: there is one */
  int cyclic;              /* J is the momentum */
  int rests;               /* at an equilibrium: J = 0 */
  int rotates;              /* it goes round: J is the mean of p over a turn, omega has its sign */
  long double J;           /* SI */
  /* of J and omega, up to 16: fewer where H has a corner along the curve, omega's beside a separatrix */
  int digits, omega_digits;
  long double omega;       /* dE/dJ at fixed other actions; NAN: not computed */
  long double low, high;   /* turning points, or ends of a turn */
} ActionVariable;

typedef struct {
  const PhaseSpace *space;
  const ActionVariable *at; /* [space->n] */
  Separation separation;
  long double E;            /* H at the start */
} ActionVariables;

/* 0, reported in the diagnostics: H has no closed form in coordinates and momenta. */
int action_variables(Eqns *e, ActionVariables *out);

/* Of pair i of a phase space, whose H is free of definitions: */
/* *why_not: NULL, or the reason for no action at any state */
PairKind pair_with_action(const PhaseSpace *s, uint32_t i, const char **why_not);
/* roots[4]: H, dH/dp, d2H/dp2, dH/dq */
void action_roots(const PhaseSpace *s, uint32_t i, Expr *roots);
