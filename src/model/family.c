/* Families (indexed declarations): index ranges, offsets and names of members, and `for` loops over statements. */
#include "model/builder.h"

uint32_t member_offset(const Entity *e, const int64_t *at) {
  uint64_t i = 0;
  for (int k = 0; k < e->ndims; k++) i = i * (uint64_t)(e->hi[k] - e->lo[k] + 1) + (uint64_t)(at[k] - e->lo[k]);
  return (uint32_t)(i * (e->parts ? e->parts : 1));
}

int range_next(const IndexRange *r, int64_t *at) {
  for (uint32_t k = r->n; k-- > 0;) {
    if (++at[k] <= r->hi[k]) return 1;
    at[k] = r->lo[k];
  }
  return 0;
}

int next_member(const Entity *e, int64_t *at) {
  IndexRange r = entity_range(e);
  return range_next(&r, at);
}

Name member_name(const Ast *ast, Name name, const int64_t *at, uint32_t ndims) {
  if (ndims == 0) return name;
  const char *second = ndims == 2 ? arena_printf(ast->arena, ",%lld", (long long)at[1]) : "";
  return intern(ast->names, arena_printf(ast->arena, "%s[%lld%s]", name, (long long)at[0], second));
}

const Entity *find_member(const Ast *ast, const Scope *members, const Entity *e, const int64_t *at) {
  return scope_own(members, member_name(ast, e->name, at, e->ndims), e->effect);
}

int range_fits(Builder *b, int64_t from, int64_t to, Span span) {
  if (to < from || (uint64_t)to - (uint64_t)from < RANGE_MAX) return 1;
  return diag_error(b->diags, span, "a range has at most %d members", RANGE_MAX);
}

/* Evaluates the ends of a range; 0, reported, on error. */
static int resolve_range(Builder *b, AstId lo, AstId hi, Name effect, int64_t *from, int64_t *to) {
  if (!resolve_whole(b, lo, effect, from) || !resolve_whole(b, hi, effect, to)) return 0;
  return range_fits(b, *from, *to, span_join(ast_expr(b->ast, lo)->span, ast_expr(b->ast, hi)->span));
}

void report_many_indices(Builder *b, Span span) {
  diag_error(b->diags, span, "a family has one index, or two" HELP "combine two indices into one: `u[(i - 1)*K + j]`, in a family of N*K");
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
  uint32_t errors = b->diags->errors, place = b->index.n;
  vec_push(b->arena, &b->index, ((IndexVar){st->name, from}));
  for (int64_t i = from; i <= to && b->diags->errors == errors; i++) {
    b->index.at[place].at = i;
    for (const AstStmt *s = st->body; s; s = s->next) each_statement(b, s, effect, fn, data);
  }
  b->index.n = place;
}

/* Recursion is bounded by the parser's limit on nested blocks. */
void each_statement(Builder *b, const AstStmt *st, Name effect, StatementFn *fn, void *data) {
  if (st->kind == STMT_FOR) each_in_for(b, st, effect, fn, data);
  else fn(b, st, effect, data);
}
