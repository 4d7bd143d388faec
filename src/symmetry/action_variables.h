/* Action variables of the scene's start: J = 1/(2 pi) closed integral p dq along the curve H(q, p) = E of each coordinate, in numbers.
 *
 * A coordinate has a curve of its own where H separates (symmetry/separability.h): the other pairs are held at the start. Cyclic coordinates have p constant.
 *
 * q = (a + b)/2 + (b - a)/2 sin(u) between the turning points a, b leaves no square roots at the ends: the integrand is smooth and periodic in u, and the
 * midpoint rule converges exponentially. Long double, about 1e-15.
 * L. D. Landau, E. M. Lifshitz, Mechanics, 3rd ed. (1976), 48 to 50; V. I. Arnold, Mathematical Methods of Classical Mechanics, 2nd ed. (1989), 50.
 * L. N. Trefethen, J. A. C. Weideman, SIAM Rev. 56 (2014) 385, doi:10.1137/130932132, on the midpoint rule. */
#pragma once

#include "symmetry/separability.h"

typedef struct {
  const char *why_not;     /* reason for no action; NULL: there is one */
  int cyclic;              /* J is the momentum */
  int rests;               /* at an equilibrium: J = 0 */
  long double J;           /* SI */
  int digits;              /* of J and omega, up to 16: fewer where H has a corner along the curve */
  long double omega;       /* dE/dJ at fixed other actions; NAN: not computed */
  long double low, high;   /* turning points */
} ActionVariable;

typedef struct {
  const PhaseSpace *space;
  const ActionVariable *at; /* [space->n] */
  Separation separation;
  long double E;            /* H at the start */
} ActionVariables;

/* 0, reported in the diagnostics: H has no closed form in coordinates and momenta. */
int action_variables(Eqns *e, ActionVariables *out);
