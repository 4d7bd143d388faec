/* Events: a switching function, a direction of crossing, and actions (new values); kicks, whose function is their
 * period; and sections, which have no actions. */
#include "model/resolve_impl.h"

Value resolve_for(Builder *b, AstId id, Name effect, SymId target, const Unit *unit) {
  SymKind kind = expr_symbol(b->g, target)->kind;
  Unit u = kind == SYM_VEL || kind == SYM_RATE ? unit_per_second(b, unit) : *unit;
  return values_in(b, resolve(b, id, IN_DYNAMICS, effect), ast_expr(b->ast, id)->span, &u);
}

void report_shapes(Builder *b, Span span, uint32_t left, uint32_t right) {
  diag_error(b->diags, span, "shapes do not match: the left side is %s, the right side is %s", shape_text(b, left),
             shape_text(b, right));
}

void report_units(Builder *b, Span span, Dim left, Dim right) {
  diag_error(b->diags, span, "units do not match: the left side is %s, the right side %s", in_dim(b, left),
             in_dim(b, right));
}

static void push_action(Builder *b, Event *ev, SymId target, Expr value) {
  vec_push(b->arena, &ev->actions, ((Action){target, value}));
}

/* Value of `target` after the event: that of its action, or the symbol itself. */
static Expr set_value(const Builder *b, const Event *ev, SymId target) {
  for (uint32_t i = 0; i < ev->actions.n; i++)
    if (ev->actions.at[i].target == target) return ev->actions.at[i].value;
  return expr_symbol(b->g, target)->node;
}

/* Adds actions for quaternion rates such that the rotation, as the event leaves it, has angular velocity w. */
static void push_spin(Builder *b, Event *ev, uint32_t coord, const Expr *w) {
  Value q = rotation_at(b, coord, 0);
  for (uint32_t k = 0; k < ROTATION; k++) q.at[k] = set_value(b, ev, b->m->coords.at[coord + k].q);
  Value rates = rotation_rates(b, &q, w);
  for (uint32_t k = 0; k < ROTATION; k++) push_action(b, ev, b->m->coords.at[coord + k].v, rates.at[k]);
}

/* 1 if a statement of the event sets omega(R). */
static int sets_spin(Builder *b, const AstStmt *event, uint32_t coord, Name effect) {
  for (const AstStmt *s = event->body; s; s = s->next)
    if (s->kind == STMT_SET && ast_expr(b->ast, s->lhs)->kind == AST_CALL &&
        spin_target(b, s->lhs, effect) == (int)coord)
      return 1;
  return 0;
}

/* An event that sets a rotation but not its omega keeps the angular velocity in the body frame. */
static void keep_spin(Builder *b, Event *ev, uint32_t coord) {
  Value q = rotation_at(b, coord, 0), rates = rotation_at(b, coord, 1);
  Expr w[3];
  rotation_spin(b, &q, &rates, w);
  push_spin(b, ev, coord, w);
}

/* Adds the action `omega(R) = ...`. */
static void add_spin_action(Builder *b, const AstStmt *st, Name effect, Event *ev) {
  int coord = spin_target(b, st->lhs, effect);
  Unit unit = spin_unit(b);
  Value v = coord < 0 ? FAILED
                      : values_in(b, resolve(b, st->rhs, IN_DYNAMICS, effect), ast_expr(b->ast, st->rhs)->span, &unit);
  if (!v.e) return;
  if (v.n == 3) push_spin(b, ev, (uint32_t)coord, v.at);
  else report_shapes(b, st->span, 3, v.n);
}

static void add_action(Builder *b, const AstStmt *st, Name effect, Event *ev) {
  Value target = resolve(b, st->lhs, IN_DYNAMICS, effect);
  if (!target.e) return;
  for (uint32_t k = 0; k < (target.n ? target.n : 1); k++) {
    SymKind kind = expr_op(b->g, target.at[k]) == EX_SYM ? expr_sym_of(b->g, target.at[k])->kind : SYM_LOCAL;
    if (kind == SYM_COORD || kind == SYM_VEL || kind == SYM_STATE) continue;
    diag_error(b->diags, ast_expr(b->ast, st->lhs)->span, "an event can set a coordinate, a velocity or a state");
    if (kind == SYM_RATE && b->m->first_order)
      diag_help(b->diags, "%s: `%s` follows from the coordinates", no_inertia(b->m), ast_text(b, st->lhs));
    else
      diag_help(b->diags, "declare a value that an event changes as a `state`: `state k`, with `flow k' = 0` where "
                          "nothing else changes it");
    return;
  }
  SymId sym = expr_sym_id(b->g, target.e);
  uint32_t i = expr_sym_of(b->g, target.e)->index;
  const Unit *unit =
      expr_sym_of(b->g, target.e)->kind == SYM_STATE ? &b->m->states.at[i].unit : &b->m->coords.at[i].unit;
  Value v = resolve_for(b, st->rhs, effect, sym, unit);
  if (!v.e) return;
  if (target.n != v.n) {
    report_shapes(b, st->span, target.n, v.n);
    return;
  }
  for (uint32_t k = 0; k < component_count(&v); k++) push_action(b, ev, expr_sym_id(b->g, target.at[k]), v.at[k]);
}

/* Angular velocities are set last, as their rates depend on the rotations after the event. */
static void add_actions(Builder *b, const AstStmt *event, Name effect, Event *ev) {
  for (const AstStmt *s = event->body; s; s = s->next)
    if (s->kind == STMT_STOP) ev->stop = 1;
    else if (ast_expr(b->ast, s->lhs)->kind != AST_CALL) add_action(b, s, effect, ev);
  uint32_t n = ev->actions.n;
  for (uint32_t i = 0; i < b->rotations.n; i++)
    for (uint32_t k = 0; k < n; k++)
      if (ev->actions.at[k].target == b->m->coords.at[b->rotations.at[i]].q &&
          !sets_spin(b, event, b->rotations.at[i], effect))
        keep_spin(b, ev, b->rotations.at[i]);
  for (const AstStmt *s = event->body; s; s = s->next)
    if (s->kind != STMT_STOP && ast_expr(b->ast, s->lhs)->kind == AST_CALL) add_spin_action(b, s, effect, ev);
}

/* The period of a kick: a time of parameters alone; 0 after a mistake. */
static Expr period_of(Builder *b, const AstStmt *st, Name effect) {
  Span span = ast_expr(b->ast, st->lhs)->span;
  Unit s = unit_si(dim_base(b->dims, DIM_TIME), "s");
  Value T = values_in(b, resolve(b, st->lhs, IN_DYNAMICS, effect), span, &s);
  unsigned fixed = 1u << SYM_PARAM | 1u << SYM_CONST;
  if (!need_number(b, span, T.n) || !T.e) return 0;
  if (!(expr_kinds(b->g, T.e) & ~fixed)) return T.e;
  diag_error(b->diags, span, "the period of a kick is a time of parameters and numbers alone");
  diag_help(b->diags, "what happens at times that depend on the motion is an event: `event NAME: g rising { ... }`");
  return 0;
}

void add_event(Builder *b, const AstStmt *st, Name effect) {
  Event ev = {.name = st->name, .span = st->span, .direction = st->direction};
  IndexRange r = {0};
  if (st->dims && !resolve_indices(b, st->dims, effect, &r)) return;
  ev.name = member_name(b->ast, st->name, r.lo, r.n);
  check_name_is_new(b, "event", ev.name, effect, st->name_span);
  check_set_once(b, st);
  int kick = st->direction == AT_EQUAL_TIMES;
  Value g = kick ? (Value){.e = period_of(b, st, effect)} : resolve(b, st->lhs, IN_DYNAMICS, effect);
  need_number(b, ast_expr(b->ast, st->lhs)->span, g.n);
  ev.g = g.e;
  add_actions(b, st, effect, &ev);
  if (g.e) vec_push(b->arena, &b->m->events, ev);
}

/* Whether e is an angle on a circle: a periodic coordinate, alone or with other terms. */
static int turns(Builder *b, Expr e) {
  e = expr_expand_defs(b->g, e);
  for (ExprPair term = {0}; expr_next_pair(b->g, e, EX_SUM, &term);) {
    const Symbol *s = expr_op(b->g, term.of) == EX_SYM ? expr_sym_of(b->g, term.of) : NULL;
    if (!s || !num_is_one(num_abs(term.num))) continue;
    if ((s->kind == SYM_COORD && b->m->coords.at[s->index].periodic) ||
        (s->kind == SYM_STATE && b->m->states.at[s->index].periodic))
      return 1;
  }
  return 0;
}

/* A section must be a function of state and time: no accelerations, rates of states, energy. */
void add_section(Builder *b, const Section *s) {
  if (!s->expr) return;
  Span span = ast_expr(b->ast, s->expr)->span;
  Value g = resolve(b, s->expr, IN_OBSERVE, NULL);
  if (!g.e) return;
  if (!need_number(b, span, g.n)) {
    diag_help(b->diags, "a section is where one number is zero: name a component");
    return;
  }
  unsigned later = 1u << SYM_ACC | 1u << SYM_LOCAL | (b->m->first_order ? 0 : 1u << SYM_RATE);
  if (expr_kinds(b->g, g.e) & later) {
    diag_error(
        b->diags, span,
        "a section is a surface in the space of states: it cannot contain accelerations, rates of states or `energy`");
    diag_help(b->diags, "write it with coordinates, velocities, states, t and lets");
    return;
  }
  /* zero once a turn; a pole half a turn away is no crossing */
  if (turns(b, g.e)) g.e = expr_fn(b->g, EX_TAN, expr_scale(b->g, num_ratio(1, 2), g.e));
  vec_push(b->arena, &b->m->events, ((Event){.name = s->name, .span = span, .g = g.e, .direction = s->direction}));
}

