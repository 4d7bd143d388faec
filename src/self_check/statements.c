/* Reads the active statements of a model onto tapes, in the order in which model/ numbers constraints and events.
 * Contract: statements.h. */
#include "self_check/statements.h"

/* Traversal of the active statements, with the indices of enclosing `for` loops. */
typedef struct {
  DirectEval *text;
  IndexVars around;
  TextDynamics *dynamics;
  TextOutputs *outputs;
  uint32_t constraint, event, guide; /* index in the model of the next one; contacts with a guide's tangent */
  const char *why;
} Walk;

typedef void Visit(Walk *w, const AstStmt *st, Name effect);

static void visit(Walk *w, const AstStmt *st, Name effect, Visit *fn) {
  int64_t from, to;
  if (st->kind != STMT_FOR) {
    fn(w, st, effect);
    return;
  }
  if (!text_range(w->text, st->lhs, st->rhs, effect, &w->around, &from, &to)) {
    w->why = "a range";
    return;
  }
  for (int64_t i = from; i <= to; i++) {
    vec_push(w->text->arena, &w->around, ((IndexVar){st->name, i}));
    for (const AstStmt *s = st->body; s; s = s->next) visit(w, s, effect, fn); /* recursion bounded by the parser */
    w->around.n--;
  }
}

static void walk(Walk *w, Visit *fn) {
  const Declarations *b = w->text->b;
  for (uint32_t i = 0; i < b->active.n; i++) visit(w, b->active.at[i].stmt, b->active.at[i].effect, fn);
}

/* Value of an expression; without one, w->why has the reason. */
static TextValue value(Walk *w, AstId id, Name effect) {
  w->text->why = NULL;
  TextValue v = text_value(w->text, id, effect, &w->around);
  if (!v.at[0] && !w->why) w->why = w->text->why ? w->text->why : "a name";
  return v;
}

/* --- dynamics --- */

static Ref added(Walk *w, Ref sum, TapeOp op, Ref term) {
  Tape *t = w->text->tape;
  if (!term) return sum;
  if (!sum) sum = tape_number(t, num_int(0));
  return tape_op(t, op, sum, term, 0);
}

static void push_force(Walk *w, Ref point, Ref f) {
  vec_push(w->text->arena, &w->dynamics->forces, ((TextForce){.point = {point}, .f = {f}}));
}

static void read_force(Walk *w, const AstStmt *st, Name effect) {
  const Ast *ast = w->text->b->ast;
  const AstExpr *l = ast_expr(ast, st->lhs), *r = ast_expr(ast, st->rhs);
  if (l->kind == AST_TUPLE && r->kind == AST_TUPLE) {
    for (AstId i = l->args, k = r->args; i && k; i = ast_expr(ast, i)->next, k = ast_expr(ast, k)->next)
      push_force(w, value(w, i, effect).at[0], value(w, k, effect).at[0]);
    return;
  }
  TextValue point = value(w, st->lhs, effect), f = value(w, st->rhs, effect);
  if (point.n == ROTATION) {
    TextForce one = {.torque = 1};
    memcpy(one.point, point.at, sizeof one.point);
    memcpy(one.f, f.at, sizeof one.f);
    vec_push(w->text->arena, &w->dynamics->forces, one);
    return;
  }
  for (uint32_t k = 0; k < text_components(&point); k++) push_force(w, point.at[k], f.at[k]);
}

static const Unit PER_SECOND_OF_SI = {.factor = {.num = 1, .den = 1}, .offset = {.num = 0, .den = 1}, .text = ""};

/* Unit of a rate: that of u without offset; times are in s. */
static Unit rate_unit(const Unit *u) {
  Unit r = u ? *u : PER_SECOND_OF_SI;
  r.offset = num_int(0);
  return r;
}

/* Input instruction of a target (a coordinate or state), or NULL. */
static const TapeIns *target_input(const Walk *w, Ref r) {
  const TapeIns *i = &w->text->tape->ins.at[r];
  return i->op == TAPE_INPUT ? i : NULL;
}

static void read_flow(Walk *w, const AstStmt *st, Name effect) {
  const AstExpr *l = ast_expr(w->text->b->ast, st->lhs);
  if (l->kind != AST_PRIME) return;
  TextValue of = value(w, l->a, effect), v = value(w, st->rhs, effect);
  for (uint32_t k = 0; of.at[0] && v.at[0] && k < text_components(&of); k++) {
    const TapeIns *z = target_input(w, of.at[k]);
    if (!z || z->input != INPUT_STATE) return;
    uint32_t index = z->index;
    Unit unit = rate_unit(&w->text->m->states.at[index].unit);
    w->dynamics->flows[index] = text_component(w->text, &v, k, &unit);
  }
}

/* Stores c as the model's next written constraint, skipping the unit-length constraints that the compiler adds for
 * rotations. */
static void push_constraint(Walk *w, Ref c) {
  const Model *m = w->text->m;
  while (w->constraint < m->constraints.n && m->constraints.at[w->constraint].inside) w->constraint++;
  if (w->constraint < m->constraints.n) w->dynamics->constraints[w->constraint++] = c;
}

static Ref contact_signal(const Walk *w, SymId s) {
  return tape_input(w->text->tape, INPUT_SIGNAL, expr_symbol(w->text->m->g, s)->index);
}

/* The tangent of a contact as a constraint, `sticks` times the slip, and the power of its force. */
static void read_tangent(Walk *w, const Contact *tangent, Ref slip) {
  Tape *t = w->text->tape;
  push_constraint(w, tape_op(t, TAPE_MUL, contact_signal(w, tangent->closed), slip, 0));
  w->dynamics->dissipation =
      added(w, w->dynamics->dissipation, TAPE_SUB, tape_op(t, TAPE_MUL, contact_signal(w, tangent->force), slip, 0));
}

/* Stores a contact, or a constraint with `while`: its input `closed` times c. Returns it; NULL: there is none here. */
static const Contact *push_switched(Walk *w, Ref c) {
  const Model *m = w->text->m;
  for (uint32_t i = 0; i < m->contacts.n; i++) {
    uint32_t place_of = m->contacts.at[i].constraint;
    while (w->constraint < m->constraints.n && m->constraints.at[w->constraint].inside) w->constraint++;
    if (place_of != w->constraint) continue;
    push_constraint(w, tape_op(w->text->tape, TAPE_MUL, contact_signal(w, m->contacts.at[i].closed), c, 0));
    return &m->contacts.at[i];
  }
  return NULL;
}

static TextValue slip_value(Walk *w, const AstStmt *st, Name effect) {
  return value(w, ast_option_value(w->text->b->ast, st, "slip"), effect);
}

/* The family of contacts that the statement gives; NULL: it gives another contact. */
static const ContactFamily *family_of(const Walk *w, const AstStmt *st) {
  const Model *m = w->text->m;
  for (uint32_t k = 0; k < m->families.n; k++)
    if (m->families.at[k].stmt == st) return &m->families.at[k];
  return NULL;
}

static void read_contact(Walk *w, const AstStmt *st, Name effect) {
  if (family_of(w, st)) return; /* its forces are impulses of a step */
  const Contact *c = push_switched(w, value(w, st->lhs, effect).at[0]);
  TextValue slip = c && st->args ? slip_value(w, st, effect) : (TextValue){0};
  for (uint32_t k = 0; c && st->args && k < text_components(&slip); k++) read_tangent(w, c + 1 + k, slip.at[k]);
}

/* Adds p*q' of a momentum, or -H, to L of a model that gives its Hamiltonian. */
static Ref with_phase_space_action(Walk *w, Ref L, const AstStmt *st, Name effect) {
  if (!w->text->m->hamiltonian) return L;
  int is_momentum = st->kind == STMT_MOMENTUM;
  return added(w, L, is_momentum ? TAPE_ADD : TAPE_SUB, value(w, is_momentum ? st->args : st->rhs, effect).at[0]);
}

static void read_constraint(Walk *w, const AstStmt *st, Name effect) {
  Tape *t = w->text->tape;
  TextValue l = value(w, st->lhs, effect), r = value(w, st->rhs, effect);
  uint32_t n = l.n ? l.n : r.n;
  for (uint32_t k = 0; k < (n ? n : 1); k++) {
    Ref c = tape_op(t, TAPE_SUB, l.at[k], r.at[k], 0);
    if (st->args) push_switched(w, c);
    else push_constraint(w, c);
  }
}

/* --- guides --- */

static Ref sum_of(Tape *t, TapeOp op, Ref a, Ref b) {
  if (!a || !b) return a ? a : b && op == TAPE_SUB ? tape_op(t, TAPE_NEG, b, 0, 0) : b;
  return tape_op(t, op, a, b, 0);
}

/* The slip along the direction that constraints c[n - 1] leave free in the space of n coordinates. */
static Ref slip_along(Walk *w, const uint32_t *space, uint32_t n, const Ref *c) {
  Tape *t = w->text->tape;
  Ref q[3], d[2][3], speed = 0, square = 0;
  for (uint32_t i = 0; i < n; i++) q[i] = tape_input(t, INPUT_COORD, space[i]);
  for (uint32_t k = 0; k + 1 < n; k++)
    for (uint32_t i = 0; i < n; i++) d[k][i] = tape_partial(t, c[k], q[i]);
  for (uint32_t i = 0; i < n; i++) {
    uint32_t j = (i + 1) % n, k = (i + 2) % n;
    Ref along = n == 2 ? i ? sum_of(t, TAPE_SUB, 0, d[0][0]) : d[0][1]
                       : sum_of(t, TAPE_SUB, tape_op(t, TAPE_MUL, d[0][j], d[1][k], 0),
                                tape_op(t, TAPE_MUL, d[0][k], d[1][j], 0));
    if (!along) continue;
    speed = sum_of(t, TAPE_ADD, speed, tape_op(t, TAPE_MUL, along, tape_op(t, TAPE_RATE, q[i], 0, 0), 0));
    square = sum_of(t, TAPE_ADD, square, tape_op(t, TAPE_MUL, along, along, 0));
  }
  return tape_op(t, TAPE_DIV, speed, tape_power(t, square, num_ratio(1, 2)), 0);
}

/* The tangent of the next guide: as that of a contact. */
static void read_guide(Walk *w, const AstStmt *st, Name effect) {
  const Model *m = w->text->m;
  if (st->kind != STMT_GUIDE) return;
  while (w->guide < m->contacts.n && !m->contacts.at[w->guide].parts) w->guide++;
  if (w->guide == m->contacts.n) return;
  const Contact *tangent = &m->contacts.at[w->guide++];
  if (!tangent->nspace) {
    read_tangent(w, tangent, slip_value(w, st, effect).at[0]);
    return;
  }
  Ref c[2];
  TextValue l = value(w, st->lhs, effect), r = value(w, st->rhs, effect);
  for (uint32_t k = 0; k + 1 < tangent->nspace; k++) c[k] = tape_op(w->text->tape, TAPE_SUB, l.at[k], r.at[k], 0);
  read_tangent(w, tangent, slip_along(w, tangent->space, tangent->nspace, c));
}

static void read_guide_constraint(Walk *w, const AstStmt *st, Name effect) {
  AstStmt constraint = *st;
  constraint.args = 0;
  if (st->lhs) read_constraint(w, &constraint, effect);
}

static void read_dynamics(Walk *w, const AstStmt *st, Name effect) {
  TextDynamics *d = w->dynamics;
  switch (st->kind) {
  case STMT_MOMENTUM:
  case STMT_HAMILTONIAN: d->lagrangian = with_phase_space_action(w, d->lagrangian, st, effect); return;
  case STMT_LAGRANGIAN:
  case STMT_KINETIC: d->lagrangian = added(w, d->lagrangian, TAPE_ADD, value(w, st->rhs, effect).at[0]); return;
  case STMT_POTENTIAL: d->lagrangian = added(w, d->lagrangian, TAPE_SUB, value(w, st->rhs, effect).at[0]); return;
  case STMT_DISSIPATION: d->dissipation = added(w, d->dissipation, TAPE_ADD, value(w, st->rhs, effect).at[0]); return;
  case STMT_FORCE: read_force(w, st, effect); return;
  case STMT_FLOW: read_flow(w, st, effect); return;
  case STMT_CONSTRAINT: read_constraint(w, st, effect); return;
  case STMT_CONTACT: read_contact(w, st, effect); return;
  case STMT_GUIDE: read_guide_constraint(w, st, effect); return;
  default: return; /* no part of the equations of motion */
  }
}

TextDynamics *text_dynamics(const Model *m, int samples, Arena *a) {
  TextDynamics *d = ARENA_NEW(a, TextDynamics);
  d->flows = ARENA_ARRAY(a, Ref, m->states.n + 1);
  d->constraints = ARENA_ARRAY(a, Ref, m->constraints.n + 1);
  Walk w = {.text = text_new(m, samples, a), .dynamics = d};
  walk(&w, read_dynamics);
  walk(&w, read_guide); /* behind all others, as in model/guide.c */
  d->tape = w.text->tape;
  d->why = d->tape->too_long ? "its length" : w.why;
  VEC(Ref) roots = {0};
  vec_push(a, &roots, d->lagrangian);
  vec_push(a, &roots, d->dissipation);
  for (uint32_t i = 0; i < d->forces.n; i++) {
    for (int k = 0; k < 4; k++) vec_push(a, &roots, d->forces.at[i].point[k]);
    for (int k = 0; k < 3; k++) vec_push(a, &roots, d->forces.at[i].f[k]);
  }
  for (uint32_t i = 0; i < m->states.n; i++) vec_push(a, &roots, d->flows[i]);
  for (uint32_t i = 0; i < m->constraints.n; i++) vec_push(a, &roots, d->constraints[i]);
  tape_finish(d->tape, roots.at, roots.n);
  return d;
}

/* --- events, outputs, inputs --- */

static void read_actions(Walk *w, const AstStmt *event, Name effect) {
  const Ast *ast = w->text->b->ast;
  for (const AstStmt *s = event->body; s; s = s->next) {
    if (s->kind != STMT_SET || ast_expr(ast, s->lhs)->kind == AST_CALL) continue; /* omega(R) = ... */
    const AstExpr *l = ast_expr(ast, s->lhs);
    int rate = l->kind == AST_PRIME;
    TextValue of = value(w, rate ? l->a : s->lhs, effect), v = value(w, s->rhs, effect);
    for (uint32_t k = 0; of.at[0] && v.at[0] && of.n != ROTATION && k < text_components(&of); k++) {
      const TapeIns *q = target_input(w, of.at[k]);
      if (!q) break;
      int coord = q->input == INPUT_COORD;
      TextAction one = {.kind = !coord ? SYM_STATE : rate ? SYM_VEL : SYM_COORD, .index = q->index, .event = w->event};
      const Unit *own = coord ? &w->text->m->coords.at[q->index].unit : &w->text->m->states.at[q->index].unit;
      Unit unit = rate ? rate_unit(own) : *own;
      one.value = text_component(w->text, &v, k, &unit);
      vec_push(w->text->arena, &w->outputs->actions, one);
    }
  }
}

static void read_event(Walk *w, const AstStmt *st, Name effect) {
  if (w->event >= w->text->m->events.n) return;
  w->outputs->events[w->event] = value(w, st->lhs, effect).at[0];
  read_actions(w, st, effect);
  w->event++;
}

static void read_member(Walk *w, const ContactFamily *f, int64_t row, int64_t turn) {
  const AstStmt *st = f->stmt;
  TextMember x = {.family = (uint32_t)(f - w->text->m->families.at), .row = row, .turn = turn};
  static const char *const options[] = {"friction", "tangential", "static", "slip"};
  vec_push(w->text->arena, &w->around, ((IndexVar){f->name_i, f->i0 + row}));
  if (f->name_j) vec_push(w->text->arena, &w->around, ((IndexVar){f->name_j, f->j0 + turn}));
  x.value[0] = value(w, st->lhs, f->effect).at[0];
  x.value[1] = value(w, st->rhs, f->effect).at[0];
  for (uint32_t k = 0; k < 4; k++) {
    AstId id = ast_option_value(w->text->b->ast, st, options[k]);
    TextValue v = id ? value(w, id, f->effect) : (TextValue){0};
    for (uint32_t part = 0; id && part < text_components(&v) && part < 2; part++) x.value[2 + k + part] = v.at[part];
  }
  w->around.n -= f->name_j ? 2 : 1;
  vec_push(w->text->arena, &w->outputs->members, x);
}

/* The first and the last member of a family. */
static void read_family(Walk *w, const ContactFamily *f) {
  int64_t first = 0, last = (int64_t)f->range.rows - 1;
  while (first < last && !loop_turns(&f->range, first)) first++;
  while (last > first && !loop_turns(&f->range, last)) last--;
  read_member(w, f, first, loop_from(&f->range, first));
  read_member(w, f, last, loop_to(&f->range, last) - 1);
}

static void read_output_statement(Walk *w, const AstStmt *st, Name effect) {
  const ContactFamily *family = family_of(w, st);
  if (st->kind == STMT_EVENT) read_event(w, st, effect);
  else if (family) read_family(w, family);
  else if (st->kind == STMT_CONTACT) { /* events added by model/constraint.c */
    TextValue slip = st->args ? slip_value(w, st, effect) : (TextValue){0};
    w->event += 2 + (st->args ? 2 * text_components(&slip) : 0);
  }
  else if (st->kind == STMT_CONSTRAINT && st->args) w->event += 2; /* the same */
}

static Ref signal_value(Walk *w, const Input *in) {
  if (!in->text) return 0;
  TextValue v = value(w, in->text, in->effect);
  return v.at[0] ? text_component(w->text, &v, 0, &in->unit) : 0;
}

static Ref rate_of(Walk *w, Ref signal) { return signal ? tape_op(w->text->tape, TAPE_RATE, signal, 0, 0) : 0; }

static Ref output_value(Walk *w, const OutputText *o) {
  if (!o->id) return 0;
  w->text->member = o->is_member ? o->member : NULL;
  TextValue v = value(w, o->id, NULL);
  w->text->member = NULL;
  return o->component < text_components(&v) ? v.at[o->component] : 0;
}

/* 1 for the output `energy`, unless the model declares that name. */
static int is_energy(const DirectEval *t, const OutputText *o) {
  const AstExpr *x = o->id ? ast_expr(t->b->ast, o->id) : NULL;
  return x && x->kind == AST_NAME && strcmp(x->name, "energy") == 0 && !scope_find(&t->b->scope, x->name, NULL, NULL);
}

static void read_energies(Walk *w, const AstStmt *st, Name effect) {
  DirectEval *t = w->text;
  if (st->kind == STMT_MOMENTUM || st->kind == STMT_HAMILTONIAN)
    t->lagrangian = with_phase_space_action(w, t->lagrangian, st, effect);
  int plus = st->kind == STMT_LAGRANGIAN || st->kind == STMT_KINETIC;
  if (!plus && st->kind != STMT_POTENTIAL) return;
  Ref term = value(w, st->rhs, effect).at[0];
  t->lagrangian = added(w, t->lagrangian, plus ? TAPE_ADD : TAPE_SUB, term);
  if (st->kind == STMT_KINETIC) t->kinetic = added(w, t->kinetic, TAPE_ADD, term);
  if (st->kind == STMT_POTENTIAL) t->potential = added(w, t->potential, TAPE_ADD, term);
}

/* Puts L, T and V on the tape, for outputs with `lagrangian`, `T`, `V`, `energy`, `p_x`. No value where a part of L
 * has none. */
static void give_energies(Walk *w) {
  w->why = NULL;
  walk(w, read_energies);
  DirectEval *t = w->text;
  if (t->kinetic && !t->potential) t->potential = tape_number(t->tape, num_int(0));
  if (t->potential && !t->kinetic) t->kinetic = tape_number(t->tape, num_int(0));
  if (w->why) t->lagrangian = t->kinetic = t->potential = 0;
}

TextOutputs *text_outputs(const Model *m, int samples, Arena *a) {
  TextOutputs *o = ARENA_NEW(a, TextOutputs);
  const Output *outputs = m->scene.outputs.at;
  const uint32_t noutputs = m->scene.outputs.n;
  o->events = ARENA_ARRAY(a, Ref, m->events.n + 1);
  o->outputs = ARENA_ARRAY(a, Ref, noutputs + 1);
  o->is_energy = ARENA_ARRAY(a, unsigned char, noutputs + 1);
  o->signals = ARENA_ARRAY(a, Ref, m->inputs.n + 1);
  Walk w = {.text = text_new(m, samples, a), .outputs = o};
  walk(&w, read_output_statement);
  for (uint32_t i = 0; i < m->inputs.n; i++)
    o->signals[i] = m->inputs.at[i].order ? rate_of(&w, o->signals[i - 1]) : signal_value(&w, &m->inputs.at[i]);
  for (uint32_t i = 0; i < noutputs; i++) {
    o->is_energy[i] = is_energy(w.text, &outputs[i].from) != 0;
    if (!o->is_energy[i]) o->outputs[i] = output_value(&w, &outputs[i].from);
  }
  if (w.text->needs_energies) give_energies(&w);
  for (uint32_t i = 0; w.text->needs_energies && i < noutputs; i++)
    if (!o->outputs[i] && !o->is_energy[i]) o->outputs[i] = output_value(&w, &outputs[i].from);
  o->tape = w.text->tape;
  VEC(Ref) roots = {0};
  for (uint32_t i = 0; i < m->events.n; i++) vec_push(a, &roots, o->events[i]);
  for (uint32_t i = 0; i < o->actions.n; i++) vec_push(a, &roots, o->actions.at[i].value);
  for (uint32_t i = 0; i < o->members.n; i++)
    for (size_t k = 0; k < sizeof o->members.at->value / sizeof *o->members.at->value; k++)
      vec_push(a, &roots, o->members.at[i].value[k]);
  for (uint32_t i = 0; i < noutputs; i++) vec_push(a, &roots, o->outputs[i]);
  for (uint32_t i = 0; i < m->inputs.n; i++) vec_push(a, &roots, o->signals[i]);
  tape_finish(o->tape, roots.at, roots.n);
  return o;
}
