/* Declarations: the statements that a scene uses become the arrays of a Model, in file order. */
#include "model/model.h"

#include <math.h>
#include <stdlib.h>

#include "model/builder.h"

/* --- declaring names --- */

static SymId declare_symbol(Builder *b, SymKind kind, uint32_t index, Name name, ExprSign sign, Dim dim) {
  SymId s = expr_declare(b->g, kind, index, name, sign);
  while (b->dims.n <= s) vec_push(b->arena, &b->dims, DIM_UNKNOWN);
  b->dims.at[s] = dim;
  return s;
}

/* 0, with a message, when the name is taken. */
static int declare_name(Builder *b, const AstStmt *st, Name effect, EntKind kind, uint32_t index) {
  if (strcmp(st->name, "t") == 0 || strcmp(st->name, "pi") == 0) {
    diag_error(b->diags, st->name_span, "`%s` is reserved", st->name);
    diag_help(b->diags, st->name[0] == 't' ? "t is the time; choose another name" : "pi is the number");
    return 0;
  }
  const Entity *old = scope_own(&b->scope, st->name, effect);
  if (!old && effect) old = scope_own(&b->scope, st->name, NULL);
  if (old) {
    diag_error(b->diags, st->name_span, "`%s` is declared twice", st->name);
    diag_also(b->diags, old->span, "first declared here, as %s", ent_kind_text(old->kind));
    return 0;
  }
  scope_add(&b->scope, (Entity){.kind = kind, .index = index, .name = st->name, .effect = effect, .span = st->name_span});
  return 1;
}

/* Declares a name so that its uses are not unknown, when the declaration itself is refused. */
static void declare_refused(Builder *b, const AstStmt *st, Name effect) {
  if (!scope_own(&b->scope, st->name, effect))
    scope_add(&b->scope, (Entity){.kind = ENT_NONE, .name = st->name, .effect = effect, .span = st->name_span});
}

/* `coord q[m]`: the index is made of units, and no constant is among them. */
static int dims_are_units(Builder *b, const AstStmt *st) {
  const AstExpr *x = ast_expr(b->ast, st->dims);
  uint32_t names = 0;
  for (AstId i = x->first; i <= st->dims; i++) {
    const AstExpr *y = ast_expr(b->ast, i);
    if (y->kind != AST_NAME) continue;
    const AstStmt *st2 = declared_in_use(b, y->name, NULL);
    if (st2 && st2->kind == STMT_CONST) return 0;
    names++;
    if (!unit_exists(y->name)) return 0;
  }
  return names > 0 && !x->next;
}

/* Families are refused; white space before the bracket would have made it a unit. */
static int refuse_family(Builder *b, const AstStmt *st, Name effect) {
  if (!st->dims) {
    if (st->unit.n && !(st->kind == STMT_PARAM && st->unit.span.begin > ast_expr(b->ast, st->rhs)->span.begin))
      warn_unit_is_constant(b, &st->unit);
    return 0;
  }
  const char *index = ast_text(b, st->dims);
  if (dims_are_units(b, st)) {
    diag_error(b->diags, st->name_span, "`%s[%s]` stands for a family, and `%s` is no constant", st->name, index, index);
    diag_help(b->diags, "a unit stands apart: `%s [%s]`", st->name, index);
  } else {
    not_yet(b, st->name_span, "families (indexed names)");
  }
  declare_refused(b, st, effect);
  return 1;
}

static void declare_coord(Builder *b, const AstStmt *st, Name effect) {
  if (refuse_family(b, st, effect)) return;
  if (st->type) {
    not_yet(b, st->name_span, arena_printf(b->arena, "coordinates of type `%s`", st->type));
    declare_refused(b, st, effect);
    return;
  }
  Model *m = b->m;
  uint32_t i = m->coords.n;
  if (!declare_name(b, st, effect, ENT_COORD, i)) return;
  Coord c = {.name = st->name, .span = st->name_span, .periodic = st->periodic};
  c.unit = unit_resolve(&st->unit, b->diags, b->arena);
  Dim second = {1, {[DIM_TIME] = DIM_ONE}};
  Dim rate = dim_div(c.unit.dim, second);
  Name v = intern_printf(b, "%s'", st->name), a = intern_printf(b, "%s''", st->name);
  c.q = declare_symbol(b, SYM_COORD, i, st->name, SIGN_UNKNOWN, c.unit.dim);
  c.v = declare_symbol(b, SYM_VEL, i, v, SIGN_UNKNOWN, rate);
  c.a = declare_symbol(b, SYM_ACC, i, a, SIGN_UNKNOWN, dim_div(rate, second));
  vec_push(b->arena, &m->coords, c);
}

static void declare_state(Builder *b, const AstStmt *st, Name effect) {
  if (refuse_family(b, st, effect)) return;
  Model *m = b->m;
  uint32_t i = m->states.n;
  if (!declare_name(b, st, effect, ENT_STATE, i)) return;
  State z = {.name = st->name, .span = st->name_span};
  z.unit = unit_resolve(&st->unit, b->diags, b->arena);
  Dim second = {1, {[DIM_TIME] = DIM_ONE}};
  z.z = declare_symbol(b, SYM_STATE, i, st->name, SIGN_UNKNOWN, z.unit.dim);
  z.rate = declare_symbol(b, SYM_RATE, i, intern_printf(b, "%s'", st->name), SIGN_UNKNOWN, dim_div(z.unit.dim, second));
  vec_push(b->arena, &m->states, z);
}

static ExprSign sign_of(AstSign s) {
  switch (s) {
    case SIGN_GT: return SIGN_POSITIVE;
    case SIGN_GE: return SIGN_NONNEGATIVE;
    case SIGN_LT: return SIGN_NEGATIVE;
    case SIGN_LE: return SIGN_NONPOSITIVE;
    case SIGN_ANY: break;
  }
  return SIGN_UNKNOWN;
}

/* The value must be of the sign that the declaration states, or the simplifier would be misled. */
void check_sign(Builder *b, const Param *p, Span span) {
  static const char *const texts[] = {"", "> 0", ">= 0", "< 0", "<= 0"};
  if (p->sign == SIGN_ANY || !p->value) return;
  ExprSign s = expr_sign(b->g, p->value);
  int zero = expr_is_zero(b->g, p->value), above = s == SIGN_POSITIVE, below = s == SIGN_NEGATIVE;
  int wrong = p->sign == SIGN_GT ? below || zero : p->sign == SIGN_GE ? below : p->sign == SIGN_LT ? above || zero : above;
  if (wrong) diag_error(b->diags, span, "`%s` is declared %s, and this value is not", p->name, texts[p->sign]);
}

static void declare_param(Builder *b, const AstStmt *st, Name effect) {
  if (refuse_family(b, st, effect)) return;
  Model *m = b->m;
  uint32_t i = m->params.n;
  Param p = {.name = st->name, .span = st->name_span, .sign = st->sign};
  p.unit = unit_resolve(&st->unit, b->diags, b->arena);
  /* Its own name is not in scope in its value; without a unit of its own it takes its value's. */
  Value v = resolve(b, st->rhs, IN_PARAM, effect);
  if (!p.unit.text[0] && v.e && !v.bare && v.dim.known) p.unit = unit_of_dim(b, v.dim);
  p.value = value_in(b, v, ast_expr(b->ast, st->rhs)->span, &p.unit);
  if (!declare_name(b, st, effect, ENT_PARAM, i)) return;
  if (effect) p.name = intern_printf(b, "%s.%s", effect, st->name);
  p.sym = declare_symbol(b, SYM_PARAM, i, p.name, sign_of(st->sign), p.unit.dim);
  if (p.value && expr_is_num(b->g, p.value)) {
    p.constant = expr_number(b->g, p.value);
    p.has_constant = 1;
  }
  check_sign(b, &p, ast_expr(b->ast, st->rhs)->span);
  vec_push(b->arena, &m->params, p);
}

static void declare_const(Builder *b, const AstStmt *st, Name effect) {
  Value v = resolve(b, st->rhs, IN_CONST, effect);
  if (!declare_name(b, st, effect, ENT_CONST, b->constants.n)) return;
  Constant c = {st->name, num_int(1)};
  if (v.e && expr_is_num(b->g, v.e)) c.value = expr_number(b->g, v.e);
  else if (v.e) diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "a constant must be a number known when compiling");
  for (uint32_t i = 0; i < b->ndefines; i++)
    if (strcmp(b->defines[i].name, st->name) == 0) c.value = num_parse(b->defines[i].value, strlen(b->defines[i].value));
  vec_push(b->arena, &b->constants, c);
}

static void declare_input(Builder *b, const AstStmt *st, Name effect) {
  Model *m = b->m;
  uint32_t i = m->inputs.n;
  if (!declare_name(b, st, effect, ENT_INPUT, i)) return;
  Input in = {.name = st->name, .span = st->name_span};
  in.unit = unit_resolve(&st->unit, b->diags, b->arena);
  in.sym = declare_symbol(b, SYM_INPUT, i, st->name, SIGN_UNKNOWN, in.unit.dim);
  vec_push(b->arena, &m->inputs, in);
}

static void declare_let(Builder *b, const AstStmt *st, Name effect) {
  if (refuse_family(b, st, effect)) return;
  if (!declare_name(b, st, effect, ENT_LET, b->lets.n)) return;
  vec_push(b->arena, &b->lets, ((Definition){.stmt = st, .effect = effect}));
}

static void declare_function(Builder *b, const AstStmt *st, Name effect) {
  if (!declare_name(b, st, effect, ENT_FUNCTION, b->functions.n)) return;
  Definition f = {.stmt = st, .effect = effect};
  VEC(SymId) args = {0};
  for (AstId i = st->args; i; i = ast_expr(b->ast, i)->next) {
    SymId s = declare_symbol(b, SYM_LOCAL, args.n, ast_expr(b->ast, i)->name, SIGN_UNKNOWN, DIM_UNKNOWN);
    vec_push(b->arena, &args, s);
  }
  f.args = args.at;
  f.nargs = args.n;
  vec_push(b->arena, &b->functions, f);
}

static void declare_observe(Builder *b, const AstStmt *st, Name effect) {
  Model *m = b->m;
  if (!declare_name(b, st, effect, ENT_OBSERVE, m->observes.n)) return;
  Output o = {.name = st->name, .span = st->name_span};
  o.unit = unit_resolve(&st->unit, b->diags, b->arena);
  vec_push(b->arena, &m->observes, o);
}

static void declare(Builder *b, const AstStmt *st, Name effect) {
  switch (st->kind) {
    case STMT_COORD: declare_coord(b, st, effect); return;
    case STMT_STATE: declare_state(b, st, effect); return;
    case STMT_PARAM: declare_param(b, st, effect); return;
    case STMT_CONST: declare_const(b, st, effect); return;
    case STMT_INPUT: declare_input(b, st, effect); return;
    case STMT_LET: declare_let(b, st, effect); return;
    case STMT_FUNCTION: declare_function(b, st, effect); return;
    case STMT_OBSERVE: declare_observe(b, st, effect); return;
    case STMT_CONSTRAINT: not_yet(b, st->span, "constraints"); return;
    case STMT_SYMMETRY: not_yet(b, st->span, "symmetries"); return;
    case STMT_CONTACT: not_yet(b, st->span, "contacts"); return;
    case STMT_FOR: not_yet(b, st->span, "`for` over a family"); return;
    case STMT_MODEL: case STMT_INCLUDE: case STMT_LAGRANGIAN: case STMT_KINETIC: case STMT_POTENTIAL:
    case STMT_DISSIPATION: case STMT_FORCE: case STMT_FLOW: case STMT_MAP: case STMT_EXPECT:
    case STMT_EVENT: case STMT_EFFECT: case STMT_REQUIRES: case STMT_EXCLUDES: case STMT_SCENE:
    case STMT_START: case STMT_EXACT: case STMT_SET: case STMT_USE: case STMT_SPAN: case STMT_METHOD:
    case STMT_TOLERANCE: case STMT_OUTPUT: case STMT_MONITOR: case STMT_LIKE: case STMT_STOP: return;
  }
}

/* --- statements with meaning --- */

/* A force or a dissipation: times `by`, it has the dimension of L. */
typedef struct {
  AstId id;
  Dim dim, by;
  int bare;
  const char *what;
} UnitCheck;

typedef struct {
  VEC(Expr) lagrangian, kinetic, potential, dissipation;
  Span base[3]; /* where the model itself gave L, T, V */
  Dim dim;              /* of L, as far as is known */
  Span dim_span;        /* what decided that */
  VEC(UnitCheck) later;
} Energies;

static Dim joule_dim(void) { return (Dim){1, {2 * DIM_ONE, DIM_ONE, -2 * DIM_ONE}}; }

/* All parts of L have one dimension: that of the first with a known one. */
static void check_energy_unit(Builder *b, const AstStmt *st, const Value *v, Energies *en) {
  if (!v->dim.known || expr_is_zero(b->g, v->e)) return;
  if (!en->dim.known) {
    en->dim = v->dim;
    en->dim_span = st->span;
  } else if (!dim_fits(v->dim, en->dim)) {
    diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "this is in [%s]", dim_text(v->dim, b->arena));
    diag_also(b->diags, en->dim_span, "another part of the Lagrangian is in [%s]", dim_text(en->dim, b->arena));
  }
}

/* Remembers that v times `by` has the dimension of L, which later statements may decide. */
static void check_later(Builder *b, Energies *en, AstId id, const Value *v, Dim by, const char *what) {
  if (expr_is_zero(b->g, v->e)) return;
  vec_push(b->arena, &en->later, ((UnitCheck){id, v->dim, by, v->bare, what}));
}

static void check_units_of_forces(Builder *b, const Energies *en) {
  for (uint32_t i = 0; i < en->later.n; i++) {
    const UnitCheck *c = &en->later.at[i];
    Dim want = dim_div(en->dim, c->by);
    if (dim_fits(c->dim, want)) continue;
    diag_error(b->diags, ast_expr(b->ast, c->id)->span, "%s is in [%s], and this is in [%s]", c->what, dim_text(want, b->arena),
               dim_text(c->dim, b->arena));
    if (c->bare) diag_help(b->diags, "give the number its unit: `%s [%s]`", ast_text(b, c->id), dim_text(want, b->arena));
  }
}

/* The model itself gives L once: as a whole, or as kinetic and potential energy. (Effects add.) */
static int is_first_energy(Builder *b, const AstStmt *st, Energies *en) {
  Span *whole = &en->base[0], *own = &en->base[st->kind == STMT_LAGRANGIAN ? 0 : st->kind == STMT_KINETIC ? 1 : 2];
  Span before = own->end ? *own : st->kind != STMT_LAGRANGIAN ? *whole : en->base[1].end ? en->base[1] : en->base[2];
  if (!before.end) {
    *own = st->span;
    return 1;
  }
  diag_error(b->diags, st->span, own->end && own != whole ? "this energy is given twice" : "L is given twice");
  diag_also(b->diags, before, own->end ? "first given here; write one sum" : "first given here; give L, or kinetic and potential energy");
  return 0;
}

static void add_energy(Builder *b, const AstStmt *st, Name effect, Energies *en) {
  if (!effect && st->kind != STMT_DISSIPATION && !is_first_energy(b, st, en)) return;
  b->m->lagrangian_span = span_join(b->m->lagrangian_span, st->span);
  if (!effect || !b->m->lagrangian_span.end) b->m->lagrangian_span = st->span;
  Value v = resolve(b, st->rhs, IN_DYNAMICS, effect);
  if (!v.e) return;
  if (st->kind == STMT_DISSIPATION) {
    Dim second = {1, {[DIM_TIME] = DIM_ONE}};
    check_later(b, en, st->rhs, &v, second, "a dissipation function");
  } else {
    check_energy_unit(b, st, &v, en);
  }
  switch (st->kind) {
    case STMT_LAGRANGIAN: vec_push(b->arena, &en->lagrangian, v.e); return;
    case STMT_KINETIC: vec_push(b->arena, &en->kinetic, v.e); return;
    case STMT_POTENTIAL: vec_push(b->arena, &en->potential, v.e); return;
    case STMT_DISSIPATION: vec_push(b->arena, &en->dissipation, v.e); return;
    default: return; /* the caller passes these four */
  }
}

static void finish_energies(Builder *b, const Energies *en) {
  Model *m = b->m;
  check_units_of_forces(b, en);
  b->dims.at[m->energy_sym] = en->dim.known && dim_fits(en->dim, joule_dim()) ? en->dim : DIM_UNKNOWN;
  Expr l = expr_add_n(b->g, en->lagrangian.at, en->lagrangian.n);
  Expr kinetic = expr_add_n(b->g, en->kinetic.at, en->kinetic.n);
  Expr potential = expr_add_n(b->g, en->potential.at, en->potential.n);
  if (en->dissipation.n) m->dissipation = expr_add_n(b->g, en->dissipation.at, en->dissipation.n);
  if (!en->lagrangian.n && !en->kinetic.n && !en->potential.n) return;
  if (!en->lagrangian.n) {
    m->kinetic = kinetic;
    m->potential = potential;
  }
  Expr t_minus_v = expr_sub(b->g, kinetic, potential);
  m->lagrangian = expr_add(b->g, l, t_minus_v);
}

static void report_force(Builder *b, const AstStmt *st) {
  diag_error(b->diags, st->span, "a force at a point needs as many components as the point");
  diag_help(b->diags, "`force x = F`, or `force (px, py) = (Fx, Fy)`");
}

/* force q = Q, force (px, py) = (Fx, Fy): both sides element by element. */
static void add_force(Builder *b, const AstStmt *st, Name effect, Energies *en) {
  const AstExpr *l = ast_expr(b->ast, st->lhs), *r = ast_expr(b->ast, st->rhs);
  int tuple = l->kind == AST_TUPLE;
  if (tuple != (r->kind == AST_TUPLE)) {
    report_force(b, st);
    return;
  }
  AstId li = tuple ? l->args : st->lhs, ri = tuple ? r->args : st->rhs;
  while (li && ri) {
    Value point = resolve(b, li, IN_DYNAMICS, effect), f = resolve(b, ri, IN_DYNAMICS, effect);
    if (point.e && f.e) {
      Force one = {point.e, f.e, ast_expr(b->ast, ri)->span};
      vec_push(b->arena, &b->m->forces, one);
      check_later(b, en, ri, &f, point.dim, arena_printf(b->arena, "a force along `%s`", ast_text(b, li)));
    }
    li = tuple ? ast_expr(b->ast, li)->next : 0;
    ri = tuple ? ast_expr(b->ast, ri)->next : 0;
  }
  if (li || ri) report_force(b, st);
}

/* A value given to a symbol: a coordinate, a state, or the rate of one, declared in `unit`. */
static Expr resolve_for(Builder *b, AstId id, Name effect, SymId target, const Unit *unit) {
  Unit u = *unit;
  u.dim = b->dims.at[target]; /* a rate's unit is per second: the same factor */
  return resolve_in(b, id, IN_DYNAMICS, effect, &u);
}

static void add_flow(Builder *b, const AstStmt *st, Name effect) {
  const AstExpr *l = ast_expr(b->ast, st->lhs);
  const AstExpr *name = l->kind == AST_PRIME ? ast_expr(b->ast, l->a) : l;
  if (l->kind != AST_PRIME || name->kind != AST_NAME) {
    diag_error(b->diags, l->span, "a flow gives the rate of a state: `flow z' = ...`");
    return;
  }
  const Entity *e = resolve_name(b, name->name, name->span, effect, "state");
  if (!e) return;
  if (e->kind == ENT_NONE) return;
  if (e->kind != ENT_STATE) {
    diag_error(b->diags, name->span, "`%s` is %s, not a state", name->name, ent_kind_text(e->kind));
    diag_help(b->diags, "declare `state %s`; coordinates get their accelerations from L", name->name);
    return;
  }
  State *z = &b->m->states.at[e->index];
  if (z->flow) diag_error(b->diags, st->span, "the flow of `%s` is given twice", name->name);
  z->flow = resolve_for(b, st->rhs, effect, z->rate, &z->unit);
  if (!z->flow) z->flow = expr_int(b->g, 0); /* reported */
}

static void add_expect(Builder *b, const AstStmt *st, Name effect) {
  Value l = resolve(b, st->lhs, IN_OBSERVE, effect), r = resolve(b, st->rhs, IN_OBSERVE, effect);
  if (!l.e || !r.e) return;
  if (!dim_fits(l.dim, r.dim))
    diag_error(b->diags, st->span, "units do not match: the left side is in [%s], the right side in [%s]", dim_text(l.dim, b->arena),
               dim_text(r.dim, b->arena));
  Expect x = {st->name, st->span, st->lhs, st->rhs, l.e, r.e, effect};
  vec_push(b->arena, &b->m->expects, x);
}

static void add_action(Builder *b, const AstStmt *st, Name effect, Event *ev) {
  Value target = resolve(b, st->lhs, IN_DYNAMICS, effect);
  if (!target.e) return;
  SymKind kind = expr_op(b->g, target.e) == EX_SYM ? expr_sym_of(b->g, target.e)->kind : SYM_LOCAL;
  if (kind != SYM_COORD && kind != SYM_VEL && kind != SYM_STATE) {
    diag_error(b->diags, ast_expr(b->ast, st->lhs)->span, "an event can set a coordinate, a velocity or a state");
    return;
  }
  SymId sym = expr_sym_id(b->g, target.e);
  uint32_t i = expr_sym_of(b->g, target.e)->index;
  const Unit *unit = kind == SYM_STATE ? &b->m->states.at[i].unit : &b->m->coords.at[i].unit;
  Expr value = resolve_for(b, st->rhs, effect, sym, unit);
  if (!value) return;
  Action a = {sym, value};
  vec_push(b->arena, &ev->actions, a);
}

static void add_event(Builder *b, const AstStmt *st, Name effect) {
  Event ev = {.name = st->name, .span = st->span, .direction = st->direction};
  Value g = resolve(b, st->lhs, IN_DYNAMICS, effect);
  ev.g = g.e;
  for (const AstStmt *s = st->body; s; s = s->next) {
    if (s->kind == STMT_STOP) ev.stop = 1;
    else add_action(b, s, effect, &ev);
  }
  if (g.e) vec_push(b->arena, &b->m->events, ev);
}

static void fill_input(Builder *b, const AstStmt *st, Name effect) {
  const Entity *e = scope_own(&b->scope, st->name, effect);
  if (!e || e->kind != ENT_INPUT) return;
  Input *in = &b->m->inputs.at[e->index];
  in->value = resolve_in(b, st->rhs, IN_INPUT, effect, &in->unit);
}

/* An observable's value; without a declared unit it is shown in that of its expression. */
static void fill_observe(Builder *b, const AstStmt *st, Name effect) {
  const Entity *e = scope_own(&b->scope, st->name, effect);
  if (!e || e->kind != ENT_OBSERVE) return;
  Output *o = &b->m->observes.at[e->index];
  Value v = resolve(b, st->rhs, IN_OBSERVE, effect);
  o->value = v.e;
  if (!o->unit.dim.known && !o->unit.text[0]) o->unit = unit_of_dim(b, v.dim);
  else if (v.e && !dim_fits(v.dim, o->unit.dim))
    diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "`%s` is declared in [%s], and this is in [%s]", st->name,
               dim_text(o->unit.dim, b->arena), dim_text(v.dim, b->arena));
}

static void apply(Builder *b, const AstStmt *st, Name effect, Energies *en) {
  switch (st->kind) {
    case STMT_LAGRANGIAN: case STMT_KINETIC: case STMT_POTENTIAL: case STMT_DISSIPATION:
      add_energy(b, st, effect, en);
      return;
    case STMT_FORCE: add_force(b, st, effect, en); return;
    case STMT_FLOW: add_flow(b, st, effect); return;
    case STMT_INPUT: fill_input(b, st, effect); return;
    case STMT_EVENT: add_event(b, st, effect); return;
    case STMT_LET: case STMT_FUNCTION: case STMT_EXPECT: case STMT_OBSERVE: /* after L is known */
    case STMT_COORD: case STMT_STATE: case STMT_PARAM: case STMT_CONST: case STMT_CONSTRAINT:
    case STMT_SYMMETRY: case STMT_CONTACT: case STMT_FOR: case STMT_MODEL: case STMT_INCLUDE:
    case STMT_MAP: case STMT_EFFECT: case STMT_REQUIRES: case STMT_EXCLUDES: case STMT_SCENE:
    case STMT_START: case STMT_EXACT: case STMT_SET: case STMT_USE: case STMT_SPAN: case STMT_METHOD:
    case STMT_TOLERANCE: case STMT_OUTPUT: case STMT_MONITOR: case STMT_LIKE: case STMT_STOP: return;
  }
}

Unit unit_of_dim(Builder *b, Dim d) {
  Unit u = {.dim = d, .factor = num_int(1), .text = ""};
  if (d.known && !dim_is_none(d)) u.text = dim_text(d, b->arena);
  return u;
}

/* Lets that nothing uses are still checked. */
static void apply_unused_lets(Builder *b) {
  for (uint32_t i = 0; i < b->active.n; i++) {
    const AstStmt *st = b->active.at[i].stmt;
    if (st->kind == STMT_LET || st->kind == STMT_FUNCTION) {
      const Entity *e = scope_own(&b->scope, st->name, b->active.at[i].effect);
      Definition *d = !e ? NULL : e->kind == ENT_LET ? &b->lets.at[e->index] : e->kind == ENT_FUNCTION ? &b->functions.at[e->index] : NULL;
      if (d && d->progress == TODO) resolve_definition(b, e->kind, e->index);
    }
  }
}

/* --- checks on the whole --- */

static int is_coordinate(const Symbol *s, const void *data) {
  return (s->kind == SYM_COORD || s->kind == SYM_VEL) && s->index == *(const uint32_t *)data;
}

static void check_whole(Builder *b) {
  Model *m = b->m;
  if (b->diags->errors) return; /* what is missing may be what was refused */
  if (!m->coords.n && !m->states.n) {
    diag_error(b->diags, m->span, "the model has no coordinates and no states");
    diag_help(b->diags, "declare what moves: `coord x [m]`");
  }
  if (m->coords.n && !m->lagrangian) {
    diag_error(b->diags, m->coords.at[0].span, "there are coordinates but no Lagrangian");
    diag_help(b->diags, "give `lagrangian = ...`, or `kinetic = ...` and `potential = ...`");
  }
  for (uint32_t i = 0; i < m->coords.n && m->lagrangian; i++) {
    const Coord *c = &m->coords.at[i];
    if (expr_contains(b->g, m->lagrangian, is_coordinate, &i)) continue;
    diag_error(b->diags, c->span, "the Lagrangian does not contain the coordinate `%s`", c->name);
    diag_help(b->diags, "nothing would determine its motion; add its energy, or remove it");
  }
  for (uint32_t i = 0; i < m->states.n; i++)
    if (!m->states.at[i].flow) {
      diag_error(b->diags, m->states.at[i].span, "the state `%s` has no flow", m->states.at[i].name);
      diag_help(b->diags, "give its rate: `flow %s' = ...`", m->states.at[i].name);
    }
}

static void check_defines(Builder *b) {
  for (uint32_t i = 0; i < b->ndefines; i++) {
    int found = 0;
    for (uint32_t k = 0; k < b->constants.n; k++) found |= strcmp(b->constants.at[k].name, b->defines[i].name) == 0;
    if (!found) {
      diag_error(b->diags, (Span){0}, "-D %s: the model declares no such constant", b->defines[i].name);
      diag_help(b->diags, "parameters are set with name=value when running");
    }
  }
}

static Builder *builder_new(Ast *ast, const ModelChoice *choice) {
  Arena *a = ast->arena;
  Builder *b = ARENA_NEW(a, Builder);
  b->ast = ast;
  b->diags = ast->diags;
  b->arena = a;
  b->g = expr_graph(a, ast->names);
  b->scope.arena = a;
  b->defines = choice->defines;
  b->ndefines = choice->ndefines;
  Model *m = b->m = ARENA_NEW(a, Model);
  m->ast = ast;
  m->diags = ast->diags;
  m->arena = a;
  m->g = b->g;
  m->builder = b;
  Dim second = {1, {[DIM_TIME] = DIM_ONE}};
  m->time = declare_symbol(b, SYM_TIME, 0, intern(ast->names, "t"), SIGN_UNKNOWN, second);
  m->pi = declare_symbol(b, SYM_CONST, 0, intern(ast->names, "pi"), SIGN_POSITIVE, DIM_NONE);
  m->energy_sym = declare_symbol(b, SYM_LOCAL, 0, intern(ast->names, "energy"), SIGN_UNKNOWN, DIM_UNKNOWN);
  return b;
}

/* A model in which no name has a unit is not checked, and time then has none either. */
static void find_units(Builder *b) {
  for (uint32_t i = 0; i < b->active.n; i++)
    if (b->active.at[i].stmt->unit.n) return;
  b->unitless = 1;
  b->dims.at[b->m->time] = DIM_UNKNOWN;
}

Model *model_build(Ast *ast, const ModelChoice *choice) {
  Builder *b = builder_new(ast, choice);
  scene_select(b, choice);
  find_units(b);
  for (uint32_t i = 0; i < b->active.n; i++) declare(b, b->active.at[i].stmt, b->active.at[i].effect);
  check_defines(b);
  Energies en = {0};
  for (uint32_t i = 0; i < b->active.n; i++) apply(b, b->active.at[i].stmt, b->active.at[i].effect, &en);
  finish_energies(b, &en);
  apply_unused_lets(b);
  for (uint32_t i = 0; i < b->active.n; i++) {
    const Active *a = &b->active.at[i];
    if (a->stmt->kind == STMT_EXPECT) add_expect(b, a->stmt, a->effect);
    if (a->stmt->kind == STMT_OBSERVE) fill_observe(b, a->stmt, a->effect);
  }
  check_whole(b);
  scene_build(b, choice);
  return ast->diags->errors ? NULL : b->m;
}
