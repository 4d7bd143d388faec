/* Ranges of families: indices and ranges as they are written, and `for` over statements. */
#include "model/builder.h"

/* Evaluates the ends of a range; 0, reported, on error. */
static int resolve_range(Builder *b, AstId lo, AstId hi, Name effect, int64_t *from, int64_t *to) {
  if (!resolve_whole(b, lo, effect, from) || !resolve_whole(b, hi, effect, to)) return 0;
  return range_fits(b, *from, *to, span_join(ast_expr(b->ast, lo)->span, ast_expr(b->ast, hi)->span));
}

int resolve_indices(Builder *b, AstId list, Name effect, IndexRange *out) {
  *out = (IndexRange){0};
  uint32_t outer = b->index.n;
  int ok = 1;
  for (AstId i = list; i && ok; i = ast_expr(b->ast, i)->next) {
    const AstExpr *x = ast_expr(b->ast, i);
    if (out->n == 2) {
      report_many_indices(b, x->span);
      return 0;
    }
    uint32_t k = out->n++;
    if (x->kind == AST_BIND) {
      out->name[k] = x->name;
      ok = resolve_range(b, x->a, x->b, effect, &out->lo[k], &out->hi[k]);
    } else {
      ok = resolve_whole(b, i, effect, &out->lo[k]);
      out->hi[k] = out->lo[k];
    }
  }
  b->index.n = outer;
  return ok;
}

static void each_in_for(Builder *b, const AstStmt *st, Name effect, StatementFn *fn, void *data) {
  int64_t from, to;
  if (!resolve_range(b, st->lhs, st->rhs, effect, &from, &to)) return;
  const int64_t outer[2] = {b->for_range[0], b->for_range[1]};
  uint32_t errors = b->diags->errors, place = b->index.n;
  b->for_range[0] = from, b->for_range[1] = to;
  vec_push(b->arena, &b->index, ((IndexVar){st->name, from}));
  for (int64_t i = from; i <= to && b->diags->errors == errors; i++) {
    b->index.at[place].at = i;
    for (const AstStmt *s = st->body; s; s = s->next) each_statement(b, s, effect, fn, data);
  }
  b->index.n = place;
  memcpy(b->for_range, outer, sizeof outer);
}

/* Recursion is bounded by the parser's limit on nested blocks. */
void each_statement(Builder *b, const AstStmt *st, Name effect, StatementFn *fn, void *data) {
  if (st->kind == STMT_FOR) each_in_for(b, st, effect, fn, data);
  else fn(b, st, effect, data);
}
