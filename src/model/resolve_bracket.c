/* Poisson brackets {f, g}: a placeholder here, whose value symmetry/ finds once the equations of motion are known. */
#include "model/resolve_impl.h"

const char *reason_against_brackets(const Model *m) {
  if (!m->lagrangian)
    return "a bracket needs coordinates and momenta, and the model has no Lagrangian" HELP
           "a Hamiltonian is given by `hamiltonian = ...`";
  if (m->contacts.n || m->families.n)
    return "brackets of a model with contacts are not supported" HELP
           "let an event reflect it: `event bounce: y falling { y' = -e*y' }`";
  if (m->constraints.n)
    return "brackets of a model with constraints, which are Dirac's, are not supported" HELP
           "use coordinates without constraints";
  if (m->first_order && !m->hamiltonian)
    return "brackets where L is linear in the velocities are not supported" HELP
           "give the model's Hamiltonian: `momentum p of x`, `hamiltonian = ...`";
  for (uint32_t i = 0; i < m->states.n; i++)
    if (!m->states.at[i].coordinate)
      return "a bracket needs coordinates and momenta, and the model has states" HELP
             "write the states as parameters, where they do not change";
  return NULL;
}

static int is_unknown(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_ACC || s->kind == SYM_MULTIPLIER || s->kind == SYM_INPUT;
}

Value bracket_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const char *why = reason_against_brackets(b->m);
  AstId gi = ast_expr(b->ast, x->args)->next;
  if (!gi || ast_expr(b->ast, gi)->next)
    return refuse(b, x->span, "a bracket has two parts" HELP "`{f, g}`; of three, `{f, {g, h}}`");
  if (why) return refuse(b, x->span, "%s", why);
  const Value *f = value_of(ev, x->args), *g = value_of(ev, gi);
  if (!f->e || !g->e) return FAILED;
  for (int k = 0; k < 2; k++) {
    Expr part = k ? g->e : f->e;
    AstId id = k ? gi : x->args;
    if (expr_contains(b->g, part, is_unknown, NULL))
      return refuse(b, ast_expr(b->ast, id)->span,
                    "a bracket is one of functions of coordinates, momenta and t, and `%s` has accelerations, "
                    "multipliers or inputs" HELP "put the right side of the equation of motion in the place of x''",
                    ast_short(b, id));
  }
  SymId sym =
      declare_symbol(b, SYM_LOCAL, 0, intern_printf(b, "bracket %u", b->m->brackets.n + 1), SIGN_UNKNOWN, DIM_NONE);
  Dim action = dim_mul(b->dims, b->energy, b->dim_of.at[b->m->time]), both = dim_mul(b->dims, f->dim, g->dim);
  vec_push(b->arena, &b->m->brackets, ((ExpressionBracket){sym, f->e, g->e, x->span}));
  Value v = a_value(expr_symbol(b->g, sym)->node, dim_div(b->dims, both, action), 0);
  v.domain = domain_and(b, domain_and(b, f->domain, domain_of_derivative(b, f)),
                        domain_and(b, g->domain, domain_of_derivative(b, g)));
  b->dim_of.at[sym] = v.dim;
  return v;
}
