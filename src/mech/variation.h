/* What discrete mechanics needs of L beside M q'' = f: its first derivatives, the forces that are in no L, and the second
 * derivatives of all of them. Derived when a method of integration calls for it. */
#ifndef LAGC_VARIATION_H
#define LAGC_VARIATION_H

#include "mech/eqns.h"

/* Which second derivative: of L by two of q and q', of the generalised force Q by one of them. Of QQ and VV the lower
 * triangle; the row of VQ is that of the velocity. */
typedef enum { SECOND_QQ, SECOND_VQ, SECOND_VV, SECOND_FQ, SECOND_FV, SECOND_PARTS } SecondPart;

typedef struct {
  SecondPart part;
  uint32_t row, col;
  Expr e;
} SecondEntry;

typedef struct {
  const Expr *dLdq;        /* [n] */
  const Expr *momenta;     /* [n] dL/dq' */
  const Expr *forces;      /* [n] Q: of force and dissipation statements */
  VEC(SecondEntry) second; /* what is not zero, part by part; in a sparse model diagonal by diagonal, else row by row */
} Variation;

/* Needs coordinates. */
Variation *variation_derive(const Eqns *e);

#endif
