/* model_build: the active statements, in file order, become a Model. Declarations first (declare.c), then energies,
 * forces, flows, constraints and events, then what may contain accelerations (expect, observe), then the scene.
 * Contract: model.h. */
#include "model/model.h"

#include <stdlib.h>

#include "model/builder.h"
#include "sym/sum_nest.h"

/* --- energies, forces, flows, expectations --- */

/* Deferred check of a force or dissipation function: dim * by must be the dimension of L. */
typedef struct {
  AstId id;
  Dim dim, by;
  int bare;
  const char *what;
} UnitCheck;

typedef struct {
  VEC(Expr) terms[4]; /* of L, T, V and dissipation, in the order of their kinds of statement */
  Span base[4]; /* the model's own statements of L, T, V, H */
  Span first;   /* the first nonzero energy */
  int failed;   /* an energy has no value: the dimension of L is unknown */
  VEC(UnitCheck) later;
} Energies;

/* All parts of L must have one dimension, not necessarily that of an energy. */
static void check_energy_unit(Builder *b, const AstStmt *st, AstId id, const Value *v, Energies *en) {
  if (expr_is_zero(b->g, v->e)) return;
  Span span = ast_expr(b->ast, id)->span;
  if (!en->first.end) en->first = st->span;
  if (dim_equate(b->dims, b->energy, v->dim, span)) return;
  diag_error(b->diags, span, "units do not match: this is %s, another part of the Lagrangian %s", in_dim(b, v->dim),
             in_dim(b, b->energy));
  diag_also(b->diags, en->first, "that part is here");
  explain_dims(b, v->dim, DIM_ANY);
}

/* Defers the check that v times `by` has the dimension of L, which a later statement may decide. */
static void check_later(Builder *b, Energies *en, AstId id, const Value *v, Dim by, const char *what) {
  if (expr_is_zero(b->g, v->e)) return;
  vec_push(b->arena, &en->later, ((UnitCheck){id, v->dim, by, v->bare, what}));
}

static void check_units_of_forces(Builder *b, const Energies *en) {
  for (uint32_t i = 0; i < en->later.n && !en->failed; i++) {
    const UnitCheck *c = &en->later.at[i];
    Dim want = dim_div(b->dims, b->energy, c->by);
    Span span = ast_expr(b->ast, c->id)->span;
    if (dim_equate(b->dims, c->dim, want, span)) continue;
    diag_error(b->diags, span, "%s is %s, and this is %s", c->what, in_dim(b, want), in_dim(b, c->dim));
    if (c->bare)
      diag_help(b->diags, "give the number its unit: `%s [%s]`", ast_text(b, c->id), dim_text(b->dims, want));
    explain_dims(b, c->dim, want);
  }
}

/* Outside of effects, L is given once: as a whole, or as kinetic and potential energy. (Effects add terms.) */
static int is_first_energy(Builder *b, const AstStmt *st, Energies *en) {
  Span *whole = &en->base[0], *own = &en->base[st->kind == STMT_LAGRANGIAN ? 0 : st->kind == STMT_KINETIC ? 1 : 2];
  Span before = own->end ? *own : st->kind != STMT_LAGRANGIAN ? *whole : en->base[1].end ? en->base[1] : en->base[2];
  if (!before.end) {
    *own = st->span;
    return 1;
  }
  diag_error(b->diags, st->span, own->end && own != whole ? "this energy is given twice" : "L is given twice");
  diag_also(b->diags, before,
            own->end ? "first given here; write one sum" : "first given here; give L, or kinetic and potential energy");
  return 0;
}

static void add_energy(Builder *b, const AstStmt *st, Name effect, Energies *en) {
  if (!adds_to_hamiltonian(b, st)) return;
  if (!effect && st->kind != STMT_DISSIPATION && !is_first_energy(b, st, en)) return;
  b->m->lagrangian_span = span_join(b->m->lagrangian_span, st->span);
  if (!effect || !b->m->lagrangian_span.end) b->m->lagrangian_span = st->span;
  if (!effect && st->kind == STMT_KINETIC) b->m->kinetic_span = st->span;
  if (st->kind == STMT_DISSIPATION) b->m->dissipation_span = st->span;
  Value v = resolve(b, st->rhs, IN_DYNAMICS, effect);
  if (v.e) need_number(b, ast_expr(b->ast, st->rhs)->span, v.n);
  en->failed |= st->kind != STMT_DISSIPATION && (!v.e || v.n);
  if (!v.e || v.n) return;
  b->m->domain = domain_and(b, b->m->domain, v.domain);
  if (st->kind == STMT_DISSIPATION) {
    if (!expr_is_num(b->g, v.e) && !(expr_kinds(b->g, v.e) & 1u << (b->m->first_order ? SYM_RATE : SYM_VEL))) {
      diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "a dissipation function without velocities does nothing");
      diag_help(b->diags, "its force is -dR/dq': `dissipation = c/2*x'^2`");
    }
    check_later(b, en, st->rhs, &v, dim_base(b->dims, DIM_TIME), "a dissipation function");
  } else {
    check_energy_unit(b, st, st->rhs, &v, en);
  }
  vec_push(b->arena, &en->terms[st->kind - STMT_LAGRANGIAN], v.e);
}

/* Adds -H, or the action p*q' of a momentum, to L. */
static void add_phase_space(Builder *b, const AstStmt *st, Name effect, Energies *en) {
  int is_momentum = st->kind == STMT_MOMENTUM;
  AstId id = is_momentum ? st->args : st->rhs;
  if (is_momentum ? !b->m->hamiltonian : !gives_hamiltonian(b, st, effect, &en->base[3])) return;
  if (!is_momentum && (!effect || !b->m->lagrangian_span.end)) b->m->lagrangian_span = st->span;
  Value v = is_momentum ? action_of_momentum(b, st, effect) : value_of_hamiltonian(b, st, effect);
  en->failed |= !v.e;
  if (!v.e) return;
  check_energy_unit(b, st, id, &v, en);
  Expr term = is_momentum ? v.e : expr_neg(b->g, v.e);
  vec_push(b->arena, &en->terms[0], term);
}

static Expr sum_of_terms(Builder *b, const Energies *en, AstStmtKind kind) {
  return expr_add_n(b->g, en->terms[kind - STMT_LAGRANGIAN].at, en->terms[kind - STMT_LAGRANGIAN].n);
}

static void finish_energies(Builder *b, const Energies *en) {
  Model *m = b->m;
  check_units_of_forces(b, en);
  Expr l = sum_of_terms(b, en, STMT_LAGRANGIAN), kinetic = sum_of_terms(b, en, STMT_KINETIC),
       potential = sum_of_terms(b, en, STMT_POTENTIAL);
  if (en->terms[3].n) m->dissipation = sum_of_terms(b, en, STMT_DISSIPATION);
  for (uint32_t i = 0; i < m->contacts.n; i++) { /* friction is the force on the slip */
    const Contact *c = &m->contacts.at[i];
    Expr power = c->is_tangent ? expr_mul(b->g, expr_symbol(b->g, c->force)->node, c->gap) : 0;
    if (power) m->dissipation = expr_sub(b->g, m->dissipation ? m->dissipation : expr_int(b->g, 0), power);
  }
  if (!en->terms[0].n && !en->terms[1].n && !en->terms[2].n) return;
  if (!en->terms[0].n) {
    m->kinetic = kinetic;
    m->potential = potential;
  }
  Expr t_minus_v = expr_sub(b->g, kinetic, potential);
  m->lagrangian = expr_add(b->g, l, t_minus_v);
}

static void report_force(Builder *b, const AstStmt *st) {
  diag_error(b->diags, st->span, "a force at a point needs as many components as the point");
  diag_help(b->diags, "`force x = F`, `force (px, py) = (Fx, Fy)`, or `force r = F` with two vectors");
}

static void report_torque(Builder *b, const AstStmt *st) {
  diag_error(b->diags, st->span,
             "a force on a rotation is a torque: a vector of 3 components, in the rotation's own frame");
  diag_help(b->diags, "`force R = (0, 0, tau)`; a torque of space is `force R = transpose(R)*tau`, a force at a point "
                      "of a body `let p = r + R*s`, `force p = F`");
}

static void add_forces(Builder *b, AstId li, AstId ri, const Value *point, const Value *f, Energies *en) {
  if (!point->e || !f->e) return;
  for (uint32_t k = 0; k < (f->n ? f->n : 1); k++) {
    Force one = {point->at[k], f->at[k], ast_expr(b->ast, ri)->span};
    vec_push(b->arena, &b->m->forces, one);
  }
  b->m->domain = domain_and(b, b->m->domain, domain_and(b, point->domain, f->domain));
  check_later(b, en, ri, f, point->dim, arena_printf(b->arena, "a force along `%s`", ast_text(b, li)));
}

/* force (px, py) = (Fx, Fy): elements are separate forces, each with a unit of its own. */
static void add_force_elements(Builder *b, const AstStmt *st, Name effect, Energies *en) {
  AstId li = ast_expr(b->ast, st->lhs)->args, ri = ast_expr(b->ast, st->rhs)->args;
  while (li && ri) {
    Value point = resolve(b, li, IN_DYNAMICS, effect), f = resolve(b, ri, IN_DYNAMICS, effect);
    if (point.e && f.e && (point.n || f.n)) {
      diag_error(b->diags, ast_expr(b->ast, point.n ? li : ri)->span, "a component of a vector is a number");
      return;
    }
    add_forces(b, li, ri, &point, &f, en);
    li = ast_expr(b->ast, li)->next;
    ri = ast_expr(b->ast, ri)->next;
  }
  if (li || ri) report_force(b, st);
}

/* force q = Q, force r = F. */
static void add_force(Builder *b, const AstStmt *st, Name effect, Energies *en) {
  int left = ast_expr(b->ast, st->lhs)->kind == AST_TUPLE, right = ast_expr(b->ast, st->rhs)->kind == AST_TUPLE;
  if (left && right) {
    add_force_elements(b, st, effect, en);
    return;
  }
  Value point = resolve(b, st->lhs, IN_DYNAMICS, effect), f = resolve(b, st->rhs, IN_DYNAMICS, effect);
  int torque = point.e && f.e && point.n == ROTATION;
  if (torque && f.n == 3) f = torque_force(b, &point, &f);
  else if (torque) report_torque(b, st);
  if (torque && f.n != ROTATION) return;
  if (point.e && f.e && point.n != f.n) report_force(b, st);
  else add_forces(b, st->lhs, st->rhs, &point, &f, en);
}

/* The size of a friction, and its static limit: how many times its size it holds a body that sticks. */
static void add_grip(Builder *b, const AstStmt *st, Name effect) {
  AstId rate = st->args, size = ast_expr(b->ast, rate)->next, most = ast_expr(b->ast, size)->next;
  Value f = resolve(b, size, IN_DYNAMICS, effect);
  if (f.e && !f.n) add_size(b, f.e, "this friction has a size", ast_expr(b->ast, size)->span, 0);
  Value v = resolve(b, rate, IN_DYNAMICS, effect);
  if (v.e && !v.n) want_rates_of(b, v.e, 1); /* where the body sticks */
  if (!most) return;
  Value g = resolve(b, most, IN_DYNAMICS, effect);
  Span span = ast_expr(b->ast, most)->span;
  if (!v.e || !f.e || !g.e) return;
  if (!dims_agree(b, &g, &f, span)) {
    diag_error(b->diags, span, "the static limit is %s, and the friction %s", in_dim(b, g.dim), in_dim(b, f.dim));
    return;
  }
  Grip grip = {v.e, expr_div(b->g, g.e, f.e)};
  add_static_limit(b, g.e, f.e, span);
  vec_push(b->arena, &b->m->grips, grip);
}

/* flow z' = ...: the left side must be the rate of a state. */
static void add_flow(Builder *b, const AstStmt *st, Name effect) {
  const AstExpr *l = ast_expr(b->ast, st->lhs);
  const AstExpr *stem = l->kind == AST_PRIME ? ast_expr(b->ast, l->a) : l;
  if (stem->kind == AST_MEMBER) stem = ast_expr(b->ast, stem->a);
  if (stem->kind == AST_INDEX) stem = ast_expr(b->ast, stem->a);
  if (l->kind != AST_PRIME || stem->kind != AST_NAME) {
    diag_error(b->diags, l->span, "a flow gives the rate of a state: `flow z' = ...`");
    return;
  }
  const Entity *e = resolve_name(b, stem->name, stem->span, effect, "state");
  if (!e) return;
  if (e->kind == ENT_NONE) return;
  if (e->kind != ENT_STATE) {
    diag_error(b->diags, stem->span, "`%s` is %s, not a state", stem->name, ent_kind_text(e->kind));
    diag_help(b->diags, "declare `state %s`; coordinates get their accelerations from L", stem->name);
    return;
  }
  Value of = resolve(b, l->a, IN_DYNAMICS, effect);
  if (!of.e) return;
  State *z = &b->m->states.at[expr_sym_of(b->g, of.e)->index];
  if (z->flow) diag_error(b->diags, st->span, "the flow of `%s` is given twice", z->name);
  Value v = resolve_for(b, st->rhs, effect, z->rate, &z->unit);
  if (v.e && v.n != of.n) report_shapes(b, st->span, of.n, v.n);
  b->m->domain = domain_and(b, b->m->domain, v.domain);
  for (uint32_t k = 0; k < (of.n ? of.n : 1); k++) {
    State *part = &b->m->states.at[expr_sym_of(b->g, of.at[k])->index];
    part->flow = v.e && v.n == of.n ? v.at[k] : expr_int(b->g, 0); /* reported */
    part->flow_span = st->span;
  }
}

static void add_expect(Builder *b, const AstStmt *st, Name effect) {
  AstId sides[2] = {st->lhs, st->rhs};
  Expr *nodes[2];
  Value v[2];
  b->brackets = 1;
  for (int k = 0; k < 2; k++) {
    nodes[k] = ARENA_ARRAY(b->arena, Expr, sides[k] - ast_expr(b->ast, sides[k])->first + 1);
    v[k] = resolve_nodes(b, sides[k], IN_OBSERVE, effect, nodes[k]);
  }
  b->brackets = 0;
  Value l = v[0], r = v[1];
  if (!l.e || !r.e || refuse_actions(b, &l, ast_expr(b->ast, st->lhs)->span) ||
      refuse_actions(b, &r, ast_expr(b->ast, st->rhs)->span))
    return;
  if (l.n != r.n) {
    report_shapes(b, st->span, l.n, r.n);
    return;
  }
  if (!dims_agree(b, &l, &r, st->span)) {
    report_units(b, st->span, l.dim, r.dim);
    explain_dims(b, l.dim, r.dim);
  }
  if (st->name && !b->index.n) check_name_is_new(b, "expectation", st->name, effect, st->name_span);
  Expect x = {.name = st->name, .span = st->span, .lhs_ast = st->lhs, .rhs_ast = st->rhs, .effect = effect};
  for (int k = 0; k < 2 && !l.n && !b->index.n; k++) x.nodes[k] = nodes[k];
  x.domain = domain_and(b, l.domain, r.domain);
  for (uint32_t k = 0; k < (l.n ? l.n : 1); k++) {
    x.lhs = l.at[k];
    x.rhs = r.at[k];
    vec_push(b->arena, &b->m->expects, x);
  }
}

static void fill_input(Builder *b, const AstStmt *st, Name effect) {
  const Entity *e = scope_own(&b->scope, st->name, effect);
  if (e && e->kind == ENT_INPUT) give_input(b, e->index, st->name, st->rhs, effect);
}

static void apply_statement(Builder *b, const AstStmt *st, Name effect, void *data) {
  Energies *en = data;
  b->keeps_rows = st->kind == STMT_FORCE || st->kind == STMT_FLOW;
  switch (st->kind) {
    case STMT_MOMENTUM: case STMT_HAMILTONIAN: add_phase_space(b, st, effect, en); return;
    case STMT_LAGRANGIAN: case STMT_KINETIC: case STMT_POTENTIAL: case STMT_DISSIPATION:
      add_energy(b, st, effect, en);
      return;
    case STMT_FORCE:
      add_force(b, st, effect, en);
      if (st->args) add_grip(b, st, effect);
      return;
    case STMT_FLOW: add_flow(b, st, effect); return;
    case STMT_INPUT: fill_input(b, st, effect); return;
    case STMT_EVENT: add_event(b, st, effect); return;
    case STMT_CONSTRAINT: add_constraint(b, st, effect); return;
    case STMT_CONTACT: add_contact(b, st, effect); return;
    case STMT_GUIDE: add_guide(b, st, effect); return;
    case STMT_LET: case STMT_FUNCTION: case STMT_EXPECT: case STMT_OBSERVE: /* once L is known: build() */
    case STMT_DRAW: /* scene_build() */
    case STMT_COORD: case STMT_STATE: case STMT_PARAM: case STMT_CONST:
    case STMT_SYMMETRY: case STMT_CANONICAL: case STMT_FOR: case STMT_MODEL: case STMT_INCLUDE: case STMT_NETWORK:
    case STMT_MAP: case STMT_EFFECT: case STMT_REQUIRES: case STMT_EXCLUDES: case STMT_SCENE:
    case STMT_START: case STMT_EXACT: case STMT_SET: case STMT_USE: case STMT_SPAN: case STMT_METHOD:
    case STMT_TOLERANCE: case STMT_OUTPUT: case STMT_MONITOR: case STMT_MEASURE: case STMT_LIKE: case STMT_STOP: return;
  }
}

/* Evaluates unused lets, to report their errors: one per family. */
static void apply_unused_lets(Builder *b) {
  const AstStmt *wrong = NULL;
  for (uint32_t i = 0; i < b->lets.n; i++) {
    if (b->lets.at[i].stmt == wrong) continue;
    resolve_definition(b, ENT_LET, i);
    if (!b->state[ENT_LET].at[i].value.e) wrong = b->lets.at[i].stmt;
  }
}

/* Statement callbacks for the passes after L is known. */
static void expect(Builder *b, const AstStmt *st, Name effect, void *data) {
  (void)data;
  int claim = st->kind == STMT_HAMILTONIAN && !effect && !b->m->hamiltonian; /* energy = H */
  if (claim && !is_free_of_velocities(b, st, NULL)) return;
  if (claim || st->kind == STMT_EXPECT) add_expect(b, st, effect);
}

static void canonical(Builder *b, const AstStmt *st, Name effect, void *data) {
  (void)effect;
  (void)data;
  if (st->kind == STMT_CANONICAL) add_canonical(b, st);
}

static void symmetry(Builder *b, const AstStmt *st, Name effect, void *data) {
  (void)data;
  if (st->kind == STMT_SYMMETRY) add_symmetry(b, st, effect);
}

static void each_active(Builder *b, StatementFn *fn, void *data) {
  for (uint32_t i = 0; i < b->active.n; i++) each_statement(b, b->active.at[i].stmt, b->active.at[i].effect, fn, data);
}

/* --- checks on the whole --- */

/* Reports coordinates that occur neither in L nor in a constraint. */
static void check_coords_in_lagrangian(Builder *b) {
  Model *m = b->m;
  uint8_t *found = ARENA_ARRAY(b->arena, uint8_t, m->coords.n + 1);
  Expr *roots = ARENA_ARRAY(b->arena, Expr, m->constraints.n + 1);
  roots[0] = m->lagrangian;
  for (uint32_t i = 0; i < m->constraints.n; i++) roots[i + 1] = m->constraints.at[i].c;
  ExprList l = expr_topo(b->g, roots, m->constraints.n + 1);
  for (uint32_t i = 0; i < l.n; i++) {
    if (expr_op(b->g, l.at[i]) != EX_SYM) continue;
    const Symbol *s = expr_sym_of(b->g, l.at[i]);
    if (s->kind == SYM_COORD || s->kind == SYM_VEL) found[s->index] = 1;
  }
  for (uint32_t i = 0; i < m->coords.n; i++) {
    if (found[i]) continue;
    diag_error(b->diags, m->coords.at[i].span, "the Lagrangian does not contain the coordinate `%s`",
               m->coords.at[i].name);
    diag_help(b->diags, "nothing would determine its motion; add its energy, or remove it");
  }
}

static void check_whole(Builder *b) {
  Model *m = b->m;
  if (b->diags->errors) return; /* a missing part may be one that was refused */
  if (!m->coords.n && !m->states.n)
    diag_error(b->diags, m->span,
               "the model has no coordinates and no states" HELP "declare a coordinate: `coord x [m]`");
  if (m->coords.n && !m->lagrangian) {
    diag_error(b->diags, m->coords.at[0].span, "there are coordinates but no Lagrangian");
    diag_help(b->diags, "give `lagrangian = ...`, or `kinetic = ...` and `potential = ...`, or `hamiltonian = ...`");
  }
  if (m->coords.n && m->lagrangian && !m->hamiltonian) check_coords_in_lagrangian(b);
  for (uint32_t i = 0; i < m->states.n; i++)
    if (!m->states.at[i].flow && !m->states.at[i].coordinate)
      diag_error(b->diags, m->states.at[i].span, "the state `%s` has no flow" HELP "give its rate: `flow %s' = ...`",
                 m->states.at[i].name, m->states.at[i].name);
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
  b->dims = dims_new(a);
  b->scope.arena = b->members.arena = b->outputs.arena = b->constraints.arena = a;
  b->defines = choice->defines;
  b->ndefines = choice->ndefines;
  b->domains = choice->bare || choice->domains; /* claims are judged on models without a scene */
  Model *m = b->m = ARENA_NEW(a, Model);
  m->times = choice->times > 0 ? choice->times : 1;
  b->sums_from = choice->sums_from ? choice->sums_from : SUMS_FROM;
  b->more = choice->more;
  m->ast = ast;
  m->diags = ast->diags;
  m->arena = a;
  m->g = b->g;
  m->written = expr_map(a);
  m->dims = b->dims;
  m->time = declare_symbol(b, SYM_TIME, 0, intern(ast->names, "t"), SIGN_UNKNOWN, dim_base(b->dims, DIM_TIME));
  m->pi = declare_symbol(b, SYM_CONST, 0, intern(ast->names, "pi"), SIGN_POSITIVE, DIM_NONE);
  m->energy_sym = declare_symbol(b, SYM_LOCAL, 0, intern(ast->names, "energy"), SIGN_UNKNOWN, DIM_ANY);
  return b;
}

/* 1 if a statement mentions a unit with a dimension. Recursion is bounded by the parser's limit on nested blocks. */
static int measures(const AstStmt *st) {
  if (st->kind != STMT_FOR) return unit_measures(&st->unit);
  for (const AstStmt *s = st->body; s; s = s->next)
    if (measures(s)) return 1;
  return 0;
}

/* A model without any unit is not checked for dimensions, and time then has none either. */
static void find_units(Builder *b) {
  Model *m = b->m;
  b->unitless = 1;
  for (uint32_t i = 0; i < b->active.n && b->unitless; i++) b->unitless = !measures(b->active.at[i].stmt);
  if (b->unitless) b->dim_of.at[m->time] = DIM_ANY;
  else b->energy = b->dim_of.at[m->energy_sym] = dim_unknown(b->dims, NULL);
}

static uint8_t degree_as_written(const Model *m, Expr e);

/* Degree in velocities of a node, from the degrees of its arguments: 0, 1, or 2 for anything nonlinear. */
static uint8_t degree_of(const Model *m, Expr x, const ExprMap *degrees) {
  const ExprGraph *g = m->g;
  uint32_t degree = 0;
  ExprOp op = expr_op(g, x);
  if (op == EX_SYM) return expr_sym_of(g, x)->kind == SYM_VEL;
  if (op == EX_DEF) return (uint8_t)expr_map_get(degrees, expr_arg(g, x, 0));
  if (op == EX_NEST) return 0;
  if (op == EX_CELL) return degree_as_written(m, expr_sum_nest(g, expr_cell_nest(g, x))->shares->value);
  if (op != EX_SUM && op != EX_PROD) {
    for (uint32_t i = 0; i < expr_nargs(g, x); i++)
      if (expr_map_get(degrees, expr_arg(g, x, i))) return 2;
    return 0;
  }
  for (ExprPair part = {0}; expr_next_pair(g, x, op, &part);) {
    uint32_t one = expr_map_get(degrees, part.of);
    if (op == EX_SUM) degree = one > degree ? one : degree;
    else degree += one && !num_is_one(part.num) ? 2 : one;
  }
  return degree > 2 ? 2 : (uint8_t)degree;
}

/* Degree of an expression in velocities. Creates no node, as nodes are numbered in text order. */
static uint8_t degree_as_written(const Model *m, Expr e) {
  ExprMap degrees = expr_map(m->arena);
  ExprList l = expr_topo(m->g, &e, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    if (!(expr_kinds(m->g, l.at[i]) & 1u << SYM_VEL)) continue;
    uint8_t degree = degree_of(m, l.at[i], &degrees);
    if (degree) expr_map_set(&degrees, l.at[i], degree);
  }
  return (uint8_t)expr_map_get(&degrees, e);
}

/* 1 if L contains velocities and is linear in them as written. */
static int is_first_order(const Model *m) {
  return m->hamiltonian || (m->coords.n && m->lagrangian && degree_as_written(m, m->lagrangian) == 1);
}

/* Builds everything but the scene. first_order: coordinates become states. */
static Builder *build(Ast *ast, const ModelChoice *choice, int first_order, InputRates *rates) {
  Builder *b = builder_new(ast, choice);
  b->rates_wanted = rates;
  b->m->first_order = first_order;
  scene_select(b, choice);
  find_units(b);
  find_hamiltonian(b);
  if (!first_order) check_momenta(b);
  declare_composed(b);
  each_active(b, declare_statement, NULL);
  for (uint32_t i = 0; i < b->active.n; i++)
    declare_empty_families(b, b->active.at[i].stmt, b->active.at[i].effect);
  each_active(b, declare_momentum, NULL); /* after all coordinates: the states are [q|p] */
  check_defines(b);
  Energies en = {0};
  each_active(b, apply_statement, &en);
  each_active(b, add_guide_friction, NULL);
  finish_energies(b, &en);
  add_rotation_inertia(b);
  if (!first_order) want_rates_of_momenta(b);
  apply_unused_lets(b);
  each_active(b, symmetry, NULL); /* before outputs use charges: fixes their units */
  for (uint32_t i = 0; i < b->observes.n; i++) resolve_definition(b, ENT_OBSERVE, i);
  each_active(b, expect, NULL);
  each_active(b, canonical, NULL);
  check_whole(b);
  return b;
}

static const Declarations *declarations_of(const Builder *b) {
  Declarations *d = ARENA_NEW(b->arena, Declarations);
  *d = (Declarations){.ast = b->ast,
                      .diags = b->diags, .dims = b->dims, .scope = b->scope, .members = b->members,
                      .constraints = b->constraints, .rotations = b->rotations, .active = b->active, .lets = b->lets,
                      .functions = b->functions, .observes = b->observes,
                      .constants = b->constants};
  return d;
}

/* The expression of `derive --bracket`. */
static void ask_bracket(Builder *b, AstId id) {
  b->brackets = 1;
  Value v = id && !b->diags->errors ? resolve(b, id, IN_OBSERVE, NULL) : (Value){0};
  b->brackets = 0;
  if (v.e && refuse_actions(b, &v, ast_expr(b->ast, id)->span)) return;
  b->m->asked_bracket = v.e;
}

static Builder *build_whole(Ast *ast, const ModelChoice *choice, InputRates *rates) {
  Builder *b = build(ast, choice, 0, rates);
  if (!ast->diags->errors && is_first_order(b->m)) {
    if (b->m->constraints.n)
      diag_error(b->diags, b->m->constraints.at[0].span, "constraints and contacts where %s are not supported" HELP
                 "insert the constraint into L, or give all coordinates inertia, `m/2*x'^2`", no_inertia(b->m));
    else b = build(ast, choice, 1, rates);
  }
  ask_bracket(b, choice->bracket);
  add_section(b, &choice->section);
  scene_build(b, choice);
  fill_input_integrals(b);
  fill_input_rates(b);
  fill_inferred_units(b);
  if (!ast->diags->errors) fix_params(b, choice->fix);
  warn_signs(b);
  check_sizes(b);
  check_contact_families(b);
  command_values(b, choice->values, choice->nvalues);
  return b;
}

Model *model_build(Ast *ast, const ModelChoice *choice) {
  InputRates rates = {0};
  Diags before = *ast->diags;
  Builder *b = build_whole(ast, choice, &rates);
  while (rates.missing) { /* of inputs, which the build took for constants */
    rates.missing = 0;
    *ast->diags = before;
    b = build_whole(ast, choice, &rates);
  }
  b->m->declared = declarations_of(b);
  return ast->diags->errors ? NULL : b->m;
}
