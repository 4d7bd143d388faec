/* Values of single Ast nodes on the tape: operators, names, functions, rotations. Independent of model/resolve*.c,
 * which it checks. */
#include <stdlib.h>

#include "self_check/direct_eval_impl.h"
#include "numeric/functions.def"

static const TextValue *operand(const Frame *f, AstId id) { return &f->value[id - f->first]; }
static TextValue scalar(Ref r, int bare) { return (TextValue){.at = {r}, .bare = bare}; }
static Ref binary_op(DirectEval *t, TapeOp op, Ref a, Ref b) { return tape_op(t->tape, op, a, b, 0); }
static Ref negative(DirectEval *t, Ref a) { return tape_op(t->tape, TAPE_NEG, a, 0, 0); }

/* --- units --- */

static Ref times_unit(DirectEval *t, Ref r, const Unit *u) {
  Ref pi = u->pi_power ? tape_pi(t->tape) : 0;
  if (pi) r = binary_op(t, TAPE_MUL, r, tape_power(t->tape, pi, num_int(u->pi_power)));
  if (!num_is_one(u->factor)) r = binary_op(t, TAPE_MUL, r, tape_number(t->tape, u->factor));
  return num_is_zero(u->offset) ? r : binary_op(t, TAPE_ADD, r, tape_number(t->tape, u->offset));
}

Ref text_component(DirectEval *t, const TextValue *v, uint32_t k, const Unit *unit) {
  return v->bare ? times_unit(t, v->at[k], unit) : v->at[k];
}

static TextValue unit_node(DirectEval *t, const TextValue *v, const AstExpr *x) {
  Unit u = unit_resolve(&x->unit, t->b->dims, t->b->diags, t->m->arena);
  TextValue r = {.n = v->n};
  for (uint32_t k = 0; v->at[0] && k < text_components(v); k++) r.at[k] = times_unit(t, v->at[k], &u);
  return r;
}

/* --- rotations: quaternions (w, x, y, z) --- */

static Ref plus(DirectEval *t, Ref a, Ref b) { return binary_op(t, TAPE_ADD, a, b); }
static Ref minus(DirectEval *t, Ref a, Ref b) { return binary_op(t, TAPE_SUB, a, b); }
static Ref times(DirectEval *t, Ref a, Ref b) { return binary_op(t, TAPE_MUL, a, b); }

static void cross(DirectEval *t, const Ref *u, const Ref *v, Ref *out) {
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    Ref a = times(t, u[i], v[j]), b = times(t, u[j], v[i]);
    out[k] = minus(t, a, b);
  }
}

static Ref dot(DirectEval *t, const Ref *u, const Ref *v, uint32_t n) {
  Ref r = times(t, u[0], v[0]);
  for (uint32_t k = 1; k < n; k++) r = plus(t, r, times(t, u[k], v[k]));
  return r;
}

/* Product of quaternions, (a, u)(b, v) = (ab - u.v, a v + b u + u x v). */
static TextValue product(DirectEval *t, const TextValue *p, const TextValue *q) {
  TextValue r = {.n = ROTATION};
  Ref across[3];
  cross(t, p->at + 1, q->at + 1, across);
  r.at[0] = minus(t, times(t, p->at[0], q->at[0]), dot(t, p->at + 1, q->at + 1, 3));
  for (int k = 0; k < 3; k++)
    r.at[k + 1] = plus(t, plus(t, times(t, p->at[0], q->at[k + 1]), times(t, q->at[0], p->at[k + 1])), across[k]);
  r.scale = p->scale && q->scale ? times(t, p->scale, q->scale) : p->scale ? p->scale : q->scale;
  return r;
}

/* Rotated vector v + 2 u x (u x v + w v) for q = (w, u). */
static TextValue turned(DirectEval *t, const TextValue *q, const TextValue *v) {
  TextValue r = {.n = 3};
  Ref inner[3], outer[3], twice = tape_number(t->tape, num_int(2));
  cross(t, q->at + 1, v->at, inner);
  for (int k = 0; k < 3; k++) inner[k] = plus(t, inner[k], times(t, q->at[0], v->at[k]));
  cross(t, q->at + 1, inner, outer);
  for (int k = 0; k < 3; k++) {
    r.at[k] = plus(t, v->at[k], times(t, twice, outer[k]));
    if (q->scale) r.at[k] = times(t, q->scale, r.at[k]);
  }
  return r;
}

static TextValue conjugate(DirectEval *t, const TextValue *q) {
  TextValue r = *q;
  for (int k = 1; k < ROTATION; k++) r.at[k] = negative(t, q->at[k]);
  return r;
}

/* Angular velocity in the body frame: vector part of 2 conj(q) q'. */
static TextValue spin(DirectEval *t, const TextValue *q) {
  TextValue back = conjugate(t, q), rates = *q, r = {.n = 3};
  for (int k = 0; k < ROTATION; k++) rates.at[k] = tape_op(t->tape, TAPE_RATE, q->at[k], 0, 0);
  TextValue w = product(t, &back, &rates);
  Ref twice = tape_number(t->tape, num_int(2));
  for (int k = 0; k < 3; k++) r.at[k] = times(t, twice, w.at[k + 1]);
  return r;
}

static TextValue turn(DirectEval *t, const TextValue *axis, const TextValue *angle) {
  Ref half = binary_op(t, TAPE_DIV, angle->at[0], tape_number(t->tape, num_int(2)));
  Ref length = tape_power(t->tape, dot(t, axis->at, axis->at, 3), num_ratio(1, 2));
  Ref s = binary_op(t, TAPE_DIV, tape_function(t->tape, "sin", half), length);
  TextValue r = {.n = ROTATION, .at = {tape_function(t->tape, "cos", half)}};
  for (int k = 0; k < 3; k++) r.at[k + 1] = times(t, s, axis->at[k]);
  return r;
}

/* --- operators --- */

/* Rotation times or over a number: the factor is kept in `scale` until a vector is turned. */
static TextValue scaled_rotation(DirectEval *t, AstKind op, const TextValue *q, const TextValue *number) {
  TextValue r = *q;
  Ref one = tape_number(t->tape, num_int(1)), scale = q->scale ? q->scale : one;
  r.scale = binary_op(t, op == AST_DIV ? TAPE_DIV : TAPE_MUL, scale, number->at[0]);
  return r;
}

TextValue text_pair(DirectEval *t, AstKind op, const TextValue *x, const TextValue *y) {
  static const TapeOp ops[] = {[AST_ADD] = TAPE_ADD, [AST_SUB] = TAPE_SUB, [AST_MUL] = TAPE_MUL, [AST_DIV] = TAPE_DIV};
  if (!x->at[0] || !y->at[0]) return NOTHING;
  if (op == AST_MUL && x->n == ROTATION && y->n == ROTATION) return product(t, x, y);
  if (op == AST_MUL && x->n == ROTATION && y->n) return turned(t, x, y);
  if (x->n == ROTATION) return scaled_rotation(t, op, x, y);
  if (y->n == ROTATION) return scaled_rotation(t, op, y, x);
  TextValue r = {.n = x->n ? x->n : y->n, .bare = x->bare && y->bare};
  for (uint32_t k = 0; k < text_components(&r); k++)
    r.at[k] = binary_op(t, ops[op], x->at[x->n ? k : 0], y->at[y->n ? k : 0]);
  return r;
}

static TextValue power(DirectEval *t, const TextValue *x, const TextValue *y) {
  Num n;
  if (!x->at[0] || !y->at[0]) return NOTHING;
  Ref r = tape_is_number(t->tape, y->at[0], &n) ? tape_power(t->tape, x->at[0], n)
                                                : binary_op(t, TAPE_POW, x->at[0], y->at[0]);
  return scalar(r, x->bare && y->bare);
}

static TextValue comparison(DirectEval *t, const Frame *f, const AstExpr *x) {
  Ref l = operand(f, x->a)->at[0], r = operand(f, x->b)->at[0];
  int swapped = x->kind == AST_GT || x->kind == AST_GE;
  TapeOp op = x->kind == AST_LT || x->kind == AST_GT   ? TAPE_LT
              : x->kind == AST_LE || x->kind == AST_GE ? TAPE_LE
                                                       : TAPE_EQ;
  Ref c = binary_op(t, op, swapped ? r : l, swapped ? l : r);
  return scalar(x->kind == AST_NE ? tape_op(t->tape, TAPE_NOT, c, 0, 0) : c, 0);
}

static TextValue tuple(const DirectEval *t, const Frame *f, const AstExpr *x) {
  TextValue r = {.bare = 1};
  for (AstId i = x->args; i && r.n < 3; i = ast_expr(t->b->ast, i)->next) {
    if (!operand(f, i)->at[0]) return NOTHING;
    r.bare &= operand(f, i)->bare;
    r.at[r.n++] = operand(f, i)->at[0];
  }
  return r;
}

/* --- names --- */

static int is_one_of(Name name, const char *const *names) {
  while (*names && strcmp(name, *names) != 0) names++;
  return *names != NULL;
}

static TextValue value_or_wait(DirectEval *t, Frame *f, EntKind kind, uint32_t index, const TextValue *known) {
  if (f->returned) return f->result.at[0] ? f->result : unknown(t, "a definition");
  if (known && known->at[0]) return *known;
  f->needs = (PendingDefinition){kind, index};
  f->waits = 1;
  return NOTHING;
}

static TextValue entity(DirectEval *t, Frame *f, const Entity *e, const int64_t *at) {
  static const InputKind kinds[] = {
      [ENT_COORD] = INPUT_COORD, [ENT_STATE] = INPUT_STATE, [ENT_PARAM] = INPUT_PARAM, [ENT_INPUT] = INPUT_SIGNAL};
  TextValue r = {.n = e->parts};
  switch (e->kind) {
    case ENT_COORD: case ENT_STATE: case ENT_PARAM: case ENT_INPUT:
      for (uint32_t k = 0; k < text_components(&r); k++)
        r.at[k] = tape_input(t->tape, kinds[e->kind], e->index + member_offset(e, at) + k);
      return r;
    case ENT_CONST: return value_or_wait(t, f, e->kind, e->index, &t->constants[e->index]);
    case ENT_LET: return value_or_wait(t, f, e->kind, e->index, &t->lets[e->index]);
    case ENT_OBSERVE: return value_or_wait(t, f, e->kind, e->index, &t->observes[e->index]);
    case ENT_NONE: case ENT_FUNCTION: case ENT_SYMMETRY: case ENT_BUILTIN: break;
  }
  return NOTHING;
}

/* Member t->member of a family that is named without indices; NULL: the family has none, as x of x[i,1] in q[i]. */
static const int64_t *output_member(const DirectEval *t, const Entity *e) {
  const int64_t *at = t->member;
  for (int k = 0; k < e->ndims && at; k++)
    if (at[k] < e->lo[k] || at[k] > e->hi[k]) at = NULL;
  return at;
}

/* Value of a name with indices `at`, or without. */
static TextValue named(DirectEval *t, Frame *f, const Entity *e, const int64_t *at) {
  const int64_t *which = e->ndims ? at ? at : output_member(t, e) : NULL;
  if (e->ndims && !which) return NOTHING;
  const Entity *member =
      e->ndims && (e->kind == ENT_LET || e->kind == ENT_OBSERVE) ? find_member(t->b->ast, &t->b->members, e, which) : e;
  return member ? entity(t, f, member, which) : NOTHING;
}

static const TextValue *argument(const DirectEval *t, const Frame *f, Name name) {
  AstId id = f->function ? f->function->stmt->args : 0;
  for (uint32_t i = 0; id && i < f->nargs; i++, id = ast_expr(t->b->ast, id)->next)
    if (ast_expr(t->b->ast, id)->name == name) return &f->args[i];
  return NULL;
}

static const IndexVar *find_index(const Frame *f, Name name) {
  for (uint32_t i = f->index.n; i-- > 0;)
    if (f->index.at[i].name == name) return &f->index.at[i];
  return NULL;
}

/* `lagrangian`, `T`, `V` or `energy`; 0 until they are set. For first-order L all states count as coordinates: L has
 * no rates of others. */
static Ref energy_called(DirectEval *t, Name name) {
  if (strcmp(name, "lagrangian") == 0) return t->lagrangian;
  if (strcmp(name, "T") == 0) return t->kinetic;
  if (strcmp(name, "V") == 0) return t->potential;
  return tape_energy(t->tape, t->lagrangian, t->m->first_order ? INPUT_STATE : INPUT_COORD);
}

/* The coordinate x of a momentum name `p_x`, or NULL. */
static const Entity *momentum_of(const DirectEval *t, const Frame *f, Name name) {
  if (strncmp(name, "p_", 2) != 0 || scope_find(&t->b->scope, name, f->effect, NULL)) return NULL;
  const Entity *e = scope_find(&t->b->scope, intern(t->b->ast->names, name + 2), f->effect, NULL);
  return e && (e->kind == ENT_COORD || e->kind == ENT_STATE) ? e : NULL;
}

/* Momentum dL/dq' of a coordinate. */
static TextValue momentum(DirectEval *t, const Entity *e, const int64_t *at) {
  TextValue r = {.n = e->parts};
  t->needs_energies |= !t->lagrangian;
  for (uint32_t k = 0; t->lagrangian && k < text_components(&r); k++) {
    Ref q = tape_input(t->tape, e->kind == ENT_COORD ? INPUT_COORD : INPUT_STATE, e->index + member_offset(e, at) + k);
    r.at[k] = tape_partial(t->tape, t->lagrangian, tape_op(t->tape, TAPE_RATE, q, 0, 0));
  }
  return r;
}

/* Value of a name; names of families, effects and constraints have none, which is no error here. */
static TextValue name_node(DirectEval *t, Frame *f, Name name) {
  static const char *const energies[] = {"lagrangian", "T", "V", "energy", NULL};
  const IndexVar *index = find_index(f, name);
  if (index) return scalar(tape_number(t->tape, num_int(index->at)), 1);
  const TextValue *arg = argument(t, f, name);
  if (arg) return *arg;
  if (strcmp(name, "pi") == 0) return scalar(tape_pi(t->tape), 1);
  if (strcmp(name, "t") == 0) return scalar(tape_input(t->tape, INPUT_TIME, 0), 0);
  const Entity *e = scope_find(&t->b->scope, name, f->effect, NULL), *q = momentum_of(t, f, name);
  if (e) return named(t, f, e, NULL);
  if (q) return q->ndims ? NOTHING : momentum(t, q, NULL);
  if (!is_one_of(name, energies)) return NOTHING;
  t->needs_energies |= !t->lagrangian;
  return t->lagrangian ? scalar(energy_called(t, name), 0) : NOTHING;
}

static TextValue index_node(DirectEval *t, Frame *f, const AstExpr *x) {
  const AstExpr *of = ast_expr(t->b->ast, x->a);
  int64_t at[2] = {0};
  uint32_t n = 0;
  const Entity *e = NULL;
  if (of->kind == AST_NAME) e = scope_find(&t->b->scope, of->name, f->effect, NULL);
  else if (of->kind == AST_MEMBER && ast_expr(t->b->ast, of->a)->kind == AST_NAME)
    e = scope_own(&t->b->scope, of->name, ast_expr(t->b->ast, of->a)->name);
  for (AstId i = x->args; i && n < 2; i = ast_expr(t->b->ast, i)->next, n++)
    if (!whole(t, operand(f, i), &at[n])) return NOTHING;
  const Entity *q = !e && of->kind == AST_NAME ? momentum_of(t, f, of->name) : NULL;
  if (q && q->ndims == n) return momentum(t, q, at);
  if (!e || e->ndims != n) return NOTHING;
  return named(t, f, e, at);
}

static TextValue component(const TextValue *v, Name name) {
  for (uint32_t k = 0; v->at[0] && k < v->n; k++)
    if (name[0] == component_letter(v->n, k) && !name[1]) return scalar(v->at[k], v->bare);
  return NOTHING;
}

/* drag.c, a name of an effect, or r.x, a component. */
static TextValue member_node(DirectEval *t, Frame *f, const AstExpr *x) {
  const AstExpr *left = ast_expr(t->b->ast, x->a);
  const Entity *e = left->kind == AST_NAME ? scope_own(&t->b->scope, x->name, left->name) : NULL;
  if (e) return named(t, f, e, NULL);
  TextValue v = *operand(f, x->a);
  return component(&v, x->name);
}

/* --- calls --- */

static TextValue rate(DirectEval *t, const TextValue *v) {
  TextValue r = {.n = v->n};
  if (v->n == ROTATION) return NOTHING;
  for (uint32_t k = 0; v->at[0] && k < text_components(v); k++) r.at[k] = tape_op(t->tape, TAPE_RATE, v->at[k], 0, 0);
  return r;
}

static TextValue select_value(DirectEval *t, const TextValue *c, const TextValue *x, const TextValue *y) {
  Num known;
  if (tape_is_number(t->tape, c->at[0], &known)) return num_is_zero(known) ? *y : *x;
  if (!x->at[0] || !y->at[0]) return NOTHING;
  TextValue r = {.n = x->n};
  for (uint32_t k = 0; k < text_components(x); k++)
    r.at[k] = tape_op(t->tape, TAPE_SELECT, c->at[0], x->at[k], y->at[k]);
  return r;
}

/* The name of a constraint or a contact: rod, rod[2], drag.rod; owner: the effect that is named. NULL: its index has
 * no value. */
static Name constraint_name(DirectEval *t, const Frame *f, AstId id, Name *owner) {
  const Ast *ast = t->b->ast;
  const AstExpr *x = ast_expr(ast, id);
  int64_t at[2] = {0};
  uint32_t n = 0;
  if (x->kind == AST_INDEX) {
    for (AstId i = x->args; i && n < 2; i = ast_expr(ast, i)->next, n++)
      if (!whole(t, operand(f, i), &at[n])) return NULL;
    x = ast_expr(ast, x->a);
  }
  if (x->kind == AST_MEMBER) *owner = ast_expr(ast, x->a)->name;
  return member_name(ast, x->name, at, n);
}

/* Multipliers of the constraint or contact e, of tangents with the friction while they slip. */
static TextValue multipliers_of(DirectEval *t, const Entity *e) {
  TextValue r = {.n = e->parts};
  for (uint32_t k = 0; k < text_components(&r); k++) r.at[k] = tape_input(t->tape, INPUT_MULTIPLIER, e->index + k);
  for (uint32_t i = 0; i < t->m->contacts.n; i++) { /* friction of a contact that slips */
    const Contact *c = &t->m->contacts.at[i];
    uint32_t k = c->constraint - e->index;
    if (c->is_tangent && c->constraint >= e->index && k < text_components(&r))
      r.at[k] = plus(t, r.at[k], tape_input(t->tape, INPUT_SIGNAL, expr_symbol(t->m->g, c->force)->index));
  }
  return r;
}

/* Multiplier of a constraint: lambda(rod), lambda(rod[2]), lambda(drag.rod), or of the slip of a contact:
 * lambda(floor.slip), lambda(feet[2].slip). */
static TextValue multiplier(DirectEval *t, const Frame *f, AstId id) {
  const AstExpr *x = ast_expr(t->b->ast, id);
  int of_family = x->kind == AST_MEMBER && ast_expr(t->b->ast, x->a)->kind == AST_INDEX, ambiguous;
  Name owner = NULL, name = of_family ? x->name : constraint_name(t, f, id, &owner);
  if (of_family) owner = constraint_name(t, f, x->a, &owner);
  if (!name || (of_family && !owner)) return NOTHING;
  const Entity *e =
      owner ? scope_own(&t->b->constraints, name, owner) : scope_find(&t->b->constraints, name, f->effect, &ambiguous);
  const Entity *back = e ? other_side(&t->b->constraints, t->b->ast, e) : NULL;
  TextValue r = e ? multipliers_of(t, e) : (TextValue){0}, w = back ? multipliers_of(t, back) : r;
  for (uint32_t k = 0; back && k < text_components(&r); k++)
    r.at[k] = r.n ? plus(t, r.at[k], w.at[k]) : minus(t, r.at[k], w.at[k]);
  return r;
}

static TextValue call_vectors(DirectEval *t, Name name, const TextValue *x, const TextValue *y) {
  TextValue r = {.n = 3};
  if (strcmp(name, "dot") == 0) return scalar(dot(t, x->at, y->at, x->n), x->bare && y->bare);
  if (strcmp(name, "norm") == 0)
    return scalar(tape_power(t->tape, dot(t, x->at, x->at, x->n), num_ratio(1, 2)), x->bare);
  if (x->n == 2)
    return scalar(minus(t, times(t, x->at[0], y->at[1]), times(t, x->at[1], y->at[0])), x->bare && y->bare);
  cross(t, x->at, y->at, r.at);
  r.bare = x->bare && y->bare;
  return r;
}

static TextValue call_rotation(DirectEval *t, Name name, const TextValue *x, const TextValue *y) {
  if (strcmp(name, "omega") == 0) return spin(t, x);
  if (strcmp(name, "transpose") == 0) return conjugate(t, x);
  return y->at[0] ? turn(t, x, y) : NOTHING;
}

/* d(expr, name). Not evaluated by an argument of a function: its value may be a number, or occur elsewhere in the
 * body. */
static TextValue partial(const DirectEval *t, const Frame *f, const TextValue *of, AstId by) {
  const AstExpr *x = ast_expr(t->b->ast, by);
  while (x->kind == AST_PRIME || x->kind == AST_MEMBER) x = ast_expr(t->b->ast, x->a);
  if (x->kind == AST_NAME && argument(t, f, x->name)) return NOTHING;
  TextValue r = {.n = of->n};
  for (uint32_t k = 0; k < text_components(of); k++) r.at[k] = tape_partial(t->tape, of->at[k], operand(f, by)->at[0]);
  return r;
}

static TextValue call_binary(DirectEval *t, Name name, const TextValue *x, const TextValue *y) {
  int bare = x->bare && y->bare;
  if (strcmp(name, "pow") == 0) return power(t, x, y);
  if (strcmp(name, "min") == 0) return scalar(binary_op(t, TAPE_MIN, x->at[0], y->at[0]), bare);
  if (strcmp(name, "max") == 0) return scalar(binary_op(t, TAPE_MAX, x->at[0], y->at[0]), bare);
  if (strcmp(name, "hypot") == 0) return scalar(binary_op(t, TAPE_HYPOT, x->at[0], y->at[0]), bare);
  return strcmp(name, "atan2") == 0 ? scalar(binary_op(t, TAPE_ATAN2, x->at[0], y->at[0]), bare) : NOTHING;
}

static TextValue call_unary(DirectEval *t, Name name, const TextValue *x) {
  #define NAME(OP, name, ...) #name,
  static const char *const functions[] = {FUNCTIONS(NAME) NULL};
  if (strcmp(name, "sqrt") == 0) return scalar(tape_power(t->tape, x->at[0], num_ratio(1, 2)), x->bare);
  if (strcmp(name, "cbrt") == 0) return scalar(tape_power(t->tape, x->at[0], num_ratio(1, 3)), x->bare);
  if (strcmp(name, "abs") == 0) return scalar(tape_function(t->tape, "fabs", x->at[0]), x->bare);
  if (strcmp(name, "sign") == 0) return scalar(tape_op(t->tape, TAPE_SIGN, x->at[0], 0, 0), x->bare);
  if (strcmp(name, "floor") == 0) return scalar(tape_op(t->tape, TAPE_FLOOR, x->at[0], 0, 0), x->bare);
  return is_one_of(name, functions) ? scalar(tape_function(t->tape, name, x->at[0]), x->bare) : NOTHING;
}

static TextValue call_node(DirectEval *t, Frame *f, const AstExpr *x) {
  static const char *const vectors[] = {"dot", "cross", "norm", NULL}, *const rotations[] = {"omega", "turn",
                                                                                             "transpose", NULL};
  const Ast *ast = t->b->ast;
  const Entity *own = scope_find(&t->b->scope, x->name, f->effect, NULL);
  if (own && own->kind == ENT_FUNCTION) return value_or_wait(t, f, ENT_FUNCTION, own->index, NULL);
  AstId second = x->args ? ast_expr(ast, x->args)->next : 0, third = second ? ast_expr(ast, second)->next : 0;
  if (strcmp(x->name, "lambda") == 0) return multiplier(t, f, x->args);
  if (!x->args || (!operand(f, x->args)->at[0])) return NOTHING;
  const TextValue *a = operand(f, x->args), *b = second ? operand(f, second) : &NOTHING;
  if (strcmp(x->name, "d") == 0) return second ? partial(t, f, a, second) : NOTHING;
  if (strcmp(x->name, "if") == 0) return third ? select_value(t, a, b, operand(f, third)) : NOTHING;
  if (is_one_of(x->name, vectors)) return call_vectors(t, x->name, a, b);
  if (is_one_of(x->name, rotations)) return call_rotation(t, x->name, a, b);
  return second ? call_binary(t, x->name, a, b) : call_unary(t, x->name, a);
}

/* --- dispatch --- */

static TextValue node(DirectEval *t, Frame *f, AstId id) {
  const AstExpr *x = ast_expr(t->b->ast, id);
  const TextValue *a = x->a >= f->first ? operand(f, x->a) : &NOTHING,
                  *b = x->b >= f->first ? operand(f, x->b) : &NOTHING;
  switch (x->kind) {
    case AST_NUM: return scalar(tape_number(t->tape, x->number), 1);
    case AST_NAME: return name_node(t, f, x->name);
    case AST_INDEX: return index_node(t, f, x);
    case AST_MEMBER: return member_node(t, f, x);
    case AST_PRIME: return rate(t, a);
    case AST_UNIT: return unit_node(t, a, x);
    case AST_CALL: return call_node(t, f, x);
    case AST_NEG: {
      TextValue r = *a;
      for (uint32_t k = 0; a->at[0] && k < text_components(a); k++) r.at[k] = negative(t, a->at[k]);
      return r;
    }
    case AST_ADD: case AST_SUB: case AST_MUL: case AST_DIV: return text_pair(t, x->kind, a, b);
    case AST_POW: return power(t, a, b);
    case AST_LT: case AST_LE: case AST_GT: case AST_GE: case AST_EQ: case AST_NE: return comparison(t, f, x);
    case AST_NOT: return scalar(tape_op(t->tape, TAPE_NOT, a->at[0], 0, 0), 0);
    case AST_AND: return scalar(binary_op(t, TAPE_AND, a->at[0], b->at[0]), 0);
    case AST_OR: return scalar(binary_op(t, TAPE_OR, a->at[0], b->at[0]), 0);
    case AST_TUPLE: return tuple(t, f, x);
    case AST_SUM: case AST_PRODUCT: case AST_AT: case AST_STRING: case AST_LIST: case AST_BIND: case AST_ERROR: break;
  }
  return NOTHING;
}

/* Names without a value may be parts of their parent node; any other node without a value is noted in
 * DirectEval.why. */
TextValue text_node(DirectEval *t, Frame *f, AstId id) {
  TextValue v = node(t, f, id);
  AstKind kind = ast_expr(t->b->ast, id)->kind;
  if (!v.at[0] && !f->waits && kind != AST_NAME && kind != AST_INDEX && kind != AST_MEMBER)
    return unknown(t, kind == AST_CALL ? ast_expr(t->b->ast, id)->name : "a part");
  return v;
}
