/* Quantified sums for readers. A cell that all turns add to is a sum over both indices; the derivative by x[3] has two
 * half sums, over the pairs with i = 3 and those with j = 3. */
#include "sym/expr_impl.h"
#include "sym/sum_nest.h"

typedef struct {
  ExprGraph *g;
  Expr nest;
  const SumNest *s;
  VEC(SumPlace) places;
} Reader;

/* Affine function of i and j (of row and turn where they are fixed) as text: "i + 1", "2*i - j", "7". */
static const char *affine_text(const Reader *r, Subscript x, const SumPlace *at) {
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

/* The argument that stands for itself in the term; 0: its name has a running index. */
static Expr fixed_argument(const Reader *r, const NestRead *read, const SumPlace *at) {
  int runs = (read->at.by_row && !at->fixed_row) || (read->at.by_turn && !at->fixed_turn);
  int64_t arg = subscript_at(&read->at, at->fixed_row ? at->row : 0, at->fixed_turn ? at->turn : 0);
  return runs && read->stem ? 0 : expr_sum_arg(r->g, r->nest, (uint32_t)arg);
}

static Expr read_symbol(const Reader *r, const NestRead *read, const SumPlace *at) {
  Expr fixed = fixed_argument(r, read, at);
  if (fixed) return fixed;
  const char *first = affine_text(r, read->index[0], at);
  if (!*read->stem) return expr_named_symbol(r->g, first);
  const char *second = read->nindices == 2 ? affine_text(r, read->index[1], at) : "";
  const char *comma = *second ? "," : "";
  const char *text = arena_printf(r->g->arena, "%s[%s%s%s]%s", read->stem, first, comma, second, read->tail);
  return expr_named_symbol(r->g, text);
}

static SumTerm term_at(Reader *r, const SumPlace *at) {
  ExprGraph *g = r->g;
  const LoopRange *range = &r->s->range;
  SymId *syms = ARENA_ARRAY(g->arena, SymId, r->s->nreads + 1);
  Expr *with = ARENA_ARRAY(g->arena, Expr, r->s->nreads + 1);
  SumTerm t = {0};
  uint32_t n = 0;
  Num c;
  for (uint32_t k = 0; k < r->s->nreads; k++) {
    syms[k] = r->s->reads[k].symbol;
    with[k] = read_symbol(r, &r->s->reads[k], at);
  }
  t.body = expr_replace(g, r->s->shares[at->share].value, syms, with, r->s->nreads);
  if (expr_op(g, t.body) == EX_SUM && expr_pairs(g, t.body, EX_SUM) == 1) {
    expr_pair(g, t.body, EX_SUM, 0, &c);
    t.minus = num_sign(c) < 0;
    if (t.minus) t.body = expr_neg(g, t.body);
  }
  if (!at->fixed_row) {
    t.index[n] = r->s->i;
    t.from[n] = arena_printf(g->arena, "%lld", (long long)(r->s->i0 + at->rows[0]));
    t.to[n++] = arena_printf(g->arena, "%lld", (long long)(r->s->i0 + at->rows[1]));
  }
  if (!at->fixed_turn) {
    t.index[n] = r->s->j;
    t.from[n] = affine_text(r, (Subscript){r->s->j0, range->skew, 0}, at);
    t.to[n++] = affine_text(r, (Subscript){r->s->j0 + range->turns - 1, range->skew + range->more, 0}, at);
  }
  return t;
}

/* Cuts the rows from rows[0] to rows[1] to those with by*row <= most. */
static void cut_rows(int64_t rows[2], int64_t by, int64_t most) {
  int64_t whole = by ? most / by : 0;
  if (by == 0 && most < 0) rows[1] = rows[0] - 1;
  if (by > 0 && whole * by > most) whole--; /* rounded towards 0 */
  if (by < 0 && whole * by > most) whole++;
  if (by > 0 && whole < rows[1]) rows[1] = whole;
  if (by < 0 && whole > rows[0]) rows[0] = whole;
}

/* The rows that have a turn, or, if `fixed`, that turn. */
static void rows_with_turn(const LoopRange *x, int fixed, int64_t turn, int64_t rows[2]) {
  rows[0] = 0;
  rows[1] = (int64_t)x->rows - 1;
  cut_rows(rows, -x->more, x->turns - 1);
  if (!fixed) return;
  cut_rows(rows, x->skew, turn);
  cut_rows(rows, -(x->skew + x->more), x->turns - 1 - turn);
}

static void add_place(Reader *r, SumPlace at) {
  Expr *args = ARENA_ARRAY(r->g->arena, Expr, r->s->nreads + 1);
  for (uint32_t k = 0; k < r->s->nreads; k++) {
    Expr fixed = fixed_argument(r, &r->s->reads[k], &at);
    if (fixed) args[at.nargs++] = fixed;
  }
  at.args = args;
  vec_push(r->g->arena, &r->places, at);
}

/* The places of a share that are added to cell c, in each row that has any, or in all rows together. */
static void add_share(Reader *r, uint32_t share, int64_t c) {
  const LoopRange *range = &r->s->range;
  const Subscript *x = &r->s->shares[share].at;
  int by_row = x->by_row != 0, by_turn = x->by_turn != 0;
  int64_t gap = c - x->first, turn = by_turn && !by_row ? gap / x->by_turn : 0, rows[2];
  if (!by_row && (by_turn ? gap % x->by_turn : gap)) return;
  if (by_row && !by_turn && gap % x->by_row) return;
  rows_with_turn(range, by_turn && !by_row, turn, rows);
  if (!by_row && rows[0] <= rows[1]) add_place(r, (SumPlace){share, 0, by_turn, 0, turn, {rows[0], rows[1]}, 0, NULL});
  for (int64_t i = by_turn ? rows[0] : by_row ? gap / x->by_row : 0; by_row && i <= rows[1]; i++) {
    if (by_turn) turn = (gap - x->by_row * i) / x->by_turn;
    int hits = !by_turn || (turn >= loop_from(range, i) && turn < loop_to(range, i));
    if (hits && i >= rows[0] && x->by_row * i + x->by_turn * turn == gap)
      add_place(r, (SumPlace){share, 1, by_turn, i, turn, {0, 0}, 0, NULL});
    if (!by_turn) break;
  }
}

static Reader reader(ExprGraph *g, Expr cell) {
  Reader r = {.g = g, .nest = expr_cell_nest(g, cell)};
  r.s = expr_sum_nest(g, r.nest);
  for (uint32_t k = 0; k < r.s->nshares; k++) add_share(&r, k, expr_cell_number(g, cell));
  return r;
}

SumPlaces expr_sum_places(ExprGraph *g, Expr cell) {
  Reader r = reader(g, cell);
  return (SumPlaces){r.places.at, r.places.n};
}

SumTerms expr_sum_terms(ExprGraph *g, Expr cell) {
  Reader r = reader(g, cell);
  SumTerm *terms = ARENA_ARRAY(g->arena, SumTerm, r.places.n + 1);
  for (uint32_t k = 0; k < r.places.n; k++) terms[k] = term_at(&r, &r.places.at[k]);
  return (SumTerms){terms, r.places.n};
}
