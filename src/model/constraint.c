/* Constraints and contacts: each becomes c = 0 in the model, left side minus right side, with a multiplier that outputs can name.
 * A contact is closed*gap = 0 plus two events: impact (the gap falls to 0) and release (the multiplier does). */
#include "base/words.h"
#include "model/resolve_impl.h"

/* Dimension of lambda: lambda c is an energy; for velocity constraints a power. */
static Dim multiplier_dim(Builder *b, Dim dim, int holonomic) {
  Dim energy = holonomic ? b->energy : dim_per_second(b->dims, b->energy);
  return dim_div(b->dims, energy, dim);
}

/* 1 for a constraint without states and inputs; 0, reported, for others. */
static int can_be_held(Builder *b, Expr c, const char *what, Name name, Span span) {
  unsigned kinds = expr_kinds(b->g, c);
  if (kinds & 1u << SYM_STATE)
    return diag_error(b->diags, span, "the %s `%s` contains a state: constraints hold between coordinates" HELP "declare the constrained quantity as a coordinate",
                      what, name);
  if (kinds & 1u << SYM_INPUT)
    return diag_error(b->diags, span, "the %s `%s` contains an input, whose derivatives would be needed" HELP
                      "write the input as a formula of t, inside the constraint", what, name);
  return 1;
}

void add_scalar_constraint(Builder *b, Name name, Expr c, Dim dim, Span span) {
  Model *m = b->m;
  Constraint one = {.name = name, .span = span, .c = c, .dim = dim};
  int holonomic = !(expr_kinds(b->g, c) & 1u << SYM_VEL);
  one.multiplier = declare_symbol(b, SYM_MULTIPLIER, m->constraints.n, intern_printf(b, "lambda(%s)", name), SIGN_UNKNOWN,
                                  multiplier_dim(b, dim, holonomic));
  vec_push(b->arena, &m->constraints, one);
}

/* Shapes and dimensions of both sides; 0, reported, if they differ. The hint gives a bare number its unit. */
static int sides_agree(Builder *b, const AstStmt *st, const Value *l, const Value *r) {
  if (l->n != r->n)
    return diag_error(b->diags, st->span, "shapes do not match: the left side is %s, the right side is %s", shape_text(b, l->n), shape_text(b, r->n));
  if (l->n == ROTATION) {
    refuse_rotation(b, st->span, ast_text(b, st->lhs), TURN_EQUATION);
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
  Name name = member_name(b->ast, st->name, r.lo, r.n);
  check_name_is_new(b, "constraint", name, effect, st->name_span);
  Value left = resolve(b, st->lhs, IN_DYNAMICS, effect), right = resolve(b, st->rhs, IN_DYNAMICS, effect);
  if (!left.e || !right.e || !sides_agree(b, st, &left, &right)) return;
  b->m->domain = domain_and(b, b->m->domain, domain_and(b, left.domain, right.domain));
  Dim dim = is_zero(b, &left) ? right.dim : left.dim;
  scope_add(&b->constraints, (Entity){.index = b->m->constraints.n, .name = name, .effect = effect, .span = st->name_span, .parts = (uint8_t)left.n});
  for (uint32_t k = 0; k < component_count(&left); k++) {
    Expr c = expr_sub(b->g, left.at[k], right.at[k]);
    if (!can_be_held(b, c, "constraint", name, st->span)) return;
    add_scalar_constraint(b, left.n ? intern_printf(b, "%s.%c", name, "xyz"[k]) : name, c, dim, st->span);
  }
}

/* --- contacts --- */

static Expr symbol_node(const Builder *b, SymId s) { return expr_symbol(b->g, s)->node; }

/* Adds the input "NAME.closed", which only the runtime sets. */
static SymId add_switch(Builder *b, Name name, Span span) {
  Model *m = b->m;
  Input in = {.name = intern_printf(b, "%s.closed", name), .span = span, .value = expr_int(b->g, 0)};
  in.unit = unit_si(DIM_NONE, "");
  in.sym = declare_symbol(b, SYM_INPUT, m->inputs.n, in.name, SIGN_NONNEGATIVE, DIM_NONE);
  vec_push(b->arena, &m->inputs, in);
  return in.sym;
}

/* Adds an event: `value` falls through zero while the contact is closed (on = 1) or open (on = 0). */
static uint32_t add_switched_event(Builder *b, const Contact *c, const char *suffix, int on, Expr value, Span span) {
  ExprGraph *g = b->g;
  Expr closed = expr_fn2(g, EX_LT, expr_num(g, num_ratio(1, 2)), symbol_node(b, c->closed)), one = expr_int(g, 1);
  Event ev = {.name = intern_printf(b, "%s%s", c->name, suffix), .span = span, .direction = CROSS_FALLING};
  ev.g = on ? expr_select(g, closed, value, one) : expr_select(g, closed, one, value);
  vec_push(b->arena, &b->m->events, ev);
  return b->m->events.n - 1;
}

static int check_contact(Builder *b, const AstStmt *st, Name name, const Value *gap, const Value *e) {
  Span span = ast_expr(b->ast, st->lhs)->span, bounce = ast_expr(b->ast, st->rhs)->span;
  if (gap->n || e->n)
    return diag_error(b->diags, gap->n ? span : bounce, "this is %s, but a number is needed here", shape_text(b, gap->n ? gap->n : e->n));
  unsigned kinds = expr_kinds(b->g, gap->e);
  if (!can_be_held(b, gap->e, "contact", name, span)) return 0;
  if (kinds & 1u << SYM_VEL || !(kinds & 1u << SYM_COORD))
    return diag_error(b->diags, span, "the gap of the contact `%s` contains %s" HELP
                      "a gap is a distance between positions: `contact floor: y >= 0, restitution = 0.8`", name, kinds & 1u << SYM_VEL ? "a velocity" : "no coordinate");
  double value = expr_is_num(b->g, e->e) ? num_value(expr_number(b->g, e->e)) : 0.5;
  if (!expr_is_constant(b->g, e->e) || value < 0 || value > 1)
    return diag_error(b->diags, bounce, "a coefficient of restitution is a number from 0 to 1, or made of parameters");
  return dims_agree(b, e, &(Value){.e = expr_int(b->g, 1), .dim = DIM_NONE}, bounce) ||
         diag_error(b->diags, bounce, "a coefficient of restitution is a pure number, and this is %s", in_dim(b, e->dim));
}

void add_contact(Builder *b, const AstStmt *st, Name effect) {
  Model *m = b->m;
  IndexRange r = {0};
  if (st->dims && !resolve_indices(b, st->dims, effect, &r)) return;
  Name name = member_name(b->ast, st->name, r.lo, r.n);
  check_name_is_new(b, "constraint", name, effect, st->name_span);
  Value gap = resolve(b, st->lhs, IN_DYNAMICS, effect), e = resolve(b, st->rhs, IN_DYNAMICS, effect);
  if (!gap.e || !e.e || !check_contact(b, st, name, &gap, &e)) return;
  Contact c = {.name = name, .gap = gap.e, .restitution = e.e, .constraint = m->constraints.n};
  c.closed = add_switch(b, name, st->name_span);
  scope_add(&b->constraints, (Entity){.index = m->constraints.n, .name = name, .effect = effect, .span = st->name_span});
  add_scalar_constraint(b, name, expr_mul(b->g, symbol_node(b, c.closed), gap.e), gap.dim, st->span);
  c.impact = add_switched_event(b, &c, "", 0, gap.e, st->span);
  c.release = add_switched_event(b, &c, " opens", 1, symbol_node(b, m->constraints.at[c.constraint].multiplier), st->span);
  vec_push(b->arena, &m->contacts, c);
}

/* --- lambda(NAME) --- */

/* Name of a constraint in an argument: rod, rod[2], drag.rod. NULL: not a name, or an index without value. */
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
  return member_name(b->ast, x->name, at, n < 2 ? n : 2);
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
  if (ev->where < IN_OBSERVE)
    return refuse(b, x->span, "multipliers follow from the equations of motion, and cannot stand in them" HELP
                  "`lambda(NAME)` may stand in `observe`, `output` and `expect`");
  Span span = ast_expr(b->ast, x->args)->span;
  uint32_t errors = b->diags->errors;
  Name effect = ev->effect, name = named_constraint(ev, x->args, &effect);
  int ambiguous = 0;
  const Entity *e = name ? scope_find(&b->constraints, name, effect, &ambiguous) : NULL;
  if (!e) return b->diags->errors > errors ? FAILED : report_unknown(b, span, name);
  if (ambiguous) return refuse(b, span, "more than one effect in use has a constraint `%s`" HELP "say which: `lambda(%s.%s)`", name, e->effect, name);
  if (e->index >= b->m->constraints.n) return FAILED; /* refused */
  Value v = {.n = e->parts};
  for (uint32_t k = 0; k < component_count(&v); k++) v.at[k] = expr_symbol(b->g, b->m->constraints.at[e->index + k].multiplier)->node;
  v.dim = b->dim_of.at[b->m->constraints.at[e->index].multiplier];
  return v;
}
