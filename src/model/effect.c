/* Effects: lists for commands, the graph of `requires` and `excludes` with its checks, and the set in use. Contract:
 * effect.h. */
#include "model/effect.h"

#include "base/words.h"
#include "model/builder.h"

#define NONE UINT32_MAX

/* --- effects and scenes by name --- */

static Name nearest(const Ast *ast, AstStmtKind kind, const char *wrong) {
  VEC(Name) names = {0};
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == kind && s->name) vec_push(ast->arena, &names, s->name);
  return suggest(wrong, names.at, names.n);
}

static const char *all_scenes(const Ast *ast) {
  StrBuf list = strbuf(ast->arena);
  SceneList scenes = model_scenes(ast);
  for (uint32_t i = 0; i < scenes.n && i < 12; i++) sb_printf(&list, "%s`%s`", i ? ", " : "", scenes.at[i]);
  if (scenes.n > 12) sb_puts(&list, ", ...");
  return sb_text(&list);
}

void report_unnamed(const Ast *ast, AstStmtKind kind, Span span, const char *name) {
  const char *what = kind == STMT_SCENE ? "scene" : "effect";
  diag_error(ast->diags, span, "unknown %s `%s`", what, name);
  Name near = nearest(ast, kind, name);
  if (near) diag_help(ast->diags, "did you mean `%s`?", near);
  else if (kind == STMT_EFFECT) diag_help(ast->diags, "declare it: `effect %s { ... }`", name);
  else
    diag_help(ast->diags, "the scenes are %s%s", all_scenes(ast),
              span.end ? "" : "; a value is one word, name=value, and an option's stands behind it");
}

EffectList model_unused_effects(const Ast *ast) {
  VEC(Name) unused = {0};
  for (const AstStmt *e = ast->first; e; e = e->next) {
    if (e->kind != STMT_EFFECT || !e->name) continue;
    int used = 0;
    for (const AstStmt *s = ast->first; s; s = s->next)
      for (const AstStmt *x = s->kind == STMT_SCENE ? s->body : NULL; x; x = x->next)
        used |= x->kind == STMT_USE && x->name == e->name;
    if (!used) vec_push(ast->arena, &unused, e->name);
  }
  return (EffectList){unused.at, unused.n};
}

/* Recursion is bounded by the parser's limit on nested blocks. */
static int contains_claim(const AstStmt *list) {
  for (const AstStmt *s = list; s; s = s->next)
    if (s->kind == STMT_EXPECT || s->kind == STMT_SYMMETRY || s->kind == STMT_CANONICAL ||
        s->kind == STMT_HAMILTONIAN || (s->kind == STMT_FOR && contains_claim(s->body)))
      return 1;
  return 0;
}

EffectList model_claiming_effects(const Ast *ast) {
  VEC(Name) names = {0};
  if (contains_claim(ast->first)) vec_push(ast->arena, &names, NULL);
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == STMT_EFFECT && s->name && contains_claim(s->body)) vec_push(ast->arena, &names, s->name);
  return (EffectList){names.at, names.n};
}

/* --- graph of requirements and exclusions --- */

static uint32_t place_of(const EffectGraph *g, Name name) {
  for (uint32_t i = 0; i < g->n; i++)
    if (g->at[i].stmt->name == name) return i;
  return NONE;
}

EffectGraph effect_graph(const Ast *ast) {
  VEC(EffectNode) nodes = {0};
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == STMT_EFFECT && s->name) vec_push(ast->arena, &nodes, ((EffectNode){.stmt = s}));
  EffectGraph g = {nodes.at, nodes.n};
  for (uint32_t i = 0; i < g.n; i++)
    for (const AstStmt *x = g.at[i].stmt->body; x; x = x->next) {
      if (x->kind != STMT_REQUIRES && x->kind != STMT_EXCLUDES) continue;
      uint32_t other = place_of(&g, x->name);
      if (other == NONE) continue;
      if (x->kind == STMT_REQUIRES) {
        vec_push(ast->arena, &g.at[i].requires, other);
        vec_push(ast->arena, &g.at[other].required_by, i);
      } else {
        vec_push(ast->arena, &g.at[i].excludes, other);
      }
    }
  return g;
}

void effect_reach(const Ast *ast, const EffectGraph *g, uint32_t effect, int up, uint8_t *in) {
  uint32_t *queue = ARENA_ARRAY(ast->arena, uint32_t, g->n), n = 0;
  if (!in[effect]) queue[n++] = effect;
  in[effect] = 1;
  for (uint32_t at = 0; at < n; at++) {
    const EffectNode *node = &g->at[queue[at]];
    for (uint32_t k = 0; k < (up ? node->required_by.n : node->requires.n); k++) {
      uint32_t next = up ? node->required_by.at[k] : node->requires.at[k];
      if (!in[next]) queue[n++] = next;
      in[next] = 1;
    }
  }
}

static const AstStmt *statement_of(const EffectGraph *g, uint32_t i, AstStmtKind kind, uint32_t other) {
  const AstStmt *x = g->at[i].stmt->body;
  while (x->kind != kind || x->name != g->at[other].stmt->name) x = x->next;
  return x;
}

/* Reports that effect i requires or excludes `other`, where `user` brings both. */
static int report_relation(const Ast *ast, const EffectGraph *g, uint32_t user, uint32_t i, uint32_t other,
                           AstStmtKind kind) {
  Name one = g->at[i].stmt->name, two = g->at[other].stmt->name, by = g->at[user].stmt->name;
  const AstStmt *x = statement_of(g, i, kind, other);
  const char *word = kind == STMT_REQUIRES ? "requires" : "excludes";
  if (i == other) diag_error(ast->diags, x->span, "the effect `%s` %s itself", one, word);
  else if (kind == STMT_REQUIRES)
    diag_error(ast->diags, x->span, "the effects `%s` and `%s` require each other, directly or through others", one,
               two);
  else
    diag_error(ast->diags, x->span, "the effect `%s` excludes `%s`, and no scene can use `%s`, which brings both", one,
               two, by);
  diag_help(ast->diags, "leave out this `%s`, or make one effect of them", word);
  return 0;
}

/* 0, reported, if an effect requires itself, or brings two effects that exclude each other. in: scratch, one entry
 * an effect. */
static int check_effect(const Ast *ast, const EffectGraph *g, uint32_t user, uint8_t *in) {
  memset(in, 0, g->n);
  effect_reach(ast, g, user, 0, in);
  for (uint32_t i = 0; i < g->n; i++) {
    const EffectNode *node = &g->at[i];
    for (uint32_t k = 0; in[i] && k < node->requires.n; k++)
      if (node->requires.at[k] == user) return report_relation(ast, g, user, i, user, STMT_REQUIRES);
    for (uint32_t k = 0; in[i] && k < node->excludes.n; k++)
      if (in[node->excludes.at[k]]) return report_relation(ast, g, user, i, node->excludes.at[k], STMT_EXCLUDES);
  }
  return 1;
}

/* Reports unknown names in `requires` and `excludes`, also of effects that no scene uses. */
static void check_names(const Ast *ast, const EffectGraph *g) {
  for (uint32_t i = 0; i < g->n; i++)
    for (const AstStmt *x = g->at[i].stmt->body; x; x = x->next)
      if ((x->kind == STMT_REQUIRES || x->kind == STMT_EXCLUDES) && place_of(g, x->name) == NONE)
        report_unnamed(ast, STMT_EFFECT, x->name_span, x->name);
}

int effects_check(const Ast *ast) {
  EffectGraph g = effect_graph(ast);
  uint8_t *in = ARENA_ARRAY(ast->arena, uint8_t, g.n + 1);
  int fine = 1;
  check_names(ast, &g);
  for (uint32_t i = 0; i < g.n; i++)
    if (g.at[i].requires.n || g.at[i].excludes.n) fine &= check_effect(ast, &g, i, in);
  return fine;
}

/* --- effects in use --- */

int uses_effect(const Builder *b, Name effect) {
  for (uint32_t i = 0; i < b->m->effects.n; i++)
    if (b->m->effects.at[i] == effect) return 1;
  return 0;
}

int is_use_none(const AstStmt *st) { return st->kind == STMT_USE && strcmp(st->name, "none") == 0; }

/* Earlier `use` of the same effect in this scene, or NULL. */
static const AstStmt *used_before(const AstStmt *scene, const AstStmt *x) {
  const AstStmt *found = NULL;
  for (const AstStmt *s = scene->body; s != x; s = s->next)
    if (is_use_none(s)) found = NULL;
    else if (s->kind == STMT_USE && s->name == x->name) found = s;
  return found;
}

void collect_uses(Builder *b, const AstStmt *scene) {
  for (const AstStmt *x = scene->body; x; x = x->next) {
    if (x->kind != STMT_USE) continue;
    if (is_use_none(x)) {
      b->m->effects.n = 0;
      if (x->body) diag_error(b->diags, x->body->span, "`use none` turns all effects off, and takes no values");
    }
    else if (!find_named(b->ast, STMT_EFFECT, x->name)) report_unnamed(b->ast, STMT_EFFECT, x->name_span, x->name);
    else if (used_before(scene, x)) {
      diag_warning(b->diags, x->name_span, "the scene `%s` uses the effect `%s` twice", scene->name, x->name);
      diag_also(b->diags, used_before(scene, x)->name_span, "it is turned on here");
    }
    else if (!uses_effect(b, x->name)) vec_push(b->arena, &b->m->effects, x->name);
  }
}

void use_with_required(Builder *b, Name effect) {
  if (uses_effect(b, effect)) return;
  vec_push(b->arena, &b->m->effects, effect);
  for (uint32_t i = b->m->effects.n - 1; i < b->m->effects.n; i++) {
    const AstStmt *st = find_named(b->ast, STMT_EFFECT, b->m->effects.at[i]);
    for (const AstStmt *x = st ? st->body : NULL; x; x = x->next)
      if (x->kind == STMT_REQUIRES && !uses_effect(b, x->name) && find_named(b->ast, STMT_EFFECT, x->name))
        vec_push(b->arena, &b->m->effects, x->name);
  }
}

/* The `use` of an effect in the scene or its `like` ancestors, or NULL. */
static const AstStmt *use_of(const Builder *b, Name effect) {
  const AstStmt *found = NULL;
  for (const AstStmt **s = b->chain; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next)
      if (x->kind == STMT_USE && x->name == effect) found = x;
  return found;
}

/* Reports an exclusion that the scene violates. */
static void report_excluded(Builder *b, const AstStmt *effect, const AstStmt *x) {
  diag_error(b->diags, x->span, "the effects `%s` and `%s` exclude each other, and the scene `%s` uses both",
             effect->name, x->name, b->m->scene.name);
  diag_help(b->diags, "use one of them; `use none` turns off effects inherited by `like`");
  const AstStmt *use = use_of(b, x->name);
  if (use) diag_also(b->diags, use->name_span, "`%s` is used here", x->name);
}

void check_effect_needs(Builder *b, const AstStmt *effect) {
  for (const AstStmt *x = effect->body; x; x = x->next) {
    if (x->kind != STMT_REQUIRES && x->kind != STMT_EXCLUDES) continue;
    if (!find_named(b->ast, STMT_EFFECT, x->name)) {
      report_unnamed(b->ast, STMT_EFFECT, x->name_span, x->name);
    } else if (x->kind == STMT_REQUIRES && !uses_effect(b, x->name)) {
      diag_error(b->diags, x->span, "the effect `%s` requires `%s`, which the scene `%s` does not use", effect->name,
                 x->name, b->m->scene.name);
      diag_help(b->diags, "add `use %s` to the scene", x->name);
    } else if (x->kind == STMT_EXCLUDES && uses_effect(b, x->name)) {
      report_excluded(b, effect, x);
    }
  }
}

int names_off_effect(const Builder *b, AstId value) {
  Span all = ast_expr(b->ast, value)->span;
  for (AstId i = 1; i < b->ast->exprs.n; i++) {
    const AstExpr *x = ast_expr(b->ast, i);
    if (x->kind != AST_NAME || x->span.begin < all.begin || x->span.end > all.end || entity_named(b, x->name)) continue;
    const AstStmt *effect = find_named(b->ast, STMT_EFFECT, x->name);
    if (!effect) effect = declaring_effect(b, x->name);
    if (effect && !uses_effect(b, effect->name)) return 1;
  }
  return 0;
}
