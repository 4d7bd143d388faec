/* Jump discontinuities of an expression; its derivative holds on each side of a jump and does not show it.
 *
 * Candidates are read off the graph: comparisons, signs, branch cuts of atan2, poles of tan, divisors. A candidate
 * jumps if the difference of the expression between states on both sides stays constant as the states approach each
 * other. abs(x), max(x, y) and if(x > 0, x^2, 0) do not jump; a divergence to infinity is not reported, as no motion
 * passes through it. */
#pragma once

#include "sym/expr.h"

typedef struct {
  Expr node;                  /* cause of the jump: a comparison, a sign, ..., or a divisor */
  Expr side;                  /* switching function: crosses 0 at the jump */
  const long double *symbols; /* values of all symbols at one such place */
  long double by;             /* height of the jump there */
  long double slope;          /* derivative of `side` along the line on which the place was found */
} ExprJump;

typedef struct {
  const ExprJump *at;
  uint32_t n;
} ExprJumps;

/* Condition under which the derivatives of the roots by all but parameters and time exist, and are
 * those of the branches: u != 0 for sign(u), abs(u) and roots of u, floor(u) != u, |u| != 1 for
 * asin and acos, a != b for comparisons, min and max. 0: everywhere. *jumps (or NULL): 1 is set
 * where jumps or corners are among them. */
Expr expr_smooth_domain(ExprGraph *g, const Expr *roots, uint32_t n, int *jumps);

/* Jumps of x as a function of coordinates, velocities, states and time, one per causing node, in graph order.
 * Searched along 64 straight lines through random states and among the first 200 candidates: others may be missed.
 * */
ExprJumps expr_jumps(ExprGraph *g, Expr x);
