/* Declarations: names, and what they stand for in the arrays of a Model, in file order. */
#include <stdlib.h>

#include "model/builder.h"

enum { FAMILY_MAX = 1000000 };

SymId declare_symbol(Builder *b, SymKind kind, uint32_t index, Name name, ExprSign sign, Dim dim) {
  SymId s = expr_declare(b->g, kind, index, name, sign);
  while (b->dims.n <= s) vec_push(b->arena, &b->dims, DIM_UNKNOWN);
  b->dims.at[s] = dim;
  return s;
}

/* 0, with a message, when the name is taken. */
static int declare_entity(Builder *b, const AstStmt *st, Entity e) {
  Name effect = e.effect;
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
  scope_add(&b->scope, e);
  return 1;
}

static int declare_name(Builder *b, const AstStmt *st, Name effect, EntKind kind, uint32_t index) {
  return declare_entity(b, st, (Entity){.kind = kind, .index = index, .name = st->name, .effect = effect, .span = st->name_span});
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

/* White space before the bracket would have made it a unit. 0, reported, when that was meant. */
static int check_brackets(Builder *b, const AstStmt *st, Name effect) {
  if (!st->dims) {
    if (st->unit.n && !(st->kind == STMT_PARAM && st->unit.span.begin > ast_expr(b->ast, st->rhs)->span.begin))
      warn_unit_is_constant(b, &st->unit);
    return 1;
  }
  if (!dims_are_units(b, st)) return 1;
  const char *index = ast_text(b, st->dims);
  diag_error(b->diags, st->name_span, "`%s[%s]` stands for a family, and `%s` is no constant", st->name, index, index);
  diag_help(b->diags, "a unit stands apart: `%s [%s]`", st->name, index);
  declare_refused(b, st, effect);
  return 0;
}

/* The sizes of a family, 1..N each, into e. */
static int read_sizes(Builder *b, const AstStmt *st, Name effect, Entity *e) {
  uint64_t all = e->parts ? e->parts : 1;
  for (AstId i = st->dims; i; i = ast_expr(b->ast, i)->next) {
    Span span = ast_expr(b->ast, i)->span;
    int64_t n;
    if (e->ndims == 2) {
      not_yet(b, span, "more than two indices");
      return 0;
    }
    if (!resolve_whole(b, i, effect, &n)) return 0;
    if (n < 1) {
      diag_error(b->diags, span, "a family has at least one member, and this is %lld", (long long)n);
      return 0;
    }
    if (n > FAMILY_MAX || (all *= (uint64_t)n) > FAMILY_MAX) {
      diag_error(b->diags, span, "a family has at most %d members", FAMILY_MAX);
      return 0;
    }
    e->lo[e->ndims] = 1;
    e->hi[e->ndims++] = n;
  }
  return 1;
}

/* The entity of a family, a vector, or a plain name, declared; 0 after an error. `index` is where its
 * first scalar will stand. */
static int declare_family(Builder *b, const AstStmt *st, Name effect, EntKind kind, uint32_t index, uint8_t parts, Entity *e) {
  *e = (Entity){.kind = kind, .index = index, .name = st->name, .effect = effect, .span = st->name_span, .parts = parts};
  if (!check_brackets(b, st, effect)) return 0;
  if (!read_sizes(b, st, effect, e)) {
    declare_refused(b, st, effect);
    return 0;
  }
  return declare_entity(b, st, *e);
}

/* "th", "th[2]", "r.x", "r[2].x": component k of member `at`. */
static Name scalar_name(Builder *b, const Entity *e, Name stem, const int64_t *at, uint32_t k) {
  Name name = member_name(b, stem, at, e->ndims);
  return e->parts ? intern_printf(b, "%s.%c", name, "xyz"[k]) : name;
}

static Dim per_second(Dim d) {
  Dim second = {1, {[DIM_TIME] = DIM_ONE}};
  return dim_div(d, second);
}

static void add_coord(Builder *b, const AstStmt *st, Name name, Unit unit) {
  Model *m = b->m;
  uint32_t i = m->coords.n;
  Coord c = {.name = name, .span = st->name_span, .periodic = st->periodic, .unit = unit};
  Dim rate = per_second(unit.dim);
  Name v = intern_printf(b, "%s'", name), a = intern_printf(b, "%s''", name);
  c.q = declare_symbol(b, SYM_COORD, i, name, SIGN_UNKNOWN, unit.dim);
  c.v = declare_symbol(b, SYM_VEL, i, v, SIGN_UNKNOWN, rate);
  c.a = declare_symbol(b, SYM_ACC, i, a, SIGN_UNKNOWN, per_second(rate));
  vec_push(b->arena, &m->coords, c);
}

static void declare_coord(Builder *b, const AstStmt *st, Name effect) {
  int two = st->type && strcmp(st->type, "vec2") == 0, three = st->type && strcmp(st->type, "vec3") == 0;
  Entity e;
  if (st->type && !two && !three) {
    not_yet(b, st->name_span, arena_printf(b->arena, "coordinates of type `%s`", st->type));
    declare_refused(b, st, effect);
    return;
  }
  if (!declare_family(b, st, effect, ENT_COORD, b->m->coords.n, two ? 2 : three ? 3 : 0, &e)) return;
  Unit unit = unit_resolve(&st->unit, b->diags, b->arena);
  int64_t at[2] = {1, 1};
  do
    for (uint32_t k = 0; k < (e.parts ? e.parts : 1u); k++) add_coord(b, st, scalar_name(b, &e, st->name, at, k), unit);
  while (next_member(&e, at));
}

static void add_state(Builder *b, const AstStmt *st, Name name, Unit unit) {
  Model *m = b->m;
  uint32_t i = m->states.n;
  State z = {.name = name, .span = st->name_span, .unit = unit};
  z.z = declare_symbol(b, SYM_STATE, i, name, SIGN_UNKNOWN, unit.dim);
  z.rate = declare_symbol(b, SYM_RATE, i, intern_printf(b, "%s'", name), SIGN_UNKNOWN, per_second(unit.dim));
  vec_push(b->arena, &m->states, z);
}

static void declare_state(Builder *b, const AstStmt *st, Name effect) {
  Entity e;
  if (!declare_family(b, st, effect, ENT_STATE, b->m->states.n, 0, &e)) return;
  Unit unit = unit_resolve(&st->unit, b->diags, b->arena);
  int64_t at[2] = {1, 1};
  do add_state(b, st, scalar_name(b, &e, st->name, at, 0), unit);
  while (next_member(&e, at));
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

static void add_param(Builder *b, const AstStmt *st, Name name, Unit unit, Value v, Span span) {
  Model *m = b->m;
  Param p = {.name = name, .span = st->name_span, .sign = st->sign, .unit = unit};
  p.value = value_in(b, v, span, &p.unit);
  p.sym = declare_symbol(b, SYM_PARAM, m->params.n, name, sign_of(st->sign), unit.dim);
  if (p.value && expr_is_num(b->g, p.value)) {
    p.constant = expr_number(b->g, p.value);
    p.has_constant = 1;
  }
  check_sign(b, &p, span);
  vec_push(b->arena, &m->params, p);
}

/* `param m[3] = {1, 3, 1/2} [kg]` */
static void declare_list(Builder *b, const AstStmt *st, Name effect, const AstExpr *list, const AstUnit *behind) {
  Entity e;
  Name stem = effect ? intern_printf(b, "%s.%s", effect, st->name) : st->name;
  Unit unit = unit_resolve(&st->unit, b->diags, b->arena), own = unit;
  if (behind) own = unit_resolve(behind, b->diags, b->arena);
  if (behind && !unit.text[0]) unit = own;
  VEC(Value) values = {0};
  for (AstId i = list->args; i; i = ast_expr(b->ast, i)->next) {
    Value v = resolve(b, i, IN_PARAM, effect);
    if (behind && v.e) v = values_in(b, v, ast_expr(b->ast, i)->span, &own);
    if (behind) v.bare = 0, v.dim = own.dim;
    vec_push(b->arena, &values, v);
  }
  if (!declare_family(b, st, effect, ENT_PARAM, b->m->params.n, 0, &e)) return;
  if (e.ndims != 1 || entity_size(&e) != values.n) {
    diag_error(b->diags, list->span, "the list has %u element%s, and `%s` %s", values.n, values.n == 1 ? "" : "s", st->name,
               e.ndims == 0 ? "is no family" : e.ndims == 2 ? "has two indices" : arena_printf(b->arena, "has %u members", entity_size(&e)));
    if (e.ndims == 2) diag_help(b->diags, "not yet: lists of lists; give one value to all, and others in a scene: `%s[1,2] = ...`", st->name);
  }
  int64_t at[2] = {1, 1};
  AstId i = list->args;
  uint32_t k = 0;
  do {
    add_param(b, st, scalar_name(b, &e, stem, at, 0), unit, k < values.n ? values.at[k] : (Value){0},
              i ? ast_expr(b->ast, i)->span : list->span);
    if (i) i = ast_expr(b->ast, i)->next;
    k++;
  } while (next_member(&e, at));
}

static void declare_param(Builder *b, const AstStmt *st, Name effect) {
  const AstUnit *behind;
  const AstExpr *list = list_behind(b, st->rhs, &behind);
  if (list) {
    declare_list(b, st, effect, list, behind);
    return;
  }
  Entity e;
  Span span = ast_expr(b->ast, st->rhs)->span;
  Unit unit = unit_resolve(&st->unit, b->diags, b->arena);
  /* Its own name is not in scope in its value; without a unit of its own it takes its value's. */
  Value v = resolve(b, st->rhs, IN_PARAM, effect);
  if (v.n) {
    not_yet(b, span, "parameters that are vectors");
    v.e = 0;
  }
  if (!unit.text[0] && v.e && !v.bare && v.dim.known) unit = unit_of_dim(b, v.dim);
  if (!declare_family(b, st, effect, ENT_PARAM, b->m->params.n, 0, &e)) return;
  Name stem = effect ? intern_printf(b, "%s.%s", effect, st->name) : st->name;
  int64_t at[2] = {1, 1};
  do add_param(b, st, scalar_name(b, &e, stem, at, 0), unit, v, span);
  while (next_member(&e, at));
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
  Input in = {.name = effect ? intern_printf(b, "%s.%s", effect, st->name) : st->name, .span = st->name_span};
  in.unit = unit_resolve(&st->unit, b->diags, b->arena);
  in.sym = declare_symbol(b, SYM_INPUT, i, in.name, SIGN_UNKNOWN, in.unit.dim);
  vec_push(b->arena, &m->inputs, in);
}

/* --- families whose members are declared one by one --- */

/* The family's own entity, made when its first member is declared; 0, reported, when the name is taken. */
static uint32_t family_of(Builder *b, const AstStmt *st, Name effect, EntKind kind, const IndexRange *r) {
  const Entity *old = scope_own(&b->scope, st->name, effect);
  if (old && old->kind == ENT_NONE) return 0;
  if (old && old->kind == kind && old->ndims == r->n) return (uint32_t)(old - b->scope.all.at) + 1;
  if (old && old->kind == kind && old->ndims) {
    diag_error(b->diags, st->name_span, "`%s` has %s, here it has %u", st->name, old->ndims == 1 ? "one index" : "two indices", r->n);
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

/* Declares members of kind and index; the entity of the family widens to contain it. */
static int declare_member(Builder *b, const AstStmt *st, uint32_t family, const int64_t *at, uint32_t index, Name *name) {
  Entity *f = &b->scope.all.at[family - 1];
  *name = member_name(b, f->name, at, f->ndims);
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
  scope_add(&b->members, (Entity){.kind = f->kind, .index = index, .name = *name, .effect = f->effect, .span = st->name_span});
  return 1;
}

static int fits_family(Builder *b, const AstStmt *st, const IndexRange *r) {
  uint64_t all = 1;
  for (uint32_t k = 0; k < r->n; k++) all *= r->hi[k] < r->lo[k] ? 0 : (uint64_t)(r->hi[k] - r->lo[k] + 1);
  if (all <= FAMILY_MAX) return 1;
  diag_error(b->diags, st->name_span, "a family has at most %d members", FAMILY_MAX);
  return 0;
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
  for (int64_t i = r.lo[0]; family && i <= r.hi[0]; i++)
    for (int64_t j = r.lo[1]; j <= (r.n > 1 ? r.hi[1] : 0); j++) {
      int64_t at[2] = {i, j};
      if (!declare_member(b, st, family, at, b->lets.n, &d.name)) return;
      for (uint32_t k = 0; k < r.n; k++) d.index[k] = (IndexVar){r.name[k], at[k]};
      vec_push(b->arena, &b->lets, d);
    }
}

static void declare_let(Builder *b, const AstStmt *st, Name effect) {
  if (!check_brackets(b, st, effect)) return;
  if (st->dims) {
    declare_let_family(b, st, effect);
    return;
  }
  if (!declare_name(b, st, effect, ENT_LET, b->lets.n)) return;
  vec_push(b->arena, &b->lets, ((Definition){.stmt = st, .name = st->name, .effect = effect}));
}

static void declare_function(Builder *b, const AstStmt *st, Name effect) {
  if (!declare_name(b, st, effect, ENT_FUNCTION, b->functions.n)) return;
  Definition f = {.stmt = st, .name = st->name, .effect = effect};
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
  Output o = {.name = st->name, .span = st->name_span};
  if (st->dims) {
    IndexRange r;
    uint32_t family = resolve_indices(b, st->dims, effect, &r) ? family_of(b, st, effect, ENT_OBSERVE, &r) : 0;
    if (!family || !declare_member(b, st, family, r.lo, m->observes.n, &o.name)) return;
  } else if (!declare_name(b, st, effect, ENT_OBSERVE, m->observes.n)) {
    return;
  }
  o.unit = unit_resolve(&st->unit, b->diags, b->arena);
  vec_push(b->arena, &m->observes, o);
}

void declare_statement(Builder *b, const AstStmt *st, Name effect, void *data) {
  (void)data;
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
    case STMT_FOR: case STMT_MODEL: case STMT_INCLUDE: case STMT_LAGRANGIAN: case STMT_KINETIC: case STMT_POTENTIAL:
    case STMT_DISSIPATION: case STMT_FORCE: case STMT_FLOW: case STMT_MAP: case STMT_EXPECT:
    case STMT_EVENT: case STMT_EFFECT: case STMT_REQUIRES: case STMT_EXCLUDES: case STMT_SCENE:
    case STMT_START: case STMT_EXACT: case STMT_SET: case STMT_USE: case STMT_SPAN: case STMT_METHOD:
    case STMT_TOLERANCE: case STMT_OUTPUT: case STMT_MONITOR: case STMT_LIKE: case STMT_STOP: return;
  }
}
