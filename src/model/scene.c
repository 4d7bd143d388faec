/* Scenes: selection of the active statements, inheritance by `like`, and the settings of a run: values, start, span,
 * tolerance, outputs, monitors. Later statements override earlier ones, except monitors, which accumulate. */

#include "base/words.h"
#include "model/builder.h"
#include "model/effect.h"

/* --- the file's scenes and effects --- */

int model_has_scene(Ast *ast, const char *scene) {
  SceneList scenes = model_scenes(ast);
  for (uint32_t i = 0; i < scenes.n; i++)
    if (strcmp(scenes.at[i], scene) == 0) return 1;
  report_unnamed(ast, STMT_SCENE, (Span){0}, scene);
  return 0;
}

/* The scene and its `like` ancestors, the farthest ancestor first; NULL-terminated. A cycle is reported. */
static const AstStmt **scene_chain(Builder *b, const AstStmt *scene) {
  VEC(const AstStmt *) chain = {0};
  for (const AstStmt *s = scene; s;) {
    for (uint32_t i = 0; i < chain.n; i++)
      if (chain.at[i] == s) {
        diag_error(b->diags, s->name_span,
                   "the scene `%s` inherits from itself" HELP "`like` must not lead back to the scene", s->name);
        s = NULL;
        break;
      }
    if (!s) break;
    vec_push(b->arena, &chain, s);
    const AstStmt *next = NULL;
    for (const AstStmt *x = s->body; x; x = x->next)
      if (x->kind == STMT_LIKE) {
        next = find_named(b->ast, STMT_SCENE, x->name);
        if (!next) report_unnamed(b->ast, STMT_SCENE, x->name_span, x->name);
      }
    s = next;
  }
  const AstStmt **out = ARENA_ARRAY(b->arena, const AstStmt *, chain.n + 1);
  for (uint32_t i = 0; i < chain.n; i++) out[i] = chain.at[chain.n - 1 - i];
  return out;
}

/* --- which statements are active --- */

static const AstStmt *pick_scene(Builder *b, const char *scene) {
  const AstStmt *st = find_named(b->ast, STMT_SCENE, scene);
  if (st || !scene) return st;
  if (strcmp(scene, "default") == 0 && !find_named(b->ast, STMT_SCENE, NULL)) return NULL;
  report_unnamed(b->ast, STMT_SCENE, (Span){0}, scene);
  return NULL;
}

static void read_model_name(Builder *b, const FileIndex *file) {
  const AstStmt *m = file->model;
  if (!m) {
    Span start = b->ast->first ? b->ast->first->span : (Span){0};
    diag_error(b->diags, start, "the file does not name its model" HELP "begin with `model NAME \"what it is\"`");
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
  for (uint32_t i = 0; i < file->common.n; i++)
    if (file->common.at[i]->kind == STMT_MODEL && file->common.at[i] != m) {
      diag_error(b->diags, file->common.at[i]->name_span, "a file declares one model");
      diag_also(b->diags, m->name_span, "the first is here");
    }
}

/* Checks names and effects of the whole file; skipped once they were found right. */
static void check_file(Builder *b, FileIndex *file) {
  uint32_t before = b->diags->errors;
  if (file->is_sound) return;
  check_names_once(b, file);
  file->clashes = !effects_check(b->ast);
  file->is_sound = b->diags->errors == before && !file->clashes;
}

void scene_select(Builder *b, const ModelChoice *choice) {
  FileIndex *file = file_index(b->ast);
  read_model_name(b, file);
  check_file(b, file);
  const AstStmt *st = choice->bare ? NULL : pick_scene(b, choice->scene);
  b->m->scene.name = st ? st->name : intern(b->ast->names, "default");
  if (st) b->m->scene.span = st->name_span;
  b->m->scene.doc = st && st->doc ? st->doc : "";
  b->chain = scene_chain(b, st);
  for (const AstStmt **s = b->chain; *s; s++) {
    check_set_once(b, *s);
    collect_uses(b, *s);
  }
  if (choice->also) use_with_required(b, choice->also);
  b->is_variant = choice->only != NULL;
  if (b->is_variant) b->m->effects.n = 0;
  for (uint32_t i = 0; b->is_variant && i < choice->only->n; i++)
    vec_push(b->arena, &b->m->effects, choice->only->at[i]);
  VEC(Name) in_order = {0};
  for (uint32_t i = 0; i < file->common.n; i++) {
    const AstStmt *s = file->common.at[i];
    if (s->kind != STMT_EFFECT) {
      vec_push(b->arena, &b->active, ((Active){s, NULL}));
      continue;
    }
    vec_push(b->arena, &b->m->all_effects, s->name);
    if (!uses_effect(b, s->name)) continue;
    vec_push(b->arena, &in_order, s->name);
    if (!file->clashes) check_effect_needs(b, s);
    for (const AstStmt *x = s->body; x; x = x->next) vec_push(b->arena, &b->active, ((Active){x, s->name}));
  }
  b->m->effects.at = in_order.at;
  b->m->effects.n = in_order.n;
  if (choice->coordinates) change_coordinates(b, choice->coordinates);
}

/* --- the scene's contents --- */

/* Parameter or input called `c` or `drag.c`; in `use drag(c = 1)`, effect is drag, and only its own are searched.
 * NULL, reported, if there is none. */
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
    if (e->kind == ENT_COORD || e->kind == ENT_STATE)
      diag_help(b->diags, "its start is set by `start %s = ...`", e->name);
    if (e->kind == ENT_CONST) diag_help(b->diags, "constants are fixed when compiling: `-D %s=...`", e->name);
    if (e->kind == ENT_LET) diag_help(b->diags, "declare it by `param` where scenes give it values");
  }
  return NULL;
}

/* Reports `span = 20` where no parameter is called span: the statement `span 20` was meant. */
static int advise_statement(Builder *b, const AstStmt *st) {
  const AstExpr *l = ast_expr(b->ast, st->lhs);
  if (l->kind != AST_NAME || declared_in_use(b, l->name, NULL)) return 0;
  if (!has_word("span tolerance method use like", l->name)) return 0;
  diag_error(b->diags, st->span, "`%s` takes no `=`" HELP "write `%s %s`", l->name, l->name, ast_short(b, st->rhs));
  return 1;
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
  p->given = b->is_giving;
  check_sign(b, p, span);
}

static void set_value(Builder *b, const AstStmt *st, Name effect) {
  static const Assigner assigner = {IN_START, param_unit, give_param, NULL, NULL, NULL};
  if (!effect && advise_statement(b, st)) return;
  Target p = read_target(b, st->lhs);
  const Entity *e = find_settable(b, p.wrong || p.primes ? st->lhs : p.stem, effect);
  if (!e) return;
  if (e->kind == ENT_PARAM) assign_values(b, &p, e, st->lhs, st->rhs, &assigner);
  else if (p.indices || p.part >= 0)
    diag_error(b->diags, ast_expr(b->ast, st->lhs)->span, "`%s` is an input: it has no index and no component",
               e->name);
  else give_input(b, e->index, e->name, st->rhs, effect);
}

static Unit seconds(const Builder *b) { return unit_si(dim_base(b->dims, DIM_TIME), "s"); }

static Unit no_unit(void) { return unit_si(DIM_NONE, "1"); }

static void set_every(Builder *b, const AstStmt *st) {
  Unit s = seconds(b);
  if (st->rhs) {
    double every = resolve_number(b, st->rhs, &s, "the output interval", NULL);
    if (every <= 0) diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "the output interval must be positive");
    b->m->scene.every = every;
  }
}

static void set_output(Builder *b, const AstStmt *st) {
  drop_outputs(b);
  for (AstId i = st->args; i; i = ast_expr(b->ast, i)->next) add_outputs(b, i);
  set_every(b, st);
}

static void set_span(Builder *b, const AstStmt *st) {
  Unit s = seconds(b);
  Scene *sc = &b->m->scene;
  sc->t1 = resolve_number(b, st->rhs, &s, "the span", &sc->t1_digits);
  sc->has_span = 1;
  if (sc->t1 == 0) diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "the span is empty");
}

static void set_tolerance(Builder *b, const AstStmt *st) {
  Unit none = no_unit();
  uint32_t before = b->diags->errors;
  b->m->scene.tolerance = resolve_number(b, st->rhs, &none, "the tolerance", NULL);
  if (b->diags->errors > before || (b->m->scene.tolerance > 0 && b->m->scene.tolerance < 1)) return;
  diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "the tolerance must be positive and below 1");
  diag_help(b->diags, "it is the relative error of a step: `tolerance 1e-9`");
}

static int is_monitor_none(const AstStmt *st) {
  return st->kind == STMT_MONITOR && !st->lhs && strcmp(st->name, "none") == 0;
}

static void exact_statement(Builder *b, const AstStmt *st) {
  if (st->kind == STMT_EXACT) set_motion(b, st);
}

static void scene_statement(Builder *b, const AstStmt *st) {
  switch (st->kind) {
    case STMT_START: set_motion(b, st); return;
    case STMT_SET: set_value(b, st, NULL); return;
    case STMT_USE:
      if (uses_effect(b, st->name))
        for (const AstStmt *x = st->body; x; x = x->next)
          if (!b->is_variant || !names_off_effect(b, x->rhs)) set_value(b, x, st->name);
      return;
    case STMT_SPAN: set_span(b, st); return;
    case STMT_METHOD: scene_method(b, st); return;
    case STMT_TOLERANCE: set_tolerance(b, st); return;
    case STMT_OUTPUT: set_output(b, st); return;
    case STMT_EXACT: case STMT_MONITOR: case STMT_MEASURE: case STMT_DRAW: case STMT_LIKE:
      return; /* see scene_build, scene_chain */
    default: diag_error(b->diags, st->span, "this does not belong in a scene"); return;
  }
}

/* Outputs of a scene without an output statement: coordinates, velocities, states, energy. */
static void default_outputs(Builder *b) {
  Model *m = b->m;
  m->scene.outputs.cap = 2 * m->coords.n + m->states.n + 1;
  m->scene.outputs.at = ARENA_ARRAY(b->arena, Output, m->scene.outputs.cap);
  for (int velocities = 0; velocities < 2; velocities++)
    vec_each(const Coord, c, m->coords) {
      const Symbol *s = expr_symbol(b->g, velocities ? c->v : c->q);
      Output o = {.name = s->name,
                  .span = c->span,
                  .unit = velocities ? unit_per_second(b, &c->unit) : c->unit,
                  .value = s->node};
      push_output(b, &o);
    }
  vec_each(const State, z, m->states) {
    Output o = {.name = z->name, .span = z->span, .unit = z->unit, .value = expr_symbol(b->g, z->z)->node};
    push_output(b, &o);
  }
  if (!m->lagrangian) return;
  Output o = {.name = intern(b->ast->names, "energy"), .value = expr_symbol(b->g, m->energy_sym)->node};
  o.unit = unit_of_dim(b->dims, b->energy);
  push_output(b, &o);
}

static int gives_value(const AstStmt *st) {
  return st->kind == STMT_SET || st->kind == STMT_START || st->kind == STMT_EXACT;
}

/* The effect, in use or not, that declares the target of an assignment; NULL: the model itself. */
static Name effect_given(Builder *b, const AstStmt *st) {
  Target p = read_target(b, st->lhs);
  const AstExpr *x = ast_expr(b->ast, p.stem);
  if (x->kind == AST_MEMBER && ast_expr(b->ast, x->a)->kind == AST_NAME) {
    Name owner = ast_expr(b->ast, x->a)->name;
    return effect_declares(find_named(b->ast, STMT_EFFECT, owner), x->name) ? owner : NULL;
  }
  if (x->kind != AST_NAME) return NULL;
  const Entity *e = entity_named(b, x->name);
  if (e) return e->effect;
  const AstStmt *effect = declaring_effect(b, x->name);
  return effect ? effect->name : NULL;
}

/* Applies statement st of scene *s of the chain. An error in an inherited statement also names the scene that
 * inherits it. */
static void apply_in_chain(Builder *b, const AstStmt *const *s, const AstStmt *st,
                           void (*apply)(Builder *b, const AstStmt *st)) {
  uint32_t errors = b->diags->errors;
  apply(b, st);
  if (!s[1] || b->diags->errors == errors || b->diags->list.at[b->diags->latest].note) return;
  while (s[1]) s++;
  diag_also(b->diags, (*s)->name_span, "in the scene `%s`, which inherits this by `like`", (*s)->name);
}

/* 1 if one of the scenes from *s on has an output statement: its columns replace inherited ones. */
static int has_own_outputs(const AstStmt *const *s) {
  for (; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next)
      if (x->kind == STMT_OUTPUT) return 1;
  return 0;
}

static int is_shown(const AstStmt *st) { return st->kind == STMT_OUTPUT || st->kind == STMT_EXACT; }

/* 1 if a statement has no effect on the run: it precedes a `use none`, or it is inherited and sets a value of an
 * effect that is off. A variant (ModelChoice.only) also drops outputs, closed forms and values with names of effects
 * that are off. */
static int is_dropped(Builder *b, const AstStmt *st, int before_none, int inherited) {
  if (st->kind == STMT_USE) return before_none;
  if (b->is_variant && is_shown(st)) return 1;
  if (!gives_value(st)) return 0;
  if (b->is_variant && names_off_effect(b, st->rhs)) return 1;
  Name effect = effect_given(b, st);
  return effect && (before_none || ((inherited || b->is_variant) && !uses_effect(b, effect)));
}

/* Last statement of the chain for which is() holds, or NULL. */
static const AstStmt *last_of(const Builder *b, int (*is)(const AstStmt *st)) {
  const AstStmt *last = NULL;
  for (const AstStmt **s = b->chain; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next)
      if (is(x)) last = x;
  return last;
}

/* Calls `apply` for all statements of the chain that are not dropped. */
static void each_effective(Builder *b, void (*apply)(Builder *b, const AstStmt *st)) {
  const AstStmt *none = last_of(b, is_use_none);
  int before = none != NULL;
  b->in_scene = 1;
  for (const AstStmt **s = b->chain; *s; s++, b->settings.n = b->given.n = 0)
    for (const AstStmt *x = (*s)->body; x; x = x->next) {
      before &= x != none;
      if (is_dropped(b, x, before, s[1] != NULL)) continue;
      int hidden = apply == scene_statement && x->kind == STMT_OUTPUT && has_own_outputs(s + 1);
      apply_in_chain(b, s, x, hidden ? set_every : apply);
    }
  b->in_scene = 0;
}

/* Monitors and measures accumulate along the chain, and may add outputs; `monitor none` drops earlier monitors. */
static void accumulate(Builder *b, AstStmtKind kind, void (*apply)(Builder *b, const AstStmt *st)) {
  const AstStmt *none = kind == STMT_MONITOR ? last_of(b, is_monitor_none) : NULL;
  int before = none != NULL;
  for (const AstStmt **s = b->chain; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next) {
      before &= x != none;
      if (x->kind == kind && x != none && !before) apply_in_chain(b, s, x, apply);
    }
}

/* Applies a value from the command line: a start, a parameter or an input. */
static void give(Builder *b, const CommandInput *x) {
  AstStmt st = {.lhs = x->what, .rhs = x->value, .span = ast_expr(b->ast, x->value)->span};
  const AstExpr *name = ast_expr(b->ast, read_target(b, x->what).stem);
  const Entity *e = name->kind == AST_NAME ? entity_named(b, name->name) : NULL;
  int starts = ast_expr(b->ast, x->what)->kind == AST_CALL || (e && (e->kind == ENT_COORD || e->kind == ENT_STATE));
  st.kind = starts ? STMT_START : STMT_SET;
  if (starts) set_motion(b, &st);
  else set_value(b, &st, NULL);
}

void scene_build(Builder *b, const ModelChoice *choice) {
  Scene *sc = &b->m->scene;
  sc->t1 = 10;
  each_effective(b, exact_statement); /* first, as outputs refer to closed forms */
  each_effective(b, scene_statement);
  for (const AstStmt **s = b->chain; *s; s++)
    if ((*s)->doc) sc->doc = (*s)->doc;
  b->is_giving = 1;
  for (uint32_t i = 0; i < choice->ngiven; i++) give(b, &choice->given[i]);
  b->is_giving = 0;
  complete_rotation_starts(b);
  if (!sc->outputs.n) default_outputs(b);
  if (!b->is_variant) accumulate(b, STMT_MONITOR, set_monitor), accumulate(b, STMT_MEASURE, set_measure);
  for (uint32_t i = 0, before = b->diags->errors; i < choice->nextra_outputs; i++) { /* before: the last output */
    const CommandOutput *o = &choice->asked[i];
    uint32_t errors = b->diags->errors;
    int rate = i && ast_expr(b->ast, o->expr)->kind == AST_PRIME && strstr(o->name, o[-1].name);
    /* --phase x: what is wrong in x is wrong in x', and said once */
    if (!rate || errors == before) add_outputs_as(b, o->expr, o->name);
    before = errors;
  }
  for (uint32_t i = 0; i < choice->nmeasures; i++) ask_measure(b, &choice->measures[i]);
  if (choice->drawing) build_drawing(b, choice->drawing == DRAWING_WANTED);
}
