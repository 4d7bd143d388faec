/* Where a force jumps with the velocities: dry friction and relays.
 *
 * Both sides of such a surface may lead back to it, and then the motion stays there (A.F. Filippov, Differential Equations with Discontinuous
 * Righthand Sides (1988), DOI 10.1007/978-94-015-7793-9): in no equation, and no step leaves it. The runtime looks for that with the
 * switching functions. Surfaces of positions alone are none: what meets one goes through. */
#ifndef LAGC_SWITCHING_SURFACES_H
#define LAGC_SWITCHING_SURFACES_H

#include "mech/eqns.h"

typedef struct {
  Expr side;        /* the switching function: the surface is where it is 0 */
  int nonnegative;  /* it does not change its sign there, as the speed in v/|v| */
  Span span;        /* of what jumps, in the text; of the statement with it */
  const char *text, *surface; /* "sign(x')", "x'" */
} SwitchingSurface;

typedef struct {
  const SwitchingSurface *at;
  uint32_t n;
} SwitchingSurfaces;

/* The switching functions of the forces and flows of a model with at most 64 coordinates and states; none of a larger one. */
SwitchingSurfaces switching_surfaces(const Eqns *e);

#endif
