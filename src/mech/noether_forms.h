/* Coordinates in which L is simple, read off its text: y = S q + s with fractions S and s, sums of coordinates that L is written with, in which the
 * kinetic energy is a sum of squares. In them the search for symmetries meets the small numbers that it would have met had the model been
 * written in them; exact arithmetic takes its results to the model's own coordinates, where the same numbers have twenty digits. */
#ifndef LAGC_NOETHER_FORMS_H
#define LAGC_NOETHER_FORMS_H

#include "mech/eqns.h"

typedef struct {
  uint32_t n;
  Num *S, *inverse; /* [n*n], row by row; exact */
  Num *shift;       /* [n] */
} LinearForms;

/* v[n], q[n]: velocities and coordinates of e, whose mass matrix is known and constant. NULL: L is not written with n such sums, or not with fractions
 * that 64 bits hold, or the mass matrix is not diagonal in them. In `a`. */
const LinearForms *forms_new(Arena *a, const Eqns *e, const SymId *q, const SymId *v, uint32_t n);

/* Coefficients of xi, affine in y, become those of xi, affine in q: c[n + n*n], of 1 for each xi, then of each coordinate for each xi. */
void forms_to_coordinates(const LinearForms *f, ExprGraph *g, Expr *c);

#endif
