/* Duplicate declarations: names, and settings of a scene or event. A second one, which would silently win, is an
 * error. */
#include "model/builder.h"

void check_names_once(Builder *b, const FileIndex *file) {
  const AstStmt *none = find_named(b->ast, STMT_EFFECT, "none");
  if (none)
    diag_error(b->diags, none->name_span,
               "an effect cannot be called `none`: `use none` turns all off" HELP "choose another name");
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
