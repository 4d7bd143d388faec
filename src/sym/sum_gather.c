/* Linear combinations of the cells of one nest, sum over k of w[k]*cell[k], as one sum over its turns.
 *
 * A turn (i, j) contributes the sum over shares of value*w[at(i, j)]. Where every w is that of the representative turn
 * with the arguments of its own turn in the places of the representative's, that body stands for all turns: shifts,
 * rotations and boosts of all bodies together are such combinations. */
#include "sym/expr_impl.h"
#include "sym/sum_nest.h"

typedef struct {
  ExprGraph *g;
  Expr nest;
  const SumNest *s;
  Expr *w;       /* by cell */
  SymId *syms;   /* symbols of the reads, */
  Expr *with;    /* and their arguments in one turn */
} Gather;

/* The only cell in a term of a sum, and its factor; 0: none, or not linear. */
static Expr cell_of_term(ExprGraph *g, Expr term, Expr *factor) {
  Expr cell = 0;
  Num power;
  for (uint32_t i = 0; i < expr_pairs(g, term, EX_PROD); i++) {
    Expr x = expr_pair(g, term, EX_PROD, i, &power);
    if (expr_op(g, x) != EX_CELL) continue;
    if (cell || !num_is_one(power)) return 0;
    cell = x;
  }
  if (cell) *factor = expr_mul(g, term, expr_pow_num(g, cell, num_int(-1)));
  return cell;
}

/* Whether the factor of the share's cell in turn (i, j) is the representative's with other arguments. */
static int is_like(const Gather *x, const NestShare *share, Expr like, int64_t i, int64_t j) {
  for (uint32_t k = 0; k < x->s->nreads; k++)
    x->with[k] = expr_sum_arg(x->g, x->nest, (uint32_t)subscript_at(&x->s->reads[k].at, i, j));
  return expr_replace(x->g, like, x->syms, x->with, x->s->nreads) == x->w[subscript_at(&share->at, i, j)];
}

/* Whether `like` contains no argument that changes along an axis (of turns: 1, of rows: 0) that the share's cell does
 * not change along. */
static int stays(const Gather *x, Expr like, int turns) {
  for (uint32_t k = 0; k < x->s->nreads; k++) {
    const Subscript *at = &x->s->reads[k].at;
    if ((turns ? at->by_turn : at->by_row) && expr_contains_sym(x->g, like, x->s->reads[k].symbol)) return 0;
  }
  return 1;
}

/* Whether the factors of a share's cells are alike in all turns; each cell is visited once. */
static int is_uniform(const Gather *x, const NestShare *share, Expr like) {
  const LoopRange *r = &x->s->range;
  unsigned char *seen = ARENA_ARRAY(x->g->arena, unsigned char, x->s->ncells);
  if ((!share->at.by_row && !stays(x, like, 0)) || (!share->at.by_turn && !stays(x, like, 1))) return 0;
  for (int64_t k = 0; k < r->rows; k++) {
    int64_t i = r->rows - 1 - k, end = share->at.by_turn ? loop_to(r, i) : loop_from(r, i) + (loop_turns(r, i) > 0);
    for (int64_t j = loop_from(r, i); j < end; j++) {
      unsigned char *known = &seen[subscript_at(&share->at, i, j)];
      if (!*known && !is_like(x, share, like, i, j)) return 0;
      *known = 1;
    }
  }
  return 1;
}

/* The body of the whole; 0: factors are not alike. */
static Expr whole_body(Gather *x) {
  ExprGraph *g = x->g;
  const SumNest s = *x->s;
  Expr body = g->zero;
  for (uint32_t k = 0; k < s.nreads; k++) {
    x->syms[k] = s.reads[k].symbol;
    if (expr_symbol(g, s.reads[k].symbol)->kind != SYM_LOCAL &&
        expr_sum_arg(g, x->nest, (uint32_t)subscript_at(&s.reads[k].at, s.row, s.turn)) !=
            expr_symbol(g, s.reads[k].symbol)->node)
      return 0;
  }
  for (uint32_t k = 0; k < s.nshares; k++) {
    Expr like = x->w[subscript_at(&s.shares[k].at, s.row, s.turn)];
    if (!is_uniform(x, &s.shares[k], like)) return 0;
    Expr part = expr_mul(g, like, s.shares[k].value);
    body = expr_add(g, body, part);
  }
  return body;
}

/* Half of the body and of what turn (j, i) has, where both are turns: what pairs do to each other may vanish. */
static Expr with_mirror(ExprGraph *g, Expr nest, Expr body) {
  SumMirror m;
  Expr other;
  if (!body || !expr_sum_mirror(g, nest, &m)) return body;
  expr_replace_nodes(g, &body, 1, m.symbol, m.mirror, m.n, &other);
  Expr sum = expr_add(g, body, other);
  return expr_scale(g, num_ratio(1, 2), sum);
}

Expr expr_gather_sum(ExprGraph *g, Expr e, Expr *rest) {
  Gather x = {.g = g};
  Expr factor;
  uint32_t n = expr_pairs(g, e, EX_SUM);
  Num c;
  g->terms.n = 0;
  for (uint32_t i = 0; i < n; i++) {
    Expr term = expr_pair(g, e, EX_SUM, i, &c), cell = cell_of_term(g, term, &factor);
    if (cell && !x.nest) {
      if (expr_sum_nest(g, expr_cell_nest(g, cell))->ncells > expr_sum_args(g, expr_cell_nest(g, cell)) + 1) return 0;
      x.nest = expr_cell_nest(g, cell);
      x.s = expr_sum_nest(g, x.nest);
      x.w = ARENA_ARRAY(g->arena, Expr, x.s->ncells);
      for (uint32_t k = 0; k < x.s->ncells; k++) x.w[k] = g->zero;
    }
    if (cell && expr_cell_nest(g, cell) == x.nest) {
      Expr *w = &x.w[expr_cell_number(g, cell)], scaled = expr_scale(g, c, factor);
      *w = expr_add(g, *w, scaled);
    } else {
      Expr other = expr_scale(g, c, term);
      vec_push(g->arena, &g->terms, other);
    }
  }
  if (!x.nest) return 0;
  *rest = expr_add_n(g, g->terms.at, g->terms.n);
  x.syms = ARENA_ARRAY(g->arena, SymId, x.s->nreads + 1);
  x.with = ARENA_ARRAY(g->arena, Expr, x.s->nreads + 1);
  Expr body = whole_body(&x);
  return with_mirror(g, x.nest, body);
}
