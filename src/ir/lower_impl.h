/* Shared by lower.c (expressions) and lower_blocks.c (the linear system). */
#ifndef LAGC_LOWER_IMPL_H
#define LAGC_LOWER_IMPL_H

#include "ir/lower.h"
#include "ir/solve.h"

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  Prog *p;
  ExprMap slots;   /* node -> slot + 1 */
  ExprMap circular; /* u -> 1 where sin u or cos u is needed anyway */
  int direct;       /* sin(a - b) is computed as it stands: for series, it is cheaper than the addition theorem */
} Lower;

/* Lowers all nodes that the roots need; then lower_slot gives each root's slot. */
void lower_roots(Lower *l, const Expr *roots, uint32_t n);
Slot lower_slot(const Lower *l, Expr e);

/* Lowers M and f; the blocks of coupled coordinates. e->n > 0. */
const Block *lower_blocks(Lower *l, uint32_t *n);

/* Lowers M q'' = f and its solution; acc[n] receives the slots of q''. */
void lower_solution(Lower *l, Slot *acc);

#endif
