/* Where an expression jumps: derivatives of a graph are taken on each side of such a place, and say nothing of it.
 *
 * What can jump is read off the graph: comparisons, signs, branches of atan2, poles of tan, what is divided by. Whether it does is seen in
 * numbers: states on both sides of the place, ever closer to it, between which the difference of the expression stays what it is.
 * abs(x), max(x, y) and if(x > 0, x^2, 0) do not jump; nor does what runs off to infinity there, which no motion passes. */
#ifndef LAGC_JUMP_H
#define LAGC_JUMP_H

#include "sym/expr.h"

typedef struct {
  Expr node;                  /* that jumps: a comparison, a sign, ...; a divisor */
  Expr side;                  /* goes through a value there, by which the sides are told apart */
  const long double *symbols; /* at one such place */
  long double by;             /* how far the expression jumps there */
  long double slope;          /* of `side` along the line on which the place was found */
} ExprJump;

typedef struct {
  const ExprJump *at;
  uint32_t n;
} ExprJumps;

/* The places where x jumps when coordinates, velocities, states and time change, each node once, in the order of the graph. A place that
 * no straight line through some dozens of random states leads to may be missed, and of very many the later ones. */
ExprJumps expr_jumps(ExprGraph *g, Expr x);

#endif
