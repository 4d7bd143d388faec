/* Sums over all pairs (i, j) of a square, with i and j exchanged: what a turn reads is read in the other, too. */
#include "sym/expr_impl.h"
#include "sym/sum_nest.h"

/* Whether x reads in turn (i, j) what y reads in turn (j, i). */
static int is_mirror(const ExprGraph *g, Expr nest, const NestRead *x, const NestRead *y) {
  const uint32_t rows = expr_sum_nest(g, nest)->range.rows;
  if (x->at.by_row != y->at.by_turn || x->at.by_turn != y->at.by_row) return 0;
  if (x->at.first == y->at.first) return 1;
  for (int64_t k = 0; k < rows; k++) { /* indices as numbers have arguments of their own */
    const int64_t by = k * (x->at.by_row + x->at.by_turn);
    Expr a = expr_sum_arg(g, nest, (uint32_t)(x->at.first + by));
    if (!expr_is_num(g, a) || a != expr_sum_arg(g, nest, (uint32_t)(y->at.first + by))) return 0;
  }
  return 1;
}

/* Appends the read of what read x reads in turn (j, i); 0: its argument is no symbol, or one that another read has. */
static int add_mirror(const ExprGraph *g, Expr nest, const NestRead *x, SumMirror *to) {
  const SumNest *s = expr_sum_nest(g, nest);
  NestRead r = *x;
  r.at = subscript_exchanged(x->at);
  for (uint32_t k = 0; k < r.nindices; k++) r.index[k] = subscript_exchanged(x->index[k]);
  Expr node = expr_sum_arg(g, nest, (uint32_t)subscript_at(&r.at, s->row, s->turn));
  if (expr_op(g, node) != EX_SYM) return 0;
  r.symbol = expr_sym_id(g, node);
  for (uint32_t k = 0; k < to->n; k++)
    if (to->reads[k].symbol == r.symbol) return 0;
  to->reads[to->n++] = r;
  return 1;
}

int expr_sum_mirror(ExprGraph *g, Expr nest, SumMirror *to) {
  const SumNest *s = expr_sum_nest(g, nest);
  const LoopRange *r = &s->range;
  const uint32_t most = 2 * s->nreads + 1;
  if (s->near || s->far || r->skew || r->more || r->turns != r->rows) return 0;
  *to = (SumMirror){s->nreads, ARENA_ARRAY(g->arena, NestRead, most), ARENA_ARRAY(g->arena, Expr, most),
                    ARENA_ARRAY(g->arena, Expr, most)};
  if (s->nreads) memcpy(to->reads, s->reads, s->nreads * sizeof *to->reads);
  for (uint32_t k = 0; k < to->n; k++) {
    uint32_t m = 0;
    if (to->reads[k].at.by_row && to->reads[k].at.by_turn) return 0;
    while (m < to->n && !is_mirror(g, nest, &to->reads[k], &to->reads[m])) m++;
    if (m == to->n && !add_mirror(g, nest, &to->reads[k], to)) return 0;
    to->symbol[k] = expr_symbol(g, to->reads[k].symbol)->node;
    to->mirror[k] = expr_symbol(g, to->reads[m].symbol)->node;
  }
  return 1;
}
