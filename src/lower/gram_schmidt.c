/* M q'' = f in straight-line code where M = W^T C W is almost singular somewhere (mech/kinetic_squares.h). Modified
 * Gram-Schmidt in the metric C (A. Bjorck, BIT 7 (1967) 1, DOI 10.1007/BF01934122) gives the factors of M = L D L^T
 * from W itself: their errors grow with the condition of W, in elimination of M with its square. */
#include "lower/lower_impl.h"

typedef struct {
  Lower *l;
  const SquareForms *s;
  uint32_t n;
  Slot *w;           /* [s->n * n] the columns of W; a column is orthogonal to the earlier ones when its step begins */
  Slot *b, *pivot;   /* [n] */
  SparseRow *below;  /* [n] the columns of L below the diagonal */
} Gram;

/* Inner product sum over k of weighted[k] W[k][u]. */
static Slot product(const Gram *y, const Slot *weighted, uint32_t u) {
  Slot sum = 0;
  for (uint32_t k = 0; k < y->s->n; k++) sum = prog_add_product(y->l->p, sum, weighted[k], y->w[k * y->n + u]);
  return sum;
}

/* Gram-Schmidt step for column v: subtracts from the columns in `later`, and from b, their parts along v. */
static void orthogonalise_by(Gram *y, uint32_t v, const uint32_t *later, uint32_t nlater) {
  Slot *weighted = ARENA_ARRAY(y->l->p->arena, Slot, y->s->n);
  for (uint32_t k = 0; k < y->s->n; k++) weighted[k] = op(y->l, IR_MUL, lower_slot(y->l, y->s->weight[k]),
                                                          y->w[k * y->n + v]);
  Slot d = y->pivot[v] = product(y, weighted, v);
  lower_name(y->l, d, "D", v, UINT32_MAX);
  lower_pivot(y->l, d, 1);
  for (uint32_t i = 0; i < nlater; i++) {
    uint32_t u = later[i];
    Slot f = op(y->l, IR_DIV, product(y, weighted, u), d);
    if (!f) continue;
    lower_name(y->l, f, "L", v, u);
    for (uint32_t k = 0; k < y->s->n; k++)
      y->w[k * y->n + u] = prog_sub_product(y->l->p, y->w[k * y->n + u], f, y->w[k * y->n + v]);
    y->b[u] = prog_sub_product(y->l->p, y->b[u], f, y->b[v]);
    vec_push(y->l->p->arena, &y->below[v], ((SparseEntry){u, f}));
  }
}

void lower_gram_schmidt(Lower *l, Slot *acc) {
  const Eqns *e = l->e;
  Arena *a = l->p->arena;
  uint32_t n = e->n;
  const uint32_t *order = e->system.order;
  Gram y = {.l = l,
            .s = &e->squares, .n = n, .w = ARENA_ARRAY(a, Slot, (size_t)e->squares.n * n), .b = ARENA_ARRAY(a, Slot, n),
            .pivot = ARENA_ARRAY(a, Slot, n),
            .below = ARENA_ARRAY(a, SparseRow, n)};
  for (uint32_t k = 0; k < y.s->n * n; k++) y.w[k] = y.s->W[k] ? lower_slot(l, y.s->W[k]) : 0;
  for (uint32_t i = 0; i < n; i++) {
    y.b[i] = lower_slot(l, e->system.f[i]);
    lower_name(l, y.b[i], "f", i, UINT32_MAX);
  }
  prog_title(l->p, "M q'' = f, M = W^T C W by orthogonal columns of W");
  for (uint32_t k = 0; k < n; k++) orthogonalise_by(&y, order[k], order + k + 1, n - k - 1);
  FactorRecord factors = {.n = n,
                          .straight = 1, .order = order, .pivot = y.pivot, .below = y.below,
                          .C = ARENA_ARRAY(a, SparseRow, n),
                          .row = ARENA_ARRAY(a, SparseRow, n)};
  for (uint32_t k = n; k-- > 0;) factor_record_backward(l->p, &factors, order[k], y.b, NULL, acc);
  if (l->factored) *l->factored = factors;
  l->x = acc;
}
