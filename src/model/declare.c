/* Declarations: each name enters the scope, and coordinates, states, inputs, observables their arrays of the Model,
 * in file order. Lets and functions are only recorded: resolve.c evaluates them when needed. Parameters and
 * constants: declare_param.c. */

#include "base/words.h"
#include "model/builder.h"

static int declare_name(Builder *b, const AstStmt *st, Name effect, EntKind kind, uint32_t index) {
  return declare_entity(
      b, st, (Entity){.kind = kind, .index = index, .name = st->name, .effect = effect, .span = st->name_span});
}

static int declare_family(Builder *b, const AstStmt *st, Name effect, EntKind kind, uint32_t index, uint8_t parts,
                          Entity *e) {
  return read_family(b, st, effect, kind, index, parts, e) && declare_entity(b, st, *e);
}

static int declares_motion(const AstStmt *st) {
  return st->kind == STMT_COORD || st->kind == STMT_MOMENTUM || st->kind == STMT_STATE;
}

/* Name of a coordinate or state in outputs: "EFFECT.NAME" if the model or another effect in use declares NAME as
 * well. */
static Name plain_name(Builder *b, const AstStmt *st, Name effect) {
  if (!effect) return st->name;
  vec_each(const Active, a, b->active)
    if (a->effect != effect && a->stmt->name == st->name && declares_motion(a->stmt))
      return intern_printf(b, "%s.%s", effect, st->name);
  return st->name;
}

static void add_state(Builder *b, const AstStmt *st, Name name, Unit unit) {
  Model *m = b->m;
  uint32_t i = m->states.n;
  State z = {.name = name,
             .span = st->name_span,
             .unit = unit,
             .coordinate = st->kind != STMT_STATE,
             .periodic = st->periodic};
  z.z = declare_symbol(b, SYM_STATE, i, name, SIGN_UNKNOWN, unit.dim);
  z.rate =
      declare_symbol(b, SYM_RATE, i, intern_printf(b, "%s'", name), SIGN_UNKNOWN, dim_per_second(b->dims, unit.dim));
  vec_push(b->arena, &m->states, z);
}

static void add_coord(Builder *b, const AstStmt *st, Name name, Unit unit) {
  Model *m = b->m;
  uint32_t i = m->coords.n;
  Coord c = {.name = name, .span = st->name_span, .periodic = st->periodic, .unit = unit};
  Dim rate = dim_per_second(b->dims, unit.dim);
  Name v = intern_printf(b, "%s'", name), a = intern_printf(b, "%s''", name);
  c.q = declare_symbol(b, SYM_COORD, i, name, SIGN_UNKNOWN, unit.dim);
  c.v = declare_symbol(b, SYM_VEL, i, v, SIGN_UNKNOWN, rate);
  c.a = declare_symbol(b, SYM_ACC, i, a, SIGN_UNKNOWN, dim_per_second(b->dims, rate));
  vec_push(b->arena, &m->coords, c);
}

/* Periodic coordinates have period 2 pi: they must be angles. */
static void check_angle(Builder *b, const AstStmt *st, const Unit *unit) {
  if (dim_equate(b->dims, unit->dim, DIM_NONE, st->name_span)) return;
  diag_error(b->diags, st->name_span, "`%s` is periodic but in [%s], which is not an angle", st->name, unit->text);
  diag_help(b->diags, "angles are in [rad], [deg] or [rev]; leave `periodic` out for other coordinates");
}

/* Declares coordinates and states. Where L is linear in all velocities, coordinates are stored as states. */
static void declare_motion(Builder *b, const AstStmt *st, Name effect) {
  Entity e;
  uint8_t parts;
  int is_state = st->kind == STMT_STATE || b->m->first_order;
  EntKind kind = is_state ? ENT_STATE : ENT_COORD;
  uint32_t first = is_state ? b->m->states.n : b->m->coords.n;
  if (has_word("energy lagrangian if end lyapunov megno", st->name))
    diag_error(b->diags, st->name_span,
               "`%s` is a word of formulas, outputs and measures, and cannot be %s" HELP "choose another name",
               st->name, ent_kind_text(kind));
  if (!read_type(b, st, effect, &parts)) return;
  if (!declare_family(b, st, effect, kind, first, parts, &e)) return;
  Unit unit = parts == ROTATION ? unit_si(DIM_NONE, "") : declared_unit(b, st, effect);
  if (st->periodic) check_angle(b, st, &unit);
  int64_t at[2];
  Name stem = plain_name(b, st, effect);
  for (int more = first_member(&e, at); more; more = next_member(&e, at)) {
    for (uint32_t k = 0; k < (e.parts ? e.parts : 1u); k++)
      (is_state ? add_state : add_coord)(b, st, scalar_name(b, &e, stem, at, k), unit);
    if (parts == ROTATION && !is_state)
      constrain_rotation(b, member_name(b->ast, stem, at, e.ndims), e.index + member_offset(&e, at), st->name_span);
  }
}

static void declare_input(Builder *b, const AstStmt *st, Name effect) {
  Model *m = b->m;
  uint32_t i = m->inputs.n;
  if (!declare_name(b, st, effect, ENT_INPUT, i)) return;
  Input in = {.name = effect ? intern_printf(b, "%s.%s", effect, st->name) : st->name, .span = st->name_span};
  in.unit = declared_unit(b, st, effect);
  in.sym = declare_symbol(b, SYM_INPUT, i, in.name, SIGN_UNKNOWN, in.unit.dim);
  vec_push(b->arena, &m->inputs, in);
  declare_input_rates(b, i);
}

/* --- families whose members are declared one by one --- */

/* Index + 1 of the family's entity, made when its first member is declared; 0, reported, when the name is taken. */
static uint32_t family_of(Builder *b, const AstStmt *st, Name effect, EntKind kind, const IndexRange *r) {
  const Entity *old = scope_own(&b->scope, st->name, effect);
  if (old && old->kind == ENT_NONE) return 0;
  if (old && old->kind == kind && old->ndims == r->n) return (uint32_t)(old - b->scope.all.at) + 1;
  if (old && old->kind == kind && old->ndims) {
    diag_error(b->diags, st->name_span, "`%s` has %s, here it has %u", st->name,
               old->ndims == 1 ? "one index" : "two indices", r->n);
    diag_also(b->diags, old->span, "first declared here");
    return 0;
  }
  Entity e = {.kind = kind, .name = st->name, .effect = effect, .span = st->name_span, .ndims = (uint8_t)r->n};
  for (uint32_t k = 0; k < r->n; k++) {
    e.lo[k] = r->lo[k];
    e.hi[k] = r->hi[k];
  }
  return declare_entity(b, st, e) ? b->scope.all.n : 0;
}

/* Declares one member of a family and widens the family's index range to contain it. */
static int declare_member(Builder *b, const AstStmt *st, uint32_t family, const int64_t *at, uint32_t index,
                          Name *name) {
  Entity *f = &b->scope.all.at[family - 1];
  *name = member_name(b->ast, f->name, at, f->ndims);
  const Entity *old = scope_own(&b->members, *name, f->effect);
  if (old) {
    diag_error(b->diags, st->name_span, "`%s` is declared twice", *name);
    diag_also(b->diags, old->span, "first declared here");
    return 0;
  }
  for (int k = 0; k < f->ndims; k++) {
    if (at[k] < f->lo[k]) f->lo[k] = at[k];
    if (at[k] > f->hi[k]) f->hi[k] = at[k];
  }
  scope_add(&b->members,
            (Entity){.kind = f->kind, .index = index, .name = *name, .effect = f->effect, .span = st->name_span});
  return 1;
}

static int fits_family(Builder *b, const AstStmt *st, const IndexRange *r) {
  if (range_count(r) <= FAMILY_MAX) return 1;
  return diag_error(b->diags, st->name_span, "a family has at most %d members", FAMILY_MAX);
}

/* `let x[0] = 0`, `let x[i in 1..N] = x[i-1] + ...` */
static void declare_let_family(Builder *b, const AstStmt *st, Name effect) {
  IndexRange r;
  if (!resolve_indices(b, st->dims, effect, &r) || !fits_family(b, st, &r)) {
    declare_refused(b, st, effect);
    return;
  }
  uint32_t family = family_of(b, st, effect, ENT_LET, &r);
  Definition d = {.stmt = st, .effect = effect};
  if (r.n == 1) d.range[0] = r.lo[0], d.range[1] = r.hi[0];
  for (int64_t i = r.lo[0]; family && i <= r.hi[0]; i++)
    for (int64_t j = r.lo[1]; j <= (r.n > 1 ? r.hi[1] : 0); j++) {
      int64_t at[2] = {i, j};
      if (!declare_member(b, st, family, at, b->lets.n, &d.name)) return;
      for (uint32_t k = 0; k < r.n; k++) d.index[k] = (IndexVar){r.name[k], at[k]};
      add_definition(b, ENT_LET, d);
    }
}

static void declare_let(Builder *b, const AstStmt *st, Name effect) {
  if (!check_brackets(b, st, effect)) return;
  if (st->dims) {
    declare_let_family(b, st, effect);
    return;
  }
  if (!declare_name(b, st, effect, ENT_LET, b->lets.n)) return;
  add_definition(b, ENT_LET, (Definition){.stmt = st, .name = st->name, .effect = effect});
}

/* Reports functions called like built-in ones, and arguments of equal names. */
static void check_function(Builder *b, const AstStmt *st) {
  if (function_index(st->name) >= 0)
    diag_error(b->diags, st->name_span, "`%s` is a function of the language" HELP "choose another name", st->name);
  for (AstId i = st->args; i; i = ast_expr(b->ast, i)->next)
    for (AstId k = st->args; k != i; k = ast_expr(b->ast, k)->next)
      if (ast_expr(b->ast, k)->name == ast_expr(b->ast, i)->name)
        diag_error(b->diags, ast_expr(b->ast, i)->span, "two arguments are called `%s`", ast_expr(b->ast, i)->name);
}

static void declare_function(Builder *b, const AstStmt *st, Name effect) {
  check_function(b, st);
  if (!declare_name(b, st, effect, ENT_FUNCTION, b->functions.n)) return;
  add_definition(b, ENT_FUNCTION, (Definition){.stmt = st, .name = st->name, .effect = effect});
}

/* Adds the observable `name`, with the indices around it. */
static void add_observe(Builder *b, const AstStmt *st, Name effect, Name name) {
  Output o = {.name = name, .span = st->name_span, .unit = unit_resolve(&st->unit, b->dims, b->diags, b->arena)};
  vec_push(b->arena, &b->m->observes, o);
  IndexVar *around = ARENA_ARRAY(b->arena, IndexVar, b->index.n + 1);
  if (b->index.n) memcpy(around, b->index.at, b->index.n * sizeof *around);
  add_definition(b, ENT_OBSERVE,
                 (Definition){.stmt = st, .name = name, .effect = effect, .around = around, .naround = b->index.n,
                              .range = {b->for_range[0], b->for_range[1]}});
}

static void declare_observe(Builder *b, const AstStmt *st, Name effect) {
  Name name = st->name;
  if (st->dims) {
    IndexRange r;
    uint32_t family = resolve_indices(b, st->dims, effect, &r) ? family_of(b, st, effect, ENT_OBSERVE, &r) : 0;
    if (!family || !declare_member(b, st, family, r.lo, b->m->observes.n, &name)) return;
  } else if (!declare_name(b, st, effect, ENT_OBSERVE, b->m->observes.n)) {
    return;
  }
  add_observe(b, st, effect, name);
}

void declare_empty_families(Builder *b, const AstStmt *st, Name effect) {
  const AstStmt *within = st->kind == STMT_FOR ? st->body : NULL;
  for (const AstStmt *s = within; s; s = s->next) {
    declare_empty_families(b, s, effect); /* recursion bounded by the parser */
    if (s->kind != STMT_OBSERVE || !s->dims || scope_own(&b->scope, s->name, effect)) continue;
    Entity e = {.kind = ENT_OBSERVE, .name = s->name, .effect = effect, .span = s->name_span, .lo = {1, 1}};
    for (AstId i = s->dims; i && e.ndims < 2; i = ast_expr(b->ast, i)->next) e.ndims++;
    scope_add(&b->scope, e);
  }
}

/* 1 if a momentum p beside L has the size of its coordinate; otherwise reported. */
static int names_a_momentum(Builder *b, const AstStmt *st, Name effect, Entity *p) {
  const AstExpr *of = ast_expr(b->ast, st->lhs);
  const Entity *q = resolve_name(b, of->name, of->span, effect, "coord");
  uint8_t parts;
  return q && read_type(b, st, effect, &parts) && read_family(b, st, effect, ENT_OBSERVE, 0, parts, p) &&
         pair_fits(b, st, p, q);
}

/* Observables p[1], ... of a family whose Lagrangian is given; their text reads _i and _j. */
static void declare_momenta(Builder *b, const AstStmt *st, Name effect, const Entity *p) {
  IndexRange r = entity_range(p);
  uint32_t family = family_of(b, st, effect, ENT_OBSERVE, &r), outer = b->index.n;
  int64_t at[2] = {p->lo[0], p->lo[1]};
  Name name;
  if (!entity_size(p)) return;
  do {
    if (!family || !declare_member(b, st, family, at, b->m->observes.n, &name)) return;
    for (int k = 0; k < p->ndims; k++)
      vec_push(b->arena, &b->index, ((IndexVar){intern(b->ast->names, k ? "_j" : "_i"), at[k]}));
    add_observe(b, st, effect, name);
    b->index.n = outer;
  } while (next_member(p, at));
}

/* A coordinate of the phase space where the model gives H; where it gives L, an observable dL/dq'. */
void declare_momentum(Builder *b, const AstStmt *st, Name effect, void *data) {
  (void)data;
  Entity p = {0};
  if (st->kind != STMT_MOMENTUM) return;
  if (b->m->hamiltonian) {
    declare_motion(b, st, effect);
  } else if (b->gives_lagrangian && names_a_momentum(b, st, effect, &p)) {
    if (p.ndims) declare_momenta(b, st, effect, &p);
    else declare_observe(b, st, effect);
  } else {
    declare_refused(b, st, effect);
  }
}

void declare_statement(Builder *b, const AstStmt *st, Name effect, void *data) {
  (void)data;
  switch (st->kind) {
    case STMT_COORD: case STMT_STATE: declare_motion(b, st, effect); return;
    case STMT_PARAM: declare_param(b, st, effect); return;
    case STMT_CONST: declare_const(b, st, effect); return;
    case STMT_INPUT: declare_input(b, st, effect); return;
    case STMT_LET: declare_let(b, st, effect); return;
    case STMT_FUNCTION: declare_function(b, st, effect); return;
    case STMT_OBSERVE: declare_observe(b, st, effect); return;
    case STMT_SYMMETRY: declare_symmetry(b, st, effect); return;
    case STMT_CANONICAL: case STMT_FOR: case STMT_MODEL: case STMT_INCLUDE: case STMT_NETWORK: case STMT_MOMENTUM:
    case STMT_HAMILTONIAN: case STMT_LAGRANGIAN: case STMT_CONSTRAINT: case STMT_CONTACT: case STMT_DRAW:
    case STMT_GUIDE: case STMT_KINETIC: case STMT_POTENTIAL: case STMT_DISSIPATION: case STMT_FORCE: case STMT_FLOW:
    case STMT_MAP: case STMT_EXPECT: case STMT_EVENT: case STMT_EFFECT: case STMT_REQUIRES: case STMT_EXCLUDES:
    case STMT_SCENE: case STMT_START: case STMT_EXACT: case STMT_SET: case STMT_USE: case STMT_SPAN: case STMT_METHOD:
    case STMT_TOLERANCE: case STMT_OUTPUT: case STMT_MONITOR: case STMT_MEASURE: case STMT_LIKE: case STMT_STOP: return;
  }
}
