/* Derivatives for variational integrators (discrete mechanics): first derivatives of L, generalised forces, and the
 * second derivatives of L and first derivatives of the forces. Derived when a method of integration needs them. */
#pragma once

#include "mech/eqns.h"

/* Kinds of entries: d2L/dq dq, d2L/dq' dq, d2L/dq' dq', dQ/dq, dQ/dq'. QQ and VV are lower triangles; a row of VQ
 * belongs to a velocity. */
typedef enum { SECOND_QQ, SECOND_VQ, SECOND_VV, SECOND_FQ, SECOND_FV } SecondPart;

typedef struct {
  SecondPart part;
  uint32_t row, col;
  Expr e;
} SecondEntry;

typedef struct {
  const Expr *dLdq;        /* [n] */
  const Expr *momenta;     /* [n] dL/dq' */
  const Expr *forces;      /* [n] Q of force and dissipation statements */
  VEC(SecondEntry) second; /* nonzero entries, part by part; in a sparse model diagonal by diagonal, else row by row */
} Variation;

/* Needs coordinates. */
Variation *lagrangian_hessian_derive(const Eqns *e);
