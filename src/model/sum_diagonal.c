/* Terms of sums over pairs with i = j: norm(r[i] - r[j]) is 0 there, whatever r is, and has no derivative by r[i] and
 * r[j] apart. Written out, such a term is a number; of a sum that stays one, a condition says so. */
#include "model/quantified_sum.h"

#include <math.h>

#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/sum_nest.h"

/* The symbol that stands for s where i and j are `at`. */
static SymId symbol_there(const Model *m, const struct Quantified *q, const Symbol *s, SymId id, int64_t at) {
  int64_t part;
  const Read *r = quantified_read_of(q, s, &part);
  if (!r) return id;
  const Affine x = quantified_element(r);
  return entity_symbol(m, r->e->kind, r->rate, r->e->index + (uint32_t)(x.first + (x.by_i + x.by_j) * at + part));
}

/* Whether the term, in the symbols of the first pair, has derivatives where i = j. */
static int has_slopes(const Eval *ev, const struct Quantified *q, Expr term) {
  ExprGraph *g = ev->b->g;
  Arena *a = ev->b->arena;
  ExprList l = expr_topo(g, &term, 1);
  const int64_t at = q->pair[REPRESENTATIVES][0];
  VEC(SymId) syms = {0};
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_SYM) vec_push(a, &syms, expr_sym_id(g, l.at[k]));
  expr_list_free(g, l);
  long double *from = ARENA_ARRAY(a, long double, expr_symbol_count(g) + 1);
  long double *to = ARENA_ARRAY(a, long double, expr_symbol_count(g) + 1);
  sample_state(g, 1, from);
  memcpy(to, from, expr_symbol_count(g) * sizeof *to);
  for (uint32_t k = 0; k < syms.n; k++) {
    const Symbol *s = expr_symbol(g, syms.at[k]);
    const int index = s->kind == SYM_LOCAL && (s->name == q->i || s->name == q->j);
    to[syms.at[k]] = index ? (long double)at : from[symbol_there(ev->b->m, q, s, syms.at[k], at)];
  }
  Expr *d = ARENA_ARRAY(a, Expr, syms.n + 1);
  long double *slope = ARENA_ARRAY(a, long double, syms.n + 1);
  expr_gradient(g, term, syms.at, syms.n, d);
  expr_eval(g, d, syms.n, to, slope);
  for (uint32_t k = 0; k < syms.n; k++)
    if (!isfinite(slope[k])) return 0;
  return 1;
}

void quantified_guard_diagonal(const Eval *ev, const struct Quantified *q, Expr same, Expr *turned) {
  ExprGraph *g = ev->b->g;
  if (q->passes == REPRESENTATIVES || q->far || !same || !expr_is_num(g, same)) return;
  if (has_slopes(ev, q, turned[0])) return;
  Expr at = expr_fn2(g, EX_EQ, expr_named_symbol(g, q->i), expr_named_symbol(g, q->j));
  for (int k = 0; k < REPRESENTATIVES; k++) turned[k] = expr_select(g, at, same, turned[k]);
}
