/* The kinetic part of L where it is a sum of squares of forms that are linear in velocities, sum c_k (W_k q' +
 * w_k)^2/2, so that M = W^T C W.
 *
 * Multiplying M out squares the condition number of W. For a body in Euler angles, at 1e-8 from the pole M is
 * singular to 1e-16, W to 1e-8 only. */
#pragma once

#include "mech/eqns.h"

/* The forms, for a mass matrix that is derived and definite. n = 0 where L is no such sum or M loses no digits: M is
 * constant or large, or singular at no state tried, or along one coordinate only, whose inertia then vanishes
 * without cancellation (r^2 of polar coordinates). */
SquareForms kinetic_squares(const Eqns *e);

/* A coordinate singularity: M is singular where the coordinate is at this many quarters of a turn, whatever the
 * other coordinates are. */
typedef struct {
  uint32_t coordinate;
  int quarters;
} MassPole;

/* Tries 0 and quarters of a turn for each of up to 8 coordinates. 0: M is regular at all of them, or is constant or
 * not derived. */
int mass_pole(const Eqns *e, MassPole *pole);
