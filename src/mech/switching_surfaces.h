/* Switching surfaces: where a force jumps with the velocities or states, as dry friction and relays do.
 *
 * If both sides lead back to such a surface, the motion slides on it (A.F. Filippov, Differential Equations with Discontinuous Righthand Sides
 * (1988), DOI 10.1007/978-94-015-7793-9), which the equations do not describe. The runtime detects that with the switching functions.
 * Jumps at positions or times alone do not count: a motion passes through them. */
#ifndef LAGC_SWITCHING_SURFACES_H
#define LAGC_SWITCHING_SURFACES_H

#include "mech/eqns.h"

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

#endif
