/* Settings of a scene that replace numbers of members set before: only wider ones may be replaced. */
#include <string.h>

#include "model/builder.h"

/* The family's table of numbers and the settings that gave them, made at the first one in a block. */
static uint32_t *given_numbers(Builder *b, const Entity *e, uint32_t primes) {
  for (uint32_t i = 0; i < b->given.n; i++) {
    const GivenFamily *f = &b->given.at[i];
    if (f->name == e->name && f->effect == e->effect && f->parts == e->parts && f->primes == primes) return f->by;
  }
  GivenFamily f = {e->name, e->effect, e->parts, primes, ARENA_ARRAY(b->arena, uint32_t, entity_size(e) + 1)};
  vec_push(b->arena, &b->given, f);
  return f.by;
}

static int is_component(const Ast *ast, AstId lhs) {
  const AstExpr *x = ast_expr(ast, lhs);
  return (x->kind == AST_PRIME ? ast_expr(ast, x->a) : x)->kind == AST_MEMBER;
}

/* Reports setting s, which replaces numbers of an older one. */
static void report_replaced(Builder *b, const MemberSetting *s, const MemberSetting *old, int all) {
  Span span = ast_expr(b->ast, s->lhs)->span;
  Name text = ast_text(b, s->lhs), before = ast_text(b, old->lhs);
  if (strcmp(text, before) == 0) return; /* reported by check_setting */
  if (all) {
    diag_error(b->diags, span, "`%s` covers `%s`, whose value is lost" HELP "%s", text, before,
               old->n < s->n ? "write the more general one first" : "leave out one of them");
  } else {
    diag_error(b->diags, span, "`%s` and `%s` share members: the second would win" HELP
               "neither lies within the other: %s", text, before,
               is_component(b->ast, s->lhs) != is_component(b->ast, old->lhs)
                   ? "give the components of the vector one by one, after the range"
                   : "end one of them where the other begins");
  }
  diag_also(b->diags, ast_expr(b->ast, old->lhs)->span, "given here");
}

void check_members_kept(Builder *b, const Target *p, const Entity *e, const IndexRange *r, AstId lhs) {
  uint32_t parts = p->part < 0 && e->parts ? e->parts : 1, shared = 0, covered = 0;
  uint32_t rank = p->indices ? (uint32_t)(r->name[0] != NULL) + (r->name[1] != NULL) : 3;
  MemberSetting s = {lhs, (uint32_t)range_count(r) * parts, rank};
  if (!b->in_scene || !s.n || (!e->ndims && !e->parts)) return;
  uint32_t *by = given_numbers(b, e, p->primes) + (p->part < 0 ? 0 : component_index(e->parts, p->part));
  const MemberSetting *lost = NULL, *old = NULL;
  int64_t at[2] = {r->lo[0], r->lo[1]};
  vec_push(b->arena, &b->settings, s);
  do {
    for (uint32_t k = 0, i = member_offset(e, at); k < parts; k++, i++) {
      if (by[i]) old = &b->settings.at[by[i] - 1], shared++;
      if (by[i] && !lost && (old->n < s.n || (old->n == s.n && old->rank <= rank))) lost = old;
      covered += by[i] && old == lost;
      by[i] = b->settings.n;
    }
  } while (range_next(r, at));
  if (lost || (old && shared < s.n)) report_replaced(b, &s, lost ? lost : old, lost && covered == lost->n);
}
