/* Quantified sums for readers. A cell that all turns add to is a sum over both indices; the derivative by x[3] has two
 * half sums, over the pairs with i = 3 and those with j = 3. */
#include "sym/expr_impl.h"
#include "sym/sum_nest.h"

typedef struct {
  ExprGraph *g;
  Expr nest;
  const SumNest *s;
  VEC(SumTerm) terms;
} Reader;

/* A term in the making: row and turn are numbers, or are summed over. */
typedef struct {
  int fixed_row, fixed_turn;
  int64_t row, turn;
} Turn;

/* Affine function of i and j (of row and turn where they are fixed) as text: "i + 1", "2*i - j", "7". */
static const char *affine_text(const Reader *r, Subscript x, const Turn *at) {
  StrBuf b = strbuf(r->g->arena);
  const char *name[2] = {r->s->i, r->s->j};
  int64_t by[2] = {x.by_row, x.by_turn}, rest = x.first;
  for (int k = 0; k < 2; k++) {
    int fixed = k ? at->fixed_turn : at->fixed_row;
    rest += by[k] * (fixed ? (k ? at->turn : at->row) : -(k ? r->s->j0 : r->s->i0));
    if (fixed || !by[k]) continue;
    if (b.n || by[k] == -1) sb_puts(&b, by[k] < 0 ? (b.n ? " - " : "-") : " + ");
    int64_t size = by[k] < 0 && (b.n || by[k] == -1) ? -by[k] : by[k];
    if (size != 1) sb_printf(&b, "%lld*", (long long)size);
    sb_puts(&b, name[k]);
  }
  if (!b.n) return arena_printf(r->g->arena, "%lld", (long long)rest);
  if (rest) sb_printf(&b, " %c %lld", rest < 0 ? '-' : '+', (long long)(rest < 0 ? -rest : rest));
  return sb_text(&b);
}

Expr expr_named_symbol(ExprGraph *g, const char *text) {
  Name name = intern(g->names, text);
  for (uint32_t k = 0; k < g->index_names.n; k++)
    if (expr_symbol(g, g->index_names.at[k])->name == name) return expr_symbol(g, g->index_names.at[k])->node;
  SymId s = expr_declare(g, SYM_LOCAL, 0, name, SIGN_UNKNOWN);
  vec_push(g->arena, &g->index_names, s);
  return expr_symbol(g, s)->node;
}

static Expr read_symbol(const Reader *r, const NestRead *read, const Turn *at) {
  int runs = (read->at.by_row && !at->fixed_row) || (read->at.by_turn && !at->fixed_turn);
  int64_t arg = subscript_at(&read->at, at->fixed_row ? at->row : 0, at->fixed_turn ? at->turn : 0);
  if (!runs || !read->stem) return expr_sum_arg(r->g, r->nest, (uint32_t)arg);
  const char *first = affine_text(r, read->index[0], at);
  if (!*read->stem) return expr_named_symbol(r->g, first);
  const char *second = read->nindices == 2 ? affine_text(r, read->index[1], at) : "";
  const char *comma = *second ? "," : "";
  const char *text = arena_printf(r->g->arena, "%s[%s%s%s]%s", read->stem, first, comma, second, read->tail);
  return expr_named_symbol(r->g, text);
}

static void add_term(Reader *r, const NestShare *x, const Turn *at, Subscript from, Subscript to, uint32_t rows[2]) {
  ExprGraph *g = r->g;
  SymId *syms = ARENA_ARRAY(g->arena, SymId, r->s->nreads + 1);
  Expr *with = ARENA_ARRAY(g->arena, Expr, r->s->nreads + 1);
  SumTerm t = {0};
  uint32_t n = 0;
  Num c;
  for (uint32_t k = 0; k < r->s->nreads; k++) {
    syms[k] = r->s->reads[k].symbol;
    with[k] = read_symbol(r, &r->s->reads[k], at);
  }
  t.body = expr_replace(g, x->value, syms, with, r->s->nreads);
  if (expr_op(g, t.body) == EX_SUM && expr_pairs(g, t.body, EX_SUM) == 1) {
    expr_pair(g, t.body, EX_SUM, 0, &c);
    t.minus = num_sign(c) < 0;
    if (t.minus) t.body = expr_neg(g, t.body);
  }
  if (!at->fixed_row) {
    t.index[n] = r->s->i;
    t.from[n] = arena_printf(g->arena, "%lld", (long long)(r->s->i0 + rows[0]));
    t.to[n++] = arena_printf(g->arena, "%lld", (long long)(r->s->i0 + rows[1]));
  }
  if (!at->fixed_turn) {
    t.index[n] = r->s->j;
    t.from[n] = affine_text(r, from, at);
    t.to[n++] = affine_text(r, to, at);
  }
  vec_push(g->arena, &r->terms, t);
}

/* The terms of a share that are added to cell c, for each row that has any, or for all rows together. */
static void add_share(Reader *r, const NestShare *x, int64_t c) {
  const LoopRange *range = &r->s->range;
  Subscript from = {r->s->j0, range->skew, 0}, to = {r->s->j0 + range->turns - 1, range->skew + range->more, 0};
  uint32_t rows[2] = {0, range->rows - 1}, some = 0;
  int by_row = x->at.by_row != 0, by_turn = x->at.by_turn != 0;
  int64_t gap = c - x->at.first, turn = by_turn && !by_row ? gap / x->at.by_turn : 0;
  if (!by_row && (by_turn ? gap % x->at.by_turn : gap)) return;
  for (uint32_t i = 0; i < range->rows; i++) {
    if (by_row && by_turn) turn = (gap - x->at.by_row * i) / x->at.by_turn;
    int hits = by_turn ? turn >= loop_from(range, i) && turn < loop_to(range, i) : loop_turns(range, i) > 0;
    if (!hits || (by_row && x->at.by_row * i + x->at.by_turn * turn != gap)) continue;
    if (by_row) add_term(r, x, &(Turn){1, by_turn, i, turn}, from, to, rows);
    if (!some++) rows[0] = i;
    rows[1] = i;
  }
  if (!by_row && some) add_term(r, x, &(Turn){0, by_turn, 0, turn}, from, to, rows);
}

SumTerms expr_sum_terms(ExprGraph *g, Expr cell) {
  Reader r = {.g = g, .nest = expr_cell_nest(g, cell)};
  r.s = expr_sum_nest(g, r.nest);
  for (uint32_t k = 0; k < r.s->nshares; k++) add_share(&r, &r.s->shares[k], expr_cell_number(g, cell));
  return (SumTerms){r.terms.at, r.terms.n};
}
