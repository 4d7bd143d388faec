/* Expressions: Ast -> graph, with dimensions checked on the way.
 *
 * The nodes of an expression are contiguous and children come first, so evaluation is one loop
 * from the first to the last. Chains of + and - are gathered and built as one sum (and * / as one
 * product), so a sum of a million terms costs one sort. Lets and functions are evaluated when first
 * needed, off an explicit stack. */
#include <math.h>
#include <stdarg.h>

#include "model/resolve_impl.h"
#include "sym/diff.h"
#include "sym/eval.h"

Name intern_printf(Builder *b, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  const char *s = arena_vprintf(b->arena, fmt, ap);
  va_end(ap);
  return intern(b->ast->names, s);
}

void not_yet(Builder *b, Span span, const char *what) {
  diag_error(b->diags, span, "not yet: %s", what);
  diag_help(b->diags, "lagc understands the syntax but cannot give it meaning in this version");
}

const char *ast_text(const Builder *b, AstId id) {
  Span s = ast_expr(b->ast, id)->span;
  Place p = source_place(b->ast->sources, s.begin);
  if (!p.file || s.end <= s.begin) return "";
  StrBuf out = strbuf(b->arena);
  const char *from = p.file->text + (s.begin - p.file->base), *end = from + (s.end - s.begin);
  int quoted = 0;
  for (const char *c = from; c < end; c++) {
    if (*c == '"') quoted = !quoted;
    if (*c == '#' && !quoted)
      while (c + 1 < end && *c != '\n') c++;
    int space = *c == ' ' || *c == '\t' || *c == '\n' || *c == '\r';
    if (!space) sb_putc(&out, *c);
    else if (out.n && out.at[out.n - 1] != ' ') sb_putc(&out, ' ');
  }
  return sb_text(&out);
}

const char *ast_short(const Builder *b, AstId id) {
  enum { LONGEST = 48 };
  const char *text = ast_text(b, id);
  size_t n = strlen(text);
  if (n <= LONGEST) return text;
  size_t head = LONGEST - 13, tail = n - 10;
  while (head && ((unsigned char)text[head] & 0xC0) == 0x80) head--;
  while (tail < n && ((unsigned char)text[tail] & 0xC0) == 0x80) tail++;
  return arena_printf(b->arena, "%.*s...%s", (int)head, text, text + tail);
}

/* --- names --- */

const Entity *resolve_name(Builder *b, Name name, Span span, Name effect, const char *declare) {
  int ambiguous;
  const Entity *e = scope_find(&b->scope, name, effect, &ambiguous);
  if (!e) {
    diag_error(b->diags, span, "unknown name `%s`", name);
    advise_unknown_name(b, name, span, effect, declare);
  } else if (ambiguous) {
    diag_error(b->diags, span, "`%s` is declared by more than one effect in use", name);
    diag_help(b->diags, "say which: `%s.%s`", e->effect, name);
    return NULL;
  }
  return e;
}

/* --- lets and functions, on demand --- */

typedef struct {
  EntKind kind;
  uint32_t index;
} Pending;

typedef VEC(Pending) PendingStack;

static Definition *definition(Builder *b, EntKind kind, uint32_t index) {
  return kind == ENT_LET ? &b->lets.at[index] : &b->functions.at[index];
}

/* The node of the argument called `name`, when a function's body is evaluated; otherwise 0. */
static Expr function_argument(const Builder *b, const Definition *function, Name name) {
  for (uint32_t i = 0; function && i < function->nargs; i++) {
    const Symbol *s = expr_symbol(b->g, function->args[i]);
    if (s->name == name) return s->node;
  }
  return 0;
}

/* Pushes what the expression needs and is not there; a definition that is being evaluated already
 * needs itself: that is reported, and 0 returned. */
static int push_needs(Builder *b, PendingStack *stack, AstId id, Name effect, const Definition *function) {
  int ok = 1;
  for (AstId i = ast_expr(b->ast, id)->first; i <= id; i++) {
    const AstExpr *x = ast_expr(b->ast, i);
    if (x->kind != AST_NAME && x->kind != AST_CALL) continue;
    if (x->kind == AST_NAME && function_argument(b, function, x->name)) continue;
    int ambiguous;
    const Entity *e = scope_find(&b->scope, x->name, effect, &ambiguous);
    if (!e || (e->kind != ENT_LET && e->kind != ENT_FUNCTION)) continue;
    Definition *d = definition(b, e->kind, e->index);
    if (d->progress == DOING) {
      diag_error(b->diags, x->span, "`%s` is defined by itself", x->name);
      diag_help(b->diags, "%s may use only what does not lead back to it", ent_kind_text(e->kind));
      ok = 0;
    } else if (d->progress == TODO) {
      vec_push(b->arena, stack, ((Pending){e->kind, e->index}));
    }
  }
  return ok;
}

static Value evaluate(Builder *b, AstId id, Context where, Name effect, const Definition *function);

static void finish_definition(Builder *b, EntKind kind, Definition *d) {
  Value v = evaluate(b, d->stmt->rhs, IN_DYNAMICS, d->effect, kind == ENT_FUNCTION ? d : NULL);
  d->dim = v.dim;
  d->condition = v.condition;
  d->value = v.e;
  if (v.e && kind == ENT_LET) d->value = expr_def(b->g, d->stmt->name, v.e);
  d->progress = DONE;
}

static void finish_pending(Builder *b, PendingStack *stack) {
  while (stack->n) {
    Pending top = stack->at[stack->n - 1];
    Definition *d = definition(b, top.kind, top.index);
    if (d->progress == TODO) {
      d->progress = DOING;
      if (push_needs(b, stack, d->stmt->rhs, d->effect, top.kind == ENT_FUNCTION ? d : NULL)) continue;
      d->progress = DONE; /* its value stays 0: reported */
    }
    if (d->progress == DOING) finish_definition(b, top.kind, d);
    stack->n--;
  }
}

static void ensure_needs(Builder *b, AstId id, Name effect) {
  PendingStack stack = {0};
  push_needs(b, &stack, id, effect, NULL);
  finish_pending(b, &stack);
}

void resolve_definition(Builder *b, EntKind kind, uint32_t index) {
  PendingStack stack = {0};
  vec_push(b->arena, &stack, ((Pending){kind, index}));
  finish_pending(b, &stack);
}

/* --- leaves --- */

static const char *place_text(Context where) {
  switch (where) {
    case IN_CONST: return "only numbers and constants are known here";
    case IN_PARAM: return "a parameter's value may contain numbers and parameters declared before it";
    case IN_START: return "a start value may contain numbers and parameters";
    case IN_INPUT: return "an input may contain numbers, parameters and t";
    case IN_DYNAMICS: case IN_OBSERVE: break;
  }
  return "";
}

static Context least_context(EntKind kind) {
  switch (kind) {
    case ENT_CONST: return IN_CONST;
    case ENT_PARAM: return IN_PARAM;
    case ENT_NONE: case ENT_COORD: case ENT_STATE: case ENT_INPUT: case ENT_LET: case ENT_FUNCTION:
    case ENT_OBSERVE: case ENT_BUILTIN: break;
  }
  return IN_DYNAMICS;
}

static Value symbol_value(const Builder *b, SymId s) {
  return a_value(expr_symbol(b->g, s)->node, b->dims.at[s], 0);
}

static Value entity_value(Eval *ev, const Entity *e, Span span) {
  Builder *b = ev->b;
  if (e->kind == ENT_NONE) return FAILED;
  if (least_context(e->kind) > ev->where) {
    diag_error(b->diags, span, "`%s` is %s and may not be used here", e->name, ent_kind_text(e->kind));
    diag_help(b->diags, "%s", place_text(ev->where));
    return FAILED;
  }
  switch (e->kind) {
    case ENT_COORD: return symbol_value(b, b->m->coords.at[e->index].q);
    case ENT_STATE: return symbol_value(b, b->m->states.at[e->index].z);
    case ENT_PARAM: return symbol_value(b, b->m->params.at[e->index].sym);
    case ENT_INPUT: return symbol_value(b, b->m->inputs.at[e->index].sym);
    case ENT_CONST: return a_value(expr_num(b->g, b->constants.at[e->index].value), DIM_NONE, 1);
    case ENT_LET: return (Value){b->lets.at[e->index].value, b->lets.at[e->index].dim, 0, b->lets.at[e->index].condition};
    case ENT_OBSERVE: {
      const Output *o = &b->m->observes.at[e->index];
      return a_value(o->value, o->unit.dim, 0);
    }
    case ENT_FUNCTION:
      diag_error(b->diags, span, "`%s` is a function", e->name);
      diag_help(b->diags, "give it its arguments: `%s(...)`", e->name);
      return FAILED;
    case ENT_NONE: case ENT_BUILTIN: break;
  }
  return FAILED;
}

/* lagrangian, energy, T, V: what the model itself defines, unless it declares the name otherwise. */
static int builtin_quantity(Eval *ev, Name name, Value *out) {
  Builder *b = ev->b;
  Model *m = b->m;
  if (ev->where != IN_OBSERVE) return 0;
  Dim joule = {1, {2 * DIM_ONE, DIM_ONE, -2 * DIM_ONE}};
  Dim dim = b->dims.at[m->energy_sym].known ? joule : DIM_UNKNOWN;
  Expr e = 0;
  if (strcmp(name, "lagrangian") == 0) e = m->lagrangian;
  else if (strcmp(name, "energy") == 0 && m->lagrangian) e = expr_symbol(b->g, m->energy_sym)->node;
  else if (strcmp(name, "T") == 0) e = m->kinetic;
  else if (strcmp(name, "V") == 0) e = m->potential;
  if (!e) return 0;
  *out = a_value(e, dim, 0);
  return 1;
}

static Value name_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  Expr argument = function_argument(b, ev->function, x->name);
  if (argument) return a_value(argument, DIM_UNKNOWN, 0);
  if (strcmp(x->name, "pi") == 0) return a_value(expr_symbol(b->g, b->m->pi)->node, DIM_NONE, 1);
  if (strcmp(x->name, "t") == 0) {
    if (ev->where >= IN_INPUT) return symbol_value(b, b->m->time);
    diag_error(b->diags, x->span, "the time `t` may not be used here");
    diag_help(b->diags, "%s", place_text(ev->where));
    return FAILED;
  }
  int ambiguous;
  Value v;
  if (!scope_find(&b->scope, x->name, ev->effect, &ambiguous) && builtin_quantity(ev, x->name, &v)) return v;
  const Entity *e = resolve_name(b, x->name, x->span, ev->effect, NULL);
  return e ? entity_value(ev, e, x->span) : FAILED;
}

/* drag.c: a parameter of an effect. */
static Value member_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const AstExpr *left = ast_expr(b->ast, x->a);
  if (left->kind != AST_NAME) {
    not_yet(b, x->span, "components of vectors");
    return FAILED;
  }
  const Entity *e = scope_own(&b->scope, x->name, left->name);
  if (e) return entity_value(ev, e, x->span);
  int ambiguous;
  const Entity *of = scope_find(&b->scope, left->name, ev->effect, &ambiguous);
  if (of && of->kind == ENT_NONE) return FAILED;
  if (of) {
    diag_error(b->diags, x->span, "`%s` has no component `%s`", left->name, x->name);
    diag_help(b->diags, "not yet: components of vectors; `effect.name` reaches the parameters of an effect in use");
  } else {
    diag_error(b->diags, x->span, "no effect in use declares `%s.%s`", left->name, x->name);
    advise_unknown_member(b, left->name, x->name);
  }
  return FAILED;
}

/* --- dimensions --- */

/* Reports two dimensions that should agree; a bare number gets the unit to write. */
void report_mismatch(Eval *ev, Span span, AstId x, AstId y) {
  Builder *b = ev->b;
  const Value *vx = value_of(ev, x), *vy = value_of(ev, y);
  if (vx->bare) {
    AstId t = x;
    x = y;
    y = t;
    vx = value_of(ev, x);
    vy = value_of(ev, y);
  }
  const char *tx = ast_short(b, x), *ty = ast_short(b, y), *dx = dim_text(vx->dim, b->arena);
  if (vy->bare) {
    diag_error(b->diags, span, "units do not match: `%s` is in [%s], `%s` has no unit", tx, dx, ty);
    diag_help(b->diags, "give the number its unit: `%s [%s]`", ty, dx);
  } else {
    diag_error(b->diags, span, "units do not match: `%s` is in [%s], `%s` in [%s]", tx, dx, ty, dim_text(vy->dim, b->arena));
  }
}

static void report_condition(Builder *b, AstId id) {
  diag_error(b->diags, ast_expr(b->ast, id)->span, "`%s` is a condition, no number", ast_short(b, id));
  diag_help(b->diags, "`if(condition, a, b)` chooses between two numbers");
}

/* A zero is a zero in every unit. */
int dims_agree(const Builder *b, const Value *x, const Value *y) {
  return dim_fits(x->dim, y->dim) || expr_is_zero(b->g, x->e) || expr_is_zero(b->g, y->e);
}

int need_pure(Eval *ev, AstId arg, const char *what) {
  const Value *v = value_of(ev, arg);
  if (!v->dim.known || dim_is_none(v->dim)) return 1;
  diag_error(ev->b->diags, ast_expr(ev->b->ast, arg)->span, "%s takes a pure number or an angle; `%s` is in [%s]",
             what, ast_short(ev->b, arg), dim_text(v->dim, ev->b->arena));
  return 0;
}

/* --- operators --- */

/* The operands of a left-leaning chain of two operators (+ and -, or * and /), left to right. */
typedef struct {
  AstId at;
  int inverted; /* subtracted, or divided by */
} Operand;

typedef VEC(Operand) Operands;

static Operands chain(Eval *ev, AstId id, AstKind inverse) {
  Builder *b = ev->b;
  Operands rev = {0}, out = {0};
  AstId at = id;
  for (;;) {
    const AstExpr *x = ast_expr(b->ast, at);
    vec_push(b->arena, &rev, ((Operand){x->b, x->kind == inverse}));
    at = x->a;
    if (!ev->open[at - ev->first]) break;
  }
  vec_push(b->arena, &rev, ((Operand){at, 0}));
  for (uint32_t i = rev.n; i-- > 0;) vec_push(b->arena, &out, rev.at[i]);
  return out;
}

static Value sum_value(Eval *ev, AstId id) {
  Builder *b = ev->b;
  Operands ops = chain(ev, id, AST_SUB);
  Expr *terms = ARENA_ARRAY(b->arena, Expr, ops.n);
  Value r = {.dim = DIM_UNKNOWN, .bare = 1};
  AstId measure = 0; /* the operand that settles the dimension */
  int ok = 1;
  for (uint32_t i = 0; i < ops.n; i++) {
    const Value *v = value_of(ev, ops.at[i].at);
    if (!v->e) {
      ok = 0;
      continue;
    }
    terms[i] = ops.at[i].inverted ? expr_neg(b->g, v->e) : v->e;
    r.bare &= v->bare;
    if (expr_is_zero(b->g, v->e)) continue;
    if (measure && ok && !dims_agree(b, value_of(ev, measure), v)) {
      report_mismatch(ev, ast_expr(b->ast, ops.at[i].at)->span, measure, ops.at[i].at);
      ok = 0;
    }
    if (!measure && v->dim.known) {
      measure = ops.at[i].at;
      r.dim = v->dim;
    }
  }
  if (!ok) return FAILED;
  r.e = expr_add_n(b->g, terms, ops.n);
  return r;
}

static Value product_value(Eval *ev, AstId id) {
  Builder *b = ev->b;
  Operands ops = chain(ev, id, AST_DIV);
  Expr *factors = ARENA_ARRAY(b->arena, Expr, ops.n);
  Value r = {.dim = DIM_NONE, .bare = 1};
  int ok = 1;
  for (uint32_t i = 0; i < ops.n; i++) {
    const Value *v = value_of(ev, ops.at[i].at);
    if (!v->e) {
      ok = 0;
      continue;
    }
    if (ops.at[i].inverted && expr_is_zero(b->g, v->e)) {
      diag_error(b->diags, ast_expr(b->ast, ops.at[i].at)->span, "division by zero");
      ok = 0;
      continue;
    }
    factors[i] = ops.at[i].inverted ? expr_pow_num(b->g, v->e, num_int(-1)) : v->e;
    r.dim = ops.at[i].inverted ? dim_div(r.dim, v->dim) : dim_mul(r.dim, v->dim);
    r.bare &= v->bare;
  }
  if (!ok) return FAILED;
  r.e = expr_mul_n(b->g, factors, ops.n);
  return r;
}

Value power_value(Eval *ev, const AstExpr *x, AstId base_id, AstId exp_id) {
  Builder *b = ev->b;
  const Value *base = value_of(ev, base_id), *e = value_of(ev, exp_id);
  if (!base->e || !e->e || !need_pure(ev, exp_id, "an exponent")) return FAILED;
  if (expr_is_num(b->g, e->e)) {
    Num n = expr_number(b->g, e->e);
    if (num_sign(n) < 0 && expr_is_zero(b->g, base->e)) {
      diag_error(b->diags, x->span, "division by zero");
      return FAILED;
    }
    return a_value(expr_pow_num(b->g, base->e, n), dim_pow(base->dim, n), base->bare && e->bare);
  }
  if (!need_pure(ev, base_id, "the base of a power whose exponent is not a number")) return FAILED;
  return a_value(expr_pow(b->g, base->e, e->e), base->dim.known ? DIM_NONE : DIM_UNKNOWN, 0);
}

static Value compare_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const Value *l = value_of(ev, x->a), *r = value_of(ev, x->b);
  if (!l->e || !r->e) return FAILED;
  if (!dims_agree(b, l, r)) {
    report_mismatch(ev, x->span, x->a, x->b);
    return FAILED;
  }
  int swapped = x->kind == AST_GT || x->kind == AST_GE;
  ExprOp op = x->kind == AST_LT || x->kind == AST_GT ? EX_LT : x->kind == AST_LE || x->kind == AST_GE ? EX_LE : EX_EQ;
  Expr e = expr_fn2(b->g, op, swapped ? r->e : l->e, swapped ? l->e : r->e);
  if (x->kind == AST_NE) e = expr_fn(b->g, EX_NOT, e);
  return (Value){e, DIM_NONE, 0, 1};
}

static int need_condition(Eval *ev, AstId id) {
  if (value_of(ev, id)->condition) return 1;
  diag_error(ev->b->diags, ast_expr(ev->b->ast, id)->span, "`%s` is no condition", ast_short(ev->b, id));
  diag_help(ev->b->diags, "`and`, `or` and `not` join comparisons, such as `x > 0`");
  return 0;
}

static Value logic_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  Expr l = value_of(ev, x->a)->e, r = x->b ? value_of(ev, x->b)->e : 0;
  if (!l || (x->b && !r)) return FAILED;
  if (!need_condition(ev, x->a) || (x->b && !need_condition(ev, x->b))) return FAILED;
  Expr e = x->kind == AST_NOT ? expr_fn(b->g, EX_NOT, l) : expr_fn2(b->g, x->kind == AST_AND ? EX_AND : EX_OR, l, r);
  return (Value){e, DIM_NONE, 0, 1};
}

/* --- time derivatives --- */

static int is_input(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_INPUT;
}

static int is_second(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_ACC || s->kind == SYM_RATE;
}

static int is_local(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_LOCAL;
}

/* What each symbol becomes under d/dt. */
static Expr *time_seeds(Builder *b) {
  Expr *seed = ARENA_ARRAY(b->arena, Expr, expr_symbol_count(b->g) + 1);
  const Model *m = b->m;
  seed[m->time] = expr_int(b->g, 1);
  for (uint32_t i = 0; i < m->coords.n; i++) {
    const Coord *c = &m->coords.at[i];
    seed[c->q] = expr_symbol(b->g, c->v)->node;
    seed[c->v] = expr_symbol(b->g, c->a)->node;
  }
  for (uint32_t i = 0; i < m->states.n; i++)
    seed[m->states.at[i].z] = expr_symbol(b->g, m->states.at[i].rate)->node;
  return seed;
}

static Value prime_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const Value *of = value_of(ev, x->a);
  if (!of->e) return FAILED;
  if (expr_contains(b->g, of->e, is_input, NULL)) {
    diag_error(b->diags, x->span, "an input has no time derivative");
    diag_help(b->diags, "declare the derivative as an input of its own");
    return FAILED;
  }
  if (expr_contains(b->g, of->e, is_second, NULL)) {
    diag_error(b->diags, x->span, "third derivatives do not occur in mechanics");
    return FAILED;
  }
  if (expr_contains(b->g, of->e, is_local, NULL)) {
    not_yet(b, x->span, "a time derivative of a function's argument, or of the energy");
    return FAILED;
  }
  Expr *seed = time_seeds(b), e;
  expr_tangent(b->g, &of->e, 1, seed, expr_symbol_count(b->g) + 1, "'", &e);
  if (ev->where != IN_OBSERVE && expr_contains(b->g, e, is_second, NULL)) {
    diag_error(b->diags, x->span, "a second derivative may stand only in `expect` and `observe`");
    diag_help(b->diags, "L and forces are functions of q, q' and t; accelerations follow from them");
    return FAILED;
  }
  Dim second = {1, {[DIM_TIME] = DIM_ONE}};
  return a_value(e, dim_div(of->dim, second), 0);
}

/* --- units on a value --- */

static Expr times_unit(Builder *b, Expr e, const Unit *u) {
  Expr pi = expr_symbol(b->g, b->m->pi)->node;
  Expr power = expr_pow_num(b->g, pi, num_int(u->pi_power));
  Expr scaled = expr_scale(b->g, u->factor, e);
  return expr_mul(b->g, scaled, power);
}

static Value unit_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, x->a);
  if (ast_expr(b->ast, x->a)->kind != AST_NUM) warn_unit_is_constant(b, &x->unit);
  Unit u = unit_resolve(&x->unit, b->diags, b->arena);
  if (!v->e || (x->unit.n && !u.dim.known)) return FAILED;
  if (v->dim.known && !dim_is_none(v->dim)) {
    diag_error(b->diags, x->unit.span, "`%s` has a unit already: [%s]", ast_short(b, x->a), dim_text(v->dim, b->arena));
    diag_help(b->diags, "leave `[%s]` out, or multiply: `... * 1 [%s]`", x->unit.text, x->unit.text);
    return FAILED;
  }
  return a_value(times_unit(b, v->e, &u), u.dim, 0);
}

/* --- the loop --- */

static Value node_value(Eval *ev, AstId id) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  switch (x->kind) {
    case AST_NUM: return a_value(expr_num(b->g, x->number), num_is_zero(x->number) ? DIM_UNKNOWN : DIM_NONE, 1);
    case AST_NAME: return name_value(ev, x);
    case AST_MEMBER: return member_value(ev, x);
    case AST_PRIME: return prime_value(ev, x);
    case AST_UNIT: return unit_value(ev, x);
    case AST_NEG: {
      const Value *v = value_of(ev, x->a);
      return v->e ? a_value(expr_neg(b->g, v->e), v->dim, v->bare) : FAILED;
    }
    case AST_ADD: case AST_SUB: return sum_value(ev, id);
    case AST_MUL: case AST_DIV: return product_value(ev, id);
    case AST_POW: return power_value(ev, x, x->a, x->b);
    case AST_LT: case AST_LE: case AST_GT: case AST_GE: case AST_EQ: case AST_NE: return compare_value(ev, x);
    case AST_NOT: case AST_AND: case AST_OR: return logic_value(ev, x);
    case AST_CALL: return call_value(ev, x);
    case AST_INDEX: not_yet(b, x->span, "families (indexed names)"); return FAILED;
    case AST_SUM: case AST_PRODUCT: not_yet(b, x->span, "`sum` and `product`"); return FAILED;
    case AST_TUPLE: not_yet(b, x->span, "vectors"); return FAILED;
    case AST_LIST: not_yet(b, x->span, "lists of values"); return FAILED;
    case AST_STRING: not_yet(b, x->span, "tables from files"); return FAILED;
    case AST_BIND: not_yet(b, x->span, "index ranges"); return FAILED;
    case AST_ERROR: return FAILED;
  }
  return FAILED;
}

/* Marks the left operands that continue a chain of the same kind of operator. */
static void mark_chains(Eval *ev, AstId last) {
  for (AstId i = ev->first; i <= last; i++) {
    const AstExpr *x = ast_expr(ev->b->ast, i);
    if (x->kind != AST_ADD && x->kind != AST_SUB && x->kind != AST_MUL && x->kind != AST_DIV) continue;
    if (x->a == ev->b->stand_in) continue;
    AstKind left = ast_expr(ev->b->ast, x->a)->kind;
    int additive = x->kind == AST_ADD || x->kind == AST_SUB;
    ev->open[x->a - ev->first] = additive ? left == AST_ADD || left == AST_SUB : left == AST_MUL || left == AST_DIV;
  }
}

/* Inside sum(...), lists and indices names may be bound that are not declared: the one message
 * about the construct is enough. */
static int is_not_yet(const Builder *b, const AstExpr *x) {
  switch (x->kind) {
    case AST_SUM: case AST_PRODUCT: case AST_INDEX: case AST_TUPLE: case AST_LIST: case AST_BIND: return 1;
    case AST_MEMBER: return ast_expr(b->ast, x->a)->kind != AST_NAME;
    case AST_CALL: return call_is_not_yet(x->name);
    case AST_NUM: case AST_STRING: case AST_NAME: case AST_PRIME: case AST_UNIT: case AST_NEG: case AST_NOT:
    case AST_ADD: case AST_SUB: case AST_MUL: case AST_DIV: case AST_POW: case AST_LT: case AST_LE: case AST_GT:
    case AST_GE: case AST_EQ: case AST_NE: case AST_AND: case AST_OR: case AST_ERROR: break;
  }
  return 0;
}

/* A condition is no number: it may stand in a condition, and first in `if`. */
static int numbers_only(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  if (x->kind == AST_NOT || x->kind == AST_AND || x->kind == AST_OR) return 1;
  int is_if = x->kind == AST_CALL && strcmp(x->name, "if") == 0;
  AstId list = is_if && x->args ? ast_expr(b->ast, x->args)->next : x->args;
  AstId at[3] = {x->a, x->b, list};
  for (int k = 0; k < 3; k++)
    for (AstId i = at[k]; i; i = k == 2 ? ast_expr(b->ast, i)->next : 0)
      if (value_of(ev, i)->condition) {
        report_condition(b, i);
        return 0;
      }
  return 1;
}

/* Numbers beyond the range of a double are refused where they arise. */
static Value finite_value(Eval *ev, const AstExpr *x, Value v) {
  ExprGraph *g = ev->b->g;
  if (!v.e) return v;
  ExprOp op = expr_op(g, v.e);
  int pairs = op == EX_SUM || op == EX_PROD;
  for (uint32_t i = 0; i < expr_nargs(g, v.e) + (op == EX_NUM); i++) {
    Expr n = op == EX_NUM ? v.e : expr_arg(g, v.e, i);
    if (!(op == EX_NUM || pairs) || !expr_is_num(g, n) || isfinite(num_value(expr_number(g, n)))) continue;
    diag_error(ev->b->diags, x->span, "a number here is not finite");
    diag_help(ev->b->diags, "numbers reach up to 1.8e308");
    return FAILED;
  }
  return v;
}

static Value evaluate(Builder *b, AstId id, Context where, Name effect, const Definition *function) {
  const AstExpr *root = ast_expr(b->ast, id);
  uint32_t n = id - root->first + 1;
  Eval ev = {.b = b, .where = where, .effect = effect, .function = function, .first = root->first};
  ev.value = ARENA_ARRAY(b->arena, Value, n);
  ev.open = ARENA_ARRAY(b->arena, unsigned char, n);
  mark_chains(&ev, id);
  AstId quiet = 0; /* the nodes of this expression are inside something that is refused as a whole */
  for (AstId i = id; i >= ev.first; i--) {
    if (quiet && i < ast_expr(b->ast, quiet)->first) quiet = 0;
    if (quiet) ev.open[i - ev.first] = 1;
    else if (is_not_yet(b, ast_expr(b->ast, i))) quiet = i;
  }
  for (AstId i = ev.first; i <= id; i++) {
    const AstExpr *x = ast_expr(b->ast, i);
    if (x->kind == AST_NAME && i < id) {
      /* the left of drag.c is no name of its own; the second argument of d() is */
      const AstExpr *up = ast_expr(b->ast, i + 1);
      if (up->kind == AST_MEMBER && up->a == i) continue;
    }
    if (i == b->stand_in) ev.value[i - ev.first] = (Value){.e = b->stands_for, .dim = DIM_UNKNOWN};
    else if (!ev.open[i - ev.first])
      ev.value[i - ev.first] = numbers_only(&ev, x) ? finite_value(&ev, x, node_value(&ev, i)) : FAILED;
    if (b->unitless) ev.value[i - ev.first].dim = DIM_UNKNOWN;
  }
  return ev.value[id - ev.first];
}

Value resolve(Builder *b, AstId id, Context where, Name effect) {
  if (!id) return FAILED;
  if (where >= IN_DYNAMICS) ensure_needs(b, id, effect);
  Value v = evaluate(b, id, where, effect, NULL);
  if (!v.e || !v.condition) return v;
  report_condition(b, id);
  return FAILED;
}

Expr value_in(Builder *b, Value v, Span span, const Unit *unit) {
  if (!v.e) return 0;
  if (v.bare) return times_unit(b, v.e, unit);
  if (!dim_fits(v.dim, unit->dim)) {
    const char *want = dim_text(unit->dim, b->arena);
    diag_error(b->diags, span, "this value is in [%s], and [%s] is wanted here", dim_text(v.dim, b->arena), want);
    if (dim_is_none(v.dim)) diag_help(b->diags, "give a number in it its unit, or multiply by `1 [%s]`", want);
    return 0;
  }
  return v.e;
}

Expr resolve_in(Builder *b, AstId id, Context where, Name effect, const Unit *unit) {
  Value v = resolve(b, id, where, effect);
  return v.e ? value_in(b, v, ast_expr(b->ast, id)->span, unit) : 0;
}

double resolve_number(Builder *b, AstId id, const Unit *unit, const char *what) {
  Expr e = resolve_in(b, id, IN_CONST, NULL, unit);
  if (!e) return NAN;
  long double *symbols = ARENA_ARRAY(b->arena, long double, expr_symbol_count(b->g) + 1), x = 0;
  symbols[b->m->pi] = 3.14159265358979323846264338327950288L;
  expr_eval(b->g, &e, 1, symbols, &x);
  if (!isfinite((double)x)) {
    diag_error(b->diags, ast_expr(b->ast, id)->span, "%s is not a finite number", what);
    return NAN;
  }
  return (double)x;
}
