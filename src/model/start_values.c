/* Start values, `start q = ...`, and closed forms, `exact q = ...`. A rotation starts with its four quaternion
 * components; `start omega(R) = ...` is converted to their rates after all statements of the scene, as it depends on
 * the start of R. */
#include "model/resolve_impl.h"
#include "sym/expr_eval.h"

typedef struct {
  EntKind kind;
  int velocity;
  Unit unit;
  int guess, rotates;
} StartOf;

/* Unit of bare numbers: the coordinate's, per second for a velocity. */
static const Unit *start_unit(Builder *b, uint32_t i, void *data) {
  StartOf *of = data;
  of->unit = of->kind == ENT_STATE ? b->m->states.at[i].unit : b->m->coords.at[i].unit;
  if (of->velocity) of->unit = unit_per_second(b, &of->unit);
  return &of->unit;
}

static void give_start(Builder *b, uint32_t i, Expr value, Span span, void *data) {
  (void)span;
  Scene *sc = &b->m->scene;
  const StartOf *of = data;
  SymId target = entity_symbol(b->m, of->kind, of->velocity, i);
  if (!b->start_index) b->start_index = ARENA_ARRAY(b->arena, uint32_t, expr_symbol_count(b->g) + 1);
  if (b->start_index[target]) {
    sc->starts.at[b->start_index[target] - 1].value = value;
    sc->starts.at[b->start_index[target] - 1].guess = of->guess;
    return;
  }
  vec_push(b->arena, &sc->starts, ((Start){target, value, 0, of->guess}));
  b->start_index[target] = sc->starts.n;
}

/* Whether the family has a start for target s. */
static int starts_target(const FamilyStart *f, const Symbol *s) {
  const FamilyValue *x = &f->of;
  for (int64_t i = 0; s->kind == f->kind && i < x->range.rows; i++) {
    int64_t from = s->index - subscript_at(&x->at, i, 0), step = x->at.by_turn ? x->at.by_turn : 1;
    if (from >= 0 && from / step < x->range.turns && from % step < x->n) return 1;
  }
  return 0;
}

/* Of models without constraints, which look at each start. Takes the place of starts of its members. */
static int give_family_start(Builder *b, const FamilyValue *x, void *data) {
  Scene *sc = &b->m->scene;
  const StartOf *of = data;
  uint32_t n = sc->starts.n;
  if (b->m->constraints.n || of->guess || of->rotates) return 0;
  FamilyStart f = {of->kind == ENT_STATE ? SYM_STATE : of->velocity ? SYM_VEL : SYM_COORD, *x};
  vec_push(b->arena, &sc->family_starts, f);
  sc->starts.n = 0;
  for (uint32_t i = 0; i < n; i++) {
    Start one = sc->starts.at[i];
    b->start_index[one.target] = 0;
    if (starts_target(&f, expr_symbol(b->g, one.target))) continue;
    sc->starts.at[sc->starts.n++] = one;
    b->start_index[one.target] = sc->starts.n;
  }
  return 1;
}

SymId model_start_target(const Model *m, const FamilyStart *f, int64_t i, int64_t j, uint32_t k) {
  int64_t at = subscript_at(&f->of.at, i, j) + k;
  return f->kind == SYM_STATE ? m->states.at[at].z : f->kind == SYM_VEL ? m->coords.at[at].v : m->coords.at[at].q;
}

void model_eval_starts(const Model *m, long double *symbols) {
  const Scene *sc = &m->scene;
  long double y[4];
  vec_each(const FamilyStart, f, sc->family_starts) {
    const FamilyValue *x = &f->of;
    EvalTape *tape = eval_tape(m->g, x->value, x->n);
    for (int64_t t = 0; t < x->range.rows * x->range.turns; t++) {
      int64_t i = t / x->range.turns, j = t % x->range.turns;
      symbols[x->index[0]] = (long double)(x->lo[0] + i);
      symbols[x->index[1]] = (long double)(x->lo[1] + j);
      eval_run(tape, symbols, y);
      for (uint32_t c = 0; c < x->n; c++) symbols[model_start_target(m, f, i, j, c)] = y[c];
    }
    eval_tape_free(m->g, tape);
  }
  for (uint32_t i = 0; i < sc->starts.n; i++)
    expr_eval(m->g, &sc->starts.at[i].value, 1, symbols, &symbols[sc->starts.at[i].target]);
}

static void give_closed_form(Builder *b, uint32_t i, Expr value, Span span, void *data) {
  const StartOf *of = data;
  int periodic = of->kind == ENT_STATE ? b->m->states.at[i].periodic : !of->velocity && b->m->coords.at[i].periodic;
  set_closed_form(b, entity_symbol(b->m, of->kind, of->velocity, i), start_unit(b, i, data), periodic, value, span);
}

static void give_spin(Builder *b, const AstStmt *st);

/* Warns of `start th = 30` for an angle in rad: an integer from 7 to 360 was probably meant in degrees. */
static void warn_of_degrees(Builder *b, const Coord *q, AstId value) {
  const AstExpr *x = ast_expr(b->ast, value);
  if (x->kind == AST_NEG) x = ast_expr(b->ast, x->a);
  double v = x->kind == AST_NUM ? num_value(x->number) : 0;
  if (strcmp(q->unit.text, "rad") != 0 || !(v > 6) || v > 360 || v != (double)(int)v) return;
  diag_warning(b->diags, x->span, "`%s` is measured in rad, and %g rad are %.2g turns", q->name, v,
               v / 6.283185307179586);
  diag_help(b->diags, "write %g [deg] where degrees are meant, and %g [rad] where not", v, v);
}

/* Whether entity e, which x names, may have a start or a closed form; else a message. */
static int may_be_given(Builder *b, const AstExpr *x, const AstExpr *name, const Target *p, const Entity *e,
                        int exact) {
  if (e->kind != ENT_COORD && e->kind != ENT_STATE) {
    diag_error(b->diags, name->span, "`%s` is %s; only coordinates, velocities and states %s", name->name,
               ent_kind_text(e->kind), exact ? "have a closed form" : "start somewhere");
    if (e->kind == ENT_PARAM && !exact) diag_help(b->diags, "write `%s = ...` without `start`", name->name);
    return 0;
  }
  if (p->primes && e->kind == ENT_STATE) {
    int is_coord = is_coordinate(b, e);
    if (is_coord)
      diag_error(b->diags, x->span, "`%s'` follows from the coordinates%s: %s, and the motion of first order",
                 name->name, b->m->hamiltonian ? " and momenta" : "", no_inertia(b->m));
    else diag_error(b->diags, x->span, "the rate of a state follows from its flow");
    diag_help(b->diags,
              exact ? "give the closed form of the %s itself: `exact %s = ...`"
                    : "give the start of the %s itself: `start %s = ...`",
              is_coord ? "coordinate" : "state", name->name);
    return 0;
  }
  if (p->primes && e->parts == ROTATION && p->part < 0) {
    diag_error(b->diags, x->span, "`%s` is a rotation, and its rate is an angular velocity", name->name);
    diag_help(b->diags, "`start omega(%s) = (a, b, c)` gives it, in the rotation's own frame", name->name);
    return 0;
  }
  return 1;
}

/* Reads `start q = ...` or `exact q = ...` for a coordinate, velocity or state. `start exactly`: constraints may not
 * move it. */
void set_motion(Builder *b, const AstStmt *st) {
  if (ast_expr(b->ast, st->lhs)->kind == AST_CALL) {
    give_spin(b, st);
    return;
  }
  int exact = st->kind == STMT_EXACT;
  Target p = read_target(b, st->lhs);
  const AstExpr *x = ast_expr(b->ast, st->lhs), *name = ast_expr(b->ast, p.stem);
  Name owner = name->kind == AST_MEMBER && !p.wrong ? ast_expr(b->ast, name->a)->name : NULL; /* e1.y */
  if (p.wrong || p.primes > 1 || (name->kind != AST_NAME && !owner) || (owner && declared_in_use(b, owner, NULL))) {
    if (name->kind == AST_ERROR) return;
    if (exact)
      diag_error(b->diags, x->span,
                 "a closed form is that of a coordinate, a velocity or a state: `exact x = x(0)*cos(w*t)`");
    else diag_error(b->diags, x->span, "a start gives a coordinate or a velocity: `start th = 90 [deg]`");
    return;
  }
  const Entity *e =
      owner ? scope_own(&b->scope, name->name, owner) : resolve_name(b, name->name, name->span, NULL, "coord");
  if (!e && owner) report_no_member(b, name->span, owner, name->name);
  if (!e) return;
  if (e->kind == ENT_NONE) return;
  if (!may_be_given(b, x, name, &p, e, exact)) return;
  if (e->kind == ENT_COORD && !p.primes && !exact && e->parts != ROTATION && entity_size(e))
    warn_of_degrees(b, &b->m->coords.at[e->index], st->rhs);
  if (st->exactly == START_EXACTLY && !b->m->scene.exactly.end) b->m->scene.exactly = st->span;
  StartOf of = {.kind = e->kind, .velocity = p.primes > 0, .guess = st->exactly == START_GUESS,
                .rotates = e->parts == ROTATION};
  Assigner assigner = {exact ? IN_EXACT : IN_START, start_unit, exact ? give_closed_form : give_start, &of, NULL,
                       exact ? NULL : give_family_start};
  assign_values(b, &p, e, st->lhs, st->rhs, &assigner);
}

/* --- rotations --- */

static const Entity *spin_entity(Builder *b, AstId call, Name effect, Target *p) {
  const AstExpr *x = ast_expr(b->ast, call);
  AstId arg = x->args;
  *p = read_target(b, arg);
  const AstExpr *stem = ast_expr(b->ast, p->stem);
  int plain = strcmp(x->name, "omega") == 0 && !p->wrong && !p->primes && p->part < 0;
  const Entity *e = NULL;
  if (plain && stem->kind == AST_MEMBER) e = scope_own(&b->scope, stem->name, ast_expr(b->ast, stem->a)->name);
  else if (plain) e = scope_find(&b->scope, stem->name, effect, NULL);
  if (e && e->kind == ENT_COORD && e->parts == ROTATION) return e;
  diag_error(b->diags, x->span, "`%s` is not the angular velocity of a rotation coordinate", ast_short(b, call));
  diag_help(b->diags, "`omega(R) = (a, b, c)` gives the angular velocity of `coord R: rotation`, in its own frame");
  return NULL;
}

int spin_target(Builder *b, AstId place, Name effect) {
  Target p;
  int64_t at[2] = {0};
  if (ast_expr(b->ast, place)->kind != AST_CALL) return -1;
  const Entity *e = spin_entity(b, place, effect, &p);
  if (!e) return -2;
  IndexRange r = {0};
  if (p.indices && !resolve_indices(b, p.indices, effect, &r)) return -2;
  for (uint32_t k = 0; k < r.n; k++) at[k] = r.lo[k];
  if (r.n == e->ndims && index_in_range(b, e, at, ast_expr(b->ast, place)->span))
    return (int)(e->index + member_offset(e, at));
  if (r.n != e->ndims)
    diag_error(b->diags, ast_expr(b->ast, place)->span, "`%s` does not name one rotation", ast_short(b, place));
  return -2;
}

Unit spin_unit(const Builder *b) { return unit_si(dim_per_second(b->dims, DIM_NONE), "rad/s"); }

/* Target of values for omega(R): assign_values numbers them as vectors of 3 components, rotations have 4. */
typedef struct {
  uint32_t index; /* first coordinate of the family's first rotation */
  Unit unit;
} SpinOf;

static const Unit *unit_of_spin(Builder *b, uint32_t i, void *data) {
  (void)b;
  (void)i;
  return &((SpinOf *)data)->unit;
}

static SpinStart *find_spin(Builder *b, uint32_t coord) {
  for (uint32_t i = 0; i < b->spins.n; i++)
    if (b->spins.at[i].coord == coord) return &b->spins.at[i];
  vec_push(b->arena, &b->spins, ((SpinStart){.coord = coord}));
  return &b->spins.at[b->spins.n - 1];
}

static void assign_spin(Builder *b, uint32_t i, Expr value, Span span, void *data) {
  SpinStart *s = find_spin(b, ((SpinOf *)data)->index + i / 3 * ROTATION);
  s->at[i % 3] = value;
  s->span = span;
}

static void give_spin(Builder *b, const AstStmt *st) {
  Target p;
  const Entity *e = spin_entity(b, st->lhs, NULL, &p);
  if (!e) return;
  if (st->kind == STMT_EXACT) {
    diag_error(b->diags, ast_expr(b->ast, st->lhs)->span,
               "a closed form is that of a rotation itself: `exact R = turn(axis, w*t)`");
    return;
  }
  SpinOf of = {e->index, spin_unit(b)};
  Entity vectors = *e;
  vectors.index = 0;
  vectors.parts = 3;
  if (!e->ndims) vectors.name = intern_printf(b, "omega(%s)", e->name);
  Assigner assigner = {IN_START, unit_of_spin, assign_spin, &of, NULL, NULL};
  assign_values(b, &p, &vectors, st->lhs, st->rhs, &assigner);
}

static int starts(const Builder *b, SymId s) { return b->start_index && b->start_index[s]; }

/* Start of a rotation as a unit quaternion: normalised start values, by default the identity. */
static Value start_of_rotation(Builder *b, uint32_t coord) {
  Value q = {.n = ROTATION};
  Expr square[ROTATION];
  for (uint32_t k = 0; k < ROTATION; k++) {
    SymId s = b->m->coords.at[coord + k].q;
    q.at[k] = starts(b, s) ? b->m->scene.starts.at[b->start_index[s] - 1].value : expr_int(b->g, k == 0);
    square[k] = expr_pow_num(b->g, q.at[k], num_int(2));
  }
  Expr sum = expr_add_n(b->g, square, ROTATION), shorter = expr_pow_num(b->g, sum, num_ratio(-1, 2));
  for (uint32_t k = 0; k < ROTATION; k++) q.at[k] = expr_mul(b->g, q.at[k], shorter);
  return q;
}

static void complete_spin_start(Builder *b, const SpinStart *s) {
  Value q = start_of_rotation(b, s->coord), rates = rotation_rates(b, &q, s->at);
  StartOf of = {.kind = ENT_COORD, .velocity = 1};
  for (uint32_t k = 0; k < ROTATION; k++) {
    const Coord *c = &b->m->coords.at[s->coord + k];
    if (starts(b, c->v)) {
      diag_error(b->diags, s->span,
                 "the angular velocity is given twice: by `omega`, and by `%s'`" HELP "leave out one of them", c->name);
      return;
    }
    give_start(b, s->coord + k, rates.at[k], s->span, &of);
  }
}

void complete_rotation_starts(Builder *b) {
  for (uint32_t i = 0; i < b->spins.n; i++) complete_spin_start(b, &b->spins.at[i]);
  for (uint32_t i = 0; i < b->rotations.n && b->m->coords.n; i++) {
    SymId w = b->m->coords.at[b->rotations.at[i]].q;
    if (!starts(b, w)) vec_push(b->arena, &b->m->scene.starts, ((Start){w, expr_int(b->g, 1), 1, 0}));
  }
}
