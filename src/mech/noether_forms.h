/* Coordinates in which L is simple, read off its text: y = S q + s with constants S and s, sums of coordinates that L is written with, in which the
 * kinetic energy is a sum of squares. In them the search for symmetries meets the small numbers that it would have met had the model been
 * written in them, and proofs and charges are short; exact arithmetic takes generators to the model's own coordinates, where the same numbers
 * have twenty digits. */
#ifndef LAGC_NOETHER_FORMS_H
#define LAGC_NOETHER_FORMS_H

#include "mech/eqns.h"
#include "sym/prove.h"

typedef struct {
  uint32_t n;
  Expr *S, *inverse;   /* [n*n], row by row: numbers, and constants made of parameters */
  const Num *exact;    /* S where it is made of numbers; or NULL */
  Expr *shift;         /* [n] */
  Expr *y, *rate;      /* [n] y and y' as they stand in the text, or as sums */
  Name *name;          /* [n] what the text calls y, where named is set: lets and coordinates */
  int named;
  SymId *q;            /* [2*n] coordinates, then velocities */
  Expr L, *p, *mass;   /* L and [n] momenta in y and y', for which the symbols q stand; the coefficients of y' in p */
  VEC(Expr) node, is;  /* sums of the text, coordinates and velocities; and what they are in y, for which the symbols of q stand then */
} LinearForms;

/* Of the coordinates of e, in `a`. NULL: none are needed, as the mass matrix is diagonal, or none are known: it varies, or is not known; a coordinate
 * has a sign; L is not written with n such sums, or the mass matrix is not diagonal in them. */
const LinearForms *forms_new(Arena *a, const Eqns *e);

/* Whether the mass matrix is constant and not diagonal, and nothing but L says what coordinates are: the search needs other ones. */
int forms_are_needed(const Eqns *e);

/* x, in which the symbols of q stand for y and y', as the text has it. */
Expr forms_back(const LinearForms *f, ExprGraph *g, Expr x);

/* Whether x, a function of q and q', is 0: as it is, or, where that is too long, as the function of y and y' that it is, which is short where it is written
 * with those sums. f NULL: there are none. */
Verdict forms_prove_zero(const LinearForms *f, ExprGraph *g, Expr x);

/* Coefficients of xi, affine in y, become those of xi, affine in q: c[n + n*n], of 1 for each xi, then of each coordinate for each xi. */
void forms_to_coordinates(const LinearForms *f, ExprGraph *g, Expr *c);

/* x[n*columns] becomes m^-1 x for numbers m[n*n], term by term, without rounding. 0: m has no inverse, or numbers are too long. */
int forms_solve(Arena *a, ExprGraph *g, uint32_t n, const Num *m, uint32_t columns, Expr *x);

#endif
