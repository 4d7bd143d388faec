/* lambda(NAME): the multiplier of a constraint, or the force of a contact. */
#include <string.h>

#include "base/words.h"
#include "model/resolve_impl.h"

/* The name of a constraint or a contact: rod, rod[2], drag.rod; owner: the effect that is named. NULL: not a name,
 * or an index without value. */
static Name indexed_name(Eval *ev, AstId id, Name *owner) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  int64_t at[2] = {0};
  uint32_t n = 0;
  if (x->kind == AST_INDEX) {
    for (AstId i = x->args; i; i = ast_expr(b->ast, i)->next, n++)
      if (n < 2 && !whole_number(b, value_of(ev, i), i, &at[n])) return NULL;
    x = ast_expr(b->ast, x->a);
  }
  if (x->kind == AST_MEMBER && ast_expr(b->ast, x->a)->kind == AST_NAME) *owner = ast_expr(b->ast, x->a)->name;
  else if (x->kind != AST_NAME) return NULL;
  return member_name(b->ast, x->name, at, n < 2 ? n : 2);
}

/* The same, or the slip of a contact of a family, feet[2].slip, which the contact owns. */
static Name named_constraint(Eval *ev, AstId id, Name *owner) {
  const AstExpr *x = ast_expr(ev->b->ast, id);
  if (x->kind != AST_MEMBER || ast_expr(ev->b->ast, x->a)->kind != AST_INDEX) return indexed_name(ev, id, owner);
  return (*owner = indexed_name(ev, x->a, owner)) ? x->name : NULL;
}

static Value report_unknown(Builder *b, Span span, Name name) {
  uint32_t n = b->constraints.all.n;
  Name *known = ARENA_ARRAY(b->arena, Name, n + 1);
  for (uint32_t i = 0; i < n; i++) {
    const Entity *e = &b->constraints.all.at[i];
    int is_slip = strcmp(e->name, "slip") == 0 && e->effect;
    known[i] = is_slip ? intern_printf(b, "%s.slip", e->effect) : e->name;
  }
  Name near = name ? suggest(name, known, n) : NULL;
  if (name) diag_error(b->diags, span, "there is no constraint `%s`", name);
  else diag_error(b->diags, span, "`lambda` takes the name of a constraint");
  if (near) diag_help(b->diags, "did you mean `%s`?", near);
  else if (b->constraints.all.n) diag_help(b->diags, "the first one is `%s`", known[0]);
  else diag_help(b->diags, "the model has none; they are declared so: `constraint rod: x^2 + y^2 = l^2`");
  return FAILED;
}

const Entity *other_side(const Scope *constraints, Ast *ast, const Entity *e) {
  int is_slip = strcmp(e->name, "slip") == 0 && e->effect;
  Name name = is_slip ? e->effect : e->name;
  const char *index = strchr(name, '[');
  int stem = (int)(index ? (size_t)(index - name) : strlen(name));
  Name back = intern(ast->names, arena_printf(ast->arena, "%.*s.back%s", stem, name, index ? index : ""));
  return scope_own(constraints, is_slip ? e->name : back, is_slip ? back : e->effect);
}

/* Multipliers of the constraint or contact e, of tangents with the friction while they slip. */
static Value multipliers_of(const Builder *b, const Entity *e) {
  Value v = {.n = e->parts, .dim = b->dim_of.at[b->m->constraints.at[e->index].multiplier]};
  for (uint32_t k = 0; k < component_count(&v); k++)
    v.at[k] = expr_symbol(b->g, b->m->constraints.at[e->index + k].multiplier)->node;
  vec_each(const Contact, c, b->m->contacts) {
    uint32_t k = c->constraint - e->index;
    if (c->is_tangent && c->constraint >= e->index && k < component_count(&v))
      v.at[k] = expr_add(b->g, v.at[k], expr_symbol(b->g, c->force)->node);
  }
  return v;
}

Value multiplier_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  if (ev->where < IN_OBSERVE && !b->in_friction)
    return refuse(
        b, x->span,
        "multipliers follow from the equations of motion, and cannot stand in them" HELP
        "`lambda(NAME)` may stand in `observe`, `output` and `expect`, and alone in `constraint ... while lambda(NAME) "
        "> 0`; friction that follows it is `friction NAME on s: mu*abs(lambda(rail))`, or a guide, `guide rail: y = 0, "
        "friction = mu`");
  Span span = ast_expr(b->ast, x->args)->span;
  if (!b->in_friction) b->force_span = x->span;
  uint32_t errors = b->diags->errors;
  Name owner = NULL, name = named_constraint(ev, x->args, &owner);
  int ambiguous = 0;
  const Entity *e = !name   ? NULL
                    : owner ? scope_own(&b->constraints, name, owner)
                            : scope_find(&b->constraints, name, ev->effect, &ambiguous);
  if (!e)
    return b->diags->errors > errors
               ? FAILED
               : report_unknown(b, span, owner && name ? intern_printf(b, "%s.%s", owner, name) : name);
  if (ambiguous)
    return refuse(b, span, "more than one effect in use has a constraint `%s`" HELP "say which: `lambda(%s.%s)`", name,
                  e->effect, name);
  if (e->index >= b->m->constraints.n) return FAILED; /* refused */
  Value v = multipliers_of(b, e);
  const Entity *back = other_side(&b->constraints, b->ast, e);
  if (!back || back->index >= b->m->constraints.n) return v;
  Value w = multipliers_of(b, back);
  for (uint32_t k = 0; k < component_count(&v); k++)
    v.at[k] = v.n ? expr_add(b->g, v.at[k], w.at[k]) : expr_sub(b->g, v.at[k], w.at[k]);
  return v;
}
