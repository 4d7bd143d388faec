/* `method NAME(option = value, ...)` of a scene: checked against the table of base/method_table.h and against the
 * model (states, constraints), and stored in the scene with names and values as the runtime expects them. */
#include <math.h>
#include <string.h>

#include "base/method_table.h"
#include "base/words.h"
#include "model/builder.h"

/* "`a`, `b`": the words up to NULL. */
static const char *listed(const Builder *b, const char *const *words) {
  StrBuf list = strbuf(b->arena);
  for (const char *const *w = words; *w; w++) sb_printf(&list, "%s`%s`", w == words ? "" : ", ", *w);
  return sb_text(&list);
}

/* The method's entry in the table; NULL for one that only the runtime knows (gsl-*), and, reported, for an unknown
 * one. */
static const MethodInfo *known_method(Builder *b, const AstStmt *st) {
  const MethodInfo *m = method_find(st->name, strlen(st->name));
  if (m || method_may_be_gsl(st->name)) return m;
  const char *near = method_suggest(b->arena, st->name);
  diag_error(b->diags, st->name_span, "unknown method `%s`", st->name);
  if (near) diag_help(b->diags, "did you mean `%s`? `lagc methods` lists them", near);
  else diag_help(b->diags, "`lagc methods` lists them; without a `method` the run chooses one");
  return NULL;
}

static void unknown_option(Builder *b, const MethodInfo *m, const AstExpr *name) {
  VEC(Name) names = {0};
  for (const MethodOption *o = m->options; o->name; o++) vec_push(b->arena, &names, o->name);
  Name near = suggest(name->name, names.at, names.n);
  vec_push(b->arena, &names, NULL);
  diag_error(b->diags, name->span, "the method `%s` has no option `%s`", m->name, name->name);
  if (strcmp(name->name, "tol") == 0 || strcmp(name->name, "rtol") == 0 || strcmp(name->name, "tolerance") == 0)
    diag_help(b->diags, "the tolerance is a statement of its own: `tolerance 1e-8`");
  else if (near) diag_help(b->diags, "did you mean `%s`? `lagc methods` lists the options", near);
  else if (names.at[0]) diag_help(b->diags, "its options: %s; `lagc methods` explains them", listed(b, names.at));
  else diag_help(b->diags, "it has no options");
}

static void check_value(Builder *b, const MethodOption *o, const Option *given, Span span) {
  char allowed[128];
  for (const char *const *c = o->choices; c && given->text && *c; c++)
    if (strcmp(*c, given->text) == 0) return;
  if (given->text && !o->choices) {
    diag_error(b->diags, span, "the option `%s` is a number" HELP "write `%s = 0.01`", o->name, o->name);
  } else if (method_option_refuses(o, given->text ? NAN : given->value, b->m->constraints.n > 0, allowed)) {
    const char *value = given->text ? given->text : arena_printf(b->arena, "%.6g", given->value);
    diag_error(b->diags, span, "the option `%s` cannot be %s%s%s" HELP "%s", o->name, given->text ? "`" : "", value,
               given->text ? "`" : "", allowed);
  }
}

static void read_method_option(Builder *b, const MethodInfo *m, const AstStmt *st) {
  const AstExpr *l = ast_expr(b->ast, st->lhs), *r = ast_expr(b->ast, st->rhs);
  Unit unit = unit_si(DIM_ANY, "");
  if (l->kind != AST_NAME) {
    diag_error(b->diags, l->span, "an option is `name = value`");
    return;
  }
  Option opt = {.name = l->name, .text = r->kind == AST_NAME ? r->name : NULL};
  if (!opt.text) opt.value = resolve_number(b, st->rhs, &unit, "an option", NULL);
  const MethodOption *o = m ? method_option(m, l->name) : NULL;
  if (o) check_value(b, o, &opt, r->span);
  else if (m) unknown_option(b, m, l);
  vec_push(b->arena, &b->m->scene.options, opt);
}

void scene_method(Builder *b, const AstStmt *st) {
  Scene *sc = &b->m->scene;
  const MethodInfo *m = known_method(b, st);
  sc->method = st->name;
  sc->method_span = st->name_span;
  sc->options.n = 0;
  int flows_alone = m && (m->flags & METHOD_FLOWS) && !b->m->coords.n;
  int may_split = m && (m->flags & METHOD_SPLITS) && b->m->hamiltonian; /* the runtime judges whether H separates */
  if (m && (m->flags & METHOD_NO_STATES) && b->m->states.n && !flows_alone && !may_split) {
    if (b->m->first_order) {
      diag_error(b->diags, st->name_span, "the method `%s` needs %s", m->name,
                 b->m->hamiltonian ? "velocities, and the model gives its Hamiltonian"
                                   : "momenta beside coordinates, and L is linear in the velocities");
      diag_help(b->diags, "`gauss` is symplectic there; `rk45` and `dop853` can, too");
      return;
    }
    diag_error(b->diags, st->name_span, "the method `%s` cannot integrate a model with states", m->name);
    diag_also(b->diags, b->m->states.at[0].span, "here is a state");
    diag_help(b->diags, "`rk45` and `dop853` can");
  }
  if (m && !(m->flags & METHOD_CONSTRAINTS) && b->m->constraints.n) {
    diag_error(b->diags, st->name_span, "the method `%s` cannot hold constraints", m->name);
    diag_also(b->diags, b->m->constraints.at[0].span, "here is a constraint");
    diag_help(b->diags, "`rk45`, `dop853` and `variational` can");
  }
  for (const AstStmt *o = st->body; o; o = o->next) read_method_option(b, m, o);
}
