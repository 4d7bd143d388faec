/* The kinetic part of L where it is a sum of squares of forms that are linear in velocities, sum c_k (W_k q' + w_k)^2/2, so that M = W^T C W.
 *
 * To multiply that out squares the condition of W: of a body in Euler's angles M is singular to 1e-16 at 1e-8 from the pole already, W there to 1e-8. */
#ifndef LAGC_SQUARES_H
#define LAGC_SQUARES_H

#include "mech/eqns.h"

/* None (n = 0) where L is not such a sum, and where it does not matter: M is constant, large, or becomes singular at no state that is tried, or
 * only along one coordinate, whose inertia vanishes without a difference (r^2 of polar coordinates). Of a mass matrix that is derived, and definite. */
SquareForms squares_of(const Eqns *e);

/* A state where M is singular: coordinate i at so many quarters of a turn, whatever the others are. */
typedef struct {
  uint32_t coordinate;
  int quarters;
} MassPole;

/* Looks at 0 and at quarters of a turn of each of up to 8 coordinates. 0: there is none among these, or M is constant or not derived. */
int mass_pole(const Eqns *e, MassPole *pole);

#endif
