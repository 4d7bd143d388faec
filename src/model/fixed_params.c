/* --fix: parameters that are compiled in as numbers. Marks them, evaluates them with the scene's values, numbers the
 * others. */
#include "model/builder.h"
#include "base/words.h"
#include "sym/expr_eval.h"

/* --- which parameters --- */

/* Parameter called `g` or `drag.c`; NULL, reported, when there is none. *off: only an effect that is off declares it
 * (a note). */
static const Entity *find_param(Builder *b, const char *word, int *off) {
  const char *dot = strchr(word, '.');
  Name effect = dot ? intern(b->ast->names, arena_strndup(b->arena, word, (size_t)(dot - word))) : NULL;
  Name name = intern(b->ast->names, dot ? dot + 1 : word);
  int ambiguous = 0;
  const Entity *e = effect ? scope_own(&b->scope, name, effect) : scope_find(&b->scope, name, NULL, &ambiguous);
  const AstStmt *owner = effect ? find_named(b->ast, STMT_EFFECT, effect) : declaring_effect(b, name);
  *off = !e && owner && effect_declares(owner, name);
  if (*off) {
    diag_note(b->diags, (Span){0}, "--fix %s: the effect `%s` is off in the scene `%s`, and has nothing to fix there",
              word, owner->name, b->m->scene.name);
    return NULL;
  }
  if (e && !ambiguous && e->kind == ENT_PARAM) return e;
  if (ambiguous) {
    diag_error(b->diags, (Span){0}, "--fix %s: more than one effect in use declares it" HELP "say which: --fix %s.%s",
               word, e->effect, name);
  } else if (e) {
    diag_error(b->diags, (Span){0}, "--fix %s: this is %s; only parameters can be fixed", word, ent_kind_text(e->kind));
    if (e->kind == ENT_CONST) diag_help(b->diags, "constants are set when compiling: -D %s=...", word);
  } else {
    VEC(Name) known = {0};
    vec_each(const Entity, x, b->scope.all)
      if (x->kind == ENT_PARAM)
        vec_push(b->arena, &known, x->effect ? intern_printf(b, "%s.%s", x->effect, x->name) : x->name);
    Name near = suggest(word, known.at, known.n);
    diag_error(b->diags, (Span){0}, "--fix %s: the model has no such parameter", word);
    if (near) diag_help(b->diags, "did you mean `%s`?", near);
    else
      diag_help(b->diags, "a family is fixed by its name, a parameter of an effect by `effect.name`, all by --fix all");
  }
  return NULL;
}

static int names_param(const Builder *b, const char *word) {
  const Entity *e = scope_own(&b->scope, intern(b->ast->names, word), NULL);
  return e && e->kind == ENT_PARAM;
}

/* Leaves parameters whose members families of contacts read at indices; a note names the first. */
static void leave_indexed(Builder *b) {
  Name first = NULL;
  for (uint32_t i = 0; i < b->scope.all.n; i++) {
    const Entity *x = &b->scope.all.at[i];
    if (x->kind != ENT_PARAM || !read_by_contact_family(b, x)) continue;
    for (uint32_t k = 0; k < entity_size(x); k++) b->m->params.at[x->index + k].fixed = 0;
    first = first ? first : x->name;
  }
  if (first)
    diag_note(b->diags, (Span){0},
              "--fix all leaves `%s` a parameter: a family of contacts reads its members in a loop", first);
}

/* Sets Param.fixed for a comma-separated list; parameters of effects that are off are skipped. 0 on a mistake,
 * reported. */
static int mark(Builder *b, const char *words) {
  uint32_t errors = b->diags->errors;
  for (const char *s = words; *s;) {
    size_t n = strcspn(s, ", ");
    const char *word = arena_strndup(b->arena, s, n);
    int off = 0;
    const Entity *e = NULL;
    s += n + strspn(s + n, ", ");
    if (strcmp(word, "all") == 0 && !names_param(b, word)) {
      for (uint32_t i = 0; i < b->m->params.n; i++) b->m->params.at[i].fixed = 1;
      leave_indexed(b);
    } else if (n && (e = find_param(b, word, &off)) != NULL)
      for (uint32_t i = 0; i < entity_size(e); i++) b->m->params.at[e->index + i].fixed = 1;
  }
  return b->diags->errors == errors;
}

/* --- their values --- */

static int is_free_param(const Symbol *s, const void *data) {
  return s->kind == SYM_PARAM && !((const Model *)data)->params.at[s->index].fixed;
}

/* Sets Param.number of fixed parameters: exact if the value is rational, a double if it contains pi or other
 * parameters. */
static void evaluate(Builder *b) {
  Model *m = b->m;
  long double *x = model_constants(m);
  vec_each(Param, p, m->params) {
    expr_eval(b->g, &p->value, 1, x, &x[p->sym]);
    if (!p->fixed) continue;
    p->number = expr_is_num(b->g, p->value) ? expr_number(b->g, p->value) : num_double((double)x[p->sym]);
    if (!expr_contains(b->g, p->value, is_free_param, m)) continue;
    diag_error(b->diags, p->span, "--fix: `%s` depends on other parameters, which are not fixed", p->name);
    diag_help(b->diags, "fix them, too, or use --fix all; parameters that depend only on fixed ones need no --fix");
  }
}

void fix_params(Builder *b, const char *words) {
  Model *m = b->m;
  uint32_t place = 0;
  if (words && mark(b, words)) evaluate(b);
  for (uint32_t i = 0; i < m->params.n; i++) {
    m->params.at[i].place = place;
    place += !m->params.at[i].fixed;
  }
  m->nfixed = m->params.n - place;
}
