/* Coordinates in which L is simple, read off its text: y = S q + s with fractions S and s, sums of coordinates that L is written with, in which the
 * kinetic energy is a sum of squares. In them the search for symmetries meets the small numbers that it would have met had the model been
 * written in them; exact arithmetic takes its results to the model's own coordinates, where the same numbers have twenty digits. */
#ifndef LAGC_NOETHER_FORMS_H
#define LAGC_NOETHER_FORMS_H

#include "mech/eqns.h"
#include "sym/prove.h"

typedef struct {
  uint32_t n;
  Num *S, *inverse;    /* [n*n], row by row; exact */
  Num *shift;          /* [n] */
  VEC(Expr) node, is;  /* sums of the text, coordinates and velocities; and what they are in y, for which the symbols of q stand then */
} LinearForms;

/* Of the coordinates of e, in `a`. NULL: none are needed, as the mass matrix is diagonal, or none are known: it varies, or is not known; a coordinate
 * has a sign; L is not written with n such sums, or not with fractions that 64 bits hold, or the mass matrix is not
 * diagonal in them. */
const LinearForms *forms_new(Arena *a, const Eqns *e);

/* Whether the mass matrix is constant and not diagonal, and nothing but L says what coordinates are: the search needs other ones. */
int forms_are_needed(const Eqns *e);

/* Whether x, a function of q and q', is 0: as it is, or, where that is too long, as the function of y and y' that it is, which is short where it is written
 * with those sums. f NULL: there are none. */
Verdict forms_prove_zero(const LinearForms *f, ExprGraph *g, Expr x);

/* Coefficients of xi, affine in y, become those of xi, affine in q: c[n + n*n], of 1 for each xi, then of each coordinate for each xi. */
void forms_to_coordinates(const LinearForms *f, ExprGraph *g, Expr *c);

#endif
