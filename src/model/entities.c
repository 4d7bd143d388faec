/* Named things of a model: symbols and entities as they are declared, their ranges and units; lists of a model's
 * coordinates, constants and scenes; constraints with their multipliers. */
#include <string.h>

#include "model/resolve_impl.h"

SymId declare_symbol(Builder *b, SymKind kind, uint32_t index, Name name, ExprSign sign, Dim dim) {
  SymId s = expr_declare(b->g, kind, index, name, sign);
  while (b->dim_of.n <= s) vec_push(b->arena, &b->dim_of, DIM_ANY);
  b->dim_of.at[s] = dim;
  return s;
}

int declare_entity(Builder *b, const AstStmt *st, Entity e) {
  const Entity *old = scope_own(&b->scope, st->name, e.effect);
  if (old) {
    diag_error(b->diags, st->name_span, "`%s` is declared twice", st->name);
    diag_also(b->diags, old->span, "first declared here, as %s", ent_kind_text(old->kind));
    return 0;
  }
  scope_add(&b->scope, e);
  return 1;
}

IndexRange entity_range(const Entity *e) {
  IndexRange r = {.n = e->ndims};
  for (int k = 0; k < e->ndims; k++) {
    r.lo[k] = e->lo[k];
    r.hi[k] = e->hi[k];
  }
  return r;
}

const Unit *entity_unit(const Builder *b, const Entity *e) {
  const Model *m = b->m;
  switch (entity_size(e) ? e->kind : ENT_NONE) {
    case ENT_COORD: return &m->coords.at[e->index].unit;
    case ENT_STATE: return &m->states.at[e->index].unit;
    case ENT_INPUT: return &m->inputs.at[e->index].unit;
    case ENT_PARAM: return &m->params.at[e->index].unit;
    case ENT_OBSERVE: return &m->observes.at[e->index].unit;
    case ENT_SYMMETRY: return &m->symmetries.at[e->index].unit;
    case ENT_NONE: case ENT_CONST: case ENT_LET: case ENT_FUNCTION: case ENT_BUILTIN: break;
  }
  return NULL;
}

SymId entity_symbol(const Model *m, EntKind kind, int rate, uint32_t i) {
  return kind == ENT_COORD   ? (rate ? m->coords.at[i].v : m->coords.at[i].q)
         : kind == ENT_STATE ? (rate ? m->states.at[i].rate : m->states.at[i].z)
         : kind == ENT_PARAM ? m->params.at[i].sym
                             : m->inputs.at[i].sym;
}

int is_coordinate(const Builder *b, const Entity *e) {
  if (e->kind != ENT_STATE) return e->kind == ENT_COORD;
  return entity_size(e) ? b->m->states.at[e->index].coordinate : b->m->first_order || b->m->hamiltonian;
}

int is_momentum_name(Name name) { return name[0] == 'p' && (strlen(name) <= 2 || name[1] == '_'); }

long double *model_constants(const Model *m) {
  long double *values = ARENA_ARRAY(m->arena, long double, expr_symbol_count(m->g) + 1);
  values[m->pi] = 3.14159265358979323846264338327950288L;
  return values;
}

CoordList model_coordinates(const Model *m) {
  VEC(Name) names = {0};
  for (uint32_t i = 0; i < m->coords.n; i++) vec_push(m->arena, &names, m->coords.at[i].name);
  for (uint32_t i = 0; i < m->states.n; i++)
    if (m->states.at[i].coordinate) vec_push(m->arena, &names, m->states.at[i].name);
  return (CoordList){names.at, names.n};
}

SceneList model_scenes(const Ast *ast) {
  VEC(Name) names = {0};
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == STMT_SCENE && s->name) vec_push(ast->arena, &names, s->name);
  if (!names.n) vec_push(ast->arena, &names, intern(ast->names, "default"));
  return (SceneList){names.at, names.n};
}

/* Dimension of lambda: lambda c is an energy; for velocity constraints a power. */
Dim multiplier_dim(Builder *b, Dim dim, int holonomic) {
  Dim energy = holonomic ? b->energy : dim_per_second(b->dims, b->energy);
  return dim_div(b->dims, energy, dim);
}

void add_scalar_constraint(Builder *b, Name name, Expr c, Dim dim, Span span) {
  Model *m = b->m;
  Constraint one = {.name = name, .span = span, .c = c, .dim = dim};
  int holonomic = !(expr_kinds(b->g, c) & 1u << SYM_VEL);
  one.multiplier = declare_symbol(b, SYM_MULTIPLIER, m->constraints.n, intern_printf(b, "lambda(%s)", name),
                                  SIGN_UNKNOWN, multiplier_dim(b, dim, holonomic));
  vec_push(b->arena, &m->constraints, one);
}
