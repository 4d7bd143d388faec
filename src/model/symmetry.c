/* Symmetries: `symmetry spin(s): x -> x*cos(s) - y*sin(s), y -> x*sin(s) + y*cos(s)`, a transformation of
 * coordinates and time that is the identity at s = 0. The model keeps its generator only, the first-order part in s,
 * which is all that Noether's theorem needs. In outputs, the symmetry's name means its charge. */
#include <math.h>

#include "model/resolve_impl.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/print.h"
#include "sym/prove.h"
#include "sym/simplify.h"

/* Name with its effect: "wind.gust". */
static Name full_name(Builder *b, Name name, Name effect) {
  return effect ? intern_printf(b, "%s.%s", effect, name) : name;
}

/* Name of the group parameter; NULL, reported, if there are two, or the model declares the name. */
static Name parameter_name(Builder *b, const AstStmt *st, Name effect) {
  const AstExpr *s = ast_expr(b->ast, st->args);
  const Entity *other = scope_find(&b->scope, s->name, effect, NULL);
  if (s->next) {
    diag_error(b->diags, ast_expr(b->ast, s->next)->span,
               "a symmetry has one parameter" HELP "write two symmetries: each has a charge of its own");
    return NULL;
  }
  if (!other) return s->name;
  diag_error(b->diags, s->span, "`%s` is %s of the model, and here the parameter of a symmetry", s->name,
             ent_kind_text(other->kind));
  diag_also(b->diags, other->span, "declared here");
  return NULL;
}

/* 1, reported, for the reserved names `energy` and `exact`. */
static int is_taken(Builder *b, const AstStmt *st) {
  int energy = strcmp(st->name, "energy") == 0;
  if (!energy && strcmp(st->name, "exact") != 0) return 0;
  diag_error(b->diags, st->name_span, "a symmetry cannot be called `%s`", st->name);
  if (energy)
    diag_help(
        b->diags,
        "`energy` is the charge of t -> t - s, which every model has, in outputs, monitors and reports; call it `%s_2`",
        st->name);
  else diag_help(b->diags, "`monitor exact` watches the scene's closed forms; call it `%s_2`", st->name);
  return 1;
}

void declare_symmetry(Builder *b, const AstStmt *st, Name effect) {
  Model *m = b->m;
  if (is_taken(b, st)) return;
  Entity e = {
      .kind = ENT_SYMMETRY, .index = m->symmetries.n, .name = st->name, .effect = effect, .span = st->name_span};
  if (!declare_entity(b, st, e)) return;
  Symmetry y = {.name = full_name(b, st->name, effect), .effect = effect, .doc = st->doc, .span = st->span, .stmt = st,
                .moved = expr_map(b->arena)};
  Name s = ast_expr(b->ast, st->args)->name;
  Dim dim = b->unitless ? DIM_ANY : dim_unknown(b->dims, s),
      action = dim_mul(b->dims, b->energy, dim_base(b->dims, DIM_TIME));
  y.parameter = declare_symbol(b, SYM_LOCAL, 0, s, SIGN_UNKNOWN, dim);
  y.unit = unit_si(b->unitless ? DIM_ANY : dim_div(b->dims, action, dim), "");
  y.charge = declare_symbol(b, SYM_LOCAL, 0, y.name, SIGN_UNKNOWN, y.unit.dim);
  vec_push(b->arena, &m->symmetries, y);
}

/* --- maps --- */

typedef struct {
  Builder *b;
  Symmetry *of;
  const AstStmt *map;
  Span target; /* left side of the map */
  EntKind kind;
} Mapping;

/* 1 if the transformed coordinate depends on coordinates, t and parameters only (a point transformation); 0,
 * reported. */
static int is_of_points(const Mapping *p, Expr to, Span span) {
  Builder *b = p->b;
  const Model *m = b->m;
  unsigned kinds = expr_kinds(b->g, to);
  const char *what = kinds & (1u << SYM_VEL | 1u << SYM_RATE) ? "velocities"
                     : kinds & 1u << SYM_INPUT                ? "inputs"
                                                              : NULL;
  ExprList l = expr_topo(b->g, &to, 1);
  for (uint32_t i = 0; i < l.n && !what && kinds & 1u << SYM_STATE; i++) {
    const Symbol *s = expr_op(b->g, l.at[i]) == EX_SYM ? expr_sym_of(b->g, l.at[i]) : NULL;
    if (s && s->kind == SYM_STATE && !m->states.at[s->index].coordinate) what = "states";
  }
  if (!what) return 1;
  return diag_error(b->diags, span, "a symmetry cannot depend on %s" HELP
                    "it maps coordinates and t to functions of coordinates, t and parameters; velocities follow", what);
}

/* Name of the rotation that a coordinate belongs to, or NULL. */
static Name rotation_of(const Builder *b, SymId target) {
  const Model *m = b->m;
  for (uint32_t i = 0; i < b->rotations.n; i++)
    for (uint32_t k = 0; k < ROTATION && b->rotations.at[i] + k < m->coords.n; k++) {
      const Coord *c = &m->coords.at[b->rotations.at[i] + k];
      if (c->q == target) return arena_strndup(b->arena, c->name, strlen(c->name) - strlen(".w"));
    }
  return NULL;
}

/* 1 if the map is proved to be the identity at s = 0; 0, reported. */
static int begins_at_identity(const Mapping *p, SymId target, Expr to, Span span) {
  Builder *b = p->b;
  Expr zero = expr_int(b->g, 0), start = expr_replace(b->g, to, &p->of->parameter, &zero, 1),
       own = expr_symbol(b->g, target)->node;
  Expr left = expr_sub(b->g, start, own);
  Name s = expr_symbol(b->g, p->of->parameter)->name, name = expr_symbol(b->g, target)->name;
  Verdict v = prove_zero(b->g, left, NULL);
  if (v == PROVED_ZERO) return 1;
  Name turned = rotation_of(b, target);
  if (turned)
    return diag_error(b->diags, span,
                      "at %s = 0 the symmetry `%s` turns `%s`" HELP
                      "write by how much %s turns it: about an axis of space by `%s -> turn((0, 0, 1), %s)*%s`, about "
                      "its own by `%s -> %s*turn((0, 0, 1), %s)`",
                      s, p->of->name, turned, s, turned, s, turned, turned, turned, s);
  const char *text = expr_text(b->g, simplify(b->g, start));
  if (v == PROVED_NONZERO) diag_error(b->diags, span, "at %s = 0 the symmetry `%s` maps `%s` to `%s`, not to itself", s,
                                      p->of->name, name, text);
  else diag_error(b->diags, span, "no proof that the symmetry `%s` maps `%s` to itself at %s = 0: the result is `%s`",
                  p->of->name, name, s, text);
  diag_help(b->diags, "write the transformed value, a function of %s that equals `%s` at 0: `%s -> %s + %s`", s, name,
            name, name, s);
  return 0;
}

/* Whether a corner, as |s| has, depends on s. */
static int has_corner(const Mapping *p, Expr to) {
  ExprGraph *g = p->b->g;
  ExprList l = expr_topo(g, &to, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    ExprOp op = expr_op(g, l.at[i]);
    int corner = op == EX_ABS || op == EX_SIGN || op == EX_FLOOR || op == EX_MIN || op == EX_MAX || op == EX_SELECT;
    if (corner && expr_contains_sym(g, l.at[i], p->of->parameter)) return 1;
  }
  return 0;
}

static void report_no_rate(const Builder *b, const Symmetry *y, Move *move) {
  Name s = expr_symbol(b->g, y->parameter)->name, turned = rotation_of(b, move->target),
       name = turned ? turned : expr_symbol(b->g, move->target)->name;
  diag_error(b->diags, move->value,
             "the symmetry `%s` maps `%s` to an expression that is not differentiable by %s at %s = 0", y->name, name,
             s, s);
  const char *as = turned ? arena_printf(b->arena, "`%s -> turn((0, 0, 1), %s)*%s`", name, s, name)
                          : arena_printf(b->arena, "`%s -> %s + %s`", name, name, s);
  diag_help(b->diags, "a charge belongs to a transformation that is smooth in its parameter, as %s is", as);
  move->rate = 0;
}

/* Reports moves whose rate has a value at none of some random states, as that of sqrt(s) at s = 0. */
static void check_rates(Builder *b, const Symmetry *y) {
  enum { TRIES = 64 }; /* some maps, like x + s*sqrt(k), have no value at many random states */
  uint32_t n = y->moves.n, open = n;
  Expr *rates = ARENA_ARRAY(b->arena, Expr, n + 1);
  uint8_t *known = ARENA_ARRAY(b->arena, uint8_t, n + 1);
  long double *symbols = ARENA_ARRAY(b->arena, long double, expr_symbol_count(b->g) + 1),
              *value = ARENA_ARRAY(b->arena, long double, n + 1);
  for (uint32_t i = 0; i < n; i++) rates[i] = y->moves.at[i].rate;
  EvalTape *tape = eval_tape(b->g, rates, n);
  for (uint32_t seed = 1; seed <= TRIES && open; seed++) {
    sample_state(b->g, seed, symbols);
    eval_run(tape, symbols, value);
    for (uint32_t i = open = 0; i < n; i++) open += !(known[i] |= isfinite(value[i]) != 0);
  }
  for (uint32_t i = 0; i < n; i++)
    if (!known[i]) report_no_rate(b, y, &y->moves.at[i]);
}

static void add_move(const Mapping *p, SymId target, Expr to, Span span) {
  Builder *b = p->b;
  Symmetry *y = p->of;
  Name name = expr_symbol(b->g, target)->name;
  Expr node = expr_symbol(b->g, target)->node;
  uint32_t first = expr_map_get(&y->moved, node);
  if (first) {
    diag_error(b->diags, p->target, "the symmetry `%s` maps `%s` twice", y->name, name);
    diag_also(b->diags, y->moves.at[first - 1].span,
              "first here; all maps are one transformation, of the old coordinates");
    if (b->index.n)
      diag_help(b->diags, "maps after a `for` belong to it, up to the next `for`: write other maps before it");
    return;
  }
  Move move = {.target = target, .span = p->map->span, .value = span};
  if (is_of_points(p, to, span) && begins_at_identity(p, target, to, span)) {
    Expr zero = expr_int(b->g, 0), slope = expr_diff(b->g, to, y->parameter);
    Expr rate = expr_replace(b->g, slope, &y->parameter, &zero, 1);
    move.rate = simplify(b->g, rate);
    if (has_corner(p, to)) report_no_rate(b, y, &move);
  }
  vec_push(b->arena, &y->moves, move);
  expr_map_set(&y->moved, node, y->moves.n);
}

static const Unit *unit_of_target(Builder *b, uint32_t scalar, void *data) {
  const Mapping *p = data;
  return p->kind == ENT_STATE ? &b->m->states.at[scalar].unit : &b->m->coords.at[scalar].unit;
}

static void give_target(Builder *b, uint32_t scalar, Expr value, Span span, void *data) {
  const Mapping *p = data;
  add_move(p, entity_symbol(b->m, p->kind, 0, scalar), value, span);
}

/* Adds the map of time, `t -> ...`. */
static void map_time(Mapping *p, AstId rhs, Name effect) {
  Builder *b = p->b;
  Unit s = unit_si(b->dim_of.at[b->m->time], "s");
  Expr to = resolve_in(b, rhs, IN_DYNAMICS, effect, &s);
  if (to) add_move(p, b->m->time, to, ast_expr(b->ast, rhs)->span);
}

static void report_target(Builder *b, const Target *p, const AstExpr *name, const Entity *e) {
  const char *what = p->primes ? "a velocity" : ent_kind_text(e->kind);
  diag_error(b->diags, name->span, "`%s` is %s: a symmetry maps coordinates and t", source_text(b, name->span), what);
  if (p->primes) diag_help(b->diags, "maps of velocities follow from those of coordinates and t");
  else if (e->kind == ENT_PARAM) diag_help(b->diags, "another value of a parameter is another model");
  else if (e->kind == ENT_STATE) diag_help(b->diags, "the states of a flow have no momenta");
}

static void add_map(Builder *b, const AstStmt *st, Name effect, void *data) {
  Mapping p = {.b = b, .of = data, .map = st, .target = ast_expr(b->ast, st->lhs)->span};
  Target target = read_target(b, st->lhs);
  const AstExpr *whole = ast_expr(b->ast, st->lhs), *name = ast_expr(b->ast, target.stem);
  if (name->kind == AST_ERROR) return;
  if (!target.wrong && name->kind == AST_NAME && strcmp(name->name, "t") == 0 && !target.primes && !target.indices &&
      target.part < 0) {
    map_time(&p, st->rhs, effect);
    return;
  }
  Name owner = name->kind == AST_MEMBER && !target.wrong ? ast_expr(b->ast, name->a)->name : NULL; /* wind.y */
  if (target.wrong || (name->kind != AST_NAME && !owner)) {
    diag_error(b->diags, whole->span, "a symmetry maps coordinates and t: `symmetry shift(s): x -> x + s`");
    return;
  }
  const Entity *e =
      owner ? scope_own(&b->scope, name->name, owner) : resolve_name(b, name->name, name->span, effect, "coord");
  if (!e && owner) report_no_member(b, name->span, owner, name->name);
  if (!e || e->kind == ENT_NONE) return;
  p.kind = e->kind;
  if (target.primes || !is_coordinate(b, e)) {
    report_target(b, &target, target.primes ? whole : name, e);
    return;
  }
  Assigner assigner = {IN_DYNAMICS, unit_of_target, give_target, &p, effect, NULL};
  assign_values(b, &target, e, st->lhs, st->rhs, &assigner);
}

/* Reports a generator that is zero: its charge would be 0. */
static void check_moves(Builder *b, const Symmetry *y) {
  int good = 1, some = 0;
  for (uint32_t i = 0; i < y->moves.n; i++) {
    good &= y->moves.at[i].rate != 0;
    some |= y->moves.at[i].rate && !expr_is_zero(b->g, y->moves.at[i].rate);
  }
  if (some || !good || !y->moves.n) return;
  diag_error(b->diags, y->span,
             "the symmetry `%s` moves nothing, to first order in its parameter" HELP "its charge would be 0", y->name);
}

void add_symmetry(Builder *b, const AstStmt *st, Name effect) {
  Symmetry *y = NULL;
  for (uint32_t i = 0; i < b->m->symmetries.n; i++)
    if (b->m->symmetries.at[i].stmt == st && b->m->symmetries.at[i].effect == effect) y = &b->m->symmetries.at[i];
  if (!y) return; /* its name was taken: reported */
  if (!b->m->lagrangian) {
    diag_error(b->diags, st->span, "a symmetry needs a Lagrangian, and the model has none");
    return;
  }
  BoundName group = {parameter_name(b, st, effect), y->parameter};
  b->bound = &group;
  b->nbound = group.name != NULL;
  for (const AstStmt *map = st->body; map && group.name; map = map->next) each_statement(b, map, effect, add_map, y);
  if (group.name) check_rates(b, y), check_moves(b, y);
  b->nbound = 0;
}
