/* Expressions: Ast -> expression graph, with checks of shapes and dimensions.
 *
 * Ast nodes of an expression are contiguous, children first, so evaluation is one loop over them. The body of a sum
 * is repeated for each value of its index; a branch of an `if` with a known condition is skipped. The whole state is
 * an Eval: an evaluation that needs an unevaluated definition is suspended on an explicit stack, so neither nesting
 * nor chains of definitions use the C stack. */
#include <math.h>

#include "base/words.h"
#include "model/resolve_impl.h"
#include "sym/expr_eval.h"

/* --- nodes that their parents evaluate --- */

/* Marks a left operand with the same kind of operator: a chain becomes one n-ary sum (or product), so a sum of a
 * million terms costs one sort. */
static void mark_chain(Eval *ev, const AstExpr *x) {
  AstKind left = ast_expr(ev->b->ast, x->a)->kind;
  int additive = x->kind == AST_ADD || x->kind == AST_SUB;
  ev->by_parent[x->a - ev->first] = additive ? left == AST_ADD || left == AST_SUB : left == AST_MUL || left == AST_DIV;
}

static void guard(Eval *ev, AstId construct, AstId body) {
  ev->guarded[ast_expr(ev->b->ast, body)->first - ev->first] = construct;
}

static void mark_branches(Eval *ev, AstId id, const AstExpr *x) {
  const Ast *ast = ev->b->ast;
  if (strcmp(x->name, "if") != 0 || !x->args) return;
  AstId yes = ast_expr(ast, x->args)->next, no = yes ? ast_expr(ast, yes)->next : 0;
  if (!no || ast_expr(ast, no)->next) return; /* a wrong number of arguments: reported later */
  guard(ev, id, yes);
  guard(ev, id, no);
}

/* Marks names before an index or a dot, which have no value by themselves: th[2], drag.c, drag.c[2]. */
static void mark_name(Eval *ev, const AstExpr *x) {
  const AstExpr *of = ast_expr(ev->b->ast, x->a);
  int effects = x->kind == AST_INDEX && of->kind == AST_MEMBER && ast_expr(ev->b->ast, of->a)->kind == AST_NAME;
  if (of->kind == AST_NAME || effects) ev->by_parent[x->a - ev->first] = 1;
}

/* Marks names of constraints, which have no value: lambda(rod), lambda(rod[2]), lambda(drag.rod),
 * lambda(feet[2].slip). */
static void mark_constraint(Eval *ev, const AstExpr *x) {
  if (strcmp(x->name, "lambda") != 0 || !x->args || own_function(ev, x)) return;
  for (AstId i = x->args; i; i = ast_expr(ev->b->ast, i)->next) {
    AstKind kind = ast_expr(ev->b->ast, i)->kind;
    if (kind == AST_NAME || kind == AST_INDEX || kind == AST_MEMBER) ev->by_parent[i - ev->first] = 1;
    AstId of = kind == AST_MEMBER ? ast_expr(ev->b->ast, i)->a : 0;
    if (of && ast_expr(ev->b->ast, of)->kind == AST_INDEX) ev->by_parent[of - ev->first] = 1;
  }
}

static void mark(Eval *ev) {
  const Ast *ast = ev->b->ast;
  for (AstId i = ev->root; i >= ev->first; i--) {
    const AstExpr *x = ast_expr(ast, i);
    if (x->kind == AST_ADD || x->kind == AST_SUB || x->kind == AST_MUL || x->kind == AST_DIV) mark_chain(ev, x);
    else if (x->kind == AST_SUM || x->kind == AST_PRODUCT) guard(ev, i, x->c);
    else if (x->kind == AST_CALL) {
      mark_branches(ev, i, x);
      mark_constraint(ev, x);
    }
    else if (x->kind == AST_INDEX || x->kind == AST_MEMBER) mark_name(ev, x);
  }
}

/* Warns of q' where q is a parameter or a constant: its rate is 0. */
static void warn_of_still(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const AstExpr *of = ast_expr(b->ast, x->a);
  while (of->kind == AST_INDEX || of->kind == AST_MEMBER) of = ast_expr(b->ast, of->a);
  const Entity *e = of->kind == AST_NAME ? scope_find(&b->scope, of->name, ev->effect, NULL) : NULL;
  if (!e || (e->kind != ENT_PARAM && e->kind != ENT_CONST)) return;
  const char *what = e->kind == ENT_PARAM ? "parameter" : "constant";
  diag_warning(b->diags, x->span, "this is 0: `%s` is a %s, which does not move", of->name, what);
  diag_help(b->diags, "what moves by itself is a `coord`, what is given over time an `input`, or a formula of t");
}

/* --- one node --- */

static Value node_value(Eval *ev, AstId id) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  switch (x->kind) {
    case AST_NAME: return name_value(ev, x);
    case AST_INDEX: return index_value(ev, x);
    case AST_MEMBER: return member_value(ev, x);
    case AST_PRIME: {
      const Value *v = value_of(ev, x->a);
      if (!v->e) return FAILED;
      if (v->n == ROTATION) return refuse_rotation(b, x->span, ast_short(b, x->a), TURN_PRIME);
      warn_of_still(ev, x);
      if (ev->kind == ENT_FUNCTION) need_rates(b, b->instances.at[ev->definition]);
      return time_derivative(b, *v, x->span, ev->where);
    }
    case AST_UNIT: return unit_value(ev, x);
    case AST_CALL: return call_value(ev, x);
    case AST_AT: return start_value(ev, *value_of(ev, x->a), x->span, value_of(ev, x->b));
    case AST_SUM: case AST_PRODUCT: return *value_of(ev, id); /* set by loop_begin or loop_next */
    case AST_NUM: case AST_NEG: case AST_ADD: case AST_SUB: case AST_MUL: case AST_DIV: case AST_POW: case AST_LT:
    case AST_LE: case AST_GT: case AST_GE: case AST_EQ: case AST_NE: case AST_NOT: case AST_AND: case AST_OR:
    case AST_TUPLE: return operator_value(ev, id);
    case AST_LIST:
      if (b->brackets) return bracket_value(ev, x);
      return refuse(b, x->span, "a list gives the members of a family their values, and stands alone" HELP
                    "`param m[3] = {1, 3, 1/2}`, `start th = {0.1, 0.2}`; a vector is written `(a, b, c)`");
    case AST_STRING:
      return refuse(
          b, x->span,
          "a quoted text is not a value here" HELP
          "a table from a file gives an input its values: `input u = \"file.csv\"`, or `u = \"file.csv\"` in a scene");
    case AST_BIND:
      return refuse(b, x->span,
                    "a range stands in `sum(i in 1..N, ...)` and behind a name, `friction rub[i in 1..N] on x[i]: "
                    "...`, and one of time in a measure, `max(x, 10..20)`");
    case AST_ERROR: return FAILED;
  }
  return FAILED;
}

static int takes_vectors(const Eval *ev, const AstExpr *x) {
  switch (x->kind) {
    case AST_NEG: case AST_ADD: case AST_SUB: case AST_MUL: case AST_DIV: case AST_PRIME: case AST_UNIT:
    case AST_MEMBER: case AST_SUM: case AST_AT: return 1;
    case AST_CALL: return call_takes_vectors(ev, x);
    default: return 0; /* all other nodes take numbers */
  }
}

int operand_fits(Eval *ev, const AstExpr *x, AstId i) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, i);
  int logic = x->kind == AST_NOT || x->kind == AST_AND || x->kind == AST_OR;
  int is_if = x->kind == AST_CALL && strcmp(x->name, "if") == 0;
  /* call_value reports the function */
  int is_foreign_if = x->kind == AST_CALL && has_word(FOREIGN_CHOICES, x->name) && !own_function(ev, x);
  if (v->condition && !logic && !(is_if && i == x->args) && !is_foreign_if) {
    report_condition(b, i);
    return 0;
  }
  if (v->n == ROTATION && !takes_vectors(ev, x)) {
    refuse_rotation(b, ast_expr(b->ast, i)->span, ast_short(b, i), TURN_NUMBER);
    return 0;
  }
  if (v->n && !takes_vectors(ev, x)) {
    diag_error(b->diags, ast_expr(b->ast, i)->span, "`%s` is %s, but a number is needed here", ast_short(b, i),
               shape_text(b, v->n));
    if (x->kind == AST_POW && i == x->a)
      diag_help(b->diags, "the square of a vector is `dot(a, a)`, its length `norm(a)`");
    else
      diag_help(b->diags, "its components are `.x`, `.y`%s; `dot(a, b)` and `norm(a)` are numbers",
                v->n > 2 ? ", `.z`" : "");
    return 0;
  }
  return !v->point || point_fits(ev, x, i);
}

static int operands_fit(Eval *ev, const AstExpr *x) {
  AstId at[3] = {x->a, x->b, x->args};
  /* checked by judge_sum, judge_product */
  if (x->kind == AST_ADD || x->kind == AST_SUB || x->kind == AST_MUL || x->kind == AST_DIV) return 1;
  for (int k = 0; k < 3; k++)
    for (AstId i = at[k]; i; i = k == 2 ? ast_expr(ev->b->ast, i)->next : 0)
      if (!operand_fits(ev, x, i)) return 0;
  return 1;
}

/* 1 if `bad` holds for a numeric node, or for a number among the direct arguments of a sum or product. */
static int has_number(const ExprGraph *g, Expr e, int (*bad)(Num n)) {
  ExprOp op = expr_op(g, e);
  if (op == EX_NUM) return bad(expr_number(g, e));
  if (op != EX_SUM && op != EX_PROD) return 0;
  for (uint32_t i = 0; i < expr_nargs(g, e); i++) {
    Expr n = expr_arg(g, e, i);
    if (expr_is_num(g, n) && bad(expr_number(g, n))) return 1;
  }
  return 0;
}

static int is_infinite(Num n) { return !isfinite(num_value(n)); }

/* Refuses values that contain a number beyond the range of doubles, or one that rounding has destroyed. */
static Value usable_value(Eval *ev, const AstExpr *x, Value v) {
  for (uint32_t k = 0; v.e && k < component_count(&v); k++) {
    int infinite = has_number(ev->b->g, v.at[k], is_infinite);
    if (!infinite && !has_number(ev->b->g, v.at[k], num_is_imprecise)) continue;
    return refuse(ev->b, x->span,
                  infinite ? "a number here is not finite" HELP "numbers reach up to 1.8e308"
                           : "rounding leaves fewer than six digits of a number here" HELP
                             "write its result as one number: numbers are exact as fractions of whole numbers up to "
                             "9.2e18, others have 16 digits");
  }
  return v;
}

/* --- the loop --- */

/* Called at the first node of a sum's body or of a branch: the node to jump to; 0: continue at pc. */
static AstId enter(Eval *ev, AstId construct) {
  const Ast *ast = ev->b->ast;
  const AstExpr *x = ast_expr(ast, construct);
  if (x->kind == AST_SUM || x->kind == AST_PRODUCT) {
    int inside = ev->loops.n && ev->loops.at[ev->loops.n - 1].construct == construct;
    return inside || loop_begin(ev, construct) ? 0 : construct;
  }
  const Value *c = value_of(ev, x->args);
  if (!c->e || !c->condition || !expr_is_num(ev->b->g, c->e)) return 0;
  AstId yes = ast_expr(ast, x->args)->next, no = ast_expr(ast, yes)->next;
  int second = ast_expr(ast, no)->first == ev->pc, taken = !expr_is_zero(ev->b->g, c->e);
  if (second) return taken ? construct : 0;
  return taken ? 0 : ast_expr(ast, no)->first;
}

/* Evaluates from pc on. 1: the root has its value; 0: suspended, a definition is needed first. */
static int run(Eval *ev) {
  Builder *b = ev->b;
  while (ev->pc <= ev->root) {
    AstId construct = ev->guarded[ev->pc - ev->first], to = construct ? enter(ev, construct) : 0;
    if (to) ev->pc = to;
    AstId i = ev->pc;
    const AstExpr *x = ast_expr(b->ast, i);
    if (!ev->by_parent[i - ev->first]) {
      Value v = operands_fit(ev, x) ? usable_value(ev, x, node_value(ev, i)) : FAILED;
      if (ev->waiting) return 0;
      if (b->unitless) v.dim = DIM_ANY;
      if (b->domains && v.e) v.domain = domain_of_node(ev, i, &v);
      *value_of(ev, i) = v;
    }
    /* End of a sum's body: next index value, or on to the sum. */
    if (ev->loops.n && ast_expr(b->ast, ev->loops.at[ev->loops.n - 1].construct)->c == i && loop_next(ev)) {
      ev->pc = ast_expr(b->ast, i)->first;
      continue;
    }
    ev->pc++;
  }
  return 1;
}

/* --- evaluations, and the definitions that they wait for --- */

enum { SHALLOW = 8 };

static Eval *begin(Builder *b, AstId id, Context where, Name effect) {
  Eval *ev = b->idle.n ? b->idle.at[--b->idle.n] : ARENA_NEW(b->arena, Eval);
  const AstExpr *root = ast_expr(b->ast, id);
  uint32_t n = id - root->first + 1;
  if (n > ev->cap) {
    ev->cap = n < 64 ? 64 : n;
    ev->value = ARENA_ARRAY(b->arena, Value, ev->cap);
    ev->by_parent = ARENA_ARRAY(b->arena, unsigned char, ev->cap);
    ev->guarded = ARENA_ARRAY(b->arena, AstId, ev->cap);
  } else {
    memset(ev->value, 0, n * sizeof *ev->value);
    memset(ev->by_parent, 0, n);
    memset(ev->guarded, 0, n * sizeof *ev->guarded);
  }
  ev->b = b;
  ev->where = where;
  ev->effect = effect;
  ev->function = NULL;
  ev->kind = ENT_NONE;
  ev->in_statement = 1;
  ev->waiting = 0;
  ev->rounds = 0;
  ev->first = ev->pc = root->first;
  ev->root = id;
  ev->index.n = ev->loops.n = ev->terms.n = 0;
  ev->sums = NULL;
  ev->written_out = 0;
  mark(ev);
  return ev;
}

static Definitions *definitions(Builder *b, EntKind kind) {
  return kind == ENT_FUNCTION ? &b->functions : kind == ENT_LET ? &b->lets : &b->observes;
}

void add_definition(Builder *b, EntKind kind, Definition d) {
  Definitions *list = definitions(b, kind);
  vec_push(b->arena, list, d);
  vec_push(b->arena, &b->state[kind], (Evaluated){0});
}

/* Index of the let, the observable, or the function of the instance, that an evaluation is for. */
static uint32_t definition_index(const Builder *b, EntKind kind, uint32_t index) {
  return kind == ENT_FUNCTION ? b->instances.at[index]->function : index;
}

static Eval *begin_definition(Builder *b, EntKind kind, uint32_t index) {
  uint32_t place = definition_index(b, kind, index);
  const Definition *d = &definitions(b, kind)->at[place];
  Eval *ev = begin(b, d->stmt->rhs, kind == ENT_OBSERVE ? IN_OBSERVE : IN_DYNAMICS, d->effect);
  b->state[kind].at[place].progress = DOING;
  ev->kind = kind;
  ev->definition = index;
  ev->in_statement = 0;
  if (kind == ENT_FUNCTION) {
    ev->function = b->instances.at[index];
    b->instances.at[index]->errors = b->diags->errors;
  }
  for (int k = 0; k < 2; k++)
    if (d->index[k].name) vec_push(b->arena, &ev->index, d->index[k]);
  for (uint32_t k = 0; k < d->naround; k++) vec_push(b->arena, &ev->index, d->around[k]);
  return ev;
}

/* Wraps the value of a let in a definition node, one per component: `r.x`. */
static Value let_value(Builder *b, const Definition *d, Value v) {
  for (uint32_t k = 0; v.e && k < component_count(&v); k++) {
    Name name = v.n ? intern_printf(b, "%s.%c", d->name, component_letter(v.n, k)) : d->name;
    v.at[k] = expr_def(b->g, name, v.at[k]);
  }
  return v;
}

/* Internal error: an expression failed without a message. */
static void report_missing_message(Builder *b, AstId id) {
  if (!b->diags->errors)
    diag_error(b->diags, ast_expr(b->ast, id)->span, "internal error: `%s` has no value, and no reason is known",
               ast_short(b, id));
}

/* An observable without a declared unit takes its expression's; a vector becomes one output per component. */
static void finish_observe(Builder *b, uint32_t index, Value v) {
  const AstStmt *st = b->observes.at[index].stmt;
  Span span = ast_expr(b->ast, st->rhs)->span;
  Output o = b->m->observes.at[index];
  if (!v.e) return;
  if (!st->unit.n) o.unit.dim = v.dim;
  else if (!dims_agree(b, &v, &(Value){.e = expr_int(b->g, 1), .dim = o.unit.dim}, span)) {
    diag_error(b->diags, span, "`%s` is declared in [%s], and this is %s", o.name, o.unit.text, in_dim(b, v.dim));
    explain_dims(b, v.dim, o.unit.dim);
  }
  b->state[ENT_OBSERVE].at[index].value.unit = o.unit.text;
  Name stem = o.name;
  for (uint32_t k = 0; k < (v.n ? v.n : 1); k++) {
    o.value = v.at[k];
    if (v.n) o.name = intern_printf(b, "%s.%c", stem, component_letter(v.n, k));
    if (k) vec_push(b->arena, &b->m->observes, o);
    else b->m->observes.at[index] = o;
  }
}

static void finish_definition(Eval *ev) {
  Builder *b = ev->b;
  uint32_t place = definition_index(b, ev->kind, ev->definition);
  const Definition *d = &definitions(b, ev->kind)->at[place];
  Evaluated *state = &b->state[ev->kind].at[place];
  Value v = *value_of(ev, ev->root);
  if (!v.e) report_missing_message(b, ev->root);
  if (ev->kind == ENT_OBSERVE && v.bare && d->stmt->unit.n) {
    Unit own = unit_resolve(&d->stmt->unit, b->dims, b->diags, b->arena);
    v = values_in(b, v, ast_expr(b->ast, ev->root)->span, &own);
    v.dim = own.dim;
  }
  v.bare = v.point = 0;
  state->progress = DONE;
  state->value = ev->kind == ENT_LET ? let_value(b, d, v) : v;
  if (ev->kind == ENT_OBSERVE) finish_observe(b, place, v);
  if (ev->kind == ENT_FUNCTION) finish_instance(b, b->instances.at[ev->definition], v);
}

/* Runs an evaluation, and those that it waits for. */
static void run_all(Builder *b, Eval *first) {
  Eval *room[SHALLOW] = {first};
  VEC(Eval *) stack = {room, 1, SHALLOW};
  while (stack.n) {
    Eval *top = stack.at[stack.n - 1];
    if (!run(top)) {
      top->waiting = 0;
      Eval *needed = begin_definition(b, b->needed_kind, b->needed);
      vec_push(b->arena, &stack, needed);
      continue;
    }
    if (top->kind != ENT_NONE) finish_definition(top);
    vec_push(b->arena, &b->idle, top);
    stack.n--;
  }
}

void resolve_definition(Builder *b, EntKind kind, uint32_t index) {
  if (b->state[kind].at[index].progress == WAITING) run_all(b, begin_definition(b, kind, index));
}

/* Reports functions within functions, deeper than memory holds their derivatives: a product for each level. */
static int nests_too_deep(Builder *b, AstId id) {
  enum { DEEPEST = 2000 };
  VEC(AstId) open = {0}; /* first nodes of the calls around node i */
  uint32_t deepest = 0;
  AstId first = ast_expr(b->ast, id)->first;
  if (id - first < DEEPEST) return 0;
  for (AstId i = id; i >= first; i--) {
    const AstExpr *x = ast_expr(b->ast, i);
    while (open.n && open.at[open.n - 1] > i) open.n--;
    if (x->kind != AST_CALL || strcmp(x->name, "if") == 0) continue;
    vec_push(b->arena, &open, x->first);
    if (open.n > deepest) deepest = open.n;
  }
  if (deepest <= DEEPEST) return 0;
  diag_error(b->diags, ast_expr(b->ast, id)->span,
             "functions are nested %u deep here, and at most %d in one expression" HELP
             "name an inner part: `let a = sin(...)`",
             deepest, DEEPEST);
  return 1;
}

/* As resolve_nodes; the value may be a condition. */
static Value evaluate(Builder *b, AstId id, Context where, Name effect, Expr *nodes) {
  if (!id || nests_too_deep(b, id)) return FAILED;
  Eval *ev = begin(b, id, where, effect);
  run_all(b, ev);
  Value v = *value_of(ev, id); /* valid: ev is on the free list, but not reused yet */
  for (AstId i = ev->first; nodes && i <= id; i++) nodes[i - ev->first] = value_of(ev, i)->n ? 0 : value_of(ev, i)->e;
  if (!v.e) report_missing_message(b, id);
  return v;
}

Value resolve_nodes(Builder *b, AstId id, Context where, Name effect, Expr *nodes) {
  Value v = evaluate(b, id, where, effect, nodes);
  if (!v.e || !v.condition) return v;
  report_condition(b, id);
  return FAILED;
}

Value resolve_condition(Builder *b, AstId id, Name effect) { return evaluate(b, id, IN_DYNAMICS, effect, NULL); }

Value resolve(Builder *b, AstId id, Context where, Name effect) { return resolve_nodes(b, id, where, effect, NULL); }

/* --- values assigned to names with units --- */

long double constant_value(const Builder *b, Expr e) {
  long double x = 0, *constants = model_constants(b->m);
  expr_eval(b->g, &e, 1, constants, &x);
  arena_release(b->arena, constants, (expr_symbol_count(b->g) + 1) * sizeof *constants);
  return x;
}

/* Warns of pi/2 assigned to a name in degrees: a bare number takes the unit, here pi/2 degrees. */
static void warn_degrees(Builder *b, const Value *v, Span span, const Unit *unit) {
  if (v->n || expr_is_num(b->g, v->e) || !unit->text[0] || dim_resolved(b->dims, unit->dim) != DIM_NONE) return;
  if (num_is_one(unit->factor) && !unit->pi_power) return;
  long double x = constant_value(b, v->e);
  const char *text = source_text(b, span);
  diag_warning(b->diags, span, "`%s` is taken as %s [%s]", text, arena_printf(b->arena, "%.6Lg", x), unit->text);
  diag_help(b->diags, "write `(%s) [rad]`, or `(%s) [%s]` where that is meant", text, text, unit->text);
}

Value values_in(Builder *b, Value v, Span span, const Unit *unit) {
  if (!v.e) return FAILED;
  if (v.bare) {
    warn_degrees(b, &v, span, unit);
    for (uint32_t k = 0; k < component_count(&v); k++) v.at[k] = times_unit(b, v.at[k], unit);
    return v;
  }
  if (is_zero(b, &v) || dim_equate(b->dims, v.dim, unit->dim, span)) return v;
  const char *want = unit->text[0] ? unit->text : dim_text(b->dims, unit->dim);
  const char *wanted = strcmp(want, "1") == 0 ? "a pure number" : arena_printf(b->arena, "[%s]", want);
  diag_error(b->diags, span, "this value is %s, but %s is needed here", in_unit(b, shown_unit(b, &v)), wanted);
  if (dim_resolved(b->dims, v.dim) == DIM_NONE)
    diag_help(b->diags, "give a number in it its unit, or multiply by `1 [%s]`", dim_text(b->dims, unit->dim));
  explain_dims(b, v.dim, unit->dim);
  return FAILED;
}

Expr value_in(Builder *b, Value v, Span span, const Unit *unit) {
  if (!v.e || !v.n) return values_in(b, v, span, unit).e;
  return refuse(b, span, "this is %s, but a number is needed here", shape_text(b, v.n)).e;
}

Expr resolve_in(Builder *b, AstId id, Context where, Name effect, const Unit *unit) {
  Value v = resolve(b, id, where, effect);
  return v.e ? value_in(b, v, ast_expr(b->ast, id)->span, unit) : 0;
}

const char *expression_digits(Builder *b, Expr e) {
  Expr pi = expr_symbol(b->g, b->m->pi)->node;
  for (int power = -1; power <= 1; power++) {
    Expr rest = expr_mul(b->g, e, expr_pow_num(b->g, pi, num_int(-power)));
    if (expr_is_num(b->g, rest)) return decimal_literal(b->arena, expr_number(b->g, rest), power);
  }
  return NULL;
}

double resolve_number(Builder *b, AstId id, const Unit *unit, const char *what, const char **digits) {
  if (digits) *digits = NULL;
  Expr e = resolve_in(b, id, IN_CONST, NULL, unit);
  if (!e) return NAN;
  long double x = constant_value(b, e);
  if (!isfinite((double)x)) {
    diag_error(b->diags, ast_expr(b->ast, id)->span, "%s is not a finite number", what);
    return NAN;
  }
  if (digits) *digits = expression_digits(b, e);
  return (double)x;
}
