/* Coordinates y = S q + s, S and s constant, in which the kinetic energy is a sum of squares: they are sums of coordinates in the text of L. The
 * search in y meets the small numbers that it would have met had the model been written in y, and proofs and charges are short; exact arithmetic
 * takes generators back to the model's own coordinates, where the same numbers have twenty digits. */
#ifndef LAGC_SYMMETRY_LINEAR_FORMS_H
#define LAGC_SYMMETRY_LINEAR_FORMS_H

#include "mech/eqns.h"
#include "sym/prove.h"

typedef struct {
  uint32_t n;
  Expr *S, *inverse;   /* [n*n], row by row: numbers, and constants made of parameters */
  const Num *exact;    /* S as exact numbers; NULL: S contains parameters */
  Expr *shift;         /* [n] s */
  Expr *y, *rate;      /* [n] y and y' as they stand in the text, or as sums */
  Name *name;          /* [n] names of y in the text (lets and coordinates), set where named is 1 */
  int named;
  SymId *q;            /* [2*n] coordinates, then velocities */
  Expr L, *p, *mass;   /* L, [n] momenta, [n] coefficients of y' in these; in y and y', written with the symbols of q */
  VEC(Expr) node, is;  /* sums of the text, coordinates and velocities; the same in y, with the symbols of q */
} LinearForms;

/* Coordinates y of a model, allocated in `a`. NULL: none are needed, as M is diagonal; or none are known: M varies or is not known, a coordinate
 * has a sign, L is not written with n such sums, or M is not diagonal in them. */
const LinearForms *forms_new(Arena *a, const Eqns *e);

/* Whether the search needs such coordinates: M is constant and not diagonal, and no coordinate has a declared sign. */
int forms_are_needed(const Eqns *e);

/* x(y, y'), written with the symbols of q, as an expression of the text in q and q'. */
Expr forms_back(const LinearForms *f, ExprGraph *g, Expr x);

/* Whether x(q, q') is 0: as it stands or, if that is not decided, rewritten in y and y', where it is short. f may be NULL. */
Verdict forms_prove_zero(const LinearForms *f, ExprGraph *g, Expr x);

/* Converts coefficients of xi affine in y to xi affine in q, in place: c[n + n*n], the constants of all xi, then the row of each xi. */
void forms_to_coordinates(const LinearForms *f, ExprGraph *g, Expr *c);

/* Solves m x = b exactly and in place: x[n*columns] are constants, taken term by term, m[n*n] numbers. 0: m has no inverse, or numbers are too
 * long. */
int forms_solve(Arena *a, ExprGraph *g, uint32_t n, const Num *m, uint32_t columns, Expr *x);

#endif
