/* `action(x)` in outputs: a symbol for the action variable of a coordinate;
 * phase_space/action_outputs.c finds its curve, a run its value. */
#include "model/resolve_impl.h"

/* Whether s is a coordinate, and no momentum or state. */
static int is_coordinate_symbol(const Model *m, const Symbol *s) {
  if (s->kind != SYM_STATE) return s->kind == SYM_COORD;
  for (uint32_t k = 0; k < m->pairs.n; k++)
    if (m->pairs.at[k].q == s->index) return 1;
  return 0;
}

#define PLACES "may stand in `observe`, `output`, `monitor` and `measure`"

Value action_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  Model *m = b->m;
  const Value *v = value_of(ev, x->args);
  if (!v->e) return FAILED;
  if (ev->where < IN_OBSERVE)
    return refuse(b, x->span,
                  "an action variable is an integral over a whole motion, and cannot stand in the equations" HELP
                  "`action(x)` " PLACES);
  const char *why = reason_against_brackets(m);
  if (why && !(m->hamiltonian && !m->first_order))
    return refuse(b, x->span, "an action variable needs a phase space, as brackets do: %s", why);
  const Symbol *s = !v->n && expr_op(b->g, v->e) == EX_SYM ? expr_sym_of(b->g, v->e) : NULL;
  if (!s || !is_coordinate_symbol(m, s))
    return refuse(b, ast_expr(b->ast, x->args)->span,
                  "`action` takes the name of a coordinate, and `%s` is %s" HELP "write `action(%s)`",
                  ast_short(b, x->args),
                  v->n ? shape_text(b, v->n)
                  : s  ? "none"
                       : "an expression",
                  model_coordinates(m).at[0]);
  SymId sym = 0, of = expr_sym_id(b->g, v->e);
  Name name = s->name; /* symbols move when another is declared */
  for (uint32_t i = 0; i < m->actions.n; i++)
    if (m->actions.at[i].coordinate == of) sym = m->actions.at[i].sym;
  if (!sym) {
    sym = declare_symbol(b, SYM_LOCAL, 0, intern_printf(b, "action(%s)", name), SIGN_UNKNOWN,
                         dim_mul(b->dims, b->energy, b->dim_of.at[m->time]));
    vec_push(b->arena, &m->actions, ((ActionOutput){sym, of, name, x->span}));
  }
  return a_value(expr_symbol(b->g, sym)->node, b->dim_of.at[sym], 0);
}

int refuse_actions(Builder *b, const Value *v, Span span) {
  for (uint32_t i = 0; i < b->m->actions.n; i++)
    for (uint32_t k = 0; k < component_count(v); k++) {
      if (!expr_contains_sym(b->g, v->at[k], b->m->actions.at[i].sym)) continue;
      diag_error(b->diags, span, "an action variable has its value in a run only, and nothing is proved of it");
      diag_help(b->diags, "`action(%s)` " PLACES, b->m->actions.at[i].name);
      return 1;
    }
  return 0;
}
