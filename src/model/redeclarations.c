/* Duplicate declarations: names, and settings of a scene or event. A second one, which would silently win, is an
 * error. */
#include "model/builder.h"

void check_names_once(Builder *b, const FileIndex *file) {
  const AstStmt *none = find_named(b->ast, STMT_EFFECT, "none");
  if (none) {
    diag_error(b->diags, none->name_span,
               "an effect cannot be called `none`: `use none` turns all off" HELP "choose another name");
  }
  for (uint32_t i = 0; i < file->repeated.n; i++) {
    const AstStmt *s = file->repeated.at[i];
    diag_error(b->diags, s->name_span, "the %s `%s` is declared twice", s->kind == STMT_SCENE ? "scene" : "effect",
               s->name);
    diag_also(b->diags, find_named(b->ast, s->kind, s->name)->name_span, "first declared here");
  }
}

static Scope *new_scope(Builder *b) {
  Scope *s = ARENA_NEW(b->arena, Scope);
  s->arena = b->arena;
  return s;
}

void check_name_is_new(Builder *b, const char *what, Name name, Name effect, Span span) {
  Name key = intern_printf(b, "%s `%s`", what, name);
  if (!b->named) b->named = new_scope(b);
  const Entity *old = scope_own(b->named, key, effect);
  if (!old) {
    scope_add(b->named, (Entity){.name = key, .effect = effect, .span = span});
    return;
  }
  diag_error(b->diags, span, "the %s is declared twice", key);
  diag_also(b->diags, old->span, "first declared here");
}

/* Key of a setting: equal for two statements of which the second would override the first; NULL: repetition is
 * allowed. */
static Name setting_key(Builder *b, const AstStmt *st, const char *owner) {
  switch (st->kind) {
    case STMT_SPAN: return intern_printf(b, "span");
    case STMT_METHOD: return intern_printf(b, "method");
    case STMT_TOLERANCE: return intern_printf(b, "tolerance");
    case STMT_OUTPUT: return intern_printf(b, "output");
    case STMT_LIKE: return intern_printf(b, "like");
    case STMT_MONITOR: return intern_printf(b, "monitor %s", st->lhs ? ast_text(b, st->lhs) : st->name);
    case STMT_MEASURE: return intern_printf(b, "measure %s", st->name);
    case STMT_START: return intern_printf(b, "start %s", ast_text(b, st->lhs));
    case STMT_EXACT: return intern_printf(b, "exact %s", ast_text(b, st->lhs));
    case STMT_SET: return intern_printf(b, "%s%s = ...", owner, ast_text(b, st->lhs));
    default: return NULL;
  }
}

static void check_setting(Builder *b, Scope *said, const AstStmt *st, const char *owner) {
  Name key = setting_key(b, st, owner);
  const Entity *old = key ? scope_own(said, key, NULL) : NULL;
  if (key && !old) scope_add(said, (Entity){.name = key, .span = st->span});
  if (!old) return;
  diag_error(b->diags, st->span, "`%s` is given twice: the second would win" HELP "leave out one of them", key);
  diag_also(b->diags, old->span, "first given here");
}

void check_set_once(Builder *b, const AstStmt *block) {
  Scope *said = new_scope(b);
  for (const AstStmt *x = block->body; x; x = x->next) {
    if (x->kind != STMT_USE && x->kind != STMT_METHOD) {
      check_setting(b, said, x, "");
      continue;
    }
    /* statements before `use none` have no effect */
    if (x->kind == STMT_USE && strcmp(x->name, "none") == 0) said = new_scope(b);
    if (x->kind == STMT_METHOD) check_setting(b, said, x, "");
    Scope *values = x->kind == STMT_METHOD ? new_scope(b) : said;
    const char *owner = x->kind == STMT_USE ? arena_printf(b->arena, "%s.", x->name) : "";
    for (const AstStmt *o = x->body; o; o = o->next) check_setting(b, values, o, owner);
  }
}

/* --- members of families --- */

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
               "ranges may lie one within the other, the narrower one last", text, before);
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
