/* Constraints: what they demand becomes c = 0 in the model, each with a multiplier that outputs can name. */
#include "base/suggest.h"
#include "model/resolve_impl.h"

/* The dimension of lambda: lambda c is an energy, or lambda r a power. */
static Dim multiplier_dim(Builder *b, Dim dim, int holonomic) {
  Dim energy = holonomic ? b->energy : dim_per_second(b->dims, b->energy);
  return dim_div(b->dims, energy, dim);
}

/* What an equation of motion cannot follow. */
static int is_refused(Builder *b, Expr c, Name name, Span span) {
  unsigned kinds = expr_kinds(b->g, c);
  if (kinds & 1u << SYM_STATE) {
    diag_error(b->diags, span, "the constraint `%s` contains a state: constraints hold between coordinates", name);
    diag_help(b->diags, "declare what it constrains as a coordinate");
    return 1;
  }
  if (kinds & 1u << SYM_INPUT) {
    diag_error(b->diags, span, "the constraint `%s` contains an input, whose derivatives would be needed", name);
    diag_help(b->diags, "write the input as a formula of t, inside the constraint");
    return 1;
  }
  return 0;
}

static void add_one(Builder *b, Name name, Expr c, Dim dim, Span span) {
  Model *m = b->m;
  if (is_refused(b, c, name, span)) return;
  Constraint one = {.name = name, .span = span, .c = c, .dim = dim};
  int holonomic = !(expr_kinds(b->g, c) & 1u << SYM_VEL);
  one.multiplier = declare_symbol(b, SYM_MULTIPLIER, m->constraints.n, intern_printf(b, "lambda(%s)", name), SIGN_UNKNOWN,
                                  multiplier_dim(b, dim, holonomic));
  vec_push(b->arena, &m->constraints, one);
}

/* A bare number takes the dimension of the other side. */
static int sides_agree(Builder *b, const AstStmt *st, const Value *l, const Value *r) {
  if (l->n != r->n) {
    diag_error(b->diags, st->span, "shapes do not match: the left side is %s, the right side is %s", shape_text(b, l->n), shape_text(b, r->n));
    return 0;
  }
  if (dims_agree(b, l, r, st->span)) return 1;
  diag_error(b->diags, st->span, "units do not match: the left side is %s, the right side %s", in_dim(b, l->dim), in_dim(b, r->dim));
  const Value *bare = r->bare ? r : l;
  if (bare->bare) diag_help(b->diags, "give the number its unit: `%s [%s]`", ast_text(b, bare == r ? st->rhs : st->lhs), dim_text(b->dims, bare == r ? l->dim : r->dim));
  explain_dims(b, l->dim, r->dim);
  return 0;
}

void add_constraint(Builder *b, const AstStmt *st, Name effect) {
  IndexRange r = {0};
  if (st->dims && !resolve_indices(b, st->dims, effect, &r)) return;
  Name name = member_name(b, st->name, r.lo, r.n);
  check_name_is_new(b, "constraint", name, effect, st->name_span);
  Value left = resolve(b, st->lhs, IN_DYNAMICS, effect), right = resolve(b, st->rhs, IN_DYNAMICS, effect);
  if (!left.e || !right.e || !sides_agree(b, st, &left, &right)) return;
  Dim dim = is_zero(b, &left) ? right.dim : left.dim;
  scope_add(&b->constraints, (Entity){.index = b->m->constraints.n, .name = name, .effect = effect, .span = st->name_span, .parts = (uint8_t)left.n});
  for (uint32_t k = 0; k < parts_of(&left); k++) {
    Expr c = expr_sub(b->g, left.at[k], right.at[k]);
    add_one(b, left.n ? intern_printf(b, "%s.%c", name, "xyz"[k]) : name, c, dim, st->span);
  }
}

/* --- lambda(NAME) --- */

/* The name of a constraint as an argument says it: rod, rod[2], drag.rod. NULL: it is none, or an index has no value. */
static Name named_constraint(Eval *ev, AstId id, Name *effect) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  int64_t at[2] = {0};
  uint32_t n = 0;
  if (x->kind == AST_INDEX) {
    for (AstId i = x->args; i; i = ast_expr(b->ast, i)->next, n++)
      if (n < 2 && !whole_number(b, value_of(ev, i), i, &at[n])) return NULL;
    x = ast_expr(b->ast, x->a);
  }
  if (x->kind == AST_MEMBER && ast_expr(b->ast, x->a)->kind == AST_NAME) *effect = ast_expr(b->ast, x->a)->name;
  else if (x->kind != AST_NAME) return NULL;
  return member_name(b, x->name, at, n < 2 ? n : 2);
}

static Value report_unknown(Builder *b, Span span, Name name) {
  Name *known = ARENA_ARRAY(b->arena, Name, b->constraints.all.n + 1);
  for (uint32_t i = 0; i < b->constraints.all.n; i++) known[i] = b->constraints.all.at[i].name;
  Name near = name ? suggest(name, known, b->constraints.all.n) : NULL;
  if (name) diag_error(b->diags, span, "there is no constraint `%s`", name);
  else diag_error(b->diags, span, "`lambda` takes the name of a constraint");
  if (near) diag_help(b->diags, "did you mean `%s`?", near);
  else if (b->constraints.all.n) diag_help(b->diags, "the first one is `%s`", known[0]);
  else diag_help(b->diags, "the model has none; they are declared so: `constraint rod: x^2 + y^2 = l^2`");
  return FAILED;
}

Value multiplier_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  if (!arity_is(ev, x, 1)) return FAILED;
  if (ev->where < IN_OBSERVE) {
    diag_error(b->diags, x->span, "multipliers follow from the equations of motion, and cannot stand in them");
    diag_help(b->diags, "`lambda(NAME)` may stand in `observe`, `output` and `expect`");
    return FAILED;
  }
  Span span = ast_expr(b->ast, x->args)->span;
  uint32_t errors = b->diags->errors;
  Name effect = ev->effect, name = named_constraint(ev, x->args, &effect);
  int ambiguous = 0;
  const Entity *e = name ? scope_find(&b->constraints, name, effect, &ambiguous) : NULL;
  if (!e) return b->diags->errors > errors ? FAILED : report_unknown(b, span, name);
  if (ambiguous) {
    diag_error(b->diags, span, "more than one effect in use has a constraint `%s`", name);
    diag_help(b->diags, "say which: `lambda(%s.%s)`", e->effect, name);
    return FAILED;
  }
  if (e->index >= b->m->constraints.n) return FAILED; /* refused */
  Value v = {.n = e->parts};
  for (uint32_t k = 0; k < parts_of(&v); k++) v.at[k] = expr_symbol(b->g, b->m->constraints.at[e->index + k].multiplier)->node;
  v.dim = b->dim_of.at[b->m->constraints.at[e->index].multiplier];
  return v;
}
