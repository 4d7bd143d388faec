/* Constraints and contacts: each becomes c = 0 in the model, left side minus right side, with a multiplier that
 * outputs can name. A contact is closed*gap = 0 plus two events: impact (the gap falls to 0) and release (the
 * multiplier does). A constraint with `while` is closed*c = 0 with the same two events, of a function that is
 * positive where the condition is true. */
#include <math.h>

#include "model/resolve_impl.h"

/* 1 for a constraint without states; 0, reported, for others. Its second derivative needs rates of inputs. */
static int can_be_held(Builder *b, Expr c, const char *what, Name name, Span span) {
  unsigned kinds = expr_kinds(b->g, c);
  if (kinds & 1u << SYM_STATE)
    return diag_error(b->diags, span,
                      "the %s `%s` contains a state: constraints hold between coordinates" HELP
                      "declare the constrained quantity as a coordinate",
                      what, name);
  if (kinds & 1u << SYM_INPUT) want_rates_of(b, c, kinds & 1u << SYM_VEL ? 1 : 2);
  return 1;
}

/* Shapes and dimensions of both sides; 0, reported, if they differ. The hint gives a bare number its unit. */
static int sides_agree(Builder *b, const AstStmt *st, const Value *l, const Value *r) {
  if (l->n != r->n) return report_shapes(b, st->span, l->n, r->n), 0;
  if (l->n == ROTATION) {
    refuse_rotation(b, st->span, ast_text(b, st->lhs), TURN_EQUATION);
    return 0;
  }
  if (dims_agree(b, l, r, st->span)) return 1;
  report_units(b, st->span, l->dim, r->dim);
  const Value *bare = r->bare ? r : l;
  if (bare->bare)
    diag_help(b->diags, "give the number its unit: `%s [%s]`", ast_text(b, bare == r ? st->rhs : st->lhs),
              dim_text(b->dims, bare == r ? l->dim : r->dim));
  explain_dims(b, l->dim, r->dim);
  return 0;
}

/* --- contacts --- */

static Expr symbol_node(const Builder *b, SymId s) { return expr_symbol(b->g, s)->node; }

/* Adds the input "NAME.WHAT", which only the runtime sets. */
static SymId add_signal(Builder *b, Name name, const char *what, ExprSign sign, Dim dim, Span span) {
  Model *m = b->m;
  Input in = {.name = intern_printf(b, "%s.%s", name, what), .span = span, .value = expr_int(b->g, 0)};
  in.unit = unit_si(dim, "");
  in.sym = declare_symbol(b, SYM_INPUT, m->inputs.n, in.name, sign, dim);
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

/* Adds an event of a tangent: the runtime says when its value counts. */
static uint32_t add_named_event(Builder *b, Name name, const char *suffix, Expr value, Span span) {
  vec_push(
      b->arena, &b->m->events,
      ((Event){.name = intern_printf(b, "%s%s", name, suffix), .span = span, .direction = CROSS_FALLING, .g = value}));
  return b->m->events.n - 1;
}

int check_contact(Builder *b, const AstStmt *st, Name name, const Value *gap, const Value *e) {
  Span span = ast_expr(b->ast, st->lhs)->span, bounce = ast_expr(b->ast, st->rhs)->span;
  if (!need_number(b, span, gap->n) || !need_number(b, bounce, e->n)) return 0;
  unsigned kinds = expr_kinds(b->g, gap->e);
  if (!can_be_held(b, gap->e, "contact", name, span)) return 0;
  if (kinds & 1u << SYM_VEL || !(kinds & 1u << SYM_COORD))
    return diag_error(b->diags, span,
                      "the gap of the contact `%s` contains %s" HELP
                      "a gap is a distance between positions: `contact floor: y >= 0, restitution = 0.8`",
                      name, kinds & 1u << SYM_VEL ? "a velocity" : "no coordinate");
  double value = expr_is_num(b->g, e->e) ? num_value(expr_number(b->g, e->e)) : 0.5;
  const unsigned of_impact =
      1u << SYM_PARAM | 1u << SYM_CONST | 1u << SYM_COORD | 1u << SYM_VEL | 1u << SYM_INPUT | 1u << SYM_TIME;
  if (expr_kinds(b->g, e->e) & ~of_impact || value < 0 || value > 1)
    return diag_error(b->diags, bounce,
                      "a coefficient of restitution is a number from 0 to 1, made of parameters, and of positions and "
                      "velocities at the impact");
  if (expr_is_constant(b->g, e->e))
    add_size(b, e->e, arena_printf(b->arena, "the contact `%s` has a restitution", name), bounce, 1);
  return dims_agree(b, e, &(Value){.e = expr_int(b->g, 1), .dim = DIM_NONE}, bounce) ||
         diag_error(b->diags, bounce, "a coefficient of restitution is a pure number, and this is %s",
                    in_dim(b, e->dim));
}

static const char *kind_of(const AstStmt *st) { return st->kind == STMT_GUIDE ? "guide" : "contact"; }

/* A pure number made of parameters, at least 0 and at most `most`; what: its name. */
int check_pure_number(Builder *b, const AstStmt *st, AstId id, const Value *x, double most, const char *what) {
  Span span = ast_expr(b->ast, id)->span;
  if (!x->e) return 0;
  if (!need_number(b, span, x->n)) return 0;
  double value = expr_is_num(b->g, x->e) ? num_value(expr_number(b->g, x->e)) : 0;
  if (!expr_is_constant(b->g, x->e)) return diag_error(b->diags, span, "%s is a number, or made of parameters", what);
  if (value < 0 || value > most)
    return diag_error(b->diags, span, most > 1 ? "%s is at least 0" : "%s is a number from 0 to 1", what);
  add_size(b, x->e, arena_printf(b->arena, "the %s `%s` has %s", kind_of(st), st->name, what), span, !(most > 1));
  return dims_agree(b, x, &(Value){.e = expr_int(b->g, 1), .dim = DIM_NONE}, span) ||
         diag_error(b->diags, span, "%s is a pure number, and this is %s", what, in_dim(b, x->dim));
}

int check_slip(Builder *b, const AstStmt *st, AstId id, const Value *slip, const Constraint *gap) {
  Span span = ast_expr(b->ast, id)->span;
  Name name = st->name;
  Dim speed = gap ? dim_per_second(b->dims, gap->dim) : DIM_NONE;
  if (!slip->e) return 0;
  if (slip->n && slip->n != 2)
    return diag_error(b->diags, span,
                      "this is %s, but a number or two are needed here" HELP
                      "the slip has one component in a plane, and two along a surface in space: `slip = (x', y')`",
                      shape_text(b, slip->n));
  for (uint32_t k = 0; k < component_count(slip); k++) {
    if (!can_be_held(b, slip->at[k], arena_printf(b->arena, "slip of the %s", kind_of(st)), name, span)) return 0;
    if (!(expr_kinds(b->g, slip->at[k]) & 1u << SYM_VEL))
      return diag_error(b->diags, span,
                        "the slip of the %s `%s` contains no velocity" HELP
                        "it is the velocity of the point of contact along the surface: `slip = x' + r*th'` of a wheel",
                        kind_of(st), name);
  }
  return !gap || dims_agree(b, slip, &(Value){.e = gap->c, .dim = speed}, span) ||
         diag_error(b->diags, span,
                    "the slip of the %s `%s` is %s, its gap per second %s" HELP
                    "friction compares two forces: let the gap be the distance from the surface, and the slip the "
                    "velocity along it",
                    kind_of(st), name, in_dim(b, slip->dim), in_dim(b, speed));
}

void push_tangent(Builder *b, const AstStmt *st, Name owner, Contact t, Expr pressed, Dim dim, const char *component) {
  Model *m = b->m;
  t.name = intern_printf(b, "%s.slip%s", owner, component);
  t.constraint = m->constraints.n;
  t.closed = add_signal(b, t.name, "sticks", SIGN_NONNEGATIVE, DIM_NONE, st->name_span);
  add_scalar_constraint(b, t.name, expr_mul(b->g, symbol_node(b, t.closed), t.gap), dim, st->span);
  t.force = add_signal(b, t.name, "force", SIGN_UNKNOWN, multiplier_dim(b, dim, 0), st->name_span);
  Expr held = expr_add(b->g, symbol_node(b, m->constraints.at[t.constraint].multiplier), symbol_node(b, t.force));
  Expr limit = expr_mul(b->g, t.hold, pressed), size = expr_fn(b->g, EX_ABS, held);
  t.impact = add_named_event(b, owner, intern_printf(b, " sticks%s", component), t.gap, st->span);
  t.release =
      add_named_event(b, owner, intern_printf(b, " slips%s", component), expr_sub(b->g, limit, size), st->span);
  if (t.parts == 1) {
    t.turn = add_named_event(b, owner, " turns", t.normal[0], st->span);
    m->events.at[t.turn].direction = CROSS_BOTH;
  }
  vec_push(b->arena, &m->contacts, t);
}

#define FRICTION_FORM                                                                                                \
  "`contact NAME: y >= 0, restitution = 0.5, friction = mu, slip = x'`, and perhaps `static = mu_s`, `tangential = " \
  "e_t` or `law = poisson`"

/* Reports options that stand twice, or do not go together. */
int check_contact_options(Builder *b, const AstStmt *st) {
  for (AstId i = st->args; i; i = ast_expr(b->ast, i)->next) {
    const AstExpr *x = ast_expr(b->ast, i);
    if (ast_option_value(b->ast, st, x->name) != x->args)
      return diag_error(b->diags, x->span, "the contact `%s` has `%s` twice", st->name, x->name);
  }
  int mu = ast_option_value(b->ast, st, "friction") != 0, slip = ast_option_value(b->ast, st, "slip") != 0;
  if (!mu || !slip)
    return diag_error(b->diags, ast_expr(b->ast, st->args)->span,
                      "the contact `%s` has %s" HELP
                      "a contact has with friction also the velocity of slipping: " FRICTION_FORM,
                      st->name,
                      mu     ? "friction and no slip"
                      : slip ? "a slip and no friction"
                             : "neither friction nor slip");
  AstId law = ast_option_value(b->ast, st, "law");
  if (law && ast_option_value(b->ast, st, "tangential"))
    return diag_error(b->diags, ast_expr(b->ast, law)->span,
                      "`tangential` is a law of its own, for both velocities after an impact" HELP
                      "leave `law` out, or `tangential`");
  return 1;
}

/* The law of impact that st names; -1, reported: it is none. */
static int impact_law(Builder *b, const AstStmt *st) {
  static const char *const laws[] = {"stronge", "poisson", "newton"};
  AstId law = ast_option_value(b->ast, st, "law");
  for (size_t i = 0; law && i < sizeof laws / sizeof *laws; i++)
    if (strcmp(ast_expr(b->ast, law)->name, laws[i]) == 0) return (int)i;
  if (law) diag_error(b->diags, ast_expr(b->ast, law)->span, "a law of impact is `stronge`, `poisson` or `newton`");
  return law ? -1 : 0;
}

Expr coefficient(Builder *b, const AstStmt *st, Name effect, const char *word, double most, const char *what,
                        Expr other) {
  AstId id = ast_option_value(b->ast, st, word);
  if (!id) return other;
  Value x = resolve(b, id, IN_DYNAMICS, effect);
  return check_pure_number(b, st, id, &x, most, what) ? x.e : 0;
}

Expr static_coefficient(Builder *b, const AstStmt *st, Name effect, Expr friction) {
  AstId most = ast_option_value(b->ast, st, "static");
  Expr hold = coefficient(b, st, effect, "static", HUGE_VAL, "a coefficient of static friction", friction);
  if (most && hold && friction) add_static_limit(b, hold, friction, ast_expr(b->ast, most)->span);
  return hold;
}

/* The friction of contact c: its tangents. */
static void add_tangents(Builder *b, const AstStmt *st, Name effect, const Contact *c) {
  static const char *const components[] = {".x", ".y"};
  Model *m = b->m;
  if (!check_contact_options(b, st)) return;
  AstId v = ast_option_value(b->ast, st, "slip");
  Contact t = {.is_tangent = 1, .law = impact_law(b, st)};
  t.friction = coefficient(b, st, effect, "friction", HUGE_VAL, "a coefficient of friction", 0);
  t.hold = static_coefficient(b, st, effect, t.friction);
  t.restitution = coefficient(b, st, effect, "tangential", 1, "a tangential restitution", expr_int(b->g, 0));
  Value slip = resolve(b, v, IN_DYNAMICS, effect);
  if (!check_slip(b, st, v, &slip, &m->constraints.at[c->constraint]) || !t.friction || !t.hold || !t.restitution ||
      t.law < 0)
    return;
  scope_add(&b->constraints, (Entity){.index = m->constraints.n,
                                      .name = intern_printf(b, "slip"),
                                      .effect = c->name,
                                      .span = st->name_span,
                                      .parts = (uint8_t)slip.n});
  Expr pressed = symbol_node(b, m->constraints.at[c->constraint].multiplier);
  for (uint32_t k = 0; k < component_count(&slip); k++) {
    t.gap = slip.at[k];
    push_tangent(b, st, c->name, t, pressed, slip.dim, slip.n ? components[k] : "");
  }
  if (!m->dissipation_span.end) m->dissipation_span = st->span;
}

/* Adds the contact `name` of a gap. */
static Contact push_contact(Builder *b, const AstStmt *st, Name name, Name effect, const Value *gap, Expr restitution) {
  Model *m = b->m;
  Contact c = {.name = name, .gap = gap->e, .restitution = restitution, .constraint = m->constraints.n};
  c.closed = add_signal(b, name, "closed", SIGN_NONNEGATIVE, DIM_NONE, st->name_span);
  scope_add(&b->constraints,
            (Entity){.index = m->constraints.n, .name = name, .effect = effect, .span = st->name_span});
  add_scalar_constraint(b, name, expr_mul(b->g, symbol_node(b, c.closed), gap->e), gap->dim, st->span);
  c.impact = add_switched_event(b, &c, "", 0, gap->e, st->span);
  c.release =
      add_switched_event(b, &c, " opens", 1, symbol_node(b, m->constraints.at[c.constraint].multiplier), st->span);
  vec_push(b->arena, &m->contacts, c);
  return c;
}

/* Declares the name of a refused constraint, so that lambda(NAME) is no second error. */
static void add_refused(Builder *b, const AstStmt *st, Name name, Name effect) {
  scope_add(&b->constraints, (Entity){.index = UINT32_MAX, .name = name, .effect = effect, .span = st->name_span});
}

void add_contact(Builder *b, const AstStmt *st, Name effect) {
  IndexRange r = {0};
  if (is_contact_family(b, st)) {
    add_contact_family(b, st, effect);
    return;
  }
  if (st->dims && !resolve_indices(b, st->dims, effect, &r)) return;
  Name name = member_name(b->ast, st->name, r.lo, r.n);
  check_name_is_new(b, "constraint", name, effect, st->name_span);
  Value gap = resolve(b, st->lhs, IN_DYNAMICS, effect), e = resolve(b, st->rhs, IN_DYNAMICS, effect);
  if (!gap.e || !e.e || !check_contact(b, st, name, &gap, &e)) {
    add_refused(b, st, name, effect);
    return;
  }
  Contact c = push_contact(b, st, name, effect, &gap, e.e);
  if (st->args) add_tangents(b, st, effect, &c);
}

/* --- constraints with `while` --- */

/* A function that is positive where condition x is true, and negative where it is false; 0: x is an equation, or
 * none. */
static Expr margin_of(Builder *b, Expr x) {
  ExprGraph *g = b->g;
  ExprOp op = expr_op(g, x);
  if (op == EX_LT || op == EX_LE) return expr_sub(g, expr_arg(g, x, 1), expr_arg(g, x, 0));
  if (op != EX_NOT && op != EX_AND && op != EX_OR) return 0;
  Expr first = margin_of(b, expr_arg(g, x, 0)), second = first && op != EX_NOT ? margin_of(b, expr_arg(g, x, 1)) : 0;
  if (op == EX_NOT) return first ? expr_neg(g, first) : 0;
  return second ? expr_fn2(g, op == EX_AND ? EX_MIN : EX_MAX, first, second) : 0;
}

/* Whether node id is `lambda(...)`. */
static int is_multiplier(const Builder *b, AstId id) {
  const AstExpr *x = ast_expr(b->ast, id);
  return x->kind == AST_CALL && strcmp(x->name, "lambda") == 0;
}

/* Whether the condition is about a multiplier: then the constraint is a contact that does not bounce, and *wrong is
 * 1 where it is no `lambda(NAME) > 0`. */
static int is_one_sided(const Builder *b, const AstStmt *st, int *wrong) {
  const AstExpr *x = ast_expr(b->ast, st->args);
  int greater = x->kind == AST_GT || x->kind == AST_GE, less = x->kind == AST_LT || x->kind == AST_LE;
  if (!greater && !less) return 0;
  AstId force = greater ? x->a : x->b, zero = greater ? x->b : x->a;
  const AstExpr *none = ast_expr(b->ast, zero);
  *wrong = !is_multiplier(b, force) || none->kind != AST_NUM || !num_is_zero(none->number);
  if (!*wrong && !st->dims) {
    const AstExpr *of = ast_expr(b->ast, ast_expr(b->ast, force)->args);
    *wrong = of->kind != AST_NAME || of->name != st->name;
  }
  return is_multiplier(b, x->a) || is_multiplier(b, x->b);
}

/* A constraint whose force has one sign: the contact left - right >= 0. */
static void add_one_sided(Builder *b, const AstStmt *st, Name name, Name effect, const Value *c, int wrong) {
  Value gap = *c, e = {.e = expr_int(b->g, 0), .dim = DIM_NONE};
  if (wrong) {
    diag_error(b->diags, ast_expr(b->ast, st->args)->span,
               "a constraint whose force has one sign holds `while lambda(%s) > 0`, and no other number or force may "
               "stand there" HELP "a force against the sides as they are written is positive with the sides exchanged: "
                                  "a rope pulls with `constraint %s: l = hypot(x, y) while lambda(%s) > 0`",
               name, name, name);
    return;
  }
  if (check_contact(b, st, name, &gap, &e)) push_contact(b, st, name, effect, &gap, e.e);
}

/* The function that is positive while the condition of st holds; 0, reported, if it cannot change or is none. */
static Expr condition_margin(Builder *b, const AstStmt *st, Name name, Name effect) {
  Span span = ast_expr(b->ast, st->args)->span;
  Value v = resolve_condition(b, st->args, effect);
  if (!v.e) return 0;
  unsigned kinds = expr_kinds(b->g, v.e);
  Expr margin = v.condition ? margin_of(b, v.e) : 0;
  if (kinds & 1u << SYM_INPUT)
    diag_error(b->diags, span,
               "the condition of `%s` contains an input, which may jump" HELP
               "write the input as a formula of t, or let an event set a state",
               name);
  else if (v.condition && !(kinds & (1u << SYM_COORD | 1u << SYM_VEL | 1u << SYM_STATE | 1u << SYM_TIME)))
    diag_error(b->diags, span,
               "the condition of `%s` cannot change: it contains no coordinate, velocity, state or t" HELP
               "leave `while` out, or put the constraint into an effect, which a scene uses",
               name);
  else if (!margin)
    diag_error(b->diags, span,
               "`%s` is no condition that holds over a time" HELP
               "`while` takes comparisons by <, <=, > and >=, joined by `and`, `or`, `not`",
               ast_short(b, st->args));
  else return margin;
  return 0;
}

/* Adds constraint `part`, c = 0, which holds while one.margin > 0; its components share the events of the first. */
static void add_conditional(Builder *b, Contact one, Name part, Expr c, Dim dim, Span span, const Contact *first) {
  Model *m = b->m;
  Expr margin = one.margin;
  one.constraint = m->constraints.n;
  one.closed = add_signal(b, part, "closed", SIGN_NONNEGATIVE, DIM_NONE, span);
  add_scalar_constraint(b, part, expr_mul(b->g, symbol_node(b, one.closed), c), dim, span);
  one.impact = first ? first->impact : add_switched_event(b, &one, "", 0, expr_neg(b->g, margin), span);
  one.release = first ? first->release : add_switched_event(b, &one, " opens", 1, margin, span);
  vec_push(b->arena, &m->contacts, one);
}

/* --- statements --- */

void add_constraint(Builder *b, const AstStmt *st, Name effect) {
  IndexRange r = {0};
  int wrong = 0;
  if (st->dims && !resolve_indices(b, st->dims, effect, &r)) return;
  Name name = member_name(b->ast, st->name, r.lo, r.n);
  check_name_is_new(b, "constraint", name, effect, st->name_span);
  Value left = resolve(b, st->lhs, IN_DYNAMICS, effect), right = resolve(b, st->rhs, IN_DYNAMICS, effect);
  if (!left.e || !right.e || !sides_agree(b, st, &left, &right)) {
    add_refused(b, st, name, effect);
    return;
  }
  b->m->domain = domain_and(b, b->m->domain, domain_and(b, left.domain, right.domain));
  Dim dim = is_zero(b, &left) ? right.dim : left.dim;
  if (st->args && is_one_sided(b, st, &wrong)) {
    Value c = {.e = left.n ? 0 : expr_sub(b->g, left.e, right.e), .n = left.n, .dim = dim};
    add_one_sided(b, st, name, effect, &c, wrong);
    return;
  }
  Expr margin = st->args ? condition_margin(b, st, name, effect) : 0;
  if (st->args && !margin) return;
  scope_add(&b->constraints, (Entity){.index = b->m->constraints.n,
                                      .name = name,
                                      .effect = effect,
                                      .span = st->name_span,
                                      .parts = (uint8_t)left.n});
  for (uint32_t k = 0, from = b->m->contacts.n; k < component_count(&left); k++) {
    Expr c = expr_sub(b->g, left.at[k], right.at[k]);
    if (!can_be_held(b, c, "constraint", name, st->span)) return;
    Name part = left.n ? intern_printf(b, "%s.%c", name, "xyz"[k]) : name;
    if (margin) add_conditional(b, (Contact){.name = name, .margin = margin}, part, c, dim, st->span,
                                k ? &b->m->contacts.at[from] : NULL);
    else add_scalar_constraint(b, part, c, dim, st->span);
  }
}
