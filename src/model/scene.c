/* Scenes: which statements are active, and what a scene says of a run. */
#include <math.h>

#include "base/suggest.h"
#include "model/builder.h"

/* --- the file's scenes and effects --- */

static const AstStmt *find_stmt(const Ast *ast, AstStmtKind kind, const char *name) {
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == kind && s->name && (!name || strcmp(s->name, name) == 0)) return s;
  return NULL;
}

SceneList model_scenes(const Ast *ast) {
  VEC(Name) names = {0};
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == STMT_SCENE && s->name) vec_push(ast->arena, &names, s->name);
  if (!names.n) vec_push(ast->arena, &names, intern(ast->names, "default"));
  return (SceneList){names.at, names.n};
}

EffectList model_unused_effects(const Ast *ast) {
  VEC(Name) unused = {0};
  for (const AstStmt *e = ast->first; e; e = e->next) {
    if (e->kind != STMT_EFFECT || !e->name) continue;
    int used = 0;
    for (const AstStmt *s = ast->first; s; s = s->next)
      for (const AstStmt *x = s->kind == STMT_SCENE ? s->body : NULL; x; x = x->next)
        used |= x->kind == STMT_USE && x->name == e->name;
    if (!used) vec_push(ast->arena, &unused, e->name);
  }
  return (EffectList){unused.at, unused.n};
}

/* Blocks nest at most as deep as the parser lets them. */
static int contains_claim(const AstStmt *list) {
  for (const AstStmt *s = list; s; s = s->next)
    if (s->kind == STMT_EXPECT || s->kind == STMT_SYMMETRY || (s->kind == STMT_FOR && contains_claim(s->body))) return 1;
  return 0;
}

EffectList model_claiming_effects(const Ast *ast) {
  VEC(Name) names = {0};
  if (contains_claim(ast->first)) vec_push(ast->arena, &names, NULL);
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == STMT_EFFECT && s->name && contains_claim(s->body)) vec_push(ast->arena, &names, s->name);
  return (EffectList){names.at, names.n};
}

static Name nearest(const Ast *ast, AstStmtKind kind, const char *wrong) {
  VEC(Name) names = {0};
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == kind && s->name) vec_push(ast->arena, &names, s->name);
  return suggest(wrong, names.at, names.n);
}

static const char *all_scenes(const Ast *ast) {
  StrBuf list = strbuf(ast->arena);
  SceneList scenes = model_scenes(ast);
  for (uint32_t i = 0; i < scenes.n && i < 12; i++) sb_printf(&list, "%s`%s`", i ? ", " : "", scenes.at[i]);
  if (scenes.n > 12) sb_puts(&list, ", ...");
  return sb_text(&list);
}

static void report_unknown(const Ast *ast, AstStmtKind kind, Span span, const char *name) {
  const char *what = kind == STMT_SCENE ? "scene" : "effect";
  diag_error(ast->diags, span, "unknown %s `%s`", what, name);
  Name near = nearest(ast, kind, name);
  if (near) diag_help(ast->diags, "did you mean `%s`?", near);
  else if (kind == STMT_EFFECT) diag_help(ast->diags, "declare it: `effect %s { ... }`", name);
  else diag_help(ast->diags, "the scenes are %s", all_scenes(ast));
}

int model_has_scene(Ast *ast, const char *scene) {
  SceneList scenes = model_scenes(ast);
  for (uint32_t i = 0; i < scenes.n; i++)
    if (strcmp(scenes.at[i], scene) == 0) return 1;
  report_unknown(ast, STMT_SCENE, (Span){0}, scene);
  return 0;
}

/* The scene and those it is like, the farthest ancestor first; NULL-terminated. */
static const AstStmt **scene_chain(Builder *b, const AstStmt *scene) {
  VEC(const AstStmt *) chain = {0};
  for (const AstStmt *s = scene; s;) {
    for (uint32_t i = 0; i < chain.n; i++)
      if (chain.at[i] == s) {
        diag_error(b->diags, s->name_span, "the scene `%s` is like itself", s->name);
        diag_help(b->diags, "`like` must not lead back to the scene");
        s = NULL;
        break;
      }
    if (!s) break;
    vec_push(b->arena, &chain, s);
    const AstStmt *next = NULL;
    for (const AstStmt *x = s->body; x; x = x->next)
      if (x->kind == STMT_LIKE) {
        next = find_stmt(b->ast, STMT_SCENE, x->name);
        if (!next) report_unknown(b->ast, STMT_SCENE, x->name_span, x->name);
      }
    s = next;
  }
  const AstStmt **out = ARENA_ARRAY(b->arena, const AstStmt *, chain.n + 1);
  for (uint32_t i = 0; i < chain.n; i++) out[i] = chain.at[chain.n - 1 - i];
  return out;
}

/* --- effects in use --- */

static int uses(const Builder *b, Name effect) {
  for (uint32_t i = 0; i < b->m->effects.n; i++)
    if (b->m->effects.at[i] == effect) return 1;
  return 0;
}

static int is_use_none(const AstStmt *st) { return st->kind == STMT_USE && strcmp(st->name, "none") == 0; }

static void collect_uses(Builder *b, const AstStmt *scene) {
  for (const AstStmt *x = scene->body; x; x = x->next) {
    if (x->kind != STMT_USE) continue;
    if (is_use_none(x)) {
      b->m->effects.n = 0;
      if (x->body) diag_error(b->diags, x->body->span, "`use none` turns all effects off, and takes no values");
    }
    else if (!find_stmt(b->ast, STMT_EFFECT, x->name)) report_unknown(b->ast, STMT_EFFECT, x->name_span, x->name);
    else if (!uses(b, x->name)) vec_push(b->arena, &b->m->effects, x->name);
  }
}

/* Turns an effect on together with what it requires. */
static void use_with_needs(Builder *b, Name effect) {
  if (uses(b, effect)) return;
  vec_push(b->arena, &b->m->effects, effect);
  for (uint32_t i = b->m->effects.n - 1; i < b->m->effects.n; i++) {
    const AstStmt *st = find_stmt(b->ast, STMT_EFFECT, b->m->effects.at[i]);
    for (const AstStmt *x = st ? st->body : NULL; x; x = x->next)
      if (x->kind == STMT_REQUIRES && !uses(b, x->name) && find_stmt(b->ast, STMT_EFFECT, x->name))
        vec_push(b->arena, &b->m->effects, x->name);
  }
}

static void check_effect_needs(Builder *b, const AstStmt *effect) {
  for (const AstStmt *x = effect->body; x; x = x->next) {
    if (x->kind != STMT_REQUIRES && x->kind != STMT_EXCLUDES) continue;
    if (!find_stmt(b->ast, STMT_EFFECT, x->name)) {
      report_unknown(b->ast, STMT_EFFECT, x->name_span, x->name);
    } else if (x->kind == STMT_REQUIRES && !uses(b, x->name)) {
      diag_error(b->diags, x->span, "the effect `%s` requires `%s`, which the scene `%s` does not use", effect->name, x->name,
                 b->m->scene.name);
      diag_help(b->diags, "add `use %s` to the scene", x->name);
    } else if (x->kind == STMT_EXCLUDES && uses(b, x->name)) {
      diag_error(b->diags, x->span, "the effects `%s` and `%s` exclude each other, and the scene `%s` uses both", effect->name,
                 x->name, b->m->scene.name);
    }
  }
}

/* --- which statements are active --- */

static const AstStmt *pick_scene(Builder *b, const char *scene) {
  const AstStmt *st = find_stmt(b->ast, STMT_SCENE, scene);
  if (st || !scene) return st;
  if (strcmp(scene, "default") == 0 && !find_stmt(b->ast, STMT_SCENE, NULL)) return NULL;
  report_unknown(b->ast, STMT_SCENE, (Span){0}, scene);
  return NULL;
}

static void take_model_name(Builder *b) {
  const AstStmt *m = find_stmt(b->ast, STMT_MODEL, NULL);
  if (!m) {
    Span start = b->ast->first ? b->ast->first->span : (Span){0};
    diag_error(b->diags, start, "the file does not name its model");
    diag_help(b->diags, "begin with `model NAME \"what it is\"`");
    b->m->name = intern(b->ast->names, "model");
    return;
  }
  if (m != b->ast->first) {
    diag_error(b->diags, m->span, "the name of the model stands first");
    diag_also(b->diags, b->ast->first->span, "this stands before it");
  }
  b->m->name = m->name;
  b->m->doc = m->doc ? m->doc : "";
  b->m->span = m->name_span;
  for (const AstStmt *s = m->next; s; s = s->next)
    if (s->kind == STMT_MODEL) {
      diag_error(b->diags, s->name_span, "a file declares one model");
      diag_also(b->diags, m->name_span, "the first is here");
    }
}

void scene_select(Builder *b, const ModelChoice *choice) {
  take_model_name(b);
  check_names_once(b);
  const AstStmt *st = choice->bare ? NULL : pick_scene(b, choice->scene);
  b->m->scene.name = st ? st->name : intern(b->ast->names, "default");
  b->m->scene.doc = st && st->doc ? st->doc : "";
  b->chain = scene_chain(b, st);
  for (const AstStmt **s = b->chain; *s; s++) {
    check_said_once(b, *s);
    collect_uses(b, *s);
  }
  if (choice->also) use_with_needs(b, choice->also);
  VEC(Name) in_order = {0};
  for (const AstStmt *s = b->ast->first; s; s = s->next) {
    if (s->kind != STMT_EFFECT) {
      if (s->kind != STMT_SCENE) vec_push(b->arena, &b->active, ((Active){s, NULL}));
      continue;
    }
    vec_push(b->arena, &b->m->all_effects, s->name);
    if (!uses(b, s->name)) continue;
    vec_push(b->arena, &in_order, s->name);
    check_effect_needs(b, s);
    for (const AstStmt *x = s->body; x; x = x->next) vec_push(b->arena, &b->active, ((Active){x, s->name}));
  }
  b->m->effects.at = in_order.at;
  b->m->effects.n = in_order.n;
}

/* --- the scene's contents --- */

static void report_no_member(Builder *b, Span span, Name effect, Name name) {
  diag_error(b->diags, span, "no effect in use declares `%s.%s`", effect, name);
  advise_unknown_member(b, effect, name);
}

/* The parameter or input that `c` or `drag.c` names; in `use drag(c = 1)`, effect is drag, and only its
 * own count. Reported when it is none; NULL then. */
static const Entity *find_settable(Builder *b, AstId id, Name effect) {
  const AstExpr *x = ast_expr(b->ast, id);
  const Entity *e = NULL;
  int member = x->kind == AST_MEMBER && ast_expr(b->ast, x->a)->kind == AST_NAME;
  if (member || (x->kind == AST_NAME && effect)) {
    Name owner = member ? ast_expr(b->ast, x->a)->name : effect;
    e = scope_own(&b->scope, x->name, owner);
    if (!e) report_no_member(b, x->span, owner, x->name);
  } else if (x->kind == AST_NAME) {
    e = resolve_name(b, x->name, x->span, NULL, "param");
  } else if (x->kind != AST_ERROR) {
    diag_error(b->diags, x->span, "a scene sets parameters and inputs: `name = value`");
    if (x->kind == AST_PRIME) diag_help(b->diags, "a start value is given by `start %s = ...`", ast_text(b, id));
  }
  if (e && (e->kind == ENT_PARAM || e->kind == ENT_INPUT)) return e;
  if (e && e->kind != ENT_NONE) {
    diag_error(b->diags, x->span, "`%s` is %s, not a parameter", e->name, ent_kind_text(e->kind));
    if (e->kind == ENT_COORD || e->kind == ENT_STATE) diag_help(b->diags, "its start is set by `start %s = ...`", e->name);
    if (e->kind == ENT_CONST) diag_help(b->diags, "constants are fixed when compiling: `-D %s=...`", e->name);
    if (e->kind == ENT_LET) diag_help(b->diags, "declare it by `param` where scenes give it values");
  }
  return NULL;
}

/* `span = 20` sets a parameter of that name; where there is none, the statement was meant. */
static int advise_statement(Builder *b, const AstStmt *st) {
  static const char *const words[] = {"span", "tolerance", "method", "use", "like"};
  const AstExpr *l = ast_expr(b->ast, st->lhs);
  if (l->kind != AST_NAME || declared_in_use(b, l->name, NULL)) return 0;
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (strcmp(l->name, words[i]) == 0) {
      diag_error(b->diags, st->span, "`%s` takes no `=`", words[i]);
      diag_help(b->diags, "write `%s %s`", words[i], ast_short(b, st->rhs));
      return 1;
    }
  return 0;
}

typedef struct {
  uint32_t index;
} ParamLimit;

static int param_from(const Symbol *s, const void *data) {
  return s->kind == SYM_PARAM && s->index >= ((const ParamLimit *)data)->index;
}

static const Unit *param_unit(Builder *b, uint32_t i, void *data) {
  (void)data;
  return &b->m->params.at[i].unit;
}

static void give_param(Builder *b, uint32_t i, Expr e, Span span, void *data) {
  (void)data;
  Param *p = &b->m->params.at[i];
  ParamLimit limit = {i};
  if (!expr_is_num(b->g, e) && expr_contains(b->g, e, param_from, &limit)) {
    diag_error(b->diags, span, "the value of `%s` may use only parameters declared before it", p->name);
    return;
  }
  p->value = e;
  check_sign(b, p, span);
}

static void set_value(Builder *b, const AstStmt *st, Name effect) {
  static const Giver giver = {IN_START, param_unit, give_param, NULL, NULL};
  if (!effect && advise_statement(b, st)) return;
  Target p = read_target(b, st->lhs);
  const Entity *e = find_settable(b, p.wrong || p.primes ? st->lhs : p.stem, effect);
  if (!e) return;
  if (e->kind == ENT_PARAM) assign_values(b, &p, e, st->lhs, st->rhs, &giver);
  else if (p.indices || p.part >= 0) diag_error(b->diags, ast_expr(b->ast, st->lhs)->span, "`%s` is an input: it has no index and no component", e->name);
  else give_input(b, e->index, e->name, st->rhs, effect);
}

typedef struct {
  EntKind kind;
  int velocity;
  Unit unit;
} StartOf;

static SymId start_target(const Builder *b, const StartOf *of, uint32_t i) {
  if (of->kind == ENT_STATE) return b->m->states.at[i].z;
  return of->velocity ? b->m->coords.at[i].v : b->m->coords.at[i].q;
}

/* That of the name; of a velocity, per second: the same factor. */
static const Unit *start_unit(Builder *b, uint32_t i, void *data) {
  StartOf *of = data;
  of->unit = of->kind == ENT_STATE ? b->m->states.at[i].unit : b->m->coords.at[i].unit;
  if (of->velocity) of->unit = unit_per_second(b, &of->unit);
  return &of->unit;
}

static void give_start(Builder *b, uint32_t i, Expr value, Span span, void *data) {
  (void)span;
  Scene *sc = &b->m->scene;
  SymId target = start_target(b, data, i);
  if (!b->start_of) b->start_of = ARENA_ARRAY(b->arena, uint32_t, expr_symbol_count(b->g) + 1);
  if (b->start_of[target]) {
    sc->starts.at[b->start_of[target] - 1].value = value;
    return;
  }
  vec_push(b->arena, &sc->starts, ((Start){target, value}));
  b->start_of[target] = sc->starts.n;
}

static void give_closed_form(Builder *b, uint32_t i, Expr value, Span span, void *data) {
  const StartOf *of = data;
  int periodic = of->kind == ENT_STATE ? b->m->states.at[i].periodic : !of->velocity && b->m->coords.at[i].periodic;
  give_exact(b, start_target(b, of, i), start_unit(b, i, data), periodic, value, span);
}

/* `start q = ...`, `exact q = ...`: what a coordinate, a velocity or a state is at the start, or always. With `start exactly`
 * constraints may not move it. */
static void set_motion(Builder *b, const AstStmt *st) {
  int exact = st->kind == STMT_EXACT;
  Target p = read_target(b, st->lhs);
  const AstExpr *x = ast_expr(b->ast, st->lhs), *name = ast_expr(b->ast, p.stem);
  Name owner = name->kind == AST_MEMBER && !p.wrong ? ast_expr(b->ast, name->a)->name : NULL; /* e1.y */
  if (p.wrong || p.primes > 1 || (name->kind != AST_NAME && !owner) || (owner && declared_in_use(b, owner, NULL))) {
    if (name->kind == AST_ERROR) return;
    if (exact) diag_error(b->diags, x->span, "a closed form is that of a coordinate, a velocity or a state: `exact x = x(0)*cos(w*t)`");
    else diag_error(b->diags, x->span, "a start gives a coordinate or a velocity: `start th = 90 [deg]`");
    return;
  }
  const Entity *e = owner ? scope_own(&b->scope, name->name, owner) : resolve_name(b, name->name, name->span, NULL, "coord");
  if (!e && owner) report_no_member(b, name->span, owner, name->name);
  if (!e) return;
  if (e->kind == ENT_NONE) return;
  if (e->kind != ENT_COORD && e->kind != ENT_STATE) {
    diag_error(b->diags, name->span, "`%s` is %s; only coordinates, velocities and states %s", name->name, ent_kind_text(e->kind),
               exact ? "have a closed form" : "start somewhere");
    if (e->kind == ENT_PARAM && !exact) diag_help(b->diags, "write `%s = ...` without `start`", name->name);
    return;
  }
  if (p.primes && e->kind == ENT_STATE) {
    int is_coord = b->m->states.at[e->index].coordinate;
    if (is_coord) diag_error(b->diags, x->span, "`%s'` follows from the coordinates: L is linear in the velocities, and the motion of first order", name->name);
    else diag_error(b->diags, x->span, "the rate of a state follows from its flow");
    diag_help(b->diags, exact ? "the %s itself has a closed form: `exact %s = ...`" : "the %s itself starts somewhere: `start %s = ...`",
              is_coord ? "coordinate" : "state", name->name);
    return;
  }
  if (st->exactly && !b->m->scene.exactly.end) b->m->scene.exactly = st->span;
  StartOf of = {.kind = e->kind, .velocity = p.primes > 0};
  Giver giver = {exact ? IN_EXACT : IN_START, start_unit, exact ? give_closed_form : give_start, &of, NULL};
  assign_values(b, &p, e, st->lhs, st->rhs, &giver);
}

static Unit seconds(const Builder *b) {
  return (Unit){.dim = dim_base(b->dims, DIM_TIME), .factor = num_int(1), .offset = num_int(0), .text = "s"};
}

static Unit no_unit(void) { return (Unit){.dim = DIM_NONE, .factor = num_int(1), .offset = num_int(0), .text = "1"}; }

static void set_every(Builder *b, const AstStmt *st) {
  Unit s = seconds(b);
  if (st->rhs) {
    double every = resolve_number(b, st->rhs, &s, "the output interval");
    if (every <= 0) diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "the output interval must be positive");
    b->m->scene.every = every;
  }
}

static void set_output(Builder *b, const AstStmt *st) {
  b->m->scene.outputs.n = 0;
  for (AstId i = st->args; i; i = ast_expr(b->ast, i)->next) add_outputs(b, i);
  set_every(b, st);
}

/* A limit for what has one already takes its place. */
static void add_monitor(Builder *b, Monitor mon) {
  Scene *sc = &b->m->scene;
  for (uint32_t i = 0; i < sc->monitors.n; i++)
    if (sc->monitors.at[i].output == mon.output) {
      sc->monitors.at[i] = mon;
      return;
    }
  vec_push(b->arena, &sc->monitors, mon);
}

/* `monitor exact 1e-6`: all that have a closed form. */
static void monitor_exact(Builder *b, Monitor mon, Span span) {
  Scene *sc = &b->m->scene;
  mon.absolute = 1;
  for (uint32_t i = 0; i < sc->exacts.n; i++) {
    mon.output = add_error(b, &sc->exacts.at[i], span);
    mon.name = sc->outputs.at[mon.output].name;
    add_monitor(b, mon);
  }
  if (sc->exacts.n) return;
  diag_error(b->diags, span, "the scene has no closed form to compare with");
  diag_help(b->diags, "`exact q = ...` gives one");
}

static void set_monitor(Builder *b, const AstStmt *st) {
  if (!st->lhs) {
    diag_error(b->diags, st->name_span, "`monitor %s` has no limit", st->name);
    diag_help(b->diags, "say what the drift may be: `monitor %s 1e-8`; `monitor none` drops what was said before", st->name);
    return;
  }
  const AstExpr *x = ast_expr(b->ast, st->lhs);
  Unit none = no_unit();
  Monitor mon = {.output = -1, .limit = resolve_number(b, st->rhs, &none, "a monitor's limit")};
  mon.name = intern(b->ast->names, ast_text(b, st->lhs));
  mon.absolute = x->kind == AST_CALL && strcmp(x->name, "error") == 0;
  if (mon.limit <= 0) diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "a monitor's limit must be positive");
  if (x->kind == AST_NAME && strcmp(x->name, "exact") == 0 && !declared_in_use(b, x->name, NULL)) {
    monitor_exact(b, mon, x->span);
    return;
  }
  if (x->kind != AST_NAME || strcmp(x->name, "energy") != 0) {
    uint32_t errors = b->diags->errors;
    mon.output = add_outputs(b, st->lhs);
    if (mon.output < 0) {
      if (b->diags->errors == errors) diag_error(b->diags, x->span, "a monitor watches one number");
      return;
    }
  }
  add_monitor(b, mon);
}

static void set_span(Builder *b, const AstStmt *st) {
  Unit s = seconds(b);
  Scene *sc = &b->m->scene;
  sc->t1 = resolve_digits(b, st->rhs, &s, "the span", &sc->t1_digits);
  sc->has_span = 1;
  if (sc->t1 == 0) diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "the span is empty");
}

static void set_tolerance(Builder *b, const AstStmt *st) {
  Unit none = no_unit();
  b->m->scene.tolerance = resolve_number(b, st->rhs, &none, "the tolerance");
  if (b->m->scene.tolerance <= 0) diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "the tolerance must be positive");
}

static int is_monitor_none(const AstStmt *st) { return st->kind == STMT_MONITOR && !st->lhs && strcmp(st->name, "none") == 0; }

static void exact_statement(Builder *b, const AstStmt *st) {
  if (st->kind == STMT_EXACT) set_motion(b, st);
}

static void scene_statement(Builder *b, const AstStmt *st) {
  switch (st->kind) {
    case STMT_START: set_motion(b, st); return;
    case STMT_SET: set_value(b, st, NULL); return;
    case STMT_USE:
      if (uses(b, st->name))
        for (const AstStmt *x = st->body; x; x = x->next) set_value(b, x, st->name);
      return;
    case STMT_SPAN: set_span(b, st); return;
    case STMT_METHOD: scene_method(b, st); return;
    case STMT_TOLERANCE: set_tolerance(b, st); return;
    case STMT_OUTPUT: set_output(b, st); return;
    case STMT_EXACT: case STMT_MONITOR: case STMT_LIKE: return; /* see scene_build, scene_chain */
    default: diag_error(b->diags, st->span, "this does not belong in a scene"); return;
  }
}

/* Without an output statement: coordinates, velocities, states, energy. */
static void default_outputs(Builder *b) {
  Scene *sc = &b->m->scene;
  Model *m = b->m;
  for (int velocities = 0; velocities < 2; velocities++)
    for (uint32_t i = 0; i < m->coords.n; i++) {
      const Coord *c = &m->coords.at[i];
      const Symbol *s = expr_symbol(b->g, velocities ? c->v : c->q);
      Output o = {.name = s->name, .span = c->span, .unit = velocities ? unit_per_second(b, &c->unit) : c->unit, .value = s->node};
      vec_push(b->arena, &sc->outputs, o);
    }
  for (uint32_t i = 0; i < m->states.n; i++) {
    const State *z = &m->states.at[i];
    Output o = {.name = z->name, .span = z->span, .unit = z->unit, .value = expr_symbol(b->g, z->z)->node};
    vec_push(b->arena, &sc->outputs, o);
  }
  if (!m->lagrangian) return;
  Output o = {.name = intern(b->ast->names, "energy"), .value = expr_symbol(b->g, m->energy_sym)->node};
  o.unit = unit_of_dim(b->dims, b->energy);
  vec_push(b->arena, &sc->outputs, o);
}

static int gives_value(const AstStmt *st) { return st->kind == STMT_SET || st->kind == STMT_START || st->kind == STMT_EXACT; }

/* The effect whose own a statement gives a value to, in use or not; NULL: it is the model's. */
static Name effect_given(Builder *b, const AstStmt *st) {
  int ambiguous;
  Target p = read_target(b, st->lhs);
  const AstExpr *x = ast_expr(b->ast, p.stem);
  if (x->kind == AST_MEMBER && ast_expr(b->ast, x->a)->kind == AST_NAME) {
    Name owner = ast_expr(b->ast, x->a)->name;
    return effect_declares(find_stmt(b->ast, STMT_EFFECT, owner), x->name) ? owner : NULL;
  }
  if (x->kind != AST_NAME) return NULL;
  const Entity *e = scope_find(&b->scope, x->name, NULL, &ambiguous);
  if (e) return e->effect;
  const AstStmt *effect = declaring_effect(b, x->name);
  return effect ? effect->name : NULL;
}

/* Statement st of scene *s of the chain. A mistake that it makes only in a scene that is like this one names both. */
static void apply_in_chain(Builder *b, const AstStmt *const *s, const AstStmt *st, void (*apply)(Builder *b, const AstStmt *st)) {
  uint32_t errors = b->diags->errors;
  apply(b, st);
  if (!s[1] || b->diags->errors == errors || b->diags->list.at[b->diags->latest].note) return;
  while (s[1]) s++;
  diag_also(b->diags, (*s)->name_span, "in the scene `%s`, which takes this over by `like`", (*s)->name);
}

/* Whether one of these scenes of the chain has columns of its own: they take the place of those before them. */
static int shows_others(const AstStmt *const *s) {
  for (; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next)
      if (x->kind == STMT_OUTPUT) return 1;
  return 0;
}

/* Whether what a statement says of an effect has no part in the run: it stands before a `use none`, or it is about one that is
 * turned off, and comes from a scene that uses it and that this one is like. */
static int is_dropped(Builder *b, const AstStmt *st, int before_none, int inherited) {
  if (st->kind == STMT_USE) return before_none;
  if (!gives_value(st)) return 0;
  Name effect = effect_given(b, st);
  return effect && (before_none || (inherited && !uses(b, effect)));
}

/* The last such statement of the scene and those that it is like; NULL: there is none. */
static const AstStmt *last_of(const Builder *b, int (*is)(const AstStmt *st)) {
  const AstStmt *last = NULL;
  for (const AstStmt **s = b->chain; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next)
      if (is(x)) last = x;
  return last;
}

/* Calls `apply` for the statements that have a part in the run. */
static void each_said(Builder *b, void (*apply)(Builder *b, const AstStmt *st)) {
  const AstStmt *none = last_of(b, is_use_none);
  int before = none != NULL;
  for (const AstStmt **s = b->chain; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next) {
      before &= x != none;
      if (is_dropped(b, x, before, s[1] != NULL)) continue;
      int hidden = apply == scene_statement && x->kind == STMT_OUTPUT && shows_others(s + 1);
      apply_in_chain(b, s, x, hidden ? set_every : apply);
    }
}

/* Monitors of outputs add to these; `monitor none` drops those that were said before it. */
static void set_monitors(Builder *b) {
  const AstStmt *none = last_of(b, is_monitor_none);
  int before = none != NULL;
  for (const AstStmt **s = b->chain; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next) {
      before &= x != none;
      if (x->kind == STMT_MONITOR && x != none && !before) apply_in_chain(b, s, x, set_monitor);
    }
}

void scene_build(Builder *b, const ModelChoice *choice) {
  Scene *sc = &b->m->scene;
  sc->t1 = 10;
  each_said(b, exact_statement); /* outputs speak of closed forms, */
  each_said(b, scene_statement);
  for (const AstStmt **s = b->chain; *s; s++)
    if ((*s)->doc) sc->doc = (*s)->doc;
  for (uint32_t i = 0; i < choice->ngiven; i++)
    set_value(b, &(AstStmt){.kind = STMT_SET, .lhs = choice->given[i].what, .rhs = choice->given[i].value}, NULL);
  if (!sc->outputs.n) default_outputs(b);
  set_monitors(b);
  for (uint32_t i = 0; i < choice->nasked; i++) add_outputs_as(b, choice->asked[i].expr, choice->asked[i].name);
}
