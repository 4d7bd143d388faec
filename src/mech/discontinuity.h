/* Warnings for a discontinuous L: equations of motion and charges come from derivatives of its branches and lack impulses at the jumps.
 *
 * The motion goes through a jump as if there were none. That is right where L jumps at a time, as with a switched force. An impulse is missing
 * where L jumps with coordinates or velocities, or where a momentum jumps. A charge is conserved, or balanced, between jumps only, if the charge
 * itself jumps or its symmetry moves the places where L does. A constraint whose rate jumps has a corner, at which no equation holds. */
#pragma once

#include "mech/eqns.h"
#include "sym/jump.h"

/* The jumps of x, with inputs replaced by their formulas. */
ExprJumps discontinuities_of(const Eqns *e, Expr x);

/* Switching surfaces: where a force jumps with the velocities or states, as dry friction and relays do.
 *
 * If both sides lead back to such a surface, the motion slides on it (A.F. Filippov, Differential Equations with Discontinuous Righthand Sides
 * (1988), DOI 10.1007/978-94-015-7793-9), which the equations do not describe. The runtime detects that with the switching functions.
 * Jumps at positions or times alone do not count: a motion passes through them. */
typedef struct {
  Expr side;        /* switching function: 0 on the surface */
  int nonnegative;  /* it does not change sign there, as the speed in v/|v| */
  Span span;        /* of the jumping expression in the text, or of its statement */
  const char *text, *surface; /* "sign(x')", "x'" */
} SwitchingSurface;

typedef struct {
  const SwitchingSurface *at;
  uint32_t n;
} SwitchingSurfaces;

/* Switching surfaces of the forces and flows of a model with at most 64 coordinates and states; none for larger models. */
SwitchingSurfaces switching_surfaces(const Eqns *e);

/* Warns of each place in the text where L, a momentum, a constraint's rate or a force jumps and the equations do not tell what follows. */
void discontinuity_warn(const Eqns *e);
