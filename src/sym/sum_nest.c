/* Nodes of quantified sums: construction, partial derivatives, and the sums written out. */
#include "sym/sum_nest.h"

#include "sym/expr_impl.h"

/* --- construction and access --- */

static Expr cell_of(ExprGraph *g, Expr nest, uint32_t cell) {
  Expr both[2] = {nest, expr_int(g, cell)};
  return expr_make(g, EX_CELL, both, 2);
}

static Expr nest_of(ExprGraph *g, uint32_t number, const Expr *args, uint32_t n) {
  Expr *all = ARENA_ARRAY(g->arena, Expr, n + 1);
  all[0] = expr_int(g, number);
  if (n) memcpy(all + 1, args, n * sizeof *args);
  return expr_make(g, EX_NEST, all, n + 1);
}

Expr expr_sum_cell(ExprGraph *g, const SumNest *s, const Expr *args, uint32_t cell) {
  vec_push(g->arena, &g->nests, *s);
  Expr nest = nest_of(g, g->nests.n, args, s->nargs);
  return cell_of(g, nest, cell);
}

Expr expr_twin_cell(ExprGraph *g, Expr nest, uint32_t number, uint32_t cell) {
  if (g->twin_of != nest || g->twin_number != number) {
    g->twin = nest_of(g, number, g->args.at + g->nodes.at[nest].payload + 1, expr_sum_args(g, nest));
    g->twin_of = nest;
    g->twin_number = number;
  }
  return cell_of(g, g->twin, cell);
}

uint32_t expr_nest_number(const ExprGraph *g, Expr nest) {
  return (uint32_t)expr_number(g, expr_arg(g, nest, 0)).num;
}

const SumNest *expr_sum_nest(const ExprGraph *g, Expr nest) { return &g->nests.at[expr_nest_number(g, nest) - 1]; }
uint32_t expr_sum_args(const ExprGraph *g, Expr nest) { return expr_nargs(g, nest) - 1; }
Expr expr_sum_arg(const ExprGraph *g, Expr nest, uint32_t i) { return expr_arg(g, nest, i + 1); }
Expr expr_cell_nest(const ExprGraph *g, Expr cell) { return expr_arg(g, cell, 0); }
uint32_t expr_cell_number(const ExprGraph *g, Expr cell) { return (uint32_t)expr_number(g, expr_arg(g, cell, 1)).num; }

uint64_t expr_sum_turns(const ExprGraph *g, Expr nest) {
  const LoopRange *r = &expr_sum_nest(g, nest)->range;
  uint64_t n = 0;
  for (uint32_t i = 0; i < r->rows; i++) n += (uint64_t)loop_turns(r, i);
  return n;
}

/* --- written out --- */

/* Whether a turn adds to cell k: an equation affine in i and j. */
static int adds_to(const NestShare *x, int64_t k, int64_t i, int64_t j) { return subscript_at(&x->at, i, j) == k; }

static void add_turn(ExprGraph *g, const SumNest *s, const Expr *args, const NestShare *x, int64_t i, int64_t j,
                     SymId *syms, Expr *with) {
  for (uint32_t k = 0; k < s->nreads; k++) {
    syms[k] = s->reads[k].symbol;
    with[k] = args[subscript_at(&s->reads[k].at, i, j)];
  }
  Expr term = expr_replace(g, x->value, syms, with, s->nreads);
  vec_push(g->arena, &g->terms, term);
}

static Expr written_out(ExprGraph *g, Expr cell) {
  Expr nest = expr_cell_nest(g, cell);
  SumNest s = *expr_sum_nest(g, nest);
  int64_t k = expr_cell_number(g, cell);
  SymId *syms = ARENA_ARRAY(g->arena, SymId, s.nreads + 1);
  Expr *with = ARENA_ARRAY(g->arena, Expr, s.nreads + 1), *args = ARENA_ARRAY(g->arena, Expr, s.nargs + 1);
  for (uint32_t n = 0; n < s.nargs; n++) args[n] = expr_sum_arg(g, nest, n);
  g->terms.n = 0;
  for (int64_t i = 0; i < s.range.rows; i++)
    for (int64_t j = loop_from(&s.range, i); j < loop_to(&s.range, i); j++)
      for (uint32_t n = 0; n < s.nshares; n++)
        if (adds_to(&s.shares[n], k, i, j)) add_turn(g, &s, args, &s.shares[n], i, j, syms, with);
  return expr_add_n(g, g->terms.at, g->terms.n);
}

void expr_write_out(ExprGraph *g, const Expr *roots, uint32_t n, const Expr *cells, uint32_t ncells, Expr *out) {
  Expr *sums = ARENA_ARRAY(g->arena, Expr, ncells + 1);
  if (n && out != roots) memcpy(out, roots, n * sizeof *roots);
  for (uint32_t k = 0; k < ncells; k++) sums[k] = written_out(g, cells[k]);
  if (ncells) expr_replace_nodes(g, roots, n, cells, sums, ncells, out);
}

void expr_expand_sums(ExprGraph *g, const Expr *roots, uint32_t n, Expr *out) {
  VEC(Expr) cells = {0};
  ExprList l = g->nests.n ? expr_topo(g, roots, n) : (ExprList){0};
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_CELL) vec_push(g->arena, &cells, l.at[k]);
  expr_write_out(g, roots, n, cells.at, cells.n, out);
}

int expr_open_sums(ExprGraph *g, Expr *e) {
  enum { MOST_TURNS = 50000 };
  uint64_t turns = 0;
  ExprList l = g->nests.n ? expr_topo_to_sums(g, e, 1) : (ExprList){0};
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_NEST) turns += expr_sum_turns(g, l.at[k]);
  if (turns > MOST_TURNS) return 0;
  if (turns) expr_expand_sums(g, e, 1, e);
  return 1;
}
