/* Ways out of mistakes: what a name that is not known here could have meant. */
#include "base/suggest.h"
#include "model/builder.h"

static int declares(const AstStmt *st, Name name) {
  switch (st->kind) {
    case STMT_COORD: case STMT_PARAM: case STMT_CONST: case STMT_INPUT: case STMT_STATE: case STMT_LET:
    case STMT_FUNCTION: case STMT_OBSERVE: return st->name == name;
    case STMT_MODEL: case STMT_INCLUDE: case STMT_LAGRANGIAN: case STMT_KINETIC: case STMT_POTENTIAL:
    case STMT_DISSIPATION: case STMT_FORCE: case STMT_FLOW: case STMT_CONSTRAINT: case STMT_SYMMETRY:
    case STMT_MAP: case STMT_EXPECT: case STMT_EVENT: case STMT_CONTACT: case STMT_FOR: case STMT_EFFECT:
    case STMT_REQUIRES: case STMT_EXCLUDES: case STMT_SCENE: case STMT_START: case STMT_EXACT: case STMT_SET:
    case STMT_USE: case STMT_SPAN: case STMT_METHOD: case STMT_TOLERANCE: case STMT_OUTPUT: case STMT_MONITOR:
    case STMT_LIKE: case STMT_STOP: return 0;
  }
  return 0;
}

const AstStmt *declared_in_use(const Builder *b, Name name, Name effect) {
  for (uint32_t i = 0; i < b->active.n; i++)
    if ((!b->active.at[i].effect || b->active.at[i].effect == effect) && declares(b->active.at[i].stmt, name))
      return b->active.at[i].stmt;
  return NULL;
}

int effect_declares(const AstStmt *effect, Name name) {
  for (const AstStmt *x = effect ? effect->body : NULL; x; x = x->next)
    if (declares(x, name)) return 1;
  return 0;
}

const AstStmt *declaring_effect(const Builder *b, Name name) {
  for (const AstStmt *e = b->ast->first; e; e = e->next)
    if (e->kind == STMT_EFFECT && effect_declares(e, name)) return e;
  return NULL;
}

void advise_unknown_name(Builder *b, Name name, Span span, Name effect, const char *declare) {
  const AstStmt *later = declared_in_use(b, name, effect);
  if (later && span.begin >= later->span.begin && span.end <= later->span.end) {
    diag_help(b->diags, "its own value cannot contain it");
    return;
  }
  if (later) {
    diag_help(b->diags, "here only names that stand before it are known; move its declaration up");
    diag_also(b->diags, later->name_span, "`%s` is declared here", name);
    return;
  }
  const AstStmt *owner = declaring_effect(b, name);
  if (owner) {
    diag_help(b->diags, "the effect `%s` declares it, but is not in use here: `use %s`", owner->name, owner->name);
    return;
  }
  Name *known = ARENA_ARRAY(b->arena, Name, b->scope.all.n + 2);
  uint32_t n = 0;
  for (uint32_t i = 0; i < b->scope.all.n; i++) {
    const Entity *e = &b->scope.all.at[i];
    if (!e->effect || e->effect == effect || !scope_own(&b->scope, e->name, NULL)) known[n++] = e->name;
  }
  known[n++] = "t";
  known[n++] = "pi";
  Name near = strcmp(name, "π") == 0 ? "pi" : suggest(name, known, n);
  if (near) diag_help(b->diags, "did you mean `%s`?", near);
  else if (declare) diag_help(b->diags, "declare it: `%s %s`", declare, name);
  else diag_help(b->diags, "declare it: `param %s = 1`, `coord %s` or `let %s = ...`", name, name, name);
}

void advise_unknown_member(Builder *b, Name effect, Name name) {
  const AstStmt *e = NULL;
  VEC(Name) effects = {0};
  for (const AstStmt *s = b->ast->first; s; s = s->next)
    if (s->kind == STMT_EFFECT) {
      vec_push(b->arena, &effects, s->name);
      if (s->name == effect) e = s;
    }
  if (!e) {
    Name near = suggest(effect, effects.at, effects.n);
    if (near) diag_help(b->diags, "did you mean `%s.%s`?", near, name);
    else diag_help(b->diags, "the model has no effect `%s`", effect);
    return;
  }
  VEC(Name) own = {0};
  StrBuf list = strbuf(b->arena);
  for (const AstStmt *x = e->body; x; x = x->next) {
    if (declares(x, name)) {
      diag_help(b->diags, "the effect is not in use here: `use %s`", effect);
      return;
    }
    if (x->name && declares(x, x->name)) {
      sb_printf(&list, "%s`%s`", own.n ? ", " : "", x->name);
      vec_push(b->arena, &own, x->name);
    }
  }
  Name near = suggest(name, own.at, own.n);
  if (near) diag_help(b->diags, "did you mean `%s.%s`?", effect, near);
  else if (own.n) diag_help(b->diags, "it declares %s", sb_text(&list));
  else diag_help(b->diags, "it declares nothing");
}

void warn_unit_is_constant(Builder *b, const AstUnit *u) {
  if (u->n != 1) return;
  int ambiguous;
  const Entity *e = scope_find(&b->scope, u->at[0].name, NULL, &ambiguous);
  if (!e || e->kind != ENT_CONST) return;
  diag_warning(b->diags, u->span, "`[%s]` is a unit here, not the constant `%s`", u->text, e->name);
  diag_help(b->diags, "an index touches what it belongs to: `x[%s]`", e->name);
}
