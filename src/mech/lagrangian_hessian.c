/* Sparse gradients of dL/dq, p and Q, in short forms; entries ordered so that long families roll into loops. */
#include "mech/lagrangian_hessian.h"

#include <stdlib.h>

#include "mech/lagrange.h"
#include "sym/diff.h"

/* Adds the derivatives of of[i] by the symbols of a kind, up to symbol i for a lower triangle. */
static void add_rows(const Eqns *e, Variation *x, SecondPart part, const Expr *of, SymKind kind) {
  int triangle = part == SECOND_QQ || part == SECOND_VV;
  for (uint32_t i = 0; i < e->n; i++) {
    ExprPartials row = expr_gradient_sparse(e->g, of[i], kind, triangle ? i + 1 : e->n);
    for (uint32_t k = 0; k < row.n; k++)
      vec_push(e->m->arena, &x->second, ((SecondEntry){part, i, row.at[k].index, row.at[k].e}));
  }
}

/* With up to this many entries a coordinate, entries are ordered by diagonals: along one, the entries of a family
 * are alike and become a loop. Full matrices roll better row by row. */
enum { FEW_A_ROW = 8 };

static int by_diagonal(const void *a, const void *b) {
  const SecondEntry *x = a, *y = b;
  int64_t dx = (int64_t)x->row - x->col, dy = (int64_t)y->row - y->col;
  if (x->part != y->part) return (x->part > y->part) - (x->part < y->part);
  if (dx != dy) return (dx > dy) - (dx < dy);
  return (x->row > y->row) - (x->row < y->row);
}

/* Entries in short forms; zeros are dropped. */
static void shorten(const Eqns *e, Variation *x) {
  uint32_t n = x->second.n, kept = 0;
  Expr *raw = ARENA_ARRAY(e->m->arena, Expr, n + 1);
  for (uint32_t k = 0; k < n; k++) raw[k] = x->second.at[k].e;
  const Expr *best = lagrange_short_forms(e, raw, n);
  for (uint32_t k = 0; k < n; k++) {
    if (expr_is_zero(e->g, best[k])) continue;
    x->second.at[kept] = x->second.at[k];
    x->second.at[kept++].e = best[k];
  }
  x->second.n = kept;
}

Variation *lagrangian_hessian_derive(const Eqns *e) {
  Arena *arena = e->m->arena;
  Variation *x = ARENA_NEW(arena, Variation);
  Expr *first = ARENA_ARRAY(arena, Expr, 2 * e->n);
  for (uint32_t i = 0; i < e->n; i++) {
    first[i] = e->dLdq[i];
    first[e->n + i] = e->p[i];
  }
  add_rows(e, x, SECOND_QQ, e->dLdq, SYM_COORD);
  add_rows(e, x, SECOND_VQ, e->p, SYM_COORD);
  add_rows(e, x, SECOND_VV, e->p, SYM_VEL);
  add_rows(e, x, SECOND_FQ, e->Q, SYM_COORD);
  add_rows(e, x, SECOND_FV, e->Q, SYM_VEL);
  shorten(e, x);
  if (x->second.n && x->second.n <= FEW_A_ROW * e->n)
    qsort(x->second.at, x->second.n, sizeof *x->second.at, by_diagonal);
  x->dLdq = lagrange_short_forms(e, first, 2 * e->n);
  x->momenta = x->dLdq + e->n;
  x->forces = e->Q;
  return x;
}
