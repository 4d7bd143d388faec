/* Sums in statements of a family, `for i in 1..N { force x[i] = sum(j in 1..N, f(x[j] - x[i])) }`: one nest has the
 * sums of all members as its rows. Evaluated at two representatives, as sums over pairs are (quantified_sum.c). */
#include "model/quantified_sum.h"

#include "sym/sum_nest.h"

/* The only index around a sum, that of a family or a `for` with this range; NULL: there is none, or there are
 * several. */
static const IndexVar *index_around(const Eval *ev, int64_t *range) {
  const Builder *b = ev->b;
  const uint32_t outer = ev->in_statement ? b->index.n : 0;
  const int is_definition = ev->kind == ENT_LET || ev->kind == ENT_OBSERVE;
  if (ev->index.n + outer != 1 || ev->function || ev->loops.n || ev->sums || ev->where < IN_DYNAMICS) return NULL;
  const int64_t *from = outer && b->keeps_rows ? b->for_range : NULL;
  if (is_definition && !outer) from = (ev->kind == ENT_LET ? b->lets : b->observes).at[ev->definition].range;
  if (!from || from[0] == from[1]) return NULL;
  memcpy(range, from, 2 * sizeof *range);
  return outer ? b->index.at : ev->index.at;
}

static const FamilySum *known_sum(const Builder *b, AstId id) {
  vec_each(const FamilySum, s, b->family_sums)
    if (s->sum == id) return s;
  return NULL;
}

/* The sum of a member. */
static Value member_sum(const Builder *b, const FamilySum *s, int64_t at) {
  Value v = s->value;
  const int64_t row = at - s->lo;
  for (uint32_t k = 0; k < component_count(&v) && s->range.rows; k++) {
    if (expr_op(b->g, v.at[k]) != EX_CELL) continue;
    const uint32_t cell = (uint32_t)row * component_count(&v) + k;
    v.at[k] = loop_turns(&s->range, row) ? expr_cell_of(b->g, expr_cell_nest(b->g, v.at[k]), cell)
                                         : expr_int(b->g, 0);
  }
  return v;
}

static void note_sum(Builder *b, FamilySum s) { vec_push(b->arena, &b->family_sums, s); }

/* Notes that the sum has no such form: its terms are written out, where nothing else keeps them together. */
static int no_rows(const Eval *ev, const struct Quantified *q, uint64_t turns) {
  note_sum(ev->b, (FamilySum){.sum = q->outer});
  if (ev->in_statement && quantified_is_long(ev->b, turns)) quantified_write_out(ev, q, turns);
  return 0;
}

int family_sum_begin(Eval *ev, AstId id, int64_t lo, int64_t hi) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  int64_t of[2];
  const IndexVar *i = x->kind == AST_SUM && b->sums_from ? index_around(ev, of) : NULL;
  if (!i || quantified_near(b->ast, id) || quantified_far_sum(b->ast, id)) return 0;
  const FamilySum *known = known_sum(b, id);
  if (known && known->value.e) *value_of(ev, id) = member_sum(b, known, i->at);
  if (known) return known->value.e ? -1 : 0;
  if (!quantified_names(b->ast, x->c, i->name)) return 0; /* the terms of all members are the same: written once */
  struct Quantified *q = ARENA_NEW(b->arena, struct Quantified);
  *q = (struct Quantified){.outer = id, .inner = id, .i = i->name, .j = x->name, .lo = of[0], .hi = of[1], .at = i->at,
                           .own = {lo, hi}};
  const int read = quantified_text(ev, q);
  for (int64_t row = 0; row < q->range.rows; row++)
    q->turns += (uint64_t)(read ? loop_turns(&q->range, row) : hi - lo + 1);
  if (!read || !quantified_is_long(b, q->turns) || !quantified_find_pairs(q, b->arena)) return no_rows(ev, q, q->turns);
  quantified_start(ev, q);
  return 1;
}

void family_sum_end(Eval *ev, const struct Quantified *q, Value *v) {
  const FamilySum s = {.sum = q->outer, .value = *v, .lo = q->lo, .range = q->range};
  note_sum(ev->b, s);
  if (v->e) *v = member_sum(ev->b, &s, q->at);
}

void family_sum_keep(const Eval *ev, AstId id, const Value *v) {
  int64_t of[2];
  const IndexVar *i = index_around(ev, of);
  if (i && v->e && !quantified_names(ev->b->ast, id, i->name)) note_sum(ev->b, (FamilySum){.sum = id, .value = *v});
}
