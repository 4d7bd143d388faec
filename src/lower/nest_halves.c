/* Sums over all pairs (i, j) of a square, as those that each member of a family has, taken once for (i, j) and (j, i):
 * what the two have in common, a distance or an odd function, is computed once. */
#include "lower/lower_impl.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/sum_nest.h"

/* Whether the values vanish for i = j, as where a condition says so, and not because 0 times 1/0 does. */
static int vanish_on_diagonal(ExprGraph *g, const SumMirror *m, const Expr *values, uint32_t n) {
  Arena *a = expr_arena(g);
  Expr *there = ARENA_ARRAY(a, Expr, n + 1), *row = ARENA_ARRAY(a, Expr, m->n + 1); /* what reads at j reads at i */
  long double *symbols = ARENA_ARRAY(a, long double, expr_symbol_count(g) + 1);
  long double *at = ARENA_ARRAY(a, long double, n + 1);
  for (uint32_t k = 0; k < m->n; k++) row[k] = m->reads[k].at.by_turn ? m->mirror[k] : m->symbol[k];
  expr_replace_nodes(g, values, n, m->symbol, row, m->n, there);
  for (uint32_t k = 0; k < n; k++)
    if (!expr_is_zero(g, there[k])) return 0;
  sample_state(g, 1, symbols);
  for (uint32_t k = 0; k < m->n; k++) symbols[m->reads[k].symbol] = symbols[expr_sym_id(g, row[k])];
  expr_eval(g, values, n, symbols, at);
  for (uint32_t k = 0; k < n; k++)
    if (at[k] != 0) return 0;
  return 1;
}

/* Decides comparisons of i and j in `values` for j below i. */
static void decide_below(ExprGraph *g, const SumMirror *m, Expr *values, uint32_t n) {
  static const ExprOp op[] = {EX_EQ, EX_LT, EX_LE, EX_LT, EX_LE}; /* of i and j, and twice of j and i */
  for (uint32_t k = 0; k < m->n; k++) {
    const NestRead *r = &m->reads[k];
    if (!r->stem || *r->stem || !r->at.by_row) continue;
    Expr i = m->symbol[k], j = m->mirror[k], from[5], to[5];
    for (int c = 0; c < 5; c++) {
      from[c] = c < 3 ? expr_fn2(g, op[c], i, j) : expr_fn2(g, op[c], j, i);
      to[c] = expr_int(g, c >= 3);
    }
    expr_replace_nodes(g, values, n, from, to, 5, values);
  }
}

/* Whether the values and their mirrors have a quarter of their nodes in common. */
static int share_nodes(ExprGraph *g, const Expr *values, uint32_t n) {
  ExprList both = expr_topo(g, values, 2 * n);
  uint32_t of_both = both.n;
  expr_list_free(g, both);
  ExprList one = expr_topo(g, values, n);
  uint32_t of_one = one.n;
  expr_list_free(g, one);
  return 2 * of_both <= 3 * of_one;
}

const SumNest *nest_half(ExprGraph *g, Expr nest) {
  Arena *a = expr_arena(g);
  const SumNest *s = expr_sum_nest(g, nest);
  const uint32_t n = s->nshares;
  SumMirror m;
  if (s->ncells == 1 || s->range.rows < 3 || !expr_sum_mirror(g, nest, &m)) return NULL;
  Expr *values = ARENA_ARRAY(a, Expr, 2 * n + 1);
  for (uint32_t k = 0; k < n; k++) values[k] = s->shares[k].value;
  if (!vanish_on_diagonal(g, &m, values, n)) return NULL;
  expr_replace_nodes(g, values, n, m.symbol, m.mirror, m.n, values + n);
  decide_below(g, &m, values, 2 * n);
  if (!share_nodes(g, values, n)) return NULL;
  NestShare *shares = ARENA_ARRAY(a, NestShare, 2 * n + 1);
  for (uint32_t k = 0; k < n; k++) {
    shares[k] = (NestShare){values[k], s->shares[k].at};
    shares[n + k] = (NestShare){values[n + k], subscript_exchanged(s->shares[k].at)};
  }
  SumNest *half = ARENA_NEW(a, SumNest);
  *half = *s;
  half->range = (LoopRange){.rows = s->range.rows, .more = 1};
  half->reads = m.reads;
  half->nreads = m.n;
  half->shares = shares;
  half->nshares = 2 * n;
  half->slopes = NULL;
  return half;
}
